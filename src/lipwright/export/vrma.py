"""VRMA: a VRM animation, which any VRM 1.0 avatar plays: expressions and turns of the head.

A GLB with the extension `VRMC_vrm_animation` 1.0 (VRM Consortium, vrm-specification). A node stands
for each expression, and the x of its translation is the weight, from 0 to 1. Those of VRM 1.0's
presets are presets, all others custom. Where an avatar looks is not an expression there, so that
`lookUp`, `lookDown`, `lookLeft` and `lookRight` are left out, as are bones of a rig. The humanoid's
required bones stand in the T-pose; the head's rotation is that of the clip's head.

Players take the sound from elsewhere; none is written. Each expression has keys of its own: one a
frame, two where it never changes, or few, as cubic splines. Weights and times are
float32.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np

from lipwright.clip import Clip
from lipwright.controls import HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.export.bonemotion import without_bones
from lipwright.export.gltf_clip import VRMA, read_clip_gltf
from lipwright.export.gltf_curves import Animation, check_clock
from lipwright.export.gltf_store import Json, Store
from lipwright.export.performance import ExportOptions, Output, Performance
from lipwright.face.turning import head_quaternions, head_turns

PRESETS: Final = frozenset((
    "happy", "angry", "sad", "relaxed", "surprised", "aa", "ih", "ou", "ee", "oh", "blink",
    "blinkLeft", "blinkRight", "neutral",
))  # fmt: skip
GAZE: Final = frozenset(("lookUp", "lookDown", "lookLeft", "lookRight"))

# VRMC_vrm-1.0, humanoid.md: the bones that each humanoid has. Heights are those of an adult of
# 1.7 m; players scale them to the avatar's.
_BONES: Final[dict[str, tuple[str, tuple[float, float, float]]]] = {
    "hips": ("", (0.0, 0.95, 0.0)),
    "spine": ("hips", (0.0, 0.12, 0.0)),
    "neck": ("spine", (0.0, 0.42, 0.0)),
    "head": ("neck", (0.0, 0.08, 0.0)),
    "leftUpperArm": ("spine", (0.17, 0.36, 0.0)),
    "leftLowerArm": ("leftUpperArm", (0.27, 0.0, 0.0)),
    "leftHand": ("leftLowerArm", (0.25, 0.0, 0.0)),
    "rightUpperArm": ("spine", (-0.17, 0.36, 0.0)),
    "rightLowerArm": ("rightUpperArm", (-0.27, 0.0, 0.0)),
    "rightHand": ("rightLowerArm", (-0.25, 0.0, 0.0)),
    "leftUpperLeg": ("hips", (0.09, -0.06, 0.0)),
    "leftLowerLeg": ("leftUpperLeg", (0.0, -0.41, 0.0)),
    "leftFoot": ("leftLowerLeg", (0.0, -0.40, 0.0)),
    "rightUpperLeg": ("hips", (-0.09, -0.06, 0.0)),
    "rightLowerLeg": ("rightUpperLeg", (0.0, -0.41, 0.0)),
    "rightFoot": ("rightLowerLeg", (0.0, -0.40, 0.0)),
}
"""bone to the one above it and its place from there in m; +x is the character's own left"""


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: the clip has no expression.
    """
    clip = without_bones(performance)
    check_clock(path, clip)
    names = expression_names(clip)
    if not names or (performance.rig is None and not PRESETS & set(names)):
        raise LipwrightError(
            f"{path}: the curves have none of VRM's expressions (aa, ih, ou, ...); retarget them "
            "to the rig vrm1"
        )

    def write(part: Path) -> None:
        part.write_bytes(clip_to_vrma(clip, path.stem, options.keys))

    return [Output(path, write)]


def expression_names(clip: Clip) -> list[str]:
    """The clip's controls that are expressions of a VRM animation."""
    return [name for name in clip.names if name not in GAZE and name not in HEAD_ANGLES]


def clip_to_vrma(clip: Clip, name: str = "speech", keys: float | None = None) -> bytes:
    """The bytes of a VRMA file.

    Args:
        clip: weights of expressions by VRM 1.0's names, and angles of the head.
        name: of the animation.
        keys: as few keys as stay within this of every frame; None for one key a frame.
    """
    from importlib.metadata import version

    bones = list(_BONES)
    names = expression_names(clip)
    nodes = _bone_nodes() + [{"name": name} for name in names]
    places = {name: {"node": len(bones) + place} for place, name in enumerate(names)}
    expressions: dict[str, Any] = {}
    for name_, place in places.items():
        expressions.setdefault("preset" if name_ in PRESETS else "custom", {})[name_] = place
    store = Store({
        "asset": {
            "version": "2.0",
            "generator": f"Lipwright {version('lipwright')}",
            "extras": {"fps": clip.fps},
        },
        "extensionsUsed": [VRMA],
        "scene": 0,
        "scenes": [{"nodes": [0, *range(len(bones), len(nodes))]}],
        "nodes": nodes,
        "extensions": {
            VRMA: {
                "specVersion": "1.0",
                "humanoid": {
                    "humanBones": {bone: {"node": place} for place, bone in enumerate(bones)}
                },
                "expressions": expressions,
            }
        },
    })  # fmt: skip
    animation = Animation(store, name, clip.fps, keys)
    for expression in names:
        values = np.zeros((len(clip), 3), np.float32)
        values[:, 0] = clip.curve(expression).clip(0.0, 1.0)
        animation.animate(places[expression]["node"], "translation", values)
    turns = head_turns(clip)
    if turns is not None:
        animation.turn_head(bones.index("head"), head_quaternions(turns))
    return store.to_glb()


def _bone_nodes() -> list[Json]:
    bones = list(_BONES)
    nodes: list[Json] = [
        {"name": bone, "translation": list(place)} for bone, (_, place) in _BONES.items()
    ]
    for bone, (above, _) in _BONES.items():
        if above:
            nodes[bones.index(above)].setdefault("children", []).append(bones.index(bone))
    return nodes


read = read_clip_gltf
