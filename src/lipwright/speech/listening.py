"""What is said in a recording that comes without words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.audio import Sound
    from lipwright.speech.aligner import Alignment, Progress
    from lipwright.speech.decoding import RecognisedPhone
    from lipwright.speech.retiming import PlacedPhone
    from lipwright.track import PhoneTrack

Path = Literal["words", "phones"]

_READ: Final = 0.1  # share of the work that is done once the sound is read
_CONTEXT: Final = 0.15  # s of sound on both sides of a piece that the network hears with it


@dataclass(frozen=True, eq=False)
class Heard:
    """Phones with times, and how they were found."""

    alignment: Alignment
    path: Path
    """"words": words were recognised and aligned; "phones": phones were recognised and re-timed"""
    confidence: float
    """0 to 1, how far to trust it: what share of the phones is likely to be right"""
    text: str = ""
    """the words that were recognised; "" on the path of phones"""
    language: str = "en"
    """of the words"""
    notes: tuple[str, ...] = ()
    """what the user should know, a line each: "music from 3.2 to 7.9 s; the mouth follows it no
    further" """


def listen(sound: Sound, language: str = "en", *, progress: Progress | None = None) -> Heard:
    """The phones of a recording, with times, without its words.

    Args:
        sound: what is heard.
        language: code of what is spoken; the recogniser knows English, others are a rough guess.
        progress: called with the share of the work that is done.

    Raises:
        LipwrightError: nothing that sounds like speech is heard.
    """
    from lipwright.speech.acoustic import load_model
    from lipwright.speech.aligner import Alignment
    from lipwright.speech.decoding import decode
    from lipwright.speech.features import FRAME_RATE
    from lipwright.speech.pieces import cut
    from lipwright.speech.recogniser import FRAME, LATE, recognise
    from lipwright.speech.recording import SILENT_DB, levels, spectra, static_features
    from lipwright.speech.retiming import place_phones
    from lipwright.speech.scores import Scores
    from lipwright.speech.silence import speech_frames

    report = progress or (lambda share: None)
    power = spectra(sound)
    level = levels(power)
    if not len(power) or level.max() < SILENT_DB:
        raise _nothing(sound)
    scores = Scores(load_model(), static_features(power))
    report(_READ)
    pieces = cut(level, speech_frames(level, FRAME_RATE) & True)
    spans = [(a / FRAME_RATE - _CONTEXT, b / FRAME_RATE + _CONTEXT) for a, b in pieces]
    placed: list[PlacedPhone] = []
    sure: list[float] = []
    for (start, stop), (begin, end) in zip(pieces, spans, strict=True):
        first, rows = max(begin, 0.0), recognise(sound, begin, end)
        report(_READ + (1 - _READ) * stop / len(power))
        inside = [
            phone
            for phone in decode(rows)
            if start / FRAME_RATE <= first + phone.frame * FRAME - LATE < stop / FRAME_RATE
        ]
        scores.hear(stop)
        placed += place_phones(_words(inside), scores, start, stop)
        sure += [phone.probability for phone in inside]
    if not placed:
        raise _nothing(sound)
    track = _track(placed, sound.duration)
    return Heard(Alignment(track), "phones", float(np.mean(sure)), language=language)


def _words(phones: Sequence[RecognisedPhone]) -> list[list[str]]:
    words: list[list[str]] = [[]]
    for phone in phones:
        words[-1].append(phone.symbol)
        if phone.ends_word:
            words.append([])
    return [word for word in words if word]


def _track(placed: Sequence[PlacedPhone], duration: float) -> PhoneTrack:
    from lipwright.phones import SILENCE
    from lipwright.speech.placing import SHORTEST, rising, seconds
    from lipwright.track import PhoneTrack

    phones: list[str] = []
    edges = [0.0]
    for phone in placed:
        start = seconds(phone.start, duration)
        if start > edges[-1] + SHORTEST:
            phones.append(SILENCE)
            edges.append(start)
        phones.append(phone.symbol)
        edges.append(seconds(phone.stop, duration))
    return PhoneTrack(tuple(phones), rising(edges, duration)).padded(0.0, duration)


def _nothing(sound: Sound) -> LipwrightError:
    name = getattr(sound, "name", "audio")
    return LipwrightError(
        f"{name}: nothing that sounds like speech was found in it; give its words with --text"
    )
