"""Recordings without words: a second implementation, real speech, other sounds, planted answers."""

import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lipwright.audio import Audio, read_audio, resampled
from lipwright.errors import LipwrightError
from lipwright.language import get_language
from lipwright.phones import BILABIALS, PHONES, SILENCE
from lipwright.speech import align
from lipwright.speech.conformer import load_weights, log_probabilities
from lipwright.speech.decoding import decode
from lipwright.speech.features import Floats
from lipwright.speech.listening import Heard, listen
from lipwright.speech.pieces import cut
from lipwright.speech.recogniser import NOTHING, WORD_END, recognise, symbols
from lipwright.speech.utterances import TimedPhone, confidence, unsure_stretches, utterances
from lipwright.track import PhoneTrack

ROOT = Path(__file__).resolve().parents[1]
HELLO = ROOT / "examples" / "hello.flac"
CORPORA = ROOT.parent / "shared" / "corpora"
RATE = 16000

needs_corpora = pytest.mark.skipif(not CORPORA.is_dir(), reason="the recordings are not there")


@cache
def bench(name: str) -> ModuleType:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT / "bench"))
        __import__(name)
        return sys.modules[name]


@cache
def hello() -> Audio:
    return resampled(read_audio(HELLO), RATE)


@cache
def heard() -> Heard:
    return listen(hello())


def aligned(sound: Audio, text: str) -> PhoneTrack:
    return align(sound, get_language("en").normalize(text)).track


def under(
    speech: Audio, other: np.ndarray[tuple[int], np.dtype[np.float64]], ratio: float
) -> Audio:
    bed = np.resize(other, len(speech))
    gain = np.sqrt(np.mean(speech.samples**2) / np.mean(bed**2) / 10 ** (ratio / 10))
    return Audio(np.clip(speech.samples + gain * bed, -1, 1).astype(np.float32), speech.rate)


def test_the_network_gives_what_hamas_own_engine_gives() -> None:
    from hama.asr import ASRModel

    samples = np.array(hello().read(0.0, 3.0).samples)
    theirs = ASRModel().session.run(["log_probs"], {"waveform": samples[None]})[0][0]
    ours = log_probabilities(samples)
    assert ours.shape == theirs.shape
    assert np.abs(np.exp(ours) - np.exp(theirs)).max() < 5e-3
    assert (ours.argmax(axis=1) == theirs.argmax(axis=1)).all()


def test_each_symbol_is_of_the_phone_table() -> None:
    names, columns = symbols()
    assert names[-2:] == (WORD_END, NOTHING)
    assert set(names[:-2]) <= set(PHONES) - {SILENCE}
    assert {"P", "B", "M", "F", "V", "W", "UW", "OW", "SH", "CH", "AA", "IY"} <= set(names)
    assert len(columns) == 191
    assert columns.max() < len(names)


def test_probabilities_of_all_symbols_sum_to_one() -> None:
    rows = recognise(hello(), 0.0, 2.0)
    np.testing.assert_allclose(np.exp(rows).sum(axis=1), 1.0, atol=1e-3)


def test_phones_are_found_without_words_where_the_aligner_puts_them_with_words() -> None:
    reference = aligned(hello(), HELLO.with_suffix(".txt").read_text())
    errors = bench("phone_errors").PhoneErrors.of([(reference, heard().alignment.track)])
    assert sum(errors.rate()) < 0.25
    recall, precision = errors.bilabials()
    assert recall >= 0.9
    assert precision >= 0.9
    assert np.median(np.abs(errors.edges)) < 0.02


def test_a_heard_track_covers_the_sound_and_needs_no_note() -> None:
    result = heard()
    assert result.path == "phones"
    assert result.alignment.track.start == 0.0
    assert result.alignment.track.end == pytest.approx(hello().duration)
    assert 0.7 < result.confidence <= 1.0
    assert result.notes == ()


@needs_corpora
def test_other_speakers_are_understood_too() -> None:
    for name in ("msajc003", "msajc022"):
        path = CORPORA / "aligned-phones" / f"{name}.flac"
        sound = resampled(read_audio(path), RATE)
        reference = aligned(sound, path.with_suffix(".txt").read_text())
        errors = bench("phone_errors").PhoneErrors.of([(reference, listen(sound).alignment.track)])
        assert sum(errors.rate()) < 0.35
        assert errors.bilabials() == (1.0, 1.0)


@pytest.mark.parametrize("gain", [0.003, 0.2])
def test_loudness_does_not_matter(gain: float) -> None:
    sound = hello().read(1.4, 3.6)
    quiet = Audio((sound.samples * np.float32(gain)).astype(np.float32), RATE)
    assert listen(quiet).alignment.track.phones == listen(sound).alignment.track.phones


def test_another_rate_gives_the_same_phones() -> None:
    sound = hello().read(1.4, 3.6)
    errors = bench("phone_errors").PhoneErrors.of(
        [(listen(sound).alignment.track, listen(resampled(sound, 44100)).alignment.track)]
    )
    assert sum(errors.rate()) < 0.1


