"""How well the ARKit weights solved from landmarks follow real faces.

    python bench/solve.py [--split test] [--untied] [--picture OUT.png --sentences NAME...]

Prints how the posed head's aperture follows the tracked one (less the speaker's own gap of shut
lips) through speech: r, gain, closures; on our head and on the second one. Then what the weights
do in silence, by phone, in blinks, and how they shake. `--picture` draws frames beside the head.
"""

from __future__ import annotations

import argparse
import time
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from grid import Sentence, sentences
from heads import rulers
from lipwright.capture.pose import remove_pose
from lipwright.capture.solve import SolveOptions, lip_gap, neutral_face, solve_arkit
from lipwright.clip import Clip
from lipwright.controls import ARKIT, MIRROR
from lipwright.evaluate.lips import BILABIALS, CLOSED, speech_span
from lipwright.face.head import load_head

Floats = npt.NDArray[np.float64]

FPS = 25
SPURIOUS = (
    "mouthFrownLeft", "mouthShrugLower", "mouthShrugUpper", "mouthPressLeft", "mouthRollLower",
    "mouthRollUpper", "noseSneerLeft",
)  # fmt: skip
SHOWN = (
    "jawOpen", "mouthClose", "mouthFunnel", "mouthPucker", "mouthSmileLeft", "mouthStretchLeft",
    "mouthDimpleLeft", "mouthFrownLeft", "mouthRollLower", "mouthRollUpper", "mouthPressLeft",
    "mouthShrugLower", "mouthShrugUpper", "mouthLowerDownLeft", "mouthUpperUpLeft", "jawForward",
    "cheekPuff", "cheekSquintLeft", "noseSneerLeft",
)  # fmt: skip


@dataclass
class Solved:
    """One sentence."""

    sentence: Sentence
    landmarks: Floats
    tracked: Floats
    """(T,), aperture less the gap of shut lips"""
    weights: Floats
    """(T, 52)"""
    seconds: float

    @property
    def times(self) -> Floats:
        """(T,) s."""
        return self.sentence.aperture.times

    @property
    def speech(self) -> npt.NDArray[np.bool_]:
        """(T,) whether somebody speaks."""
        start, end = speech_span(self.sentence.track)
        return (self.times >= start) & (self.times <= end)

    @property
    def clip(self) -> Clip:
        """The weights as curves."""
        return Clip(ARKIT, FPS, self.weights)


def quiet_frames(sentence: Sentence) -> npt.NDArray[np.bool_]:
    """(T,) whether the frame lies in silence."""
    times = sentence.aperture.times
    quiet = np.zeros(len(times), bool)
    for phone, start, end in sentence.track:
        quiet |= (phone == "sil") & (times >= start) & (times < end)
    return quiet


def solve(sentence: Sentence, options: SolveOptions) -> Solved:
    """Solve one sentence."""
    landmarks = remove_pose(sentence.landmarks, FPS)[0].astype(float)
    aperture = sentence.aperture.values
    neutral = neutral_face(landmarks, aperture, quiet_frames(sentence))
    start = time.perf_counter()
    weights = solve_arkit(landmarks, aperture, load_head(), FPS, neutral, options).astype(float)
    took = time.perf_counter() - start
    return Solved(sentence, landmarks, np.maximum(aperture - lip_gap(neutral), 0), weights, took)


def follow(tracked: list[Floats], posed: list[Floats], masks: list[npt.NDArray[np.bool_]]) -> None:
    """Print how posed apertures follow tracked ones through speech."""
    rows = []
    hit = real = 0
    for real_, guess, mask in zip(tracked, posed, masks, strict=True):
        a, b = real_[mask], guess[mask]
        rows.append(
            (np.corrcoef(a, b)[0, 1], np.polyfit(a, b, 1)[0],
             np.percentile(b, 95) / np.percentile(a, 95))
        )  # fmt: skip
        shut = real_ < CLOSED * np.percentile(real_, 95)
        real += shut.sum()
        hit += (shut & (guess < CLOSED * np.percentile(guess, 95))).sum()
    table = np.array(rows)
    a = np.concatenate([t[m] for t, m in zip(tracked, masks, strict=True)])
    b = np.concatenate([t[m] for t, m in zip(posed, masks, strict=True)])
    pooled = np.corrcoef(a, b)[0, 1], np.polyfit(a, b, 1)[0]
    pooled_ratio = np.percentile(b, 95) / np.percentile(a, 95)
    for name, column in zip(("r", "slope", "p95 ratio"), table.T, strict=True):
        print(
            f"  {name:10s} each {column.min():.4f} to {column.max():.4f},"
            f" median {np.median(column):.4f}"
        )
    print(f"  pooled     r {pooled[0]:.4f}  slope {pooled[1]:.4f}  p95 ratio {pooled_ratio:.4f}")
    print(f"  shut frames that are shut too: {hit} of {real} ({hit / real:.2%})")


