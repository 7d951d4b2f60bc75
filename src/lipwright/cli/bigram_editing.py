"""`lipwright bigrams edit`: change one pair."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, get_args

import click

from lipwright.bigrams.values import Source
from lipwright.cli.bigram_sets import set_argument
from lipwright.cli.progress import say
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.bigrams.fields import SetFile
    from lipwright.bigrams.values import BigramSet

EDIT_EXAMPLES = """\b
Examples:
  lipwright bigrams edit examples/diphones.txt "f ay" open "0.3 0, 0.7 0.6, 1 0" -o mine.json
    mine.json: f ay, drawn: FV, open
\b
  lipwright bigrams edit mine.json "f ah" open --remove    # the pair leaves that pose at rest
\b
  lipwright bigrams edit mine.json "f ah" --remove         # the pair is that of the parent again
"""


@click.command(epilog=EDIT_EXAMPLES)
@set_argument
@click.argument("pair", required=False)
@click.argument("pose", required=False)
@click.argument("points", required=False)
@click.option("--remove", is_flag=True, help="Take the curve out, or without POSE the pair.")
@click.option("--source", type=click.Choice(get_args(Source)), default="drawn", show_default=True,
              help="How the pair came about.")  # fmt: skip
@click.option("-o", "--output", type=Path, metavar="FILE", help="Write to another file.")
def edit(
    name: str, pair: str | None, pose: str | None, points: str | None, remove: bool, source: Source,
    output: Path | None,
) -> None:  # fmt: skip
    """Draw the curve of POSE while PAIR is said: POINTS are times from 0 to 1 and values.

    A pair that only the parent has is copied into the set's file first.
    """
    from lipwright.bigrams import edits

    if pair is None:
        raise LipwrightError(
            f'name what to edit, such as "f ah" open "0 0, 0.4 0.6, 1 0", or draw it in a page: '
            f"lipwright bigrams editor {name}"
        )
    if remove == (points is not None) or (pose is None and not remove):
        raise LipwrightError(f"{pair}: give a pose and its control points, or --remove")
    both = edits.parse_pair(pair)
    drawn = None if points is None else edits.parse_points(points)

    def change(said: SetFile, whole: BigramSet) -> SetFile:
        if pose is None:
            return edits.without_bigram(said, both)
        if drawn is None:
            return edits.without_curve(said, whole, both, pose)
        return edits.with_curve(said, whole, both, pose, drawn, source)

    whole = edits.edit_set(name, change, output)
    found = whole.bigrams.get(both)
    about = "gone" if found is None else f"{found.source}: {', '.join(found.curves) or 'rest'}"
    say(f"{output or name}: {' '.join(both)}, {about}")