SOUNDS = (
    "breath", "hum", "pink noise", "melody", "tone", "drums", "chords", "music", "fiddle", "clicks",
)  # fmt: skip


@pytest.mark.parametrize("name", SOUNDS)
def test_other_sounds_are_no_speech(name: str) -> None:
    samples = bench("other_sounds").OTHER_SOUNDS[name](4.0).astype(np.float32)
    with pytest.raises(LipwrightError, match="sounds like speech") as error:
        listen(Audio(samples, RATE))
    assert "--text" in str(error.value)
    assert "\n" not in str(error.value)


def test_laughter_shuts_no_lips() -> None:
    samples = bench("other_sounds").OTHER_SOUNDS["laughter"](5.0).astype(np.float32)
    result = listen(Audio(samples, RATE))
    assert not BILABIALS & set(result.alignment.track.phones)
    assert result.confidence < 0.4
    assert "likely to be right" in result.notes[0]


@pytest.mark.parametrize("count", [0, 1, 100, 161, 401, 800])
def test_next_to_no_sound_is_refused(count: int) -> None:
    noise = 0.1 * np.random.default_rng(0).standard_normal(count)
    with pytest.raises(LipwrightError, match="nothing that sounds like speech"):
        listen(Audio(noise.astype(np.float32), RATE))


@pytest.mark.parametrize("value", [0.0, 0.5])
def test_digital_silence_is_refused(value: float) -> None:
    with pytest.raises(LipwrightError, match="nothing that sounds like speech"):
        listen(Audio(np.full(RATE, value, np.float32), RATE))


def test_music_under_speech_costs_confidence_and_not_all_phones() -> None:
    tune = bench("other_sounds").music(8.0)
    reference = heard().alignment.track
    sure = [heard().confidence]
    for ratio, most in ((20, 0.15), (10, 0.3), (0, 0.8)):
        mixed = listen(under(hello(), tune, ratio))
        errors = bench("phone_errors").PhoneErrors.of([(reference, mixed.alignment.track)])
        assert sum(errors.rate()) < most
        sure.append(mixed.confidence)
    assert sure[-1] < min(sure[:-1]) - 0.05


def test_the_mouth_rests_in_music_before_and_after_speech() -> None:
    tune = bench("other_sounds").music(5.0)
    samples = np.concatenate([tune, hello().samples, tune]).astype(np.float32)
    result = listen(Audio(samples, RATE))
    said = [(s, e) for phone, s, e in result.alignment.track if phone != SILENCE]
    assert said[0][0] > 4.5
    assert said[-1][1] < 5.5 + hello().duration
    assert result.notes[0].startswith("from 0.0 to")
    assert len(result.notes) == 2


def test_languages_that_the_recogniser_never_learnt_are_a_guess() -> None:
    result = listen(hello().read(1.4, 3.6), "sv")
    assert result.language == "sv"
    assert "rough guess" in result.notes[0]


def test_progress_rises_to_the_end() -> None:
    shares: list[float] = []
    listen(hello(), progress=shares.append)
    assert shares == sorted(shares)
    assert 0 <= shares[0] < 0.5
    assert shares[-1] == pytest.approx(1.0)


def row(**probabilities: float) -> Floats:
    names, _ = symbols()
    values = np.full(len(names), 1e-6, np.float32)
    for name, probability in probabilities.items():
        values[names.index({"nothing": NOTHING, "end": WORD_END}.get(name, name))] = probability
    return np.log(values)


def test_repeated_rows_are_one_phone_and_nothing_parts_equal_phones() -> None:
    rows = [row(nothing=0.9), row(S=0.8), row(S=0.9), row(nothing=0.9), row(S=0.7), row(end=0.9)]
    found = decode(np.stack(rows))
    assert [(p.symbol, p.frame, p.ends_word) for p in found] == [("S", 1, False), ("S", 4, True)]
    assert [p.probability for p in found] == pytest.approx([0.9, 0.7])


def test_lips_do_not_shut_where_that_is_unlikely() -> None:
    assert [p.symbol for p in decode(np.stack([row(M=0.44, N=0.3)]))] == ["N"]
    assert [p.symbol for p in decode(np.stack([row(M=0.46, N=0.3)]))] == ["M"]
    assert decode(np.stack([row(M=0.44, nothing=0.3)])) == []


def test_a_closure_counts_whichever_of_p_b_and_m_it_is() -> None:
    found = decode(np.stack([row(P=0.25, B=0.3, nothing=0.4)]))
    assert [p.symbol for p in found] == ["B"]
    assert found[0].probability == pytest.approx(0.55, abs=1e-4)


def timed(*phones: tuple[str, float, float]) -> list[TimedPhone]:
    return [TimedPhone(symbol, time, sure, False) for symbol, time, sure in phones]


