"""Which pairs a corpus needs and how often: table 2 and figure 2 of Xu et al. 2013, of any text.

Text gives phones by the language's pronunciations; each line is said by itself, with silence at
its ends and where a sign of punctuation stands.
"""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Final

from lipwright.bigrams.missing import stand_in
from lipwright.bigrams.values import BigramSet, Pair
from lipwright.dataset.folder import open_dataset
from lipwright.dataset.recording import PHONES_FILE
from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.files import write_whole
from lipwright.formats import read_track
from lipwright.language import Language, get_language
from lipwright.phones import SILENCE
from lipwright.track import PhoneTrack

MOST_SHARE: Final = 0.99  # of all that is said; Xu et al. 2013, section 2.1.1
COLUMNS: Final = ("rank", "pair", "count", "percent", "cumulative", "source", "from", "stand-in")

_PAUSES: Final = ",;:.!?…"
_CLOSING: Final = "\"'”’»)]}*_"


def pair_text(pair: Pair) -> str:
    """A pair as it is written; a silence that the set has no class for is named too."""
    return " ".join(one or SILENCE for one in pair)


@dataclass(frozen=True)
class Row:
    """One pair of a coverage."""

    rank: int
    """from 1, the most frequent first"""
    pair: Pair
    count: int
    share: float
    """of all pairs that are said, 0 to 1"""
    cumulative: float
    """share of this pair and all before it"""
    source: str
    """how the set came by the pair; empty if it lacks it"""
    origin: str
    """the set of the family that has the pair; empty if none"""
    stand_in: Pair | None
    """what stands in for a pair that the set lacks; None for rest"""

    def cells(self) -> tuple[str, ...]:
        """The row as text, one a name of `COLUMNS`."""
        other = "" if self.source else pair_text(self.stand_in) if self.stand_in else "rest"
        return (
            str(self.rank), pair_text(self.pair), str(self.count), f"{100 * self.share:.2f}",
            f"{100 * self.cumulative:.2f}", self.source, self.origin, other,
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Coverage:
    """What a corpus needs of a set."""

    rows: tuple[Row, ...]
    """the pairs that occur, most frequent first"""
    possible: int
    """the number of pairs of the set's classes"""

    @property
    def never(self) -> int:
        """How many pairs of classes never occur."""
        return self.possible - len(self.rows)

    @property
    def missing(self) -> tuple[Row, ...]:
        """The pairs that occur and that the set lacks."""
        return tuple(row for row in self.rows if not row.source)

    def enough(self, share: float = MOST_SHARE) -> int:
        """How many of the most frequent pairs make up at least that share."""
        return next((r.rank for r in self.rows if r.cumulative >= share - 1e-12), len(self.rows))


@dataclass(eq=False)
class Counting:
    """Pairs of phones as they are found; of phones, so that any set may ask for its classes."""

    pairs: Counter[Pair] = field(default_factory=Counter)
    """pair of phones to its number"""
    refused: list[str] = field(default_factory=list)
    """why lines were left out"""

    def add_text(self, text: str, language: str, source: str = "text") -> None:
        """Count the pairs of a text, a line at a time.

        A line that the language cannot read is left out, and why is kept in `refused`.

        Raises:
            LipwrightError: the language is unknown.
        """
        speaker = get_language(language)
        said: dict[str, tuple[str, ...]] = {}
        for number, line in enumerate(text.splitlines(), start=1):
            if any(map(str.isalnum, line)):
                try:
                    phones = list(_line_phones(speaker, line, said))
                except LipwrightError as error:
                    reason = str(error).removeprefix("line: ").removeprefix("line 1, ")
                    self.refused.append(f"{source}: line {number}: {reason}")
                else:
                    self.pairs.update(pairwise(phones))

    def add_track(self, track: PhoneTrack) -> None:
        """Count the pairs of a track; silences that follow each other are one."""
        phones = [
            phone
            for index, phone in enumerate(track.phones)
            if not (phone == SILENCE and index and track.phones[index - 1] == SILENCE)
        ]
        self.pairs.update(pairwise(phones))

    def coverage(
        self, bigrams: BigramSet, origins: Mapping[Pair, str] | None = None, *, pauses: bool = True
    ) -> Coverage:
        """What was counted, in the classes of a set.

        Args:
            bigrams: the set.
            origins: pair to the set that it comes from, as `families.origins` gives it.
            pauses: pairs with silence count too.
        """
        counts: Counter[Pair] = Counter()
        for (first, second), count in self.pairs.items():
            if pauses or SILENCE not in (first, second):
                counts[bigrams.class_of(first), bigrams.class_of(second)] += count
        return cover(bigrams, counts, origins, pauses=pauses)


def cover(
    bigrams: BigramSet,
    counts: Mapping[Pair, int],
    origins: Mapping[Pair, str] | None = None,
    *,
    pauses: bool = True,
) -> Coverage:
    """The coverage of pairs of classes that are said so often."""
    return Coverage(tuple(_rows(bigrams, counts, origins or {})), _possible(bigrams, pauses))


def dataset_tracks(path: Path) -> Iterator[PhoneTrack]:
    """The phones of a dataset's usable recordings.

    Raises:
        LipwrightError: it is no dataset, or a file of it is broken.
    """
    dataset = open_dataset(path)
    for name in dataset.names():
        yield read_track(dataset.folder(name) / PHONES_FILE)


def _rows(
    bigrams: BigramSet, counts: Mapping[Pair, int], origins: Mapping[Pair, str]
) -> Iterator[Row]:
    total, before = sum(counts.values()), 0
    ordered = sorted(counts.items(), key=lambda row: (-row[1], row[0]))
    for rank, (pair, count) in enumerate(ordered, start=1):
        before += count
        bigram, other = stand_in(bigrams, pair)
        has = bigram is not None and other == pair
        yield Row(
            rank, pair, count, count / total, before / total,
            source=bigram.source if bigram is not None and has else "",
            origin=origins.get(pair, bigrams.name) if has else "",
            stand_in=other,
        )  # fmt: skip


def _possible(bigrams: BigramSet, pauses: bool) -> int:
    """The number of pairs that phones can make; a silence never follows a silence."""
    held = {name for name, phones in bigrams.classes.items() if phones}
    silent = {name for name in held if SILENCE in bigrams.classes[name]}
    sounds = len(held - silent)
    return sounds**2 + (2 * sounds if pauses else 0)


def _line_phones(language: Language, line: str, said: dict[str, tuple[str, ...]]) -> Iterator[str]:
    """The phones of a line, with silence around it and at its punctuation."""
    words = language.normalize(line, "line")
    yield SILENCE
    for index, word in enumerate(words):
        if word.text not in said:
            said[word.text] = language.pronounce(word.text)[0].phones
        yield from said[word.text]
        is_last = index + 1 == len(words)
        after = None if is_last else words[index + 1]
        if after is not None and after.column != word.column and _pauses(word.written, word.text):
            yield SILENCE
    yield SILENCE


def _pauses(written: str, spoken: str) -> bool:
    """Whether a pause follows a token; the dot of an abbreviation is none."""
    bare = written.rstrip(_CLOSING)
    if not bare or bare[-1] not in _PAUSES:
        return False
    letters = bare.rstrip(_PAUSES).lstrip("\"'“‘«([{*_")
    is_short = bare[-1] == "." and letters.casefold() != spoken
    return not (is_short or (bare[-1] == "." and len(letters) == 1))


def write_table(path: Path, coverage: Coverage) -> None:
    """Write all rows as CSV, whole or not at all.

    Raises:
        LipwrightError: the file cannot be written.
    """
    with write_whole(path) as part, part.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        table.writerows(row.cells() for row in coverage.rows)


def draw_distribution(path: Path, coverage: Coverage) -> None:
    """Draw figure 2 of the paper: the share of each pair, most frequent first, as PNG.

    Raises:
        MissingExtraError: matplotlib is not installed.
        LipwrightError: the file cannot be written.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("matplotlib", "studio") from None
    figure = Figure(figsize=(8, 4.5), layout="constrained")
    axes = figure.add_subplot()
    ranks = [row.rank for row in coverage.rows]
    for is_there, colour, label in (
        (True, "tab:blue", "in the set"),
        (False, "tab:red", "missing"),
    ):
        heights = [100 * row.share if bool(row.source) == is_there else 0 for row in coverage.rows]
        if any(heights):
            axes.bar(ranks, heights, width=1.0, color=colour, label=label)
    axes.set_xlabel("pairs of phone classes, most frequent first")
    axes.set_ylabel("share of all pairs (%)")
    whole = axes.twinx()
    whole.plot(ranks, [100 * row.cumulative for row in coverage.rows], color="black", linewidth=1)
    whole.axvline(coverage.enough(), color="grey", linestyle=":")
    whole.set_ylabel("cumulative (%)")
    whole.set_ylim(0, 100)
    axes.legend(loc="center right")
    with write_whole(path) as part:
        figure.savefig(part, format="png", dpi=120)


WRITERS: Final = {".csv": write_table, ".png": draw_distribution}
"""suffix to what writes a coverage"""
