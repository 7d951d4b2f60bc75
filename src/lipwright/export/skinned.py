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
from lipwright.face.skeleton import Floats, Skeleton
from lipwright.face.skinning import MOST_BONES, SkinnedMesh
from lipwright.retarget.skinned import bone_channels, whole_turns
from lipwright.rig import Rig

# An error in control units is a share of what a blendshape at 1 does to a bone, about as much as:
KEY_M: Final = 0.02  # m
KEY_RADIANS: Final = float(np.radians(20.0))

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
        keys: as few keys as keep the bones within this share of 20 mm and of 20 degrees at every
            frame; None for one key a frame.
    """
    store = Store()
    mesh, skeleton = skinned.mesh, skinned.skeleton
    fps = 0.0 if clip is None else clip.fps
    store.document |= {"asset": asset_of(mesh, fps, sound), "scene": 0}
    store.document["scenes"] = [{"nodes": [MESH_NODE, MESH_NODE + 1], "name": "scene"}]
    # A bone may be called like the mesh, and readers rename the second of two nodes.
    shown = {"mesh": 0, "skin": 0, "name": f"{mesh.name}_mesh"}
    bones = bone_nodes(f"{mesh.name}_bones", skeleton, FIRST_BONE)
    store.document["nodes"] = [shown, *bones]
    add_looks(store, mesh)
    primitives = [primitive_at_rest(store, mesh, part, i) for i, part in enumerate(mesh.parts)]
    for primitive, part in zip(primitives, mesh.parts, strict=True):
        primitive["attributes"] |= skin_attributes(store, skinned.weights[part.vertices])
    store.document["meshes"] = [{"name": mesh.name, "primitives": primitives}]
    add_skin(store, skeleton, FIRST_BONE)
    if clip is not None and rig is not None:
        animation = Animation(store, name, clip.fps, keys)
        _animate(animation, skeleton, bone_channels(clip, rig), whole_turns(clip))
    return store.to_glb()


def bone_nodes(name: str, skeleton: Skeleton, first: int) -> list[Json]:
    """What holds the bones, called `name`, and the bones as a tree: nodes from `first`."""
    bones: list[Json] = [
        {"name": bone, "translation": offset.tolist()}
        for bone, offset in zip(skeleton.names, skeleton.offsets, strict=True)
    ]
    holder: Json = {"name": name}
    for bone, parent in enumerate(skeleton.parents):
        above = holder if parent < 0 else bones[parent]
        above.setdefault("children", []).append(first + bone)
    return [holder, *bones]


def add_skin(store: Store, skeleton: Skeleton, first: int, axes: Floats | None = None) -> int:
    """Add the skin of bones that are nodes from `first`; its index.

    Args:
        store: where to.
        skeleton: the bones.
        first: node of the first one.
        axes: (4, 4), from the axes of the mesh to those in which the bones are.
    """
    inverse = np.tile(np.eye(4), (len(skeleton), 1, 1))
    inverse[:, :3, 3] = -skeleton.at
    if axes is not None:
        inverse = inverse @ axes
    columns = np.swapaxes(inverse, 1, 2).reshape(len(skeleton), 16).astype(np.float32)
    skin = {
        "joints": [first + bone for bone in range(len(skeleton))],
        "inverseBindMatrices": store.accessor(columns, "MAT4"),
    }
    return store.add("skins", skin)


def skin_attributes(store: Store, weights: Floats) -> Json:
    """Add the skin weights (V, B) of a primitive; its attributes."""
    joints, shares = most_held(weights)
    stored = np.ascontiguousarray(joints, np.uint16)
    held = {
        "bufferView": store.view(stored.tobytes(), VERTICES),
        "componentType": UINT16,
        "count": len(stored),
        "type": "VEC4",
    }
    return {
        "JOINTS_0": store.add("accessors", held),
        "WEIGHTS_0": store.accessor(shares, "VEC4", VERTICES),
    }


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
