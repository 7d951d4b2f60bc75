"""The texture of the head: skin, lips, brows, hair and irises, drawn by rule.

The skin's part is a cylinder unrolled, left and right folded onto each other, so that it has
no seam; the eyes share a square below it. The last texel is white, for parts without texture.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.face.easing import smooth_step
from lipwright.face.eyes import EYE_TILE, IRIS_DEG, PUPIL_DEG
from lipwright.face.materials import linear_to_srgb
from lipwright.face.raster import barycentric, rasterise

Vectors = NDArray[np.float64]
Image = NDArray[np.float64]

SIDE: Final = 1024  # px of the texture
SKIN_ROWS: Final = 768  # px; the rest is for the eyes
EDGE: Final = 4  # px
AXIS_Z_M: Final = 0.015  # m; the cylinder's axis is upright behind the eyes

# The face gets more rows than crown and shoulders: height in m to row.
_HEIGHTS_M: Final = (-0.25, -0.075, 0.095, 0.20)
_ROWS: Final = (767.0, 640.0, 130.0, 1.0)

# Linear RGB.
SKIN: Final = np.array([0.575, 0.345, 0.245])
BLUSH: Final = np.array([1.04, 0.80, 0.78])
LIP: Final = np.array([0.40, 0.135, 0.120])
LID: Final = np.array([0.80, 0.72, 0.74])
HAIR: Final = np.array([0.030, 0.019, 0.013])
BROW: Final = np.array([0.040, 0.025, 0.018])
SCLERA: Final = np.array([0.78, 0.76, 0.74])
IRIS_INNER: Final = np.array([0.22, 0.115, 0.045])
IRIS_OUTER: Final = np.array([0.105, 0.058, 0.030])
LIMBUS: Final = np.array([0.020, 0.013, 0.010])


@dataclass(frozen=True, eq=False)
class Landmarks:
    """Places of the left half of the face at rest, m."""

    eye: Vectors
    nose_tip: Vectors
    mouth_corner: Vectors
    mouth: Vectors


def skin_uvs(vertices: Vectors) -> Vectors:
    """Places (n, 2) of skin `vertices` in the texture."""
    turn = np.abs(np.arctan2(vertices[:, 0], vertices[:, 2] - AXIS_Z_M)) / np.pi
    rows = np.interp(vertices[:, 1], _HEIGHTS_M, _ROWS)
    return np.column_stack([(turn * (SIDE - 2) + 1) / SIDE, rows / SIDE])


def paint_texture(
    vertices: Vectors, triangles: NDArray[np.int64], lip: NDArray[np.float64], marks: Landmarks
) -> NDArray[np.uint8]:
    """The texture (SIDE, SIDE, 3) for the skin's `vertices` with `lip` (n,), 1 on the red."""
    image = np.ones((SIDE, SIDE, 3))
    places, known = _unroll(vertices, triangles, lip)
    image[:SKIN_ROWS] = _skin(places, known, marks)
    left, top, side = (round(value * SIDE) for value in EYE_TILE)
    image[top : top + side, left : left + side] = _eye(side)
    return linear_to_srgb(image)


def _unroll(
    vertices: Vectors, triangles: NDArray[np.int64], lip: NDArray[np.float64]
) -> tuple[Image, NDArray[np.bool_]]:
    """Position and lip mask (rows, SIDE, 4) of the outermost skin at each texel."""
    half = triangles[vertices[triangles][:, :, 0].mean(axis=1) > 0].astype(np.int32)
    outward = np.hypot(vertices[:, 0], vertices[:, 2] - AXIS_Z_M)
    points = np.column_stack([skin_uvs(vertices) * SIDE, -outward]).astype(np.float32)
    covered, triangle = rasterise(points, half, SIDE, SKIN_ROWS)
    shares = barycentric(points, half, covered, triangle, SIDE)
    values = np.column_stack([vertices, lip])
    places = np.zeros((SKIN_ROWS * SIDE, 4))
    places[covered] = np.einsum("nk,nkc->nc", shares, values[half[triangle]])
    known = np.zeros(SKIN_ROWS * SIDE, bool)
    known[covered] = True
    return _spread(places.reshape(SKIN_ROWS, SIDE, 4), known.reshape(SKIN_ROWS, SIDE))


