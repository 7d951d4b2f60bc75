"""Who performs without being trained by the benchmark: found and checked before anything is."""

from __future__ import annotations

from collections.abc import Sequence

from lipwright.benchmark.curve_folders import read_curves
from lipwright.benchmark.entrants import Entrant
from lipwright.benchmark.motion import Performer
from lipwright.benchmark.scoring import Stage
from lipwright.benchmark.variants import Variant
from lipwright.dataset.folder import Dataset
from lipwright.errors import LipwrightError
from lipwright.evaluate.errors import frame_errors
from lipwright.network import find_model
from lipwright.network.folder import read_meta


def ready_performers(
    entrants: Sequence[Entrant], dataset: Dataset, variant: Variant, stage: Stage
) -> dict[str, Performer]:
    """Name to performer of all that are not trained here, but who has heard the unseen words.

    Raises:
        LipwrightError: a folder of curves lacks a recording, or has what cannot be measured.
    """
    found = {}
    for one in entrants:
        if one.config is not None or (variant.name == "unseen" and _has_heard(one, dataset)):
            continue
        curves = None if one.folder is None else read_curves(one.folder, variant.recordings)
        found[one.name] = Performer(one, one.model, curves)
        if curves is not None:
            _check_modes(found[one.name], stage)
    return found


def _check_modes(performer: Performer, stage: Stage) -> None:
    """Refuse curves of modes that the reference face has not."""
    for recording, truth in zip(stage.recordings, stage.truths, strict=True):
        modes = performer.perform(recording, stage.bridge).modes
        try:
            frame_errors(stage.face, truth, modes, only=())
        except LipwrightError as error:
            raise LipwrightError(f"{performer.entrant.folder}: {error}") from error


def _has_heard(entrant: Entrant, dataset: Dataset) -> bool:
    """Whether a model that was not trained here learnt from this dataset."""
    if entrant.kind != "shipped" or entrant.model is None:
        return False
    name = str(dataset.manifest.get("name", "")) or dataset.path.name
    return read_meta(find_model(entrant.model)).data.split(":")[0] == name
