"""What to do about words that do not fit: free their neighbours, and see where they would be."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from lipwright.phones import PHONES
from lipwright.speech.fit import LEAST_FIT, PlacedWord, SpokenRow, noise_allowance, placed_words
from lipwright.speech.graph import ANY_SPEECH, build_graph
from lipwright.speech.held import over_held
from lipwright.speech.search import STRICT, Costs, Search, Segment

_CONTEXT: Final = 2  # right words on each side that are heard again
_FARTHEST: Final = 2000  # frames, 20 s, that are heard again before the first or after the last
_LOOSE: Final = Costs(
    skip=STRICT.skip, begin_other=10.0, other=1.5
)  # no word is left out, other speech is cheap
_USUAL_FRAMES: Final = 8  # of a phone
_LEAST_SPOKEN: Final = 0.5  # share of a misfit's frames that are speech, to stay in the track
_PAUSE: Final = 50  # frames, the longest pause inside one stretch of speech without words
_MUCH: Final = 60  # frames of speech without words that are worth a warning: two or three words


@dataclass(frozen=True)
class Judged:
    """Where each word of the transcript is, and which of them do not fit."""

    placed: dict[int, PlacedWord]
    """index in the transcript to place; the misfits too, unless the sound lacks them"""
    misfits: dict[int, tuple[int, int, float | None]]
    """index to start, stop (frames) and score, or None where there is no room for the word"""
    allowance: float
    """added to scores, for the noise of the recording and the language"""
    share: float
    """0 to 1, how much of what is said and of what is written the fitting words are"""
    unwritten: list[tuple[int, int]]
    """frames of speech that no word was placed in, from and to"""


class Judge:
    """Decides which words fit, from a first path on."""

    def __init__(
        self, search: Search, path: Sequence[Segment], rows: Sequence[SpokenRow],
        allowance: float = 0.0,
    ) -> None:  # fmt: skip
        """`path` is the first path of all words; `allowance` comes to that for noise."""
        self.scores, self.rows = search.scores, rows
        first = placed_words(search.graph, path)
        self.allowance = allowance + noise_allowance([word.score for word in first])
        self.placed = {word.index: word for word in first}
        self.other = np.zeros(len(self.scores), np.bool_)  # frames that hold speech of no word
        self._mark_other(search, path)

    def fits(self, word: PlacedWord) -> bool:
        """Whether the word is likely to be what is said there."""
        return word.score + self.allowance >= LEAST_FIT

    def judge(self) -> Judged:
        """All words, each heard where its neighbours leave room."""
        fitting = [
            i for i in range(len(self.rows)) if i in self.placed and self.fits(self.placed[i])
        ]
        misfits = sorted(set(range(len(self.rows))) - set(fitting))
        for run in _runs(misfits, 2 * _CONTEXT):
            self._free_neighbours(run, fitting)
        found: dict[int, tuple[int, int, float | None]] = {}
        for run in _runs(misfits, 1):
            self._place_misfits(run, fitting, found)
        self._hold()
        share, unwritten = self._share(found), self._unwritten()
        return Judged(self.placed, found, self.allowance, share, unwritten)

    def _hold(self) -> None:
        """Let a vowel at the edge of a word go on as long as its sound does."""
        indices = sorted(self.placed)
        words = [self.placed[index] for index in indices]
        ways = [self.rows[word.index].phones[word.pronunciation] for word in words]
        vowels = [(PHONES[way[0]].is_vowel, PHONES[way[-1]].is_vowel) for way in ways]
        spans = over_held(
            [(w.start, w.stop) for w in words], vowels, self.scores.weights, self.scores.static
        )
        for index, word, (start, stop) in zip(indices, words, spans, strict=True):
            self.placed[index] = word.moved(start, stop)

    def _free_neighbours(self, run: list[int], fitting: list[int]) -> None:
        """Align the words around misfits again, as if the misfits were not in the transcript."""
        for index in run:
            self.placed.pop(index, None)
        before = [i for i in fitting if i < run[0]][-_CONTEXT:]
        after = [i for i in fitting if i > run[-1]][:_CONTEXT]
        inside = [i for i in fitting if run[0] < i < run[-1]]
        words = [*before, *inside, *after]
        if not words:
            return
        start = self.placed[before[0]].start if before else (
            max(self.placed[words[0]].start - _FARTHEST, 0))  # fmt: skip
        stop = self.placed[after[-1]].stop if after else (
            min(self.placed[words[-1]].stop + _FARTHEST, len(self.scores)))  # fmt: skip
        search, path = self._search(words, start, stop, _LOOSE)
        self._mark_other(search, path)
        for word in placed_words(search.graph, path):
            index = words[word.index]
            self.placed[index] = replace(word, index=index)

    def _place_misfits(
        self, run: list[int], fitting: list[int],
        found: dict[int, tuple[int, int, float | None]],
    ) -> None:  # fmt: skip
        """Put misfits between their neighbours, and take back those that fit there after all."""
        before = [self.placed[i].stop for i in fitting if i < run[0]][-1:]
        after = [self.placed[i].start for i in fitting if i > run[-1]][:1]
        start, stop = (before or [0])[0], (after or [len(self.scores)])[0]
        shortest = sum(3 * min(map(len, self.rows[i].model_phones)) for i in run)
        if stop - start < shortest or stop - start > 2 * _FARTHEST:
            found.update((i, (start, stop, None)) for i in run)
            return
        search, path = self._search(run, start, stop, STRICT)
        for word in placed_words(search.graph, path):
            index = run[word.index]
            placed = replace(word, index=index)
            if not self.fits(placed):
                found[index] = placed.start, placed.stop, placed.score
            if self.fits(placed) or self._is_spoken(placed):
                self.placed[index] = placed

    def _is_spoken(self, word: PlacedWord) -> bool:
        return float(self.other[word.start : word.stop].mean()) >= _LEAST_SPOKEN

    def _mark_other(self, search: Search, path: Sequence[Segment]) -> None:
        for segment in path:
            if search.graph.senones[segment.node, 0] == ANY_SPEECH:
                self.other[segment.start : segment.stop] = True

    def _share(self, misfits: Container[int]) -> float:
        """Frames of fitting words over those, other speech, and what misfits would take."""
        fitting = np.zeros(len(self.scores), np.bool_)
        for index, word in self.placed.items():
            if index not in misfits:
                fitting[word.start : word.stop] = True
        other = int((self.other & ~fitting).sum())
        missing = sum(
            _USUAL_FRAMES * len(row.phones[0]) for i, row in enumerate(self.rows) if i in misfits
        )
        return float(fitting.sum() / max(fitting.sum() + other + missing, 1))

    def _unwritten(self) -> list[tuple[int, int]]:
        """Speech of no word, across the short pauses in it, where there is much of it."""
        free = self.other.copy()
        for word in self.placed.values():
            free[word.start : word.stop] = False
        return [
            (run[0], run[-1] + 1)
            for run in _runs(np.flatnonzero(free).tolist(), _PAUSE)
            if len(run) >= _MUCH
        ]

    def _search(
        self, words: Sequence[int], start: int, stop: int, costs: Costs
    ) -> tuple[Search, list[Segment]]:
        graph = build_graph(self.scores.model, [self.rows[i].model_phones for i in words])
        search = Search(graph, self.scores, costs)
        return search, search.run(start, stop, 0, to_end=True)


def _runs(indices: Sequence[int], reach: int) -> list[list[int]]:
    """Neighbouring indices together: those at most `reach` apart."""
    runs: list[list[int]] = []
    for index in indices:
        if runs and index - runs[-1][-1] <= reach:
            runs[-1].append(index)
        else:
            runs.append([index])
    return runs