def _spread(places: Image, known: NDArray[np.bool_]) -> tuple[Image, NDArray[np.bool_]]:
    """Carry known texels over the edge of the unrolled skin, so that filters find them there."""
    rows = np.arange(len(known))[:, None]
    first = np.argmax(known, axis=0)  # above the crown there is nothing but more crown
    places = np.take_along_axis(places, np.maximum(rows, first)[..., None], axis=0)
    known = known | (rows < first)
    for _ in range(EDGE):
        for axis in (0, 1):
            for step in (1, -1):
                take = ~known & np.roll(known, step, axis)
                places[take] = np.roll(places, step, axis)[take]
                known = known | take
    return places, known


def _noise(shape: tuple[int, int], cell: tuple[float, float], seed: int) -> Image:
    """Smooth noise, -1 to 1, with features of `cell` texels (vertical, horizontal)."""
    rows, columns = shape
    chance = np.random.default_rng(seed)
    down, across = int(rows / cell[0]) + 2, int(columns / cell[1]) + 2
    grid = chance.uniform(-1, 1, (down, across))
    at = np.arange(columns) / cell[1]
    wide = np.array([np.interp(at, np.arange(across), line) for line in grid])
    up = np.arange(rows) / cell[0]
    low = np.minimum(up.astype(int), down - 2)
    share = smooth_step(0, 1, up - low)[:, None]
    return np.asarray(wide[low] * (1 - share) + wide[low + 1] * share)


def _blob(places: Image, centre: Vectors, radius: float) -> Image:
    """A soft spot around `centre` (3,), 1 in the middle."""
    far = ((places[..., :3] - centre) ** 2).sum(axis=-1)
    return np.asarray(np.exp(-far / (2 * radius**2)))


def _mix(image: Image, color: Vectors, share: Image) -> Image:
    return np.asarray(image + share[..., None] * (color - image))


def _skin(places: Image, known: NDArray[np.bool_], marks: Landmarks) -> Image:
    shape = (SKIN_ROWS, SIDE)
    mottle = 0.6 * _noise(shape, (34, 34), 1) + 0.4 * _noise(shape, (9, 9), 2)
    pores = _noise(shape, (1.6, 1.6), 3)
    image = SKIN * (1 + 0.035 * mottle + 0.018 * pores)[..., None]
    image *= 1 + 0.05 * mottle[..., None] * np.array([-0.3, 0.4, 0.5])
    eye, corner = marks.eye, marks.mouth_corner
    cheek = np.array([eye[0] + 0.012, (eye[1] + corner[1]) / 2 + 0.004, eye[2] - 0.002])
    blush = (
        0.50 * _blob(places, cheek, 0.017)
        + 0.55 * _blob(places, marks.nose_tip, 0.010)
        + 0.22 * _blob(places, marks.mouth + np.array([0, -0.028, 0]), 0.011)
        + 0.60
        * smooth_step(0.066, 0.074, places[..., 0])
        * smooth_step(-0.03, 0.0, places[..., 1])
        * smooth_step(0.055, 0.045, places[..., 1])
    )
    image = image * (1 + np.clip(blush, 0, 1)[..., None] * (BLUSH - 1))
    lids = np.clip(_blob(places, eye + np.array([0.0, -0.002, 0.012]), 0.0105) * 1.1, 0, 1)
    image = image * (1 + 0.55 * lids[..., None] * (LID - 1))
    image = _mix(image, LIP * (1 + 0.10 * mottle)[..., None], _lips(places))
    image = _mix(image, BROW, _brows(places, marks))
    image = _mix(image, HAIR * (1 + 0.55 * _strands(shape))[..., None], _hair(places))
    image[~known] = SKIN
    return np.asarray(image)


def _lips(places: Image) -> Image:
    shape = (SKIN_ROWS, SIDE)
    lines = _noise(shape, (26, 3.0), 5)
    return smooth_step(0.30, 0.78, places[..., 3] + 0.05 * lines) * (0.80 + 0.07 * lines)


def _strands(shape: tuple[int, int]) -> Image:
    return 0.6 * _noise(shape, (22, 2.2), 6) + 0.4 * _noise(shape, (9, 1.3), 7)


HAIRLINE: Final = (
    # turn from the front in deg, height in m of the lower edge of the hair
    (0.0, 0.101), (14.0, 0.100), (28.0, 0.097), (40.0, 0.091), (50.0, 0.082), (58.0, 0.072),
    (66.0, 0.058), (73.0, 0.040), (80.0, 0.018), (92.0, 0.010), (100.0, 0.030), (112.0, 0.000),
    (125.0, -0.022), (140.0, -0.034), (180.0, -0.038),
)  # fmt: skip


