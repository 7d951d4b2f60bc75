"""The crab: shell, claws, legs, eyes, teeth and tongue, and its eight poses."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Final

import numpy as np
from crab.body import claws, eyes, legs, paint_shell, rim
from crab.forms import Form, Vectors, block, closed, tube
from crab.mouth import MIDDLE, face_depth, outlines, surface

from lipwright.face.easing import smooth_step
from lipwright.face.mesh import Mesh
from lipwright.face.occlusion import openness, smoothed, unit_normals
from lipwright.face.pieces import Piece, assemble_mesh
from lipwright.face.shading import Camera

POSES: Final = (
    "bare teeth", "frown", "smile", "mouth open", "mouth OO",
    "tongue up", "tongue down", "tongue out",
)  # fmt: skip
CAMERA: Final = Camera((0.0, 0.24, 1.28), (0.0, 0.014, 0.02), 12.3)
"""shows all of the crab in a picture of 4 to 3, from a little above"""

JAW_M: Final = np.array([0.0, -0.024, -0.012])  # how "mouth open" moves lower teeth and tongue
TOOTH_M: Final = (0.0068, 0.0062, 0.0052)  # half widths, from the middle outwards
TOOTH: Final = (0.86, 0.80, 0.66)
GUM: Final = (0.42, 0.07, 0.07)
TONGUE: Final = (0.86, 0.20, 0.20)


@cache
def crab() -> Mesh:
    """The crab; made once."""
    pieces = [front(), *teeth(), tongue(), *eyes(), *claws(), *legs()]
    shade(pieces)
    return assemble_mesh(
        pieces, POSES, name="crab", source="made by examples/crab/model.py", license="Apache-2.0"
    )


def front() -> Piece:
    """Shell, lips and the inside of the mouth."""
    drawn = {name: surface(outline) for name, outline in outlines().items()}
    rest = drawn.pop("")
    form = closed(rest)
    stand = rim(form.vertices)
    shapes = {name: closed(rings).vertices - form.vertices for name, rings in drawn.items()}
    vertices = form.vertices + stand
    tints = paint_shell(form.vertices)
    return Piece("shell", "shell", vertices, form.triangles, shapes, tints=tints)


def teeth() -> list[Piece]:
    """Both rows with their gums, shut at rest; the lower row goes with the jaw."""
    pieces = []
    for name, up, jaw in (("teethUpper", 1.0, 0.0), ("teethLower", -1.0, 1.0)):
        forms, tints = [], []
        at = 0.0
        for half in TOOTH_M:
            at += half
            for x in (-at, at):
                height = 0.0088 - 0.05 * (at - TOOTH_M[0])
                y = MIDDLE + up * (height + 0.0002) + 0.1 * (at - TOOTH_M[0])
                depth = float(face_depth(np.array(x), np.array(y))) - 0.0105 - 5 * at**2
                forms.append(block((x, y, depth), (half * 0.965, height, 0.0034), power=4.5))
                tints.append(TOOTH)
            at += half
        x = np.linspace(-at, at, 24)
        y = MIDDLE + up * 0.0165 + 0.1 * np.abs(x)
        gum = np.column_stack([x, y, face_depth(x, y) - 0.0112 - 5 * x**2])
        forms.append(tube(gum, 0.0050, 0.0052))
        tints.append(GUM)
        form = joined(forms)
        colors = np.concatenate(
            [np.tile(tint, (len(f.vertices), 1)) for tint, f in zip(tints, forms, strict=True)]
        )
        still = np.zeros_like(form.vertices)
        # Behind a round mouth the rows part and draw back, out of sight.
        shapes = {
            "mouth open": still + jaw * JAW_M,
            "mouth OO": still + np.array([0.0, 0.018 * up - 0.006, -0.014]),
        }
        pieces.append(Piece(name, "teeth", form.vertices, form.triangles, shapes, tints=colors))
    return pieces


def joined(forms: list[Form]) -> Form:
    """Several forms as one."""
    starts = np.cumsum([0, *(len(form.vertices) for form in forms)])
    return Form(
        np.concatenate([form.vertices for form in forms]),
        np.concatenate([f.triangles + s for f, s in zip(forms, starts, strict=False)]),
    )


def tongue() -> Piece:
    """The tongue; where its poses take it holds for a mouth that is half open."""
    share = np.linspace(0, 1, 26)
    back, rise = 0.008 + 0 * share, 0.006 * np.sin(np.pi * share)
    spines = {
        "": (MIDDLE - 0.010 + rise, back + 0.039 * share),
        "tongue up": (MIDDLE - 0.012 + 0.026 * share**1.8, back + 0.036 * share),
        "tongue down": (MIDDLE - 0.011 - 0.012 * share**1.4, back + 0.038 * share),
        "tongue out": (
            MIDDLE - 0.010 + 0.014 * smooth_step(0.0, 0.5, share)
            - 0.030 * np.clip((share - 0.62) / 0.38, 0, 1) ** 1.6,
            back + 0.094 * share - 0.008 * share**6,
        ),
    }  # fmt: skip
    drawn = {name: _tongue(y, z, share) for name, (y, z) in spines.items()}
    rest = drawn.pop("")
    shapes = {name: form.vertices - rest.vertices for name, form in drawn.items()}
    shapes["mouth open"] = np.tile(JAW_M, (len(rest.vertices), 1))
    shapes["mouth OO"] = np.tile([0.0, -0.020, -0.020], (len(rest.vertices), 1))
    groove = np.exp(-((rest.vertices[:, 0] / 0.003) ** 2))[:, None]
    tints = np.array(TONGUE) * (1 - 0.35 * groove)
    return Piece("tongue", "tongue", rest.vertices, rest.triangles, shapes, tints=tints)


def _tongue(y: Vectors, z: Vectors, share: Vectors) -> Form:
    round_tip = np.sqrt(np.maximum(1 - np.clip((share - 0.72) / 0.28, 0, 1) ** 2, 0.01))
    path = np.column_stack([0 * y, y, z])
    return tube(path, 0.0185 * round_tip, 0.0052 * np.sqrt(round_tip), sides=32)


def shade(pieces: list[Piece]) -> None:
    """Darken the tints where little light comes, the mouth's inside as it is when it is open."""
    starts = np.cumsum([0, *(len(piece.vertices) for piece in pieces)])
    triangles = np.concatenate([p.triangles + s for p, s in zip(pieces, starts, strict=False)])
    light = [_light(pieces, triangles, weights) for weights in ({}, {"mouth open": 0.7})]
    for piece, start in zip(pieces, starts, strict=False):
        closed_light, open_light = (row[start : start + len(piece.vertices)] for row in light)
        inner = piece.name in {"teethUpper", "teethLower", "tongue"}
        mixed = 1.25 * open_light if inner else 0.5 * closed_light + 0.5 * open_light
        mixed = np.clip(mixed, 0.12 if inner else 0.05, 1)
        if inner:
            mixed = 0.45 + 0.55 * mixed
        piece.tints = piece.tints * mixed[:, None] ** np.array([0.75, 0.95, 1.0])


def _light(pieces: list[Piece], triangles: Vectors, weights: Mapping[str, float]) -> Vectors:
    """The share (V,) of the light from all around that reaches each vertex in a pose."""
    posed = np.concatenate(
        [
            p.vertices + sum((w * p.shapes.get(name, 0.0) for name, w in weights.items()), 0.0)
            for p in pieces
        ]
    )
    faces = triangles.astype(np.int32)
    return smoothed(openness(posed, unit_normals(posed, faces), faces), faces)
