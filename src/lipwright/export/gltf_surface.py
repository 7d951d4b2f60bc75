"""The mesh of a glTF file as a surface, and blendshapes put into it.

glTF 2.0 (ISO/IEC 12113:2022), sections 3.5 (nodes), 3.7.2 (meshes and morph targets) and 3.7.3
(skins: the transforms of the joints replace that of the node). The surface has the axes and the
unit of the scene, with skins as they are bound.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError
from lipwright.export.gltf_file import GltfFile, read_gltf
from lipwright.export.gltf_names import Character
from lipwright.export.gltf_rest import Rests
from lipwright.export.gltf_store import Json, Store
from lipwright.face.surface import Surface, weld_seams

Floats = npt.NDArray[np.float64]

TRIANGLES: Final = 4  # section 3.7.2.1
PACKED: Final = frozenset(("KHR_draco_mesh_compression", "EXT_meshopt_compression"))


@dataclass(frozen=True, eq=False)
class GltfMesh:
    """One mesh of a glTF file, as its scene shows it."""

    file: GltfFile
    mesh: int
    """its number"""
    surface: Surface
    """all primitives, one after the other"""
    runs: tuple[slice, ...]
    """for each primitive its vertices of the surface's V"""
    bends: Floats
    """(V, 3, 3), what takes displacements in the mesh's own axes to the scene's"""


def read_gltf_surface(path: Path, name: str | None = None) -> GltfMesh:
    """The mesh `name`, or the one with most triangles.

    Raises:
        LipwrightError: the file is none of glTF, is compressed, or has no such mesh.
        ValueError: the mesh cannot be a surface.
    """
    file = read_gltf(path)
    required = file.document.get("extensionsRequired")
    packed = PACKED & {str(name) for name in required} if isinstance(required, list) else ()
    if packed:
        raise LipwrightError(
            f"{path}: its meshes are compressed ({', '.join(packed)}); export it uncompressed"
        )
    character = Character(file)
    number = _choose(character, name)
    where = f"mesh {number}"
    primitives = file.tables("primitives", file.tables("meshes")[number], where)
    parts = [_primitive(file, item, where) for item in primitives]
    bounds = np.cumsum([0, *(len(part[0]) for part in parts)])
    if not bounds[-1]:
        raise ValueError("the mesh has no vertices")
    local = np.concatenate([part[0] for part in parts])
    triangles = np.concatenate(
        [part[1] + start for part, start in zip(parts, bounds, strict=False)]
    )
    places = [part[2] for part in parts if part[2] is not None]
    uvs = np.concatenate(places) if len(places) == len(parts) else None
    moves = _moves(character, character.shown[number][0], primitives, bounds)
    bends = moves[:, :3, :3]
    vertices = np.einsum("vab,vb->va", bends, local) + moves[:, :3, 3]
    checked = Surface(vertices, triangles)  # before seams are looked for
    surface = Surface(vertices, triangles, weld_seams(vertices, checked.triangles), uvs)
    runs = tuple(slice(int(a), int(b)) for a, b in pairwise(bounds))
    return GltfMesh(file, number, surface, runs, bends)


def _choose(character: Character, name: str | None) -> int:
    """The number of the mesh that is meant."""
    file, meshes = character.file, character.file.tables("meshes")
    if not character.shown:
        raise LipwrightError(f"{file.path}: shows no mesh; name a GLB that holds a character")
    names = {
        number: file.name(meshes[number])
        or file.name(character.nodes[nodes[0]])
        or f"mesh {number}"
        for number, nodes in sorted(character.shown.items())
    }
    if name is None:
        return max(names, key=lambda number: _size(file, meshes[number]))
    for number, known in names.items():
        if name in {known, file.name(character.nodes[character.shown[number][0]])}:
            return number
    raise LipwrightError(f"{file.path}: has no mesh {name!r}; it has: {', '.join(names.values())}")


