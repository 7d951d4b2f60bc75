"""What deformation transfer is for: a character's file with our head's blendshapes, or moved."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.export.glb import mesh_to_glb
from lipwright.export.gltf_surface import with_blendshapes
from lipwright.export.onto import animated
from lipwright.export.performance import ExportOptions, Performance
from lipwright.export.surfaces import FileSurface
from lipwright.face.head import Head
from lipwright.face.target_mesh import character
from lipwright.face.transfer import TransferSolver

Floats = NDArray[np.float64]

LEFT_OUT: Final = 0.02  # of how far the head's shape moves: what moves less is not there
MOVES: Final = 1e-3  # of a shape's greatest motion; less of it is left out of files


def made_shapes(solver: TransferSolver, head: Head, names: Sequence[str]) -> Mapping[str, Floats]:
    """Control to displacements (V, 3), for those of `names` that the target can show.

    A shape that hardly moves the target, as of the tongue where it has none, is left out.
    """
    found = {}
    for name, deltas in zip(names, solver.blendshapes(head, names), strict=True):
        far = np.linalg.norm(deltas, axis=1)
        ours = np.linalg.norm(head.shape(name)[1], axis=1).max(initial=0.0) * solver.placement.scale
        if far.max() > LEFT_OUT * ours:
            found[name] = np.where(far[:, None] > MOVES * far.max(), deltas, 0.0)
    return found


def shaped_glb(target: FileSurface, shapes: Mapping[str, Floats], name: str) -> bytes:
    """The bytes of a GLB of the character with blendshapes.

    A glTF keeps all that it has; an OBJ becomes plain clay, with its texture places.

    Raises:
        LipwrightError: the character's file keeps data elsewhere.
    """
    if target.gltf is not None:
        return with_blendshapes(target.gltf, shapes)
    mesh = character(
        target.surface, tuple(shapes), np.stack(list(shapes.values())), name=target.path.stem[:60]
    )
    return mesh_to_glb(
        mesh, Clip(tuple(shapes), 1.0, np.zeros((1, len(shapes)), np.float32)), name=name
    )


def animated_glb(
    target: FileSurface, shapes: Mapping[str, Floats], path: Path, clip: Clip
) -> bytes:
    """The bytes of a GLB at `path` of the character with blendshapes, moved by a clip.

    Raises:
        LipwrightError: the character's file keeps data elsewhere, or the clip moves none of it.
    """
    if target.gltf is None:
        moved = [name for name in clip.names if name in shapes]
        if not moved:
            raise LipwrightError(f"{path}: the clip moves none of the blendshapes")
        mesh = character(
            target.surface, tuple(shapes), np.stack(list(shapes.values())),
            name=target.path.stem[:60],
        )  # fmt: skip
        return mesh_to_glb(mesh, clip, name=path.stem)
    with TemporaryDirectory(prefix="lipwright-") as folder:
        shaped = Path(folder) / target.path.with_suffix(".glb").name
        shaped.write_bytes(with_blendshapes(target.gltf, shapes))
        return animated(path, Performance(clip), ExportOptions(onto=shaped))()


def moved_vertices(solver: TransferSolver, head: Head, clip: Clip) -> Iterator[Floats]:
    """Where the target's vertices (V, 3) are at each frame of a clip."""
    weights = clip.select(head.shape_names).values
    return solver.frames(head.pose(row) for row in weights)
