"""`lipwright evaluate`."""

from __future__ import annotations

import json
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lipwright.cli.progress import keeps, progress_option, progress_report, say
from lipwright.errors import LipwrightError, MissingExtraError

if TYPE_CHECKING:
    from lipwright.benchmark.options import BenchmarkOptions

EXAMPLES = """\b
Examples:
  lipwright evaluate anna --engines dominance,openfacefx --videos 0 -o report
    report: 1 recording; best r: dominance 0.951; see report/index.html
\b
  lipwright evaluate grid --engines all --hold-out "???[mvy]??" -o report
  lipwright evaluate grid --engines lipwright,hmm,openfacefx -o report
  lipwright evaluate grid --engines all --model mine=my-model --curves theirs=csv/ -o report
  lipwright evaluate anna --engines all --quick -o try
\b
Who takes part: lipwright, default, window, trees, hmm, lstm, dynamic, bigram, dominance, overlay,
static, and the peer openfacefx; `all` is all of them. Models are trained for it, and kept in the
report's folder: the same command goes on where it was stopped.
"""


@click.command(epilog=EXAMPLES)
@click.argument("path", metavar="DATASET", type=Path)
@click.option(
    "--engines", default="all", show_default=True, help="Names with commas: who takes part."
)
@click.option("--model", "models", multiple=True, help="NAME=MODEL: a further model or bigram set.")
@click.option(
    "--curves", multiple=True, help="NAME=FOLDER: further curves, a CSV file a recording."
)
@click.option("--face", type=Path, help="Reference face.  [default: DATASET-face.npz]")
@click.option("--second-head", type=Path, help="Landmarks of a second head, .npz, to measure on.")
@click.option(
    "--hold-out", multiple=True,
    help="Name or pattern as 'a*': recordings of unseen words, for a second training without them.",
)  # fmt: skip
@click.option("--hold-out-words", help="Words with commas: recordings that say one are unseen too.")
@click.option("--quick", is_flag=True, help="Small networks, few passes: a try of the whole.")
@click.option("--seed", type=click.IntRange(0, 2**31 - 1), default=0, show_default=True)
@click.option(
    "--videos", type=click.IntRange(0, 100), default=2, show_default=True,
    help="Recordings to draw side by side with the real mouth.",
)  # fmt: skip
@click.option("--keep-curves", is_flag=True, help="Write everybody's curves too.")
@click.option("--licence", default="", help="Licence of the models that are trained.")
@click.option("-o", "--output", "out", type=Path, required=True, help="Folder of the report.")
@progress_option
def evaluate(path: Path, out: Path, progress: str, **given: Any) -> None:
    """Measure every engine on the held-out recordings of a dataset, and write a report."""
    _need_extra()
    from lipwright.benchmark.run import best_r, run_benchmark

    options = _options(given)
    keeps(f"models that were trained are kept in {out}; run the same command to go on")
    with progress_report(progress) as report:
        found = run_benchmark(path, options, out, report, lambda told: _tell(told, progress))
    if progress != "json":
        name, r = best_r(found)
        best = f"; best r: {name} {r:.3f}" if name else ""
        count = len(found.splits[0].recordings)
        recordings = "1 recording" if count == 1 else f"{count} recordings"
        say(f"{out}: {recordings}{best}; see {out / 'index.html'}")


def _options(given: dict[str, Any]) -> BenchmarkOptions:
    from lipwright.benchmark.options import BenchmarkOptions

    lists: dict[str, Any] = {
        "engines": _list(given.pop("engines")),
        "models": tuple(_pair(value, "--model", "MODEL") for value in given.pop("models")),
        "hold_out_words": _list(given.pop("hold_out_words") or ""),
    }
    pairs = [_pair(value, "--curves", "FOLDER") for value in given.pop("curves")]
    curves = tuple((name, Path(folder)) for name, folder in pairs)
    try:
        return BenchmarkOptions(**given, **lists, curves=curves)
    except ValueError as error:
        raise LipwrightError(f"lipwright evaluate: {error}") from error


def _list(text: str) -> tuple[str, ...]:
    return tuple(part.strip() for part in text.split(",") if part.strip())


def _pair(value: str, option: str, what: str) -> tuple[str, str]:
    name, sign, rest = value.partition("=")
    if not (name and sign and rest):
        raise LipwrightError(f"{option} {value}: give it as NAME={what}")
    return name, rest


def _tell(told: dict[str, Any], progress: str) -> None:
    if progress == "json":
        say(json.dumps(told))
    elif progress == "auto" and "trained" in told:
        say(f"{told['trained']} for {told['split']}: trained in {told['seconds']:.1f} s")


def _need_extra() -> None:
    """Refuse to begin without the packages of the extra.

    Raises:
        MissingExtraError: one is not installed.
    """
    for package in ("torch", "sklearn", "jinja2", "matplotlib", "PIL"):
        if find_spec(package) is None:
            raise MissingExtraError(f"{package}, which the benchmark needs,", "bench")
