"""BVH: a skeleton and its motion, as Biovision's motion capture files have them.

HIERARCHY is a tree of bones with their offsets from the parent, in centimetres, which readers of
BVH take for granted. Each bone has six channels, `Xposition Yposition Zposition Zrotation Yrotation
Xrotation`: rotations are multiplied from left to right, which turns about x first, then y, then z,
about the axes of the parent. A position is that in the parent and takes the place of the offset, as
Blender reads it; three.js adds the offset to it. A bone without children ends in a site 1 cm on. A
rig with several roots gets one above them. MOTION has `Frames`, `Frame Time` in s, and one line a
frame. The layout is that of Meredith and Maddock, Motion Capture File Formats Explained (University
of Sheffield, 2001).

Positions are rounded to a hundredth of a millimetre, angles to a thousandth of a degree.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

from lipwright.export.bone_csv import bone_values, rig_with_bones
from lipwright.export.performance import ExportOptions, Output, Performance, text_output
from lipwright.face.skeleton import Floats, Skeleton
from lipwright.rig import Rig

CM: Final = 100.0  # a metre
ROTATIONS: Final = [5, 4, 3]  # z, y, x of a bone's channels
CHANNELS: Final = "CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation"
FORMAT: Final = " ".join(["%.3f"] * 6)
ROOT: Final = "root"  # above the bones of a rig with several roots
BLOCK: Final = 2000  # frames that are formatted at once


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: the performance is in a rig without bones.
    """
    del options
    rig = rig_with_bones(path, performance)
    return [text_output(path, lambda: _lines(performance, rig))]


def _lines(performance: Performance, rig: Rig) -> Iterator[str]:
    skeleton = Skeleton.of(rig.bones)
    order, text = _hierarchy(skeleton)
    yield text
    clip = performance.clip
    yield f"MOTION\nFrames: {len(clip)}\nFrame Time: {1 / clip.fps:.9f}\n"
    values = bone_values(performance, rig)[:, order]
    places, turns = values[..., :3] * CM, values[..., ROTATIONS]
    rows = np.concatenate([places, turns], axis=-1).reshape(len(clip), -1).round(3) + 0.0
    form = " ".join([FORMAT] * len(order))
    if _has_many_roots(skeleton):
        form = f"{FORMAT % ((0,) * 6)} {form}"
    form += "\n"
    for first in range(0, len(rows), BLOCK):
        block = rows[first : first + BLOCK]
        yield (form * len(block)) % tuple(block.ravel().tolist())


def _has_many_roots(skeleton: Skeleton) -> bool:
    return int((skeleton.parents < 0).sum()) > 1


def _hierarchy(skeleton: Skeleton) -> tuple[list[int], str]:
    """The bones in the order in which they stand in the file, and its first part."""
    order: list[int] = []
    lines = ["HIERARCHY"]
    many = _has_many_roots(skeleton)
    if many:
        lines += [f"ROOT {ROOT}", "{", "  OFFSET 0 0 0", f"  {CHANNELS}"]

    def add(bone: int, depth: int) -> None:
        order.append(bone)
        pad = "  " * depth
        kind = "JOINT" if depth else "ROOT"
        lines.extend([f"{pad}{kind} {_word(skeleton.names[bone])}", f"{pad}{{"])
        lines.append(f"{pad}  OFFSET {_numbers(skeleton.offsets[bone])}")
        lines.append(f"{pad}  {CHANNELS}")
        children = np.flatnonzero(skeleton.parents == bone).tolist()
        for child in children:
            add(child, depth + 1)
        if not children:
            lines.extend([f"{pad}  End Site", f"{pad}  {{", f"{pad}    OFFSET 0 0 1", f"{pad}  }}"])
        lines.append(f"{pad}}}")

    for root in np.flatnonzero(skeleton.parents < 0).tolist():
        add(root, int(many))
    if many:
        lines.append("}")
    return order, "\n".join(lines) + "\n"


def _word(name: str) -> str:
    """A name without the spaces that end a name in BVH."""
    return "_".join(name.split())


def _numbers(offset: Floats) -> str:
    return " ".join(f"{number:.5f}" for number in (offset * CM + 0.0).tolist())
