"""`lipwright convert`: curves that exist already, for another rig or in another format."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

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
from lipwright.cli.progress import progress_option, progress_report, say

if TYPE_CHECKING:
    from lipwright.export import Performance

CONVERT_EXAMPLES = """\b
Examples:
  lipwright convert examples/hello.clip.json --rig vrm1 --keys 0.01 -o hello.anim
    hello.anim: 9.3 s, 18 controls
\b
  lipwright convert talk.json --onto hero.vrm -o hero.glb
  lipwright convert talk.livelink.csv --audio talk.wav -o talk.mp4
  lipwright convert talk.json --audio talk.wav --rig preston-blair -o talk.pgo
"""


@click.command(epilog=CONVERT_EXAMPLES)
@click.argument("clip", type=Path)
@out_option
@format_option
@click.option("--audio", type=Path, help="The sound of the curves, for outputs that have one.")
@click.option("--phones", type=Path, help="Phone times, where the curves' file has none.")
@click.option("--of-rig", help="Rig that the curves are of, where they are not canonical.")
@click.option("--fps", type=float, help="Frames a second.  [default: those of the curves]")
@character_options
@progress_option
def convert(
    clip: Path, out: tuple[str, ...],
    format: str | None,  # noqa: A002  # as the option is called
    audio: Path | None, phones: Path | None, of_rig: str | None, fps: float | None,
    wanted: Wanted, progress: str,
) -> None:  # fmt: skip
    """Write the curves of CLIP, from any engine or program, for another rig or in another format.

    CLIP is a file that can be read back: .json, .csv, .livelink.csv, .glb or .vrma.
    """
    from dataclasses import replace

    from lipwright.export import EXPORTERS
    from lipwright.export.rigged import for_rig
    from lipwright.export.stored import read_performance

    targets = targets_of(out, EXPORTERS, format)
    options = wanted.options(clip.stem)
    check_files(targets, str(audio or ""), clip, phones, of_rig, *wanted.inputs)
    performance = read_performance(clip, audio=audio, phones=phones, rig=of_rig, fps=fps)
    names = performance.clip.names
    exporters_of(targets, suffix_of(format), wanted, _shown_names(performance), (
        f"{clip} has curves of {', '.join(names[:3])}{', ...' * (len(names) > 3)}, which move no "
        "head; say whose they are with --of-rig, or write another format"
    ))  # fmt: skip
    with progress_report(progress) as report:
        show = replace(options, progress=lambda done, all_: report("video", done / all_))
        moved = for_rig(performance, wanted.target)
        export_targets(moved, targets, suffix_of(format), wanted, show)
    warn_left_out(moved, wanted, progress)
    if progress != "json":
        for target in targets:
            say(f"{target}: {moved.clip.duration:.1f} s, {len(moved.clip.names)} controls")


def _shown_names(performance: Performance) -> tuple[str, ...]:
    from lipwright.controls import CANONICAL

    rig = performance.rig
    return CANONICAL if rig is not None and (rig.looks or rig.bones) else performance.clip.names
