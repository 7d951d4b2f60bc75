"""The English voices of hibari, whose model tells how long each phone lasts."""

from __future__ import annotations

import json
import os
import sys
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache, cached_property, lru_cache
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError
from lipwright.language import LANGUAGES, get_language
from lipwright.onnx_session import open_session
from lipwright.phones import SILENCE
from lipwright.speech.voices.hibari_text import G2P, Line, script_lines
from lipwright.speech.voices.hibari_times import FRAME, LAG, RATE, time_line
from lipwright.speech.voices.onnx_outputs import input_of, with_output
from lipwright.speech.voices.stretching import stretch
from lipwright.speech.voices.timeline import Samples, Stretch, Timed, Timeline
from lipwright.speech.voices.values import Emphasis, Script, Utterance, VoiceInfo

if TYPE_CHECKING:
    from lipwright.speech.aligner import Progress

NAME: Final = "hibari"
SEED: Final = 0  # of the noise in its sound: the same text sounds the same every time
_TURNED_INTO_FRAMES: Final = "CumSum"

# Beyond this rate more and more phones last one FRAME, which they cannot fall under: at 2 a
# sentence takes 0.57 of its usual time, at 4 0.44. What is faster is said so and made shorter.
_FASTEST: Final = 1.5
_JOIN, _COMMA = 0.04, 0.25  # s of silence where the rate changes inside a phrase, or at a comma
"""the model's only node of this kind counts up the frames of the letters"""
_MAGNITUDES: Final = (0, 2, 3)  # outputs that are natural logarithms, as `hibari.dsp.synth` says
_PITCH: Final = 5  # output in Hz
_MOST_LINES_AT_ONCE: Final = 4  # threads
_OPENING: Final = threading.Lock()  # hibari is imported by one thread; see `_without_scipy_fft`
_STEPS: Final = 2  # of `hibari.dsp.HOP` in a FRAME
_RAMP: Final = 4  # steps in which a word's emphasis comes and goes: 50 ms


@dataclass(frozen=True)
class _Manner:
    """What emphasis changes."""

    gain: float
    """dB"""
    pitch: float
    """factor"""


# Ours, by ear: SSML 1.1 leaves it to the voice; prominent syllables of English are a few dB louder
# and 1 to 4 semitones higher (Fry 1958; Kochanski et al. 2005).
_MANNERS: Final = MappingProxyType[Emphasis, _Manner]({
    "reduced": _Manner(-3.0, 0.94), "moderate": _Manner(1.5, 1.08), "strong": _Manner(3.0, 1.16),
})  # fmt: skip


