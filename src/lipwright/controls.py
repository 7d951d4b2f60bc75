"""The canonical face controls: ARKit's 52 blendshapes and three tongue controls.

Every engine speaks in these names; a rig maps them to what a character has. Left and right
are the character's own. Values run from 0 (rest) to 1.
"""

from __future__ import annotations

import unicodedata
from types import MappingProxyType
from typing import Final

# Apple, ARFaceAnchor.BlendShapeLocation; the order is that of Live Link Face recordings.
ARKIT: Final[tuple[str, ...]] = (
    "eyeBlinkLeft", "eyeLookDownLeft", "eyeLookInLeft", "eyeLookOutLeft", "eyeLookUpLeft",
    "eyeSquintLeft", "eyeWideLeft",
    "eyeBlinkRight", "eyeLookDownRight", "eyeLookInRight", "eyeLookOutRight", "eyeLookUpRight",
    "eyeSquintRight", "eyeWideRight",
    "jawForward", "jawRight", "jawLeft", "jawOpen",
    "mouthClose", "mouthFunnel", "mouthPucker", "mouthRight", "mouthLeft",
    "mouthSmileLeft", "mouthSmileRight", "mouthFrownLeft", "mouthFrownRight",
    "mouthDimpleLeft", "mouthDimpleRight", "mouthStretchLeft", "mouthStretchRight",
    "mouthRollLower", "mouthRollUpper", "mouthShrugLower", "mouthShrugUpper",
    "mouthPressLeft", "mouthPressRight", "mouthLowerDownLeft", "mouthLowerDownRight",
    "mouthUpperUpLeft", "mouthUpperUpRight",
    "browDownLeft", "browDownRight", "browInnerUp", "browOuterUpLeft", "browOuterUpRight",
    "cheekPuff", "cheekSquintLeft", "cheekSquintRight",
    "noseSneerLeft", "noseSneerRight",
    "tongueOut",
)  # fmt: skip

# ARKit knows only tongueOut; speech needs the tongue behind the teeth as well.
TONGUE: Final[tuple[str, ...]] = (
    "tongueRaise",  # the tip at the ridge behind the upper teeth: "t" in "tin", "l" in "lid"
    "tonguePress",  # the tip at the edges of the teeth: "th" in "thin"
    "tongueBack",  # the back of the tongue at the soft palate: "k" in "kit"
)

CANONICAL: Final[tuple[str, ...]] = ARKIT + TONGUE

# Not blendshapes: a clip may have them beside the canonical controls, in radians.
HEAD_ANGLES: Final[tuple[str, ...]] = (
    "headYaw",  # to the character's own left
    "headPitch",  # up
    "headRoll",  # the crown to the character's own right
)


def _mirrored(name: str) -> str:
    for side, other in (("Left", "Right"), ("Right", "Left")):
        if name.endswith(side):
            return name.removesuffix(side) + other
    return name


MIRROR: Final = MappingProxyType({name: _mirrored(name) for name in CANONICAL})
"""control to the control of the other side; a control of the middle mirrors to itself"""

GROUPS: Final = MappingProxyType(
    {
        "eyes": tuple(n for n in CANONICAL if n.startswith("eye")),
        "brows": tuple(n for n in CANONICAL if n.startswith("brow")),
        "cheeks": tuple(n for n in CANONICAL if n.startswith(("cheek", "noseSneer"))),
        "jaw": tuple(n for n in CANONICAL if n.startswith("jaw")),
        "lips": tuple(n for n in CANONICAL if n.startswith("mouth")),
        "tongue": tuple(n for n in CANONICAL if n.startswith("tongue")),
    }
)
"""part of the face to its controls; each control is in one group"""


def both_sides(name: str) -> tuple[str, ...]:
    """The canonical controls of a name that may lack its side, as `mouthSmile` does."""
    return (name,) if name in CANONICAL else (f"{name}Left", f"{name}Right")


NO_TEXT: Final = frozenset({"Cc", "Cs", "Zl", "Zp"})
"""Unicode's categories of what no name has: control characters, which a terminal would obey, half
letters of UTF-16, which no file can hold, and ends of lines"""


def is_text(name: str) -> bool:
    """Whether a name or line of others can be shown and written as it is."""
    return not any(unicodedata.category(letter) in NO_TEXT for letter in name)
