"""The best way through a transcript's graph for a stretch of sound (Viterbi search).

Arrays are indexed by N nodes or H hubs of the part of the graph that is in reach, which moves
along with the best hypothesis, so that neither time nor memory grow with the transcript.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.speech.acoustic import PAUSE, AcousticModel
from lipwright.speech.features import Floats
from lipwright.speech.graph import ANY_SPEECH, HUB, Graph
from lipwright.speech.scores import Scores

Ints = npt.NDArray[np.intp]

BLOCK: Final = 300  # frames that are searched before the reach moves
AHEAD: Final = 60  # words in reach after the best hypothesis
BEAM: Final = 1500.0  # nats behind the best at which a hypothesis falls out of reach
NEVER: Final = np.float32(-1e30)

# nats a frame at which a pause scores at best in a held sound, which is too loud for one
_HELD_PAUSE: Final = -4.0


@dataclass(frozen=True)
class Costs:
    """What it costs to depart from the transcript."""

    skip: float = 40.0
    """nats to leave out a word"""
    begin_other: float = 10.0
    """nats to begin something that the transcript lacks"""
    other: float = 2.0
    """nats a frame of it"""

    def skips(self, count: int) -> Floats:
        """(count,) nats to leave out 0, 1, 2... words."""
        number = np.arange(count, dtype=np.float32)
        if np.isinf(self.skip):
            return np.where(number > 0, -NEVER, 0).astype(np.float32)
        return number * np.float32(self.skip)


STRICT: Final = Costs(skip=np.inf, other=1e3)
"""each word must be somewhere"""

# In noise, right words score lower, and must not be taken for wrong ones.
_NOISY: Final = Costs(skip=100.0, begin_other=20.0, other=4.0)
_CLEAN_RANGE, _NOISY_RANGE = 30.0, 15.0  # dB from the quietest to the loud frames


def costs_for(dynamic_range: float) -> Costs:
    """What suits a recording whose speech rises `dynamic_range` dB over its floor."""
    share = (_CLEAN_RANGE - dynamic_range) / (_CLEAN_RANGE - _NOISY_RANGE)
    noisy, clean = float(np.clip(share, 0, 1)), Costs()
    return Costs(
        clean.skip + noisy * (_NOISY.skip - clean.skip),
        clean.begin_other + noisy * (_NOISY.begin_other - clean.begin_other),
        clean.other + noisy * (_NOISY.other - clean.other),
    )


@dataclass(frozen=True)
class Segment:
    """A node that was passed through."""

    node: int
    start: int
    """frame"""
    stop: int
    """frame after its last"""
    score: float
    """nats by which it beats any speech, summed over its frames as they count"""
    weight: float
    """frames that it counts for: as many as it has, fewer in held sounds"""


@dataclass(frozen=True, eq=False)
class _Block:
    """What was decided in frames `start` and after, to trace back by."""

    start: int
    first_node: int
    first_hub: int
    arrived: npt.NDArray[np.bool_]
    """(T, 3, N) whether the state was entered at this frame"""
    choices: npt.NDArray[np.uint8]
    """(T, M) which predecessor, for the M nodes that have several"""
    choosers: Ints
    """(N,) row of `choices` of each node, or -1"""
    exits: npt.NDArray[np.uint8]
    """(T, H) which node led to each hub"""
    skipped: npt.NDArray[np.bool_]
    """(T, H) whether the hub was reached from the hub before, leaving out a word"""
    ratios: Floats
    """(T, S)"""
    columns: Ints
    """(3, N) column of `ratios` of each state"""


def _padded(rows: Sequence[Sequence[int]], empty: int) -> Ints:
    table = np.full((len(rows), max(map(len, rows), default=1)), empty, np.intp)
    for index, row in enumerate(rows):
        table[index, : len(row)] = row
    return table


def _ratios(search: Search, start: int, stop: int, senones: Ints) -> Floats:
    """(stop - start, len(senones)) of senones, sorted, and of the graph's choices of them."""
    count = int(np.searchsorted(senones, search.graph.n_senones))
    if count == len(senones):
        return search.scores.ratios(start, stop, senones)
    rows = [search.graph.choices[i - search.graph.n_senones] for i in senones[count:]]
    needed = np.unique(np.concatenate([senones[:count], *rows]))
    heard = search.scores.ratios(start, stop, needed)
    best = [heard[:, np.searchsorted(needed, row)].max(axis=1) for row in rows]
    return np.column_stack([heard[:, np.searchsorted(needed, senones[:count])], *best])


