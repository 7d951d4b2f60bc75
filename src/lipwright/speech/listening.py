"""What is said in a recording that comes without words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.audio import Sound
    from lipwright.speech.aligner import Alignment, Progress
    from lipwright.speech.retiming import PlacedPhone
    from lipwright.speech.scores import Scores
    from lipwright.speech.utterances import TimedPhone, Utterance
    from lipwright.track import PhoneTrack

Path = Literal["words", "phones"]

LEARNT: Final = frozenset(("en", "en-gb", "ko"))
"""codes of the languages that the recogniser learnt"""

_READ: Final = 0.15  # share of the work that is done once the sound is read
_CONTEXT: Final = 0.3  # s of sound on both sides of a piece that the network hears with it
_DEAD_DB: Final = 14.0  # dB of mel power, about -90 dB of full scale: nothing was recorded
_APART: Final = 0.25  # s before a phone's time at which it surely has not begun
_REST: Final = 1.0  # s between two utterances that are placed apart
_LONGEST_STRETCH: Final = 20.0  # s that are placed at once
_UNSURE: Final = 0.6  # confidence under which the user is told to look
_OTHER: Final = 2.0  # s of sound without speech that are worth a line
_MOST_LINES: Final = 3  # of such sounds


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

    Phones come from a recogniser, their edges from the aligner. Breath, noise and music give none.

    Args:
        sound: what is heard.
        language: code of what is spoken; others than English are a rough guess.
        progress: called with the share of the work that is done.

    Raises:
        LipwrightError: nothing that sounds like speech is heard.
    """
    from lipwright.speech.acoustic import load_model
    from lipwright.speech.aligner import Alignment
    from lipwright.speech.features import FRAME_RATE
    from lipwright.speech.recording import levels, spectra, static_features
    from lipwright.speech.scores import Scores
    from lipwright.speech.silence import speech_frames
    from lipwright.speech.utterances import confidence, utterances

    report = progress or (lambda share: None)
    power = spectra(sound)
    level = levels(power)
    if not len(power) or level.max() < _DEAD_DB:
        raise _nothing(sound)
    active = speech_frames(level, FRAME_RATE)
    report(_READ)
    phones = []
    for phone in _phones(sound, level, active):
        phones.append(phone)
        report(_READ + (1 - _READ) * min(phone.time / sound.duration, 1.0) / 2)
    said = utterances(phones)
    scores = Scores(load_model(), static_features(power))
    placed = _placed(said, scores, report)
    if not placed:
        raise _nothing(sound)
    kept = [phone for utterance in said if utterance.is_speech for phone in utterance.phones]
    track, sure = _track(placed, sound.duration), confidence(kept)
    notes = _notes(track, active, sure, language)
    return Heard(Alignment(track), "phones", sure, language=language, notes=notes)


def _phones(
    sound: Sound, level: npt.NDArray[np.float64], active: npt.NDArray[np.bool_]
) -> Iterator[TimedPhone]:
    """What the network writes, piece by piece."""
    from lipwright.speech.decoding import decode
    from lipwright.speech.features import FRAME_RATE
    from lipwright.speech.pieces import cut
    from lipwright.speech.recogniser import FRAME, LATE, recognise
    from lipwright.speech.utterances import TimedPhone

    for first, stop in cut(level, active):
        start, end = first / FRAME_RATE, stop / FRAME_RATE
        begin = max(start - _CONTEXT, 0.0)
        for phone in decode(recognise(sound, begin, end + _CONTEXT)):
            time = begin + phone.frame * FRAME - LATE
            if start <= time < end:
                yield TimedPhone(phone.symbol, time, phone.probability, phone.ends_word)


def _placed(said: Sequence[Utterance], scores: Scores, report: Progress) -> list[PlacedPhone]:
    """The phones of what is speech, with edges, between what is none."""
    from lipwright.speech.features import FRAME_RATE
    from lipwright.speech.retiming import place_phones

    placed: list[PlacedPhone] = []
    for start, stop, words in _stretches(said, len(scores) / FRAME_RATE):
        first, last = (round(time * FRAME_RATE) for time in (start, stop))
        scores.hear(last)
        placed += place_phones(words, scores, first, last)
        report((1 + _READ) / 2 + (1 - _READ) / 2 * last / len(scores))
    return placed


def _stretches(
    said: Sequence[Utterance], duration: float
) -> Iterator[tuple[float, float, list[list[str]]]]:
    """Start and end in s, and words, of runs of speech with nothing else between."""
    start, words = 0.0, []
    for index, utterance in enumerate(said):
        after = said[index + 1].start if index + 1 < len(said) else duration
        if not utterance.is_speech:
            start = max(min(utterance.end + _APART, after - _APART), start)
            continue
        words += utterance.words()
        follows = index + 1 < len(said) and said[index + 1].is_speech
        apart = after - utterance.end > _REST or after - start > _LONGEST_STRETCH
        if apart or not follows:
            stop = duration if index + 1 == len(said) else max(after - _APART, utterance.end)
            yield start, stop, words
            start, words = stop, []


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


def _notes(
    track: PhoneTrack, active: npt.NDArray[np.bool_], sure: float, language: str
) -> tuple[str, ...]:
    notes = []
    if language not in LEARNT:
        notes.append(
            f"the recogniser learnt English: what it hears in {language!r} is a rough guess; give "
            "the words with --text"
        )
    if sure < _UNSURE:
        notes.append(
            f"only about {10 * sure:.0f} in 10 phones are likely to be right (noise or music under "
            "the speech?); give the words with --text"
        )
    others = _other_sounds(track, active)
    notes += [
        f"from {start:.1f} to {end:.1f} s something else than speech is heard; the mouth rests"
        for start, end in others[:_MOST_LINES]
    ]
    if len(others) > _MOST_LINES:
        notes.append(f"and so {len(others) - _MOST_LINES} times more")
    return tuple(notes)


def _other_sounds(track: PhoneTrack, active: npt.NDArray[np.bool_]) -> list[tuple[float, float]]:
    """Start and end in s of long sounds in which nobody speaks."""
    from lipwright.phones import SILENCE
    from lipwright.speech.features import FRAME_RATE

    free = active.copy()
    for phone, start, end in track:
        if phone != SILENCE:
            free[int(start * FRAME_RATE) : int(end * FRAME_RATE) + 1] = False
    edges = np.flatnonzero(np.diff(np.concatenate([[False], free, [False]]).astype(np.int8)))
    spans = (edges.reshape(-1, 2) / FRAME_RATE).tolist()
    return [(start, end) for start, end in spans if end - start >= _OTHER]


def _nothing(sound: Sound) -> LipwrightError:
    name = getattr(sound, "name", "audio")
    return LipwrightError(
        f"{name}: nothing that sounds like speech was found in it; give its words with --text"
    )
