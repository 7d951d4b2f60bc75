"""`lipwright align`, and what it shares with `lipwright animate`: speech, words, misfits."""

from __future__ import annotations

import contextlib
import functools
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import click

from lipwright.cli.inputs import STDIN, read_text, recording
from lipwright.cli.outputs import (
    check_files,
    format_option,
    out_option,
    suffix_of,
    targets_of,
    write_tracks,
)
from lipwright.cli.progress import Report, progress_option, progress_report, say, warn
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.pipeline import AlignOptions
    from lipwright.pipeline.words import RecogniserName
    from lipwright.speech import Alignment
    from lipwright.speech.listening import Heard
    from lipwright.track import PhoneTrack

ALIGN_EXAMPLES = """\b
Examples:
  lipwright align examples/hello.flac --text examples/hello.txt -o hello.TextGrid
    hello.TextGrid: 9.3 s, 82 phones, 26 words
\b
  lipwright align talk.mp3 --text talk.txt --dictionary names.dict -o talk.TextGrid
  lipwright align talk.mp3 -o talk.TextGrid
  lipwright align tal.mp3 --text tal.txt --language sv -o tal.TextGrid
  lipwright align talk.wav --text talk.txt -o - --format ctm
"""

speech_argument = click.argument("speech")
text_option = click.option("--text", "-t", help="The words, a file of them, or - for a pipe.")
dictionary_option = click.option(
    "--dictionary", type=Path, help="File of pronunciations: a WORD and its ARPABET phones a line."
)
language_option = click.option(
    "--language", "-l",
    help="Language of the words: en, en-gb, sv, cmn, de, es, fr, it, nl, pt, ja, another that "
    "espeak-ng speaks, or auto.  [default: en, or of words that are recognised, what is heard]",
)  # fmt: skip


@dataclass(frozen=True)
class Listening:
    """How a recording without words is heard."""

    recogniser: str
    model: str | None

    def options(self, language: str | None, dictionary: Path | None) -> AlignOptions:
        """The options of the pipeline.

        Raises:
            LipwrightError: the language is unknown.
        """
        from lipwright.pipeline import AlignOptions

        return AlignOptions(
            language=language,
            dictionary=dictionary,
            recogniser=cast("RecogniserName", self.recogniser),
            asr_model=self.model,
        )


def listening_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Options of commands that take a recording without words; they arrive as `listening`."""

    @click.option(
        "--listen", "recogniser", type=click.Choice(["auto", "words", "phones"]), default="auto",
        show_default=True, help="Without words: recognise words, phones, or words where they can "
        "be (auto).",
    )  # fmt: skip
    @click.option(
        "--asr-model", help="Model that recognises words: a folder, or one that is installed."
    )
    @functools.wraps(command)
    def inner(*arguments: Any, recogniser: str, asr_model: str | None, **more: Any) -> Any:
        return command(*arguments, listening=Listening(recogniser, asr_model), **more)

    return inner


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


def report_heard(name: str, heard: Heard, progress: str) -> None:
    """Say how a recording without words was heard, and how far to trust it."""
    if progress == "json":
        found = {"path": heard.path, "confidence": round(heard.confidence, 2), "text": heard.text,
                 "language": heard.language}  # fmt: skip
        say(json.dumps({"heard": found}, ensure_ascii=False))
    else:
        how = {"words": "words were recognised and aligned", "phones": "phones were recognised"}
        say(f"{name}: no words given; {how[heard.path]} (confidence {heard.confidence:.2f})")
        if heard.text:
            say(f"{name}: heard {heard.text[:200]!r}")
    for note in heard.notes:
        warn(f"{name}: {note}", progress)


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
@listening_options
@progress_option
def align(
    speech: str, text: str | None, out: tuple[str, ...],
    format: str | None,  # noqa: A002  # as the option is called
    dictionary: Path | None, language: str | None, listening: Listening, progress: str,
) -> None:  # fmt: skip
    """Find when each word and phone of a recording is said.

    Without words, the phones are recognised.
    """
    from lipwright.formats import TRACK_FORMATS
    from lipwright.formats.suffixes import by_suffix

    targets = targets_of(out, TRACK_FORMATS, format)
    if speech == STDIN == text:
        raise LipwrightError("the sound and the words cannot both come through the pipe")
    for target in targets:
        by_suffix(TRACK_FORMATS, Path(target), suffix_of(format), "phone track")
    check_files(targets, speech, text, dictionary)
    options = listening.options(language, dictionary)
    with progress_report(progress) as report, recording(speech) as path, named(path, speech):
        alignment, heard = _align(path, text, options, report)
    write_tracks(targets, alignment.track, suffix_of(format))
    if heard is not None:
        report_heard(speech_name(speech), heard, progress)
    report_misfits(alignment, progress)
    say_done(targets, alignment.track, progress)


def _align(
    path: Path, text: str | None, options: AlignOptions, report: Report
) -> tuple[Alignment, Heard | None]:
    from lipwright.pipeline import align_speech, hear_speech

    if text is None:
        heard = hear_speech(path, options, report)
        return heard.alignment, heard
    words, source = read_text(text)
    return align_speech(path, words, options, source, report), None
