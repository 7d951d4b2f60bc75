"""The report of a benchmark in a folder."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from lipwright.benchmark.reporting.figures import Report, find_figures
from lipwright.benchmark.reporting.markdown import tables_as_markdown
from lipwright.benchmark.reporting.page import write_page
from lipwright.benchmark.reporting.records import write_records
from lipwright.benchmark.values import Benchmark
from lipwright.errors import LipwrightError
from lipwright.files import write_whole

MARKDOWN: Final = "report.md"


def write_report(
    benchmark: Benchmark, folder: Path, report: Report = lambda stage, share: None
) -> None:
    """Write the report: JSON, CSV, Markdown, plots, and index.html, which shows them.

    The page shows the videos that already lie in `folder/videos`, each named by its recording.

    Args:
        benchmark: what was measured.
        folder: of the report; made where it is missing.
        report: told the stage, and which share of it is done.

    Raises:
        LipwrightError: a file cannot be written.
        MissingExtraError: jinja2 is not installed.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "plots").mkdir(exist_ok=True)
    except OSError as error:
        raise LipwrightError(
            f"{error.filename or folder}: cannot be made: {error.strerror}"
        ) from error
    figures = find_figures(benchmark, report)
    report("writing", 0.0)
    write_records(figures, folder)
    with write_whole(folder / MARKDOWN) as part:
        part.write_text(tables_as_markdown(figures), "utf-8", errors="replace", newline="\n")
    write_page(figures, folder)
    report("writing", 1.0)
