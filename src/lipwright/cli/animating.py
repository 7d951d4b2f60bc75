"""`lipwright animate` and `lipwright align`."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from lipwright.cli.inputs import STDIN, piped_out, read_text, recording
from lipwright.cli.progress import Report, progress_option, progress_report, say, warn
from lipwright.engines import DEFAULT, ENGINES, OF_BIGRAMS, OF_MODELS
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.export import Exporter, ExportOptions
    from lipwright.pipeline import AlignOptions, AnimateOptions, Result
    from lipwright.speech import Alignment
    from lipwright.track import PhoneTrack

ANIMATE_EXAMPLES = """\b
Examples:
  lipwright animate examples/hello.flac --text examples/hello.txt -o hello.csv -o hello.glb
    hello.csv: 9.3 s, 82 phones, 26 words
    hello.glb: 9.3 s, 82 phones, 26 words
\b
  lipwright animate talk.mp3 --text talk.txt -o talk.csv -o talk.glb
  lipwright animate talk.mp3 --phones talk.TextGrid -o talk.livelink.csv --fps 30
  lipwright animate talk.mp3 --text talk.txt --model anna-model -o talk.mp4
  lipwright animate talk.mp3 --text talk.txt --bigrams anna.json -o talk.mp4
  cat talk.wav | lipwright animate - --text talk.txt -o - --format json
