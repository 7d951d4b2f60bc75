"""Small characters as glTF, VRM 1.0 and VRM 0.x, written without Lipwright; and a small mesh."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from lipwright.face.head import Head
from lipwright.face.mesh import Mesh, Part

Json = dict[str, Any]

# VRMC_vrm-1.0, humanoid.md: the required bones, and where a child is from its parent in m.
HUMANOID = {
    "hips": ("", (0, 1, 0)), "spine": ("hips", (0, 0.1, 0)), "head": ("spine", (0, 0.5, 0)),
    "leftUpperArm": ("spine", (0.2, 0.4, 0)), "leftLowerArm": ("leftUpperArm", (0.3, 0, 0)),
    "leftHand": ("leftLowerArm", (0.2, 0, 0)), "rightUpperArm": ("spine", (-0.2, 0.4, 0)),
    "rightLowerArm": ("rightUpperArm", (-0.3, 0, 0)), "rightHand": ("rightLowerArm", (-0.2, 0, 0)),
    "leftUpperLeg": ("hips", (0.1, 0, 0)), "leftLowerLeg": ("leftUpperLeg", (0, -0.5, 0)),
    "leftFoot": ("leftLowerLeg", (0, -0.4, 0)), "rightUpperLeg": ("hips", (-0.1, 0, 0)),
    "rightLowerLeg": ("rightUpperLeg", (0, -0.5, 0)),
    "rightFoot": ("rightLowerLeg", (0, -0.4, 0)),
}  # fmt: skip

LOOKS = ("HorizontalInner", "HorizontalOuter", "VerticalDown", "VerticalUp")
LOOK = {"curve": [0, 0, 0, 1, 1, 1, 1, 0], "xRange": 90, "yRange": 10}  # VRM 0.x's own default


def small_mesh(names: Sequence[str] = ("jawOpen", "mouthClose", "tongueOut")) -> Mesh:
    """A square of four vertices with blendshapes that each move a few of them."""
    rng = np.random.default_rng(len(names))
    moved = [np.flatnonzero(rng.random(4) < 0.6).astype(np.int32) for _ in names]
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32) / 10
    return Mesh(
        name="square", source="a test", license="CC0", shape_names=tuple(names),
        vertices=corners, triangles=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
        parts=(Part("skin", "skin", slice(0, 4), slice(0, 2)),),
        tints=np.ones((4, 3), np.float32), uvs=np.full((4, 2), 0.5, np.float32),
        texture=np.full((4, 4, 3), 200, np.uint8), welds=np.arange(4, dtype=np.int32),
        shape_starts=np.cumsum([0, *map(len, moved)]).astype(np.int32),
        shape_vertices=np.concatenate(moved),
        shape_deltas=rng.normal(size=(sum(map(len, moved)), 3)).astype(np.float32) / 100,
    )  # fmt: skip


def small_head(names: Sequence[str]) -> Head:
    """The square as a head that turns, in part."""
    mesh = small_mesh(names)
    values = {field.name: getattr(mesh, field.name) for field in fields(mesh)}
    return Head(**values, lip_pairs=np.zeros((3, 2), np.int32))


def to_glb(document: Json, data: bytes, rest: bytes = b"") -> bytes:
    """A GLB of a document whose buffer 0 is `data`; `rest` are other chunks."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    data += bytes(-len(data) % 4)
    size = 28 + len(text) + len(data) + len(rest)
    head = struct.pack("<4sIII4s", b"glTF", 2, size, len(text), b"JSON")
    return head + text + struct.pack("<I4s", len(data), b"BIN\0") + data + rest


def from_glb(content: bytes) -> tuple[Json, bytes]:
    """The document and the binary chunk of a GLB."""
    (size,) = struct.unpack_from("<I", content, 12)
    (length,) = struct.unpack_from("<I", content, 20 + size)
    return json.loads(content[20 : 20 + size]), content[28 + size : 28 + size + length]


