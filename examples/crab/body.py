"""The crab's colours, claws, legs and eyes: all that does not move."""

from __future__ import annotations

from typing import Final

import numpy as np
from crab.forms import Form, Vectors, bend, block, closed, directions, facing, rounded, tube
from crab.mouth import COLUMNS, FIRST_LIP_RING, LIP_RINGS

from lipwright.face.easing import smooth_step
from lipwright.face.pieces import Piece

SHELL: Final = np.array([0.66, 0.085, 0.022])
FACE: Final = np.array([0.86, 0.24, 0.065])
RIM: Final = np.array([0.36, 0.030, 0.012])
SPOT: Final = np.array([0.90, 0.33, 0.075])
LIP: Final = np.array([0.52, 0.035, 0.030])
SEAM: Final = np.array([0.10, 0.008, 0.008])
THROAT: Final = np.array([0.16, 0.014, 0.016])
CLAW_TIP: Final = np.array([0.20, 0.022, 0.014])
WHITE: Final = np.array([0.88, 0.87, 0.82])
IRIS: Final = np.array([0.055, 0.24, 0.30])
PUPIL: Final = np.array([0.006, 0.006, 0.008])

RIM_M: Final = 0.0050  # how far the shell's edge stands out
SPOTS: Final = (
    # x and z of the spots on the shell's top, and their radius, m
    (-0.052, 0.018, 0.0085), (-0.070, -0.006, 0.0060), (-0.034, -0.004, 0.0055),
    (0.055, 0.012, 0.0075), (0.038, -0.010, 0.0065), (0.071, -0.012, 0.0055),
    (0.004, 0.030, 0.0070), (-0.012, 0.006, 0.0050), (0.016, -0.028, 0.0080),
    (-0.050, -0.032, 0.0075), (0.022, 0.012, 0.0045), (0.060, 0.034, 0.0050),
    (-0.022, 0.042, 0.0048), (-0.076, 0.026, 0.0050),
)  # fmt: skip

EYE_M: Final = 0.0230  # radius
EYE: Final = np.array([0.038, 0.104, 0.034])  # the left one
LOOK: Final = np.array([-0.040, 0.10, 1.0])  # and where it looks
LEGS: Final = (
    # z of root, knee and foot, and how far out the knee is, m
    (0.030, 0.062, 0.075, 0.128), (0.010, 0.026, 0.030, 0.142),
    (-0.012, -0.014, -0.018, 0.142), (-0.032, -0.050, -0.062, 0.130),
)  # fmt: skip


def rim_height(x: Vectors, z: Vectors) -> Vectors:
    """Y of the shell's edge, which arches over the mouth."""
    front = smooth_step(0.0, 0.05, z)
    return np.asarray(0.006 + 0.026 * front * smooth_step(0.095, 0.045, np.abs(x)))


def rim(vertices: Vectors) -> Vectors:
    """How the edge stands out from the bare shell `vertices` (V, 3): displacements, m."""
    x, y, z = vertices.T
    near = np.exp(-(((y - rim_height(x, z)) / 0.0062) ** 2))
    outside = np.linalg.norm(vertices / [0.096, 0.066, 0.066], axis=1) > 0.97
    knobs = 1 + 0.35 * np.cos(26 * np.arctan2(z, x)) * smooth_step(0.05, 0.08, np.abs(x))
    outwards = np.column_stack([x, 0.25 * np.abs(x), z])
    outwards /= np.maximum(np.linalg.norm(outwards, axis=1, keepdims=True), 1e-9)
    return np.asarray((RIM_M * near * knobs * outside)[:, None] * outwards)


def paint_shell(vertices: Vectors) -> Vectors:
    """Linear RGB (V, 3) of the front's rings and poles."""
    x, y, z = vertices.T
    above = y - rim_height(x, z)
    tints = _mix(FACE, SHELL, smooth_step(-0.001, 0.004, above))
    tints = _mix(tints, FACE * [0.92, 0.75, 0.8], smooth_step(-0.040, -0.066, y))
    for spot_x, spot_z, radius in SPOTS:
        away = np.hypot(x - spot_x, (z - spot_z) * 1.0)
        inside = smooth_step(radius * 1.25, radius * 0.85, away) * smooth_step(0.008, 0.014, above)
        tints = _mix(tints, SPOT, inside)
    tints = _mix(tints, RIM, np.exp(-(((above - 0.001) / 0.0040) ** 2)))
    ring = np.arange(len(vertices)) // COLUMNS
    ring[-2:] = 0, ring.max()
    lip = ring - FIRST_LIP_RING
    tints = np.where(((lip >= 0) & (lip < LIP_RINGS))[:, None], LIP, tints)
    tints = np.where((lip == LIP_RINGS - 1)[:, None], 0.5 * LIP + 0.5 * FACE, tints)
    tints = np.where(((lip == 0) | (lip == -1))[:, None], SEAM, tints)
    return np.where((lip < -1)[:, None], THROAT, tints)