def bilabials(found: list[Solved], posed: list[Floats]) -> None:
    """Print how many p b m whose tracked lips shut are shut on the head, in the same frames."""
    hit = real = 0
    for item, guess in zip(found, posed, strict=True):
        limit, own = (CLOSED * np.percentile(v, 95) for v in (item.tracked, guess))
        for phone, start, end in item.sentence.track:
            if phone in BILABIALS:
                near = (item.times >= start - 0.04) & (item.times <= end + 0.04)
                shut = near & (item.tracked < limit)
                real += bool(shut.any())
                hit += bool((guess[shut] < own).any())
    print(f"  p b m that shut: {hit} of {real}")


def by_phone(found: list[Solved]) -> None:
    """Print the mean weights of each phone, in percent."""
    frames: dict[str, list[Floats]] = defaultdict(list)
    for item in found:
        for phone, start, end in item.sentence.track:
            inside = (item.times >= start) & (item.times < end)
            frames[phone].append(item.weights[inside])
    print("\nmean weight by phone, percent")
    print(
        f"{'':4s}{'n':>5s} "
        + " ".join(n.removeprefix("mouth").replace("Left", "")[:8].rjust(8) for n in SHOWN)
    )
    columns = [ARKIT.index(n) for n in SHOWN]
    means = {p: np.concatenate(w) for p, w in frames.items()}
    for phone in sorted(means, key=lambda p: -means[p][:, ARKIT.index("jawOpen")].mean()):
        row = 100 * means[phone][:, columns].mean(axis=0)
        print(f"{phone:4s}{len(means[phone]):5d} " + " ".join(f"{v:8.1f}" for v in row))


def at_rest(found: list[Solved]) -> None:
    """Print what moves in silence."""
    silent = np.concatenate([item.weights[quiet_frames(item.sentence)] for item in found])
    print(f"\nin silence ({len(silent)} frames)        mean    p95")
    for name in ARKIT:
        column = silent[:, ARKIT.index(name)]
        if MIRROR[name] >= name and (name in SPURIOUS or column.mean() > 0.01):
            mark = "*" if name in SPURIOUS else " "
            print(f"{mark} {name:24s} {column.mean():9.4f} {np.percentile(column, 95):6.3f}")


def shaking(found: list[Solved]) -> None:
    """Print the second differences of posed lips against those of tracked lips."""
    from lipwright.capture.correspondence import landmark_shapes

    shapes = landmark_shapes(load_head())[:, :, :2]
    lips = [0, 17, 13, 14, 61, 291, 37, 267, 84, 314]
    posed, tracked = [], []
    for item in found:
        moved = np.tensordot(item.weights, shapes[:, lips], axes=1)
        posed.append(np.diff(moved, 2, axis=0).ravel())
        tracked.append(np.diff(item.landmarks[:, lips, :2], 2, axis=0).ravel())
    rms = [np.sqrt(np.mean(np.concatenate(v) ** 2)) for v in (posed, tracked)]
    second = np.concatenate([np.diff(i.weights, 2, axis=0) for i in found])
    worst = np.argsort(-np.sqrt((second**2).mean(axis=0)))[:8]
    print(
        "\nsecond differences of the lips, rms, eye distances:"
        f" posed {rms[0]:.4f}, tracked {rms[1]:.4f}"
    )
    print(
        "  of weights: "
        + ", ".join(f"{ARKIT[i]} {np.sqrt((second[:, i] ** 2).mean()):.3f}" for i in worst)
    )


