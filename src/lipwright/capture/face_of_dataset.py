"""The reference face of a dataset: fitted, saved, and its parameters kept beside each recording."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from lipwright.capture.fit_face import FaceFit, FitOptions, fit_reference_face
from lipwright.capture.takes import Take, make_take
from lipwright.dataset.folder import Dataset, open_dataset, sha256_of
from lipwright.dataset.lock import locked
from lipwright.errors import LipwrightError
from lipwright.face.reference import ReferenceFace
from lipwright.face.reference_file import save_reference_face
from lipwright.version import VERSION

Report = Callable[[str, float], None]


@dataclass(frozen=True)
class FittedDataset:
    """What `fit_dataset` did."""

    face: ReferenceFace
    used: tuple[str, ...]
    """recordings with parameters now"""
    skipped: tuple[str, ...]
    """a line for each recording without landmarks or video"""


def fit_dataset(
    dataset: Dataset, out: Path, options: FitOptions | None = None, videos: Path | None = None,
    report: Report | None = None,
) -> FittedDataset:  # fmt: skip
    """Fit a reference face, write it to `out`, and face.npz beside each recording.

    Args:
        dataset: of captured videos; its manifest is read again, as it may have changed.
        out: where the model is written.
        options: of the fit.
        videos: folder of the videos, where they are not at the places that the recordings name.
        report: called with a stage and its share that is done.

    Raises:
        LipwrightError: a video is missing or has changed, there are too few frames, or a file
            cannot be written.
    """
    report = report or (lambda stage, share: None)
    with locked(dataset.path):
        return _fit_dataset(open_dataset(dataset.path), out, options, videos, report)


def _fit_dataset(
    dataset: Dataset, out: Path, options: FitOptions | None, videos: Path | None, report: Report
) -> FittedDataset:
    takes, skipped = load_takes(dataset, videos, report)
    if not takes:
        raise LipwrightError(
            f"{dataset.path}: no recording has landmarks and a video; capture videos first"
        )
    try:
        fit = fit_reference_face(takes, options, report)
    except ValueError as error:
        raise LipwrightError(
            f"{dataset.path}: no reference face can be fitted: {error}; capture more speech"
        ) from error
    face = replace(fit.face, info={**fit.face.info, **_origin(dataset)})
    save_reference_face(out, face)
    _save_parameters(dataset, replace(fit, face=face), takes, sha256_of(out), report)
    return FittedDataset(face, tuple(take.name for take in takes), tuple(skipped))


def load_takes(
    dataset: Dataset, videos: Path | None, report: Report
) -> tuple[list[Take], list[str]]:
    """The takes of the usable recordings, and a line for each that cannot be one.

    Raises:
        LipwrightError: a video is missing or has changed.
    """
    takes, skipped = [], []
    names = dataset.names()
    for number, name in enumerate(names):
        report("read", number / len(names))
        take = make_take(dataset.recording(name), dataset.entry(name).get("split", "train"), videos)
        if take is None:
            skipped.append(f"{name}: has no landmarks or no video; skipped")
        else:
            takes.append(take)
    report("read", 1.0)
    return takes, skipped


def _origin(dataset: Dataset) -> dict[str, object]:
    return {
        "lipwright": VERSION,
        "dataset": dataset.manifest.get("name", ""),
        "licence": dataset.manifest.get("licence", ""),
    }


def _save_parameters(
    dataset: Dataset, fit: FaceFit, takes: Sequence[Take], model: str, report: Report
) -> None:
    """face.npz of each recording, and its hash in the manifest."""
    for number, take in enumerate(takes):
        report("write", number / len(takes))
        parameters = fit.parameters[take.name]
        arrays = {
            "shape": parameters.shape, "inner": parameters.inner, "outer": parameters.outer,
            "joint": fit.face.join(parameters), "inner_visible": take.visible,
            "light": np.tile(fit.lights[take.name], (len(take), 1)), "model": np.array(model),
        }  # fmt: skip
        dataset.save_face(take.name, arrays)
    dataset.with_files(tuple(take.name for take in takes)).save()
    report("write", 1.0)
