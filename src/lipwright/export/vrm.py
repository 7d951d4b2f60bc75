"""What the VRM extensions of a glTF file say: expressions, and which bone is the head.

VRM 1.0 (`VRMC_vrm`): an expression's `morphTargetBinds` name a node, a morph target and a weight up
to 1. VRM 0.x (`VRM`): a blend shape group's `binds` name a mesh, a morph target and a weight up to
100. Colours and textures that an expression also changes are not animated: glTF cannot.
Published by the VRM Consortium: vrm-specification, VRMC_vrm-1.0 and 0.0.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from lipwright.export.gltf_file import GltfFile, is_number
from lipwright.export.gltf_store import Json

VRM1: Final = "VRMC_vrm"
VRM0: Final = "VRM"
FULL_VRM0: Final = 100.0  # the weight of a bind that is on in full


@dataclass(frozen=True)
class Bind:
    """What a name moves: one morph target of a mesh that a node shows."""

    node: int
    target: int
    share: float = 1.0
    """the target's weight where the name's is 1"""
    binary: bool = False
    """on or off: above a half it is 1"""


def faces_back(file: GltfFile) -> bool:
    """Whether the character looks along -Z, as those of VRM 0.x do, rather than along +Z."""
    extensions = file.table("extensions")
    return VRM0 in extensions and VRM1 not in extensions


def expressions(file: GltfFile) -> Iterator[tuple[str, tuple[Bind, ...]]]:
    """Each expression's name, or names, and what it moves."""
    extensions = file.table("extensions")
    if VRM1 in extensions:
        yield from _expressions_1(file, file.table(VRM1, extensions))
    elif VRM0 in extensions:
        yield from _expressions_0(file, file.table(VRM0, extensions))


def head_bone(file: GltfFile) -> int | None:
    """The node of the humanoid's head; None where no extension says so."""
    extensions, where = file.table("extensions"), "the humanoid's head"
    count = len(file.tables("nodes"))
    if VRM1 in extensions:
        bones = file.table("humanBones", file.table("humanoid", file.table(VRM1, extensions)))
        return file.index(file.table("head", bones), "node", count, where) if bones else None
    humanoid = file.table("humanoid", file.table(VRM0, extensions))
    for bone in file.tables("humanBones", humanoid, "the humanoid's "):
        if bone.get("bone") == "head":
            return file.index(bone, "node", count, where)
    return None


def _expressions_1(file: GltfFile, vrm: Json) -> Iterator[tuple[str, tuple[Bind, ...]]]:
    nodes = len(file.tables("nodes"))
    both = file.table("expressions", vrm)
    for name, body in {**file.table("custom", both), **file.table("preset", both)}.items():
        if not isinstance(body, dict):
            file.fail(f"the expression {name[:40]!r} is no object")
        where, binary = f"the expression {name[:40]!r}", body.get("isBinary") is True
        yield (
            name,
            tuple(
                Bind(
                    file.index(bind, "node", nodes, where),
                    file.whole(bind, "index", where),
                    _share(file, bind, where, 1.0),
                    binary,
                )
                for bind in file.tables("morphTargetBinds", body, f"{where}: ")
            ),
        )


def _expressions_0(file: GltfFile, vrm: Json) -> Iterator[tuple[str, tuple[Bind, ...]]]:
    meshes = len(file.tables("meshes"))
    shown = nodes_of_meshes(file)
    groups = file.tables("blendShapeGroups", file.table("blendShapeMaster", vrm), "VRM: ")
    for body in groups:
        name, preset = file.name(body), body.get("presetName")
        where, binary = f"the blend shape group {name[:40]!r}", body.get("isBinary") is True
        found = tuple(
            Bind(
                node,
                file.whole(bind, "index", where),
                _share(file, bind, where, FULL_VRM0),
                binary,
            )
            for bind in file.tables("binds", body, f"{where}: ")
            for node in shown.get(file.index(bind, "mesh", meshes, where), [])
        )
        for known in dict.fromkeys((name, preset if isinstance(preset, str) else "")):
            if known not in {"", "unknown"}:
                yield known, found


def _share(file: GltfFile, bind: Json, where: str, full: float) -> float:
    weight = bind.get("weight", full)
    if not is_number(weight):
        file.fail(f"{where}: the weight {str(weight)[:24]!r} is no number")
    return float(weight) / full


def nodes_of_meshes(file: GltfFile) -> dict[int, list[int]]:
    """Each mesh that a node shows, and those nodes."""
    meshes = len(file.tables("meshes"))
    shown: dict[int, list[int]] = {}
    for number, node in enumerate(file.tables("nodes")):
        if "mesh" in node:
            shown.setdefault(file.index(node, "mesh", meshes, f"node {number}"), []).append(number)
    return shown
