"""Every entrant measured on the recordings of a split."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.benchmark.motion import Moves, Performer
from lipwright.clip import Clip
from lipwright.controls import ARKIT
from lipwright.dataset.folder import Dataset
from lipwright.dataset.recording import FACE_FILE, Recording
from lipwright.dataset.splits import TRAIN
from lipwright.errors import LipwrightError
from lipwright.evaluate.bridge import Bridge, fit_bridge
from lipwright.evaluate.classes import class_rows
from lipwright.evaluate.errors import Truth, error_rows, load_truth
from lipwright.evaluate.heads import OUR_HEAD, Ruler
from lipwright.evaluate.lip_rows import lip_rows, lower
from lipwright.evaluate.lips import Aperture, evaluate
from lipwright.evaluate.measures import Rows, Scores
from lipwright.face.faceclip import control_names
from lipwright.face.reference import PARTS, ReferenceFace
from lipwright.phones import SILENCE

MOST: Final = 1e6  # of a parameter; grey levels of all pixels together stay far below


@dataclass(frozen=True, eq=False)
class Stage:
    """The recordings of a split, as every entrant is measured on them."""

    face: ReferenceFace
    recordings: tuple[Recording, ...]
    truths: tuple[Truth, ...]
    references: tuple[Aperture, ...]
    """of the tracked lips, on the clock of the video"""
    bridge: Bridge
    heads: Mapping[str, Ruler]


def set_stage(
    face: ReferenceFace, face_hash: str, dataset: Dataset, names: Sequence[str], bridge: Bridge,
    heads: Mapping[str, Ruler],
) -> Stage:  # fmt: skip
    """The stage of some recordings of a dataset.

    Raises:
        LipwrightError: a recording cannot be measured with; names it and the remedy.
    """
    recordings = tuple(_recording(dataset, name) for name in names)
    truths = tuple(_truth(face, face_hash, recording) for recording in recordings)
    return Stage(face, recordings, truths, tuple(map(_reference, recordings)), bridge, heads)


def _recording(dataset: Dataset, name: str) -> Recording:
    found = dataset.recording(name)
    if found.name != name:  # videos and curves are named by it
        raise LipwrightError(
            f"{found.folder}: its recording.json is that of {found.name!r}; give it the name "
            f"{name!r} there"
        )
    return found


def _truth(face: ReferenceFace, face_hash: str, recording: Recording) -> Truth:
    """The parameters of a recording, where they can be those of the face."""
    truth = load_truth(recording, face_hash)
    for part, size in zip(PARTS, face.sizes, strict=True):
        values = getattr(truth.parameters, part)
        if values.shape[1] != size or not (np.abs(values) <= MOST).all():
            raise LipwrightError(
                f"{recording.folder / FACE_FILE}: {part} has values that cannot be, or not {size} "
                "of them; run: lipwright face fit"
            )
    return truth


def _reference(recording: Recording) -> Aperture:
    """The tracked lips, where the house's definition has them: on the clock of the video."""
    values = recording.motion.aperture
    if values is None:
        raise LipwrightError(
            f"{recording.folder}: has no aperture of the lips: it was not tracked from a video; "
            "reject it with: lipwright dataset reject"
        )
    if not (
        len(values) > 1 and np.isfinite(values).any() and set(recording.track.phones) != {SILENCE}
    ):
        raise LipwrightError(
            f"{recording.folder}: shows no face or says nothing; reject it with: "
            "lipwright dataset reject"
        )
    return Aperture(recording.times + recording.offset, np.asarray(values, np.float64))


def make_bridge(dataset: Dataset, face: ReferenceFace, face_hash: str) -> Bridge:
    """The map from weights to joint modes, learnt from the recordings for training.

    Raises:
        LipwrightError: one has no parameters of this face, or none shows a face.
    """
    names = control_names(face, "joint")
    weights, modes, owners = [], [], []
    for number, name in enumerate(dataset.names(TRAIN)):
        recording = dataset.recording(name)
        truth = _truth(face, face_hash, recording)
        weights.append(recording.motion.arkit[truth.valid])
        modes.append(face.join(truth.parameters) / face.sd("joint"))
        owners.append(np.full(int(truth.valid.sum()), number))
    if not sum(map(len, weights)):
        raise LipwrightError(
            f"{dataset.path}: no frame for {TRAIN} shows a face; run: lipwright dataset split"
        )
    return fit_bridge(
        np.concatenate(weights), np.concatenate(modes), ARKIT, names, np.concatenate(owners)
    )


@dataclass(frozen=True, eq=False)
class Performance:
    """An entrant on a stage."""

    moves: tuple[Moves, ...]
    errors: Scores
    classes: Mapping[str, Rows]
    by_head: Mapping[str, Scores]
    """of the lips' measures; empty where it moves no head"""
    bare: Scores
    """of the lips on our head, without passes"""

    @property
    def scores(self) -> Scores:
        """All measures, of the lips those of the head where r is lower."""
        return {**self.errors, **(lower(self.by_head)[1] if self.by_head else {})}


def measure(performer: Performer, stage: Stage) -> Performance:
    """An entrant on every recording of a stage.

    Raises:
        LipwrightError: its model or curves cannot be used.
    """
    moves = tuple(performer.perform(one, stage.bridge) for one in stage.recordings)
    modes = [one.modes for one in moves]
    animated = [one.animated for one in moves if one.animated is not None]
    bare = [one.bare for one in moves if one.bare is not None]
    return Performance(
        moves,
        error_rows(stage.face, stage.truths, modes),
        class_rows(stage.face, stage.truths, modes),
        {head: _lips(stage, animated, ruler) for head, ruler in stage.heads.items()}
        if animated else {},
        _lips(stage, bare, stage.heads[OUR_HEAD]) if bare else {},
    )  # fmt: skip


def _lips(stage: Stage, clips: Sequence[Clip], ruler: Ruler) -> Scores:
    return lip_rows([
        evaluate(reference, Aperture(clip.times, ruler(clip)), recording.track)
        for reference, clip, recording in zip(
            stage.references, clips, stage.recordings, strict=True
        )
    ])  # fmt: skip


def aperture_over_loud(
    aperture: Aperture, times: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """An aperture at some times, over its 95th percentile."""
    return aperture.at(times) / max(aperture.loud, 1e-9)
