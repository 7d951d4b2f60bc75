"""A skinned mesh as GLB: joints, skin, and the motion of the joints.

glTF 2.0 (ISO/IEC 12113:2022), sections 3.7.3 and 3.11: a bone is a node that is not turned at rest,
called as in the rig; `JOINTS_0` and `WEIGHTS_0` hold up to four bones a vertex, and nothing else
moves the mesh. A joint that moves has a translation in m and a rotation as a quaternion, one key a
frame, or few keys as cubic splines; see `gltf_curves`. Numbers are float32.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.export.glb import add_looks, asset_of, primitive_at_rest
from lipwright.export.gltf_curves import Animation, continuous
from lipwright.export.gltf_store import UINT16, VERTICES, Json, Store
from lipwright.face.mesh import Part
from lipwright.face.skeleton import Floats, Skeleton
from lipwright.face.skinning import MOST_BONES, SkinnedMesh
from lipwright.retarget.skinned import bone_channels, whole_turns
from lipwright.rig import Rig

# An error in control units is a share of what a blendshape at 1 does to a bone, about as much as:
KEY_M: Final = 0.01  # m
KEY_RADIANS: Final = float(np.radians(10.0))

MESH_NODE: Final = 0
FIRST_BONE: Final = 2  # after the nodes of the mesh and of what holds the bones


def skinned_glb(
    skinned: SkinnedMesh,
    rig: Rig | None = None,
    clip: Clip | None = None,
    *,
    name: str = "speech",
    sound: str | None = None,
    keys: float | None = None,
) -> bytes:
    """The bytes of a GLB file.

    Args:
        skinned: the mesh with its bones.
        rig: the rig of these bones, where there is a clip.
        clip: curves in the rig's controls; turns of the head turn the bone `head`. Without a clip
            nothing moves.
        name: of the animation.
        sound: the file of the sound, named in the asset's `extras`.
        keys: as few keys as keep the bones within this share of 10 mm and of 10 degrees at every
            frame; None for one key a frame.
    """
    store = Store()
    mesh, skeleton = skinned.mesh, skinned.skeleton
    fps = 0.0 if clip is None else clip.fps
    store.document |= {"asset": asset_of(mesh, fps, sound), "scene": 0}
    store.document["scenes"] = [{"nodes": [MESH_NODE, MESH_NODE + 1], "name": "scene"}]
    store.document["nodes"] = _nodes(mesh.name, skeleton)
    add_looks(store, mesh)
    primitives = [_primitive(store, skinned, part, index) for index, part in enumerate(mesh.parts)]
    store.document["meshes"] = [{"name": mesh.name, "primitives": primitives}]
    store.document["skins"] = [_skin(store, skeleton)]
    if clip is not None and rig is not None:
        animation = Animation(store, name, clip.fps, keys)
        _animate(animation, skeleton, bone_channels(clip, rig), whole_turns(clip))
    return store.to_glb()


def _nodes(name: str, skeleton: Skeleton) -> list[Json]:
    """The mesh, what holds the bones, and the bones as a tree."""
    bones: list[Json] = [
        {"name": bone, "translation": offset.tolist()}
        for bone, offset in zip(skeleton.names, skeleton.offsets, strict=True)
    ]
    holder: Json = {"name": f"{name}_bones"}
    for bone, parent in enumerate(skeleton.parents):
        above = holder if parent < 0 else bones[parent]
        above.setdefault("children", []).append(FIRST_BONE + bone)
    # A bone may be called like the mesh, and readers rename the second of two nodes.
    return [{"mesh": 0, "skin": 0, "name": f"{name}_mesh"}, holder, *bones]


def _skin(store: Store, skeleton: Skeleton) -> Json:
    """The joints, and what brings each one's place to the origin, column by column."""
    inverse = np.tile(np.eye(4, dtype=np.float32), (len(skeleton), 1, 1))
    inverse[:, 3, :3] = -skeleton.at
    return {
        "joints": [FIRST_BONE + bone for bone in range(len(skeleton))],
        "skeleton": MESH_NODE + 1,
        "inverseBindMatrices": store.accessor(inverse.reshape(len(skeleton), 16), "MAT4"),
    }


def _primitive(store: Store, skinned: SkinnedMesh, part: Part, index: int) -> Json:
    primitive = primitive_at_rest(store, skinned.mesh, part, index)
    joints, weights = most_held(skinned.weights[part.vertices])
    stored = np.ascontiguousarray(joints, np.uint16)
    held = {
        "bufferView": store.view(stored.tobytes(), VERTICES),
        "componentType": UINT16,
        "count": len(stored),
        "type": "VEC4",
    }
    primitive["attributes"] |= {
        "JOINTS_0": store.add("accessors", held),
        "WEIGHTS_0": store.accessor(weights, "VEC4", VERTICES),
    }
    return primitive


def most_held(weights: Floats) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.float32]]:
    """The bones (V, 4) that hold each vertex, the most first, and their weights (V, 4).

    Bones of no weight are 0, as glTF asks.
    """
    padded = np.pad(weights, ((0, 0), (0, max(MOST_BONES - weights.shape[1], 0))))
    joints = np.argsort(-padded, axis=1, kind="stable")[:, :MOST_BONES]
    shares = np.take_along_axis(padded, joints, axis=1)
    return np.where(shares > 0, joints, 0), (shares / shares.sum(axis=1, keepdims=True)).astype(
        np.float32
    )


def _animate(
    animation: Animation, skeleton: Skeleton, channels: Floats, turns: Floats | None
) -> None:
    """Move the joints by channels (T, B, 6); bones that stay at rest have no curves."""
    from scipy.spatial.transform import Rotation

    rotations, places = skeleton.joints(channels, turns)
    keys = animation.keys
    for bone in range(len(skeleton)):
        node = FIRST_BONE + bone
        quaternions = continuous(Rotation.from_matrix(rotations[:, bone]).as_quat())
        animation.keys = keys and keys * KEY_RADIANS
        if turns is not None and bone in skeleton.turning:
            animation.turn_head(node, quaternions)
        elif channels[:, bone, 3:].any():
            animation.animate(node, "rotation", quaternions)
        animation.keys = keys and keys * KEY_M
        if channels[:, bone, :3].any():
            animation.animate(node, "translation", places[:, bone])
    animation.keys = keys
