from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import onnx
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import piper_voice
from lipwright import espeak
from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.espeak.process import find_library
from lipwright.language.ipa import read_ipa
from lipwright.phones import BILABIALS, SILENCE
from lipwright.speech.voices import find_voice
from lipwright.speech.voices.onnx_nodes import read_contents
from lipwright.speech.voices.piper import PiperVoice, back_end
from lipwright.speech.voices.values import Piece, Utterance
from lipwright.speech.voices.written_out import written_out
from piper_voice import HOP, RATE, SYMBOLS, config, frames, tone, write_voice

pytestmark = pytest.mark.skipif(
    find_library() is None, reason="espeak-ng is not installed: pip install 'lipwright[piper]'"
)


def voice(path: Path, speaker: str = "") -> PiperVoice:
    return back_end().open(f"{path}{speaker}", None)


def said(path: Path, *pieces: Piece) -> Utterance:
    return voice(path).speak(pieces)


def pitch(samples: npt.NDArray[np.float32]) -> float:
    """Hz of a tone."""
    spectrum = np.abs(np.fft.rfft(samples * np.hanning(len(samples)), 1 << 16))
    return float(np.argmax(spectrum) * RATE / (1 << 16))


def test_each_phone_of_the_track_is_where_the_network_makes_its_tone(tmp_path: Path) -> None:
    utterance = said(write_voice(tmp_path), Piece("Bob's map, my pub. A beam!"))
    track = utterance.track
    assert track is not None
    assert utterance.timing == "voice"
    assert track.end == pytest.approx(utterance.audio.duration)
    tone_of = {"B": "b", "M": "m", "P": "p", "Z": "z", "IY": "i", "AE": "æ", "AX": "ɐ"}
    checked = 0
    for phone, start, end in track:
        samples = utterance.audio.read(start, end).samples
        if phone == SILENCE:
            assert np.abs(samples).max() < 0.01
        elif phone in tone_of:
            assert pitch(samples) == pytest.approx(tone(tone_of[phone]), abs=8)
            # The space behind a word belongs to its last phone.
            spare = (end - start) * RATE / HOP - frames(tone_of[phone])
            assert min(abs(spare), abs(spare - frames(" "))) < 0.01
            checked += 1
    assert checked >= 9
    assert "".join(phone for phone in track.phones if phone in BILABIALS) == "BBMPMPBBM"


def test_words_are_as_written_and_own_their_phones(tmp_path: Path) -> None:
    track = said(write_voice(tmp_path), Piece("“Mum”, of the 12 pubs: naïve!")).track
    assert track is not None
    words = {word.text: track.phones[word.first : word.stop] for word in track.words}
    assert list(words) == ["Mum", "of", "the", "twelve", "pubs", "naïve"]
    assert words["Mum"] == ("M", "AH", "M")
    assert words["twelve"] == ("T", "W", "EH", "L", "V")
    assert words["the"][0] == "DH"


def test_commas_and_sentences_are_silence_and_breaks_exact(tmp_path: Path) -> None:
    track = said(
        write_voice(tmp_path), Piece("Map, map. Map", pause=0.75), Piece("Map.")
    ).track  # fmt: skip
    assert track is not None
    gaps = [end - start for phone, start, end in track if phone == SILENCE]
    assert len(gaps) == 5
    assert gaps[3] == pytest.approx(0.75, abs=1e-3)
    assert gaps[1] == pytest.approx((frames(",") + frames(" ")) * HOP / RATE, abs=1e-3)


@pytest.mark.parametrize("rate", [0.5, 0.8, 1.5, 2.0])
def test_rate_changes_the_duration_by_length_scale(tmp_path: Path, rate: float) -> None:
    path = write_voice(tmp_path)
    text = "Many people buy apples in the market."
    usual, other = (len(said(path, Piece(text, rate=one)).audio) for one in (1.0, rate))
    assert usual / other == pytest.approx(rate, rel=0.05)


def test_phones_are_said_and_those_that_the_voice_lacks_by_the_nearest(tmp_path: Path) -> None:
    track = said(
        write_voice(tmp_path), Piece("Bam", ("B", "AA", "M")), Piece("", ("XH", "AA"))
    ).track
    assert track is not None
    assert [phone for phone in track.phones if phone != SILENCE] == ["B", "AA", "M", "XH", "AA"]
    assert [word.text for word in track.words] == ["Bam", "XH-AA"]
    lacking = {letter: ids for letter, ids in piper_voice.IDS.items() if letter != "ɧ"}
    other = write_voice(tmp_path, "other", config(phoneme_id_map=lacking))
    track = said(other, Piece("x", ("XH", "AA"))).track
    assert track is not None
    assert track.phones[1] in ("SH", "XS")


@pytest.mark.parametrize("options", [{"shown": True}, {"ceils": "two"}])
def test_durations_are_found_in_other_exports(tmp_path: Path, options: dict[str, Any]) -> None:
    usual = said(write_voice(tmp_path), Piece("Bob met a man.")).track
    other = said(write_voice(tmp_path, "other", **options), Piece("Bob met a man.")).track
    assert usual is not None
    assert other is not None
    np.testing.assert_allclose(usual.edges, other.edges)