def test_phones_far_apart_are_other_utterances_and_unsure_ones_no_speech() -> None:
    said = utterances(timed(("S", 0.0, 0.9), ("AA", 0.2, 0.9), ("T", 0.6, 0.9), ("P", 2.0, 0.7),
                            ("K", 4.0, 0.3), ("AA", 4.1, 0.2)))  # fmt: skip
    assert [u.is_speech for u in said] == [True, False, False]
    assert said[0].words() == [["S", "AA"], ["T"]]


def test_confidence_is_a_share() -> None:
    assert confidence(timed(("S", 0.0, 1.0))) == pytest.approx(0.92)
    assert confidence(timed(("S", 0.0, 0.1))) == 0.0


@given(st.lists(st.tuples(st.booleans(), st.integers(1, 2500)), min_size=1, max_size=6))
def test_pieces_cover_what_is_active_once_and_are_short(runs: list[tuple[bool, int]]) -> None:
    active = np.concatenate([np.full(count, on) for on, count in runs])
    level = np.random.default_rng(0).standard_normal(len(active))
    covered = np.zeros(len(active), int)
    for start, stop in cut(level, active):
        assert 0 < stop - start <= 1000
        covered[start:stop] += 1
    np.testing.assert_array_equal(covered, active.astype(int))


def broken(change: Callable[[bytes], bytes], folder: Path) -> Path:
    from lipwright.speech.conformer import weights_path

    path = weights_path()
    assert path is not None
    (folder / "asr_waveform.hama").write_bytes(change(path.read_bytes()))
    return folder / "asr_waveform.hama"


@pytest.mark.parametrize(
    "change",
    [
        lambda data: b"other" + data,
        lambda data: data[:5000],
        lambda data: data.replace(b"Conv_801", b"Conv_901"),
    ],
)
def test_weights_that_cannot_be_read_are_left_to_hamas_own_engine(
    change: Callable[[bytes], bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    samples = np.array(hello().read(0.0, 2.0).samples)
    ours = log_probabilities(samples)
    path = broken(change, tmp_path)
    monkeypatch.setattr("lipwright.speech.conformer.weights_path", lambda: path)
    load_weights.cache_clear()
    try:
        assert load_weights() is None
        theirs = log_probabilities(samples)
    finally:
        load_weights.cache_clear()
    assert np.abs(np.exp(ours) - np.exp(theirs)).max() < 5e-3


def test_without_hama_the_remedy_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lipwright.speech.conformer.weights_path", lambda: None)
    load_weights.cache_clear()
    with pytest.raises(LipwrightError, match="pip install"):
        load_weights()


def test_a_phone_of_two_units_keeps_both_and_is_one_phone() -> None:
    from lipwright.speech.acoustic import load_model
    from lipwright.speech.recording import spectra, static_features
    from lipwright.speech.retiming import place_phones
    from lipwright.speech.scores import Scores
    from lipwright.speech.units import units_of

    assert units_of("XTS") == ("T", "S")
    sound = hello().read(1.4, 3.6)
    scores = Scores(load_model(), static_features(spectra(sound)))
    scores.hear(len(scores))
    both = place_phones([["XTS", "AA"], ["M"]], scores, 20, 200)
    parts = place_phones([["T", "S", "AA"], ["M"]], scores, 20, 200)
    assert [p.symbol for p in both] == ["XTS", "AA", "M"]
    assert (both[0].start, both[0].stop) == (parts[0].start, parts[1].stop)
    assert [(p.start, p.stop) for p in both[1:]] == [(p.start, p.stop) for p in parts[2:]]
    assert place_phones([["XTS"]], scores, 20, 25) == []


def test_stretches_of_unsure_phones_are_named() -> None:
    rows = [TimedPhone("AA", 0.2 * i, 0.4 if 50 <= i < 75 else 0.9, False) for i in range(120)]
    ((start, end, sure),) = unsure_stretches(rows)
    assert (start, end) == (pytest.approx(10.0), pytest.approx(14.8))
    assert sure == pytest.approx(confidence(rows[50:75]))
    assert unsure_stretches(rows[:40]) == []


def test_music_under_some_of_the_speech_is_noted_with_its_place() -> None:
    tune = bench("other_sounds").music(10.0)
    part = under(hello(), tune, -6)
    sound = np.concatenate([hello().samples, hello().samples, part.samples, hello().samples])
    notes = [n for n in listen(Audio(sound, RATE)).notes if "likely to be right" in n]
    assert len(notes) == 1
    start, end = (float(word) for word in notes[0].split()[1:4:2])
    first, last = 2 * hello().duration, 3 * hello().duration
    assert first - 5 < start < end < last + 5


def test_speech_that_music_masks_is_noted_though_the_recogniser_is_rather_sure() -> None:
    result = listen(under(hello(), bench("other_sounds").music(8.0), -1))
    assert 0.65 < result.confidence < 0.8
    assert "likely to be right" in result.notes[0]
