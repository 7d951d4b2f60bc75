"""Pictures of a mesh on numpy alone, for machines without OpenGL.

Light is computed at the vertices and interpolated, except the sharp highlights of the eyes.
The picture is sampled four times a pixel; the shading is done once a pixel where all four
samples lie on one part.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.face.materials import srgb_to_linear
from lipwright.face.mesh import Mesh
from lipwright.face.raster import barycentric, rasterise
from lipwright.face.shading import (
    LIGHTS,
    SURFACES,
    Camera,
    Surface,
    VertexLight,
    View,
    background,
    camera_of,
    encode,
    unit,
)

Floats = NDArray[np.float32]
Integers = NDArray[np.int32]

GRID: Final = 2  # samples a pixel along each axis
_GRID_STEPS: Final = [(i, j) for i in range(GRID) for j in range(GRID)]


class SoftwarePainter:
    """Draws a posed mesh without any graphics driver."""

    def __init__(self, mesh: Mesh, width: int, height: int, view: View | Camera) -> None:
        """Prepare what does not change."""
        self._mesh = mesh
        self._size = (width, height)
        camera = camera_of(view)
        self._matrix = camera.matrix(width / height).astype(np.float32)
        self._eye = np.array(camera.eye, np.float32)
        self._texture = _shrunk(
            srgb_to_linear(mesh.texture), _texels_per_pixel(mesh, camera, height)
        )
        self._empty = encode(background(width, height)).reshape(-1, 3)
        self._light = VertexLight(mesh, view)
        self._part_of = np.zeros(len(mesh.triangles), np.int8)
        self._two_sided = np.zeros(len(mesh.triangles), bool)
        for number, part in enumerate(mesh.parts):
            self._part_of[part.triangles] = number
            self._two_sided[part.triangles] = part.material.double_sided

    def paint(self, vertices: NDArray[np.float32]) -> NDArray[np.uint8]:
        """The picture (H, W, 3) of the posed `vertices` (V, 3)."""
        width, height = self._size
        points = self._project(vertices)
        drawn = self._facing(points)
        triangles = self._mesh.triangles[drawn]
        covered, chosen = rasterise(points, triangles, width * GRID, height * GRID)
        whole, mixed, samples = self._gather(covered, self._part_of[drawn[chosen]])
        filled = samples >= 0
        wanted = np.concatenate([whole[1], samples[filled]])
        corners, places = chosen[wanted], covered[wanted]
        shares = barycentric(points, triangles, places, corners, width * GRID)
        part = self._part_of[drawn[corners]]
        colors = self._shade(vertices, triangles[corners], shares, part)
        picture = self._empty.copy()
        picture[whole[0]] = colors[: len(whole[0])]
        edge = np.repeat(self._empty[mixed][:, None], GRID**2, axis=1)
        edge[filled] = colors[len(whole[0]) :]
        picture[mixed] = edge.mean(axis=1)
        return np.asarray(np.rint(picture * 255), np.uint8).reshape(height, width, 3)

    def _gather(
        self, covered: Integers, parts: NDArray[np.int8]
    ) -> tuple[tuple[NDArray[np.intp], Integers], NDArray[np.intp], Integers]:
        """Which pixels lie on one part and which on several.

        Returns:
            The pixels on one part with one covered sample of each; the pixels on several; and
            the covered samples (n, 4) of these, -1 where the background is seen.
        """
        width, height = self._size
        part = np.full(width * height * GRID**2, -1, np.int8)
        part[covered] = parts
        number = np.full(width * height * GRID**2, -1, np.int32)
        number[covered] = np.arange(len(covered), dtype=np.int32)
        shape = (height * GRID, width * GRID)
        first, *rest = (part.reshape(shape)[i::GRID, j::GRID] for i, j in _GRID_STEPS)
        alike = np.logical_and.reduce([first == other for other in rest])
        empty = alike & (first < 0)
        samples = [number.reshape(shape)[i::GRID, j::GRID] for i, j in _GRID_STEPS]
        whole = np.flatnonzero(alike & ~empty)
        mixed = np.flatnonzero(~alike)
        return (
            (whole, samples[0].ravel()[whole]),
            mixed,
            np.stack([sample.ravel()[mixed] for sample in samples], axis=1),
        )

    def close(self) -> None:
        """Nothing is held."""

    def _project(self, vertices: Floats) -> Floats:
        """Places in samples from the top left corner, and depth (V, 3)."""
        clip = vertices @ self._matrix[:, :3].T + self._matrix[:, 3]
        points = clip[:, :3] / clip[:, 3:]
        width, height = self._size
        points[:, 0] = (points[:, 0] + 1) * (width * GRID / 2)
        points[:, 1] = (1 - points[:, 1]) * (height * GRID / 2)
        return points

    def _facing(self, points: Floats) -> NDArray[np.int64]:
        """The triangles that can be seen: those that face us, and all of two-sided parts."""
        a, b, c = (points[self._mesh.triangles[:, k], :2] for k in range(3))
        area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (c[:, 0] - a[:, 0]) * (b[:, 1] - a[:, 1])
        return np.flatnonzero(self._two_sided | (area < 0))

    def _shade(
        self, vertices: Floats, corners: Integers, shares: Floats, part: NDArray[np.int8]
    ) -> Floats:
        """SRGB 0 to 1 (n, 3) at `shares` (n, 3) of the triangles `corners` (n, 3)."""
        normals = self._mesh.normals(vertices)
        values = np.concatenate([self._light.fall(vertices, normals), self._mesh.uvs], axis=1)
        mixed = np.zeros((len(corners), values.shape[1]), np.float32)
        for corner in range(3):
            mixed += values[corners[:, corner]] * shares[:, corner : corner + 1]
        color = self._sample(mixed[:, 6:]) * mixed[:, :3] + mixed[:, 3:6]
        for number, piece in enumerate(self._mesh.parts):
            surface = SURFACES[piece.material_name]
            if surface.highlight is not None:
                here = np.flatnonzero(part == number)
                place, normal, tint = (
                    np.einsum("nk,nkc->nc", shares[here], array[corners[here]])
                    for array in (vertices, normals, self._mesh.tints)
                )
                color[here] += self._highlight(surface, place, normal, tint)
        return encode(color)

    def _highlight(
        self, surface: Surface, places: Floats, normals: Floats, tints: Floats
    ) -> Floats:
        """A sharp highlight (n, 3), linear RGB."""
        view = self._eye - places
        view /= np.linalg.norm(view, axis=1, keepdims=True)
        half = view + np.array(unit(surface.highlight or LIGHTS[0].direction), np.float32)
        lengths = np.linalg.norm(half, axis=1) * np.linalg.norm(normals, axis=1)
        cosine = np.maximum(np.einsum("nc,nc->n", normals, half) / lengths, 0)
        shine = surface.gloss * cosine**surface.power * np.minimum(4 * tints[:, 0], 1)
        return np.asarray(shine[:, None] * np.array(LIGHTS[0].color, np.float32))

    def _sample(self, uvs: Floats) -> Floats:
        """Linear RGB (n, 3) of the texture at `uvs` (n, 2), nearest texel."""
        height, width = self._texture.shape[:2]
        row = np.clip(uvs[:, 1] * height, 0, height - 1).astype(np.int32)
        column = np.clip(uvs[:, 0] * width, 0, width - 1).astype(np.int32)
        return np.asarray(self._texture.reshape(-1, 3)[row * width + column])


def _texels_per_pixel(mesh: Mesh, camera: Camera, height: int) -> float:
    """How many rows of the texture fall on a row of the picture, on the usual triangle."""
    places = mesh.vertices[mesh.triangles]
    spots = mesh.uvs[mesh.triangles] * np.array(mesh.texture.shape[1::-1])
    one, other = spots[:, 1] - spots[:, 0], spots[:, 2] - spots[:, 0]
    texels = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
    area = np.linalg.norm(
        np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]), axis=1
    )
    textured = (texels > 0) & (area > 0)
    if not textured.any():
        return 0.0
    texels_per_m = float(np.median(np.sqrt(texels[textured] / area[textured])))
    seen = 2 * math.dist(camera.eye, camera.target) * math.tan(math.radians(camera.field_deg) / 2)
    return texels_per_m * seen / height


def _shrunk(texture: Floats, texels_per_pixel: float) -> Floats:
    """The texture at the size at which a texel is about a pixel."""
    while texels_per_pixel > 1.4:
        height, width = texture.shape[:2]
        texture = texture.reshape(height // 2, 2, width // 2, 2, 3).mean(axis=(1, 3))
        texels_per_pixel /= 2
    return np.ascontiguousarray(texture)
