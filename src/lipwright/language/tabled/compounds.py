"""Compounds: a long word as words of the lexicon, with the letters that join them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cache
from typing import Final

_SHORTEST: Final = 3  # letters of a part
_LONGEST_PART: Final = 24  # letters
_LONGEST: Final = 120  # letters of a compound; a number below a trillion has about 100
_SHORT_COST: Final = 1.5  # of a part of three letters; longer parts cost 1
_LINK_COST: Final = 0.25


def parts_of(word: str) -> Iterable[str]:
    """Every stretch of the word that might be a part."""
    if 2 * _SHORTEST <= len(word) <= _LONGEST:
        for start in range(len(word) - _SHORTEST + 1):
            for end in range(start + _SHORTEST, min(len(word), start + _LONGEST_PART) + 1):
                yield word[start:end]


def split_compound(
    word: str, is_known: Callable[[str], bool], links: Sequence[str]
) -> tuple[tuple[str, str], ...]:
    """The parts of a compound, each with the link behind it; none if it is not one.

    The fewest parts win, and of as many the ones with the fewest short parts and links.
    """
    if not 2 * _SHORTEST <= len(word) <= _LONGEST:
        return ()
    unsplit = float("inf")

    @cache
    def best(start: int) -> tuple[float, tuple[tuple[str, str], ...]]:
        if start == len(word):
            return 0.0, ()
        found: tuple[float, tuple[tuple[str, str], ...]] = (unsplit, ())
        for end in range(start + _SHORTEST, min(len(word), start + _LONGEST_PART) + 1):
            part = word[start:end]
            if part == word or not is_known(part):
                continue
            cost = _SHORT_COST if len(part) == _SHORTEST else 1.0
            for link in ("", *links):
                behind = end + len(link)
                if not word.startswith(link, end) or (link and behind >= len(word)):
                    continue
                rest, parts = best(behind)
                total = cost + rest + (_LINK_COST if link else 0.0)
                if total < found[0]:
                    found = total, ((part, link), *parts)
        return found

    return best(0)[1]
