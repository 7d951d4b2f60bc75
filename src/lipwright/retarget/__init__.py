"""The same motion in another rig's controls."""

from __future__ import annotations

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.retarget.linear import apply_linear
from lipwright.retarget.poses import apply_poses, modes_to_canonical
from lipwright.retarget.shapes import choose_shapes, shape_curves
from lipwright.rig import LinearMapping, PoseMapping, Rig
from lipwright.track import PhoneTrack

__all__ = ["apply_linear", "apply_poses", "choose_shapes", "is_retargetable", "retarget"]

_MODE = "shape1"  # what a clip of modes of a reference face begins with


def is_retargetable(clip: Clip) -> bool:
    """Whether a clip has canonical controls, or shape modes of a reference face."""
    return bool(set(clip.names) & set(CANONICAL)) or _MODE in clip.names


def retarget(clip: Clip, rig: Rig, track: PhoneTrack | None = None) -> Clip:
    """A canonical clip in a rig's controls.

    Turns of the head go along as they are, unless the rig has controls of that name.

    Args:
        clip: canonical curves, or shape modes of a reference face (`shape1` and on).
        rig: what to move: by its mapping, or, where its controls are drawings, one at a time.
        track: the phones, which tell drawings where lips must meet.

    Raises:
        LipwrightError: the rig does not say how it follows canonical controls, or the clip moves
            none of them.
    """
    if not is_retargetable(clip):
        raise LipwrightError(
            f"curves of {', '.join(clip.names[:3])}... cannot move the rig {rig.name!r}; retarget "
            "canonical ones, such as jawOpen"
        )
    return _with_head(_moved(clip, rig, track), clip)


def _moved(clip: Clip, rig: Rig, track: PhoneTrack | None) -> Clip:
    if isinstance(rig.mapping, PoseMapping):
        return apply_poses(clip, rig, rig.mapping)
    canonical = clip if set(clip.names) & set(CANONICAL) else modes_to_canonical(clip)
    if rig.discrete and rig.looks:
        shown = choose_shapes(canonical, rig, track)
        return shape_curves(shown, rig, clip.fps, len(clip))
    if isinstance(rig.mapping, LinearMapping):
        return apply_linear(canonical, rig, rig.mapping)
    if set(rig.names) & set(CANONICAL):
        return rig.fit(canonical)
    raise LipwrightError(
        f"the rig {rig.name!r} does not say how it follows speech; run: lipwright rigs fit"
    )


def _with_head(moved: Clip, clip: Clip) -> Clip:
    """`moved`, and beside it the turns of the head of `clip` that it lacks."""
    turns = [name for name in HEAD_ANGLES if name in clip.names and name not in moved.names]
    if not turns:
        return moved
    both = moved.select((*moved.names, *turns))
    return both.with_curves({name: clip.curve(name) for name in turns})
