"""USD: the head, or another character, as UsdSkel blendshapes with their weights over time.

OpenUSD's schemas UsdGeom, UsdSkel and UsdMedia. `.usda` is text, `.usdc` and `.usd` are crate
files. In metres, y up, one time code a frame. A SkelRoot holds a mesh for each part, whose
`skel:blendShapes` name the blendshapes that move it, a skeleton whose joint `Neck/Head` turns our
head, and a SkelAnimation with `blendShapes` and time samples of `blendShapeWeights` as they are,
float32; USD is linear between them. Curves of which the character has no blendshape stand there
too; with a rig that no mesh is there for, they are all there is. Bones of a rig are left out. The
recording is a SpatialAudio that names the file, where it is one that USD plays.
"""

from __future__ import annotations

import os
import re
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, HEAD_ANGLES
from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.export.bonemotion import without_bones
from lipwright.export.performance import ExportOptions, Output, Performance
from lipwright.face.head import Head, load_head
from lipwright.face.neck import turn_shares
from lipwright.face.turning import head_quaternions, head_turns

if TYPE_CHECKING:
    from lipwright.face.mesh import Mesh, Part

SOUNDS: Final = (".m4a", ".mp3", ".wav")  # UsdMedia's SpatialAudio
TURNS: Final = 1e-3  # smaller changes of a unit normal are not seen and not stored
JOINTS: Final = ("Neck", "Neck/Head")
_KEY: Final = "Animation"


def prepare() -> None:
    """Find out before long work whether USD is there."""
    if find_spec("pxr") is None:
        raise MissingExtraError("USD", "usd")


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: USD is not installed, or the clip moves bones alone, or none of the given
            character.
    """
    prepare()
    clip = without_bones(performance)
    if not clip.names:
        raise LipwrightError(
            f"{path}: the curves move bones alone, and it holds blendshapes; export the canonical "
            "curves, or write a GLB"
        )
    mesh = _shown(path, clip, options)
    sound = _sound(path, performance)

    def write(part: Path) -> None:
        from pxr import Tf

        try:
            _write(part, path.stem, clip, mesh, sound)
        except Tf.ErrorException as error:
            reason = str(error).strip().partition("\n")[0][:80]
            raise LipwrightError(f"{path}: cannot be written: {reason}") from None

    return [Output(path, write)]


def _shown(path: Path, clip: Clip, options: ExportOptions) -> Mesh | None:
    """The character; None where only the weights are written."""
    names = set(clip.names)
    if options.character is not None:
        if not names & set(options.character.shape_names):
            raise LipwrightError(
                f"{path}: the curves have none of the blendshapes of the "
                f"{options.character.name}; retarget them"
            )
        return options.character
    if not names & set(CANONICAL):
        return None
    try:
        return load_head()
    except LipwrightError:  # not installed; the weights go onto the user's own mesh
        return None


def _sound(path: Path, performance: Performance) -> str | None:
    """The recording as seen from the file."""
    recording = performance.audio_path
    if recording is None or recording.suffix.lower() not in SOUNDS or not recording.is_file():
        return None
    try:
        return Path(os.path.relpath(recording, path.parent)).as_posix()
    except ValueError:  # on another drive
        return recording.resolve().as_posix()


def identifiers(names: tuple[str, ...]) -> dict[str, str]:
    """Each control's name as USD allows it: letters, digits and underscores, each once."""
    found: dict[str, str] = {}
    for name in names:
        plain = re.sub(r"[^A-Za-z0-9_]", "_", name)
        plain = plain if not plain[0].isdigit() else f"_{plain}"
        number, free = 2, plain
        while free in found.values():
            number, free = number + 1, f"{plain}_{number}"
        found[name] = free
    return found


def _write(part: Path, name: str, clip: Clip, mesh: Mesh | None, sound: str | None) -> None:
    from pxr import Sdf, Usd, UsdGeom, UsdSkel

    layer = Sdf.Layer.CreateNew(str(part))
    stage = Usd.Stage.Open(layer)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetTimeCodesPerSecond(clip.fps)
    stage.SetFramesPerSecond(clip.fps)
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(len(clip) - 1)
    root = UsdSkel.Root.Define(stage, "/Character")
    stage.SetDefaultPrim(root.GetPrim())
    root.GetPrim().SetDocumentation(f"{name}, by Lipwright")
    skeleton = _skeleton(stage, clip)
    names = identifiers(tuple(n for n in clip.names if n not in HEAD_ANGLES))
    _animate(stage, clip, names)
    if mesh is not None:
        every = identifiers((*names, *(n for n in mesh.shape_names if n not in names)))
        shown = {shape: every[shape] for shape in mesh.shape_names}
        turned = [mesh.normals(mesh.pose(row)) - mesh.rest_normals
                  for row in np.eye(len(mesh.shape_names), dtype=np.float32)]  # fmt: skip
        root.GetPrim().SetCustomDataByKey("source", f"{mesh.name}: {mesh.source}, {mesh.license}")
        shares = (
            turn_shares(mesh)
            if isinstance(mesh, Head)
            else np.zeros(len(mesh.vertices), np.float32)
        )
        for piece in mesh.parts:
            _part(stage, mesh, piece, shown, turned, shares, skeleton)
    if sound is not None:
        _play(stage, sound, clip)
    layer.Save()


def _skeleton(stage: Any, clip: Clip) -> Any:
    """Two joints at the origin, where head and neck meet."""
    from pxr import Gf, UsdSkel, Vt

    skeleton = UsdSkel.Skeleton.Define(stage, "/Character/Skeleton")
    skeleton.CreateJointsAttr(JOINTS)
    still = Vt.Matrix4dArray([Gf.Matrix4d(1.0)] * len(JOINTS))
    skeleton.CreateBindTransformsAttr(still)
    skeleton.CreateRestTransformsAttr(still)
    binding = UsdSkel.BindingAPI.Apply(skeleton.GetPrim())
    binding.CreateAnimationSourceRel().SetTargets([f"/Character/{_KEY}"])
    return skeleton