def _size(file: GltfFile, mesh: Json) -> int:
    accessors = file.tables("accessors")
    found = 0
    for item in file.tables("primitives", mesh):
        attributes = file.table("attributes", item)
        holder, key = (item, "indices") if "indices" in item else (attributes, "POSITION")
        number = file.index(holder, key, len(accessors), "a primitive")
        found += file.whole(accessors[number], "count", f"accessor {number}")
    return found


def _attribute(file: GltfFile, item: Json, key: str, where: str) -> Floats | None:
    attributes = file.table("attributes", item)
    if key not in attributes:
        return None
    number = file.index(attributes, key, len(file.tables("accessors")), where)
    return file.accessor(number, where)


def _primitive(
    file: GltfFile, item: Json, where: str
) -> tuple[Floats, npt.NDArray[np.int64], npt.NDArray[np.float32] | None]:
    """Vertices (n, 3) in the mesh's own axes, triangles (m, 3) and texture places (n, 2)."""
    if file.whole(item, "mode", where, TRIANGLES) != TRIANGLES:
        raise LipwrightError(
            f"{file.path}: {where} is drawn as strips, fans, lines or points; export it as "
            "triangles"
        )
    vertices = _attribute(file, item, "POSITION", where)
    if vertices is None or vertices.shape[1] != 3:
        file.fail(f"{where} has a primitive without positions")
    if "indices" in item:
        number = file.index(item, "indices", len(file.tables("accessors")), where)
        numbers = file.accessor(number, where).astype(np.int64).ravel()
    else:
        numbers = np.arange(len(vertices))
    if len(numbers) % 3:
        raise ValueError(f"{len(numbers)} corners do not make triangles")
    if len(numbers) and numbers.max() >= len(vertices):
        raise ValueError(f"a triangle names vertex {numbers.max()} of {len(vertices)}")
    uvs = _attribute(file, item, "TEXCOORD_0", where)
    if uvs is not None and uvs.shape != (len(vertices), 2):
        uvs = None
    return vertices, numbers.reshape(-1, 3), None if uvs is None else uvs.astype(np.float32)


def _moves(
    character: Character, node: int, primitives: Sequence[Json], bounds: npt.NDArray[np.int64]
) -> Floats:
    """(V, 4, 4), what takes each vertex from the mesh's own axes to the scene's."""
    file, where = character.file, f"node {node}"
    rests = Rests(character)
    if "skin" not in character.nodes[node]:
        return np.broadcast_to(_world(character, rests, node), (int(bounds[-1]), 4, 4))
    skins = file.tables("skins")
    skin = skins[file.index(character.nodes[node], "skin", len(skins), where)]
    listed = skin.get("joints")
    joints = [
        file.index({"joint": joint}, "joint", len(character.nodes), "a skin")
        for joint in (listed if isinstance(listed, list) else [])
    ]
    if not joints:
        file.fail(f"{where}: its skin has no joints")
    bound = np.stack([_world(character, rests, joint) for joint in joints])
    if "inverseBindMatrices" in skin:
        number = file.index(skin, "inverseBindMatrices", len(file.tables("accessors")), where)
        inverse = file.accessor(number, where)
        if inverse.shape != (len(joints), 16):
            file.fail(f"{where}: its skin has {len(inverse)} matrices for {len(joints)} joints")
        bound = bound @ inverse.reshape(-1, 4, 4).transpose(0, 2, 1)  # stored by columns
    counts = np.diff(bounds)
    return np.concatenate(
        [
            _skinned(file, item, bound, int(n), where)
            for item, n in zip(primitives, counts, strict=True)
        ]
    )


def _skinned(file: GltfFile, item: Json, bound: Floats, count: int, where: str) -> Floats:
    bones = _attribute(file, item, "JOINTS_0", where)
    shares = _attribute(file, item, "WEIGHTS_0", where)
    if bones is None or shares is None or bones.shape != (count, 4) or shares.shape != (count, 4):
        file.fail(f"{where}: its mesh has no weights for the skin")
    if count and bones.max() >= len(bound):
        file.fail(f"{where}: its mesh names joint {int(bones.max())} of {len(bound)}")
    sums = shares.sum(axis=1, keepdims=True)
    shares = np.where(sums > 0, shares / np.where(sums > 0, sums, 1), 0.25)
    return np.asarray(np.einsum("vj,vjab->vab", shares, bound[bones.astype(np.int64)]))


