"""Whether a dataset is whole: every file there, unchanged, readable and fitting the others."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from lipwright.dataset.folder import FAILED, MANIFEST_FILE, RECORDINGS, Dataset, sha256_of
from lipwright.dataset.recording import (
    AUDIO_FILE,
    FACE_FILE,
    INFO_FILE,
    MOTION_FILE,
    PHONES_FILE,
    Recording,
    read_recording,
)
from lipwright.dataset.splits import SPLITS
from lipwright.errors import LipwrightError
from lipwright.formats import read_track

NEEDED: Final = (MOTION_FILE, PHONES_FILE)
LENGTHS: Final = 0.5  # the shorter of picture and sound over the longer, least, as in capture
FACE_TEXT: Final = "model"  # the only array of face.npz that is not one row a frame
_PICKLE_SUFFIXES: Final = frozenset((".pkl", ".pickle", ".joblib", ".pt", ".pth"))
_PICKLE_STARTS: Final = tuple(bytes((0x80, protocol)) for protocol in range(2, 6))
_DAMAGED: Final = "restore the file, or capture again"


@dataclass(frozen=True)
class Findings:
    """What a check found."""

    problems: tuple[str, ...]
    """one line each"""
    edited: tuple[str, ...]
    """recordings whose phones were edited since they were captured"""


def check_dataset(
    dataset: Dataset, report: Callable[[str, float], None] = lambda stage, share: None
) -> Findings:
    """Look at every file of a dataset.

    Args:
        dataset: what to check.
        report: told how far it is.
    """
    problems: list[str] = []
    edited = []
    for number, entry in enumerate(dataset.entries, 1):
        found = list(_entry_problems(dataset, entry))
        problems += found
        if not found and is_edited(dataset, entry):
            edited.append(entry["name"])
        report("check", number / len(dataset.entries))
    problems += _strangers(dataset)
    return Findings(tuple(problems), tuple(edited))


def is_edited(dataset: Dataset, entry: Mapping[str, Any]) -> bool:
    """Whether the phones of a recording are not those that the manifest knows.

    Raises:
        LipwrightError: they cannot be read.
    """
    known = entry.get("files", {}).get(PHONES_FILE)
    return known is not None and sha256_of(dataset.folder(entry["name"]) / PHONES_FILE) != known


def accept_edits(dataset: Dataset, edited: tuple[str, ...]) -> Dataset:
    """The dataset whose manifest knows the edited phones; nothing is written.

    Raises:
        LipwrightError: a file cannot be read.
    """
    return dataset.with_files(edited, PHONES_FILE)


def _entry_problems(dataset: Dataset, entry: Mapping[str, Any]) -> Iterator[str]:
    name, folder = entry["name"], dataset.folder(entry["name"])
    if entry.get("split") is not None and entry["split"] not in SPLITS:
        yield (
            f"{dataset.path / MANIFEST_FILE}: {name!r} has the split {entry['split']!r}, "
            f"not one of: {', '.join(SPLITS)}"
        )
    if entry["status"] == FAILED and not entry.get("files"):
        return
    if not _lies_in(folder, dataset.path):
        yield f"{folder}: leads out of the dataset; put the files themselves there"
    elif not folder.is_dir():
        yield f"{folder}: no such folder; restore it, or capture again"
    else:
        files = list(_file_problems(folder, entry))
        yield from files
        if not files:  # one line about a broken file is enough
            yield from _content_problems(folder, name)


def _lies_in(path: Path, root: Path) -> bool:
    return Path(os.path.realpath(path)).is_relative_to(os.path.realpath(root))


def _file_problems(folder: Path, entry: Mapping[str, Any]) -> Iterator[str]:
    """Files that are missing, changed, unknown, or not what a dataset may hold."""
    known = entry.get("files", {})
    there = {path.name for path in folder.iterdir()}
    for file in sorted({*known, *NEEDED, INFO_FILE} - there):
        yield f"{folder / file}: no such file; {_DAMAGED}"
    for file in sorted(there):
        path = folder / file
        if not _lies_in(path, folder) or not path.is_file():
            yield f"{path}: is no file of this folder; remove it"
        elif file.startswith("."):
            yield f"{path}: was left by a program that was stopped; remove it"
        elif is_pickle(path):
            yield f"{path}: is a pickle, which can run programs when it is read; remove it"
        elif file in known:
            if file != PHONES_FILE and sha256_of(path) != known[file]:
                yield f"{path}: has changed since it was written; {_DAMAGED}"
        elif file != INFO_FILE:
            yield f"{path}: the manifest does not know it; remove it"


def is_pickle(path: Path) -> bool:
    """Whether a file looks like Python objects rather than data."""
    if path.suffix.lower() in _PICKLE_SUFFIXES:
        return True
    with path.open("rb") as file:
        return file.read(2) in _PICKLE_STARTS


def _content_problems(folder: Path, name: str) -> Iterator[str]:
    """What files say that cannot be, alone or together."""
    try:
        recording = read_recording(folder)
        motion, frames = recording.motion, recording.info.get("frames")
        if recording.name != name:
            yield f"{folder / INFO_FILE}: is of {recording.name!r}; {_DAMAGED}"
        if frames is not None and frames != len(motion):
            yield f"{folder / MOTION_FILE}: has {len(motion)} frames, not {frames}; {_DAMAGED}"
        sound = _sound_length(folder / AUDIO_FILE)
        read_track(folder / PHONES_FILE, duration=sound)
        if sound is not None:
            yield from _length_problems(recording, sound)
        yield from _face_problems(recording)
    except LipwrightError as error:
        yield str(error)


def _sound_length(path: Path) -> float | None:
    """s, or None where the recording has no sound of its own."""
    import soundfile

    if not path.is_file():
        return None
    try:
        return float(soundfile.info(path).duration)
    except (OSError, RuntimeError) as error:
        raise LipwrightError(f"{path}: not readable sound; {_DAMAGED}") from error


def _length_problems(recording: Recording, sound: float) -> Iterator[str]:
    picture = recording.start + recording.motion.duration
    if min(picture, sound) < LENGTHS * max(picture, sound):
        yield (
            f"{recording.folder / MOTION_FILE}: the picture lasts {picture:.1f} s and the sound "
            f"{sound:.1f} s; {_DAMAGED}"
        )


def _face_problems(recording: Recording) -> Iterator[str]:
    path, frames = recording.folder / FACE_FILE, len(recording.motion)
    for key, array in (recording.face() or {}).items():
        if key == FACE_TEXT:
            continue
        if array.dtype.kind not in "fbiu" or not array.ndim or len(array) != frames:
            yield (
                f"{path}: {key!r} has the shape {array.shape}, not {frames} rows; "
                "run: lipwright face fit"
            )
        elif array.dtype.kind == "f" and np.isinf(array).any():
            yield f"{path}: {key!r} is infinite somewhere; run: lipwright face fit"


def _strangers(dataset: Dataset) -> Iterator[str]:
    """What lies among the recordings and is none of them."""
    root = dataset.path / RECORDINGS
    names = {entry["name"] for entry in dataset.entries}
    try:
        there = sorted(root.iterdir())
    except OSError:
        if names:
            yield f"{root}: cannot be read; restore it, or capture again"
        return
    for path in there:
        if path.name.startswith("."):
            yield f"{path}: was left by a program that was stopped; remove it"
        elif path.name not in names:
            yield f"{path}: is not in the manifest; remove it, or capture again"
