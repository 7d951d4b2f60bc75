"""How phones become motion: engine, layers, passes and rig."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Final

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, HEAD_ANGLES
from lipwright.engines import OF_BIGRAMS, choose_engine, engine_controls, engine_learnt
from lipwright.errors import LipwrightError
from lipwright.export.performance import check_rate
from lipwright.passes import Pass, bigram_passes, default_passes, learnt_passes
from lipwright.rig import Rig, load_rig

if TYPE_CHECKING:
    from lipwright.bigrams.values import BigramSet

PathLike = str | os.PathLike[str]
Report = Callable[[str, float], None]
"""called with the stage's name and the share of it that is done, 0 to 1"""

_FOR_BIGRAMS: Final = (None, OF_BIGRAMS)


def quiet(stage: str, share: float) -> None:
    """A report that nobody reads."""
    del stage, share


@dataclass(frozen=True)
class AnimateOptions:
    """How phones become motion.

    Raises:
        LipwrightError: fps or intensity out of range, no such engine, or a model or bigram set
            for one that runs none.
    """

    engine: str | None = None
    """a name; by default `window` where a model is given, or else the default engine"""
    model: str | Path | None = None
    """of the engine `window`: the name of one that ships, or a model's folder"""
    bigrams: str | Path | BigramSet | None = None
    """of the engine `bigram`: the name of a set that ships, a set's file, or a set"""
    fps: float = 60.0
    """frames a second, 0.1 to 1000"""
    intensity: float = 1.0
    """0.5 mumbles, 1.5 over-articulates"""
    intensities: Mapping[str, float] = field(default_factory=dict)
    """amount by control, part of the face or class of phones; see `passes.intensities`"""
    expressions: tuple[tuple[Clip | Mapping[str, float], float], ...] = ()
    """poses or clips that lie over the speech, each with its amount; see `passes.expression`"""
    life: float = 0.0
    """blinks, glances, brows and head motion, 0 (none) to 2; 1 is usual"""
    seed: int = 0
    """which of many lives, from 0 on"""
    rig: str | Path | Rig | None = None
    """whom the curves move: the name of a rig that ships, a rig's file, or a rig; by default
    canonical controls stay"""
    passes: tuple[Pass, ...] | None = None
    """instead of the default passes; then intensities are not used"""

    def __post_init__(self) -> None:
        """Check."""
        if self.bigrams is not None and (self.model is not None or self.engine not in _FOR_BIGRAMS):
            other = "--model" if self.model is not None else f"the engine {self.engine}"
            raise LipwrightError(
                f"--bigrams is for the engine {OF_BIGRAMS}, not for {other}; leave one of them out"
            )
        choose_engine(*self.runs)
        check_rate(self.fps)
        if self.passes is None:
            default_passes(self.intensity, self.intensities)  # refuses what it cannot use
        if self.life or self.seed:
            from lipwright.life import check_life

            check_life(self.life, self.seed)

    @property
    def runs(self) -> tuple[str | None, str | Path | BigramSet | None]:
        """The engine, and the model or the bigram set that it runs; None for the default."""
        if self.bigrams is not None:
            return OF_BIGRAMS, self.bigrams
        return self.engine, self.model

    @cached_property
    def bigram_set(self) -> BigramSet | None:
        """The bigram set that is animated with; None with another engine.

        Raises:
            LipwrightError: the set cannot be used.
        """
        name, model = self.runs
        if choose_engine(name, model) != OF_BIGRAMS:
            return None
        from lipwright.engines.bigram import open_set

        return open_set(model)

    @cached_property
    def target(self) -> Rig | None:
        """The rig that the curves are retargeted to; None for none.

        Raises:
            LipwrightError: it cannot be used.
        """
        return self.rig if self.rig is None or isinstance(self.rig, Rig) else load_rig(self.rig)

    def controls(self) -> tuple[str, ...]:
        """The controls of the clips that `animate_track` makes.

        Canonical ones, or modes of a reference face, or poses of a creature.

        Raises:
            LipwrightError: the model or set cannot be used.
        """
        bigrams = self.bigram_set
        if bigrams is None:
            return engine_controls(*self.runs)
        rig = rig_of(bigrams)
        return CANONICAL if rig.looks else rig.names

    def refuse_layers(self, names: tuple[str, ...]) -> None:
        """Refuse expressions and life over curves that move no human head.

        Raises:
            LipwrightError: there are some.
        """
        if self.expressions or self.life:
            raise LipwrightError(
                f"expressions and life move canonical controls, and these curves are {names[0]} to "
                f"{names[-1]}; leave --expression and --life out"
            )

    def chosen_passes(self) -> tuple[Pass, ...]:
        """The passes to apply to what the engine gives, in order.

        Raises:
            LipwrightError: the model or set cannot be used.
        """
        if self.passes is not None:
            return self.passes
        bigrams = self.bigram_set
        if bigrams is not None:
            return tuple(bigram_passes(bigrams))
        phones, controls = engine_learnt(*self.runs)
        if not phones:
            return tuple(default_passes(self.intensity, self.intensities))
        return tuple(learnt_passes(self.intensity, phones, controls, self.intensities))


def rig_of(bigrams: BigramSet) -> Rig:
    """The rig whose controls are the poses of a bigram set.

    Raises:
        LipwrightError: the rig cannot be used, or lacks a pose of the set; names it.
    """
    who = f"the bigram set {bigrams.name!r}"
    try:
        rig = load_rig(bigrams.rig)
    except LipwrightError as error:
        raise LipwrightError(f"the rig of {who}: {error}") from error
    rig.check_controls(bigrams.poses, who)
    return rig


def moves_heads(names: Iterable[str]) -> bool:
    """Whether controls are canonical ones, which heads have, rather than modes of one speaker."""
    return set(names) <= {*CANONICAL, *HEAD_ANGLES}
