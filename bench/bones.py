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
from lipwright.retarget.bone_rig import RIDGE, lip_importance, other_side, rig_of_bones
from lipwright.retarget.bones import FitOptions, fit_bones, residuals
from lipwright.retarget.skinned import bone_channels, shape_transforms, skin_mesh
from lipwright.rig import Bone, Control, Rig, load_rig, save_rig

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

ROUNDS = 15
TILE = 192  # px, a side of each picture
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
    options = FitOptions(
        still=STILL,
        grips={"jaw": CHIN},
        follows=FOLLOWS,
        rounds=ROUNDS,
        ridge=RIDGE,
        importance=lip_importance(head, BONES),
    )
    transforms = _symmetric(fit_bones(head, BONES, SHAPES, options).transforms)
    about = Rig(
        name="bones",
        title="ten bones of lips, tongue and jaw, as in the thesis",
        controls=(Control("jaw.rx"),),
        mirror={},
        lacks=LACKS,
        source="bones of Swedish visual speech (thesis, 2018), section 4.6.2; places and gains are "
        "ours, fitted to the MakeHuman head (CC0) by bench/bones.py",
        license="Apache-2.0",
    )
    return rig_of_bones(about, BONES, SHAPES, transforms, float(np.ptp(head.vertices[:, 1])))


def _symmetric(transforms: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """The mean of transforms (C, B, 6) and their mirror image."""
    shapes = [SHAPES.index(MIRROR[shape]) for shape in SHAPES]
    names = [bone.name for bone in BONES]
    bones = [names.index(other_side(name)) for name in names]
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
    with Renderer(head, TILE, TILE, view="mouth") as renderer:
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
