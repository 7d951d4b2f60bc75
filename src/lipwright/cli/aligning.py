"""`lipwright align`, and what it shares with `lipwright animate`: speech, words, misfits."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from lipwright.cli.inputs import STDIN, read_text, recording
from lipwright.cli.outputs import (
    check_files,
    format_option,
    out_option,
    pipe,
    suffix_of,
    targets_of,
)
from lipwright.cli.progress import Report, progress_option, progress_report, say, warn
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.pipeline import AlignOptions
    from lipwright.speech import Alignment
    from lipwright.track import PhoneTrack

ALIGN_EXAMPLES = """\b
Examples:
  lipwright align examples/hello.flac --text examples/hello.txt -o hello.TextGrid
    hello.TextGrid: 9.3 s, 82 phones, 26 words
\b
  lipwright align talk.mp3 --text talk.txt --dictionary names.dict -o talk.TextGrid
  lipwright align talk.wav --text talk.txt -o - --format ctm
"""

speech_argument = click.argument("speech")
text_option = click.option("--text", "-t", help="The words, a file of them, or - for a pipe.")
dictionary_option = click.option(
    "--dictionary", type=Path, help="File of pronunciations: a WORD and its ARPABET phones a line."
)
language_option = click.option(
    "--language", "-l", default="en", show_default=True, help="Language of the words."
)


def speech_name(speech: str) -> str:
    """The recording's name in messages."""
    return "standard input" if speech == STDIN else speech


@contextlib.contextmanager
def named(path: Path, speech: str) -> Iterator[None]:
    """Errors name what the user gave, not the file that kept it meanwhile."""
    try:
        yield
    except LipwrightError as error:
        raise LipwrightError(str(error).replace(str(path), speech_name(speech))) from error


def report_misfits(alignment: Alignment, progress: str) -> None:
    """Say which words do not fit the sound, and where speech has no words."""
    track = alignment.track
    kept = {(word.text, round(track.word_span(word)[0], 2)) for word in track.words}
    for misfit in alignment.misfits:
        is_kept = (misfit.text, round(misfit.start, 2)) in kept
        outcome = "something else is said there" if is_kept else "it was left out"
        warn(
            f"{(misfit.written or misfit.text)[:40]!r} does not fit the sound at "
            f"{misfit.start:.2f} to {misfit.end:.2f} s (score {misfit.score:.1f}); {outcome}",
            progress,
        )
    for start, end in alignment.unwritten:
        warn(
            f"speech at {start:.2f} to {end:.2f} s has no words, and the mouth is shut there; "
            "add its words to the text",
            progress,
        )


def say_done(targets: tuple[str, ...], track: PhoneTrack, progress: str) -> None:
    """A line for each output; programs that read JSON lines know what they asked for."""
    if progress == "json":
        return
    for target in targets:
        name = "standard output" if target == STDIN else target
        say(f"{name}: {track.end:.1f} s, {len(track)} phones, {len(track.words)} words")


@click.command(epilog=ALIGN_EXAMPLES)
@speech_argument
@text_option
@out_option
@format_option
@dictionary_option
@language_option
@progress_option
def align(
    speech: str, text: str | None, out: tuple[str, ...],
    format: str | None,  # noqa: A002  # as the option is called
    dictionary: Path | None, language: str, progress: str,
) -> None:  # fmt: skip
    """Find when each word and phone of a recording is said."""
    from lipwright.formats import TRACK_FORMATS
    from lipwright.formats.suffixes import by_suffix
    from lipwright.pipeline import AlignOptions

    targets = targets_of(out, TRACK_FORMATS, format)
    if text is None:
        raise LipwrightError(f"{speech_name(speech)}: give its words with --text")
    if speech == STDIN == text:
        raise LipwrightError("the sound and the words cannot both come through the pipe")
    for target in targets:
        by_suffix(TRACK_FORMATS, Path(target), suffix_of(format), "phone track")
    check_files(targets, speech, text, dictionary)
    words, source = read_text(text)
    options = AlignOptions(language=language, dictionary=dictionary)
    with progress_report(progress) as report:
        alignment = _align(speech, words, source, options, report)
    for target in targets:
        _write_track(target, alignment, suffix_of(format))
    report_misfits(alignment, progress)
    say_done(targets, alignment.track, progress)


def _align(
    speech: str, words: str, source: str, options: AlignOptions, report: Report
) -> Alignment:
    from lipwright.pipeline import align_speech

    with recording(speech) as path, named(path, speech):
        return align_speech(path, words, options, source, report)


def _write_track(target: str, alignment: Alignment, suffix: str | None) -> None:
    from lipwright.formats import write_track

    if target != STDIN:
        write_track(target, alignment.track, suffix)
    else:
        pipe(suffix, lambda path: write_track(path, alignment.track, suffix))
