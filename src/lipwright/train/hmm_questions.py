"""Questions about quinphones, generated from the phone table, for the trees of the hmm engine.

Each asks of one of five phones whether it is a certain phone, or has an attribute of
features/linguistic.py: made there, so, voiced, rounded, a vowel of that height (Odell 1995;
Taylor et al. 2017, section 8.1, have 749 such questions).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.engines.hmm import PLACES
from lipwright.features.linguistic import ATTRIBUTES, CLUSTERS, REGIONS, attributes_of
from lipwright.phones import PHONES, Phone

WHERE: Final = ("second before", "before", "the phone", "after", "second after")
"""the five phones"""


@dataclass(frozen=True, eq=False)
class Questions:
    """The sets of phones that may be asked for, of each of the five phones."""

    names: tuple[str, ...]
    """of K sets"""
    members: npt.NDArray[np.bool_]
    """(K, P), the P phones of each set"""

    def __len__(self) -> int:
        """How many questions there are: sets times places."""
        return PLACES * len(self.names)


def attributes_seen(phone: Phone) -> tuple[str, ...]:
    """All that is asked of a phone, itself included."""
    place = phone.place
    also = (f"place like {CLUSTERS[place]}", f"made with the {REGIONS[place]}") if place else ()
    voiced = f"{'voiced' if phone.voiced else 'voiceless'} {phone.manner}" if place else ""
    return (phone.symbol, *attributes_of(phone), *also, *((voiced,) if voiced else ()))


def all_questions() -> Questions:
    """The questions of the whole phone table."""
    table = tuple(PHONES.values())
    seen = [attributes_seen(phone) for phone in table]
    names = tuple(dict.fromkeys(
        (*PHONES, *(name for name in ATTRIBUTES if any(name in held for held in seen)),
         *(name for held in seen for name in held))
    ))  # fmt: skip
    return Questions(names, np.array([[name in held for held in seen] for name in names]))


def questions_of(phones: Sequence[str]) -> Questions:
    """Those that tell some phones apart, each set once, by its first name.

    Args:
        phones: P symbols of the phone table.
    """
    every = all_questions()
    columns = [list(PHONES).index(phone) for phone in phones]
    kept: dict[bytes, int] = {}
    for row, members in enumerate(every.members[:, columns]):
        if members.any() and not members.all():
            kept.setdefault(members.tobytes(), row)
    rows = list(kept.values())
    return Questions(tuple(every.names[row] for row in rows), every.members[np.ix_(rows, columns)])
