"""Pictures of a head, or of any other mesh with blendshapes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Literal, Protocol, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.face.head import Head
from lipwright.face.mesh import Mesh
from lipwright.face.neck import turn_shares, turned
from lipwright.face.png import write_png
from lipwright.face.shading import Camera, View

Backend = Literal["auto", "gl", "software"]


class Painter(Protocol):
    """A way of drawing a posed mesh."""

    def paint(self, vertices: NDArray[np.float32]) -> NDArray[np.uint8]:
        """The picture (H, W, 3) of the posed `vertices` (V, 3)."""

    def close(self) -> None:
        """Give back what the painter holds."""


class Renderer:
    """Draws poses of one mesh at one size; a context manager.

    Attributes:
        backend: "gl" or "software", whichever draws.
    """

    def __init__(
        self,
        mesh: Mesh,
        width: int = 512,
        height: int = 512,
        backend: Backend = "auto",
        view: View | Camera = "face",
    ) -> None:
        """Prepare to draw `mesh`.

        Args:
            mesh: the head, or another character.
            width: of the pictures in pixels.
            height: of the pictures in pixels.
            backend: "gl", "software", or "auto" for software where OpenGL does not work.
            view: the whole face, the mouth from near by, or a camera of your own.

        Raises:
            LipwrightError: "gl" was asked for and does not work.
        """
        self._mesh = mesh
        self._shares = turn_shares(mesh) if isinstance(mesh, Head) else None
        self._painter, self.backend = _painter(mesh, width, height, backend, view)

    def render(self, weights: ArrayLike, turn: ArrayLike | None = None) -> NDArray[np.uint8]:
        """The picture (H, W, 3), sRGB, of one pose.

        Args:
            weights: (C,), in the order of the mesh's `shape_names`.
            turn: yaw, pitch and roll of `controls.HEAD_ANGLES` in radians; the neck follows and
                the shirt stays. Other characters than our head have no joint and do not turn.
        """
        vertices = self._mesh.pose(weights)
        if turn is not None and self._shares is not None:
            vertices = turned(vertices, self._shares, turn)
        return self.draw(vertices)

    def draw(self, vertices: NDArray[np.float32]) -> NDArray[np.uint8]:
        """The picture (H, W, 3), sRGB, of the mesh with its `vertices` (V, 3) anywhere, m."""
        return self._painter.paint(vertices)

    def close(self) -> None:
        """Give back the graphics context; no picture can be drawn afterwards."""
        self._painter.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def _painter(
    mesh: Mesh, width: int, height: int, backend: Backend, view: View | Camera
) -> tuple[Painter, str]:
    if backend != "software":
        try:
            from lipwright.face.render_gl import GlPainter

            return GlPainter(mesh, width, height, view), "gl"
        except Exception as error:  # drivers fail in many ways, with many kinds of exception
            if backend == "gl":
                raise LipwrightError(
                    f"OpenGL does not work here ({error}); use the software renderer instead"
                ) from error
    from lipwright.face.render_software import SoftwarePainter

    return SoftwarePainter(mesh, width, height, view), "software"


def pose_weights(**controls: float) -> NDArray[np.float32]:
    """Weights (C,) with the named controls set and all others at rest.

    Raises:
        ValueError: a name is not a canonical control.
    """
    weights = np.zeros(len(CANONICAL), np.float32)
    for name, value in controls.items():
        if name not in CANONICAL:
            raise ValueError(f"{name} is not a canonical control; see lipwright.controls.CANONICAL")
        weights[CANONICAL.index(name)] = value
    return weights


def render_contact_sheet(
    head: Head,
    poses: Sequence[Mapping[str, float]],
    path: str | Path,
    *,
    columns: int = 4,
    size: int = 384,
    view: View = "face",
    backend: Backend = "auto",
) -> None:
    """Write one PNG with a picture of each pose, row by row.

    Args:
        head: the head.
        poses: control to weight, for each picture.
        path: the PNG file.
        columns: pictures in a row.
        size: width and height of each in pixels.
        view: the whole face, or the mouth.
        backend: as for `Renderer`.

    Raises:
        LipwrightError: the file cannot be written.
        ValueError: there are no poses, or one names an unknown control.
    """
    if not poses:
        raise ValueError("a contact sheet needs at least one pose")
    with Renderer(head, size, size, backend, view) as renderer:
        tiles = [renderer.render(pose_weights(**pose)) for pose in poses]
    columns = min(columns, len(tiles))
    tiles += [np.zeros_like(tiles[0])] * (-len(tiles) % columns)
    rows = [np.hstack(tiles[i : i + columns]) for i in range(0, len(tiles), columns)]
    write_png(path, np.vstack(rows))
