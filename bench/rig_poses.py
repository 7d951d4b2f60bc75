"""How well poses of the reference face's modes carry speech over to a rig.

    python bench/rig_poses.py                     # the 50 GRID test sentences, three engines
    python bench/rig_poses.py --pictures docs     # draws docs/rig-poses-crab.png alone

Each engine's curves go through the modes and back to a human face by its shipped poses, with and
without the shut pose. r is that of the lips' aperture on the head, before and after, inside speech;
gain the slope of the one over the other; shut counts the p, b and m at which the lips meet. The
crab's gap is measured on its own lips. Needs `lipwright head install`.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from grid import Sentence, sentences
from lipwright.audio import open_audio
from lipwright.clip import Clip
from lipwright.controls import CANONICAL
from lipwright.evaluate.lips import BILABIALS, speech_span
from lipwright.face.head import load_head
from lipwright.face.outlines import PAPER, draw_words, sheet
from lipwright.face.png import write_png
from lipwright.face.render import Renderer
from lipwright.pipeline import ALIGNMENT_RATE, AnimateOptions, animate, animate_track
from lipwright.retarget.pose_table import pose_labels
from lipwright.retarget.poses import apply_poses, human_mapping
from lipwright.rig import PoseMapping, Rig, canonical_rig, load_rig
from lipwright.track import PhoneTrack

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
sys.path.insert(0, str(EXAMPLES))

from crab.model import CAMERA, crab  # noqa: E402  # beside the example that uses them
from crab.mouth import lip_pairs  # noqa: E402

ENGINES = ("window", "dominance", "bigram")
MODE_COUNTS = (1, 2, 3, 4, 6, 8)
FPS = 60.0
SHUT = 2e-3  # eye distances of aperture, a tenth of a mm, that nobody sees
CRAB_M = 0.05  # of which the shut gap of the crab is a tenth of a mm as well
SHOWN = (2, 14, 22, 26, 34, 50, 54, 58, 66, 78)  # phones of the example
Curve = npt.NDArray[np.floating]


def head_aperture(clip: Clip) -> Curve:
    return load_head().aperture_curve(clip.select(CANONICAL).values)


def crab_gap(clip: Clip) -> Curve:
    """(T,) of `CRAB_M`, the widest gap between the crab's lips."""
    mesh = crab()
    rest = mesh.vertices[lip_pairs(), 1].astype(float)
    shapes = np.stack([mesh.pose(row)[lip_pairs(), 1] - rest for row in np.eye(len(POSES))])
    heights = np.tensordot(clip.select(POSES).values, shapes, axes=1) + rest
    return np.asarray(np.maximum(heights[..., 0] - heights[..., 1], 0.0).max(axis=1) / CRAB_M)


POSES = crab().shape_names
MEASURES = {"arkit": head_aperture, "crab": crab_gap}


def clip_of(sentence: Sentence, engine: str) -> Clip:
    with open_audio(sentence.audio, ALIGNMENT_RATE) as sound:
        return animate_track(sentence.track, AnimateOptions(engine=engine, fps=FPS), sound)


def score(source: Curve, made: Curve, track: PhoneTrack) -> list[float]:
    """r, gain, closures and how many there are."""
    first, last = (int(time * FPS) for time in speech_span(track))
    before, after = source[first:last], made[first:last]
    spans = [(int(a * FPS), int(np.ceil(b * FPS)) + 1) for p, a, b in track if p in BILABIALS]
    shut = sum(bool(made[a:b].min() < SHUT) for a, b in spans)
    r = np.corrcoef(before, after)[0, 1]
    return [r, np.polyfit(before, after, 1)[0], shut, len(spans)]


def measure() -> None:
    variants: dict[str, tuple[Rig, PoseMapping]] = {}
    for count in MODE_COUNTS:
        mapping = human_mapping(modes=count)
        variants[f"{count} modes, no shut pose"] = canonical_rig(), replace(mapping, shut={})
        variants[f"{count} modes"] = canonical_rig(), mapping
    rig = load_rig(EXAMPLES / "crab" / "crab.rig.json")
    assert isinstance(rig.mapping, PoseMapping)
    variants["the crab, 4 modes"] = rig, rig.mapping
    for engine in ENGINES:
        rows: dict[str, list[list[float]]] = {name: [] for name in ("itself", *variants)}
        for sentence in sentences("test"):
            clip, track = clip_of(sentence, engine), sentence.track
            source = head_aperture(clip)
            rows["itself"].append(score(source, source, track))
            for name, (target, mapping) in variants.items():
                made = MEASURES[target.name](apply_poses(clip, target, mapping))
                rows[name].append(score(source, made, track))
        for name, found in rows.items():
            r, gain, shut, real = np.array(found).T
            print(f"{engine:10} {name:22} r {r.mean():.4f}, least {r.min():.4f}; gain "
                  f"{gain.mean():.2f}; shut {shut.sum():.0f} of {real.sum():.0f}")  # fmt: skip


def draw(folder: Path) -> None:
    """The crab's poses, and what the default engine says through them, beside the head."""
    rig, mesh, head = load_rig(EXAMPLES / "crab" / "crab.rig.json"), crab(), load_head()
    assert isinstance(rig.mapping, PoseMapping)
    p = np.zeros((9, 4), np.float32)
    for index in range(8):
        p[index + 1, index // 2] = 3 if index % 2 else -3
    modes = Clip(("shape1", "shape2", "shape3", "shape4"), 1, p)
    text = (EXAMPLES / "hello.txt").read_text("utf-8")
    said = animate(EXAMPLES / "hello.flac", text, options=AnimateOptions(fps=FPS))
    middles = (said.track.edges[:-1] + said.track.edges[1:]) / 2
    frames = np.rint(middles * FPS).astype(int)[list(SHOWN)]
    with Renderer(mesh, 240, 180, view=CAMERA) as renderer:
        posed = apply_poses(modes, rig, replace(rig.mapping, shut={})).select(POSES).values
        rest = renderer.render(np.zeros(len(POSES)))
        labels = ("mean", *pose_labels())
        stills = [draw_words(renderer.render(row), label, 9, PAPER)
                  for row, label in zip(posed, labels, strict=True)]  # fmt: skip
        talk = apply_poses(said.clip, rig, rig.mapping).select(POSES).values[frames]
        below = [renderer.render(row) for row in talk]
    with Renderer(head, 240, 180, view="mouth") as renderer:
        above = [renderer.render(r) for r in said.clip.select(CANONICAL).values[frames]]
    tiles = [*stills, draw_words(rest, "shut", 9, PAPER)]
    rows = [tiles[:5], tiles[5:], above[:5], below[:5], above[5:], below[5:]]
    write_png(folder / "rig-poses-crab.png", sheet(rows))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pictures", type=Path, metavar="FOLDER")
    options = parser.parse_args()
    if options.pictures is None:
        measure()
    else:
        draw(options.pictures)


if __name__ == "__main__":
    main()
