"""`lipwright animate`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import click

from lipwright.cli.aligning import (
    Listening,
    dictionary_option,
    language_option,
    listening_options,
    named,
    report_heard,
    report_misfits,
    say_done,
    speech_argument,
    speech_name,
    text_option,
)
from lipwright.cli.inputs import STDIN, read_text, recording
from lipwright.cli.layering import Layers, layer_options
from lipwright.cli.motion import Motion, motion_options, no_head, report_missing
from lipwright.cli.outputs import (
    Wanted,
    character_options,
    check_files,
    export_targets,
    exporters_of,
    format_option,
    out_option,
    outputs_known,
    suffix_of,
    targets_of,
    tracks_apart,
    warn_left_out,
    write_tracks,
)
from lipwright.cli.progress import progress_option, progress_report
from lipwright.errors import LipwrightError

ANIMATE_EXAMPLES = """\b
Examples:
  lipwright animate examples/hello.flac --text examples/hello.txt -o hello.csv -o hello.glb
    hello.csv: 9.3 s, 82 phones, 26 words
    hello.glb: 9.3 s, 82 phones, 26 words
\b
  lipwright animate talk.mp3 -o talk.glb
  lipwright animate talk.mp3 --text talk.txt -o talk.csv -o talk.TextGrid
  lipwright animate tal.mp3 --text tal.txt --language sv -o tal.mp4
  lipwright animate talk.mp3 --phones talk.TextGrid -o talk.livelink.csv --fps 30
  lipwright animate talk.mp3 --text talk.txt --model anna-model -o talk.mp4
  lipwright animate talk.mp3 --text talk.txt --bigrams anna.json -o talk.mp4
  lipwright animate talk.mp3 --text talk.txt --expression happy=0.5 --life -o talk.mp4
  lipwright animate talk.mp3 --text talk.txt --onto hero.vrm -o hero.glb
  lipwright animate talk.mp3 --text talk.txt --rig cc4 --edits talk.edits.json -o talk.json
  cat talk.wav | lipwright animate - --text talk.txt -o - --format json
"""


@click.command(epilog=ANIMATE_EXAMPLES)
@speech_argument
@text_option
@click.option(
    "--phones",
    type=Path,
    help="Phone times to use instead of words: TextGrid, CTM, lab, JSON, pho, or what another "
    "program has written; see lipwright formats.",
)
@out_option
@format_option
@motion_options
@layer_options
@dictionary_option
@language_option
@listening_options
@character_options
@progress_option
def animate(
    speech: str, text: str | None, phones: Path | None, out: tuple[str, ...],
    format: str | None,  # noqa: A002  # as the option is called
    motion: Motion, layers: Layers, dictionary: Path | None, language: str | None,
    listening: Listening, wanted: Wanted, progress: str,
) -> None:  # fmt: skip
    """Make a face speak a recording: curves, an animated head, a video.

    Without words or phones, what is said is recognised.
    """
    from lipwright.pipeline import animate as make

    targets = targets_of(out, outputs_known(), format)
    curves, tracks = tracks_apart(targets, suffix_of(format))
    _check_inputs(speech, text, phones, dictionary)
    options = motion.options(layers, wanted)
    alignment = listening.options(language, dictionary)
    export_options = wanted.options(Path(speech_name(speech)).stem)
    exporters_of(curves, suffix_of(format), wanted, options.controls(), no_head(options))
    check_files(targets, speech, text, phones, dictionary, motion.bigrams, *wanted.inputs)
    words, source = (None, "") if text is None else read_text(text)
    with progress_report(progress) as report, recording(speech) as path, named(path, speech):
        result = make(
            path, words, phones=phones, options=options, text_source=source, report=report,
            alignment=alignment,
        )  # fmt: skip
        show = replace(export_options, progress=lambda done, all_: report("video", done / all_))
        export_targets(result.performance, curves, suffix_of(format), wanted, show)
    write_tracks(tracks, result.track, suffix_of(format))
    if result.heard is not None:
        report_heard(speech_name(speech), result.heard, progress)
    if result.alignment is not None:
        report_misfits(result.alignment, progress)
    report_missing(options, result.track, progress)
    warn_left_out(result.performance, wanted, progress)
    say_done(targets, result.track, progress)


def _check_inputs(
    speech: str, text: str | None, phones: Path | None, dictionary: Path | None
) -> None:
    """Refuse inputs that do not go together."""
    if text is not None and phones is not None:
        raise LipwrightError(
            f"{speech_name(speech)}: give either its words with --text or its phones with "
            "--phones, or neither"
        )
    if speech == STDIN == text:
        raise LipwrightError("the sound and the words cannot both come through the pipe")
    if phones is not None and dictionary is not None:
        raise LipwrightError(f"{dictionary}: --phones needs no dictionary; leave one of them out")
