"""`lipwright face`: the reference face of a dataset."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lipwright.cli.progress import progress_option, progress_report, say, warn
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.face.reference import ReferenceFace

FIT_EXAMPLES = """\b
Examples:
  lipwright face fit anna -o anna-face.npz
    anna-face.npz: 3 shape, 12 + 25 pixel and 15 joint modes from 2 recordings
    train: points 0.0033 eye distances (0.24 px), grey levels 4.55 inner mouth, 0.69 rest
\b
  lipwright face fit anna -o anna-face.npz --videos moved/videos
"""
INFO_EXAMPLES = """\b
Example:
  lipwright face info anna-face.npz
    vertices: 34
    shape modes: 3, 99.1% of the variance
"""
SHOW_EXAMPLES = """\b
Example:
  lipwright face show anna-face.npz -o modes.png --modes 2
    modes.png: written
"""
OVERLAY_EXAMPLES = """\b
Examples:
  lipwright face overlay anna-face.npz anna anna1 -o anna1.mp4
    anna1.mp4: 53 frames
\b
  lipwright face overlay anna-face.npz anna anna1 --params guess.csv -o guess.mp4
"""

face_argument = click.argument("face_file", metavar="FACE.npz", type=Path)
videos_option = click.option(
    "--videos", type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Folder of the videos, where they have moved since they were captured.",
)  # fmt: skip


@click.group(epilog="Each command has examples: lipwright face COMMAND --help")
def face() -> None:
    """Fit, describe and look at the reference face of a speaker."""


@face.command(epilog=FIT_EXAMPLES)
@click.argument("dataset", type=Path)
@click.option("-o", "--output", "out", type=Path, required=True, help="The .npz to write.")
@videos_option
@click.option("--shape-share", type=float, default=0.99, show_default=True,
              help="Share of the variance of shapes that modes keep.")  # fmt: skip
@click.option("--pixel-share", type=float, default=0.95, show_default=True,
              help="The same of the pixels of each region.")  # fmt: skip
@click.option("--joint-share", type=float, default=0.99, show_default=True,
              help="The same of shape and pixels together.")  # fmt: skip
@click.option("--most-modes", type=int, default=100, show_default=True,
              help="Pixel modes of a region at most.")  # fmt: skip
@click.option("--frames", type=int, default=4000, show_default=True,
              help="Frames that pixel modes are found from, at most.")  # fmt: skip
@click.option("--pixels", type=int, default=40_000, show_default=True,
              help="Pixel samples at most; low-resolution video has fewer.")  # fmt: skip
@progress_option
def fit(dataset: Path, out: Path, videos: Path | None, progress: str, **shares: Any) -> None:
    """Fit a reference face to a dataset, and write its parameters beside each recording."""
    from lipwright.capture.face_of_dataset import fit_dataset
    from lipwright.capture.fit_face import FitOptions
    from lipwright.dataset.folder import open_dataset
    from lipwright.export import check_targets

    _check_suffix(out, ".npz", "a reference face")
    options, opened = FitOptions(**shares), open_dataset(dataset)
    check_targets([out])
    with progress_report(progress) as report:
        fitted = fit_dataset(opened, out, options, videos, report)
    for line in fitted.skipped:
        warn(line, progress)
    if progress != "json":
        say(f"{out}: {_counts(fitted.face)} from {len(fitted.used)} recordings")
        for split, errors in fitted.face.info["errors"].items():
            say(f"{split}: {_error_line(errors)}")


def _counts(model: ReferenceFace) -> str:
    shape, inner, outer = model.sizes
    return f"{shape} shape, {inner} + {outer} pixel and {len(model.joint_modes)} joint modes"


def _error_line(errors: dict[str, Any]) -> str:
    joint = errors["joint"]
    grey = {
        region: f"{joint[region].get('mae', float('nan')):.2f}" for region in ("inner", "outer")
    }
    return (
        f"points {joint['points']:.4f} eye distances ({joint['px']:.2f} px), grey levels "
        f"{grey['inner']} inner mouth, {grey['outer']} rest"
    )


def _check_suffix(path: Path, suffix: str, what: str) -> None:
    if path.suffix.lower() != suffix:
        raise LipwrightError(f"{path}: {what} is written as {suffix}; name such a file")


@face.command(epilog=INFO_EXAMPLES)
@face_argument
def info(face_file: Path) -> None:
    """Say what a reference face is made of, and how well it fits."""
    from lipwright.face.reference_file import load_reference_face

    model = load_reference_face(face_file)
    for name, value in model.summary().items():
        click.echo(f"{name}: {value}")
    for split, errors in model.info.get("errors", {}).items():
        click.echo(f"errors, {split}: {_error_line(errors)}")


@face.command(epilog=SHOW_EXAMPLES)
@face_argument
@click.option("-o", "--output", "out", type=Path, required=True, help="The PNG to write.")
@click.option("--modes", type=click.IntRange(1, 20), default=3, show_default=True,
              help="How many modes.")  # fmt: skip
@click.option("--vertices", is_flag=True, help="Show the 34 vertices with their numbers instead.")
def show(face_file: Path, out: Path, modes: int, vertices: bool) -> None:
    """Draw the first modes at -3, 0 and 3 standard deviations."""
    from lipwright.capture.face_pictures import write_modes, write_vertices
    from lipwright.export import check_targets
    from lipwright.face.reference_file import load_reference_face

    _check_suffix(out, ".png", "a picture")
    check_targets([out])
    model = load_reference_face(face_file)
    if vertices:
        write_vertices(out, model)
    else:
        write_modes(out, model, modes)
    say(f"{out}: written")


@face.command(epilog=OVERLAY_EXAMPLES)
@face_argument
@click.argument("dataset", type=Path)
@click.argument("name")
@click.option("-o", "--output", "out", type=Path, required=True, help="The MP4 to write.")
@click.option("--params", type=Path,
              help="CSV or JSON clip of modes (joint1..., or shape1..., inner1..., outer1...) on "
              "the clock of the sound; without it, the recording's own.")  # fmt: skip
@videos_option
@progress_option
def overlay(
    face_file: Path, dataset: Path, name: str, out: Path, params: Path | None,
    videos: Path | None, progress: str,
) -> None:  # fmt: skip
    """Lay the reference face over the video of a recording, beside the video itself."""
    from lipwright.capture.overlay import own_parameters, parameters_at_frames, write_overlay
    from lipwright.capture.takes import make_take
    from lipwright.dataset.folder import open_dataset
    from lipwright.export import check_targets, read_clip
    from lipwright.face.reference_file import load_reference_face

    _check_suffix(out, ".mp4", "a video")
    check_targets([out])
    model, opened = load_reference_face(face_file), open_dataset(dataset)
    clip = read_clip(params) if params is not None else None
    recording = opened.recording(name)
    take = make_take(recording, "test", videos)
    if take is None:
        raise LipwrightError(f"{opened.path}: {name} has no landmarks or no video to lay over")
    parameters, light = own_parameters(model, take)
    if clip is not None:
        parameters = parameters_at_frames(model, recording, clip)
    with progress_report(progress) as report:
        count = write_overlay(
            out, model, recording, take, parameters, light,
            lambda done, total: report("encode", done / total),
        )  # fmt: skip
    if progress != "json":
        say(f"{out}: {count} frames")
