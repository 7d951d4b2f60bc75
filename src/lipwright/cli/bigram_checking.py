"""`lipwright bigrams check` and `coverage`: what a set lacks."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import click

from lipwright.cli.bigram_sets import set_argument
from lipwright.cli.listing import json_option
from lipwright.cli.progress import say, warn
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.bigrams.coverage import Counting, Coverage
    from lipwright.bigrams.values import BigramSet

SHOWN = 10  # missing pairs
TOP = 21  # rows, as many as table 2 of Xu et al. 2013

CHECK_EXAMPLES = """\b
Examples:
  lipwright bigrams check english --text "five of them"
    english: 9 of 9 pairs, nothing to complain of
\b
  lipwright bigrams check mine.json hero.json     # all pairs that their classes can make
"""
COVERAGE_EXAMPLES = """\b
Examples:
  lipwright bigrams coverage english words/anna1.txt --top 1
    rank  pair               count     percent  cumulative  source    from          stand-in
       1  ah bmp                 2       10.53       10.53  rule      english
\b
  lipwright bigrams coverage english corpus.txt --no-pauses -o pairs.csv -o pairs.png
\b
  lipwright bigrams coverage mine.json line1.TextGrid dataset     # of phones with times
"""


@click.command(epilog=CHECK_EXAMPLES)
@click.argument("names", metavar="SET...", nargs=-1, required=True)
@click.option("--text", metavar="TEXT", help="Only the pairs of these words, or of a file of them.")
def check(names: tuple[str, ...], text: str | None) -> int:
    """Find out whether sets can be used: pairs that they lack, constraints, poses of the rig.

    What can be played all the same is a warning; exit status 2 means that a set cannot be used.
    """
    from lipwright.cli.inputs import read_text

    words, source = (None, "") if text is None else read_text(text)
    worst = 0
    for name in names:
        try:
            _check(name, words, source)
        except LipwrightError as error:
            say(f"lipwright: {error}")
            worst = 2
    return worst


def _check(name: str, words: str | None, source: str) -> None:
    from lipwright.bigrams.checking import faults, pairs_of_set
    from lipwright.bigrams.coverage import Counting
    from lipwright.bigrams.families import load_bigrams
    from lipwright.rig import load_rig

    bigrams = load_bigrams(name)
    try:
        rig = load_rig(bigrams.rig)
    except LipwrightError as error:
        raise LipwrightError(f"{name}: {error}") from error
    if unknown := [pose for pose in bigrams.poses if pose not in rig.names]:
        raise LipwrightError(
            f"{name}: the rig {bigrams.rig} lacks the poses {', '.join(unknown)}; "
            "name another rig, or take them out"
        )
    counting = Counting()
    if words is not None:
        counting.add_text(words, bigrams.language, source)
        if counting.refused:
            raise LipwrightError(counting.refused[0])
        if not counting.pairs:
            raise LipwrightError(f"{source}: has no words; give the words that are spoken")
    needed = counting.coverage(bigrams) if words is not None else pairs_of_set(bigrams)
    complaints = list(faults(bigrams))
    for line in chain(complaints, _missing_lines(needed)):
        warn(f"{name}: {line}", "auto")
    has = len(needed.rows) - len(needed.missing)
    quiet = "" if complaints or needed.missing else ", nothing to complain of"
    say(f"{name}: {has} of {len(needed.rows)} pairs{quiet}")


def _missing_lines(needed: Coverage) -> Iterator[str]:
    from lipwright.bigrams.coverage import pair_text

    rows = needed.missing
    for row in rows[:SHOWN]:
        other = f"{pair_text(row.stand_in)} stands in" if row.stand_in else "every pose rests"
        times = f", said {row.count} times" if row.count > 1 else ""
        yield f"no pair {pair_text(row.pair)}{times}; {other}"
    if len(rows) > SHOWN:
        yield f"and {len(rows) - SHOWN} pairs more"


@click.command(epilog=COVERAGE_EXAMPLES)
@set_argument
@click.argument("inputs", metavar="TEXT...", nargs=-1, required=True)
@click.option("--language", metavar="CODE", help="Of the text; by default that of the set.")
@click.option("--pauses/--no-pauses", default=True, help="Count pairs with silence too; the paper "
              "does not.", show_default=True)  # fmt: skip
@click.option("--top", type=click.IntRange(min=0), default=TOP, show_default=True,
              help="How many pairs to print.")  # fmt: skip
@click.option("-o", "--output", "outputs", multiple=True, type=Path, metavar="FILE",
              help="Write all pairs (.csv) or draw their distribution (.png).")  # fmt: skip
@json_option
def coverage(
    name: str, inputs: tuple[str, ...], language: str | None, pauses: bool, top: int,
    outputs: tuple[Path, ...], as_json: bool,
) -> None:  # fmt: skip
    """List the pairs that a corpus needs, most frequent first, and which of them a set has.

    TEXT is a file of plain text, each line said by itself, or - for a pipe; a file of phones with
    times; or a dataset.
    """
    from lipwright.bigrams.coverage import WRITERS, Counting
    from lipwright.bigrams.families import load_family, merge, origins

    for path in outputs:
        if path.suffix.lower() not in WRITERS:
            raise LipwrightError(f"{path}: give it one of the suffixes {', '.join(WRITERS)}")
    family = load_family(name)
    bigrams = merge(family)
    counting = Counting()
    for one in inputs:
        _count(counting, one, language or bigrams.language)
    if counting.refused:
        more = f"; so were {len(counting.refused) - 1} more" if counting.refused[1:] else ""
        warn(f"left out: {counting.refused[0]}{more}", "auto")
    found = counting.coverage(bigrams, origins(family), pauses=pauses)
    if not found.rows:
        raise LipwrightError(f"{inputs[0]}: has no pairs of phones; name a text with words")
    _print(bigrams, found, top, as_json)
    for path in outputs:
        WRITERS[path.suffix.lower()](path, found)


def _count(counting: Counting, name: str, language: str) -> None:
    from lipwright.cli.inputs import piped_in
    from lipwright.formats import TRACK_FORMATS, read_track
    from lipwright.formats.source import decode_text, read_text

    path = Path(name)
    if name == "-":
        counting.add_text(decode_text("-", piped_in().read()), language, "-")
    elif path.is_dir():
        from lipwright.bigrams.coverage import dataset_tracks

        for track in dataset_tracks(path):
            counting.add_track(track)
    elif name.lower().endswith(tuple(TRACK_FORMATS)):
        counting.add_track(read_track(path))
    else:
        counting.add_text(read_text(path), language, name)


def _print(bigrams: BigramSet, found: Coverage, top: int, as_json: bool) -> None:
    from lipwright.bigrams.coverage import COLUMNS

    enough = found.enough()
    if as_json:
        rows = [dict(zip(COLUMNS, row.cells(), strict=True)) for row in found.rows]
        totals = {"possible": found.possible, "occur": len(found.rows), "never": found.never,
                  "missing": len(found.missing), "make_up_99_percent": enough}  # fmt: skip
        click.echo(json.dumps({"set": bigrams.name, **totals, "pairs": rows}, indent=1))
        return
    for cells in [COLUMNS, *(row.cells() for row in found.rows[:top])]:
        rank, pair, *numbers, made, origin, other = cells
        numerals = "".join(f"{number:>12}" for number in numbers)
        click.echo(f"{rank:>4}  {pair:12}{numerals}  {made:8}  {origin:12}  {other}".rstrip())
    click.echo(
        f"{len(found.rows)} of {found.possible} pairs occur, {found.never} never; the first "
        f"{enough} make up 99 %; {bigrams.name} lacks {len(found.missing)}"
    )
