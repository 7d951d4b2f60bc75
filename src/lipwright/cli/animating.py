"""`lipwright animate`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from lipwright.cli.aligning import (
    dictionary_option,
    language_option,
    named,
    report_misfits,
    say_done,
    speech_argument,
    speech_name,
    text_option,
)
from lipwright.cli.inputs import STDIN, read_text, recording
from lipwright.cli.layering import Layers, layer_options
from lipwright.cli.outputs import (
    Wanted,
    character_options,
    check_files,
    export_targets,
    exporters_of,
    format_option,
    out_option,
    suffix_of,
    targets_of,
    warn_left_out,
)
from lipwright.cli.progress import progress_option, progress_report, warn
from lipwright.engines import DEFAULT, ENGINES, OF_BIGRAMS, OF_MODELS
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.pipeline import AnimateOptions
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
@layer_options
@dictionary_option
@language_option
@character_options
@progress_option
def animate(
    speech: str, text: str | None, phones: Path | None, out: tuple[str, ...],
    format: str | None,  # noqa: A002  # as the option is called
    engine: str | None, model: str | None, bigrams: str | None, fps: float, layers: Layers,
    dictionary: Path | None, language: str, wanted: Wanted, progress: str,
) -> None:  # fmt: skip
    """Make a face speak a recording: curves, an animated head, a video."""
    from lipwright.export import EXPORTERS
    from lipwright.pipeline import AlignOptions, AnimateOptions
    from lipwright.pipeline import animate as make

    targets = targets_of(out, EXPORTERS, format)
    if (text is None) == (phones is None):
        raise LipwrightError(
            f"{speech_name(speech)}: give either its words with --text or its phones with --phones"
        )
    if speech == STDIN == text:
        raise LipwrightError("the sound and the words cannot both come through the pipe")
    if phones is not None and dictionary is not None:
        raise LipwrightError(f"{dictionary}: --phones needs no dictionary; leave one of them out")
    options = AnimateOptions(
        engine=engine, model=model, bigrams=bigrams, fps=fps, rig=wanted.target,
        intensity=layers.intensity, intensities=layers.intensities, expressions=layers.expressions,
        life=layers.life, seed=layers.seed,
    )  # fmt: skip
    export_options = wanted.options(Path(speech_name(speech)).stem)
    exporters_of(targets, suffix_of(format), wanted, options.controls(), _no_head(options))
    check_files(targets, speech, text, phones, dictionary, bigrams, *wanted.inputs)
    words, source = (None, "") if text is None else read_text(text)
    with progress_report(progress) as report, recording(speech) as path, named(path, speech):
        result = make(
            path, words, phones=phones, options=options, text_source=source, report=report,
            alignment=AlignOptions(language=language, dictionary=dictionary),
        )  # fmt: skip
        show = replace(export_options, progress=lambda done, all_: report("video", done / all_))
        export_targets(result.performance, targets, suffix_of(format), wanted, show)
    if result.alignment is not None:
        report_misfits(result.alignment, progress)
    _report_missing(options, result.track, progress)
    warn_left_out(result.performance, wanted, progress)
    say_done(targets, result.track, progress)


def _no_head(options: AnimateOptions) -> str:
    """Why what the options make moves no human head, and what can be done."""
    names = options.controls()
    if options.bigram_set is not None:
        return (
            f"{options.bigram_set.name} moves poses of a creature ({names[0]} to {names[-1]}), "
            "which no human head shows; write .csv or .json, as examples/07_crab.py does before it "
            "draws"
        )
    return (
        f"{options.model} predicts modes of a reference face ({names[0]} to {names[-1]}), which "
        "move no head; write .csv or .json for 'lipwright face overlay --params', name a --rig, "
        "or train one with: lipwright train --targets arkit"
    )


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
