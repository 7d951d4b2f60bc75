"""`lipwright rigs transfer`: our head's blendshapes on another mesh."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from lipwright.cli.progress import say
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.clip import Clip
    from lipwright.export.surfaces import FileSurface
    from lipwright.face.head import Head
    from lipwright.face.registration import Registration
    from lipwright.face.surface import Surface
    from lipwright.face.transfer import TransferSolver

TRANSFER_EXAMPLES = """\b
Examples:
  lipwright rigs transfer examples/other-head.obj --landmarks examples/other-head.csv -o other.glb
    examples/other-head.obj: 4,590 points, 9,120 triangles, 3 pieces
    examples/other-head.csv: 34 landmarks
\b
  lipwright rigs transfer hero.glb -o talking.glb                      # finds the landmarks itself
  lipwright rigs transfer hero.glb -o talking.glb --clip hello.json    # and moves it
  lipwright rigs transfer statue.obj -o statue.pc2 --clip hello.json   # every frame, for no rig
  lipwright rigs transfer sculpted.glb -o mine.glb --same-topology     # our own head, changed
"""

GLB: Final = ".glb"
POOR_MM: Final = 4.0  # mean distance after registration, in the head's own mm
GROUPED: Final = 6  # names that a line lists


@dataclass(frozen=True, eq=False)
class Fitted:
    """A solver, and what there is to say of how it came about."""

    solver: TransferSolver
    lines: tuple[str, ...]
    warnings: tuple[str, ...] = ()


@click.command(epilog=TRANSFER_EXAMPLES)
@click.argument("target", type=Path)
@click.option("-o", "--output", "out", required=True, type=Path, metavar="FILE",
              help="GLB with blendshapes, or PC2 with every frame of --clip.")  # fmt: skip
@click.option("--landmarks", type=Path, metavar="CSV",
              help="landmark,vertex or landmark,x,y,z; without it a face is looked for in a "
              "picture of the mesh, which must be upright and face along z.")  # fmt: skip
@click.option("--same-topology", is_flag=True,
              help="The target is our head with other places of the same vertices.")  # fmt: skip
@click.option("--mesh", metavar="NAME", help="Mesh of a GLB.  [default: the largest]")
@click.option("--controls", metavar="NAME,...", help="Blendshapes to make.  [default: all 55]")
@click.option("--clip", type=Path, metavar="FILE", help="Curves of canonical controls to play.")
def transfer(
    target: Path, out: Path, landmarks: Path | None, same_topology: bool, mesh: str | None,
    controls: str | None, clip: Path | None,
) -> None:  # fmt: skip
    """Give the mesh in TARGET (OBJ, GLB, VRM) the head's 55 blendshapes.

    Deformation transfer: each triangle of the target is deformed as those of the head that lie
    there. A GLB keeps its materials, skeleton and pictures. Look at the result, the lips above all;
    more landmarks around the mouth help.
    """
    from lipwright.controls import CANONICAL
    from lipwright.export import check_targets, read_clip
    from lipwright.export.pointcache import SUFFIX
    from lipwright.export.surfaces import read_surface
    from lipwright.face.head import load_head

    if out.suffix.lower() not in {GLB, SUFFIX}:
        raise LipwrightError(f"{out}: name a file that ends in .glb or {SUFFIX}")
    if out.suffix.lower() == SUFFIX and clip is None:
        raise LipwrightError(f"{out}: a point cache holds motion; give curves with --clip")
    if same_topology and landmarks is not None:
        raise LipwrightError("--same-topology needs no --landmarks; give one of them")
    names = _names(controls, CANONICAL)
    check_targets([out], None, [path for path in (target, landmarks, clip) if path is not None])
    head = load_head()
    curves = None if clip is None else read_clip(clip)
    found = read_surface(target, mesh)
    fitted = _fit(found.surface, head, target, landmarks, same_topology)
    for line in (_about(target, found.surface), *fitted.lines, *fitted.warnings):
        say(line)
    say(_write(out, found, fitted.solver, head, names, curves))


def _names(controls: str | None, known: tuple[str, ...]) -> tuple[str, ...]:
    from lipwright.controls import both_sides

    if controls is None:
        return known
    names = tuple(n for word in controls.split(",") if word for n in both_sides(word.strip()))
    wrong = [name for name in names if name not in known]
    if wrong or not names:
        raise LipwrightError(
            f"--controls: no control {(wrong or [''])[0]!r}; the controls are: {', '.join(known)}"
        )
    return tuple(dict.fromkeys(names))


def _about(path: Path, surface: Surface) -> str:
    pieces = int(surface.pieces.max()) + 1
    parts = [
        f"{len(surface.places):,} points", f"{len(surface.triangles):,} triangles",
        f"{pieces} piece{'s' * (pieces > 1)}",
    ]  # fmt: skip
    flat, loose = int(surface.flat.sum()), surface.loose()
    if flat:
        parts.append(f"{flat:,} degenerate triangles are left out")
    if loose:
        parts.append(f"{loose:,} vertices in no triangle")
    return f"{path}: {', '.join(parts)}"


def _fit(surface: Surface, head: Head, path: Path, landmarks: Path | None, same: bool) -> Fitted:
    from lipwright.face.head_landmarks import pairs, read_landmarks
    from lipwright.face.partners import same_topology
    from lipwright.face.registration import register
    from lipwright.face.surface import mesh_surface
    from lipwright.face.transfer import TransferSolver

    if same:
        source = mesh_surface(head)
        solver = TransferSolver(source, surface, same_topology(source, surface, str(path)))
        return Fitted(solver, ("each triangle is deformed as the head's of the same number",))
    if landmarks is not None:
        marks, said = read_landmarks(landmarks, head, surface), f"{landmarks}: "
    else:
        from lipwright.capture.character_landmarks import find_landmarks

        marks, said = pairs(head, find_landmarks(surface, head)), "seen in a picture of the mesh: "
    placed = register(head, surface, marks)
    solver = TransferSolver(placed.source, surface, placed.partners, placed.contacts)
    lines = (f"{said}{len(marks.names)} landmarks", _quality(placed, len(surface.triangles)))
    mean_mm = placed.mean_distance / placed.scale * 1000
    poor = f"warning: the head fits badly ({mean_mm:.1f} mm); give more landmarks, or better ones"
    return Fitted(solver, lines, (poor,) if mean_mm > POOR_MM else ())


def _quality(placed: Registration, triangles: int) -> str:
    mm = 1000 / placed.scale
    return (
        f"the head lies {placed.mean_distance * mm:.1f} mm from the mesh (95 %: "
        f"{placed.worst_distance * mm:.1f} mm, in the head's size) over {placed.covered:.0%} of "
        f"its skin; {placed.partners.alone:,} of {triangles:,} triangles have no partner"
    )


def _write(
    out: Path, target: FileSurface, solver: TransferSolver, head: Head, names: tuple[str, ...],
    clip: Clip | None,
) -> str:  # fmt: skip
    from lipwright.export.pointcache import SUFFIX, write_point_cache
    from lipwright.export.transferred import animated_glb, made_shapes, moved_vertices, shaped_glb
    from lipwright.files import write_whole

    if out.suffix.lower() == SUFFIX:
        assert clip is not None
        if not set(names) & set(clip.names):
            raise LipwrightError("--clip has none of the controls; give curves of canonical ones")
        played, count = clip.select(names), len(target.surface.vertices)
        with write_whole(out) as part:
            write_point_cache(part, moved_vertices(solver, head, played), len(played), count)
        return f"{out}: {len(played)} frames of {count:,} vertices"
    shapes = made_shapes(solver, head, names)
    if not shapes:
        raise LipwrightError(f"{target.path}: none of the shapes moves it; check the landmarks")
    if clip is None:
        content = shaped_glb(target, shapes, out.stem)
    else:
        content = animated_glb(target, shapes, out, clip)
    with write_whole(out) as part:
        part.write_bytes(content)
    lacks = [name for name in names if name not in shapes]
    more = "" if not lacks else f"; not on this mesh: {', '.join(lacks[:GROUPED])}"
    return f"{out}: {len(shapes)} blendshapes{more}" + (" and more" * (len(lacks) > GROUPED))