class HibariVoice:
    """A voice of hibari; made by `HibariBackEnd.open`."""

    def __init__(self, info: VoiceInfo, model: Path, british: bool) -> None:
        """`model` is the voice's ONNX file."""
        self._info, self._model, self._british = info, model, british
        # The model is read by threads of its own while Python reads the lexicon.
        with ThreadPoolExecutor(1) as pool:
            session = pool.submit(self._open_session)
            self._g2p = _load_g2p(british)
            self._session = session.result()

    @property
    def info(self) -> VoiceInfo:
        """Its name and language."""
        return self._info

    def speak(
        self, script: Script, source: str = "text", progress: Progress | None = None
    ) -> Utterance:
        """Say the script, as `Voice.speak` describes it.

        Breaks last as long as they ask for, from the last phone before to the first one after.

        Raises:
            LipwrightError: nothing is said, or letters are not English.
        """
        code = self._info.language if self._info.language in LANGUAGES else "en"
        known = frozenset(self._vocabulary)
        before, lines = script_lines(script, get_language(code), self._g2p, known, source)
        timeline = Timeline(RATE)
        tail: Samples = np.zeros(0, np.float32)
        pause = before or None
        with ThreadPoolExecutor(min(os.cpu_count() or 1, _MOST_LINES_AT_ONCE)) as pool:
            said = pool.map(self._say, lines, range(1, len(lines) + 1))
            for number, (line, (frames, samples)) in enumerate(zip(lines, said, strict=True), 1):
                head, body, rest = time_line(line.letters, line.sounds, frames, samples)
                if line.rate > _FASTEST:
                    factor = _FASTEST / line.rate
                    head, rest = (stretch(silence, RATE, factor) for silence in (head, rest))
                    body = body.stretched(factor, RATE)
                timeline.add(_bridge(tail, head, pause, at_end=number == 1))
                timeline.add(replace(body, words=line.words))
                tail, pause = rest, _pause_behind(line, lines[number : number + 1])
                if progress:
                    progress(number / len(lines))
        timeline.add(_bridge(tail, tail[:0], pause, at_end=True))
        return timeline.utterance(" ".join(piece.text for piece in script if piece.text))

    @cached_property
    def _vocabulary(self) -> dict[str, int]:
        vocabulary: dict[str, int] = json.loads((_assets() / "vocab.json").read_text("utf-8"))
        return vocabulary

    def _open_session(self) -> Any:
        try:
            model = self._model.read_bytes()
            model = with_output(model, input_of(model, _TURNED_INTO_FRAMES))
            return open_session(model, threads=1)  # lines have threads
        except Exception as error:  # onnxruntime has a class for each kind of refusal
            reason = " ".join(str(error).split())[:120]
            raise LipwrightError(
                f"{self._model}: not a voice of hibari ({reason}); remove the file, and let "
                f"hibari fetch it again: hibari --voice {self._info.name.partition(':')[2]} hello"
            ) from error

    def _say(self, line: Line, number: int) -> tuple[npt.NDArray[np.int64], Samples]:
        """The FRAMEs of each letter, and the sound."""
        from hibari import dsp

        ids = [0, *(self._vocabulary[letter] for letter in line.letters), 0]
        feeds = {
            "ids": np.asarray([ids], np.int64),
            "speed": np.asarray([min(line.rate, _FASTEST)], np.float32),
        }  # fmt: skip
        *parts, frames = self._session.run(None, feeds)
        frames = frames.reshape(-1).astype(np.int64)
        spectra: list[npt.NDArray[np.float32]] = [part[0] for part in parts]
        _emphasise(spectra, line, frames)
        samples: Samples = dsp.synth(*spectra, np.random.default_rng([SEED, number]))
        return frames, samples


def _load_g2p(british: bool) -> G2P:
    import gc

    # Tens of thousands of small dicts come from its files; collecting between them takes longer
    # than reading them.
    collected = gc.isenabled()
    gc.disable()
    try:
        with _without_scipy_fft():
            import hibari.g2p

        return hibari.g2p.G2P(british=british)
    finally:
        if collected:
            gc.enable()


@contextmanager
def _without_scipy_fft() -> Iterator[None]:
    """Hibari takes numpy's transforms where scipy's are missing, which take 0.3 s to import.

    Those of numpy 2 are as fast, as they too keep float32.
    """
    name = "scipy.fft"
    kept = sys.modules.get(name)
    sys.modules[name] = None  # type: ignore[assignment]  # Python's own sign of what is missing
    try:
        yield
    finally:
        if kept is None:
            del sys.modules[name]
        else:
            sys.modules[name] = kept


def _emphasise(
    spectra: list[npt.NDArray[np.float32]], line: Line, frames: npt.NDArray[np.int64]
) -> None:
    """Make words louder and higher, in the network's spectra (B, F) and pitch (F,), in place."""
    pitch = spectra[_PITCH]
    at = np.concatenate([[0], np.cumsum(frames)]) * _STEPS - round(LAG * RATE / FRAME * _STEPS)
    for first, stop, level in line.emphasis:
        if level not in _MANNERS:
            continue
        steps = np.arange(len(pitch))
        start, end = at[first + 1], at[stop + 1]
        share = np.clip(np.minimum(steps - start, end - steps) / _RAMP + 1, 0, 1)
        share = share.astype(np.float32)
        manner = _MANNERS[level]
        gain = share * np.float32(manner.gain * np.log(10) / 20)
        for number in _MAGNITUDES:
            spectra[number] += gain
        pitch *= 1 + share * np.float32(manner.pitch - 1)


def _pause_behind(line: Line, following: Sequence[Line]) -> float | None:
    """Seconds up to the next line; None for what the voice makes by itself.

    A line that only another rate parts from the next, inside a phrase, has next to none.
    """
    if line.pause is not None or not following or following[0].rate == line.rate:
        return line.pause
    mark = line.letters.rstrip()[-1:]
    return None if mark in ".!?…" else _COMMA if mark in ",;:—" else _JOIN


