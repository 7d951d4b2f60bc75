"""The mesh of a glTF 2.0 file as a surface, in the axes and unit of its scene.

As the Khronos glTF 2.0 specification lays down: accessors (section 3.6.2, sparse ones too),
meshes (3.7.2), skins (3.7.3: the transforms of joints replace that of the node) and nodes (3.5.3).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError
from lipwright.face.surface import Surface, weld_seams

Floats = npt.NDArray[np.float64]

# glTF 2.0, section 3.6.2.2 and 3.7.2.1
COMPONENTS: Final = {
    5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32,
    5126: np.float32,
}  # fmt: skip
WIDTHS: Final = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
TRIANGLES: Final = 4


@dataclass(frozen=True, eq=False)
class GltfMesh:
    """One mesh of a glTF file, as its scene shows it."""

    document: Any
    """pygltflib's GLTF2"""
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
        OSError: the file cannot be read.
    """
    document = _load(path)
    shown = {node.mesh: i for i, node in reversed(list(enumerate(document.nodes)))
             if node.mesh is not None}  # fmt: skip
    if not document.meshes or not shown:
        raise LipwrightError(f"{path}: shows no mesh; name a GLB that holds a character")
    chosen = _choose(path, document, shown, name)
    parts = [_primitive(path, document, p) for p in document.meshes[chosen].primitives]
    bounds = np.cumsum([0, *(len(part[0]) for part in parts)])
    local = np.concatenate([part[0] for part in parts])
    triangles = np.concatenate(
        [part[1] + start for part, start in zip(parts, bounds, strict=False)]
    )
    uvs = None if any(part[2] is None for part in parts) else np.concatenate([p[2] for p in parts])
    moves = _moves(document, shown[chosen], len(local))
    bends = moves[:, :3, :3]
    vertices = np.einsum("vab,vb->va", bends, local) + moves[:, :3, 3]
    surface = Surface(vertices, triangles)  # checks the numbers before seams are looked for
    surface = Surface(vertices, triangles, weld_seams(vertices, surface.triangles), uvs)
    runs = tuple(slice(int(a), int(b)) for a, b in pairwise(bounds))
    return GltfMesh(document, chosen, surface, runs, bends)


def _load(path: Path) -> Any:
    import pygltflib as gltf

    try:
        document = gltf.GLTF2().load(str(path))
    except FileNotFoundError as error:
        raise LipwrightError(f"{path}: no such file") from error
    except OSError:
        raise
    except Exception as error:  # pygltflib lets through whatever its parsers raise
        raise LipwrightError(f"{path}: not a glTF file: {type(error).__name__}") from error
    if document is None:
        raise LipwrightError(f"{path}: not a glTF file")
    packed = set(document.extensionsRequired) & {
        "KHR_draco_mesh_compression", "EXT_meshopt_compression",
    }  # fmt: skip
    if packed:
        raise LipwrightError(
            f"{path}: its meshes are compressed ({', '.join(packed)}); export it uncompressed"
        )
    return document


def _choose(path: Path, document: Any, shown: dict[int, int], name: str | None) -> int:
    """The number of the mesh that is meant."""
    names = {index: document.meshes[index].name or document.nodes[node].name or f"mesh {index}"
             for index, node in sorted(shown.items())}  # fmt: skip
    if name is None:
        return max(names, key=lambda index: _size(document, document.meshes[index]))
    for index, known in names.items():
        if name in (known, document.nodes[shown[index]].name):
            return index
    raise LipwrightError(f"{path}: has no mesh {name!r}; it has: {', '.join(names.values())}")


def _size(document: Any, mesh: Any) -> int:
    counts = (p.indices if p.indices is not None else p.attributes.POSITION
              for p in mesh.primitives)  # fmt: skip
    return sum(document.accessors[index].count for index in counts)


def _primitive(
    path: Path, document: Any, primitive: Any
) -> tuple[Floats, npt.NDArray[np.int64], npt.NDArray[np.float32] | None]:
    """Vertices (n, 3) in the mesh's own axes, triangles (m, 3) and texture places (n, 2)."""
    if primitive.mode not in (None, TRIANGLES):
        raise LipwrightError(
            f"{path}: a mesh is drawn as strips, fans, lines or points; export it as triangles"
        )
    vertices = read_accessor(document, primitive.attributes.POSITION).astype(np.float64)
    if primitive.indices is None:
        numbers = np.arange(len(vertices))
    else:
        numbers = read_accessor(document, primitive.indices).astype(np.int64).ravel()
    if len(numbers) % 3:
        raise ValueError(f"{len(numbers)} corners do not make triangles")
    uvs = primitive.attributes.TEXCOORD_0
    places = None if uvs is None else read_accessor(document, uvs).astype(np.float32)
    return vertices, numbers.reshape(-1, 3), places


