"""Performances in the controls of another rig."""

from __future__ import annotations

from dataclasses import replace

from lipwright.export.performance import Performance
from lipwright.rig import Rig


def as_seen(performance: Performance) -> Performance:
    """The performance in canonical controls where its rig says how it looks; else as it is."""
    own = performance.rig
    if own is None or not own.looks:
        return performance
    return replace(performance, clip=own.to_canonical(performance.clip), rig=None)


def for_rig(performance: Performance, rig: Rig | None) -> Performance:
    """The performance in the controls of a rig; as it is without one.

    Curves of another rig go by what that looks like on a human face.

    Raises:
        LipwrightError: the curves cannot move the rig.
    """
    own = performance.rig
    if rig is None or (own is not None and own.name == rig.name):
        return performance
    from lipwright.retarget import retarget

    seen = as_seen(performance)
    return replace(seen, clip=retarget(seen.clip, rig, seen.track), rig=rig)
