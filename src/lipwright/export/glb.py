"""GLB: the head, or another character, with its blendshapes as morph targets, animated.

The sound is `NAME.wav`. With `options.onto`, another's GLB or VRM is animated instead: see `onto`.

Morph targets are sparse accessors: most blendshapes move a small part of the mesh. The names
stand in the mesh's `extras.targetNames`, where Blender, three.js and Unreal look for them. Weights
are float32, with one key a frame, or few; see `gltf_curves`. Where the clip turns the head, our
head is skinned to two joints: `Head` turns, `Neck` stays with the shirt. Other characters have no
joint and do not turn.

What is read is the last animation that Lipwright wrote, or else the first that moves morph targets
or bones; see `gltf_clip`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.export.gltf_curves import Animation, check_clock
from lipwright.export.gltf_store import INDICES, VERTICES, Json, Store
from lipwright.export.performance import (
    ExportOptions,
    Output,
    PathLike,
    Performance,
    shown_character,
)
from lipwright.export.sidecar import sound_outputs
from lipwright.face.head import Head
from lipwright.face.neck import turn_shares
from lipwright.face.png import encode_png
from lipwright.face.turning import head_quaternions, head_turns

if TYPE_CHECKING:
    from lipwright.face.mesh import Mesh, Part
    from lipwright.rig import Rig

NECK_JOINT: Final = 1  # nodes, after that of the mesh
HEAD_JOINT: Final = 2
TURNS: Final = 1e-3  # smaller changes of a unit normal are not seen and not stored


def prepare() -> None:
    """Find out before long work whether the head is there."""
    from lipwright.face.head import load_head

    load_head()


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The GLB, and the sound beside it.

    Raises:
        LipwrightError: no head is installed, the clip moves none of the character, or the
            character's file cannot be used.
    """
    clip = performance.clip
    check_clock(path, clip)
    wav = path.with_suffix(".wav").name if performance.audio is not None else None
    if options.onto is not None:
        from lipwright.export.onto import animated

        make = animated(path, performance, options, wav)
        return [Output(path, lambda part: _write(part, make())), *sound_outputs(path, performance)]
    sound, rig = sound_outputs(path, performance), performance.rig
    if rig is not None and rig.bones and options.character is None:
        return [Output(path, _on_bones(path, clip, rig, wav, options.keys)), *sound]
    mesh = shown_character(path, clip, options)

    def write(part: Path) -> None:
        _write(part, mesh_to_glb(mesh, clip, name=path.stem, sound=wav, keys=options.keys))

    return [Output(path, write), *sound]


def _on_bones(
    path: Path, clip: Clip, rig: Rig, sound: str | None, keys: float | None
) -> Callable[[Path], None]:
    """Writes our head on the bones of a rig."""
    from lipwright.export.skinned import skinned_glb
    from lipwright.face.head import load_head
    from lipwright.retarget.skinned import skin_mesh

    head = load_head()
    try:
        skinned = skin_mesh(head, rig)
    except LipwrightError as error:
        reason = str(error).partition(";")[0]
        raise LipwrightError(
            f"{path}: {reason}; name the character that has them with --onto character.glb"
        ) from error

    def write(part: Path) -> None:
        content = skinned_glb(skinned, rig, clip, name=path.stem, sound=sound, keys=keys)
        _write(part, content)

    return write


def _write(part: Path, content: bytes) -> None:
    part.write_bytes(content)


def mesh_to_glb(
    mesh: Mesh,
    clip: Clip,
    *,
    name: str = "speech",
    sound: str | None = None,
    keys: float | None = None,
) -> bytes:
    """The bytes of a GLB file.

    Args:
        mesh: the head, or another character.
        clip: curves. Controls that the mesh lacks are left out.
        name: of the animation.
        sound: the file of the sound, named in the asset's `extras`.
        keys: as few keys as stay within this of every frame; None for one key a frame.
    """
    store = Store()
    document = store.document
    document |= {"asset": asset_of(mesh, clip.fps, sound), "scene": 0}
    document["scenes"] = [{"nodes": [0], "name": "scene"}]
    document["nodes"] = [{"mesh": 0, "name": mesh.name}]
    turns = head_turns(clip)
    if turns is not None and isinstance(mesh, Head):
        _add_joints(store)
    add_looks(store, mesh)
    turned = _turned_normals(mesh)
    document["meshes"] = [
        {
            "name": mesh.name,
            "primitives": [
                _primitive(store, mesh, part, index, turned)
                for index, part in enumerate(mesh.parts)
            ],
            "weights": [0.0] * len(mesh.shape_names),
            "extras": {"targetNames": list(mesh.shape_names)},
        }
    ]
    animation = Animation(store, name, clip.fps, keys)
    animation.animate(0, "weights", clip.select(mesh.shape_names).values)
    if turns is not None and isinstance(mesh, Head):
        _bind(store, mesh)
        animation.turn_head(HEAD_JOINT, head_quaternions(turns))
    return store.to_glb()