"""

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
out_option = click.option(
    "-o", "--output", "out", multiple=True, help="File to write, or -. Repeat for several."
)
format_option = click.option("--format", "-f", help="Format, where a suffix does not say it.")
dictionary_option = click.option(
    "--dictionary", type=Path, help="File of pronunciations: a WORD and its ARPABET phones a line."
)
language_option = click.option(
    "--language", "-l", default="en", show_default=True, help="Language of the words."
)


def _suffix(format: str | None) -> str | None:  # noqa: A002  # as the option is called
    return format if format is None or format.startswith(".") else f".{format}"


def _targets(out: tuple[str, ...], known: Iterable[str], suffix: str | None) -> tuple[str, ...]:
    if not out:
        raise LipwrightError(
            f"no output; name one with -o: {', '.join(f'-o NAME{s}' for s in known)}"
        )
    if out.count(STDIN) > 1:
        raise LipwrightError("standard output is named twice; give each output its own place")
    if STDIN in out and suffix is None:
        raise LipwrightError("standard output has no suffix; choose the format with --format")
    if STDIN in out:
        piped_out()
    return out


def _check_files(targets: tuple[str, ...], speech: str, *inputs: str | Path | None) -> None:
    """Find out now, rather than after minutes of work, what cannot be written."""
    from lipwright.export import check_targets

    files = [target for target in targets if target != STDIN]
    read = [path for path in inputs if path is not None and path != STDIN]
    check_targets(files, None if speech == STDIN else speech, read)


def _speech_name(speech: str) -> str:
    return "standard input" if speech == STDIN else speech


@contextlib.contextmanager
def _named(path: Path, speech: str) -> Iterator[None]:
    """Errors name what the user gave, not the file that kept it meanwhile."""
    try:
        yield
    except LipwrightError as error:
        raise LipwrightError(str(error).replace(str(path), _speech_name(speech))) from error


def _report_misfits(alignment: Alignment, progress: str) -> None:
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


def _say_done(targets: tuple[str, ...], track: PhoneTrack, progress: str) -> None:
    """A line for each output; programs that read JSON lines know what they asked for."""
    if progress == "json":
        return
    for target in targets:
        name = "standard output" if target == STDIN else target
        say(f"{name}: {track.end:.1f} s, {len(track)} phones, {len(track.words)} words")


@click.command(epilog=ANIMATE_EXAMPLES)
@speech_argument
@text_option
@click.option(
    "--phones",
    type=Path,
    help="Phone times to use instead of words: TextGrid, CTM, lab, JSON, pho.",
)
@out_option
@format_option
@click.option("--engine", help=f"What makes motion of phones: {', '.join(ENGINES)}.  [default: "
              f"{DEFAULT}, or {OF_MODELS} where a model is given, {OF_BIGRAMS} where a bigram set "
              "is]")  # fmt: skip
@click.option("--model", help="Name or folder of a network to run; see lipwright models.")
@click.option("--bigrams", help="Name or file of a phone bigram set; see lipwright bigrams.")
@click.option("--fps", type=float, default=60.0, show_default=True, help="Frames a second.")
@click.option("--intensity", type=float, default=1.0, show_default=True,
              help="0.5 mumbles, 1.5 over-articulates.")  # fmt: skip
@dictionary_option
@language_option
@click.option(
    "--size", default="512x512", show_default=True, help="Width x height of a video in pixels."
)
@progress_option
def animate(
    speech: str, text: str | None, phones: Path | None, out: tuple[str, ...],
    format: str | None,  # noqa: A002  # as the option is called
    engine: str | None, model: str | None, bigrams: str | None, fps: float, intensity: float,
    dictionary: Path | None, language: str, size: str, progress: str,
) -> None:  # fmt: skip
    """Make a face speak a recording: curves, an animated head, a video."""
    from lipwright.export import EXPORTERS
    from lipwright.formats.suffixes import by_suffix
    from lipwright.pipeline import AlignOptions, AnimateOptions
    from lipwright.pipeline import animate as make

    targets = _targets(out, EXPORTERS, format)
    if (text is None) == (phones is None):
        raise LipwrightError(
            f"{_speech_name(speech)}: give either its words with --text or its phones with --phones"
        )
    if speech == STDIN == text:
        raise LipwrightError("the sound and the words cannot both come through the pipe")
    if phones is not None and dictionary is not None:
        raise LipwrightError(f"{dictionary}: --phones needs no dictionary; leave one of them out")
    options = AnimateOptions(
        engine=engine, model=model, bigrams=bigrams, fps=fps, intensity=intensity
    )
    export_options = _export_options(size, Path(_speech_name(speech)).stem)
    exporters = [by_suffix(EXPORTERS, Path(t), _suffix(format), "export") for t in targets]
    _check_controls(options, targets, exporters)
    for exporter in exporters:
        exporter.prepare()
    _check_files(targets, speech, text, phones, dictionary, bigrams)
    words, source = (None, "") if text is None else read_text(text)
    with progress_report(progress) as report, recording(speech) as path, _named(path, speech):
        result = make(
            path, words, phones=phones, options=options, text_source=source, report=report,
            alignment=AlignOptions(language=language, dictionary=dictionary),
        )  # fmt: skip
        show = replace(export_options, progress=lambda done, all_: report("video", done / all_))
        _export(result, targets, _suffix(format), show)
    if result.alignment is not None:
        _report_misfits(result.alignment, progress)
    _report_missing(options, result.track, progress)
    _say_done(targets, result.track, progress)


MOST_MISSING = 10  # pairs that are named; a set that is drawn in part lacks hundreds


def _report_missing(options: AnimateOptions, track: PhoneTrack, progress: str) -> None:
    """Name the pairs that a bigram set lacks, and what was said instead."""
    from lipwright.bigrams.coverage import pair_text
    from lipwright.bigrams.missing import missing

    bigrams = options.bigram_set
    if bigrams is None:
        return
    lacking = missing(bigrams, track)
    for pair, count, instead in lacking[:MOST_MISSING]:
        stand_in = "the mouth rests there" if instead is None else f"used {pair_text(instead)!r}"
        said = pair_text(pair)
        warn(f"{bigrams.name} has no pair {said!r} ({count} times); {stand_in}", progress)
    if len(lacking) > MOST_MISSING:
        warn(
            f"{bigrams.name} lacks {len(lacking) - MOST_MISSING} more pairs; see lipwright bigrams "
            "coverage",
            progress,
        )


def _check_controls(
    options: AnimateOptions, targets: tuple[str, ...], exporters: list[Exporter]
) -> None:
    """Refuse to put what moves no human head on one; our own tables hold any controls."""
    from lipwright.pipeline import moves_heads

    names = options.controls()
    if moves_heads(names):
        return
    for target, exporter in zip(targets, exporters, strict=True):
        if exporter.reads:
            continue
        if options.bigram_set is not None:
            raise LipwrightError(
                f"{target}: {options.bigram_set.name} moves poses of a creature ({names[0]} to "
                f"{names[-1]}), which no human head shows; write .csv or .json, as "
                "examples/07_crab.py does before it draws"
            )
        raise LipwrightError(
            f"{target}: {options.model} predicts modes of a reference face ({names[0]} to "
            f"{names[-1]}), which move no head; write .csv or .json for 'lipwright face "
            "overlay --params', or train one with: lipwright train --targets arkit"
        )


def _export_options(size: str, title: str) -> ExportOptions:
    from lipwright.export import ExportOptions

    width, _, height = size.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise LipwrightError(f"--size {size!r} is not WIDTHxHEIGHT in pixels, such as 512x512")
    return ExportOptions(size=(int(width), int(height)), title=title)


def _export(
    result: Result, targets: tuple[str, ...], suffix: str | None, options: ExportOptions
) -> None:
    from lipwright.export import export_all

    files = [target for target in targets if target != STDIN]
    if STDIN in targets:
        _pipe(
            suffix,
            lambda path: export_all([path], result.performance, format=suffix, options=options),
        )
    if files:
        export_all(files, result.performance, format=suffix, options=options)


def _pipe(suffix: str | None, write: Callable[[Path], None]) -> None:
    """Write a file that nobody keeps, and send it to standard output."""
    with tempfile.TemporaryDirectory(prefix="lipwright-") as folder:
        path = Path(folder) / f"out{suffix}"
        write(path)
        out = piped_out()
        out.write(path.read_bytes())
        out.flush()


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

    targets = _targets(out, TRACK_FORMATS, format)
    if text is None:
        raise LipwrightError(f"{_speech_name(speech)}: give its words with --text")
    if speech == STDIN == text:
        raise LipwrightError("the sound and the words cannot both come through the pipe")
    for target in targets:
        by_suffix(TRACK_FORMATS, Path(target), _suffix(format), "phone track")
    _check_files(targets, speech, text, dictionary)
    words, source = read_text(text)
    options = AlignOptions(language=language, dictionary=dictionary)
    with progress_report(progress) as report:
        alignment = _align(speech, words, source, options, report)
    for target in targets:
        _write_track(target, alignment, _suffix(format))
    _report_misfits(alignment, progress)
    _say_done(targets, alignment.track, progress)


def _align(
    speech: str, words: str, source: str, options: AlignOptions, report: Report
) -> Alignment:
    from lipwright.pipeline import align_speech

    with recording(speech) as path, _named(path, speech):
        return align_speech(path, words, options, source, report)


def _write_track(target: str, alignment: Alignment, suffix: str | None) -> None:
    from lipwright.formats import write_track

    if target != STDIN:
        write_track(target, alignment.track, suffix)
    else:
        _pipe(suffix, lambda path: write_track(path, alignment.track, suffix))