def _mix(below: Vectors, above: Vectors, share: Vectors) -> Vectors:
    return np.asarray(below + share[:, None] * (above - below))


def _both_sides(name: str, material: str, left: Piece) -> list[Piece]:
    """`left` and its mirror image."""
    flip = np.array([-1.0, 1.0, 1.0])
    return [
        Piece(f"{name}Left", material, left.vertices, left.triangles, {}, tints=left.tints),
        Piece(
            f"{name}Right", material, left.vertices * flip, left.triangles[:, ::-1], {},
            tints=left.tints,
        ),
    ]  # fmt: skip


def _plain(name: str, form: Form, tints: Vectors) -> Piece:
    colors = np.broadcast_to(tints, form.vertices.shape).copy()
    return Piece(name, "shell", form.vertices, form.triangles, {}, tints=colors)


def eyes() -> list[Piece]:
    """Stalks, balls and lids."""
    stalk = tube(
        bend((0.030, 0.042, 0.022), (0.034, 0.078, 0.020), EYE - [0, 0.008, 0.006]),
        np.linspace(0.0115, 0.0085, 14),
    )
    angles = np.concatenate([[4, 14, 24.9, 25.1, 31, 39.9, 40.1], np.arange(46, 178, 6)])
    ball = closed(EYE + EYE_M * directions(angles, 40) @ facing(LOOK))
    angle = np.append(np.repeat(angles, 40), [0.0, 180.0])
    tints = _mix(np.tile(WHITE, (len(angle), 1)), IRIS, (angle < 40) * 1.0)
    tints = _mix(tints, PUPIL, (angle < 25) * 1.0)
    lid = closed(
        EYE + 1.07 * EYE_M * directions(np.arange(6, 53, 5), 40) @ facing((0.25, 1, -0.22))
    )
    pieces = []
    pieces += _both_sides("stalk", "shell", _plain("stalk", stalk, SHELL))
    pieces += _both_sides("eye", "eye", Piece("", "eye", ball.vertices, ball.triangles, {}, tints))
    return pieces + _both_sides("lid", "shell", _plain("lid", lid, SHELL * 0.9))


def claws() -> list[Piece]:
    """An arm, a palm and two fingers on either side."""
    pieces = []
    palm = np.array([0.132, 0.040, 0.058])
    arm = tube(
        bend((0.076, -0.020, 0.030), (0.150, -0.050, 0.055), palm - [0, 0.012, 0], count=18),
        np.linspace(0.0125, 0.0105, 18),
    )
    pieces += _both_sides("arm", "shell", _plain("arm", arm, SHELL * 0.85))
    hand = block(palm + np.array([0, 0.012, 0]), (0.0225, 0.0270, 0.0175), power=2.2, columns=28)
    pieces += _both_sides("palm", "shell", _plain("palm", hand, SHELL))
    for name, points, thick in (
        ("finger", ((0.006, 0.012, 0), (0.046, 0.052, 0.002), (-0.004, 0.082, 0.004)), 0.0165),
        ("thumb", ((-0.010, 0.012, 0), (-0.038, 0.044, 0.002), (-0.016, 0.070, 0.004)), 0.0115),
    ):
        path = bend(*(palm + point for point in points), count=20)
        radii = rounded(thick * (1 - np.linspace(0, 1, 20) ** 1.6 * 0.86), 0.08)
        form = tube(path, radii, sides=18)
        tip = smooth_step(0.62, 0.92, np.append(np.repeat(np.linspace(0, 1, 20), 18), [0.0, 1.0]))
        tints = _mix(np.tile(SHELL, (len(tip), 1)), CLAW_TIP, tip)
        pieces += _both_sides(name, "shell", _plain(name, form, tints))
    return pieces


def legs() -> list[Piece]:
    """Four on either side."""
    pieces = []
    for number, (root, knee, foot, out) in enumerate(LEGS, start=1):
        upper = bend((0.070, -0.034, root), (out * 0.86, -0.010, knee), (out, -0.028, knee))
        lower = bend((out, -0.028, knee), (out + 0.014, -0.055, foot), (out + 0.004, -0.094, foot))
        path = np.concatenate([upper, lower[1:]])
        radii = np.interp(np.linspace(0, 1, len(path)), [0, 0.45, 0.55, 1], [92, 82, 66, 14]) / 1e4
        form = tube(path, radii, sides=12)
        share = np.append(np.repeat(np.linspace(0, 1, len(path)), 12), [0.0, 1.0])
        tints = _mix(np.tile(SHELL * 0.85, (len(share), 1)), CLAW_TIP, smooth_step(0.7, 1.0, share))
        pieces += _both_sides(f"leg{number}", "shell", _plain("leg", form, tints))
    return pieces
