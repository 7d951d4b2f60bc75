"""Squared error against the parameters of a reference face, as in figure 10 of Taylor et al. 2017.

Errors are means over frames and over what a frame has. Pixels are drawn from the predicted and from
the recording's own parameters, so that what the modes cannot draw counts for nobody; vertices are
compared with the tracked ones.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.dataset.recording import FACE_FILE, Recording
from lipwright.errors import LipwrightError
from lipwright.evaluate.lips import Aperture, correlation
from lipwright.evaluate.measures import MEASURES, Floats, Rows, Scores
from lipwright.face.reference import PARTS, FaceParameters, ReferenceFace
from lipwright.face.vertices import LANDMARKS, REGIONS, aperture
from lipwright.phones import SILENCE
from lipwright.track import PhoneTrack

OF_SHAPE: Final = ("shape", "vertices")
"""the errors that curves of shape modes alone have, besides `face_r`"""
OF_FRAMES: Final = tuple(
    name for name, measure in MEASURES.items() if measure.group == "error" and name != "face_r"
)
"""the errors that each frame has"""

_MODE: Final = re.compile(r"(joint|shape)([1-9][0-9]*)")
_REMEDY: Final = "run: lipwright face fit"
_STORED: Final = ("joint", *PARTS)


@dataclass(frozen=True, eq=False)
class Truth:
    """What a recording is compared with, in the T of its frames that show a face."""

    name: str
    """of the recording"""
    times: Floats
    """(T,) s, on the clock of the sound"""
    valid: npt.NDArray[np.bool_]
    """(all frames,) which of them the T are"""
    parameters: FaceParameters
    """(T, ...)"""
    points: npt.NDArray[np.float32]
    """(T, 34, 2) tracked vertices, eye distances"""
    visible: npt.NDArray[np.bool_]
    """(T,) where the inner mouth is seen"""
    track: PhoneTrack

    def counted(self, measure: str) -> Floats:
        """(F,) s, the times of the frames that an error counts."""
        return self.times[self.visible] if measure == "inner" else self.times


def load_truth(recording: Recording, face_hash: str) -> Truth:
    """A recording with its parameters of the reference face whose file has that SHA-256.

    Raises:
        LipwrightError: it has none, those of another face, or broken ones.
    """
    face, landmarks = recording.face(), recording.motion.landmarks
    if face is None or landmarks is None:
        raise LipwrightError(f"{recording.folder}: has no parameters; {_REMEDY}")
    if str(face.get("model")) != face_hash:
        raise LipwrightError(
            f"{recording.folder}: has the parameters of another reference face; {_REMEDY}"
        )
    _check(recording, face)
    valid = recording.valid & np.isfinite(face["joint"]).all(axis=1)
    return Truth(
        recording.name, recording.times[valid], valid,
        FaceParameters(*(face[part][valid] for part in PARTS)),
        landmarks[valid][:, LANDMARKS, :2], face["inner_visible"][valid], recording.track,
    )  # fmt: skip


def _check(recording: Recording, face: dict[str, npt.NDArray[Any]]) -> None:
    frames = len(recording.motion)
    for name in _STORED:
        array = face.get(name)
        if array is None or array.ndim != 2 or len(array) != frames or array.dtype.kind != "f":
            raise LipwrightError(
                f"{recording.folder / FACE_FILE}: {name} is not numbers of {frames} frames; "
                f"{_REMEDY}"
            )
    seen = face.get("inner_visible")
    if seen is None or seen.shape != (frames,) or seen.dtype.kind != "b":
        raise LipwrightError(
            f"{recording.folder / FACE_FILE}: inner_visible is not flags of {frames} frames; "
            f"{_REMEDY}"
        )


def frame_errors(
    face: ReferenceFace, truth: Truth, clip: Clip, only: Collection[str] = OF_FRAMES
) -> dict[str, Floats]:
    """Each error of each frame that it counts.

    Args:
        face: the model of both.
        truth: the recording.
        clip: joint modes, or shape modes, one value for each frame of the recording, with or
            without a face; controls that are no modes are left alone, modes that it lacks are at
            the mean.
        only: the errors that are wanted.

    Returns:
        Name of a measure to (F,); curves of shape modes have those of OF_SHAPE only.

    Raises:
        LipwrightError: the clip has no modes of this face, or joint and shape modes.
        ValueError: it has not as many frames as the recording.
    """
    made, real = _read(face, truth, clip), truth.parameters
    found: dict[str, npt.NDArray[Any]] = {}
    if "shape" in only:
        found["shape"] = np.square(made.shape - real.shape)
    if "vertices" in only:
        found["vertices"] = np.square(face.points(made.shape) - truth.points).sum(axis=-1)
    if made.joint is not None and not {"joint_sd", "joint"}.isdisjoint(only):
        apart = made.joint - face.join(real) / face.joint_sd
        found |= {"joint_sd": np.square(apart), "joint": np.square(apart * face.joint_sd)}
    if made.joint is not None:
        for region in set(REGIONS).intersection(only):
            seen = truth.visible if region == "inner" else slice(None)
            appearance = getattr(face, region)
            levels = (appearance.grey(getattr(one, region)[seen]) for one in (made, real))
            found[region] = np.square(np.subtract(*levels))
    return {name: found[name].mean(axis=1, dtype=np.float64)
            for name in OF_FRAMES if name in found and name in only}  # fmt: skip


def face_r(face: ReferenceFace, truth: Truth, clip: Clip) -> float:
    """Pearson's r of the aperture of predicted and tracked vertices in speech.

    NaN where either does not move, or where nothing is said.

    Raises:
        LipwrightError: as `frame_errors`.
        ValueError: as `frame_errors`.
    """
    made = _read(face, truth, clip)
    if len(truth.times) < 2 or set(truth.track.phones) == {SILENCE}:
        return float("nan")
    tracked, estimated = (
        Aperture(truth.times, np.asarray(aperture(points), np.float64))
        for points in (truth.points, face.points(made.shape))
    )
    return correlation(tracked, estimated, truth.track)


def error_rows(face: ReferenceFace, truths: Sequence[Truth], clips: Sequence[Clip]) -> Scores:
    """The rows of the errors over recordings.

    Of `face_r`, the sum of those that are finite, and how many are.

    Args:
        face: the model.
        truths: S recordings.
        clips: of each recording, as `frame_errors` takes them.

    Raises:
        LipwrightError: as `frame_errors`.
        ValueError: as `frame_errors`.
    """
    sums: dict[str, list[float]] = {}
    counts: dict[str, list[int]] = {}
    for truth, clip in zip(truths, clips, strict=True):
        r = face_r(face, truth, clip)
        values = {
            **frame_errors(face, truth, clip), "face_r": np.array([r] if np.isfinite(r) else []),
        }  # fmt: skip
        for name, found in values.items():
            sums.setdefault(name, []).append(float(found.sum()))
            counts.setdefault(name, []).append(len(found))
    return {name: Rows(np.array(sums[name]), np.array(counts[name], float)) for name in sums}


@dataclass(frozen=True, eq=False)
class _Made:
    """What curves say of the T frames."""

    shape: npt.NDArray[np.float32]
    """(T, M) eye distances"""
    joint: npt.NDArray[np.float32] | None = None
    """(T, q) standard deviations; None where they say nothing of the appearance"""
    inner: npt.NDArray[np.float32] | None = None
    """(T, n1) grey levels"""
    outer: npt.NDArray[np.float32] | None = None
    """(T, n2) grey levels"""


def _read(face: ReferenceFace, truth: Truth, clip: Clip) -> _Made:
    if len(clip) != len(truth.valid):
        raise ValueError(f"{len(clip)} frames of curves for {len(truth.valid)} of {truth.name!r}")
    modes = {name: match for name in clip.names if (match := _MODE.fullmatch(name))}
    kinds = {match[1] for match in modes.values()}
    if len(kinds) != 1:
        found = "joint and shape modes; keep either" if kinds else "no joint and no shape modes"
        raise LipwrightError(f"{truth.name}: the curves have {found}")
    kind = "joint" if "joint" in kinds else "shape"
    sd = face.sd("joint" if kind == "joint" else "shape")
    places = [int(match[2]) - 1 for match in modes.values()]
    if max(places) >= len(sd):
        raise LipwrightError(
            f"{truth.name}: the curves have {kind}{max(places) + 1}, and the reference face "
            f"{len(sd)} {kind} modes; name the face that they are of"
        )
    values = np.zeros((int(truth.valid.sum()), len(sd)), np.float32)
    values[:, places] = clip.values[truth.valid][:, [clip.names.index(name) for name in modes]]
    if kind == "shape":
        return _Made(values * sd)
    parts = face.split(values * sd)
    return _Made(parts.shape, values, parts.inner, parts.outer)
