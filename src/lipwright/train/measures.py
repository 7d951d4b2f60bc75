"""How well a network predicts recordings: errors and correlations, for cards and tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.controls import ARKIT, CANONICAL
from lipwright.errors import LipwrightError
from lipwright.evaluate.lips import Aperture, correlation
from lipwright.face.head import Head, load_head
from lipwright.phones import SILENCE
from lipwright.train.checkpoint import Weights
from lipwright.train.config import Config
from lipwright.train.data import Arrays, Data
from lipwright.train.loop import network_of, predict
from lipwright.train.takes import Take

Values = npt.NDArray[np.float64]

DIGITS: Final = 4  # of figures in cards and meta.json


def predict_takes(
    config: Config, data: Data, members: Sequence[Weights], arrays: Arrays
) -> list[Values]:
    """The controls (T, C) of each take, as they leave the network; the mean of all members."""
    outputs = [predict(network_of(config, data, weights), arrays).numpy() for weights in members]
    scaled = np.mean(outputs, axis=0, dtype=np.float64)
    controls = scaled * data.scaling.sd + data.scaling.mean
    return [controls[start:stop] for start, stop in pairwise(arrays.starts)]


def measure(
    names: Sequence[str], spread: Values, takes: Sequence[Take], estimated: Sequence[Values]
) -> dict[str, Any]:
    """The figures of some takes, as plain values; None where there is none.

    `error` is the mean squared error in standard deviations of each control in training, `r`
    Pearson's correlation over all frames, `aperture_r` the mean over recordings of that of the
    lips: real ones against those of the head under the predicted weights.
    """
    valid = np.concatenate([take.valid for take in takes])
    real = np.concatenate([take.targets for take in takes])[valid].astype(np.float64)
    guess = np.concatenate(estimated)[valid]
    errors = (((guess - real) / spread) ** 2).mean(axis=0)
    controls = {
        name: {"error": _rounded(errors[column]),
               "r": _rounded(_correlation(real[:, column], guess[:, column]))}
        for column, name in enumerate(names)
    }  # fmt: skip
    return {
        "recordings": len(takes),
        "frames": int(valid.sum()),
        "error": _rounded(errors.mean()),
        "aperture_r": _rounded(_aperture_r(names, takes, estimated)),
        "controls": controls,
    }


def _rounded(value: float) -> float | None:
    return round(float(value), DIGITS) if math.isfinite(value) else None


def _correlation(one: Values, other: Values) -> float:
    if np.ptp(one) < 1e-9 or np.ptp(other) < 1e-9:
        return math.nan
    return float(np.corrcoef(one, other)[0, 1])


def _aperture_r(
    controls: Sequence[str], takes: Sequence[Take], estimated: Sequence[Values]
) -> float:
    """NaN where the targets are no weights of a head, or there is no head."""
    weights = [column for column, name in enumerate(controls) if name in ARKIT]
    if not weights:
        return math.nan
    try:
        head = load_head()
    except LipwrightError:
        return math.nan
    found = [
        _take_r(head, [controls[column] for column in weights], take, values[:, weights])
        for take, values in zip(takes, estimated, strict=True)
        if take.aperture is not None and take.valid.any() and set(take.track.phones) != {SILENCE}
    ]
    known = [r for r in found if math.isfinite(r)]
    return float(np.mean(known)) if known else math.nan


def _take_r(head: Head, controls: Sequence[str], take: Take, values: Values) -> float:
    assert take.aperture is not None
    weights = np.zeros((len(values), len(CANONICAL)))
    weights[:, [CANONICAL.index(name) for name in controls]] = np.clip(values, 0, 1)
    real = Aperture(take.times, np.where(take.valid, take.aperture, np.nan))
    return correlation(real, Aperture(take.times, head.aperture_curve(weights)), take.track)
