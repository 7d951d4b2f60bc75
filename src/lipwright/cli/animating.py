"""`lipwright animate` and `lipwright align`."""

from __future__ import annotations

import contextlib
import sys
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lipwright.cli.inputs import STDIN, read_text, recording
from lipwright.cli.progress import Progress, Report, progress_report, say
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.pipeline import AlignOptions, Result
    from lipwright.speech import Alignment

ANIMATE_EXAMPLES = """\b
Examples:
  lipwright animate hello.wav --text "Hello, how are you?" -o hello.mp4
    hello.mp4: 2.1 s, 31 phones, 5 words
\b
  lipwright animate talk.mp3 --text talk.txt -o talk.csv -o talk.glb
  lipwright animate talk.mp3 --phones talk.TextGrid -o talk.livelink.csv --fps 30
  cat talk.wav | lipwright animate - --text talk.txt -o - --format json
"""

ALIGN_EXAMPLES = """\b
Examples:
  lipwright align hello.wav --text "Hello, how are you?" -o hello.TextGrid
    hello.TextGrid: 2.1 s, 31 phones, 5 words
\b
  lipwright align talk.mp3 --text talk.txt --dictionary names.dict -o talk.TextGrid
  lipwright align talk.wav --text talk.txt -o - --format ctm
"""

Speech = Annotated[str, typer.Argument(help="Recording: any sound or video file, or - for a pipe.")]
Text = Annotated[
    str | None, typer.Option("--text", "-t", help="The words, a file of them, or - for a pipe.")
]
Out = Annotated[
    list[str] | None,
    typer.Option("-o", "--output", help="File to write, or -. Repeat for several."),
]
Format = Annotated[
    str | None, typer.Option("--format", "-f", help="Format, where a suffix does not say it.")
]
Dictionary = Annotated[
    Path | None, typer.Option(help="File of pronunciations: a WORD and its ARPABET phones a line.")
]
Language = Annotated[str, typer.Option("--language", "-l", help="Language of the words.")]
ProgressOption = Annotated[
    Progress, typer.Option(help="Bar on a terminal (auto), JSON lines (json), or none.")
]


def _suffix(format: str | None) -> str | None:  # noqa: A002  # as the option is called
    return format if format is None or format.startswith(".") else f".{format}"


def _targets(out: list[str] | None, known: Iterable[str]) -> list[str]:
    if not out:
        raise LipwrightError(f"no output; name one with -o: {', '.join(f'-o NAME{s}' for s in known)}")
    return out


def _speech_name(speech: str) -> str:
    return "standard input" if speech == STDIN else speech


@contextlib.contextmanager
def _named(path: Path, speech: str) -> Iterator[None]:
    """Errors name what the user gave, not the file that kept it meanwhile."""
    try:
        yield
    except LipwrightError as error:
        raise LipwrightError(str(error).replace(str(path), _speech_name(speech))) from error


def _report_misfits(alignment: Alignment) -> None:
    for misfit in alignment.misfits:
        shown = misfit.written or misfit.text
        say(
            f"warning: {shown!r} does not fit the sound at {misfit.start:.2f} to {misfit.end:.2f} s "
            f"(score {misfit.score:.1f}); it was left out"
        )


def _summary(path: str, duration: float, phones: int, words: int) -> str:
    name = "standard output" if path == STDIN else path
    return f"{name}: {duration:.1f} s, {phones} phones, {words} words"


