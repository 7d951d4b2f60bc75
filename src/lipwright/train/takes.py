"""`Take`: what training needs of a recording, and `Corpus`: those of a dataset by split."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.controls import ARKIT, GROUPS
from lipwright.dataset.folder import Dataset, sha256_of
from lipwright.dataset.recording import FACE_FILE, Recording
from lipwright.dataset.splits import TEST, TRAIN, VALIDATION
from lipwright.errors import LipwrightError
from lipwright.face.faceclip import control_names
from lipwright.face.reference_file import load_reference_face
from lipwright.track import PhoneTrack
from lipwright.train.config import Config
from lipwright.train.hearing import Listening, listen_to_all
from lipwright.train.learner import LearnerConfig

Report = Callable[[str, float], None]
Floats = npt.NDArray[np.float32]

SPOKEN: Final = ("cheeks", "jaw", "lips", "tongue")  # groups of ARKit that phones say anything of
MOVES: Final = 1e-3  # of a full range; less standard deviation in training is a control at rest


@dataclass(frozen=True, eq=False)
class Take:
    """One recording."""

    name: str
    times: npt.NDArray[np.float64]
    """(T,), s on the clock of the track"""
    targets: Floats
    """(T, C), finite; 0 where no face was seen"""
    valid: npt.NDArray[np.bool_]
    """(T,), where a face was seen"""
    track: PhoneTrack
    audio: Path | None = None
    """the recorded sound"""
    sound: Floats | None = None
    """(T, S), features of the sound"""
    voices: tuple[Floats, ...] = ()
    """the same of other voices, each (T, S)"""
    aperture: Floats | None = None
    """(T,), of the real lips, eye distances; NaN where no face was seen"""


@dataclass(frozen=True, eq=False)
class Corpus:
    """The takes of a dataset."""

    splits: dict[str, tuple[Take, ...]]
    """train, validation, test"""
    controls: tuple[str, ...]
    """C names"""
    fps: float
    name: str
    licence: str
    path: Path
    """of the dataset"""

    def of(self, split: str) -> tuple[Take, ...]:
        """The takes of a split."""
        return self.splits[split]

    def check_window(self, window: int) -> None:
        """Refuse takes shorter than a window of so many frames.

        Raises:
            LipwrightError: there is one; names it.
        """
        for take in (take for takes in self.splits.values() for take in takes):
            if len(take.times) < window:
                raise LipwrightError(
                    f"{self.path}: the recording {take.name!r} has {len(take.times)} frames, fewer "
                    f"than the window of {window}; narrow the window, or reject the recording"
                )

    def digest(self) -> str:
        """A hash of all that can be learnt from it."""
        known = hashlib.sha256(repr((self.controls, self.fps)).encode())
        for split, takes in self.splits.items():
            for take in takes:
                known.update(repr((split, take.name, take.track.phones)).encode())
                arrays = (take.track.edges, take.times, take.targets, take.valid, take.sound)
                for array in arrays:
                    known.update(b"" if array is None else np.ascontiguousarray(array).tobytes())
        return known.hexdigest()


def read_corpus(
    dataset: Dataset, config: Config | LearnerConfig, face: Path | None = None,
    report: Report | None = None,
) -> Corpus:  # fmt: skip
    """What a configuration learns from a dataset.

    Args:
        dataset: captured; for shape and joint modes `lipwright face fit` has run.
        config: of the training.
        face: the reference face of the modes; that beside the dataset, DATASET-face.npz, unless
            given.
        report: told how much is read.

    Raises:
        LipwrightError: the dataset has not what the configuration asks for; names the recording.
    """
    names = {split: dataset.names(split) for split in (TRAIN, VALIDATION, TEST)}
    for split in (TRAIN, VALIDATION):
        if not names[split]:
            raise LipwrightError(
                f"{dataset.path}: no recording is for {split}; run: lipwright dataset split"
            )
    reader = _Reader(dataset, config, face)
    total, done = sum(map(len, names.values())), 0
    splits: dict[str, list[Take]] = {split: [] for split in names}
    for split, chosen in names.items():
        for name in chosen:
            splits[split].append(reader.read(name))
            done += 1
            if report is not None:
                report("read", done / total)
    for split, takes in splits.items():
        if takes and not any(take.valid.any() for take in takes):
            raise LipwrightError(
                f"{dataset.path}: no frame for {split} shows a face; run: lipwright dataset split"
            )
    columns = _columns(dataset, config, reader.names, splits[TRAIN])
    if isinstance(config, Config) and "sound" in config.features:
        splits = _with_sound(config, splits, report)
    return Corpus(
        {
            split: tuple(replace(take, targets=take.targets[:, columns]) for take in takes)
            for split, takes in splits.items()
        },
        tuple(reader.names[column] for column in columns),
        reader.fps,
        str(dataset.manifest.get("name", "")) or dataset.path.name,
        str(dataset.manifest.get("licence", "")),
        dataset.path,
    )


def _with_sound(
    config: Config, splits: dict[str, list[Take]], report: Report | None
) -> dict[str, list[Take]]:
    """The same takes with what is heard in them; those without sound stay as they are."""
    chosen = [(split, take) for split, takes in splits.items() for take in takes]
    tasks = [
        Listening(take.audio, take.times, config.augment.voices if split == TRAIN else ())
        for split, take in chosen
        if take.audio is not None
    ]
    heard = listen_to_all(tasks)
    found: dict[str, list[Take]] = {split: [] for split in splits}
    for number, (split, take) in enumerate(chosen, 1):
        if take.audio is None:
            found[split].append(take)
            continue
        sound, *voices = next(heard)
        found[split].append(replace(take, sound=sound, voices=tuple(voices)))
        if report is not None:
            report("listen", number / len(chosen))
    return found


class _Reader:
    """Takes out of recordings that must agree with each other."""

    def __init__(self, dataset: Dataset, config: Config | LearnerConfig, face: Path | None) -> None:
        self.dataset, self.config = dataset, config
        self.fps = 0.0
        self.first = ""
        self.names: tuple[str, ...] = ARKIT
        if config.targets != "arkit":
            self.face = face or Path(f"{dataset.path}-face.npz")
            self._need_parameters(dataset.names()[0])
            self.model = sha256_of(self.face)
            loaded = load_reference_face(self.face)
            self.modes = "joint" if config.targets == "both" else config.targets
            self.names, self.sd = control_names(loaded, self.modes), loaded.sd(self.modes)
            if config.targets == "both":
                self.names += ARKIT

    def read(self, name: str) -> Take:
        recording = self.dataset.recording(name)
        fps = round(self.config.fps or recording.motion.fps, 6)
        if self.fps and fps != self.fps:
            raise LipwrightError(
                f"{self.dataset.path}: {self.first!r} has {self.fps:g} frames a second, {name!r} "
                f"has {fps:g}; name one rate as 'fps' in the configuration, or --fps"
            )
        self.fps, self.first = fps, self.first or name
        take = self._take(recording)
        if self.config.fps is not None and recording.motion.fps != self.config.fps:
            take = resampled(take, self.config.fps)
        return take

    def _take(self, recording: Recording) -> Take:
        valid = recording.valid
        targets = self._targets(recording)
        finite = np.asarray(np.isfinite(targets).all(axis=1))
        if not finite[valid].all():
            frame = int(np.flatnonzero(valid & ~finite)[0])
            raise LipwrightError(
                f"{recording.folder}: {self.config.targets} is not a number at frame {frame}, "
                "where a face was seen; capture it again, or run: lipwright face fit"
            )
        still = np.where(valid[:, None], targets, 0).astype(np.float32)
        return Take(
            recording.name, recording.times, still, valid, recording.track, recording.audio,
            aperture=recording.motion.aperture,
        )  # fmt: skip

    def _targets(self, recording: Recording) -> Floats:
        if self.config.targets == "arkit":
            return recording.motion.arkit
        found = self._need_parameters(recording.name)
        shape = (len(recording.motion), len(self.sd))
        if str(found.get("model", "")) != self.model:
            raise LipwrightError(
                f"{recording.folder / FACE_FILE}: is of another reference face than {self.face}; "
                "name its own with --face, or run: lipwright face fit"
            )
        values = np.asarray(found.get(self.modes))
        if values.shape != shape or values.dtype.kind != "f":
            raise LipwrightError(
                f"{recording.folder / FACE_FILE}: {self.modes} has the shape "
                f"{values.shape}, not {shape}; run: lipwright face fit"
            )
        modes = np.asarray(values / self.sd, np.float32)
        if self.config.targets == "both":
            return np.concatenate([modes, recording.motion.arkit], axis=1)
        return modes

    def _need_parameters(self, name: str) -> dict[str, npt.NDArray[Any]]:
        recording = self.dataset.recording(name)
        found = recording.face()
        if found is None:
            raise LipwrightError(
                f"{recording.folder}: has no {FACE_FILE}, and so no {self.config.targets} modes; "
                f"run: lipwright face fit {self.dataset.path} -o {self.face}"
            )
        return found


def resampled(take: Take, fps: float) -> Take:
    """The take at another frame rate, linear between frames in which a face was seen."""
    start, end = take.times[0], take.times[-1]
    times = start + np.arange(int((end - start) * fps + 1e-6) + 1) / fps
    valid = np.interp(times, take.times, take.valid.astype(float)) > 1 - 1e-6
    targets = np.zeros((len(times), take.targets.shape[1]), np.float32)
    if valid.any():
        for column, values in enumerate(take.targets.T):
            targets[valid, column] = np.interp(times[valid], take.times, values)
    aperture = None
    if take.aperture is not None:
        aperture = np.interp(times, take.times, np.nan_to_num(take.aperture)).astype(np.float32)
        aperture[~valid] = np.nan
    return replace(take, times=times, valid=valid, targets=targets, aperture=aperture)


def _columns(
    dataset: Dataset, config: Config | LearnerConfig, names: tuple[str, ...], takes: list[Take]
) -> list[int]:
    """Which controls to learn, by their place among all of the targets."""
    if config.controls is not None:
        for name in config.controls:
            if name not in names:
                raise LipwrightError(
                    f"{dataset.path}: has no control {name!r} among its {config.targets} targets; "
                    f"it has {names[0]} to {names[-1]}"
                )
        return [names.index(name) for name in config.controls]
    seen = np.concatenate([take.targets[take.valid] for take in takes])
    moves = seen.std(axis=0, dtype=np.float64) > MOVES
    columns = list(_spoken(names, moves))
    if not columns:
        raise LipwrightError(f"{dataset.path}: no control of {config.targets} moves in training")
    return columns


def _spoken(names: tuple[str, ...], moves: npt.NDArray[np.bool_]) -> Iterator[int]:
    lower = {name for group in SPOKEN for name in GROUPS[group]}
    for column, name in enumerate(names):
        if moves[column] and (name not in ARKIT or name in lower):
            yield column
