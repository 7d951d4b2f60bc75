"""What a character lets us move: `Rig`, its mapping from canonical controls, and its file."""

from __future__ import annotations

from lipwright.rig.file import RIGS, canonical_rig, load_rig, read_rig, rig_to_text, save_rig
from lipwright.rig.mapping import (
    MODES,
    SIGMA,
    Corrective,
    LinearMapping,
    Mapped,
    PoseMapping,
    RigPose,
    Row,
)
from lipwright.rig.values import CHANNELS, Bone, Control, Rig

__all__ = [
    "CHANNELS", "MODES", "RIGS", "SIGMA", "Bone", "Control", "Corrective", "LinearMapping",
    "Mapped", "PoseMapping", "Rig", "RigPose", "Row", "canonical_rig", "load_rig", "read_rig",
    "rig_to_text", "save_rig",
]  # fmt: skip