def _world(character: Character, rests: Rests, node: int) -> Floats:
    """(4, 4), from the axes of a node at rest to the scene's."""
    matrix = np.eye(4)
    at: int | None = node
    while at is not None:
        matrix = _local(character.file, character.nodes[at], f"node {at}") @ matrix
        at = rests.parents.get(at)
    return matrix


def _local(file: GltfFile, node: Json, where: str) -> Floats:
    from scipy.spatial.transform import Rotation

    if "matrix" in node:
        columns = file.numbers(node, "matrix", [0.0] * 16, where)
        return np.array(columns, np.float64).reshape(4, 4).T
    matrix = np.eye(4)
    turn = file.numbers(node, "rotation", [0.0, 0.0, 0.0, 1.0], where)
    if any(turn):
        matrix[:3, :3] = Rotation.from_quat(turn).as_matrix()
    matrix[:3, :3] *= file.numbers(node, "scale", [1.0] * 3, where)
    matrix[:3, 3] = file.numbers(node, "translation", [0.0] * 3, where)
    return matrix


def with_blendshapes(mesh: GltfMesh, shapes: Mapping[str, Floats]) -> bytes:
    """The bytes of the GLB with blendshapes in its mesh, and all else as it was.

    Shapes that the mesh has already stay before the new ones; one of the same name is replaced.
    Its own animations of blendshapes are left out, since they do not know of the new ones.

    Args:
        mesh: of a GLB whose data all lies in the file.
        shapes: name to displacements (V, 3) in the axes and unit of the scene.

    Raises:
        LipwrightError: the file keeps data elsewhere, or a transform flattens the mesh.
    """
    file = mesh.file
    if len(file.buffers) > 1 or any("uri" in item for item in file.tables("buffers")):
        raise LipwrightError(f"{file.path}: keeps data in other files; export it as one GLB")
    own = Character(file).targets[mesh.mesh]
    names = [*own, *(name for name in shapes if name not in own)]
    document = deepcopy(file.document)
    store = Store(document, file.buffers[0] or b"")
    body = document["meshes"][mesh.mesh]
    try:
        back = np.linalg.inv(mesh.bends)
    except np.linalg.LinAlgError:
        raise LipwrightError(f"{file.path}: a transform makes the mesh flat; apply it") from None
    local = {name: np.einsum("vab,vb->va", back, deltas) for name, deltas in shapes.items()}
    for item, run in zip(body["primitives"], mesh.runs, strict=True):
        old = item.get("targets", [])
        count = run.stop - run.start
        item["targets"] = [
            {"POSITION": _stored(store, local[name][run], count)} if name in local else old[index]
            for index, name in enumerate(names)
        ]
    extras = body.get("extras")
    body["extras"] = {**(extras if isinstance(extras, dict) else {}), "targetNames": names}
    body["weights"] = [0.0] * len(names)
    _forget_weights(document, mesh.mesh)
    return store.to_glb(file.other_chunks)


def _stored(store: Store, deltas: Floats, count: int) -> int:
    moved = np.flatnonzero(np.abs(deltas).max(axis=1) > 0)
    return store.sparse(moved, deltas[moved], count)


def _forget_weights(document: Json, mesh: int) -> None:
    """Take out what is as long as the mesh's blendshapes were many."""
    shown = {i for i, node in enumerate(document["nodes"]) if node.get("mesh") == mesh}
    for i in shown:
        document["nodes"][i].pop("weights", None)
    kept = []
    for animation in document.get("animations", []):
        animation["channels"] = [
            channel
            for channel in animation.get("channels", [])
            if not (
                channel.get("target", {}).get("path") == "weights"
                and channel["target"].get("node") in shown
            )
        ]
        if animation["channels"]:
            kept.append(animation)
    document.pop("animations", None)
    if kept:
        document["animations"] = kept
