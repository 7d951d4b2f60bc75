"""How far the work is: a bar on a terminal, JSON lines for programs, else nothing."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import click

Report = Callable[[str, float], None]

_kept = ["nothing was written"]


def keeps(what: str) -> None:
    """Say what an interrupted command leaves, where that is more than nothing."""
    _kept[:] = [what]


def interrupted() -> str:
    """What is said to somebody who interrupts."""
    return f"interrupted; {_kept[0]}"


progress_option = click.option(
    "--progress", type=click.Choice(["auto", "json", "none"]), default="auto", show_default=True,
    help="Bar on a terminal (auto), none, or on standard error nothing but JSON, a line for each "
    "stage, warning and error (json).",
)  # fmt: skip


def say(line: str) -> None:
    """A line for the user; standard output is kept for results."""
    sys.stderr.write(" ".join(line.splitlines()) + "\n")


def warn(line: str, progress: str) -> None:
    """What the user should know, though the work is done."""
    say(json.dumps({"warning": line}) if progress == "json" else f"warning: {line}")


def wants_json(arguments: Sequence[str]) -> bool:
    """Whether a command line asks for JSON lines; also one that cannot be parsed."""
    chosen = zip(arguments, [*arguments[1:], ""], strict=True)
    return "--progress=json" in arguments or ("--progress", "json") in chosen


def _json_lines() -> Report:
    last: dict[str, float] = {}

    def report(stage: str, share: float) -> None:
        share = min(max(share, 0.0), 1.0)
        if stage in last and share < 1 and share - last[stage] < 0.01:
            return
        last[stage] = share
        sys.stderr.write(json.dumps({"stage": stage, "done": round(share, 3)}) + "\n")
        sys.stderr.flush()

    return report


@contextmanager
def progress_report(progress: str) -> Iterator[Report]:
    """What to call with a stage and the share of it that is done."""
    if progress == "json":
        yield _json_lines()
    elif progress == "auto" and sys.stderr.isatty():
        from rich.console import Console
        from rich.progress import BarColumn, TaskID, TextColumn, TimeRemainingColumn
        from rich.progress import Progress as Bars

        with Bars(
            TextColumn("{task.description:8}"), BarColumn(), TextColumn("{task.percentage:3.0f}%"),
            TimeRemainingColumn(), console=Console(stderr=True), transient=True,
        ) as bars:  # fmt: skip
            tasks: dict[str, TaskID] = {}

            def report(stage: str, share: float) -> None:
                if stage not in tasks:
                    tasks[stage] = bars.add_task(stage, total=1.0)
                bars.update(tasks[stage], completed=share)

            yield report
    else:
        yield lambda stage, share: None
