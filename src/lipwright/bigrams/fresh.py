"""What a new set starts with: classes, poses and constraints of Xu et al. 2013, and no pairs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Final

from lipwright.bigrams.fields import SetFile
from lipwright.bigrams.values import (
    OTHERWISE,
    SILENCE_REACH,
    SMOOTHING,
    SPEED_LIMIT,
    Pose,
)
from lipwright.phones import COMMON, PHONES, SILENCE

COMMON_CLASSES: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType({
    name: tuple(phone.symbol for phone in PHONES.values() if phone.common == name)
    for name in COMMON
})  # fmt: skip
"""the Common Phoneme Set: Xu et al. 2013, table 1"""

# Xu et al. 2013, section 2.2.2: of two poses the one of less priority gives way.
FACEFX_POSES: Final = MappingProxyType({
    "open": Pose("open", 0), "W": Pose("W", 1), "wide": Pose("wide", 2),
    "ShCh": Pose("ShCh", 3), "FV": Pose("FV", 4, "widen"), "PBM": Pose("PBM", 5, "widen"),
    "tBack": Pose("tBack", 0), "tRoof": Pose("tRoof", 0), "tTeeth": Pose("tTeeth", 0),
})  # fmt: skip
"""the poses of FaceFX; that closures are widened is ours"""
FACEFX_CONSTRAINTS: Final = MappingProxyType({
    ("open", "ShCh"): 0.5, ("open", "FV"): 0.5, ("open", "PBM"): 0.5,
})  # fmt: skip
"""C of section 2.2.2; that of all other pairs is OTHERWISE"""


def fresh_set(name: str, language: str, licence: str, rig: str, controls: Sequence[str]) -> SetFile:
    """A set without pairs, for any face.

    Args:
        name: of the set.
        language: ISO 639 code.
        licence: terms of use.
        rig: name of a rig, or its path from where the set will lie.
        controls: what the rig can move; each becomes a pose, those of FaceFX with the paper's
            priorities and constraints.
    """
    poses = {control: FACEFX_POSES.get(control, Pose(control)) for control in controls}
    return SetFile(
        name=name,
        language=language,
        licence=licence,
        source="drawn with Lipwright",
        rig=rig,
        smoothing=SMOOTHING,
        speed_limit=SPEED_LIMIT,
        silence=SILENCE_REACH,
        classes={**COMMON_CLASSES, SILENCE: (SILENCE,)},
        poses=poses,
        constraints={
            pair: most for pair, most in FACEFX_CONSTRAINTS.items() if set(pair) <= set(poses)
        },
        otherwise=OTHERWISE,
    )
