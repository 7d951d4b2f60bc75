"""`lipwright rigs fit`: make a rig follow speech."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from lipwright.cli.progress import say
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.retarget.fitting import Fitted
    from lipwright.rig import PoseMapping, Rig

GLTF: Final = (".glb", ".gltf", ".vrm")
HIDDEN: Final = 0.5  # share of a control's motion that is not shown, from which it is named
FIT_EXAMPLES = """\b
Examples:
  lipwright rigs fit examples/crab/crab.rig.json --poses examples/crab/crab.poses.json -o crab.json
    crab.json: crab follows 4 modes of grid-s1 by 8 poses, which move 5 of its 8 controls; 3 by rows
\b
  lipwright rigs fit crab.rig.json --poses crab.glb -o crab.json     # a pose a frame or a second
  lipwright rigs fit mine.json -o mine.json                          # by its looks
  lipwright rigs fit mine.json --mesh mine.glb -o mine.json          # by its blendshapes
"""


@click.command(epilog=FIT_EXAMPLES)
@click.argument("rig")
@click.option("-o", "--output", required=True, type=Path, metavar="FILE",
              help="The rig with its mapping, .json.")  # fmt: skip
@click.option("--poses", type=Path, metavar="FILE",
              help="The poses that an artist set: .json, .csv, .glb or .gltf.")  # fmt: skip
@click.option("--modes", default=4, show_default=True, type=click.IntRange(1, 99),
              help="Shape modes that --poses shows, two poses each.")  # fmt: skip
@click.option("--mesh", type=Path, metavar="GLB",
              help="A character on the head's mesh with the controls as blendshapes.")  # fmt: skip
@click.option("--controls", metavar="NAME,...", help="Controls to fit.  [default: those that "
              "follow jaw, lips and tongue; all, where the rig follows nothing yet]")  # fmt: skip
def fit(
    rig: str, output: Path, poses: Path | None, modes: int, mesh: Path | None,
    controls: str | None,
) -> None:  # fmt: skip
    """Say how RIG, a name or a file, follows speech, and write it as a rig of its own.

    With --poses by the poses that an artist set for: lipwright rigs poses. Without, by a linear
    mapping: least squares on what the rig's looks, or the blendshapes of --mesh, show. Controls
    that are not fitted keep what they follow.
    """
    from lipwright.export import check_targets
    from lipwright.retarget.refitting import refitted
    from lipwright.rig import load_rig, save_rig

    if output.suffix.lower() != ".json":
        raise LipwrightError(f"{output}: a rig is a JSON file; name one that ends in .json")
    if poses is not None and mesh is not None:
        raise LipwrightError("--poses and --mesh are two ways to fit; leave one of them out")
    known = load_rig(rig)
    check_targets([output], inputs=[path for path in (poses, mesh) if path is not None])
    if poses is not None:
        mapping = _read_poses(poses, known, modes)
        save_rig(replace(known, mapping=mapping), output)
        say(f"{output}: {_posed(known, mapping)}")
        return
    fitted = _fit_linear(known, mesh, controls)
    save_rig(refitted(known, fitted), output)
    for line in _fitted(known, fitted):
        say(f"{output}: {line}")


def _read_poses(path: Path, rig: Rig, modes: int) -> PoseMapping:
    from lipwright.export.gltf_poses import read_pose_frames
    from lipwright.retarget.pose_files import read_poses
    from lipwright.retarget.pose_table import frames_to_poses, pose_labels, to_mapping

    if path.suffix.lower() not in GLTF:
        return read_poses(path, rig, modes)
    count = len(pose_labels(modes))
    frames = read_pose_frames(path, rig, (count, count + 1, count + 2))
    try:
        return to_mapping(frames_to_poses(frames, rig, modes), rig, modes)
    except LipwrightError as error:
        raise LipwrightError(f"{path}: {error}") from error


def _posed(rig: Rig, mapping: PoseMapping) -> str:
    modes = len({pose.mode for pose in mapping.poses})
    posed = len(mapping.controls - set(mapping.rows))
    rows = f"; {len(mapping.rows)} by rows" if mapping.rows else ""
    shut = "" if mapping.shut else "; without a shut pose its lips may stay apart at p, b and m"
    return (
        f"{rig.name} follows {modes} modes of {mapping.reference} by {len(mapping.poses)} poses, "
        f"which move {posed} of its {len(rig.controls)} controls{rows}{shut}"
    )


def _fit_linear(rig: Rig, mesh: Path | None, controls: str | None) -> Fitted:
    from lipwright.face.head import load_head
    from lipwright.retarget.fitting import (
        OF_MESHES,
        FitOptions,
        fit_looks,
        fit_meshes,
    )
    from lipwright.retarget.refitting import follows_speech

    named = None if controls is None else tuple(name.strip() for name in controls.split(","))
    chosen = follows_speech(rig) if named is None else named
    if mesh is None:
        return fit_looks(rig, load_head(), FitOptions(controls=chosen))
    from lipwright.export.gltf_character import read_character

    options = replace(OF_MESHES, controls=chosen)
    return fit_meshes(load_head(), read_character(mesh), rig, options)


def _fitted(rig: Rig, fitted: Fitted) -> list[str]:
    moved = f"{len(fitted.mapping.controls)} of its {len(rig.controls)} controls"
    hidden = dict.fromkeys(
        name.removesuffix("Left").removesuffix("Right")
        for name, share in fitted.left.items() if share > HIDDEN
    )  # fmt: skip
    lines = [
        f"{rig.name} follows speech with {moved}, {fitted.error:.2f} mm off where faces move by "
        f"{fitted.motion:.2f} mm"
    ]
    if hidden:
        lines.append(f"hardly shown: {', '.join(hidden)}")
    return lines
