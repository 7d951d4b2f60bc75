"""The passes of phone bigrams, over clips of poses (Xu et al. 2013, section 2.2)."""

from __future__ import annotations

import numpy as np

from lipwright.bigrams.steps import constrained, without_valleys
from lipwright.bigrams.values import BigramSet, Pose
from lipwright.clip import Clip
from lipwright.passes.kinds import Pass
from lipwright.passes.shaping import speed_limit
from lipwright.track import PhoneTrack


def remove_valleys(smoothing: float) -> Pass:
    """Join maxima of a curve that are at most 2 `smoothing` s apart (section 2.2.1)."""

    def fill(clip: Clip, track: PhoneTrack) -> Clip:
        del track
        window = 2 * smoothing * clip.fps
        values = clip.values.astype(np.float64)
        for column in np.flatnonzero(np.ptp(values, axis=0) > 0):
            values[:, column] = without_valleys(values[:, column], window)
        return clip.with_values(values)

    return fill


def constrain(bigrams: BigramSet) -> Pass:
    """Let no two poses exceed what the set allows them together (section 2.2.2).

    Curves that are no poses of the set stay as they are.
    """

    def give_way(clip: Clip, track: PhoneTrack) -> Clip:
        del track
        poses = [bigrams.poses.get(name, Pose(name)) for name in clip.names]
        known = [column for column, pose in enumerate(poses) if pose.name in bigrams.poses]
        values = clip.values.astype(np.float64)
        values[:, known] = constrained(
            values[:, known], [poses[c] for c in known], bigrams.constraints, bigrams.otherwise
        )
        return clip.with_values(values)

    return give_way


def limit_poses(bigrams: BigramSet) -> Pass:
    """The set's speed limit (section 2.2.3); closures are widened, other peaks lowered."""
    closers = [pose.name for pose in bigrams.poses.values() if pose.limit == "widen"]
    return speed_limit(bigrams.speed_limit, closers)


def bigram_passes(bigrams: BigramSet) -> list[Pass]:
    """What section 2.2 does to stitched curves, in its order."""
    return [remove_valleys(bigrams.smoothing), constrain(bigrams), limit_poses(bigrams)]
