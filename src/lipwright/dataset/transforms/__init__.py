"""What was done to the data before a network learnt from it, and how to undo it.

Each transform of the thesis (sections 4.2.1 and 4.2.2) is a small value with `apply` and
`invert`; `Transforms` is a chain of them that can be kept as JSON beside a model.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from types import MappingProxyType
from typing import Any, Final

from lipwright.dataset.transforms.inputs import PHONE_CLASSES, MergePhones
from lipwright.dataset.transforms.outputs import (
    THESIS_CONTROLS,
    THESIS_PRUNED,
    MergeSides,
    Prune,
    ZeroCentre,
    smape,
    unpredictable,
)
from lipwright.dataset.transforms.sample import Random, Sample, Transform, sample_of
from lipwright.dataset.transforms.timing import EditFrames, Resample, TimeShift
from lipwright.errors import LipwrightError

__all__ = [
    "PHONE_CLASSES", "THESIS_CONTROLS", "THESIS_PRUNED", "TRANSFORMS", "EditFrames",
    "MergePhones", "MergeSides", "Prune", "Resample", "Sample", "TimeShift", "Transform",
    "Transforms", "ZeroCentre", "build_transforms", "sample_of", "smape", "unpredictable",
]  # fmt: skip

TRANSFORMS: Final[Mapping[str, type[Any]]] = MappingProxyType({
    made.kind: made
    for made in (MergeSides, Prune, ZeroCentre, Resample, TimeShift, EditFrames, MergePhones)
})  # fmt: skip
"""kind to class"""


@dataclass(frozen=True)
class Transforms:
    """Transforms in the order in which they are applied."""

    steps: tuple[Transform, ...] = ()

    def apply(self, sample: Sample, random: Random | None = None) -> tuple[Sample, tuple[Any, ...]]:
        """The sample after all steps, and a record for each of them.

        Args:
            sample: the sample.
            random: for steps that draw lots; without it they change nothing.
        """
        records = []
        for step in self.steps:
            sample, record = step.apply(sample, random)
            records.append(record)
        return sample, tuple(records)

    def invert(self, sample: Sample, records: tuple[Any, ...] | None = None) -> Sample:
        """The sample before all steps; the last is undone first.

        Raises:
            ValueError: there is not one record for each step.
        """
        records = (None,) * len(self.steps) if records is None else records
        if len(records) != len(self.steps):
            raise ValueError(f"{len(records)} records for {len(self.steps)} transforms")
        for step, record in zip(reversed(self.steps), reversed(records), strict=True):
            sample = step.invert(sample, record)
        return sample

    def describe(self) -> list[dict[str, Any]]:
        """The steps as values of JSON; `build_transforms` makes the same chain of them."""
        return [{"kind": step.kind, **asdict(step)} for step in self.steps]  # type: ignore[call-overload]


def build_transforms(described: Any, source: str = "transforms") -> Transforms:
    """The chain that `describe` told of, before or after JSON.

    Args:
        described: a list with a kind and its options for each step.
        source: what errors name.

    Raises:
        LipwrightError: an unknown kind or option, or a value that cannot be.
    """
    if not isinstance(described, list):
        raise LipwrightError(f"{source}: not a list of transforms")
    return Transforms(
        tuple(_build(step, f"{source}: step {i}") for i, step in enumerate(described, 1))
    )


def _build(step: Any, place: str) -> Transform:
    kind = step.get("kind") if isinstance(step, dict) else None
    if not isinstance(kind, str) or kind not in TRANSFORMS:
        raise LipwrightError(f"{place}: kind {kind!r} is not one of: {', '.join(TRANSFORMS)}")
    made = TRANSFORMS[kind]
    options = {key: value for key, value in step.items() if key != "kind"}
    known = [field.name for field in fields(made)]
    for key in options:
        if key not in known:
            raise LipwrightError(f"{place}: {kind} has no {key!r}; it has: {', '.join(known)}")
    try:
        transform: Transform = made(**options)
    except (TypeError, ValueError) as error:
        raise LipwrightError(f"{place}: {kind}: {error}") from error
    return transform