def _add_joints(store: Store) -> None:
    """The nodes of the joints, both where head and neck meet, and the skin."""
    nodes = store.document["nodes"]
    nodes[0]["skin"] = 0
    nodes += [{"name": "Neck", "children": [HEAD_JOINT]}, {"name": "Head"}]
    store.document["scenes"][0]["nodes"] = [0, NECK_JOINT]
    still = np.tile(np.eye(4, dtype=np.float32).ravel(), (2, 1))
    store.document["skins"] = [
        {
            "joints": [NECK_JOINT, HEAD_JOINT],
            "skeleton": NECK_JOINT,
            "inverseBindMatrices": store.accessor(still, "MAT4"),
        }
    ]


def _bind(store: Store, head: Head) -> None:
    """How far each vertex follows which joint."""
    shares = turn_shares(head)
    weights = np.stack([1 - shares, shares, 0 * shares, 0 * shares], axis=1)
    primitives = store.document["meshes"][0]["primitives"]
    for primitive, part in zip(primitives, head.parts, strict=True):
        own = weights[part.vertices]
        joints = np.tile(np.array([0, 1, 0, 0], np.uint8), (len(own), 1)) * (own > 0)
        primitive["attributes"] |= {
            "JOINTS_0": store.accessor(joints.astype(np.uint8), "VEC4", VERTICES),
            "WEIGHTS_0": store.accessor(own, "VEC4", VERTICES),
        }


def asset_of(mesh: Mesh, fps: float, sound: str | None = None) -> Json:
    """The document's `asset`: who made the mesh, on which terms, and with what sound it goes."""
    from importlib.metadata import version

    own = version("lipwright")
    extras = {
        "lipwright": own,
        mesh.name: f"{mesh.source}, {mesh.license}",
        "fps": fps,
    }
    if sound is not None:
        extras["sound"] = sound
    return {
        "version": "2.0",
        "generator": f"Lipwright {own}",
        "copyright": f"{mesh.name.capitalize()}: {mesh.license}",
        "extras": extras,
    }


def add_looks(store: Store, mesh: Mesh) -> None:
    """Add the texture of a mesh, and a material for each of its parts."""
    document = store.document
    image = store.view(encode_png(mesh.texture))
    document["materials"] = [_material(part) for part in mesh.parts]
    document["textures"] = [{"sampler": 0, "source": 0}]
    document["samplers"] = [{"magFilter": 9729, "minFilter": 9987, "wrapS": 33071, "wrapT": 33071}]
    document["images"] = [{"bufferView": image, "mimeType": "image/png", "name": "skin"}]


def _material(part: Part) -> Json:
    material = part.material
    return {
        "name": part.name,
        "doubleSided": material.double_sided,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*material.base_color, 1.0],
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
            "baseColorTexture": {"index": 0},
        },
    }


def _turned_normals(mesh: Mesh) -> Sequence[npt.NDArray[np.float32]]:
    """For each blendshape, how it changes the normals: (V, 3)."""
    weights = np.eye(len(mesh.shape_names), dtype=np.float32)
    return [mesh.normals(mesh.pose(row)) - mesh.rest_normals for row in weights]


def _primitive(
    store: Store, mesh: Mesh, part: Part, index: int, turned: Sequence[npt.NDArray[np.float32]]
) -> Json:
    """One part of the mesh with all blendshapes; glTF asks for the same number in each part."""
    run = part.vertices
    count = run.stop - run.start
    targets = []
    for name, turn in zip(mesh.shape_names, turned, strict=True):
        vertices, deltas = mesh.shape(name)
        inside = (vertices >= run.start) & (vertices < run.stop)
        own = turn[run]
        turning = np.flatnonzero(np.abs(own).max(axis=1) > TURNS)
        targets.append(
            {
                "POSITION": store.sparse(vertices[inside] - run.start, deltas[inside], count),
                "NORMAL": store.sparse(turning, own[turning], count),
            }
        )
    return {**primitive_at_rest(store, mesh, part, index), "targets": targets}


def primitive_at_rest(store: Store, mesh: Mesh, part: Part, index: int) -> Json:
    """One part of the mesh without its blendshapes, in the material of that index."""
    run = part.vertices
    triangles = (mesh.triangles[part.triangles] - run.start).astype(np.uint32)
    return {
        "attributes": {
            "POSITION": store.accessor(mesh.vertices[run], "VEC3", VERTICES, bounds=True),
            "NORMAL": store.accessor(mesh.rest_normals[run], "VEC3", VERTICES),
            "TEXCOORD_0": store.accessor(mesh.uvs[run], "VEC2", VERTICES),
            "COLOR_0": store.accessor(mesh.tints[run], "VEC3", VERTICES),
        },
        "indices": store.accessor(triangles.ravel(), "SCALAR", INDICES),
        "material": index,
    }


def read(path: PathLike) -> Clip:
    """The clip of a GLB; see `gltf_clip`."""
    from lipwright.export.gltf_clip import read_clip_gltf

    return read_clip_gltf(path)
