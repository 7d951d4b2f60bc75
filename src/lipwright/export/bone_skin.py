"""Bones and skin put into somebody's GLB; all else in it stays.

glTF 2.0 (ISO/IEC 12113:2022), section 3.7.3: the joints hang in the scene, the transform of the
mesh's node no longer counts and is part of the inverse bind matrices instead.
"""

from __future__ import annotations

from copy import deepcopy

import numpy as np

from lipwright.errors import LipwrightError
from lipwright.export.gltf_names import Character
from lipwright.export.gltf_store import Json, Store
from lipwright.export.gltf_surface import GltfMesh
from lipwright.export.skinned import add_skin, bone_nodes, skin_attributes
from lipwright.face.skeleton import Floats
from lipwright.face.skinning import SkinnedMesh


def with_bones(found: GltfMesh, skinned: SkinnedMesh) -> bytes:
    """The bytes of a character's GLB with bones that hold its mesh.

    Args:
        found: the mesh of a GLB whose data all lies in the file.
        skinned: the same vertices on bones, in the axes and unit of the scene.

    Raises:
        LipwrightError: the mesh has a skin already or is shown twice, or the file keeps data
            elsewhere.
    """
    file = found.file
    shown = Character(file).shown[found.mesh]
    nodes = file.document["nodes"]
    if len(shown) > 1 or "skin" in nodes[shown[0]]:
        raise LipwrightError(
            f"{file.path}: its mesh has a skin already, or is shown twice; name another --mesh, or "
            "export it without its skeleton"
        )
    if len(file.buffers) > 1 or any("uri" in item for item in file.tables("buffers")):
        raise LipwrightError(f"{file.path}: keeps data in other files; export it as one GLB")
    document = deepcopy(file.document)
    store = Store(document, file.buffers[0] or b"")
    first = len(nodes)
    holder, *bones = bone_nodes(f"{skinned.mesh.name}_bones", skinned.skeleton, first + 1)
    document["nodes"] += [holder, *bones]
    for scene in document["scenes"]:
        scene["nodes"] = [*scene.get("nodes", []), first]
    document["nodes"][shown[0]]["skin"] = add_skin(
        store, skinned.skeleton, first + 1, _own_axes(found)
    )
    items: list[Json] = document["meshes"][found.mesh]["primitives"]
    for item, run in zip(items, found.runs, strict=True):
        item["attributes"] |= skin_attributes(store, skinned.weights[run])
    return store.to_glb(file.other_chunks)


def _own_axes(found: GltfMesh) -> Floats:
    """(4, 4), from the mesh's own axes to the scene's."""
    file = found.file
    item = file.tables("primitives", file.tables("meshes")[found.mesh])[0]
    number = file.index(file.table("attributes", item), "POSITION", len(file.tables("accessors")),
                        "a primitive")  # fmt: skip
    local = file.accessor(number, "a primitive")[0]
    matrix = np.eye(4)
    matrix[:3, :3] = found.bends[0]
    matrix[:3, 3] = found.surface.vertices[0] - found.bends[0] @ local
    return matrix
