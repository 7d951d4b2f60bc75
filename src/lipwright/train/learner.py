"""What learners that are no networks share: their configuration, and what they have learnt."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np
import numpy.typing as npt

from lipwright.network.meta import Kind, Target
from lipwright.phones import PHONES, SILENCE
from lipwright.train.config import need

if TYPE_CHECKING:
    from lipwright.features import FeatureSet
    from lipwright.train.takes import Corpus

Report = Callable[[str, float], None]

LEARNERS: Final = MappingProxyType({
    "hmm": "lipwright.train.hmm",
    "dynamic": "lipwright.train.dynamic",
    "trees": "lipwright.train.trees",
})  # fmt: skip
"""engine to the module that trains its models: it has `CONFIG`, a class of configurations, and
`fit`, a `Fit`"""


@dataclass(frozen=True, kw_only=True)
class LearnerConfig:
    """What every learner's configuration has.

    Raises:
        MisfitError: a value is out of range.
    """

    engine: str
    """of LEARNERS"""
    name: str
    targets: Target = "arkit"
    controls: tuple[str, ...] | None = None
    """of the targets; null for all that move in training, of arkit those of the lower face"""
    phones: tuple[str, ...] | None = None
    """that it tells apart; null for those heard in training"""
    fps: float | None = None
    """frames a second that it learns from; null for that of the dataset"""
    seed: int = 0
    comment: str = ""

    def __post_init__(self) -> None:
        """Check."""
        need(self.engine in LEARNERS, "engine", f"is {self.engine!r}, not {', '.join(LEARNERS)}")
        need(bool(self.name) and self.name.isprintable(), "name", "must be a name")
        need(self.fps is None or 1 <= self.fps <= 1000, "fps", "must be 1 to 1000, or null")
        need(0 <= self.seed <= 2**31, "seed", f"is {self.seed}, not 0 to {2**31}")
        named = self.controls
        need(named is None or bool(named), "controls", "must name one at least, or be null")
        need(named is None or len(set(named)) == len(named), "controls", "has a name twice")
        for phone in self.phones or ():
            need(phone in PHONES, "phones", f"has {phone!r}, which the phone table lacks")
        need(self.phones is None or SILENCE in self.phones, "phones", f"must have {SILENCE!r}")

    def to_json(self) -> dict[str, Any]:
        """Plain values, as `config_from` reads them."""
        return dict(json.loads(json.dumps(asdict(self))))


def silence_first(phones: Iterable[str]) -> tuple[str, ...]:
    """Each phone once, as feature sets want them."""
    return (SILENCE, *(phone for phone in dict.fromkeys(phones) if phone != SILENCE))


@dataclass(frozen=True, eq=False)
class Fitted:
    """What was learnt."""

    kind: Kind
    arrays: Mapping[str, npt.NDArray[Any]]
    """all that the engine needs besides meta.json; no objects"""
    features: FeatureSet
    """phones and frame rate, and what trees see"""
    notes: tuple[str, ...]
    """lines for the card: sizes of what was learnt, and how"""
    output_window: int = 1

    def __post_init__(self) -> None:
        """Check."""
        for name, array in self.arrays.items():
            if np.asarray(array).dtype.hasobject:
                raise ValueError(f"{name!r} has objects, which would be pickled")


class Fit(Protocol):
    """What a learner's module does."""

    def __call__(self, corpus: Corpus, config: Any, report: Report) -> Fitted:
        """Learn from the takes for training; the same corpus and seed give the same arrays.

        Args:
            corpus: takes by split; `targets` are as they come, `valid` says which frames count.
            config: of the module's class CONFIG.
            report: told "train" and how much of it is done, 0 to 1.

        Raises:
            LipwrightError: there is too little to learn from.
        """
        ...
