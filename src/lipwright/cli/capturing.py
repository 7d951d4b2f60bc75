"""`lipwright capture`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from lipwright.cli.aligning import dictionary_option, language_option
from lipwright.cli.progress import keeps, progress_option, progress_report, say, warn

if TYPE_CHECKING:
    from lipwright.capture.job import Outcome
    from lipwright.capture.run import Captured

EXAMPLES = """\b
Examples:
  lipwright capture videos/ --transcripts words/ -o anna
    anna: 2 recordings captured, 0 failed; 0 should be left out, see anna/report/index.html
\b
  lipwright capture take1.mov take2.mov --transcripts lines.tsv -o anna
  lipwright capture videos/ --audio sounds/ --transcripts words/ -o anna --reject
  lipwright capture videos/ --phones corrected/ -o anna
  lipwright capture MySlate_1_iPhone.csv --transcripts words.txt -o anna
\b
Files match by stem: NAME.mp4, NAME.flac or .wav, NAME.txt, NAME.TextGrid. A file of transcripts
for several recordings has a line `NAME<tab>words` for each. What is captured stays: run the same
command again after an interruption, and it goes on where it stopped.
"""

FAILED_STATUS = 2  # some recordings could not be captured; the others were


@click.command(epilog=EXAMPLES)
@click.argument("faces", metavar="VIDEO...", nargs=-1, type=Path, required=True)
@click.option(
    "--audio", type=Path, help="Sound of its own: a file, or a folder of NAME.flac, .wav."
)
@click.option(
    "--transcripts",
    "-t",
    type=Path,
    help="Words: a file for one recording, a table of names and words, or a folder of NAME.txt.",
)
@click.option(
    "--phones",
    type=Path,
    help="Phone times to use instead of words: a file, or a folder of NAME.TextGrid.",
)
@click.option("-o", "--output", "out", type=Path, required=True, help="Folder of the dataset.")
@click.option("--reject", is_flag=True, help="Leave out what the report advises against.")
@click.option("--licence", default="", help="Licence of the recordings, for the manifest.")
@click.option("--name", default="", help="Name of the dataset; else that of its folder.")
@click.option("--jobs", "-j", type=click.IntRange(1), help="Recordings at once.  [one a processor]")
@click.option("--tracker", default="mediapipe", show_default=True, help="What finds the landmarks.")
@click.option("--asymmetric", is_flag=True, help="Let left and right ARKit weights differ.")
@click.option(
    "--fps",
    type=click.FloatRange(15, 240),
    default=30.0,
    show_default=True,
    help="Frames a second of Live Link Face and ARKit recordings; videos keep theirs.",
)
@dictionary_option
@language_option
@progress_option
def capture(
    faces: tuple[Path, ...], audio: Path | None, transcripts: Path | None, phones: Path | None,
    out: Path, reject: bool, licence: str, name: str, jobs: int | None, tracker: str,
    asymmetric: bool, fps: float, dictionary: Path | None, language: str | None, progress: str,
) -> int:  # fmt: skip
    """Turn videos of a speaker, or Live Link Face recordings, into a dataset."""
    from lipwright.capture.job import CaptureOptions
    from lipwright.capture.report import write_report
    from lipwright.capture.run import capture as run
    from lipwright.capture.sources import find_sources

    sources = find_sources(faces, audio, transcripts, phones)
    options = CaptureOptions(
        language=language or "en", dictionary=dictionary, tracker=tracker, fps=fps,
        tied=not asymmetric,
        reject=reject, name=name, licence=licence,
    )  # fmt: skip
    keeps(f"what was captured is kept in {out}; run the same command to go on")
    with progress_report(progress) as report:
        captured = run(
            sources, out, options, jobs=jobs, report=report,
            tell=lambda outcome: _tell(outcome, progress),
        )  # fmt: skip
        page = write_report(captured.dataset, lambda share: report("report", share))
    _say_done(out, captured, page, progress)
    return FAILED_STATUS if captured.failed else 0


def _tell(outcome: Outcome, progress: str) -> None:
    if outcome.error is not None:
        warn(f"not captured: {outcome.error}", progress)
    elif outcome.fresh:
        for line in outcome.warnings:
            warn(line, progress)


def _say_done(out: Path, captured: Captured, page: Path, progress: str) -> None:
    if progress == "json":
        return
    done = len(captured.outcomes) - len(captured.failed)
    advised = sum(bool(outcome.reasons) for outcome in captured.outcomes)
    rejected = "are" if captured.rejects else "should be"
    say(
        f"{out}: {done} recordings captured, {len(captured.failed)} failed; {advised} {rejected} "
        f"left out, see {page}"
    )
