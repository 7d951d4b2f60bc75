"""What is said in a recording that comes without words."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
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

# The user is told to look where the confidence is under `_UNSURE`, or under `_LESS_SURE` while
# another sound fills the pauses: speech rises less than `_LEAST_RANGE` over what is quietest.
# With music 5 dB under the speech, 24 of 28 recordings of bench/listening.py get the note, with
# music as loud as the speech all, 10 dB under it 11. So do 12 of 50 sentences of GRID as recorded,
# in which 47 % of the phones are wrong (24 % in the others), and none of 24 by hibari and the
# Australian (17 and 20 % wrong). A limit of 0.6 alone gave 11, 20 and 2 of 28, and 5 of 50.
_UNSURE: Final = 0.65
_LESS_SURE: Final = 0.8
_LEAST_RANGE: Final = 18.0  # dB
_OTHER: Final = 2.0  # s of sound without speech that are worth a line
_MOST_LINES: Final = 3  # of such sounds, and of stretches that are unsure


@dataclass(frozen=True, eq=False)
class Heard:
    """Phones with times, and how they were found."""

    alignment: Alignment
    path: Path
    """"words": words were recognised and aligned; "phones": phones were recognised and re-timed"""
    confidence: float
    """0 to 1; "phones": the share of phones likely to be right; "words": the recogniser's own
    probability of its words"""
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
    from lipwright.speech.recording import dynamic_range, levels, spectra, static_features
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
    masked = dynamic_range(power) < _LEAST_RANGE
    scores = Scores(load_model(), static_features(power))
    placed = _placed(said, scores, report)
    if not placed:
        raise _nothing(sound)
    kept = [phone for utterance in said if utterance.is_speech for phone in utterance.phones]
    track, sure = _track(placed, sound.duration), confidence(kept)
    notes = (*_foreign(language), *_doubts(kept, sure, masked), *_rests(track, active))
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


def _foreign(language: str) -> Iterator[str]:
    if language not in LEARNT:
        yield (
            f"the recogniser learnt English: what it hears in {language!r} is a rough guess; give "
            "the words with --text"
        )


def _doubts(phones: Sequence[TimedPhone], sure: float, masked: bool) -> list[str]:
    """What is not to be trusted: all of it, or stretches."""
    from lipwright.speech.utterances import unsure_stretches

    why, remedy = "(noise, music, or another language?)", "give the words with --text"
    if sure < _UNSURE or (masked and sure < _LESS_SURE):
        return [f"only about {_tenths(sure)} phones are likely to be right {why}; {remedy}"]
    return _some(
        f"from {start:.1f} to {end:.1f} s only about {_tenths(part)} phones are likely to be right "
        f"{why}; {remedy}"
        for start, end, part in unsure_stretches(phones)
    )


def _tenths(share: float) -> str:
    return f"{10 * share:.0f} in 10"


def _rests(track: PhoneTrack, active: npt.NDArray[np.bool_]) -> list[str]:
    return _some(
        f"from {start:.1f} to {end:.1f} s something else than speech is heard; the mouth rests"
        for start, end in _other_sounds(track, active)
    )


def _some(lines: Iterable[str]) -> list[str]:
    """The first lines, and how many more there are."""
    every = list(lines)
    more = len(every) - _MOST_LINES
    return [*every[:_MOST_LINES], *([f"and so {more} times more"] if more > 0 else [])]


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
