"""The transcript as a graph of phones: what may be said, in which order, and what may be left out.

Before, between and after the words are H = W + 1 hubs. At a hub one may pause, make a noise, say
something that the transcript lacks, or skip the next word. Words that follow each other without
a pause meet phone to phone, so that each is heard in the context of the other.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.speech.acoustic import NOISE, PAUSE, AcousticModel, Position

Ints = npt.NDArray[np.int32]

Pronunciations = Sequence[Sequence[str]]
"""the ways to say one word, each a row of the model's phones; "IY|IH" is whichever of these fits
each frame best, beside neighbours that meet the first"""

FILLER_WORD: Final = -1
ANY_SPEECH: Final = -1
"""in place of senones: the node says something that the transcript lacks"""
HUB: Final = -2
"""predecessors from here down are hubs: hub h is written HUB - h"""

PAUSE_COST: Final = 3.0  # nats
NOISE_COST: Final = 18.0  # nats, pocketsphinx: fillprob 1e-8


@dataclass(frozen=True, eq=False)
class Graph:
    """N nodes, one for each phone in one context, in the order of the words, and H hubs."""

    senones: Ints
    """(N, 3), or ANY_SPEECH; from `n_senones` on, rows of `choices`"""
    base: Ints
    """(N,) base phone, which has the transition probabilities"""
    hub: Ints
    """(N,) the hub that the node stands at, or that its word follows"""
    pronunciation: Ints
    """(N,) index among those of its word, or FILLER_WORD"""
    position: Ints
    """(N,) index of the phone in the pronunciation"""
    cost: npt.NDArray[np.float32]
    """(N,) nats to enter the node; of ANY_SPEECH, the search decides"""
    predecessors: tuple[tuple[int, ...], ...]
    """N rows of nodes and hubs from which the node may be entered"""
    exits: tuple[tuple[int, ...], ...]
    """H rows of the nodes that lead to the hub"""
    starts: Ints
    """(H + 1,) the first node of each hub, and N"""
    n_senones: int
    """of the acoustic model"""
    choices: tuple[tuple[int, ...], ...]
    """rows of senones of which the best in each frame counts"""

    @property
    def n_hubs(self) -> int:
        """H, one more than there are words."""
        return len(self.exits)


class _Builder:
    def __init__(self, model: AcousticModel, words: Sequence[Pronunciations]) -> None:
        self.model = model
        self.pause = model.base(PAUSE)
        # The first phone of a choice stands for it in the contexts of others.
        choices = [[[p.split("|") for p in row] for row in rows] for rows in words]
        self.words = [[[model.base(p[0]) for p in row] for row in rows] for rows in choices]
        self.others = [
            [[tuple(map(model.base, p[1:])) for p in row] for row in rows] for rows in choices
        ]
        self.choices: dict[tuple[int, ...], int] = {}
        self.rows: list[tuple[tuple[int, ...], int, int, int, int, float]] = []
        self.predecessors: list[tuple[int, ...]] = []
        self.exits: list[list[int]] = [[] for _ in range(len(words) + 1)]
        self.starts: list[int] = []
        # (last phone, next phone) to the nodes that end the word before with that outlook
        self.endings: dict[tuple[int, int], list[int]] = {}

    def add(
        self, senones: tuple[int, ...], base: int, hub: int, pronunciation: int, position: int,
        cost: float, predecessors: Iterable[int],
    ) -> int:  # fmt: skip
        self.rows.append((senones, base, hub, pronunciation, position, cost))
        self.predecessors.append(tuple(predecessors))
        return len(self.rows) - 1

    def add_hub(self, hub: int) -> None:
        self.starts.append(len(self.rows))
        fillers = (
            (self.model.base(PAUSE), PAUSE_COST),
            (self.model.base(NOISE), NOISE_COST),
        )
        for base, cost in fillers:
            senones = tuple(int(s) for s in self.model.sequences[base])
            node = self.add(senones, base, hub, FILLER_WORD, 0, cost, (HUB - hub,))
            self.exits[hub].append(node)
        any_speech = (ANY_SPEECH,) * 3
        node = self.add(any_speech, self.pause, hub, FILLER_WORD, 0, 0.0, (HUB - hub,))
        self.exits[hub].append(node)

    def add_word(self, index: int) -> None:
        firsts = {row[0] for row in self.words[index + 1]} if index + 1 < len(self.words) else set()
        endings: dict[tuple[int, int], list[int]] = defaultdict(list)
        for number, phones in enumerate(self.words[index]):
            before: tuple[int, ...] = ()
            for position in range(len(phones)):
                before = self._add_phone(index, number, position, before, firsts, endings)
        self.endings = endings

    def _add_phone(
        self, index: int, number: int, position: int, before: tuple[int, ...],
        firsts: set[int], endings: dict[tuple[int, int], list[int]],
    ) -> tuple[int, ...]:  # fmt: skip
        """Add a phone in each of its contexts; nodes of equal senones are one."""
        phones = self.words[index][number]
        is_first, is_last = position == 0, position == len(phones) - 1
        place: Position = ("only" if is_last else "first") if is_first else (
            "last" if is_last else "inner")  # fmt: skip
        phone = phones[position]
        lasts = sorted({last for last, outlook in self.endings if outlook == phone})
        lefts = [self.pause, *lasts] if is_first else [phones[position - 1]]
        rights = [self.pause, *sorted(firsts)] if is_last else [phones[position + 1]]
        groups: dict[tuple[int, tuple[int, ...]], list[int]] = defaultdict(list)
        for left in lefts:
            for right in rights:
                others = self.others[index][number][position]
                # Which right contexts a node serves must not depend on the left one.
                key = right if is_first and is_last else -1
                senones = self._senones((phone, *others), left, right, place)
                groups[key, senones].append(left if is_first else right)
        nodes = []
        for (right, senones), contexts in groups.items():
            sources = self._sources(index, phone, contexts) if is_first else before
            node = self.add(senones, phone, index, number, position, 0.0, sources)
            nodes.append(node)
            if is_last:
                outlooks = [right] if is_first else contexts
                for outlook in outlooks:
                    if outlook == self.pause:
                        self.exits[index + 1].append(node)
                    else:
                        endings[phone, outlook].append(node)
        return tuple(nodes)

    def _senones(
        self, phones: tuple[int, ...], left: int, right: int, place: Position
    ) -> tuple[int, ...]:
        """The senones of the three states of a phone, or of whichever of several fits best."""
        rows = [self.model.sequence(phone, left, right, place) for phone in phones]
        states = self.model.sequences[rows].T.tolist()
        if len(phones) == 1:
            return tuple(state[0] for state in states)
        n_senones = len(self.model.senone_base)
        return tuple(
            n_senones + self.choices.setdefault(tuple(sorted(set(state))), len(self.choices))
            for state in states
        )

    def _sources(self, index: int, phone: int, lefts: Sequence[int]) -> list[int]:
        sources = [HUB - index] if self.pause in lefts else []
        for left in lefts:
            sources += self.endings.get((left, phone), ())
        return sources


def build_graph(model: AcousticModel, words: Sequence[Pronunciations]) -> Graph:
    """The graph of a transcript; each word has at least one pronunciation of at least one phone."""
    builder = _Builder(model, words)
    for index in range(len(words)):
        builder.add_hub(index)
        builder.add_word(index)
    builder.add_hub(len(words))
    senones, base, hub, pronunciation, position, cost = zip(*builder.rows, strict=True)
    return Graph(
        np.array(senones, np.int32), np.array(base, np.int32), np.array(hub, np.int32),
        np.array(pronunciation, np.int32), np.array(position, np.int32),
        np.array(cost, np.float32), tuple(builder.predecessors),
        tuple(tuple(row) for row in builder.exits),
        np.array([*builder.starts, len(builder.rows)], np.int32),
        len(model.senone_base), tuple(builder.choices),
    )  # fmt: skip