def test_a_voice_without_durations_gives_no_track(tmp_path: Path) -> None:
    path = write_voice(tmp_path, ceils="none")
    utterance = said(path, Piece("Bob met a man.", pause=0.5), Piece("Who?"))
    assert utterance.track is None
    assert utterance.text == "Bob met a man. Who?"
    timed = said(write_voice(tmp_path, "timed"), Piece("Bob met a man."))
    assert utterance.audio.duration > timed.audio.duration + 0.5


def test_a_voice_that_reads_letters_gives_no_track(tmp_path: Path) -> None:
    path = write_voice(tmp_path, settings=config(phoneme_type="text", espeak={}))
    utterance = said(path, Piece("Bob met a man. 😀"))
    assert utterance.track is None
    assert utterance.audio.duration > 0.5


def test_speakers_are_named_by_number_or_name(tmp_path: Path) -> None:
    settings = config(num_speakers=40, speaker_id_map={"amy": 30})
    path = write_voice(tmp_path, settings=settings, speakers=True)

    def heard(speaker: str) -> float:
        utterance = voice(path, speaker).speak((Piece("Mmm", ("M",)),))
        assert utterance.track is not None
        return pitch(
            utterance.audio.read(*utterance.track.word_span(utterance.track.words[0])).samples
        )

    assert heard("") == pytest.approx(tone("m"), abs=8)
    assert heard("#30") == heard("#amy") == pytest.approx(tone("m") + 30, abs=8)
    for wrong in ("#40", "#bob", "#-1", "#²"):
        with pytest.raises(LipwrightError, match=r"has no speaker .*; use 0 to 39.*amy"):
            voice(path, wrong)


def test_a_hash_in_a_files_name_is_part_of_it(tmp_path: Path) -> None:
    assert voice(write_voice(tmp_path, "a#1")).info.name.endswith("a#1.onnx")


def test_the_voice_is_found_by_its_name_and_knows_its_language(tmp_path: Path) -> None:
    path = write_voice(
        tmp_path, settings=config(espeak={"voice": "sv"}, language={"code": "sv_SE"})
    )
    found = find_voice(f"piper:{path}", "sv")
    assert found.info.language == "sv"
    with pytest.raises(LipwrightError, match="speaks sv, not de"):
        find_voice(f"piper:{path}", "de")
    track = found.speak((Piece("Sju sjuka barn på bio"),)).track
    assert track is not None
    assert track.phones[1] == "XH"


def test_without_espeak_the_command_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(espeak, "is_available", lambda: False)
    with pytest.raises(MissingExtraError, match=r"pip install 'lipwright\[piper\]'"):
        voice(write_voice(tmp_path))
    spelled = write_voice(tmp_path, "spelled", config(phoneme_type="text"))
    assert voice(spelled).info.language == "en"


@pytest.mark.parametrize(("name", "message"), [
    ("", "a Piper voice is a file"), ("nothing.onnx", "no such file"), (".", "no such file"),
    ("\0", "is no path"), ("x" * 5000, "no such file"),
])  # fmt: skip
def test_a_missing_voice_is_one_line(name: str, message: str) -> None:
    with pytest.raises(LipwrightError, match=message) as caught:
        back_end().open(name, None)
    assert "\n" not in str(caught.value)


def bare(**fields: Any) -> str:
    content = config()
    for name, value in fields.items():
        if value is None:
            content.pop(name)
        else:
            content[name] = value
    return json.dumps(content)


@pytest.mark.parametrize(("content", "message"), [
    ("", "not JSON"), ("[1, 2]", "not the settings"), ("{}", "'espeak' is missing"),
    ("[" * 100_000, "not JSON"), (bare(audio={}), "'sample_rate' is None"),
    (bare(audio={"sample_rate": 1e9}), "'sample_rate'"), (bare(espeak={}), "'espeak' has no"),
    (bare(espeak=None), "'espeak' is missing"), (bare(phoneme_type="pinyin"), "'phoneme_type'"),
    (bare(phoneme_id_map={"a": "x"}), "no numbers for 'a'"),
    (bare(phoneme_id_map={"a": [1]}), "has no '\\^'"),
    (bare(phoneme_id_map={"a": [-1]}), "no numbers for 'a'"),
    (bare(phoneme_id_map={"a": [True]}), "no numbers for 'a'"),
    (bare(num_speakers="two"), "'num_speakers'"), (bare(speaker_id_map=[1]), "'speaker_id_map'"),
    (bare(inference={"length_scale": "x"}), "'length_scale'"),
    (bare(vowel_clusters=["ab"]), "'vowel_clusters'"),
    (bare(espeak={"voice": "../../etc"}), "has no voice"),
])  # fmt: skip
def test_wrong_settings_name_the_field(tmp_path: Path, content: str, message: str) -> None:
    path = write_voice(tmp_path)
    path.with_name("voice.onnx.json").write_text(content, "utf-8")
    with pytest.raises(LipwrightError, match=message) as caught:
        voice(path)
    assert "\n" not in str(caught.value)


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="this system has no /dev/zero")
def test_settings_without_an_end_are_refused(tmp_path: Path) -> None:
    (tmp_path / "v.onnx").write_bytes(b"x")
    (tmp_path / "v.onnx.json").symlink_to("/dev/zero")
    with pytest.raises(LipwrightError, match="larger than the settings of any voice"):
        find_voice(f"piper:{tmp_path / 'v.onnx'}")