def animate(
    speech: Speech,
    text: Text = None,
    phones: Annotated[
        Path | None,
        typer.Option(help="Phone times to use instead of words: TextGrid, CTM, lab, JSON, pho."),
    ] = None,
    out: Out = None,
    format: Format = None,  # noqa: A002  # as the option is called
    engine: Annotated[str, typer.Option(help="What makes motion of phones.")] = "dominance",
    fps: Annotated[float, typer.Option(help="Frames a second.")] = 60.0,
    intensity: Annotated[float, typer.Option(help="0.5 mumbles, 1.5 over-articulates.")] = 1.0,
    dictionary: Dictionary = None,
    language: Language = "en",
    size: Annotated[str, typer.Option(help="Width x height of a video in pixels.")] = "512x512",
    progress: ProgressOption = Progress.AUTO,
) -> None:
    """Make a face speak a recording: curves, an animated head, a video."""
    from lipwright.engines import get_engine
    from lipwright.export import EXPORTERS, ExportOptions, check_targets
    from lipwright.formats.suffixes import by_suffix
    from lipwright.pipeline import AlignOptions, AnimateOptions
    from lipwright.pipeline import animate as make

    targets = _targets(out, EXPORTERS)
    if (text is None) == (phones is None):
        raise LipwrightError(
            f"{_speech_name(speech)}: give either its words with --text or its phones with --phones"
        )
    if speech == STDIN == text:
        raise LipwrightError("the sound and the words cannot both come through the pipe")
    options = AnimateOptions(engine=engine, fps=fps, intensity=intensity)
    get_engine(engine)
    for target in targets:
        by_suffix(EXPORTERS, Path(target), _suffix(format), "export")
    # Found now rather than after minutes of work.
    check_targets([t for t in targets if t != STDIN], None if speech == STDIN else speech)
    words, source = (None, "") if text is None else read_text(text)
    with progress_report(progress) as report, recording(speech) as path, _named(path, speech):
        result = make(
            path, words, phones=phones, options=options, text_source=source, report=report,
            alignment=AlignOptions(language=language, dictionary=dictionary),
        )  # fmt: skip
        export_options = ExportOptions(
            size=_size(size),
            title=Path(_speech_name(speech)).stem,
            progress=lambda done, total: report("video", done / total),
        )
        _export(result, targets, _suffix(format), export_options)
    if result.alignment is not None:
        _report_misfits(result.alignment)
    if progress is not Progress.JSON:
        track = result.track
        for target in targets:
            say(_summary(target, track.end, len(track), len(track.words)))


def _size(size: str) -> tuple[int, int]:
    width, _, height = size.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise LipwrightError(f"size {size!r} is not WIDTHxHEIGHT in pixels, such as 512x512")
    return int(width), int(height)


def _export(result: Result, targets: list[str], suffix: str | None, options: object) -> None:
    from lipwright.export import ExportOptions, export_all

    assert isinstance(options, ExportOptions)
    files = [target for target in targets if target != STDIN]
    if STDIN in targets:
        if suffix is None:
            raise LipwrightError("standard output has no suffix; choose the format with --format")
        with tempfile.TemporaryDirectory(prefix="lipwright-") as folder:
            path = Path(folder) / f"out{suffix}"
            export_all([path], result.performance, format=suffix, options=options)
            sys.stdout.buffer.write(path.read_bytes())
            sys.stdout.buffer.flush()
    if files:
        export_all(files, result.performance, format=suffix, options=options)


def align(
    speech: Speech,
    text: Text = None,
    out: Out = None,
    format: Format = None,  # noqa: A002  # as the option is called
    dictionary: Dictionary = None,
    language: Language = "en",
    progress: ProgressOption = Progress.AUTO,
) -> None:
    """Find when each word and phone of a recording is said."""
    from lipwright.export import check_targets
    from lipwright.formats import TRACK_FORMATS
    from lipwright.formats.suffixes import by_suffix
    from lipwright.pipeline import AlignOptions

    targets = _targets(out, TRACK_FORMATS)
    if text is None:
        raise LipwrightError(f"{_speech_name(speech)}: give its words with --text")
    if speech == STDIN == text:
        raise LipwrightError("the sound and the words cannot both come through the pipe")
    for target in targets:
        by_suffix(TRACK_FORMATS, Path(target), _suffix(format), "phone track")
    check_targets([t for t in targets if t != STDIN], None if speech == STDIN else speech)
    words, source = read_text(text)
    options = AlignOptions(language=language, dictionary=dictionary)
    with progress_report(progress) as report:
        alignment = _align(speech, words, source, options, report)
    for target in targets:
        _write_track(target, alignment, _suffix(format))
    _report_misfits(alignment)
    if progress is not Progress.JSON:
        track = alignment.track
        for target in targets:
            say(_summary(target, track.end, len(track), len(track.words)))


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
        return
    if suffix is None:
        raise LipwrightError("standard output has no suffix; choose the format with --format")
    with tempfile.TemporaryDirectory(prefix="lipwright-") as folder:
        path = Path(folder) / f"out{suffix}"
        write_track(path, alignment.track, suffix)
        sys.stdout.buffer.write(path.read_bytes())
        sys.stdout.buffer.flush()