def read_accessor(document: Any, index: int) -> npt.NDArray[Any]:
    """The values (n, width) of an accessor; those that are normalised, from -1 or 0 to 1.

    Raises:
        ValueError: the file ends before its values do.
    """
    accessor = document.accessors[index]
    kind: np.dtype[Any] = np.dtype(COMPONENTS[accessor.componentType])
    width = WIDTHS[accessor.type]
    if accessor.bufferView is None:
        values = np.zeros((accessor.count, width), kind)
    else:
        values = _view(document, accessor.bufferView, accessor.byteOffset or 0,
                       kind, accessor.count, width).copy()  # fmt: skip
    if accessor.sparse is not None:
        sparse, some = accessor.sparse, accessor.sparse.count
        where = _view(document, sparse.indices.bufferView, sparse.indices.byteOffset or 0,
                      np.dtype(COMPONENTS[sparse.indices.componentType]), some, 1)  # fmt: skip
        values[where[:, 0]] = _view(document, sparse.values.bufferView,
                                    sparse.values.byteOffset or 0, kind, some, width)  # fmt: skip
    if accessor.normalized and kind.kind in "iu":
        return np.maximum(values / float(np.iinfo(kind).max), -1.0)
    return values


def _view(
    document: Any, index: int, offset: int, kind: np.dtype[Any], count: int, width: int
) -> npt.NDArray[Any]:
    view = document.bufferViews[index]
    data = _buffer(document, view.buffer)
    stride = view.byteStride or kind.itemsize * width
    start = (view.byteOffset or 0) + offset
    if start + stride * (count - 1) + kind.itemsize * width > len(data):
        raise ValueError("the file ends before its numbers do")
    return np.ndarray((count, width), kind, data, start, (stride, kind.itemsize))


def _buffer(document: Any, index: int) -> bytes:
    buffer = document.buffers[index]
    if buffer.uri is None:
        return document.binary_blob() or b""
    return document.get_data_from_buffer_uri(buffer.uri)


def _moves(document: Any, node: int, count: int) -> Floats:
    """(count, 4, 4), what takes each vertex from the mesh's own axes to the scene's."""
    world = dict(_worlds(document))
    skin = document.nodes[node].skin
    if skin is None:
        return np.broadcast_to(world[node], (count, 4, 4))
    joints = np.stack([world[joint] for joint in document.skins[skin].joints])
    if document.skins[skin].inverseBindMatrices is not None:
        inverse = read_accessor(document, document.skins[skin].inverseBindMatrices)
        joints = joints @ inverse.reshape(-1, 4, 4).transpose(0, 2, 1)  # stored by columns
    primitives = document.meshes[document.nodes[node].mesh].primitives
    return np.concatenate([_skinned(document, p.attributes, joints) for p in primitives])


def _skinned(document: Any, attributes: Any, joints: Floats) -> Floats:
    bones = read_accessor(document, attributes.JOINTS_0).astype(np.int64)
    shares = read_accessor(document, attributes.WEIGHTS_0).astype(np.float64)
    shares /= np.maximum(shares.sum(axis=1, keepdims=True), np.finfo(float).tiny)
    return np.asarray(np.einsum("vj,vjab->vab", shares, joints[bones]))


def _worlds(document: Any) -> Iterator[tuple[int, Floats]]:
    """Each node of the file with its transform (4, 4) in the scene."""
    children = {child for node in document.nodes for child in node.children or []}
    queue = [(i, np.eye(4)) for i in range(len(document.nodes)) if i not in children]
    while queue:
        index, above = queue.pop()
        node = document.nodes[index]
        here = above @ _local(node)
        yield index, here
        queue += [(child, here) for child in node.children or []]


def _local(node: Any) -> Floats:
    from scipy.spatial.transform import Rotation

    if node.matrix is not None:
        return np.asarray(node.matrix, np.float64).reshape(4, 4).T
    matrix = np.eye(4)
    turn = Rotation.from_quat(node.rotation or [0.0, 0.0, 0.0, 1.0]).as_matrix()
    matrix[:3, :3] = turn * (node.scale or [1.0, 1.0, 1.0])
    matrix[:3, 3] = node.translation or [0.0, 0.0, 0.0]
    return matrix
