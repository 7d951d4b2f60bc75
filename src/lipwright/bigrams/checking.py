"""What is odd about a set although it can be played."""

from __future__ import annotations

from collections.abc import Iterator

from lipwright.bigrams.coverage import Coverage, cover
from lipwright.bigrams.values import BigramSet
from lipwright.phones import PHONES, SILENCE

FULL = 2.0  # C that two poses between 0 and 1 never pass


def faults(bigrams: BigramSet) -> Iterator[str]:
    """A line for each thing that is likely a slip."""
    for (one, other), most in bigrams.constraints.items():
        a, b = bigrams.poses[one].priority, bigrams.poses[other].priority
        if most < FULL and a == b:
            yield (
                f"{one} and {other} exclude each other and have the same priority {a:g}; say with "
                "priorities which of them gives way"
            )
    if not any(SILENCE in phones for phones in bigrams.classes.values()):
        yield "no class holds silence; at the ends of speech every pose rests"
    used = {one for pair in bigrams.bigrams for one in pair}
    if empty := [one for one in bigrams.classes if one in used and not bigrams.classes[one]]:
        yield f"no phone is in these classes, so that their pairs are never heard: {_some(empty)}"
    moved = {pose for bigram in bigrams.bigrams.values() for pose in bigram.curves}
    if still := [pose for pose in bigrams.poses if pose not in moved]:
        yield f"no pair moves these poses: {_some(still)}"
    held = {phone for phones in bigrams.classes.values() for phone in phones}
    if not held:
        yield f"no class holds any of the {len(PHONES)} phones"


def pairs_of_set(bigrams: BigramSet) -> Coverage:
    """Every pair that the classes of a set can make, each once."""
    held = [name for name, phones in bigrams.classes.items() if phones]
    silent = {name for name in held if SILENCE in bigrams.classes[name]}
    return cover(
        bigrams,
        {
            (first, second): 1
            for first in held
            for second in held
            if not (first in silent and second in silent)
        },
    )


def _some(names: list[str]) -> str:
    return ", ".join(names)
