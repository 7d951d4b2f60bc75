"""A character with its morph targets out of a GLB, as a mesh that a mapping can be fitted to."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError
from lipwright.export.gltf_names import Character
from lipwright.export.gltf_store import Json
from lipwright.export.gltf_surface import GltfMesh, read_gltf_surface
from lipwright.face.mesh import Mesh
from lipwright.face.target_mesh import character

SUFFIXES = (".glb", ".gltf", ".vrm")


def read_character(path: Path, mesh: str | None = None) -> Mesh:
    """The mesh of a file with its morph targets, vertices in the file's order.

    Args:
        path: a GLB, VRM or `.gltf`.
        mesh: the name of one of its meshes; by default the one with most triangles.

    Raises:
        LipwrightError: the file cannot be used, or its mesh has no morph targets with names.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise LipwrightError(f"{path}: characters are read from {', '.join(SUFFIXES)}; export one")
    try:
        found = read_gltf_surface(path, mesh)
    except ValueError as error:
        raise LipwrightError(f"{path}: {error}; clean the mesh and export it again") from error
    named = [
        (target, name)
        for target, name in enumerate(Character(found.file).targets[found.mesh])
        if name
    ]
    if not named:
        raise LipwrightError(
            f"{path}: its mesh has no morph targets with names; export them with their names"
        )
    deltas = np.stack([_displacements(found, target) for target, _ in named])
    return character(found.surface, [name for _, name in named], deltas, name=path.name)


def _displacements(found: GltfMesh, target: int) -> npt.NDArray[np.float64]:
    """(V, 3), how far a morph target moves the vertices, in the axes and unit of the scene."""
    file, where = found.file, f"mesh {found.mesh}"
    primitives = file.tables("primitives", file.tables("meshes")[found.mesh], where)
    moved = np.zeros((len(found.surface.vertices), 3))
    for item, run in zip(primitives, found.runs, strict=True):
        targets: list[Json] = file.tables("targets", item, where)
        if target >= len(targets):
            file.fail(f"{where}: its primitives have different numbers of morph targets")
        if "POSITION" not in targets[target]:
            continue
        count = len(file.tables("accessors"))
        values = file.accessor(file.index(targets[target], "POSITION", count, where), where)
        if values.shape != (run.stop - run.start, 3):
            file.fail(f"{where}: morph target {target} has {len(values)} vertices")
        moved[run] = values
    return np.asarray(np.einsum("vab,vb->va", found.bends, moved))