def _weigh(
    ratios: Floats, weights: Floats, senones: npt.NDArray[Any], pauses: npt.NDArray[Any]
) -> None:
    """Let held sounds count less: `ratios` (T, S) by weights (T, 1) of their frames."""
    no_pause = (weights < 1) & np.isin(senones, pauses)
    np.minimum(ratios, np.where(no_pause, np.float32(_HELD_PAUSE), np.float32(np.inf)), out=ratios)
    ratios *= weights


_NOWHERE: Final = np.iinfo(np.intp).min


class Search:
    """Finds paths through one graph."""

    def __init__(self, graph: Graph, scores: Scores, costs: Costs | None = None) -> None:
        """A search for the words of `graph` in the sound of `scores`."""
        self.graph, self.scores, self.costs = graph, scores, costs or Costs()
        model: AcousticModel = scores.model
        self._stay = model.transitions[graph.base, :, 0].T.copy()  # (3, N)
        self._leave = model.transitions[graph.base, :, 1].T.copy()
        self._only = np.array([row[0] if row else _NOWHERE for row in graph.predecessors], np.intp)
        self._choosers = np.array(
            [i for i, p in enumerate(graph.predecessors) if len(p) > 1], np.intp
        )
        self._several = _padded([graph.predecessors[i] for i in self._choosers], _NOWHERE)
        self._exits = _padded(graph.exits, _NOWHERE)
        self.pauses = model.sequences[model.base(PAUSE)]
        is_other = graph.senones[:, 0] == ANY_SPEECH
        self._cost = graph.cost + np.where(is_other, self.costs.begin_other, 0).astype(np.float32)

    def run(self, start: int, stop: int, first_hub: int, to_end: bool) -> list[Segment]:
        """The best path over frames `start` to `stop` from `first_hub` on.

        With `to_end`, it ends at a hub, and pays for each word that is left.
        """
        reach = _Reach(self, first_hub, min(first_hub + AHEAD, self.graph.n_hubs - 1))
        reach.begin(first_hub)
        blocks = []
        for low in range(start, stop, BLOCK):
            if low > start:
                reach = reach.moved()
            blocks.append(reach.advance(low, min(low + BLOCK, stop)))
        if to_end:
            return self._trace(blocks, stop, HUB - reach.best_hub(), 0)
        node, state = reach.best_state()
        return self._trace(blocks, stop, node, state)

    def _trace(self, blocks: list[_Block], stop: int, place: int, state: int) -> list[Segment]:
        path = []
        end, total = stop, 0.0
        frame = stop - 1
        while blocks:
            block = blocks[-1]
            row = frame - block.start
            if row < 0:
                blocks.pop()
                continue
            if place <= HUB:
                hub = HUB - place - block.first_hub
                while block.skipped[row, hub]:
                    hub -= 1
                place, state = int(self._exits[hub + block.first_hub, block.exits[row, hub]]), 2
            node = place - block.first_node
            total += float(block.ratios[row, block.columns[state, node]])
            if block.arrived[row, state, node]:
                state -= 1
                if state < 0:
                    weight = float(self.scores.weights[frame:end].sum())
                    path.append(Segment(place, frame, end, total, weight))
                    end, total, state = frame, 0.0, 2
                    chooser = block.choosers[node]
                    which = 0 if chooser < 0 else block.choices[row, chooser]
                    place = self.graph.predecessors[place][which]
            frame -= 1
        return path[::-1]


