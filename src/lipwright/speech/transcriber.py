"""Words of a recording, by faster-whisper (extra `asr`) and a model that the user has.

A model is a folder in the layout of CTranslate2: model.bin, config.json, tokenizer.json and a
vocabulary. Nothing is downloaded here but by `fetch_model`, which somebody must ask for.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from lipwright.errors import LipwrightError, MissingExtraError

if TYPE_CHECKING:
    from lipwright.audio import Sound
    from lipwright.speech.aligner import Progress

MODEL_VARIABLE: Final = "LIPWRIGHT_ASR_MODEL"
_NEEDED: Final = ("model.bin", "config.json", "tokenizer.json")  # or the library would fetch one

# Which of the models on this machine is taken where none is named: from small, whose words are
# good enough to align, downwards, since they are faster; then the larger ones.
_PREFERRED: Final = (
    "small", "small.en", "base", "base.en", "tiny", "tiny.en", "medium", "medium.en", "turbo",
    "large-v3-turbo", "distil-large-v3", "large-v3", "large-v2", "large-v1",
)  # fmt: skip

_TO_WHISPER: Final = {"cmn": "zh", "en-gb": "en"}
_BEAM: Final = 5
_RATE: Final = 16000  # Hz, what Whisper hears


@dataclass(frozen=True)
class Transcript:
    """What was recognised."""

    text: str
    """the words, a stretch of speech a line; "" where none were heard"""
    language: str
    """code of the language, as `lipwright.language` knows it"""
    confidence: float
    """0 to 1, the probability of the words by the model, averaged over time"""
    notes: tuple[str, ...] = ()
    """what the user should know, a line each"""


def is_available() -> bool:
    """Whether the extra `asr` is installed."""
    return find_spec("faster_whisper") is not None


def find_model(wanted: str | os.PathLike[str] | None = None, *, needed: bool = False) -> str | None:
    """The folder of a model on this machine; None where there is none and none is needed.

    Args:
        wanted: a folder, or the name of a model that was fetched before; by default what
            $LIPWRIGHT_ASR_MODEL says, or the best that is here.
        needed: whether it is an error that there is none.

    Raises:
        LipwrightError: it is not here, or the extra is missing though the model is needed.
    """
    wanted = wanted or os.environ.get(MODEL_VARIABLE) or None
    if not is_available():
        if needed or wanted is not None:
            raise MissingExtraError("faster-whisper, which recognises words,", "asr")
        return None
    if wanted is not None and Path(wanted).is_dir():
        return _checked(Path(wanted))
    fetched = fetched_models()
    if wanted is not None:
        name = os.fspath(wanted)
        if name in fetched:
            return _checked(fetched[name])
        raise LipwrightError(_not_here(name, fetched))
    best = next((name for name in _PREFERRED if name in fetched), None)
    if best is not None:
        return _checked(fetched[best])
    if needed:
        raise LipwrightError(
            "no model that recognises words is on this machine; name a folder with --asr-model, or "
            "fetch one with: lipwright asr fetch small"
        )
    return None


def _not_here(name: str, fetched: dict[str, Path]) -> str:
    known = f"; here are: {', '.join(sorted(fetched))}" if fetched else ""
    if os.sep in name or name.startswith("."):
        return f"--asr-model {name}: no such folder; name the folder of a model{known}"
    return (
        f"--asr-model {name}: no such folder, and no model of this name is on this machine{known}; "
        f"fetch it with: lipwright asr fetch {name}"
    )


def _checked(folder: Path) -> str:
    """The folder, if a model is in it and nothing would have to be downloaded for it."""
    missing = [name for name in _NEEDED if not (folder / name).is_file()]
    if missing:
        raise LipwrightError(
            f"{folder}: no model that recognises words: it lacks {', '.join(missing)}; name a "
            "folder in the layout of CTranslate2"
        )
    return str(folder)


def _hub() -> Path:
    """Where the download of faster-whisper keeps its models."""
    own = os.environ.get("HF_HUB_CACHE")
    if own:
        return Path(own)
    home = os.environ.get("HF_HOME")
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return (Path(home) if home else cache / "huggingface") / "hub"


def fetched_models() -> dict[str, Path]:
    """Name to folder of the models on this machine, which were downloaded before."""
    found = {}
    for model in sorted(_hub().glob("models--*--faster-*whisper-*/snapshots/*/model.bin")):
        repository = model.parents[2].name.rpartition("--")[2]
        found[repository.replace("faster-", "").replace("whisper-", "")] = model.parent
    return found


def fetch_model(name: str) -> str:
    """Download a model by its name, such as "small", and return its folder.

    Raises:
        LipwrightError: there is no such model, it cannot be fetched, or the extra is missing.
    """
    if not is_available():
        raise MissingExtraError("faster-whisper, which recognises words,", "asr")
    from faster_whisper import available_models, download_model

    if name not in available_models():
        raise LipwrightError(f"unknown model {name!r}; use one of: {', '.join(available_models())}")
    try:
        return _checked(Path(download_model(name)))
    except LipwrightError:
        raise
    except Exception as error:  # the library's own, of its network package and of the disk
        reason = str(error).strip().splitlines()[:1] or [type(error).__name__]
        raise LipwrightError(
            f"the model {name!r} could not be fetched: {reason[0]}; check the network, or fetch "
            "its folder elsewhere and name it with --asr-model"
        ) from error


def transcribe(
    sound: Sound, model: str, language: str | None = None, progress: Progress | None = None
) -> Transcript:
    """The words of a sound of 16 kHz; silence and noise are passed over by voice activity.

    Args:
        sound: what is heard.
        model: the folder of `find_model`.
        language: code of the language; None lets the model tell it.
        progress: told how far it is.

    Raises:
        LipwrightError: the model cannot be used, or does not know the language.
    """
    assert sound.rate == _RATE  # the pipeline opens it so
    report = progress or (lambda share: None)
    with _clear_errors(model):
        whisper = _open(model)
        wanted = None if language is None else _TO_WHISPER.get(language, language)
        if wanted is not None and wanted not in whisper.supported_languages:
            raise LipwrightError(
                f"{model}: this model does not recognise {language!r}; name another"
            )
        samples = sound.read(0, sound.duration).samples
        segments, info = whisper.transcribe(
            samples, language=wanted, beam_size=_BEAM, vad_filter=True,
            condition_on_previous_text=False,
        )  # fmt: skip
        lines, weights, scores = [], [], []
        for segment in segments:
            if segment.text.strip():
                lines.append(segment.text.strip())
                weights.append(max(segment.end - segment.start, 0.01))
                scores.append(math.exp(min(segment.avg_logprob, 0.0)))
            report(min(segment.end / max(sound.duration, 0.01), 1.0))
    code = _code_of(info.language, language)
    sure = sum(w * s for w, s in zip(weights, scores, strict=True)) / max(sum(weights), 0.01)
    notes: tuple[str, ...] = ()
    if language is None and lines and info.language_probability < 0.5:
        notes = (f"the language is a guess: {code}; name it with --language",)
    return Transcript("\n".join(lines), code, sure, notes)


def _open(model: str) -> Any:
    from faster_whisper import WhisperModel

    return WhisperModel(model, device="cpu", compute_type="int8", local_files_only=True)


def _code_of(heard: str, asked: str | None) -> str:
    from lipwright.language.codes import resolve_code

    return asked or resolve_code(heard)


@contextmanager
def _clear_errors(model: str) -> Iterator[None]:
    """A damaged model is named, in a line."""
    try:
        yield
    except LipwrightError:
        raise
    except Exception as error:  # its tokenizer raises nothing more special
        reason = (str(error).strip().splitlines() or [type(error).__name__])[0]
        raise LipwrightError(
            f"{model}: the model cannot be used: {reason}; fetch it again, or name another with "
            "--asr-model"
        ) from error
