"""Voices of Piper: any voice file that the user has, run by onnxruntime.

A voice is two files, NAME.onnx and NAME.onnx.json. Its phonemes come from espeak-ng, its phone
times from the durations inside its own network. Several speakers: `piper:NAME.onnx#3`, or the
speaker's name instead of the number.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt

from lipwright import espeak
from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.phones import SILENCE
from lipwright.speech.voices.espeak_times import share_time
from lipwright.speech.voices.piper_config import PiperConfig, read_config
from lipwright.speech.voices.piper_model import PiperModel
from lipwright.speech.voices.piper_text import Sentence, sentences, spoken_phones
from lipwright.speech.voices.scripts import check_text
from lipwright.speech.voices.timeline import Stretch, Timed, Timeline
from lipwright.speech.voices.values import Emphasis, Piece, Script, Utterance, VoiceInfo
from lipwright.speech.voices.written_out import written_out

if TYPE_CHECKING:
    from lipwright.speech.aligner import Progress

NAME: Final = "piper"
EXTRA: Final = "piper"
SUFFIX: Final = ".json"
SHORTEST_PAUSE: Final = 0.06  # s; what a comma lasts for less is no silence
SHORTEST_GAP: Final = 0.12  # s; the same of the space between two words
_CLOSE_ENOUGH: Final = 0.02  # of the duration
_MOST_TRIES: Final = 4
# Ours: emphasised words are slower; a Piper voice can do nothing else.
_SLOWER: Final = MappingProxyType[Emphasis | None, float]({
    None: 1.0, "none": 1.0, "reduced": 0.92, "moderate": 1.07, "strong": 1.15,
})  # fmt: skip


class PiperVoice:
    """A voice in two files; made by `PiperBackEnd.open`."""

    def __init__(self, info: VoiceInfo, model: PiperModel, config: PiperConfig, speaker: int):
        """`speaker` is its number."""
        self._info, self._model, self._config, self._speaker = info, model, config, speaker

    @property
    def info(self) -> VoiceInfo:
        """Its name and language."""
        return self._info

    def speak(
        self, script: Script, source: str = "text", progress: Progress | None = None
    ) -> Utterance:
        """Say the script, as `Voice.speak` describes it; without a track if no durations are told.

        Raises:
            LipwrightError: nothing is said, or a control character stands in the text.
        """
        for piece in script:
            check_text(piece, source)
        script = written_out(script, self._info.language, source)
        timeline = Timeline(self._config.rate)
        joins, said_any = False, False
        for number, piece in enumerate(script, 1):
            for sentence in self._sentences(piece):
                stretch = self._say(sentence, piece)
                timeline.add(stretch.trimmed(joins, False) if self._tells_times else stretch)
                joins, said_any = False, True
            if piece.pause:
                if self._tells_times:
                    timeline.end_speech()
                timeline.silence(piece.pause)
                joins = True
            if progress:
                progress(number / len(script))
        if not said_any or (self._tells_times and not timeline.says_something):
            raise LipwrightError(
                f"{source}: line {script[0].line}: the voice finds nothing to say; write words"
            )
        text = " ".join(piece.text for piece in script if piece.text)
        if self._tells_times:
            return timeline.utterance(text)
        return Utterance(timeline.audio(), None, text)

    @property
    def _tells_times(self) -> bool:
        return self._model.tells_durations and self._config.phoneme_type == "espeak"

    def _sentences(self, piece: Piece) -> Sequence[Sentence]:
        if piece.phones:
            word = "".join(piece.text.split()) or "-".join(piece.phones)
            return (spoken_phones(piece.phones, word, self._config),)
        return tuple(sentences(piece.text, self._config)) if piece.text.strip() else ()

    def _say(self, sentence: Sentence, piece: Piece) -> Stretch:
        """A sentence at the rate of its piece."""
        ids = [number for unit in sentence.units for number in unit.ids]
        factor = _SLOWER[piece.emphasis] / piece.rate
        scale = self._config.length_scale
        samples, ends = self._model.run(ids, scale, self._speaker)
        goal = len(samples) * factor
        # Durations are rounded up, so that half the scale is more than half the time.
        for _ in range(_MOST_TRIES if factor != 1 else 0):
            if abs(len(samples) / goal - 1) <= _CLOSE_ENOUGH:
                break
            scale *= goal / len(samples)
            samples, ends = self._model.run(ids, scale, self._speaker)
        if ends is None or not self._tells_times:
            return Stretch(samples, (), ())
        phones = _timed(sentence, ends, self._config.rate)
        return Stretch(samples, phones, sentence.words)


def _timed(sentence: Sentence, ends: npt.NDArray[np.float64], rate: int) -> tuple[Timed, ...]:
    """The phones and pauses of a sentence.

    Args:
        sentence: with L numbers.
        ends: (L,), the end of each number, in samples.
        rate: samples a second.
    """
    timed: list[Timed] = []
    place, start = 0, 0.0
    for unit in sentence.units:
        place += len(unit.ids)
        stop = float(ends[place - 1]) if place else 0.0
        lasts = (stop - start) / rate
        if unit.sounds:
            timed += share_time(unit.sounds, round(start), round(stop), unit.word)
        elif (
            unit.kind == "edge"
            or (unit.kind == "pause" and lasts >= SHORTEST_PAUSE)
            or (unit.kind == "space" and lasts >= SHORTEST_GAP)
        ):
            timed.append(Timed(SILENCE, round(start)))
        start = stop
    return tuple(
        one for number, one in enumerate(timed)
        if not (number and one.phone == timed[number - 1].phone == SILENCE)
    )  # fmt: skip


class PiperBackEnd:
    """Voices that lie in files of the user."""

    name = NAME

    def is_available(self) -> bool:
        """Whether its packages are installed."""
        return find_spec("onnxruntime") is not None

    def remedy(self) -> str:
        """The command that installs what is missing."""
        return f"pip install 'lipwright[{EXTRA}]'"

    def voices(self) -> Sequence[VoiceInfo]:
        """None: they are wherever the user has them."""
        return ()

    def open(self, voice: str, language: str | None) -> PiperVoice:
        """The voice in the file of that name, with `#` and a speaker behind it if it has several.

        Raises:
            LipwrightError: there is no such file, it is no Piper voice, or has no such speaker.
        """
        del language  # a file has the one that it has
        if not voice:
            raise LipwrightError("a Piper voice is a file: name it, as in --voice piper:FILE.onnx")
        path, speaker = _speaker_of(voice)
        if not _is_file(path):
            raise LipwrightError(
                f"{str(path)[:200]}: no such file; name the .onnx file of a Piper voice, with its "
                f".onnx{SUFFIX} beside it"
            )
        config = read_config(path.with_name(path.name + SUFFIX))
        number = _number_of(speaker, config, path)
        if config.phoneme_type == "espeak":
            if not espeak.is_available():
                raise MissingExtraError("espeak-ng", EXTRA)
            espeak.find_language(config.espeak_voice)
        model = PiperModel(path, config)
        info = VoiceInfo(f"{NAME}:{voice}", _language_of(config), f"{path.stem}, by Piper")
        return PiperVoice(info, model, config, number)


def _speaker_of(voice: str) -> tuple[Path, str]:
    """The file and the speaker; a file whose name has a # is a file."""
    name, mark, speaker = voice.rpartition("#")
    if "\0" in voice:
        raise LipwrightError(f"{voice[:80]!a}: is no path; name the .onnx file of a Piper voice")
    return (Path(name), speaker) if mark and not _is_file(Path(voice)) else (Path(voice), "")


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # too long for a path
        return False


def _number_of(speaker: str, config: PiperConfig, path: Path) -> int:
    if not speaker:
        return 0
    if speaker in config.speaker_ids:
        return config.speaker_ids[speaker]
    if speaker.isdecimal() and int(speaker) < config.speakers:
        return int(speaker)
    names = ", ".join(list(config.speaker_ids)[:8])
    known = f"0 to {config.speakers - 1}" + (f", or by name: {names}" if names else "")
    raise LipwrightError(f"{path}: has no speaker {speaker[:40]!r}; use {known}")


def _language_of(config: PiperConfig) -> str:
    """The ISO code of a voice, which writes it as "sv_SE", "en_GB" or "zh_CN"."""
    from lipwright.language.codes import resolve_code

    code = config.language.replace("_", "-")
    for one in (code, code.partition("-")[0]):
        try:
            return resolve_code(one)
        except LipwrightError:
            continue
    return code.partition("-")[0]


def back_end() -> PiperBackEnd:
    """The back end of the registry."""
    return PiperBackEnd()
