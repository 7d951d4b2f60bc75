"""How many phones were recognised wrongly, against phones that are known."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from lipwright.phones import BILABIALS, PHONES, SILENCE
from lipwright.track import PhoneTrack

# What the reference, a pronouncing dictionary, writes with one symbol counts as one phone
# (Lee and Hon 1989 fold TIMIT's phones in this way).
SAME = MappingProxyType({
    "AX": "AH", "IX": "IH", "AXR": "ER", "HV": "HH", "UX": "UW", "WH": "W", "DX": "D", "EL": "L",
    "EN": "N", "EM": "M", "NX": "N", "ENG": "NG",
})  # fmt: skip
LEFT_OUT = frozenset((SILENCE, "Q"))
EDGE_REACH = 0.1  # s, farthest apart that two starts of equal phones are compared

Pair = tuple[str | None, str | None]
"""a reference phone and the estimated one, or None where one of them has no counterpart"""


@dataclass
class PhoneErrors:
    """Counts over some recordings, and the errors of edges."""

    pairs: Counter[Pair] = field(default_factory=Counter)
    edges: list[float] = field(default_factory=list)
    """s, starts of phones that are right, estimated minus reference"""

    @classmethod
    def of(cls, tracks: Iterable[tuple[PhoneTrack, PhoneTrack]]) -> PhoneErrors:
        """Of pairs of reference and estimated tracks."""
        errors = cls()
        for reference, estimated in tracks:
            errors.add(reference, estimated)
        return errors

    def add(self, reference: PhoneTrack, estimated: PhoneTrack | None) -> None:
        """One more recording; None where nothing was recognised."""
        known, starts = _spoken(reference)
        heard, times = _spoken(estimated) if estimated is not None else ([], [])
        for i, j in match(known, heard):
            self.pairs[None if i is None else known[i], None if j is None else heard[j]] += 1
            if i is not None and j is not None and known[i] == heard[j]:
                error = times[j] - starts[i]
                self.edges += [error] if abs(error) < EDGE_REACH else []

    @property
    def phones(self) -> int:
        """Phones of the reference."""
        return sum(count for (known, _), count in self.pairs.items() if known)

    def rate(self) -> tuple[float, float, float]:
        """Substitutions, deletions and insertions over the phones of the reference."""
        found = [0, 0, 0]
        for (known, heard), count in self.pairs.items():
            if known != heard:
                found[1 if heard is None else 2 if known is None else 0] += count
        total = max(self.phones, 1)
        return found[0] / total, found[1] / total, found[2] / total

    def bilabials(self) -> tuple[float, float]:
        """Recall and precision of p, b and m, whichever of them."""
        both = sum(n for (k, h), n in self.pairs.items() if k in BILABIALS and h in BILABIALS)
        known = sum(n for (k, _), n in self.pairs.items() if k in BILABIALS)
        heard = sum(n for (_, h), n in self.pairs.items() if h in BILABIALS)
        return both / max(known, 1), both / max(heard, 1)

    def by_class(self) -> dict[str, tuple[int, float]]:
        """Manner (or vowel) of the reference: how many, and what share of them is not right."""
        total: Counter[str] = Counter()
        wrong: Counter[str] = Counter()
        for (known, heard), count in self.pairs.items():
            if known is not None:
                total[PHONES[known].manner or "vowel"] += count
                wrong[PHONES[known].manner or "vowel"] += count * (known != heard)
        return {name: (total[name], wrong[name] / total[name]) for name in total}

    def __str__(self) -> str:
        """One line."""
        substituted, deleted, inserted = self.rate()
        recall, precision = self.bilabials()
        edge = 1000 * float(np.median(np.abs(self.edges))) if self.edges else float("nan")
        return (
            f"phone error rate {substituted + deleted + inserted:.3f} (substituted "
            f"{substituted:.3f}, deleted {deleted:.3f}, inserted {inserted:.3f}); bilabials found "
            f"{recall:.3f}, right {precision:.3f}; edges {edge:.0f} ms"
        )


def _spoken(track: PhoneTrack) -> tuple[list[str], list[float]]:
    kept = [(SAME.get(p, p), start) for p, start, _ in track if p not in LEFT_OUT]
    return [phone for phone, _ in kept], [start for _, start in kept]


def match(
    reference: Sequence[str], estimated: Sequence[str]
) -> list[tuple[int | None, int | None]]:
    """Indices of phones that stand for each other, by the least number of edits."""
    cost: npt.NDArray[np.int64] = np.zeros((len(reference) + 1, len(estimated) + 1), np.int64)
    cost[:, 0], cost[0] = np.arange(len(reference) + 1), np.arange(len(estimated) + 1)
    for i, one in enumerate(reference):
        for j, other in enumerate(estimated):
            cost[i + 1, j + 1] = min(
                cost[i, j] + (one != other), cost[i, j + 1] + 1, cost[i + 1, j] + 1
            )
    i, j = len(reference), len(estimated)
    pairs: list[tuple[int | None, int | None]] = []
    while i or j:
        if i and j and cost[i, j] == cost[i - 1, j - 1] + (reference[i - 1] != estimated[j - 1]):
            i, j = i - 1, j - 1
            pairs.append((i, j))
        elif i and cost[i, j] == cost[i - 1, j] + 1:
            i -= 1
            pairs.append((i, None))
        else:
            j -= 1
            pairs.append((None, j))
    return pairs[::-1]
