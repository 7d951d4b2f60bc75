"""What lies over the speech: intensities, expressions and life, as options of a command."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from lipwright.clip import Clip


@dataclass(frozen=True)
class Layers:
    """The layers that a command line asks for."""

    intensity: float
    """of jaw and lips throughout"""
    intensities: Mapping[str, float]
    """of controls, parts of the face and classes of phones"""
    expressions: tuple[tuple[Clip, float], ...]
    """each with its amount"""
    life: float
    """1 with --life, else 0"""
    seed: int


def layer_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Options of commands that make motion; they arrive as `layers`."""

    @click.option(
        "--intensity",
        "amounts",
        multiple=True,
        metavar="[NAME=]AMOUNT",
        help="0.5 mumbles, 1.5 over-articulates; NAME: a control, a part of the face or a class of "
        "phones. Repeat for several.  [default: 1]",
    )
    @click.option(
        "--expression",
        "faces",
        multiple=True,
        metavar="NAME|FILE[=AMOUNT]",
        help="Expression over the speech: happy, sad, angry, ... or a file. Repeat for several.",
    )
    @click.option("--life", is_flag=True, help="Blinks, glances, brows and head motion.")
    @click.option("--seed", type=int, default=0, show_default=True, help="Which of many lives.")
    @functools.wraps(command)
    def inner(
        *arguments: Any, amounts: tuple[str, ...], faces: tuple[str, ...], life: bool, seed: int,
        **more: Any,
    ) -> Any:  # fmt: skip
        from lipwright.expressions import parse_expression
        from lipwright.passes import parse_intensities

        amount, named = parse_intensities(amounts)
        shown = tuple(parse_expression(face) for face in faces)
        layers = Layers(amount, named, shown, float(life), seed)
        return command(*arguments, layers=layers, **more)

    return inner
