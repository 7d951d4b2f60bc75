"""From judged words to the track and the report that a user sees."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from lipwright.errors import LipwrightError
from lipwright.phones import SILENCE
from lipwright.speech.aligner import Alignment, Misfit
from lipwright.speech.features import FRAME_CENTRE, FRAME_RATE
from lipwright.speech.fit import WORST, PlacedWord, SpokenRow, confidence
from lipwright.speech.repair import Judged
from lipwright.track import PhoneTrack, Word

if TYPE_CHECKING:
    from lipwright.audio import Sound

LEAST_SHARE: Final = 0.42  # of what is said and written must fit, for the text to be the right one

# A frame tells about the middle of its window; an edge lies between two such middles.
_EDGE_OFFSET: Final = FRAME_CENTRE - 0.5 / FRAME_RATE  # s
_SHORTEST: Final = 1e-3  # s, of a phone that the end of the sound cuts off


def to_alignment(judged: Judged, rows: Sequence[SpokenRow], sound: Sound) -> Alignment:
    """The track of the words that were placed, and those that do not fit.

    Raises:
        LipwrightError: most words do not fit.
    """
    misfits = tuple(
        Misfit(
            rows[index].word.text, rows[index].word.written,
            _seconds(start, sound.duration), _seconds(stop, sound.duration),
            WORST if score is None else score,
        )
        for index, (start, stop, score) in sorted(judged.misfits.items())
    )  # fmt: skip
    if judged.share < LEAST_SHARE:
        raise _other_text(judged, misfits, rows, sound)
    words = [judged.placed[index] for index in sorted(judged.placed)]
    return Alignment(_track(words, rows, judged.allowance, sound.duration), misfits)


def _other_text(
    judged: Judged, misfits: Sequence[Misfit], rows: Sequence[SpokenRow], sound: Sound
) -> LipwrightError:
    name = getattr(sound, "name", "audio")
    place = "most of what is said is not in it"
    if misfits:
        word = rows[min(judged.misfits)].word
        place = (
            f"{len(misfits)} of {len(rows)} words do not, the first at {misfits[0].start:.2f} s, "
            f"{word.written!r} (line {word.line}, column {word.column})"
        )
    return LipwrightError(
        f"{name}: the text does not fit the sound: {place}; give the words of this recording"
    )


def _track(
    words: Sequence[PlacedWord], rows: Sequence[SpokenRow], allowance: float, duration: float
) -> PhoneTrack:
    phones: list[str] = []
    edges = [0.0]
    placed: list[Word] = []
    for word in words:
        row = rows[word.index]
        start = _seconds(word.start, duration)
        if start > edges[-1] + _SHORTEST:
            phones.append(SILENCE)
            edges.append(start)
        first = len(phones)
        phones += row.phones[word.pronunciation]
        edges += [_seconds(segment.stop, duration) for segment in word.segments]
        placed.append(
            Word(row.word.text, first, len(phones), confidence(word.score + allowance))
        )  # fmt: skip
    return PhoneTrack(tuple(phones), _rising(edges, duration), tuple(placed)).padded(0.0, duration)


def _rising(
    edges: Sequence[float], duration: float
) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """The edges, with room for phones that the end of the sound would leave without any."""
    room = duration - _SHORTEST * np.arange(len(edges))[::-1]
    return np.minimum(edges, np.maximum(room, 0))


def _seconds(frame: int, duration: float) -> float:
    if frame <= 0:
        return 0.0
    return min(frame / FRAME_RATE + _EDGE_OFFSET, duration)
