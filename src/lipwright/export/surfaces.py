"""Characters out of files, as surfaces that motion can be carried over to."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.export.gltf_surface import GltfMesh, read_gltf_surface
from lipwright.face.surface import Surface
from lipwright.face.surface_obj import read_obj_surface

OBJ: Final = ".obj"
SUFFIXES: Final = (OBJ, ".glb", ".gltf", ".vrm")


@dataclass(frozen=True, eq=False)
class FileSurface:
    """The surface of a file."""

    path: Path
    surface: Surface
    gltf: GltfMesh | None
    """where it came from in a glTF file; None for an OBJ"""


def read_surface(path: str | os.PathLike[str], mesh: str | None = None) -> FileSurface:
    """The surface in an OBJ, GLB, VRM or glTF file, fit for transfer.

    Args:
        path: the file.
        mesh: the name of the mesh of a glTF file; by default the one with most triangles.

    Raises:
        LipwrightError: the file cannot be read, or its mesh cannot be used: it is empty, a number
            is not finite, an edge has more than two triangles, or no triangle has an area.
    """
    path = Path(path)
    if path.suffix.lower() not in SUFFIXES:
        raise LipwrightError(f"{path}: meshes are read from {', '.join(SUFFIXES)}; export one")
    try:
        if path.suffix.lower() == OBJ:
            if mesh is not None:
                raise LipwrightError(  # beside the other ways to be wrong
                    f"{path}: an OBJ is read whole; leave out the name of a mesh"
                )
            found = FileSurface(path, read_obj_surface(path), None)
        else:
            gltf = read_gltf_surface(path, mesh)
            found = FileSurface(path, gltf.surface, gltf)
        found.surface.check_usable()
    except OSError as error:
        raise LipwrightError(f"{path}: cannot be read: {error.strerror or error}") from error
    except ValueError as error:
        raise LipwrightError(f"{path}: {error}; clean the mesh and export it again") from error
    return found
