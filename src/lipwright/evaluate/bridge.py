"""From the weights of blendshapes to the joint modes of a reference face.

Engines that only move heads (rules, peers, models taught weights) have no modes of the recorded
speaker, and so no errors in parameters, vertices and pixels. The bridge is the affine map from the
speaker's own solved weights to his own modes, learnt on the recordings for training. What it cannot
know (what the weights leave open) is its error on real weights, the floor of all that come over it;
such entries are compared with that floor and with each other, not with those that learnt modes.

The map is affine on purpose. It commutes with the mean, so that an engine that predicts the mean of
the weights gets the mean of the modes; and it continues in straight lines where weights are larger
than the speaker's. Squares of the weights take 1.2 % off the error on captured weights of GRID's
speaker 1, and products 0.8 %, but squares add 6 to 64 % to that of engines, whose weights are
elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import GROUPS

Floats = npt.NDArray[np.float64]

SPOKEN: Final = frozenset(name for group in ("cheeks", "jaw", "lips", "tongue")
                          for name in GROUPS[group])  # fmt: skip
"""Controls of the lower face, of which modes are predicted. Brows and eyes tell them too (1 % less
error), by the day and the head's pose, but no speech engine moves them as the speaker did."""

PENALTIES: Final = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 10.0)
"""of ridge regression, over the variance of a weight"""
FOLDS: Final = 5  # of the cross-validation over recordings
UNTRIED: Final = 1e-2  # the penalty where there is one recording only
MOVES: Final = 1e-3  # of a full range; less standard deviation is a control at rest


@dataclass(frozen=True, eq=False)
class Bridge:
    """The map; made by `fit_bridge`.

    Raises:
        ValueError: shapes do not match the names, or a number is not finite.
    """

    controls: tuple[str, ...]
    """C, that it reads"""
    modes: tuple[str, ...]
    """M: `joint1` and on"""
    weights: Floats
    """(C, M) standard deviations of a mode for a full weight"""
    bias: Floats
    """(M,) the modes of a face at rest, standard deviations"""
    penalty: float
    """what the cross-validation chose"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        for name, shape in (
            ("weights", (len(self.controls), len(self.modes))), ("bias", (len(self.modes),))
        ):  # fmt: skip
            array = np.array(getattr(self, name), np.float64)
            if array.shape != shape or not np.isfinite(array).all():
                raise ValueError(f"{name} are {array.shape}, not {shape} finite numbers")
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    def apply(self, clip: Clip) -> Clip:
        """The modes of a clip's weights, frame by frame.

        Controls that the clip lacks are at rest; others than the bridge's count for nothing. The
        engine's weights are taken as they are: one that opens the jaw wider than the speaker did,
        or has another idea of rest, has the larger error, as it would on his face.

        Args:
            clip: canonical controls.
        """
        values = clip.select(self.controls).values.astype(np.float64) @ self.weights + self.bias
        return Clip(self.modes, clip.fps, np.asarray(values, np.float32))


def fit_bridge(
    weights: npt.NDArray[np.floating[Any]], modes: npt.NDArray[np.floating[Any]],
    controls: Sequence[str], mode_names: Sequence[str], recordings: npt.ArrayLike,
) -> Bridge:  # fmt: skip
    """Ridge regression, with the penalty that five-fold cross-validation over recordings chooses.

    Args:
        weights: (N, C) 0 to 1, of N frames that show a face.
        modes: (N, M) standard deviations.
        controls: the C names; those of the lower face that move are used.
        mode_names: the M names.
        recordings: (N,) which recording each frame is of.

    Raises:
        ValueError: shapes do not match, there are no frames, or a number is not finite.
    """
    x, y = np.asarray(weights, np.float64), np.asarray(modes, np.float64)
    owners = np.unique(np.asarray(recordings), return_inverse=True)[1].reshape(-1)
    if x.shape != (len(owners), len(controls)) or y.shape != (len(owners), len(mode_names)):
        raise ValueError(
            f"{x.shape} weights and {y.shape} modes are not those of {len(owners)} frames, "
            f"{len(controls)} controls and {len(mode_names)} modes"
        )
    if not len(x) or not (np.isfinite(x).all() and np.isfinite(y).all()):
        raise ValueError("no frames, or a number is not finite")
    used = [
        index for index, name in enumerate(controls) if name in SPOKEN and x[:, index].std() > MOVES
    ]
    mean, sd, bias = x[:, used].mean(axis=0), x[:, used].std(axis=0), y.mean(axis=0)
    scaled, apart = (x[:, used] - mean) / sd, y - bias
    penalty = _choose(scaled, apart, owners % min(FOLDS, owners.max() + 1))
    slopes = _solve(scaled.T @ scaled, scaled.T @ apart, penalty * len(x)) / sd[:, None]
    names = tuple(controls[index] for index in used)
    return Bridge(names, tuple(mode_names), slopes, bias - mean @ slopes, penalty)


def _choose(x: Floats, y: Floats, folds: npt.NDArray[np.intp]) -> float:
    """The penalty with the least squared error on the folds left out in turn."""
    if not folds.any() or not x.shape[1]:
        return UNTRIED
    parts = [folds == fold for fold in range(folds.max() + 1)]
    grams = [x[part].T @ x[part] for part in parts]
    crosses = [x[part].T @ y[part] for part in parts]

    def error(penalty: float) -> float:
        total = 0.0
        for part, gram, cross in zip(parts, grams, crosses, strict=True):
            rest = sum(grams) - gram
            slopes = _solve(rest, sum(crosses) - cross, penalty * int((~part).sum()))
            # |y - x slopes|² without |y|², which is the same for all penalties
            total += float(np.sum(slopes * (gram @ slopes)) - 2 * np.sum(slopes * cross))
        return total

    return min(PENALTIES, key=error)


def _solve(gram: Floats, cross: Floats, penalty: float) -> Floats:
    """(C, M) slopes of ridge regression."""
    return np.asarray(np.linalg.solve(gram + penalty * np.eye(len(gram)), cross))


def recalibrated(
    bridge: Bridge, reference_weights: Floats, estimated_weights: Floats
) -> Bridge:  # fmt: skip
    """A bridge that first brings one engine's weights to the speaker's, control by control.

    Each control gets the gain and the offset that fit the speaker's own weights best. It says how
    much of an engine's error is its scale and its idea of rest; as a figure of the engine it would
    credit it with what it has not learnt.

    Args:
        bridge: of the speaker.
        reference_weights: (N, C) the speaker's own weights of the bridge's controls, not those of
            recordings that are measured.
        estimated_weights: (N, C) the engine's, of the same frames.
    """
    reference, estimated = np.asarray(reference_weights), np.asarray(estimated_weights)
    apart = estimated - estimated.mean(axis=0)
    power = np.square(apart).mean(axis=0)
    gains = np.where(
        power > MOVES**2,
        (apart * (reference - reference.mean(axis=0))).mean(axis=0) / np.maximum(power, MOVES**2),
        0.0,
    )
    offsets = reference.mean(axis=0) - gains * estimated.mean(axis=0)
    return Bridge(
        bridge.controls, bridge.modes, bridge.weights * gains[:, None],
        bridge.bias + offsets @ bridge.weights, bridge.penalty,
    )  # fmt: skip
