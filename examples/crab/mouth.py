"""The crab's front: shell, lips and the inside of the mouth in one surface, and its poses.

Every pose is the whole surface drawn anew around another outline of the mouth; its blendshape is
the difference from the rest pose. Columns go round the mouth from the crab's left corner over the
upper lip; rings go from deep inside over the lips and the shell to the middle of the back.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from crab.forms import Vectors
from numpy.typing import NDArray

from lipwright.face.easing import smooth_step

Row = NDArray[np.float64]

COLUMNS: Final = 160  # even: each column of the upper lip has one of the lower lip below it
HALF_M: Final = np.array([0.096, 0.066, 0.066])  # half axes of the shell
BULGE: Final = 2.5  # 2 is an ellipsoid, more a box
MIDDLE: Final = -0.008  # m, height of the mouth
WIDTH: Final = 0.046  # m, half the mouth's
LIP_M: Final = 0.0056  # half the height of a lip
LIP_RINGS: Final = 9
SHELL_RINGS: Final = 78
REACH_M: Final = 0.064  # how far from the lips the shell moves with them
STILL_M: Final = (0.050, 0.078)  # and how far to the side: in full, and not at all
LINING: Final = (
    # m outwards from where the lips meet, and m back from the face: the inside of the lips
    (0.0165, 0.0072), (0.0105, 0.0056), (0.0040, 0.0046), (0.0006, 0.0028),
)  # fmt: skip
CAVITY: Final = ((0.020, 0.012, -0.012), (0.042, 0.022, 0.004), (0.0485, 0.0275, 0.034))
"""half width, half height and z of the rings of the cavity from the back, m"""


@dataclass(frozen=True, eq=False)
class Outline:
    """Where the lips are in one pose; rows (N,) over the columns."""

    x: Row
    """m"""
    y: Row
    """m"""
    forward: float = 0.0
    """m that the lips stand out"""
    thickness: float = 1.0
    """of the lips, 1 as at rest"""
    roundness: float = 0.25
    """0 for lips above each other, 1 for a ring"""
    jaw: float = 0.0
    """m that the floor of the mouth sinks"""


def outlines() -> dict[str, Outline]:
    """The rest pose, named "", and the poses of the lips."""
    u, s = around()
    upper, lower = np.clip(s, 0, 1), np.clip(-s, 0, 1)
    rest = MIDDLE - 0.003 + 0.008 * u**2
    corners = np.abs(u) ** 2.2
    open_y = rest - 0.007 * corners + 0.009 * upper**0.8 - 0.036 * lower**0.75
    bare_y = rest - 0.001 + 0.0125 * upper**0.4 - 0.0125 * lower**0.4
    return {
        "": Outline(WIDTH * u, rest),
        "bare teeth": Outline(1.06 * WIDTH * u, bare_y, thickness=0.82, roundness=0.3),
        "frown": Outline(0.95 * WIDTH * u, rest - 0.021 * corners + 0.005, 0.001, 0.9),
        "smile": Outline(1.13 * WIDTH * u, rest + 0.020 * corners - 0.005, thickness=0.95),
        "mouth open": Outline(0.88 * WIDTH * u, open_y, roundness=0.6, jaw=0.024),
        "mouth OO": Outline(
            0.0135 * u, MIDDLE - 0.005 + 0.0145 * s, 0.016, 1.25, roundness=1.0, jaw=0.010
        ),
    }


def around() -> tuple[Row, Row]:
    """Cosine and sine (N,) of the columns' angles; the sine is exactly 0 in the corners."""
    turn = 2 * np.pi * np.arange(COLUMNS) / COLUMNS
    sine = np.sin(turn)
    sine[[0, COLUMNS // 2]] = 0.0
    return np.cos(turn), sine


def face_depth(x: Row, y: Row) -> Row:
    """Z of the shell's front at (x, y), m."""
    left = 1 - np.abs(x / HALF_M[0]) ** BULGE - np.abs(y / HALF_M[1]) ** BULGE
    return np.asarray(HALF_M[2] * np.maximum(left, 0.02) ** (1 / BULGE))


def shell_ring(rays: Vectors) -> Vectors:
    """Where `rays` (..., 3) from the middle of the mouth's height leave the shell."""
    start = np.array([0.0, MIDDLE, 0.0])
    low, high = np.zeros(rays.shape[:-1]), np.full(rays.shape[:-1], 0.3)
    for _ in range(40):
        middle = (low + high) / 2
        size = (np.abs((start + middle[..., None] * rays) / HALF_M) ** BULGE).sum(axis=-1)
        low, high = np.where(size < 1, middle, low), np.where(size < 1, high, middle)
    return np.asarray(start + low[..., None] * rays)


def lips(outline: Outline) -> tuple[Vectors, Vectors]:
    """Rings of the mouth's inside (6 or more, N, 3) and of the lips (LIP_RINGS, N, 3)."""
    u, s = around()
    out = np.column_stack([outline.roundness * u, s])
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    radius = LIP_M * outline.thickness * (0.5 + 0.5 * np.abs(s) ** 0.6)
    meeting = np.column_stack([outline.x, outline.y])
    profile = []
    for turn in np.linspace(0, np.pi, LIP_RINGS):
        flat = meeting + (radius * (1 - np.cos(turn)))[:, None] * out
        depth = face_depth(*flat.T) + outline.forward + 1.15 * radius * np.sin(turn) - 0.001
        profile.append(np.column_stack([flat, depth]))
    inside = []
    sunk = outline.jaw * np.clip(-s, 0, 1)
    for half_width, half_height, depth in CAVITY:
        inside.append(
            np.column_stack([half_width * u, MIDDLE + half_height * s - sunk, depth + 0 * u])
        )
    for outwards, back in LINING:
        room = outwards * (1 - 26 * outline.jaw * np.clip(-s, 0, 1))  # little in a dropped chin
        flat = meeting + (room * np.sqrt(np.abs(s)))[:, None] * out
        depth = np.minimum(face_depth(*meeting.T), face_depth(*flat.T)) + outline.forward - back
        depth -= 0.3 * outline.jaw * np.clip(-s, 0, 1)
        inside.append(np.column_stack([flat, depth]))
    return np.stack(inside), np.stack(profile)


def surface(outline: Outline) -> Vectors:
    """All rings (R, N, 3) of the front, from the back of the mouth to the crab's back."""
    inside, profile = lips(outline)
    _, rest = lips(outlines()[""])
    shell = rest_shell(rest[-1])
    away = np.linalg.norm(shell - rest[-1], axis=-1)
    follow = smooth_step(REACH_M, 0.0, away) * smooth_step(*STILL_M[::-1], np.abs(shell[..., 0]))
    moved = shell + follow[..., None] * (profile[-1] - rest[-1])
    return np.concatenate([inside, profile, moved])


def rest_shell(edge: Vectors) -> Vectors:
    """Rings (SHELL_RINGS, N, 3) from the lips' outer edge (N, 3) at rest to the back."""
    from_middle = edge - [0.0, MIDDLE, 0.0]
    start = np.arccos(from_middle[:, 2] / np.linalg.norm(from_middle, axis=1))
    turn = np.unwrap(np.arctan2(from_middle[:, 1], from_middle[:, 0]))
    even = 2 * np.pi * np.arange(COLUMNS) / COLUMNS
    share = np.linspace(0, 1, SHELL_RINGS + 1)[1:, None] ** 1.3
    polar = start + (0.985 * np.pi - start) * share
    angle = turn + (even - turn) * smooth_step(0.0, 0.5, share)
    flat = np.sin(polar)
    return shell_ring(
        np.stack([flat * np.cos(angle), flat * np.sin(angle), np.cos(polar)], axis=-1)
    )


FIRST_LIP_RING: Final = len(CAVITY) + len(LINING)


def lip_pairs() -> NDArray[np.int64]:
    """(N / 2 - 1, 2): upper and lower vertex where the lips meet, from left to right."""
    columns = np.arange(1, COLUMNS // 2)
    return FIRST_LIP_RING * COLUMNS + np.column_stack([columns, COLUMNS - columns])
