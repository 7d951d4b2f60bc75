"""Which engine moves the face, as options of a command."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from lipwright.cli.progress import warn
from lipwright.engines import DEFAULT, ENGINES, OF_BIGRAMS

if TYPE_CHECKING:
    from lipwright.cli.layering import Layers
    from lipwright.cli.outputs import Wanted
    from lipwright.pipeline import AnimateOptions
    from lipwright.track import PhoneTrack

MOST_MISSING = 10  # pairs that are named; a set that is drawn in part lacks hundreds


@dataclass(frozen=True)
class Motion:
    """What a command line asks for."""

    engine: str | None
    model: str | None
    bigrams: str | None
    fps: float

    def options(self, layers: Layers, wanted: Wanted) -> AnimateOptions:
        """The options of the pipeline.

        Raises:
            LipwrightError: one is out of range, or they do not go together.
        """
        from lipwright.pipeline import AnimateOptions

        return AnimateOptions(
            engine=self.engine, model=self.model, bigrams=self.bigrams, fps=self.fps,
            rig=wanted.target, intensity=layers.intensity, intensities=layers.intensities,
            expressions=layers.expressions, life=layers.life, seed=layers.seed,
        )  # fmt: skip


def motion_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Options of commands that animate; they arrive as `motion`."""

    @click.option("--engine", help=f"What makes motion of phones: {', '.join(ENGINES)}.  [default: "
                  f"{DEFAULT}, or that of the model that is given; {OF_BIGRAMS} where a bigram "
                  "set is]")  # fmt: skip
    @click.option("--model", help="Name or folder of a model to run; see lipwright models.")
    @click.option("--bigrams", help="Name or file of a phone bigram set; see lipwright bigrams.")
    @click.option("--fps", type=float, default=60.0, show_default=True, help="Frames a second.")
    @functools.wraps(command)
    def inner(
        *arguments: Any, engine: str | None, model: str | None, bigrams: str | None, fps: float,
        **more: Any,
    ) -> Any:  # fmt: skip
        return command(*arguments, motion=Motion(engine, model, bigrams, fps), **more)

    return inner


def no_head(options: AnimateOptions) -> str:
    """Why what the options make moves no human head, and what can be done."""
    names = options.controls()
    if options.bigram_set is not None:
        return (
            f"{options.bigram_set.name} moves poses of a creature ({names[0]} to {names[-1]}), "
            "which no human head shows; write .csv or .json, as examples/07_crab.py does before it "
            "draws"
        )
    return (
        f"{options.model} predicts modes of a reference face ({names[0]} to {names[-1]}), which "
        "move no head; write .csv or .json for 'lipwright face overlay --params', name a --rig, "
        "or train one with: lipwright train --targets arkit"
    )


def report_missing(options: AnimateOptions, track: PhoneTrack, progress: str) -> None:
    """Name the pairs that a bigram set lacks, and what was said instead."""
    from lipwright.bigrams.coverage import pair_text
    from lipwright.bigrams.missing import missing

    bigrams = options.bigram_set
    if bigrams is None:
        return
    lacking = missing(bigrams, track)
    for pair, count, instead in lacking[:MOST_MISSING]:
        stand_in = "the mouth rests there" if instead is None else f"used {pair_text(instead)!r}"
        said = pair_text(pair)
        warn(f"{bigrams.name} has no pair {said!r} ({count} times); {stand_in}", progress)
    if len(lacking) > MOST_MISSING:
        warn(
            f"{bigrams.name} lacks {len(lacking) - MOST_MISSING} more pairs; see lipwright bigrams "
            "coverage",
            progress,
        )
