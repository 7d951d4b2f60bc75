"""`lipwright dataset`: look at, check, merge and split recordings."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

from lipwright.cli.progress import progress_option, progress_report, say, warn
from lipwright.errors import LipwrightError

SHOWN = 10  # names of rejected recordings
INFO_EXAMPLES = """\b
Examples:
  lipwright dataset info anna
    name        anna
    licence     CC0
    recordings  2: 2 captured
    splits      2 train
\b
  lipwright dataset info anna --json
"""
CHECK_EXAMPLES = """\b
Examples:
  lipwright dataset check anna
    anna: 2 recordings, no problems
\b
  lipwright dataset check anna --accept    # after editing phones by hand
    anna: 1 edited recording accepted
    anna: 2 recordings, no problems
"""
MERGE_EXAMPLES = """\b
Examples:
  lipwright dataset merge anna bert -o both
    both: 3 recordings
\b
  lipwright dataset merge monday tuesday --prefix mon- --prefix tue- -o week
"""
SPLIT_EXAMPLES = """\b
Examples:
  lipwright dataset split anna
    anna: 2 train
\b
  lipwright dataset split grid --hold-out-words m,v,y
    grid: 44 test, 680 train, 114 unseen, 42 validation
"""

dataset_argument = click.argument("path", metavar="DATASET", type=Path)


@click.group(epilog="Each command has examples: lipwright dataset COMMAND --help")
def dataset() -> None:
    """Look at, check, merge and split datasets of recordings."""


@dataset.command(epilog=INFO_EXAMPLES)
@dataset_argument
@click.option("--json", "as_json", is_flag=True, help="Print JSON, for programs.")
def info(path: Path, as_json: bool) -> None:
    """Say what is in a dataset: counts, lengths, phones, parameters, what was rejected and why."""
    from lipwright.dataset.folder import open_dataset
    from lipwright.dataset.summary import summarise

    summary = summarise(open_dataset(path))
    if as_json:
        click.echo(json.dumps(summary, ensure_ascii=False, indent=1))
        return
    for label, text in _summary_lines(summary):
        click.echo(f"{label:11} {text}")


def _summary_lines(summary: dict[str, Any]) -> Iterator[tuple[str, str]]:
    from lipwright.dataset.summary import rarest

    yield "name", summary["name"]
    yield "licence", summary["licence"] or "none named"
    yield "recordings", f"{summary['recordings']}: {_listed(summary['statuses'])}"
    if summary["advised"]:
        yield "", f"{summary['advised']} of them better rejected; see the report"
    yield "splits", _listed(summary["splits"])
    yield "length", f"{summary['seconds']:.1f} s, {summary['frames']} frames"
    rates = {f"at {fps} fps": count for fps, count in summary["fps"].items()}
    yield "frame rates", _listed(rates)
    yield "speech", f"{summary['words']} words, {summary['phones']} phones"
    yield "rare phones", ", ".join(f"{p} {n}" for p, n in rarest(summary["phone_counts"]))
    yield "trackers", _listed(summary["trackers"])
    yield "tracked", _percent(summary["tracked"]) + " of the frames"
    kept = f"{_percent(summary['closures_kept'])} of {summary['bilabials']} p, b, m"
    yield "closures", kept if summary["bilabials"] else "no p, b, m"
    offset = summary["offset_ms"]
    if offset is not None:
        yield "offset", "{least:.0f} to {greatest:.0f} ms, median {median:.0f}".format(**offset)
    yield "parameters", _listed(summary["parameters"])
    for name, reason in list(summary["reasons"].items())[:SHOWN]:
        yield "left out", f"{name}: {reason}"
    if len(summary["reasons"]) > SHOWN:
        yield "", f"and {len(summary['reasons']) - SHOWN} more; --json lists them"


def _listed(counts: dict[str, int]) -> str:
    return ", ".join(f"{count} {name}" for name, count in counts.items()) or "none"


def _percent(share: float | None) -> str:
    return "none" if share is None else f"{share:.2%}"


@dataset.command(epilog=CHECK_EXAMPLES)
@dataset_argument
@click.option("--accept", is_flag=True, help="Take phones that were edited by hand as they are.")
@progress_option
def check(path: Path, accept: bool, progress: str) -> None:
    """Check that every file is there, unchanged, readable, and fits the others.

    Prints a line for each problem and ends with status 2 where there is one. Phones that were
    edited by hand are no problem.
    """
    from lipwright.cli import BAD_INPUT
    from lipwright.dataset.checking import accept_edits, check_dataset
    from lipwright.dataset.folder import open_dataset
    from lipwright.dataset.lock import locked

    found = open_dataset(path)
    with progress_report(progress) as report:
        findings = check_dataset(found, report)
    for problem in findings.problems:
        click.echo(problem)
    if accept and findings.edited:
        with locked(path):
            accept_edits(open_dataset(path), findings.edited).save()
        _tell(f"{path}: {_count(len(findings.edited), 'edited recording')} accepted", progress)
    else:
        for name in findings.edited:
            warn(f"{found.folder(name)}: phones edited since capture", progress)
    problems = _count(len(findings.problems), "problem") if findings.problems else "no problems"
    _tell(f"{path}: {_count(len(found.entries), 'recording')}, {problems}", progress)
    if findings.problems:
        raise click.exceptions.Exit(BAD_INPUT)


def _tell(line: str, progress: str) -> None:
    """What was done; programs that read JSON lines know what they asked for."""
    if progress != "json":
        say(line)


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


@dataset.command(epilog=MERGE_EXAMPLES)
@click.argument("paths", metavar="DATASET...", nargs=-1, required=True, type=Path)
@click.option("-o", "--output", "out", type=Path, required=True, help="The new dataset's folder.")
@click.option(
    "--prefix", "prefixes", multiple=True,
    help="Put before the names of a dataset's recordings; one for each dataset, in order.",
)  # fmt: skip
@click.option("--mixed", is_flag=True, help="Take recordings of several trackers together.")
@progress_option
def merge(
    paths: tuple[Path, ...], out: Path, prefixes: tuple[str, ...], mixed: bool, progress: str
) -> None:
    """Copy several datasets into a new one. Recordings keep their splits."""
    from lipwright.dataset.folder import open_dataset
    from lipwright.dataset.merging import MergeOptions, merge_datasets

    options = MergeOptions(prefixes, mixed)
    with progress_report(progress) as report:
        merged, notes = merge_datasets([open_dataset(p) for p in paths], out, options, report)
    for note in notes:
        warn(note, progress)
    _tell(f"{out}: {_count(len(merged.entries), 'recording')}", progress)


@dataset.command(epilog=SPLIT_EXAMPLES)
@dataset_argument
@click.option("--test", type=click.IntRange(0), help="Recordings  [default: 50, a tenth at most]")
@click.option("--validation", type=click.IntRange(0), help="The same for validation.")
@click.option("--seed", help="Another text gives another order.  [default: lipwright-split]")
@click.option(
    "--hold-out", multiple=True,
    help="Name, pattern as 'a*', or file with one a line: such recordings become 'unseen'.",
)  # fmt: skip
@click.option("--hold-out-words", help="Words with commas: recordings that say one do too.")
@click.option("--keep", is_flag=True, help="Recordings that have a split keep it.")
def split(
    path: Path, test: int | None, validation: int | None, seed: str | None,
    hold_out: tuple[str, ...], hold_out_words: str | None, keep: bool,
) -> None:  # fmt: skip
    """Say which recordings are for training, validation, test, and a test on unseen words.

    By a hash of their names, so that others may come or go.
    """
    from lipwright.dataset.folder import open_dataset
    from lipwright.dataset.lock import locked
    from lipwright.dataset.splits import SEED, SplitOptions, check_hold_outs, split_dataset
    from lipwright.dataset.summary import count_values

    words = tuple(word for word in (hold_out_words or "").split(",") if word.strip())
    patterns = tuple(pattern for value in hold_out for pattern in _patterns(value))
    options = SplitOptions(test, validation, SEED if seed is None else seed, patterns, words)
    check_hold_outs(open_dataset(path), options)
    with locked(path):
        changed = split_dataset(open_dataset(path), options, keep=keep)
        changed.save()
    say(f"{path}: {_listed(count_values(entry['split'] for entry in changed.entries))}")


def _patterns(value: str) -> list[str]:
    """The pattern that `--hold-out` means, or those of the file that it names."""
    if not Path(value).is_file():
        return [value]
    try:
        lines = Path(value).read_text("utf-8").splitlines()
    except (OSError, ValueError) as error:
        raise LipwrightError(f"{value}: not a readable text file of names: {error}") from error
    patterns = [line.strip() for line in lines if line.strip()]
    if not patterns:
        raise LipwrightError(f"{value}: names no recording; write one name or pattern a line")
    return patterns
