"""Which recordings are for training, which for choosing between models, which for the test.

By a hash of the name and nothing else, so that a recording keeps its place in the order when
others come or go.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from fnmatch import fnmatchcase
from typing import Any, Final

from lipwright.dataset.folder import FAILED, MANIFEST_FILE, Dataset
from lipwright.dataset.recording import read_info
from lipwright.errors import LipwrightError

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


def split_names(
    names: Iterable[str],
    options: SplitOptions | None = None,
    kept: Mapping[str, str] | None = None,
) -> dict[str, str]:
    """Name to `train`, `validation` or `test`.

    With the same two counts, more names never bring one from training into the others.

    Args:
        names: of all recordings.
        options: how many for what.
        kept: name to the split that it must stay in; the other names fill what is missing there.

    Raises:
        ValueError: test and validation would leave nothing to train on.
    """
    options, kept = options or SplitOptions(), kept or {}
    order = sorted(names, key=lambda name: split_order(name, options.seed))
    usual = default_count(len(order))
    test = usual if options.test is None else options.test
    validation = usual if options.validation is None else options.validation
    if order and test + validation >= len(order):
        raise ValueError(
            f"{test} for the test and {validation} for validation leave none of the "
            f"{len(order)} recordings to train on"
        )
    stay = [kept[name] for name in order if name in kept]
    places = [TEST] * (test - stay.count(TEST))
    places += [VALIDATION] * (validation - stay.count(VALIDATION))
    free = iter(places)
    return {name: kept[name] if name in kept else next(free, TRAIN) for name in order}


def is_held_out(name: str, words: Iterable[str], options: SplitOptions) -> bool:
    """Whether a recording of that name, which says `words`, is kept from training."""
    held = {_bare(word) for word in options.hold_out_words}
    return any(fnmatchcase(name, pattern) for pattern in options.hold_out) or any(
        _bare(word) in held for word in words
    )


def _bare(word: str) -> str:
    """A word without what a writer puts around it."""
    return word.casefold().strip(" .,;:!?\"()'")


def split_options(manifest: Mapping[str, Any]) -> SplitOptions:
    """How a dataset was split last; the usual way where its manifest does not say.

    Raises:
        LipwrightError: what it says is no such thing.
    """
    stored = manifest.get("split", {})
    try:
        return SplitOptions(
            stored.get("test"),
            stored.get("validation"),
            str(stored.get("seed", SEED)),
            tuple(map(str, stored.get("hold_out", ()))),
            tuple(map(str, stored.get("hold_out_words", ()))),
        )
    except (AttributeError, TypeError, ValueError) as error:
        raise LipwrightError(
            f"{MANIFEST_FILE}: 'split' is broken ({error}); run: lipwright dataset split"
        ) from error


def check_hold_outs(dataset: Dataset, options: SplitOptions) -> None:
    """Refuse a pattern or a word that holds nothing out, as a slip of the pen does.

    Raises:
        LipwrightError: there is one.
    """
    words = _words(dataset, options)
    said = {_bare(word) for spoken in words.values() for word in spoken}
    for word in options.hold_out_words:
        if _bare(word) not in said:
            raise LipwrightError(f"{dataset.path}: no recording says {word!r}")
    for pattern in options.hold_out:
        if not any(fnmatchcase(name, pattern) for name in words):
            raise LipwrightError(f"{dataset.path}: no recording has a name like {pattern!r}")


def split_dataset(dataset: Dataset, options: SplitOptions, *, keep: bool = False) -> Dataset:
    """The dataset split anew, and `options` kept in its manifest; nothing is written.

    All recordings take part, rejected and failed ones too, so that none moves when another is
    rejected.

    Args:
        dataset: what to split.
        options: how.
        keep: recordings that have a split stay there, as far as they are not held out.

    Raises:
        LipwrightError: a file cannot be read, or nothing is left to train on.
    """
    words = _words(dataset, options)
    kept = {
        entry["name"]: entry["split"]
        for entry in dataset.entries
        if keep and entry.get("split") in (TRAIN, VALIDATION, TEST)
    }
    try:
        splits = split_names(words, options, kept)
    except ValueError as error:
        raise LipwrightError(f"{dataset.path}: {error}; give smaller numbers") from error
    for name, said in words.items():
        if is_held_out(name, said, options):
            splits[name] = UNSEEN
    if splits and TRAIN not in splits.values():
        raise LipwrightError(f"{dataset.path}: nothing is left to train on; hold out less")
    entries = [{**entry, "split": splits[entry["name"]]} for entry in dataset.entries]
    how = {**asdict(options), "hold_out": list(options.hold_out),
           "hold_out_words": list(options.hold_out_words)}  # fmt: skip
    manifest = {**dataset.manifest, "split": how, "recordings": entries}
    return Dataset(dataset.path, manifest)


def hold_out(dataset: Dataset, options: SplitOptions) -> Dataset:
    """The dataset whose held-out recordings are `unseen`; the others stay as they are split.

    Raises:
        LipwrightError: a file cannot be read, a pattern or word holds nothing out, or nothing is
            left to train on.
    """
    check_hold_outs(dataset, options)
    words = _words(dataset, options)
    entries = [
        {**entry, "split": UNSEEN} if is_held_out(entry["name"], words[entry["name"]], options)
        else entry
        for entry in dataset.entries
    ]  # fmt: skip
    if TRAIN not in {entry.get("split") for entry in entries}:
        raise LipwrightError(f"{dataset.path}: nothing is left to train on; hold out less")
    return Dataset(dataset.path, {**dataset.manifest, "recordings": entries})


def _words(dataset: Dataset, options: SplitOptions) -> dict[str, tuple[str, ...]]:
    """Name to what is said, as far as somebody asks."""
    words: dict[str, tuple[str, ...]] = {}
    for entry in dataset.entries:
        rows: Any = ()
        if options.hold_out_words and entry["status"] != FAILED:
            rows = read_info(dataset.folder(entry["name"])).get("words")
        rows = rows if isinstance(rows, list) else ()
        words[entry["name"]] = tuple(str(row.get("text")) for row in rows if isinstance(row, dict))
    return words
