"""Words of recordings: faster-whisper itself, with a model that says planted words."""

from __future__ import annotations

from pathlib import Path
from unittest import mock

import numpy as np
import pytest

from lipwright.audio import Audio, open_audio
from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.pipeline import AlignOptions, hear_speech
from lipwright.speech import transcriber
from lipwright.speech.transcriber import find_model, transcribe
from planted_whisper import plant
from test_cli import assert_refused, lipwright

pytest.importorskip("faster_whisper", reason="the extra asr is not installed")

ROOT = Path(__file__).resolve().parents[1]
HELLO = ROOT / "examples" / "hello.flac"
WORDS = " ".join((ROOT / "examples" / "hello.txt").read_text("utf-8").split())


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return plant(tmp_path_factory.mktemp("whisper") / "planted", WORDS, 9.0)


@pytest.fixture(autouse=True)
def _no_models_of_the_user(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("HF_HUB_CACHE", str(tmp_path / "hub"))
    monkeypatch.delenv(transcriber.MODEL_VARIABLE, raising=False)


def test_words_are_heard_and_aligned(model: Path) -> None:
    heard = hear_speech(HELLO, AlignOptions(asr_model=model))
    assert heard.path == "words"
    assert heard.text == WORDS
    said = [word.text for word in heard.alignment.track.words]
    assert said[:6] == ["hello", "i", "am", "a", "face", "made"]
    assert 0 < heard.confidence <= 1


def test_the_command_says_how_it_heard(model: Path, tmp_path: Path) -> None:
    run = lipwright("animate", HELLO, "--asr-model", model, "-o", "a.csv", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    told = run.stderr.decode()
    assert "words were recognised and aligned (confidence 0." in told
    assert "26 words" in told
    assert (tmp_path / "a.csv").is_file()


def test_words_that_do_not_fit_the_sound_give_way_to_phones(tmp_path: Path) -> None:
    other = plant(tmp_path / "other", "completely different things were said here long ago", 9.0)
    heard = hear_speech(HELLO, AlignOptions(asr_model=other))
    assert heard.path == "phones"
    assert any("were dropped" in note for note in heard.notes)
    with pytest.raises(LipwrightError, match="the text does not fit the sound"):
        hear_speech(HELLO, AlignOptions(asr_model=other, recogniser="words"))


def test_silence_has_no_words(model: Path) -> None:
    hiss = np.random.default_rng(0).standard_normal(16000 * 4).astype(np.float32) * 1e-4
    assert transcribe(Audio(hiss, 16000), str(model)).text == ""


def test_the_language_of_the_words_is_what_was_asked_for(model: Path) -> None:
    with open_audio(HELLO, 16000) as sound:
        assert transcribe(sound, str(model)).language == "en"
        assert transcribe(sound, str(model), "en-gb").language == "en-gb"
        with pytest.raises(LipwrightError, match="this model does not recognise 'sv'"):
            transcribe(sound, str(model), "sv")


def test_a_model_is_found_in_the_cache_by_its_name(model: Path, tmp_path: Path) -> None:
    place = tmp_path / "hub" / "models--Systran--faster-whisper-tiny.en" / "snapshots" / "1"
    place.parent.mkdir(parents=True)
    place.symlink_to(model)
    assert find_model() == str(place)
    assert find_model("tiny.en") == str(place)
    with pytest.raises(LipwrightError, match=r"here are: tiny\.en; fetch it with: lipwright asr"):
        find_model("base")


def test_without_a_model_phones_are_heard_and_words_are_refused(tmp_path: Path) -> None:
    assert find_model() is None
    run = lipwright("animate", HELLO, "--listen", "words", "-o", "a.csv", cwd=tmp_path)
    assert_refused(run, "no model that recognises words", "lipwright asr fetch small")
    assert list(tmp_path.glob("a.*")) == []


@pytest.mark.parametrize("name", ["model.bin", "config.json", "tokenizer.json"])
def test_a_damaged_model_is_named(model: Path, tmp_path: Path, name: str) -> None:
    damaged = tmp_path / "damaged"
    damaged.mkdir()
    for file in model.iterdir():
        (damaged / file.name).write_bytes(file.read_bytes())
    (damaged / name).write_bytes(b"nonsense")
    with open_audio(HELLO, 16000) as sound, pytest.raises(LipwrightError) as caught:
        transcribe(sound, str(find_model(damaged)))
    assert str(damaged) in str(caught.value)
    (damaged / name).unlink()
    with pytest.raises(LipwrightError, match=f"it lacks {name}"):
        find_model(damaged)


def test_the_missing_extra_names_its_command() -> None:
    with mock.patch.object(transcriber, "is_available", return_value=False):
        assert find_model() is None
        with pytest.raises(MissingExtraError, match=r"pip install 'lipwright\[asr\]'"):
            find_model(needed=True)


def test_an_unknown_model_is_not_fetched() -> None:
    with pytest.raises(LipwrightError, match="unknown model 'enormous'; use one of: tiny"):
        transcriber.fetch_model("enormous")