class _Reach:
    """Hubs `first` to `last` and the nodes that stand there, with the scores of their states."""

    def __init__(self, search: Search, first: int, last: int) -> None:
        self.search, self.first, self.last = search, first, last
        graph = search.graph
        # The nodes of the word after the last hub stay out, its fillers are in.
        self.low = int(graph.starts[first])
        self.high = int(graph.starts[last + 1])
        self.nodes, self.hubs = slice(self.low, self.high), slice(first, last + 1)
        n_nodes, n_hubs = self.high - self.low, last + 1 - first
        self.states: Floats = np.full((3, n_nodes), NEVER, np.float32)
        self.at_hub: Floats = np.full(n_hubs, NEVER, np.float32)
        self._ramp = search.costs.skips(n_hubs)
        self._only = self._local(search._only[self.nodes])
        low, high = np.searchsorted(search._choosers, (self.low, self.high))
        self._choosers = search._choosers[low:high] - self.low
        self._several = self._local(search._several[low:high])
        self._exits = self._local(search._exits[self.hubs])
        self._which = np.full(n_nodes, -1, np.intp)
        self._which[self._choosers] = np.arange(len(self._choosers))

    def _local(self, places: Ints) -> Ints:
        """Indices into nodes, then hubs, then one place that is never reached."""
        n_nodes, n_hubs = self.high - self.low, self.last + 1 - self.first
        nowhere = n_nodes + n_hubs
        nodes = np.where((places >= self.low) & (places < self.high), places - self.low, nowhere)
        hubs = HUB - np.where(places <= HUB, np.maximum(places, HUB - 2**40), HUB)
        inside = (places <= HUB) & (hubs >= self.first) & (hubs <= self.last)
        return np.where(inside, hubs - self.first + n_nodes, nodes)

    def begin(self, hub: int) -> None:
        """Nothing was said yet; the next word is that of `hub`."""
        self.at_hub[hub - self.first :] = -self.search.costs.skips(self.last + 1 - hub)

    def moved(self) -> _Reach:
        """The reach for the next block, with the scores of what both have."""
        hubs = self.search.graph.hub[self.nodes]
        best_of_node = self.states.max(axis=0)
        top = float(best_of_node.max())
        alive = hubs[best_of_node > top - BEAM]
        first = int(alive.min())
        best = int(hubs[best_of_node.argmax()])
        last = max(min(best + AHEAD, self.search.graph.n_hubs - 1), self.last)
        reach = _Reach(self.search, first, last)
        cut = reach.low - self.low
        reach.states[:, : self.high - reach.low] = self.states[:, cut:] - top
        kept = self.at_hub[first - self.first :] - top
        reach.at_hub[: len(kept)] = kept
        fresh = self.search.costs.skips(len(reach.at_hub) - len(kept) + 1)[1:]
        reach.at_hub[len(kept) :] = kept[-1] - fresh
        return reach

    def advance(self, start: int, stop: int) -> _Block:
        """Hear frames `start` to `stop`."""
        graph, search = self.search.graph, self.search
        senones, columns = np.unique(graph.senones[self.nodes].T, return_inverse=True)
        columns = columns.reshape(3, -1)
        spoken = senones[senones != ANY_SPEECH]
        ratios = np.full((stop - start, len(senones)), -search.costs.other, np.float32)
        ratios[:, len(senones) - len(spoken) :] = _ratios(search, start, stop, spoken)
        weights = search.scores.weights[start:stop, None]
        _weigh(ratios, weights, senones, search.pauses)
        n_frames, n_nodes, n_hubs = len(ratios), self.high - self.low, len(self.at_hub)
        arrived = np.empty((n_frames, 3, n_nodes), np.bool_)
        choices = np.empty((n_frames, len(self._choosers)), np.uint8)
        exits = np.empty((n_frames, n_hubs), np.uint8)
        skipped = np.empty((n_frames, n_hubs), np.bool_)
        stay, leave = search._stay[:, self.nodes], search._leave[:, self.nodes]
        cost = search._cost[self.nodes]
        places = np.full(n_nodes + n_hubs + 1, NEVER, np.float32)
        states: Floats = self.states
        at_hub: Floats = self.at_hub
        choosers, hub_rows = np.arange(len(self._choosers)), np.arange(n_hubs)
        arrive = np.empty_like(states)
        ramp, strict = self._ramp, np.isinf(search.costs.skip)
        for frame in range(n_frames):
            left = states + leave
            places[:n_nodes] = left[2]
            places[n_nodes:-1] = at_hub
            entries = places[self._only]
            several = places[self._several]
            which = several.argmax(axis=1)
            choices[frame] = which
            entries[self._choosers] = several[choosers, which]
            np.subtract(entries, cost, out=arrive[0])
            arrive[1:] = left[:2]
            states = states + stay * weights[frame]
            np.greater(arrive, states, out=arrived[frame])
            np.maximum(arrive, states, out=states)
            states += ratios[frame][columns]
            places[:n_nodes] = states[2] + leave[2]
            leading = places[self._exits]
            which = leading.argmax(axis=1)
            exits[frame] = which
            direct = leading[hub_rows, which]
            at_hub = direct if strict else np.maximum.accumulate(direct + ramp) - ramp
            # Rounding must not look like a word left out.
            np.greater(at_hub, direct + 0.01, out=skipped[frame])
        self.states = states
        self.at_hub = at_hub
        return _Block(start, self.low, self.first, arrived, choices, self._which, exits, skipped,
                      ratios, columns)  # fmt: skip

    def best_state(self) -> tuple[int, int]:
        """The node and state of the best hypothesis."""
        state, node = np.unravel_index(self.states.argmax(), self.states.shape)
        return int(node) + self.low, int(state)

    def best_hub(self) -> int:
        """The hub of the best hypothesis that has said what it began, and skips what is left."""
        if np.isinf(self.search.costs.skip):
            return self.last
        return int((self.at_hub + self._ramp).argmax()) + self.first
