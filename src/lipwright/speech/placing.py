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
    from lipwright.language import SpokenWord

# A text is refused if it explains less of the speech than this, and that many of its words do not
# fit. Right texts of GRID reach 0.95, with half of the words replaced 0.5; other texts 0.1 to 0.4.
# Where all words fit, the rest of the sound may be other people's.
LEAST_SHARE: Final = 0.36
MOST_MISFITS: Final = 0.25
# In other languages, right texts of espeak-ng's voices reach 0.86, other texts 0.2 to 0.6.
LEAST_SHARE_FOREIGN: Final = 0.55

# A frame tells about the middle of its window; an edge lies between two such middles.
_EDGE_OFFSET: Final = FRAME_CENTRE - 0.5 / FRAME_RATE  # s
SHORTEST: Final = 1e-3  # s, of a phone that the end of the sound cuts off


def to_alignment(
    judged: Judged, rows: Sequence[SpokenRow], sound: Sound, least_share: float = LEAST_SHARE
) -> Alignment:
    """The track of the words that were placed, and those that do not fit.

    A text whose share is under `least_share` is refused, if enough of its words do not fit.

    Raises:
        LipwrightError: most words do not fit.
    """
    misfits = tuple(
        Misfit(
            rows[index].word.text, rows[index].word.written,
            seconds(start, sound.duration), seconds(stop, sound.duration),
            WORST if score is None else score,
        )
        for index, (start, stop, score) in sorted(judged.misfits.items())
    )  # fmt: skip
    if judged.share < least_share and len(misfits) >= MOST_MISFITS * len(rows):
        raise _other_text(misfits, rows[min(judged.misfits)].word, len(rows), sound)
    words = [judged.placed[index] for index in sorted(judged.placed)]
    unwritten = tuple(
        (seconds(start, sound.duration), seconds(stop, sound.duration))
        for start, stop in judged.unwritten
    )
    return Alignment(_track(words, rows, judged.allowance, sound.duration), misfits, unwritten)


def _other_text(
    misfits: Sequence[Misfit], word: SpokenWord, n_words: int, sound: Sound
) -> LipwrightError:
    name = getattr(sound, "name", "audio")
    return LipwrightError(
        f"{name}: the text does not fit the sound: {len(misfits)} of {n_words} words do not, the "
        f"first at {misfits[0].start:.2f} s, {word.written[:40]!r} (line {word.line}, column "
        f"{word.column}); give the words of this recording"
    )


def _track(
    words: Sequence[PlacedWord], rows: Sequence[SpokenRow], allowance: float, duration: float
) -> PhoneTrack:
    phones: list[str] = []
    edges = [0.0]
    placed: list[Word] = []
    for word in words:
        row = rows[word.index]
        start = seconds(word.start, duration)
        if start > edges[-1] + SHORTEST:
            phones.append(SILENCE)
            edges.append(start)
        first = len(phones)
        phones += row.phones[word.pronunciation]
        edges += edges_of(word, row, duration)[1:]
        placed.append(
            Word(row.word.text, first, len(phones), confidence(word.score + allowance))
        )  # fmt: skip
    return PhoneTrack(tuple(phones), rising(edges, duration), tuple(placed)).padded(0.0, duration)


def edges_of(word: PlacedWord, row: SpokenRow, duration: float) -> list[float]:
    """(P + 1,) s, where the phones of a word begin and end, whatever lies between their units."""
    last_units = np.cumsum([len(units) for units in row.units[word.pronunciation]]) - 1
    frames = [word.start, *(word.segments[i].stop for i in last_units)]
    return [seconds(frame, duration) for frame in frames]


def rising(edges: Sequence[float], duration: float) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """The edges, with room for phones that the end of the sound would leave without any."""
    room = duration - SHORTEST * np.arange(len(edges))[::-1]
    return np.minimum(edges, np.maximum(room, 0))


def seconds(frame: int, duration: float) -> float:
    """The time in s at which the frame before ends and `frame` begins."""
    if frame <= 0:
        return 0.0
    return min(frame / FRAME_RATE + _EDGE_OFFSET, duration)
