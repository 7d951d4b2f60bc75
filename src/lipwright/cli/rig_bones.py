"""`lipwright rigs bones`: a face on bones, made from its blendshapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.face.skinning import SkinnedMesh
    from lipwright.retarget.bones import BoneFit, Residual
    from lipwright.rig import Rig

BONES_EXAMPLES = """\b
Examples:
  lipwright rigs bones -o bones.glb
    head: 7093 vertices on 12 bones
    blendshape           rms mm  worst mm  of its motion
    jawForward             0.26       1.0             5%
\b
  lipwright rigs bones hero.glb -o hero-bones.glb --save-rig hero.json
  lipwright animate talk.wav --text talk.txt --rig hero.json --onto hero-bones.glb -o speaks.glb
"""


@click.command(epilog=BONES_EXAMPLES)
@click.argument("character", required=False, type=Path)
@click.option("-o", "--output", "out", type=Path, metavar="GLB", help="The face on its bones.")
@click.option("--rig", "rig_name", default="bones", show_default=True, metavar="RIG",
              help="Rig with bones: a name, or a file whose bones lie in CHARACTER.")  # fmt: skip
@click.option("--save-rig", "saved", type=Path, metavar="JSON",
              help="Write the rig as fitted: its bones, and what moves them.")  # fmt: skip
@click.option("--mesh", metavar="NAME", help="Mesh of CHARACTER.  [default: the largest]")
def bones(
    character: Path | None, out: Path | None, rig_name: str, saved: Path | None, mesh: str | None
) -> None:
    """Put a face on bones that move it as its blendshapes do, and say what they cannot show.

    Without CHARACTER that is our head. A CHARACTER (GLB, VRM) needs morph targets with ARKit's
    names, must be upright and look along z; the bones of a rig that ships are placed by where its
    face moves, and fitted to its morph targets. All else in its file stays as it is.
    """
    from lipwright.export import check_targets
    from lipwright.files import write_whole
    from lipwright.rig import RIGS, load_rig, save_rig

    if out is not None and out.suffix.lower() != ".glb":
        raise LipwrightError(f"{out}: name a file that ends in .glb")
    targets = [path for path in (out, saved) if path is not None]
    inputs = [Path(rig_name)] if character is None else [character, Path(rig_name)]
    check_targets(targets, inputs=inputs)
    rig = load_rig(rig_name)
    if character is None:
        skinned, left = _our_head(rig)
    else:
        fit, rig = _fit(character, mesh, rig, ships=rig_name in RIGS)
        skinned, left = fit.skinned, fit.residuals
    content = None if out is None else _glb(skinned, character, mesh)
    _print(skinned, left)
    if out is not None and content is not None:
        with write_whole(out) as part:
            part.write_bytes(content)
    if saved is not None:
        save_rig(rig, saved)


def _our_head(rig: Rig) -> tuple[SkinnedMesh, tuple[Residual, ...]]:
    from lipwright.face.head import load_head
    from lipwright.retarget.bone_rig import moving_shapes
    from lipwright.retarget.bones import residuals
    from lipwright.retarget.skinned import shape_transforms, skin_mesh

    head = load_head()
    skinned = skin_mesh(head, rig)
    shapes = moving_shapes(head, rig)
    return skinned, residuals(skinned, shapes, shape_transforms(rig, shapes))


def _fit(path: Path, mesh_name: str | None, rig: Rig, ships: bool) -> tuple[BoneFit, Rig]:
    """The bones in another character; those of a rig that ships are placed first."""
    from lipwright.export.gltf_character import read_character
    from lipwright.face.head import load_head
    from lipwright.retarget.bone_rig import fit_character, moving_shapes, placed_bones

    mesh = read_character(path, mesh_name)
    bones, size = rig.bones, 1.0
    if ships:
        bones, size = placed_bones(rig, load_head(), mesh, moving_shapes(mesh, rig))
    fit, fitted = fit_character(mesh, rig, bones, size)
    title = f"{rig.title}, fitted to {path.name}"
    return fit, replace(fitted, name=path.stem, title=title, source=f"fitted to {path.name}")


def _glb(skinned: SkinnedMesh, character: Path | None, mesh_name: str | None) -> bytes:
    from lipwright.export.bone_skin import with_bones
    from lipwright.export.gltf_surface import read_gltf_surface
    from lipwright.export.skinned import skinned_glb

    if character is None:
        return skinned_glb(skinned)
    return with_bones(read_gltf_surface(character, mesh_name), skinned)


def _print(skinned: SkinnedMesh, left: Sequence[Residual]) -> None:
    click.echo(
        f"{skinned.mesh.name}: {len(skinned.mesh.vertices)} vertices on "
        f"{len(skinned.skeleton)} bones"
    )
    click.echo(f"{'blendshape':19}  rms mm  worst mm  of its motion")
    for row in left:
        click.echo(f"{row.shape:19}  {row.rms_mm:6.2f}  {row.worst_mm:8.1f}  {row.share:13.0%}")
