"""`lipwright bigrams fit`: a set out of captured faces."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import click

from lipwright.cli.bigram_sets import parent_name
from lipwright.cli.progress import progress_option, progress_report, say
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.train.bigram_set import FittedSet

FIT_EXAMPLES = """\b
Examples:
  lipwright bigrams fit anna -o anna.json --licence "mine" --least 1
    anna.json: 36 pairs fitted to 2 recordings, 447 by rule
\b
  lipwright bigrams fit anna -o anna.json --parent english    # only what anna said, over english
"""


@click.command(epilog=FIT_EXAMPLES)
@click.argument("dataset", type=Path)
@click.option("-o", "--output", required=True, type=Path, metavar="FILE", help="The set to make.")
@click.option("--name", help="Of the set.  [default: as the file]")
@click.option("--parent", metavar="SET", help="Keep this set's pairs where a pair is not heard.")
@click.option("--language", metavar="CODE", default="en", show_default=True, help="ISO 639 code.")
@click.option("--licence", metavar="TERMS", default="", help="Terms of use, in a few words.")
@click.option("--points", default=9, show_default=True, type=click.IntRange(4, 33),
              help="Control points of a curve.")  # fmt: skip
@click.option("--least", default=3, show_default=True, type=click.IntRange(1),
              help="Times that a pair must be heard to be fitted.")  # fmt: skip
@progress_option
def fit(
    dataset: Path, output: Path, name: str | None, parent: str | None, language: str,
    licence: str, points: int, least: int, progress: str,
) -> None:  # fmt: skip
    """Fit a set to the recordings of a captured dataset that are for training.

    Each fitted pair says how often it was heard, and how far the captures are from its curves.
    Pairs that were not heard come from articulation, or from --parent; so do the tongue, which no
    camera sees, and the closures, which always shut the lips.
    """
    from lipwright.bigrams.file import save_set
    from lipwright.bigrams.jsonvalues import word_at
    from lipwright.bigrams.places import Fault
    from lipwright.dataset.folder import open_dataset
    from lipwright.train.bigram_fit import FitOptions
    from lipwright.train.bigram_heard import ClosureOptions
    from lipwright.train.bigram_set import Naming, fit_set

    if output.exists():
        raise LipwrightError(f"{output}: is there already; name another file, or delete it")
    try:
        called = word_at(name or output.name.partition(".")[0], ("NAME",))
    except Fault as fault:
        raise LipwrightError(f"{output}: {fault}; name the set with --name") from None
    naming = Naming(called, language, licence, parent or "",
                    parent_name(parent, output) if parent else "")  # fmt: skip
    with progress_report(progress) as report:
        options = FitOptions(points=points, least=least, closures=ClosureOptions(least=least))
        made = fit_set(open_dataset(dataset), naming, options, report)
        save_set(output, made.said)
    if progress != "json":
        say(f"{output}: {_summary(made)}")
        shares = ", ".join(f"{pose} {share:.2f}" for pose, share in made.fit.explained.items())
        say(f"share of the captured motion that the curves explain: {shares}")


def _summary(made: FittedSet) -> str:
    sources = Counter(bigram.source for bigram in made.said.bigrams.values())
    ruled = f", {sources['rule']} by rule" if sources["rule"] else ""
    return f"{sources['fitted']} pairs fitted to {made.recordings} recordings{ruled}"
