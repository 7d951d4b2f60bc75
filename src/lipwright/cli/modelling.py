"""`lipwright models`: what engines have learnt."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lipwright.cli.listing import json_option
from lipwright.cli.progress import say

if TYPE_CHECKING:
    from lipwright.network import ModelMeta

LIST_EXAMPLES = """\b
Example:
  lipwright models list
    lipwright: ARKit weights, 23 controls; raw, attributes, timing, sound; 57 frames at 50 a second
"""
INFO_EXAMPLES = """\b
Example:
  lipwright models info lipwright
    name: lipwright
    predicts: ARKit weights, 23 controls
"""
CHECK_EXAMPLES = """\b
Example:
  lipwright models check lipwright
    lipwright: whole, and gives its golden output
"""

MOST_LEVELS = 4  # of figures within figures

model_argument = click.argument("model")


@click.group(epilog="Each command has examples: lipwright models COMMAND --help")
def models() -> None:
    """List, describe and check the networks that speak: of this version, or your own."""


@models.command("list", epilog=LIST_EXAMPLES)
@json_option
def list_models(as_json: bool) -> None:
    """List the models that come with Lipwright."""
    from lipwright.network import shipped_models
    from lipwright.network.folder import read_meta

    metas = {name: read_meta(folder) for name, folder in shipped_models().items()}
    if as_json:
        click.echo(json.dumps({name: meta.to_json() for name, meta in metas.items()}, indent=1))
    elif not metas:
        click.echo("this version ships no model; train one with: lipwright train")
    for name, meta in () if as_json else metas.items():
        click.echo(f"{name}: {_predicts(meta)}; {_sees(meta)}")


@models.command(epilog=INFO_EXAMPLES)
@model_argument
@json_option
def info(model: str, as_json: bool) -> None:
    """Say what a model predicts, from what, how well, and on which terms."""
    from lipwright.network import find_model
    from lipwright.network.folder import read_meta

    folder = find_model(model)
    meta = read_meta(folder)
    if as_json:
        click.echo(json.dumps(meta.to_json(), indent=1))
        return
    for name, value in _summary(folder, meta):
        line = f"{name}: {value}"  # of a stranger's file: nothing in it may steer the terminal
        click.echo("".join(letter if letter.isprintable() else " " for letter in line))


@models.command(epilog=CHECK_EXAMPLES)
@model_argument
def check(model: str) -> None:
    """Find out whether a model is whole and gives the same here as where it was trained."""
    from lipwright.engines.golden import check_model

    check_model(model)
    say(f"{model}: whole, and gives its golden output")


def _predicts(meta: ModelMeta) -> str:
    from lipwright.network.meta import TARGETS

    return f"{TARGETS[meta.target]}, {len(meta.controls)} controls"


def _sees(meta: ModelMeta) -> str:
    features = meta.features
    return f"{', '.join(features.kinds)}; {features.window} frames at {features.fps:g} a second"


def _summary(folder: Path, meta: ModelMeta) -> Iterator[tuple[str, str]]:
    yield "name", meta.name
    yield "predicts", _predicts(meta)
    yield "sees", _sees(meta)
    count = len(meta.features.phones)
    yield "learnt", f"{count} phones; others take the mouth of one that looks like them"
    if meta.kind == "windows":
        size = meta.features.size
        yield "network", f"{size} numbers a window to {meta.output_window} frames of motion"
    elif meta.kind == "sequence":
        yield "network", f"a convolution over frames of {meta.features.frame_size} numbers"
    elif meta.kind == "recurrent":
        yield "network", f"recurrent, over all frames of {meta.features.frame_size} numbers"
    if (folder / meta.model_file).is_file():
        yield "size", f"{(folder / meta.model_file).stat().st_size / 1e6:.1f} MB"
    yield "trained", f"{meta.date}, by Lipwright {meta.lipwright}, on {meta.data}"
    yield "licence", meta.licence
    yield from _figures(meta.metrics)


def _figures(metrics: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, str]]:
    """The figures of nested metrics, one a line, named by their way in."""
    for name, value in metrics.items():
        if isinstance(value, Mapping) and path.count(", ") < MOST_LEVELS:
            yield from _figures(value, f"{path}{name}, ")
        else:
            yield f"{path}{name}", f"{value:.4g}" if isinstance(value, float) else str(value)
