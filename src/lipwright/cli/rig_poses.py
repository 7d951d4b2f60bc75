"""`lipwright rigs poses`: the reference poses, for an artist to copy."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from lipwright.cli.progress import say
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from lipwright.face.shapes import ReferenceShape
    from lipwright.retarget.pose_table import PoseTable

    Picture = npt.NDArray[np.uint8]

SIZE: Final = 256  # px, a side of each picture
LETTERS: Final = 11  # px, a capital
POSES_EXAMPLES = """\b
Examples:
  lipwright rigs poses -o sheet
    sheet: mean, 8 poses of grid-s1, shut lips; set them and fill in poses.json or poses.csv
\b
  lipwright rigs poses -o sheet --rig crab.rig.json    # a table with the crab's controls
  lipwright rigs poses -o sheet --modes 6
"""


@click.command(epilog=POSES_EXAMPLES)
@click.option("-o", "--output", required=True, type=Path, metavar="FOLDER",
              help="A new folder for pictures, animation and templates.")  # fmt: skip
@click.option("--modes", default=4, show_default=True, type=click.IntRange(1, 99),
              help="Shape modes; each has two poses.")  # fmt: skip
@click.option("--reference", default="grid-s1", show_default=True, metavar="NAME",
              help="Reference shape, or the JSON file of one.")  # fmt: skip
@click.option("--rig", metavar="RIG", help="Whose controls the templates list: a name or a file.")
def poses(output: Path, modes: int, reference: str, rig: str | None) -> None:
    """Draw the poses of a reference face that an artist is to copy on a rig.

    mean.png, mode1-3.png, mode1+3.png and so on show each on our head and as an outline, sheet.png
    all of them; poses.glb is the head with one pose a second, in the same order. poses.json and
    poses.csv are to be filled in, with the rig's controls, for: lipwright rigs fit RIG --poses
    """
    from lipwright.face.shapes import load_reference_shape
    from lipwright.retarget.pose_table import pose_labels
    from lipwright.rig import load_rig

    shape = load_reference_shape(reference)
    if modes > len(shape):
        raise LipwrightError(f"--modes {modes}: {shape.name} has {len(shape)} shape modes")
    labels = ("mean", *pose_labels(modes), "shut")
    if missing := [label for label in labels if label not in shape.human]:
        raise LipwrightError(f"{shape.name} does not say how a head shows {missing[0]}")
    names = _template_controls(shape, labels) if rig is None else load_rig(rig).names
    with _new_folder(output) as folder:
        _draw(folder, shape, labels)
        _write_templates(folder, _template(shape, labels, reference, rig is None), names)
    say(
        f"{output}: mean, {2 * modes} poses of {shape.name}, shut lips; set them and fill in "
        "poses.json or poses.csv"
    )


@contextmanager
def _new_folder(target: Path) -> Iterator[Path]:
    """A folder that becomes `target` when the block ends well, and else leaves no trace.

    Raises:
        LipwrightError: there is something of that name, or it cannot be written.
    """
    if target.is_symlink() or target.exists():
        raise LipwrightError(f"{target}: is there already; name a new folder")
    try:
        part = Path(tempfile.mkdtemp(prefix=".poses-", dir=target.absolute().parent))
    except OSError as error:
        raise LipwrightError(f"{target}: cannot be written: {error.strerror}") from error
    try:
        yield part
        part.chmod(0o755)
        part.rename(target)
    except OSError as error:
        raise LipwrightError(f"{target}: cannot be written: {error.strerror}") from error
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _draw(folder: Path, shape: ReferenceShape, labels: tuple[str, ...]) -> None:
    """Write the pictures and the animation."""
    import numpy as np

    from lipwright.clip import Clip
    from lipwright.controls import CANONICAL
    from lipwright.export.glb import mesh_to_glb
    from lipwright.face.head import load_head
    from lipwright.face.outlines import draw_words, sheet
    from lipwright.face.png import write_png
    from lipwright.face.render import Renderer, pose_weights

    head = load_head()
    weights = np.stack([pose_weights(**shape.human[label]) for label in labels])
    tiles: dict[str, list[Picture]] = {}
    with Renderer(head, SIZE, SIZE, view="mouth") as renderer:
        for label, row, outline in zip(labels, weights, _outlines(shape, labels), strict=True):
            tiles[label] = [renderer.render(row), draw_words(outline, label, LETTERS)]
            write_png(folder / f"{label}.png", sheet([tiles[label]]))
    columns = [("mean", "shut"), *zip(labels[1:-1:2], labels[2:-1:2], strict=True)]
    stacks = [tiles[above] + tiles[below] for above, below in columns]
    write_png(folder / "sheet.png", sheet(list(zip(*stacks, strict=True))))
    clip = Clip(CANONICAL, 1.0, weights)
    (folder / "poses.glb").write_bytes(mesh_to_glb(head, clip, name=", ".join(labels)))


def _outlines(shape: ReferenceShape, labels: tuple[str, ...]) -> list[Picture]:
    """The reference face in each pose, its mean in pale; lips that overlap are made to meet."""
    import numpy as np

    from lipwright.face.outlines import draw_outline
    from lipwright.face.reference import meeting
    from lipwright.face.shapes import lip_gap
    from lipwright.rig import SIGMA

    shapes: list[Any] = [shape.mean]
    for index in range(len(labels) - 2):
        p = shape.pose(1 + index // 2, SIGMA if index % 2 else -SIGMA)
        points = shape.points(p)
        shapes.append(points if lip_gap(points) > 0 else meeting(points))
    shapes.append(meeting(shape.points(shape.offset)))
    margin = 0.1  # eye distances
    box = (np.min(shapes, axis=(0, 1)) - margin, np.max(shapes, axis=(0, 1)) + margin)
    return [
        draw_outline(points, SIZE, box, None if index == 0 else shape.mean)
        for index, points in enumerate(shapes)
    ]


def _template_controls(shape: ReferenceShape, labels: tuple[str, ...]) -> tuple[str, ...]:
    """The canonical controls that the poses move."""
    from lipwright.controls import CANONICAL

    moved = {name for label in labels for name in shape.human[label]}
    return tuple(name for name in CANONICAL if name in moved)


def _template(
    shape: ReferenceShape, labels: tuple[str, ...], reference: str, is_filled: bool
) -> PoseTable:
    """Poses to fill in; filled in for canonical controls, as an example."""
    from lipwright.retarget.pose_table import PoseTable

    mean = shape.human["mean"]
    filled = {
        label: dict(shape.human[label]) if label in {"mean", "shut"}
        else {**dict.fromkeys(mean, 0.0), **shape.human[label]}
        for label in labels
    }  # fmt: skip
    return PoseTable(filled if is_filled else {label: {} for label in labels}, reference)


def _write_templates(folder: Path, table: PoseTable, names: tuple[str, ...]) -> None:
    from lipwright.retarget.pose_files import table_to_csv, table_to_json

    (folder / "poses.json").write_text(table_to_json(table), "utf-8", newline="")
    (folder / "poses.csv").write_text(table_to_csv(table, names), "utf-8", newline="")
