"""Tracks as dynamic visemes see them: stretches of speech, and the rests between them.

Places in a stretch are counted in joints: PARTS to a phone, so that a gesture may begin or end
inside one. In the middle of a long silence the face rests, which no gesture needs to say.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.features.known import known_track
from lipwright.phones import SILENCE
from lipwright.track import PhoneTrack

Floats = npt.NDArray[np.float64]

PARTS: Final = 2  # joints to a phone: gestures meet at its start or in its middle
MARGIN_S: Final = 0.3  # s of silence beside speech that belong to it
LONGEST: Final = 200  # phones of a stretch, so that a day without a pause needs no more memory


@dataclass(frozen=True, eq=False)
class Stretch:
    """Speech between two rests, or a rest, which has no phones."""

    phones: tuple[int, ...]
    """P places in the list of known phones; none for a rest"""
    edges: Floats
    """(P + 1,) s, rising; of a rest its two ends"""

    @property
    def joints(self) -> int:
        """The last place, J: PARTS to a phone."""
        return PARTS * len(self.phones)

    def times(self, joints: npt.ArrayLike) -> Floats:
        """The times of places in joints, whole or not, 0 to J."""
        place = np.asarray(joints, np.float64) / PARTS
        return np.interp(place, np.arange(len(self.edges)), self.edges)

    def places(self, times: npt.ArrayLike) -> Floats:
        """The places in joints of times in s."""
        known = np.arange(len(self.edges)) * float(PARTS)
        return np.interp(np.asarray(times, np.float64), self.edges, known)


def stretches(track: PhoneTrack, known: tuple[str, ...]) -> Iterator[Stretch]:
    """The stretches and rests of a track, in order and without gaps.

    Args:
        track: any; phones that are not known are replaced by what looks like them.
        known: the phones that gestures were heard with.
    """
    index = {phone: place for place, phone in enumerate(known)}
    said = known_track(track, known)
    phones: list[int] = []
    edges: list[float] = [said.start]
    for number, (phone, start, end) in enumerate(said):
        before, after = number > 0, number + 1 < len(said)
        silence = MARGIN_S * (before + after)  # s of it that belong to speech
        if phone == SILENCE and end - start > silence:
            if before:
                phones.append(index[phone])
                edges.append(start + MARGIN_S)
                yield Stretch(tuple(phones), np.array(edges))
            rest = (start + MARGIN_S * before, end - MARGIN_S * after)
            yield Stretch((), np.array(rest))
            phones, edges = ([index[phone]], [rest[1], end]) if after else ([], [end])
            continue
        phones.append(index[phone])
        edges.append(end)
        if len(phones) >= LONGEST:
            yield Stretch(tuple(phones), np.array(edges))
            phones, edges = [], [end]
    if phones:
        yield Stretch(tuple(phones), np.array(edges))
