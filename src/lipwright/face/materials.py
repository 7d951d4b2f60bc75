"""Materials of characters, and sRGB to linear light and back."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Material:
    """How a part reflects light, in the terms of glTF's metallic-roughness model."""

    base_color: tuple[float, float, float]
    """linear RGB, 0 to 1; multiplies the colours of the vertices"""
    roughness: float
    """0 mirror, 1 dull"""
    metallic: float = 0.0
    double_sided: bool = False


WHITE: Final = (1.0, 1.0, 1.0)

MATERIALS: Final = MappingProxyType(
    {
        "skin": Material(WHITE, roughness=0.58),
        "cloth": Material(WHITE, roughness=0.9, double_sided=True),
        "mouth": Material(WHITE, roughness=0.45, double_sided=True),
        "eye": Material(WHITE, roughness=0.08),
        "teeth": Material(WHITE, roughness=0.25, double_sided=True),
        "tongue": Material(WHITE, roughness=0.4),
        "shell": Material(WHITE, roughness=0.38),
        "lash": Material(WHITE, roughness=0.9, double_sided=True),
    }
)
"""material name to material; colours differ by vertex, so that the base colour is white"""


def srgb_to_linear(pixels: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Linear light 0 to 1 of 8-bit sRGB values, in their shape."""
    return _SRGB_TABLE[pixels]


def linear_to_srgb(light: NDArray[np.floating]) -> NDArray[np.uint8]:
    """8-bit sRGB values of linear light, clipped to 0 to 1, in its shape."""
    light = np.clip(light, 0.0, 1.0)
    curve = np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.asarray(np.rint(curve * 255), np.uint8)


def _srgb_table() -> NDArray[np.float32]:
    value = np.arange(256) / 255  # IEC 61966-2-1
    curve = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    return np.asarray(curve, np.float32)


_SRGB_TABLE: Final = _srgb_table()
