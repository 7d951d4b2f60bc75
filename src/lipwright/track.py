"""`PhoneTrack`: phones and the times at which they meet."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from lipwright.controls import is_text
from lipwright.phones import PHONES, SILENCE


@dataclass(frozen=True)
class Word:
    """A word as a run of phones in a track."""

    text: str
    """as written, without white space"""
    first: int
    """index of its first phone"""
    stop: int
    """index after its last phone"""
    confidence: float | None = None
    """0 (does not fit the sound) to 1 (fits), or None if nobody judged it"""


@dataclass(frozen=True, eq=False)
class PhoneTrack:
    """P phones without gaps: P labels and the P + 1 edges between them.

    Raises:
        ValueError: an unknown phone, edges that do not rise, words out of order or range.
    """

    phones: tuple[str, ...]
    """P symbols of the phone table (ARPABET without stress digits, or `sil`); P at least 1"""
    edges: npt.NDArray[np.float64]
    """(P + 1,), s, rising, the first at or after 0; read-only"""
    words: tuple[Word, ...] = ()
    """in order, not overlapping; phones between words belong to none"""
    stress: tuple[int | None, ...] = ()
    """P of 0, 1 (primary), 2 (secondary) or None (not a vowel, or unknown); () is all None"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        phones, words = tuple(self.phones), tuple(self.words)
        stress = tuple(self.stress) or (None,) * len(phones)
        edges = np.array(self.edges, dtype=np.float64)  # a copy: ours to freeze
        if not phones:
            raise ValueError("a phone track has at least one phone")
        for index, phone in enumerate(phones):
            if phone not in PHONES:
                raise ValueError(f"phone {index} is {phone!r}, which the phone table lacks")
        if edges.shape != (len(phones) + 1,):
            raise ValueError(f"{len(phones)} phones with edges of the shape {edges.shape}")
        if not np.isfinite(edges).all() or edges[0] < 0 or not (np.diff(edges) > 0).all():
            raise ValueError("edges are not finite, rising times from 0 s on")
        if len(stress) != len(phones) or any(s not in (None, 0, 1, 2) for s in stress):
            raise ValueError("stress is not one of None, 0, 1 and 2 for each phone")
        stop = 0
        for word in words:
            if not (stop <= word.first < word.stop <= len(phones)):
                raise ValueError(f"word {word.text!r} is out of order or out of the track")
            if not word.text or word.text.split() != [word.text]:
                raise ValueError(f"word {word.text!r} is empty or has white space")
            if not is_text(word.text):
                raise ValueError(f"word {word.text!a} has a control character or half a letter")
            if word.confidence is not None and not 0 <= word.confidence <= 1:
                raise ValueError(f"word {word.text!r} has the confidence {word.confidence}")
            stop = word.stop
        edges.setflags(write=False)
        object.__setattr__(self, "phones", phones)
        object.__setattr__(self, "words", words)
        object.__setattr__(self, "stress", stress)
        object.__setattr__(self, "edges", edges)

    def __len__(self) -> int:
        """The number of phones, P."""
        return len(self.phones)

    def __iter__(self) -> Iterator[tuple[str, float, float]]:
        """Symbol, start and end (s) of each phone."""
        for index, phone in enumerate(self.phones):
            yield phone, float(self.edges[index]), float(self.edges[index + 1])

    @property
    def start(self) -> float:
        """The first edge in s."""
        return float(self.edges[0])

    @property
    def end(self) -> float:
        """The last edge in s."""
        return float(self.edges[-1])

    @property
    def durations(self) -> npt.NDArray[np.float64]:
        """(P,) in s."""
        return np.diff(self.edges)

    def word_span(self, word: Word) -> tuple[float, float]:
        """Start and end of a word of this track in s."""
        return float(self.edges[word.first]), float(self.edges[word.stop])

    def word_at(self, index: int) -> Word | None:
        """The word that phone `index` belongs to."""
        return next((word for word in self.words if word.first <= index < word.stop), None)

    def with_edges(self, edges: npt.ArrayLike) -> PhoneTrack:
        """The same phones and words at other times, (P + 1,)."""
        return replace(self, edges=np.asarray(edges, np.float64))

    def shifted(self, seconds: float) -> PhoneTrack:
        """The same track, `seconds` later."""
        return self.with_edges(self.edges + seconds)

    def padded(self, start: float, end: float) -> PhoneTrack:
        """The track with silence around it, from `start` to `end` s; it never loses a phone."""
        phones, edges, stress = list(self.phones), list(self.edges), list(self.stress)
        shift = 0
        if start < edges[0]:
            phones.insert(0, SILENCE)
            edges.insert(0, start)
            stress.insert(0, None)
            shift = 1
        if end > edges[-1]:
            phones.append(SILENCE)
            edges.append(end)
            stress.append(None)
        words = tuple(replace(w, first=w.first + shift, stop=w.stop + shift) for w in self.words)
        return PhoneTrack(tuple(phones), np.asarray(edges), words, tuple(stress))


def join_tracks(tracks: Sequence[PhoneTrack]) -> PhoneTrack:
    """One track out of tracks that follow each other; a gap between two becomes silence.

    Raises:
        ValueError: no tracks, or two overlap.
    """
    if not tracks:
        raise ValueError("no tracks to join")
    phones: list[str] = []
    edges: list[float] = [tracks[0].start]
    stress: list[int | None] = []
    words: list[Word] = []
    for track in tracks:
        gap = track.start - edges[-1]
        if gap < -1e-9:
            raise ValueError(f"a track starts at {track.start} s, before the last ends")
        if gap > 1e-9:
            phones.append(SILENCE)
            stress.append(None)
            edges.append(track.start)
        shift = len(phones)
        words += [replace(w, first=w.first + shift, stop=w.stop + shift) for w in track.words]
        phones += track.phones
        stress += track.stress
        edges += [float(edge) for edge in track.edges[1:]]
    return PhoneTrack(tuple(phones), np.asarray(edges), tuple(words), tuple(stress))