def test_missing_and_huge_settings_are_refused(tmp_path: Path) -> None:
    path = write_voice(tmp_path)
    settings_file = path.with_name("voice.onnx.json")
    settings_file.write_bytes(b" " * (5 << 20))
    with pytest.raises(LipwrightError, match="is larger than"):
        voice(path)
    settings_file.unlink()
    with pytest.raises(LipwrightError, match="is missing beside"):
        voice(path)


def changed(change: str) -> bytes:
    model = piper_voice.model()
    if change == "other inputs":
        model.graph.input.pop()
    elif change == "external":
        tensor = model.graph.initializer[0]
        tensor.ClearField("raw_data")
        tensor.data_location = onnx.TensorProto.EXTERNAL
        tensor.external_data.add(key="location", value="../../../etc/passwd")
    elif change == "unknown step":
        model.graph.node[0].op_type = "Nonsense"
    elif change == "nan":
        model.graph.node.insert(0, onnx.helper.make_node("Div", ["zero", "zero"], ["nan"]))
        next(n for n in model.graph.node if n.output[0] == "quiet_wave").input[1] = "nan"
    content: bytes = model.SerializeToString()
    return content


@pytest.mark.parametrize(("content", "message"), [
    (b"", "not an ONNX model"), (b"nonsense" * 100, "not an ONNX model"),
    (b"\x80\x04\x95pickle", "not an ONNX model"), (changed("")[:-500], "not an ONNX|cannot run"),
    (changed("other inputs"), "inputs|cannot run"), (changed("external"), "weights in other files"),
    (changed("unknown step"), "cannot run"),
])  # fmt: skip
def test_a_file_that_is_no_voice_is_one_line(tmp_path: Path, content: bytes, message: str) -> None:
    path = write_voice(tmp_path)
    path.write_bytes(content)
    with pytest.raises(LipwrightError, match=message) as caught:
        voice(path)
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)


def test_a_sound_that_is_not_finite_is_refused(tmp_path: Path) -> None:
    path = write_voice(tmp_path)
    path.write_bytes(changed("nan"))
    with pytest.raises(LipwrightError, match="empty or not finite"):
        said(path, Piece("Bob"))


def test_numbers_that_the_network_lacks_are_one_line(tmp_path: Path) -> None:
    ids = {**piper_voice.IDS, "b": [9000]}
    with pytest.raises(LipwrightError, match="the voice fails"):
        said(write_voice(tmp_path, settings=config(phoneme_id_map=ids)), Piece("Bob"))


@pytest.mark.parametrize("text", ["...", "\n", "[[", "   ", "—"])
def test_nothing_to_say_is_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(LipwrightError, match="finds nothing to say"):
        said(write_voice(tmp_path), Piece(text))


def test_control_characters_are_refused_with_their_place(tmp_path: Path) -> None:
    with pytest.raises(LipwrightError, match="page: line 4, column 3: the character U\\+0007"):
        voice(write_voice(tmp_path)).speak((Piece("one\nab\7", line=3),), "page")


@settings(max_examples=12)
@given(st.text(st.sampled_from("Bob my,.?! 12-'’[]<>&😀éß\n"), min_size=1, max_size=40))
def test_any_text_gives_a_track_of_its_closures_or_nothing_to_say(text: str) -> None:
    speaker = _shared_voice()
    try:
        track = speaker.speak((Piece(text),)).track
    except LipwrightError as error:
        assert "nothing to say" in str(error)  # noqa: PT017
        return
    assert track is not None
    (piece,) = written_out((Piece(text),), "en")
    ipa = espeak.to_ipa(piece.text, "en-us")
    wanted = [sound.phone for sound in read_ipa(re.sub(r"\s", " ", ipa))]
    assert [one for one in track.phones if one in BILABIALS] == [
        one for one in wanted if one in BILABIALS
    ]


def _shared_voice(made: dict[str, PiperVoice] = {}) -> PiperVoice:  # noqa: B006
    if not made:
        import tempfile

        with tempfile.TemporaryDirectory() as folder:
            made["voice"] = voice(write_voice(Path(folder)))
    return made["voice"]


def test_contents_are_those_that_onnx_reads() -> None:
    model = piper_voice.model(shown=True)
    contents = read_contents(model.SerializeToString())
    assert contents.outputs == ("output", "durations")
    assert [node.op_type for node in contents.nodes] == [node.op_type for node in model.graph.node]
    assert [node.inputs for node in contents.nodes] == [
        tuple(node.input) for node in model.graph.node
    ]
    assert not contents.needs_files
    assert len(SYMBOLS) == len(set(SYMBOLS))
