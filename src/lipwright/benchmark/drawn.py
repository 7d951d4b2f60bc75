"""The apertures that a report draws: real lips and everybody's, of a few recordings."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from lipwright.benchmark.scoring import Performance, Stage, aperture_over_loud
from lipwright.benchmark.values import Curves
from lipwright.evaluate.heads import OUR_HEAD
from lipwright.evaluate.lips import Aperture

DRAWN: Final = 4  # recordings, the first of the stage


def drawn_curves(stage: Stage, found: Mapping[str, Performance]) -> tuple[Curves, ...]:
    """The curves of the first recordings."""
    return tuple(
        _curves(number, stage, found) for number in range(min(DRAWN, len(stage.recordings)))
    )


def _curves(number: int, stage: Stage, found: Mapping[str, Performance]) -> Curves:
    recording, reference = stage.recordings[number], stage.references[number]
    times = recording.times + recording.offset
    real = np.where(recording.valid, aperture_over_loud(reference, times), np.nan)
    estimated = {}
    for name, one in found.items():
        clip = one.moves[number].animated
        if clip is not None:
            estimated[name] = aperture_over_loud(
                Aperture(clip.times, stage.heads[OUR_HEAD](clip)), times
            )
    return Curves(
        recording.name, str(recording.info.get("text", "")).strip(), recording.track.phones,
        np.asarray(recording.track.edges), times, real, estimated,
    )  # fmt: skip