def character(*meshes: Sequence[str], nodes: Sequence[Json] = ()) -> tuple[Json, bytes]:
    """A document with a mesh for each list of morph target names, and its data.

    The meshes' nodes come first; target n of each mesh moves its triangle by n + 1 cm along x.
    """
    data = bytearray(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32).tobytes())
    accessors: list[Json] = [
        {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
         "min": [0, 0, 0], "max": [1, 1, 0]},
    ]  # fmt: skip
    for place in range(max(map(len, meshes), default=0)):
        moved = np.tile(np.array([(place + 1) / 100, 0, 0], np.float32), (3, 1))
        bounds = moved[0].tolist()
        accessors.append(
            {"bufferView": len(accessors), "componentType": 5126, "count": 3, "type": "VEC3",
             "min": bounds, "max": bounds}
        )  # fmt: skip
        data += moved.tobytes()
    document: Json = {
        "asset": {"version": "2.0", "generator": "a test"},
        "scene": 0,
        "scenes": [{"nodes": _roots(len(meshes), nodes)}],
        "nodes": [{"name": f"mesh{n}", "mesh": n} for n in range(len(meshes))] + list(nodes),
        "accessors": accessors,
        "bufferViews": [
            {"buffer": 0, "byteOffset": 36 * n, "byteLength": 36} for n in range(len(accessors))
        ],
        "buffers": [{"byteLength": len(data)}],
    }
    if meshes:
        document["meshes"] = [_mesh(n, names) for n, names in enumerate(meshes)]
    return document, bytes(data)


def _mesh(number: int, names: Sequence[str]) -> Json:
    targets = [{"POSITION": place + 1} for place in range(len(names))]
    primitive: Json = {"attributes": {"POSITION": 0}} | ({"targets": targets} if names else {})
    extras: Json = {"extras": {"targetNames": list(names)}} if names else {}
    return {"name": f"shape{number}", "primitives": [primitive], **extras}


def _roots(first: int, nodes: Sequence[Json]) -> list[int]:
    below = {child for node in nodes for child in node.get("children", ())}
    return [n for n in range(first + len(nodes)) if n not in below]


def humanoid(first: int) -> list[Json]:
    """The nodes of the required bones, from number `first` on."""
    bones = list(HUMANOID)
    nodes: list[Json] = [
        {"name": f"J_{bone}", "translation": list(place)} for bone, (_, place) in HUMANOID.items()
    ]
    for place, (above, _) in enumerate(HUMANOID.values()):
        if above:
            nodes[bones.index(above)].setdefault("children", []).append(first + place)
    return nodes


def vrm1(expressions: dict[str, list[Json]], *meshes: Sequence[str], **custom: Any) -> bytes:
    """A VRM 1.0 whose preset expressions have these morph target binds."""
    first = len(meshes)
    document, data = character(*meshes, nodes=humanoid(first))
    bones = {bone: {"node": first + place} for place, bone in enumerate(HUMANOID)}
    document["extensionsUsed"] = ["VRMC_vrm"]
    document["extensions"] = {
        "VRMC_vrm": {
            "specVersion": "1.0",
            "meta": {
                "name": "Small", "authors": ["a test"], "licenseUrl": "https://vrm.dev/licenses/1.0/"
            },
            "humanoid": {"humanBones": bones},
            "expressions": {
                "preset": {name: {"morphTargetBinds": b} for name, b in expressions.items()},
                "custom": {name: {"morphTargetBinds": b} for name, b in custom.items()},
            },
        }
    }  # fmt: skip
    return to_glb(document, data)


def vrm0(groups: list[Json], *meshes: Sequence[str]) -> bytes:
    """A VRM 0.x with these blend shape groups."""
    first = len(meshes)
    document, data = character(*meshes, nodes=humanoid(first))
    bones = [{"bone": bone, "node": first + place} for place, bone in enumerate(HUMANOID)]
    document["extensionsUsed"] = ["VRM"]
    document["extensions"] = {
        "VRM": {
            "exporterVersion": "a test",
            "specVersion": "0.0",
            "meta": {"title": "Small", "version": "1", "author": "a test"},
            "humanoid": {"humanBones": bones},
            "firstPerson": {f"lookAt{axis}": LOOK for axis in LOOKS},
            "blendShapeMaster": {"blendShapeGroups": groups},
            "secondaryAnimation": {"boneGroups": [], "colliderGroups": []},
            "materialProperties": [],
        }
    }
    return to_glb(document, data)