def _bridge(tail: Samples, head: Samples, pause: float | None, at_end: bool) -> Stretch:
    """The silence between two lines, with the sound that one ends and the other begins with.

    Args:
        tail: of the line before, after its last phone; empty before the first line.
        head: of the line after, before its first phone; empty after the last line.
        pause: how long it lasts in s; None for as long as both.
        at_end: before the first line or after the last: never shorter than both.
    """
    own = len(tail) + len(head)
    wanted = own if pause is None else round(pause * RATE)
    if at_end or wanted >= own:
        between = np.zeros(max(wanted - own, 0), np.float32)
    else:
        kept = round(wanted * len(tail) / own)
        tail, head = tail[:kept], head[len(head) - (wanted - kept) :]
        between = np.zeros(0, np.float32)
    return Stretch(np.concatenate([tail, between, head]), (Timed(SILENCE, 0),), ())


def _assets() -> Path:
    """Where hibari keeps its files; hibari itself, which imports much, is not imported for it."""
    spec = find_spec("hibari")
    if spec is None or not spec.submodule_search_locations:
        raise LipwrightError("hibari is not installed; run: pip install hibari-tts")
    return Path(spec.submodule_search_locations[0], "assets")


@cache
def _table() -> dict[str, dict[str, Any]]:
    """What `hibari.voices.VOICES` holds, from its file; the default first."""
    table: dict[str, dict[str, Any]] = json.loads((_assets() / "voices.json").read_text("utf-8"))
    return table


@lru_cache(maxsize=2)
def _ready(info: VoiceInfo, model: Path, british: bool, changed: float) -> HibariVoice:
    """A voice, kept for the next text: it takes longer to open than to say a sentence."""
    del changed
    return HibariVoice(info, model, british)


class HibariBackEnd:
    """The voices of hibari: one in its package, and those that its user has fetched with it."""

    name = NAME

    def is_available(self) -> bool:
        """Whether its packages are installed."""
        return find_spec("hibari") is not None and find_spec("onnxruntime") is not None

    def remedy(self) -> str:
        """The command that installs what is missing."""
        return "pip install hibari-tts"

    def voices(self) -> Sequence[VoiceInfo]:
        """The voices whose models lie on this machine, the default first."""
        return tuple(self._info(name) for name in self._table() if self._path(name))

    def open(self, voice: str, language: str | None) -> HibariVoice:
        """The voice of that name, "" for the default of the language; nothing is downloaded.

        Raises:
            LipwrightError: there is none; lists those on this machine, and how to get others.
        """
        table = self._table()
        if not voice and language in (None, "en"):
            voice = next(iter(table))  # without a look at the others, which takes longer
        known = () if voice in table and self._path(voice) else self.voices()
        if not voice:
            fitting = [one for one in known if language == one.language]
            fitting = fitting or [one for one in known if language == "en-gb"]
            if not fitting:
                raise LipwrightError(
                    f"hibari speaks English alone, not {language!r}; choose another voice"
                )
            voice = fitting[0].name.partition(":")[2]
        path = self._path(voice) if voice in table else None
        if path is None:
            raise LipwrightError(self._refusal(voice, known))
        british, changed = bool(table[voice]["british"]), path.stat().st_mtime
        with _OPENING:
            return _ready(self._info(voice), path, british, changed)

    def _refusal(self, voice: str, known: Sequence[VoiceInfo]) -> str:
        here = ", ".join(info.name for info in known)
        if voice in self._table():
            return (
                f"voice 'hibari:{voice}' is not on this machine; hibari fetches it when you run: "
                f"hibari --voice {voice} hello; here are: {here}"
            )
        others = [name for name in self._table() if not self._path(name)]
        return (
            f"unknown voice 'hibari:{voice}'; use one of: {here}"
            + (f"; hibari also knows {', '.join(others)}, which it fetches when you run: "
               f"hibari --voice {others[0]} hello" if others else "")
        )  # fmt: skip

    def _table(self) -> dict[str, dict[str, Any]]:
        return _table()

    def _path(self, name: str) -> Path | None:
        row = self._table()[name]
        if row.get("bundled"):
            return _assets() / str(row["file"])
        from hibari.voices import voice_path

        try:
            return Path(voice_path(name, download_missing=False))
        except FileNotFoundError:
            return None

    def _info(self, name: str) -> VoiceInfo:
        row = self._table()[name]
        language = "en-gb" if row["british"] else "en"
        return VoiceInfo(f"{NAME}:{name}", language, f"{row['accent']} English, {row['gender']}")


def back_end() -> HibariBackEnd:
    """The back end of the registry."""
    return HibariBackEnd()
