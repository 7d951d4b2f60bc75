"""Camera, light and shade, the same for every way of drawing a mesh."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from lipwright.face.mesh import Mesh

View = Literal["face", "mouth"]
Floats = NDArray[np.float32]


@dataclass(frozen=True)
class Camera:
    """A perspective camera that stands level with or above what it looks at."""

    eye: tuple[float, float, float]
    """m"""
    target: tuple[float, float, float]
    """m"""
    field_deg: float
    """vertical field of view"""

    def matrix(self, aspect: float) -> NDArray[np.float64]:
        """Projection times view (4, 4) for pictures of width over height `aspect`."""
        eye, target = np.array(self.eye), np.array(self.target)
        forward = (target - eye) / np.linalg.norm(target - eye)
        right = np.cross(forward, [0.0, 1.0, 0.0])
        right /= np.linalg.norm(right)
        view = np.eye(4)
        view[:3, :3] = right, np.cross(right, forward), -forward
        view[:3, 3] = -view[:3, :3] @ eye
        scale = 1 / np.tan(np.radians(self.field_deg) / 2)
        near, far = 0.1, 4.0  # m
        projection = np.zeros((4, 4))
        scale *= min(aspect, 1.0)  # a tall picture shows as much to the sides as a square one
        projection[0, 0], projection[1, 1] = scale / aspect, scale
        projection[2, 2:] = (far + near) / (near - far), 2 * far * near / (near - far)
        projection[3, 2] = -1
        return np.asarray(projection @ view)


CAMERAS: Final = MappingProxyType(
    {
        # A portrait: from a little above the eyes, far enough away to flatter the nose.
        "face": Camera((0.0, 0.050, 1.30), (0.0, 0.006, 0.02), 13.9),
        "mouth": Camera((0.0, -0.015, 0.75), (0.0, -0.030, 0.09), 7.6),
    }
)


def camera_of(view: View | Camera) -> Camera:
    """The camera of a view of the head, or `view` itself."""
    return CAMERAS[view] if isinstance(view, str) else view


@dataclass(frozen=True)
class Light:
    """A distant light."""

    direction: tuple[float, float, float]
    """towards the light; any length"""
    color: tuple[float, float, float]
    """linear RGB"""


# A soft key from the upper left of the picture, a weak cool fill, and a rim from behind.
LIGHTS: Final = (
    Light((-0.55, 0.60, 0.75), (1.02, 0.95, 0.86)),
    Light((0.85, 0.10, 0.60), (0.26, 0.29, 0.34)),
    Light((0.65, 0.45, -0.75), (0.55, 0.52, 0.50)),
)
SKY: Final = (0.36, 0.37, 0.39)  # ambient light from above, linear RGB
GROUND: Final = (0.20, 0.165, 0.15)  # and from below
BACKGROUND: Final = ((0.115, 0.130, 0.150), (0.040, 0.045, 0.053))
"""linear RGB behind the middle of the head and in the corners"""


@dataclass(frozen=True)
class Surface:
    """What the shading needs to know of a material."""

    wrap: tuple[float, float, float]
    """how far light creeps round the edge of the shadow, by colour; skin lets red through"""
    gloss: float
    """strength of the highlight"""
    power: float
    """sharpness of the highlight"""
    highlight: tuple[float, float, float] | None = None
    """where the highlight's light is, if not at the key: eyes want theirs beside the pupil"""


SURFACES: Final = MappingProxyType(
    {
        "skin": Surface((0.42, 0.24, 0.18), 0.07, 14.0),
        "cloth": Surface((0.25, 0.25, 0.25), 0.012, 6.0),
        "mouth": Surface((0.3, 0.2, 0.2), 0.05, 20.0),
        "eye": Surface((0.35, 0.3, 0.3), 0.85, 420.0, (-0.34, 0.30, 1.0)),
        "teeth": Surface((0.4, 0.4, 0.4), 0.22, 40.0),
        "tongue": Surface((0.4, 0.25, 0.2), 0.16, 26.0),
        "shell": Surface((0.36, 0.22, 0.16), 0.24, 34.0),
        "lash": Surface((0.3, 0.3, 0.3), 0.0, 1.0),
    }
)


def unit(direction: tuple[float, float, float]) -> tuple[float, float, float]:
    """The same direction, of length 1."""
    length = sum(d * d for d in direction) ** 0.5
    x, y, z = (d / length for d in direction)
    return x, y, z


def background(width: int, height: int) -> Floats:
    """Linear RGB (height, width, 3): lighter behind the head, dark in the corners."""
    x = (np.arange(width) + 0.5) / width - 0.5
    y = (np.arange(height) + 0.5) / height - 0.45
    far = np.clip(np.hypot(x[None, :], y[:, None]) / 0.72, 0, 1)
    share = (far * far * (3 - 2 * far))[..., None]
    middle, corner = np.array(BACKGROUND)
    return np.asarray(middle + share * (corner - middle), np.float32)


class VertexLight:
    """The light that falls on a mesh, at its vertices, as one camera sees it."""

    def __init__(self, mesh: Mesh, view: View | Camera) -> None:
        """Gather the surfaces of the parts."""
        self._tints = mesh.tints
        self._eye = np.array(camera_of(view).eye, np.float32)
        self._wrap = np.zeros((len(mesh.vertices), 3), np.float32)
        self._gloss = np.zeros(len(mesh.vertices), np.float32)
        self._power = np.ones(len(mesh.vertices), np.float32)
        for part in mesh.parts:
            surface = SURFACES[part.material_name]
            self._wrap[part.vertices] = surface.wrap
            self._power[part.vertices] = surface.power
            if surface.highlight is None:
                self._gloss[part.vertices] = surface.gloss

    def fall(self, vertices: Floats, normals: Floats) -> Floats:
        """Light times tint, and highlights (V, 6), linear RGB; eyes want theirs added."""
        view = self._eye - vertices
        view /= np.sqrt(np.einsum("vc,vc->v", view, view))[:, None]
        away = np.minimum(np.einsum("vc,vc->v", normals, view), 0)
        normals = normals - 2 * away[:, None] * view
        sky, ground = np.array(SKY, np.float32), np.array(GROUND, np.float32)
        light = ground + (0.5 + 0.5 * normals[:, 1:2]) * (sky - ground)
        for source in LIGHTS:
            cosine = (normals @ np.array(unit(source.direction), np.float32))[:, None]
            lit = np.maximum((cosine + self._wrap) / (1 + self._wrap), 0)
            light += lit * np.array(source.color, np.float32)
        half = view + np.array(unit(LIGHTS[0].direction), np.float32)
        half /= np.sqrt(np.einsum("vc,vc->v", half, half))[:, None]
        cosine = np.maximum(np.einsum("vc,vc->v", normals, half), 0)
        shine = self._gloss * cosine**self._power * np.minimum(4 * self._tints[:, 0], 1)
        key = np.array(LIGHTS[0].color, np.float32)
        return np.concatenate([light * self._tints, shine[:, None] * key], axis=1)


def encode(light: Floats) -> Floats:
    """The sRGB values, 0 to 1, of linear light in its shape, to within half a step of 255; fast."""
    light = np.clip(light, 0, 1, dtype=np.float32)
    root = np.sqrt(light)
    fourth = np.sqrt(root)
    curve = 0.662002687 * root + 0.684122060 * fourth - 0.323583601 * np.sqrt(fourth)
    dark = light < 0.0031308
    return np.where(dark, 12.92 * light, curve - 0.0225411470 * light)
