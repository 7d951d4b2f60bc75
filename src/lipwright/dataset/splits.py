"""Which recordings are for training, which for choosing between models, which for the test.

By a hash of the name and nothing else, so that a recording keeps its place in the order when
others come or go.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Final

TRAIN, VALIDATION, TEST, UNSEEN = "train", "validation", "test", "unseen"
SPLITS: Final = (TRAIN, VALIDATION, TEST, UNSEEN)

COUNT: Final = 50  # recordings in each of test and validation, at most
SHARE: Final = 0.1  # of all names, the most that test and validation each take unasked
SEED: Final = "lipwright-split"


def split_order(name: str, seed: str = SEED) -> str:
    """The key that sorts recordings: the least are for the test, the next for validation."""
    return hashlib.sha256(f"{seed}:{name}".encode()).hexdigest()


def default_count(names: int) -> int:
    """How many of `names` recordings test and validation each take unless told otherwise."""
    return min(COUNT, math.floor(names * SHARE))


@dataclass(frozen=True)
class SplitOptions:
    """How to split.

    Raises:
        ValueError: a count is below 0.
    """

    test: int | None = None
    """recordings; None for 50, and at most a tenth of all"""
    validation: int | None = None
    """recordings; None for 50, and at most a tenth of all"""
    seed: str = SEED
    """another text gives another order"""
    hold_out: tuple[str, ...] = ()
    """patterns such as `*m??`; recordings with such names become `unseen`"""
    hold_out_words: tuple[str, ...] = ()
    """recordings that say one of these words become `unseen`; capitals do not count"""

    def __post_init__(self) -> None:
        """Check."""
        for count in (self.test, self.validation):
            if count is not None and count < 0:
                raise ValueError(f"{count} recordings; give 0 or more")


def split_names(names: Iterable[str], options: SplitOptions | None = None) -> dict[str, str]:
    """Name to `train`, `validation` or `test`.

    Raises:
        ValueError: test and validation would leave nothing to train on.
    """
    options = options or SplitOptions()
    order = sorted(names, key=lambda name: split_order(name, options.seed))
    usual = default_count(len(order))
    test = usual if options.test is None else options.test
    validation = usual if options.validation is None else options.validation
    if order and test + validation >= len(order):
        raise ValueError(
            f"{test} for the test and {validation} for validation leave none of the "
            f"{len(order)} recordings to train on"
        )
    kinds = [TEST] * test + [VALIDATION] * validation
    kinds += [TRAIN] * (len(order) - len(kinds))
    return dict(zip(order, kinds, strict=True))


def is_held_out(name: str, words: Iterable[str], options: SplitOptions) -> bool:
    """Whether a recording of that name, which says `words`, is kept from training."""
    held = {word.casefold() for word in options.hold_out_words}
    return any(fnmatchcase(name, pattern) for pattern in options.hold_out) or any(
        word.casefold() in held for word in words
    )