def hair_depth(places: Image) -> Image:
    """How far inside the hair each place is, in m; negative outside."""
    turn = np.degrees(np.abs(np.arctan2(places[..., 0], places[..., 2] - AXIS_Z_M)))
    edge = np.interp(turn, *np.array(HAIRLINE).T)
    return np.asarray(places[..., 1] - edge)


def _hair(places: Image) -> Image:
    shape = (SKIN_ROWS, SIDE)
    fringe = _noise(shape, (14, 2.4), 8) + 0.7 * _noise(shape, (6, 1.5), 9)
    depth = hair_depth(places) + 0.0034 * fringe
    ear = places[..., 0] > 0.0735
    return smooth_step(-0.0075, 0.0105, depth) * 0.95 * ~ear


BROW_LINE: Final = (
    # left brow: x and height above the eye's centre, half its thickness, in m
    (0.0085, 0.0165, 0.0022), (0.0140, 0.0190, 0.0034), (0.0220, 0.0212, 0.0034),
    (0.0320, 0.0232, 0.0028), (0.0400, 0.0222, 0.0020), (0.0470, 0.0180, 0.0008),
)  # fmt: skip


def _brows(places: Image, marks: Landmarks) -> Image:
    """Single hairs, leaning outwards and up, denser along the middle of the brow."""
    line = np.array(BROW_LINE)
    height = places[..., 1] - marks.eye[1]
    front = places[..., 2] > marks.eye[2] - 0.02
    middle = np.interp(places[..., 0], line[:, 0], line[:, 1])
    half = np.interp(places[..., 0], line[:, 0], line[:, 2], left=1e-5, right=1e-5)
    across = np.abs(height - middle) / half
    lean = np.interp(places[..., 0], line[:, 0], [0.1, 0.5, 1.1, 1.6, 2.2, 2.6])
    scale = 3800.0  # hairs per m, measured across their direction
    along = places[..., 0] - (height - middle) * lean
    rng = np.random.default_rng(11)
    table = rng.uniform(-1, 1, 400)
    comb = np.interp((along * scale) % 400, np.arange(400), table)
    density = smooth_step(1.35, 0.25, across + 0.30 * comb) * (0.70 + 0.30 * comb)
    ends = smooth_step(0.0075, 0.0125, places[..., 0]) * smooth_step(0.049, 0.043, places[..., 0])
    return np.asarray(np.clip(density * ends * front, 0, 1) * 0.92)


def _eye(side: int) -> Image:
    """White, iris, limbal ring and pupil around the pole of the eye."""
    at = (np.arange(side) + 0.5) / side - 0.5
    x, y = np.meshgrid(at, -at)
    angle = np.hypot(x, y) / 0.48 * 90
    around = np.arctan2(y, x)
    rng = np.random.default_rng(21)
    fibres = np.interp((around / (2 * np.pi) + 0.5) * 160, np.arange(161), rng.uniform(-1, 1, 161))
    fine = np.interp((around / (2 * np.pi) + 0.5) * 61, np.arange(62), rng.uniform(-1, 1, 62))
    veins = smooth_step(45, 80, angle)
    image = _mix(
        np.broadcast_to(SCLERA, (side, side, 3)), np.array([0.62, 0.36, 0.33]), veins * 0.5
    )
    share = np.clip((angle - PUPIL_DEG) / (IRIS_DEG - PUPIL_DEG), 0, 1)
    collar = np.exp(-(((share - 0.28 - 0.06 * fine) / 0.16) ** 2))
    iris = IRIS_OUTER + (IRIS_INNER - IRIS_OUTER) * np.clip(1 - share, 0, 1)[..., None]
    iris = iris * (1 + 0.35 * fibres * (1 - share) + 0.75 * collar + 0.25 * fine)[..., None]
    iris = iris * (0.75 + 0.55 * smooth_step(0.4, -0.7, np.sin(around)))[..., None]
    iris = _mix(iris, LIMBUS, smooth_step(0.68, 0.98, share))
    image = _mix(image, iris, smooth_step(IRIS_DEG + 1.6, IRIS_DEG - 0.6, angle))
    return _mix(image, np.full(3, 0.004), smooth_step(PUPIL_DEG + 1.0, PUPIL_DEG - 0.6, angle))