def _animate(stage: Any, clip: Clip, names: dict[str, str]) -> None:
    from pxr import Gf, UsdSkel, Vt

    animation = UsdSkel.Animation.Define(stage, f"/Character/{_KEY}")
    animation.CreateBlendShapesAttr(list(names.values()))
    weights = animation.CreateBlendShapeWeightsAttr()
    values = np.ascontiguousarray(clip.select(names).values)
    for frame, row in enumerate(values):
        weights.Set(Vt.FloatArray.FromNumpy(row), frame)
    turns = head_turns(clip)
    animation.CreateJointsAttr(JOINTS)
    animation.CreateTranslationsAttr([Gf.Vec3f(0.0)] * len(JOINTS))
    animation.CreateScalesAttr(Vt.Vec3hArray([Gf.Vec3h(1.0)] * len(JOINTS)))
    still = Gf.Quatf(1.0)
    rotations = animation.CreateRotationsAttr(Vt.QuatfArray([still] * len(JOINTS)))
    if turns is not None:
        for frame, (x, y, z, w) in enumerate(head_quaternions(turns).tolist()):
            rotations.Set(Vt.QuatfArray([still, Gf.Quatf(w, x, y, z)]), frame)


def _part(
    stage: Any, mesh: Mesh, part: Part, shown: dict[str, str], turned: list[Any],
    shares: npt.NDArray[np.float32], skeleton: Any,
) -> None:  # fmt: skip
    """One part of the mesh, with the blendshapes that move it."""
    from pxr import UsdGeom, UsdSkel, Vt

    run, path = part.vertices, f"/Character/{identifiers((part.name,))[part.name]}"
    prim = UsdGeom.Mesh.Define(stage, path)
    points = mesh.vertices[run]
    triangles = mesh.triangles[part.triangles] - run.start
    prim.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(points)))
    prim.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(triangles), 3, np.int32)))
    corners = np.ascontiguousarray(triangles.ravel(), np.int32)
    prim.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(corners))
    prim.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(mesh.rest_normals[run])))
    prim.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
    prim.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    prim.CreateDoubleSidedAttr(part.material.double_sided)
    prim.CreateExtentAttr(Vt.Vec3fArray.FromNumpy(np.stack([points.min(0), points.max(0)])))
    color = prim.CreateDisplayColorPrimvar(UsdGeom.Tokens.vertex)
    tints = mesh.colors[run] * np.array(part.material.base_color, np.float32)
    color.Set(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(tints, np.float32)))
    binding = UsdSkel.BindingAPI.Apply(prim.GetPrim())
    binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    _bind(binding, shares[run])
    _blendshapes(stage, mesh, run, path, shown, turned, binding)


def _bind(binding: Any, shares: npt.NDArray[np.float32]) -> None:
    """How far each vertex follows the two joints; a part that follows as a whole says so once."""
    from pxr import Vt

    whole = bool(np.ptp(shares) == 0)
    used = shares[:1] if whole else shares
    joints = np.tile(np.array([0, 1], np.int32), len(used))
    weights = np.ascontiguousarray(np.stack([1 - used, used], axis=1).ravel(), np.float32)
    binding.CreateJointIndicesPrimvar(whole, len(JOINTS)).Set(Vt.IntArray.FromNumpy(joints))
    binding.CreateJointWeightsPrimvar(whole, len(JOINTS)).Set(Vt.FloatArray.FromNumpy(weights))


def _blendshapes(
    stage: Any, mesh: Mesh, run: slice, path: str, shown: dict[str, str], turned: list[Any],
    binding: Any,
) -> None:  # fmt: skip
    from pxr import UsdSkel, Vt

    names, targets = [], []
    for name, turn in zip(mesh.shape_names, turned, strict=True):
        vertices, deltas = mesh.shape(name)
        moved = np.zeros((run.stop - run.start, 3), np.float32)
        inside = (vertices >= run.start) & (vertices < run.stop)
        moved[vertices[inside] - run.start] = deltas[inside]
        own = turn[run]
        used = np.flatnonzero(moved.any(axis=1) | (np.abs(own).max(axis=1) > TURNS))
        if not len(used):
            continue
        shape = UsdSkel.BlendShape.Define(stage, f"{path}/{shown[name]}")
        shape.CreateOffsetsAttr(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(moved[used])))
        turns = np.ascontiguousarray(own[used], np.float32)
        shape.CreateNormalOffsetsAttr(Vt.Vec3fArray.FromNumpy(turns))
        shape.CreatePointIndicesAttr(Vt.IntArray.FromNumpy(used.astype(np.int32)))
        names.append(shown[name])
        targets.append(shape.GetPath())
    if names:
        binding.CreateBlendShapesAttr(names)
        binding.CreateBlendShapeTargetsRel().SetTargets(targets)


def _play(stage: Any, sound: str, clip: Clip) -> None:
    from pxr import Sdf, UsdMedia

    audio = UsdMedia.SpatialAudio.Define(stage, "/Character/Sound")
    audio.CreateFilePathAttr(Sdf.AssetPath(sound))
    audio.CreateAuralModeAttr(UsdMedia.Tokens.nonSpatial)
    audio.CreatePlaybackModeAttr(UsdMedia.Tokens.onceFromStart)
    audio.CreateStartTimeAttr(Sdf.TimeCode(0))
    audio.CreateEndTimeAttr(Sdf.TimeCode(len(clip) - 1))