def eyes(found: list[Solved]) -> None:
    """Print how eyeBlink follows the lids."""
    lids, blinks = [], []
    for item in found:
        p = item.landmarks
        gap = np.mean(
            [
                np.linalg.norm(p[:, a, :2] - p[:, b, :2], axis=-1)
                for a, b in ((159, 145), (386, 374))
            ],
            axis=0,
        )
        lids.append(gap / np.median(gap))
        blinks.append(item.weights[:, ARKIT.index("eyeBlinkLeft")])
    opening, blink = np.concatenate(lids), np.concatenate(blinks)
    print(f"\neyeBlink against the lids' opening: r {np.corrcoef(opening, blink)[0, 1]:.3f}")
    for low, high in ((0, 0.3), (0.3, 0.5), (0.5, 0.7), (0.7, 0.9), (0.9, 1.1), (1.1, 2)):
        inside = (opening >= low) & (opening < high)
        if inside.any():
            print(
                f"  opening {low:.1f} to {high:.1f}: {inside.sum():5d} frames,"
                f" eyeBlink {blink[inside].mean():.2f}"
            )


def read_pictures(path: Path) -> list[npt.NDArray[np.uint8]]:
    """The frames of a video, (H, W, 3)."""
    import av

    with av.open(str(path)) as container:
        return [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]


def draw(found: list[Solved], path: Path, phones: list[str], view: str) -> None:
    """Draw, of each sentence, the middle frames of some phones beside the head."""
    from PIL import Image, ImageDraw

    from lipwright.controls import CANONICAL
    from lipwright.face.render import Renderer

    tiles = []
    with Renderer(load_head(), 300, 300, view=view) as renderer:  # type: ignore[arg-type]
        for item in found:
            frames = read_pictures(item.sentence.video)
            clip = item.clip.select(CANONICAL).values
            for phone, start, end in item.sentence.track:
                if phones and phone not in phones:
                    continue
                index = min(int((start + end) / 2 * FPS), len(clip) - 1)
                points = item.sentence.landmarks[index, :, :2]
                centre = points[[1, 61, 291] if view == "face" else [61, 291, 17]].mean(axis=0)
                half = item.sentence.eyes[index] * (1.7 if view == "face" else 0.87)
                box = (*(centre - half), *(centre + half))
                photo = Image.fromarray(frames[index]).crop(box).resize((300, 300))
                ImageDraw.Draw(photo).text(
                    (4, 4), f"{item.sentence.name} {phone} {index}", fill="yellow"
                )
                tiles.append(np.vstack([np.asarray(photo), renderer.render(clip[index])]))
    columns = min(8, len(tiles))
    tiles += [np.zeros_like(tiles[0])] * (-len(tiles) % columns)
    rows = [np.hstack(tiles[i : i + columns]) for i in range(0, len(tiles), columns)]
    Image.fromarray(np.vstack(rows)).save(path)


def main() -> None:
    """Solve a split and print its figures."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--split", default="test", choices=("test", "validation", "train", "all"))
    parser.add_argument("--untied", action="store_true", help="left and right on their own")
    parser.add_argument("--picture", type=Path, help="draw frames beside the head, print nothing")
    parser.add_argument("--sentences", nargs="*", default=[], help="only these")
    parser.add_argument("--phones", nargs="*", default=[], help="of the pictures; default all")
    parser.add_argument("--view", default="face", choices=("face", "mouth"))
    arguments = parser.parse_args()
    options = SolveOptions(tied=not arguments.untied)
    chosen = [
        s
        for s in sentences(arguments.split)
        if not arguments.sentences or s.name in arguments.sentences
    ]
    found = [solve(sentence, options) for sentence in chosen]
    if arguments.picture:
        draw(found, arguments.picture, arguments.phones, arguments.view)
        return
    took = [item.seconds for item in found]
    print(f"{len(found)} sentences, {np.median(took):.3f} s each (at most {max(took):.3f})")
    for name, ruler in rulers().items():
        posed = [ruler(item.clip) for item in found]
        print(f"\n{name}")
        follow([i.tracked for i in found], posed, [i.speech for i in found])
        bilabials(found, posed)
    by_phone(found)
    at_rest(found)
    eyes(found)
    shaking(found)


if __name__ == "__main__":
    main()
