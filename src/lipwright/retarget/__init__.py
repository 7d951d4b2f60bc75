"""The same motion in another rig's controls."""

from __future__ import annotations

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.retarget.linear import apply_linear
from lipwright.rig import LinearMapping, Rig

__all__ = ["apply_linear", "retarget"]


def retarget(clip: Clip, rig: Rig) -> Clip:
    """A canonical clip in a rig's controls.

    Turns of the head go along as they are, unless the rig has controls of that name.

    Args:
        clip: canonical curves, or modes of a reference face where the rig's mapping is by poses.
        rig: what to move.

    Raises:
        LipwrightError: the rig does not say how it follows canonical controls, or the clip moves
            none of them.
    """
    if not set(clip.names) & set(CANONICAL):
        raise LipwrightError(
            f"curves of {', '.join(clip.names[:3])}... cannot move the rig {rig.name!r}; retarget "
            "canonical ones, such as jawOpen"
        )
    if isinstance(rig.mapping, LinearMapping):
        moved = apply_linear(clip, rig, rig.mapping)
    elif rig.mapping is None and set(rig.names) & set(CANONICAL):
        moved = rig.fit(clip)
    else:
        raise LipwrightError(
            f"the rig {rig.name!r} does not say how it follows speech; run: lipwright rigs fit"
        )
    return _with_head(moved, clip)


def _with_head(moved: Clip, clip: Clip) -> Clip:
    """`moved`, and beside it the turns of the head of `clip` that it lacks."""
    turns = [name for name in HEAD_ANGLES if name in clip.names and name not in moved.names]
    if not turns:
        return moved
    both = moved.select((*moved.names, *turns))
    return both.with_curves({name: clip.curve(name) for name in turns})
