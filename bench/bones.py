"""The rig `bones`: made from the installed head's blendshapes, and how well it shows them.

    python bench/bones.py --fit                  # make src/lipwright/rigs/bones.json anew (1 min)
    python bench/bones.py                        # what is left of each blendshape, and in speech
    python bench/bones.py --sheet docs/bone-rigs.png   # both heads in poses of speech

In speech: the head's own aperture against that of the head on bones, in examples/hello.flac and,
where the corpora are, ten test sentences of GRID. A frame counts as shut where the aperture is
under 5 % of its own 95th percentile, and as missed where the bones then leave 15 % of theirs.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt

from grid import CORPORA, sentences
from lipwright.clip import Clip
from lipwright.controls import CANONICAL, GROUPS, MIRROR
from lipwright.face.head import Head, load_head
from lipwright.face.png import write_png
from lipwright.face.render import Renderer, pose_weights
from lipwright.face.skinning import SkinnedMesh
from lipwright.pipeline import animate
from lipwright.retarget import retarget
from lipwright.retarget.bones import FitOptions, fit_bones, residuals
from lipwright.retarget.skinned import bone_channels, shape_transforms, skin_mesh
from lipwright.rig import Bone, Control, LinearMapping, Rig, Row, load_rig, save_rig
from lipwright.rig.values import CHANNELS

ROOT = Path(__file__).resolve().parents[1]
RIG_FILE = ROOT / "src" / "lipwright" / "rigs" / "bones.json"
HELLO = ROOT / "examples" / "hello"
SENTENCES = 10

# The ten bones of the thesis, section 4.6.2, below the head: seven of the lips, two of the tongue,
# one of the jaw. The jaw turns where the head's own jawOpen does, in front of the ears. The body
# holds the shirt when the head turns.
BONES = (
    Bone("body"),
    Bone("head", "body"),
    Bone("jaw", "head", (0.0, -0.004, 0.024)),
    Bone("lip_upper_mid", "head", (0.0, -0.022, 0.107)),
    Bone("lip_upper_left", "head", (0.0134, -0.023, 0.103)),
    Bone("lip_upper_right", "head", (-0.0134, -0.023, 0.103)),
    Bone("lip_corner_left", "head", (0.024, -0.028, 0.089)),
    Bone("lip_corner_right", "head", (-0.024, -0.028, 0.089)),
    Bone("lip_lower_left", "jaw", (0.010, -0.035, 0.101)),
    Bone("lip_lower_right", "jaw", (-0.010, -0.035, 0.101)),
    Bone("tongue_back", "jaw", (0.0, -0.034, 0.040)),
    Bone("tongue_front", "tongue_back", (0.0, -0.031, 0.070)),
)
# The head turns by the clip's headYaw, headPitch and headRoll, not by controls of its own.
STILL = ("body", "head")
CHIN = (0.0, -0.060, 0.100)  # m, what the jaw carries
# What an artist expects: the jaw moves for the jaw, the tongue for itself and to lie in the jaw.
FOLLOWS = {
    "jaw": GROUPS["jaw"],
    "tongue_back": (*GROUPS["jaw"], *GROUPS["tongue"]),
    "tongue_front": (*GROUPS["jaw"], *GROUPS["tongue"]),
}
SHAPES = (*GROUPS["jaw"], *GROUPS["lips"], "cheekPuff", *GROUPS["tongue"])

# The lips count most: a gap of a millimetre there is an open mouth.
LIP_COUNT = 10.0  # times the rest of the face
LIP_RADII_M = (0.030, 0.015, 0.020)  # m, around their contact
RIDGE = 1e-2  # lips that turn by half a circle for a tenth of a millimetre are no use to artists
ROUNDS = 15

SEEN_M = 5e-5  # m; a gain that moves nothing by this is not seen
LEVERS_M = {"jaw": 0.10}  # m, from a bone to the farthest that it carries
LEVER_M = 0.015  # m, of the other bones
ROOM = 2.0  # times the largest gain: how far a channel goes
LEAST_RANGE = (0.005, 10.0)  # m and degrees
DECIMALS = (5, 2)  # of m and degrees
REFLECT = np.array([-1.0, 1.0, 1.0, 1.0, -1.0, -1.0])  # of channels, left for right

LACKS = {
    **dict.fromkeys(
        ("eyeBlink", "eyeSquint", "eyeWide"),
        "keep the morph target, or add bones of the lids: none of the ten reaches them",
    ),
    **dict.fromkeys(
        ("eyeLookUp", "eyeLookDown", "eyeLookIn", "eyeLookOut"),
        "turn the eyeballs, which are parts of their own",
    ),
    **dict.fromkeys(
        ("browDown", "browInnerUp", "browOuterUp", "cheekSquint", "noseSneer"),
        "keep the morph target: none of the ten bones reaches so high",
    ),
}

POSES: dict[str, dict[str, float]] = {
    "rest": {},
    "aa": {"jawOpen": 0.5, "mouthLowerDown": 0.2, "mouthUpperUp": 0.2},
    "oo": {"mouthPucker": 0.8, "mouthFunnel": 0.3, "jawOpen": 0.12},
    "ee": {"mouthStretch": 0.4, "mouthSmile": 0.4, "jawOpen": 0.1, "mouthLowerDown": 0.2},
    "PP": {"mouthPress": 0.4, "jawOpen": 0.08, "mouthClose": 0.08, "mouthRollLower": 0.15,
           "mouthRollUpper": 0.1},
    "FF": {"mouthRollLower": 0.5, "mouthUpperUp": 0.35, "jawOpen": 0.06},
    "th": {"tonguePress": 0.95, "tongueOut": 0.08, "jawOpen": 0.15, "mouthUpperUp": 0.2,
           "mouthLowerDown": 0.2},
    "sh": {"mouthFunnel": 0.5, "mouthPucker": 0.3, "jawOpen": 0.08, "mouthUpperUp": 0.3,
           "mouthLowerDown": 0.25},
}  # fmt: skip


def make_rig(head: Head) -> Rig:
    """The rig, fitted to the head and made symmetric."""
    lips = head.vertices[head.lip_pairs].reshape(-1, 3).mean(axis=0)
    far = np.linalg.norm((head.vertices - lips) / LIP_RADII_M, axis=1)
    options = FitOptions(
        still=STILL,
        grips={"jaw": CHIN},
        follows=FOLLOWS,
        rounds=ROUNDS,
        ridge=RIDGE,
        importance=1 + LIP_COUNT * np.exp(-0.5 * far**2),
    )
    transforms = _symmetric(fit_bones(head, BONES, SHAPES, options).transforms)
    rows, controls = {}, []
    for number, bone in enumerate(BONES):
        for column, channel in enumerate(CHANNELS):
            if bone.name in STILL:
                continue
            turns = channel.startswith("r")
            gains = _gains(transforms[:, number, column], turns, LEVERS_M.get(bone.name, LEVER_M))
            largest = max([*map(abs, gains.values()), LEAST_RANGE[turns] / ROOM])
            reach = float(np.ceil(ROOM * largest * (1 if turns else 1000)) / (1 if turns else 1000))
            name = f"{bone.name}.{channel}"
            controls.append(Control(name, -reach, reach))
            if gains:
                rows[name] = Row(gains)
    names = [control.name for control in controls]
    return Rig(
        name="bones",
        title="ten bones of lips, tongue and jaw, as in the thesis",
        controls=tuple(controls),
        mirror={name: _other(name) for name in names if _other(name) != name},
        bones=BONES,
        mapping=LinearMapping(rows),
        lacks=LACKS,
        source="bones of Swedish visual speech (thesis, 2018), section 4.6.2; places and gains are "
        "ours, fitted to the MakeHuman head (CC0) by bench/bones.py",
        license="Apache-2.0",
    )


def _gains(column: npt.NDArray[np.float64], turns: bool, lever: float) -> dict[str, float]:
    """Blendshape to gain, without those that are not seen."""
    least = np.degrees(SEEN_M / lever) if turns else SEEN_M
    return {
        shape: round(float(gain), DECIMALS[turns])
        for shape, gain in zip(SHAPES, column, strict=True)
        if abs(gain) >= least
    }


def _other(name: str) -> str:
    """The same channel on the other side."""
    swapped = name.replace("_left.", "_?.").replace("_right.", "_left.")
    return swapped.replace("_?.", "_right.")


def _symmetric(transforms: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """The mean of transforms (C, B, 6) and their mirror image."""
    shapes = [SHAPES.index(MIRROR[shape]) for shape in SHAPES]
    names = [f"{bone.name}." for bone in BONES]
    bones = [names.index(_other(name)) for name in names]
    return np.asarray((transforms + transforms[shapes][:, bones] * REFLECT) / 2)


def speech() -> Iterator[tuple[str, Clip]]:
    """Canonical curves of what is said, by the default engine."""
    said = HELLO.with_suffix(".txt").read_text("utf-8")
    yield "hello", animate(HELLO.with_suffix(".flac"), said).clip
    if CORPORA.exists():
        for sentence in sentences("test")[:SENTENCES]:
            yield sentence.name, animate(sentence.audio, sentence.text).clip


def print_speech(head: Head, skinned: SkinnedMesh, rig: Rig) -> None:
    """Aperture on bones against that of the blendshapes."""
    print("| said | r | worst gap where shut, of the 95th percentile | missed |")
    print("| --- | ---: | ---: | ---: |")
    for name, clip in speech():
        own = head.aperture_curve(clip.select(CANONICAL).values)
        channels = bone_channels(retarget(clip, rig), rig)
        boned = np.array([float(head.aperture(posed)) for posed in skinned.pose_many(channels)])
        shares = (boned / np.percentile(boned, 95))[own < 0.05 * np.percentile(own, 95)]
        r = np.corrcoef(own, boned)[0, 1]
        print(f"| {name} | {r:.4f} | {shares.max():.1%} | {(shares >= 0.15).sum()} |", flush=True)


def print_residuals(skinned: SkinnedMesh, rig: Rig) -> None:
    """What bones cannot show of each blendshape."""
    print("| blendshape | rms mm | worst mm | rms of its motion |")
    print("| --- | ---: | ---: | ---: |")
    for row in residuals(skinned, SHAPES, shape_transforms(rig, SHAPES)):
        print(f"| {row.shape} | {row.rms_mm:.2f} | {row.worst_mm:.1f} | {row.share:.0%} |")


def write_sheet(head: Head, skinned: SkinnedMesh, rig: Rig, path: Path) -> None:
    """Two rows of pairs: blendshapes above, bones below."""
    tiles: list[list[npt.NDArray[np.uint8]]] = [[], []]
    with Renderer(head, 256, 256, view="mouth") as renderer:
        for pose in POSES.values():
            sided = {
                side: weight
                for name, weight in pose.items()
                for side in ((name,) if name in CANONICAL else (f"{name}Left", f"{name}Right"))
            }
            weights = pose_weights(**sided)
            clip = retarget(Clip(CANONICAL, 1.0, weights[None]), rig)
            tiles[0].append(renderer.render(weights))
            tiles[1].append(renderer.draw(skinned.pose(bone_channels(clip, rig)[0])))
    half = len(POSES) // 2
    rows = [np.hstack(row[part]) for part in (slice(half), slice(half, None)) for row in tiles]
    write_png(path, np.vstack(rows))


def main() -> None:
    """Make the rig, or say how good it is."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--fit", action="store_true", help="make the rig anew")
    parser.add_argument("--sheet", type=Path, help="write a picture of poses")
    options = parser.parse_args()
    head = load_head()
    if options.fit:
        save_rig(make_rig(head), RIG_FILE)
    rig = load_rig(RIG_FILE)
    skinned = skin_mesh(head, rig)
    if options.sheet:
        write_sheet(head, skinned, rig, options.sheet)
        return
    print_residuals(skinned, rig)
    print()
    print_speech(head, skinned, rig)


if __name__ == "__main__":
    main()
