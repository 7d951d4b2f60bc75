from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from lipwright import espeak
from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.espeak import process
from lipwright.espeak.corrections import CORRECTIONS, corrected
from lipwright.espeak.process import KEEPER, Child, find_library
from lipwright.language.ipa import read_ipa

needs_espeak = pytest.mark.skipif(
    find_library() is None, reason="espeak-ng is not installed: pip install 'lipwright[espeak]'"
)
pytestmark = needs_espeak


def running() -> int:
    """The process that answers now; started if there is none."""
    espeak.version()
    pid = KEEPER.pid()
    assert pid is not None
    return pid


def is_gone(pid: int) -> bool:
    """Whether there is no such process, not even a zombie."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    return False


def test_it_says_its_version_and_over_a_hundred_languages() -> None:
    assert espeak.is_available()
    assert tuple(map(int, espeak.version().split(".")[:2])) >= (1, 52)
    codes = [language.code for language in espeak.languages()]
    assert len(codes) > 100
    assert len(set(codes)) == len(codes)
    assert {"sv", "en-gb", "en-us", "cmn", "cmn-latn-pinyin", "de", "ja"} <= set(codes)
    swedish = next(one for one in espeak.languages() if one.code == "sv")
    assert (swedish.name, swedish.identifier) == ("Swedish", "gmq/sv")


# Wells, "Accents of English" (1982): hello, map; SAOL: sjuk; Xinhua zidian: women, hua, nü.
@pytest.mark.parametrize(("text", "code", "ipa"), [
    ("hello", "en-us", "həlˈoʊ"),
    ("hello", "en-gb", "həlˈəʊ"),
    ("map", "en-us", "mˈæp"),
    ("sjuk", "sv", "ɧˈʉːk"),
    ("wo3men5", "cmn-latn-pinyin", "womˈən"),
    ("hua1", "cmn-latn-pinyin", "hwˈɑ"),
    ("女", "cmn", "nˈy"),
    ("中", "cmn", "ʈʂˈʊŋ"),
])  # fmt: skip
def test_ipa_of_words_is_that_of_the_language(text: str, code: str, ipa: str) -> None:
    bare = str.maketrans("", "", "ː ")
    assert espeak.to_ipa(text, code).translate(bare) == ipa.translate(bare)


def test_many_words_at_once_are_said_as_each_alone() -> None:
    words = ["Bob", "mamma", "12", "", "papa", "naïve"]
    together = espeak.words_to_ipa(words, "en")
    assert together == tuple(espeak.to_ipa(word, "en") for word in words)
    assert together[3] == ""
    assert espeak.words_to_ipa([], "en") == ()


def test_every_language_says_ipa_and_nothing_else() -> None:
    for language in espeak.languages():
        said = espeak.to_ipa("Mama papa 12 Bob, 37 Sharjah amber.", language.code)
        assert bool(read_ipa(said)) == (language.code not in espeak.MUTE), language.code


def test_phonemes_are_parted_where_asked() -> None:
    assert espeak.to_ipa("cheap map", "en-us", "|") == "tʃ|ˈiː|p m|ˈæ|p"
    assert espeak.to_ipa("cheap", "en-us", "|").replace("|", "") == espeak.to_ipa("cheap", "en-us")
    with pytest.raises(ValueError, match="one character"):
        espeak.to_ipa("cheap", "en-us", "--")


def test_marks_of_another_language_are_dropped() -> None:
    said = espeak.to_ipa("我喜欢 weekend。", "cmn")
    assert "(" not in said
    assert "w" in said


@pytest.mark.parametrize("code", sorted(CORRECTIONS))
def test_corrections_are_ipa_of_languages_that_there_are(code: str) -> None:
    assert code in {language.code for language in espeak.languages()}
    for wrong, right in CORRECTIONS[code].items():
        assert read_ipa(right)
        assert corrected("ˈ" + wrong, code) == "ˈ" + right
        assert corrected(wrong, "en-us") in (wrong, wrong.replace("nɡ", "ŋ"))


@pytest.mark.parametrize(("written", "said"), [
    ("ˈɑu2", "ˈɑu"), ("uoɜ5", "wo"), ("yɛɜ", "ɥɛ"), ("ˈɜː", "ˈɜː"), ("ɜ", "ɜ"), ("onɡ55", "ʊŋ"),
])  # fmt: skip
def test_tones_are_no_sounds(written: str, said: str) -> None:
    assert corrected(written, "cmn") == said


def test_speech_has_sound_phones_and_words() -> None:
    speech = espeak.speak("Bob met a man.", "en-us")
    assert speech.rate == 22050
    assert speech.samples.dtype == np.float32
    assert 0.1 < np.abs(speech.samples).max() <= 1
    assert not speech.samples.flags.writeable
    assert [word.position for word in speech.words] == [0, 4, 8, 10]
    starts = [phone.start for phone in speech.phones]
    assert starts == sorted(starts)
    assert starts[-1] <= len(speech.samples) / speech.rate
    assert [phone.label for phone in speech.phones if phone.label] == (
        ["b", "ˈɑː", "b", "m", "ˈɛ", "t", "ɐ", "m", "ˈæ", "n"]
    )
    assert [phone.position for phone in speech.phones][:3] == [0, 0, 0]


def test_what_was_translated_before_takes_no_word_from_what_is_said() -> None:
    letters = " ".join("abcdefghijklmnopqrstuvwxyz")
    for language in espeak.languages():
        espeak.to_ipa(letters, language.code)
    assert espeak.speak("Bob met a man.", "en-us").words[0].position == 0


def test_events_have_mnemonics_where_asked_in_the_same_order() -> None:
    ipa = espeak.speak("Sju sjuka barn i Paris.", "sv")
    mnemonics = espeak.speak("Sju sjuka barn i Paris.", "sv", mnemonics=True)
    assert len(ipa.phones) == len(mnemonics.phones)
    said = [(a.label, b.label) for a, b in zip(ipa.phones, mnemonics.phones, strict=True)]
    assert ("ɧ", "sx") in said


def test_positions_count_characters_of_any_script() -> None:
    text = "Ett 😀 och ett Ö, till."
    words = espeak.speak(text, "sv").words
    assert text[words[-1].position :].startswith("till")


def test_faster_is_shorter_and_pauses_at_the_end_are_made_on_demand() -> None:
    def count(**options: int) -> int:
        return len(espeak.speak("Many words a minute.", "en", **options).samples)

    assert count(words_per_minute=300) < count() < count(words_per_minute=100)
    assert count(end_pause=True) > count() + 2000


# What looks like markup is words, and does not reach what interprets it.
@pytest.mark.parametrize("text", [
    "[[h@l'oU]]", "[[", "]]", "<voice name='en'>x</voice>", "<audio src='/etc/passwd'/>",
    "$(touch x); `ls` | cat > y & rm -rf .", "%s%n%s", "-v en --stdout", "'; DROP TABLE voices",
])  # fmt: skip
def test_markup_and_commands_are_read_as_text(text: str) -> None:
    speech = espeak.speak(f"one {text} two", "en-us")
    labels = "".join(phone.label for phone in speech.phones)
    assert "w" in labels
    assert labels.endswith("tˈuː")
    assert espeak.to_ipa(f"one {text} two", "en-us").endswith("tˈuː")
    assert running()


def test_mnemonics_and_ssml_are_understood_only_where_asked_for_and_not_remembered() -> None:
    def labels(text: str, **options: bool) -> str:
        return "".join(phone.label for phone in espeak.speak(text, "en-us", **options).phones)

    plain = espeak.to_ipa("[[m'ap]]", "en-us")
    tagged = espeak.to_ipa("<break/> no", "en-us")
    assert labels("[[m'ap]]", phoneme_input=True) == "mˈæp"
    assert labels("<speak>no<break time='1s'/></speak>", ssml=True) == "nˈoʊ"
    assert labels("[[m'ap]]") != "mˈæp"
    assert espeak.to_ipa("[[m'ap]]", "en-us") == plain
    assert espeak.to_ipa("<break/> no", "en-us") == tagged


def test_ssml_opens_no_files(tmp_path: Path) -> None:
    import soundfile

    path = tmp_path / "long.wav"
    soundfile.write(path, np.full(22050 * 5, 0.5, np.float32), 22050)
    said = f"<speak>no <audio src='{path}'>sound</audio></speak>"
    assert len(espeak.speak(said, "en-us", ssml=True).samples) < 22050 * 3


@pytest.mark.parametrize("char", ["\0", "\1", "\x1b", "\x7f", "\x85", "\ud800"])
def test_control_characters_are_refused_with_their_place(char: str) -> None:
    for call in (espeak.speak, espeak.to_ipa):
        with pytest.raises(LipwrightError, match="character 4 of") as caught:
            call(f"one{char}two", "en")
        assert "\n" not in str(caught.value)


def test_a_million_characters_are_refused_and_many_are_said() -> None:
    with pytest.raises(LipwrightError, match="in parts of at most 100000"):
        espeak.to_ipa("a" * 1_000_000, "en")
    assert len(espeak.to_ipa("mama " * 1_000, "en")) > 4_000
    assert espeak.to_ipa("b" * 2_000, "en")


def test_more_sound_than_allowed_is_refused_and_the_next_request_is_met(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(espeak, "MAX_SECONDS", 0.5)
    with pytest.raises(LipwrightError, match="more sound"):
        espeak.speak("<speak>a<break time='4000s'/>b</speak>", "en", ssml=True)
    monkeypatch.undo()
    assert espeak.to_ipa("map", "en") == "mˈæp"


@pytest.mark.parametrize("voice", [
    "klingonese", "", "../sv", "/etc/passwd", "sv+../../x", "sv+nobody", "sv+", "sv ", "!v/f2",
    "mb/mb-de1", "sv\n", "x" * 10_000,
])  # fmt: skip
def test_an_unknown_voice_names_the_known_ones(voice: str) -> None:
    with pytest.raises(LipwrightError, match="espeak-ng has no v") as caught:
        espeak.speak("hej", voice)
    assert len(str(caught.value)) < 2000
    assert "sv" in str(caught.value) or "f2" in str(caught.value)


def test_variants_change_the_timbre() -> None:
    assert {"f2", "m3"} <= set(espeak.variants())
    usual, other = (espeak.speak("hej", voice).samples for voice in ("sv", "sv+f2"))
    assert len(usual) != len(other) or not np.array_equal(usual, other)


def test_after_a_crash_one_error_is_given_and_the_next_request_is_met() -> None:
    before = running()
    os.kill(before, signal.SIGKILL)
    with pytest.raises(LipwrightError, match=r"ended unexpectedly \(signal 9\)"):
        espeak.to_ipa("map", "en")
    assert is_gone(before)
    assert espeak.to_ipa("map", "en") == "mˈæp"
    assert running() != before


def test_killed_while_it_works_it_gives_the_same_error() -> None:
    before = running()
    killer = threading.Timer(0.2, os.kill, (before, signal.SIGKILL))
    killer.start()
    with pytest.raises(LipwrightError, match="ended unexpectedly"):
        espeak.speak("A long story about many things. " * 2500, "en")
    killer.join()
    assert is_gone(before)


def test_a_hang_ends_with_one_error_and_the_next_request_is_met(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    before = running()
    os.kill(before, signal.SIGSTOP)
    monkeypatch.setattr(espeak, "_TIMEOUT", 0.2)
    with pytest.raises(LipwrightError, match="did not answer within"):
        espeak.to_ipa("map", "en")
    assert is_gone(before)
    monkeypatch.undo()
    assert espeak.to_ipa("map", "en") == "mˈæp"


def test_threads_share_one_process_and_get_their_own_answers() -> None:
    words = [f"{name} {number}" for number in range(20) for name in ("map", "bob", "tip")]
    alone = [espeak.to_ipa(word, "en") for word in words]
    pid = running()
    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(lambda word: espeak.to_ipa(word, "en"), words)) == alone
    assert running() == pid


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_forked_process_starts_its_own() -> None:
    code = (
        "import os, sys\n"
        "from lipwright import espeak\n"
        "from lipwright.espeak.process import KEEPER\n"
        "espeak.version(); before = KEEPER.pid()\n"
        "child = os.fork()\n"
        "same = espeak.to_ipa('map', 'en') == 'mˈæp'\n"
        "if child == 0:\n"
        "    KEEPER.stop(); os._exit(0 if same and before != KEEPER.pid() else 1)\n"
        "status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])\n"
        "sys.exit(status or not (same and KEEPER.pid() == before))\n"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False, timeout=60).returncode == 0


def test_nothing_is_left_when_the_program_ends() -> None:
    code = (
        "from lipwright import espeak\nfrom lipwright.espeak.process import KEEPER\n"
        "espeak.version(); print(KEEPER.pid())"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr == ""
    deadline = time.monotonic() + 10
    while not is_gone(int(done.stdout)) and time.monotonic() < deadline:
        time.sleep(0.01)
    assert is_gone(int(done.stdout))


def test_our_process_never_loads_the_library() -> None:
    code = (
        "from lipwright import espeak\nespeak.speak('map', 'en')\n"
        "maps = open('/proc/self/maps').read()\nassert 'espeak' not in maps, maps"
    )
    if not Path("/proc/self/maps").exists():
        pytest.skip("no list of loaded libraries here")
    subprocess.run([sys.executable, "-c", code], check=True)


def test_the_process_needs_no_package() -> None:
    script = Path(process.__file__).with_name("child.py").read_text("utf-8")
    assert "import numpy" not in script
    assert "lipwright" not in script.replace("`lipwright.espeak.process`", "")


def test_without_the_library_the_error_has_the_command(monkeypatch: pytest.MonkeyPatch) -> None:
    KEEPER.stop()
    monkeypatch.setattr(process, "find_library", lambda: None)
    monkeypatch.setattr(espeak, "find_library", lambda: None)
    assert not espeak.is_available()
    with pytest.raises(MissingExtraError, match=r"pip install 'lipwright\[espeak\]'"):
        espeak.version()
    with pytest.raises(MissingExtraError):
        KEEPER.ask({"verb": "voices"}, 1)


def test_a_damaged_library_is_one_line(tmp_path: Path) -> None:
    fake = tmp_path / "libespeak-ng.so"
    fake.write_bytes(b"not a library")
    with pytest.raises(LipwrightError, match="cannot be loaded") as caught:
        Child(str(fake), "")
    assert "\n" not in str(caught.value)


def test_data_that_is_missing_is_one_line(tmp_path: Path) -> None:
    found = find_library()
    assert found is not None
    (tmp_path / "espeak-ng-data").mkdir()
    with pytest.raises(LipwrightError, match="cannot be loaded") as caught:
        Child(found[0], str(tmp_path / "espeak-ng-data"))
    assert "\n" not in str(caught.value)


def test_data_in_a_folder_with_a_long_name_is_found(tmp_path: Path) -> None:
    found = find_library()
    assert found is not None
    if not found[1]:
        pytest.skip("the system's library has data of its own")
    deep = tmp_path / ("å" * 60) / ("b" * 120)
    deep.mkdir(parents=True)
    (deep / "espeak-ng-data").symlink_to(found[1])
    child = Child(found[0], str(deep / "espeak-ng-data"))
    try:
        assert child.version == espeak.version()
    finally:
        child.stop()


def test_an_older_library_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = find_library()
    assert found is not None
    monkeypatch.setattr(process, "OLDEST", (99, 0))
    with pytest.raises(LipwrightError, match=r"is too old, 99\.0 or later is needed; run: pip"):
        Child(*found)
    old = Path("/usr/lib/x86_64-linux-gnu/libespeak-ng.so.1.1.51")
    if old.exists():
        monkeypatch.undo()
        with pytest.raises(LipwrightError, match=r"1\.51 is too old"):
            Child(str(old), "")
