"""One performance on every target: whether lips still meet, and how well they follow the head's.

    python bench/retarget.py [--sentences 50] [--sheet docs/rigs.png]

GRID speaker 1, test sentences, animated by the default engine and moved to each rig as `lipwright
animate --rig` does. Needs ../shared; --sheet draws one sentence on five targets.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from grid import Sentence, sentences
from lipwright.audio import open_audio
from lipwright.clip import Clip
from lipwright.evaluate.lips import BILABIALS, speech_span
from lipwright.face.head import load_head
from lipwright.face.mesh import Mesh
from lipwright.face.render import Renderer
from lipwright.face.shading import Camera, View
from lipwright.face.skinning import SkinnedMesh
from lipwright.files import write_whole
from lipwright.pipeline import ALIGNMENT_RATE, animate_track
from lipwright.retarget import retarget
from lipwright.retarget.skinned import posed_at, skin_mesh
from lipwright.rig import RIGS, Rig, load_rig
from lipwright.track import PhoneTrack

Floats = npt.NDArray[np.float64]
EXAMPLES = Path(__file__).parents[1] / "examples"
SHUT = 0.15  # of a clip's 95th percentile, as closures are measured against real faces
TOUCHING = 0.05  # of the same; where the head's own lips are taken for shut
SHOWN = ("arkit", "facefx", "vrm1", "bones", "crab")
MOMENTS = 9  # pictures of a row


@dataclass(frozen=True)
class Target:
    """A character and the lips that are measured on it."""

    rig: Rig
    mesh: Mesh
    gaps: Callable[[Clip], Floats]
    """(T,) of a clip in the rig's controls"""
    vertices: Callable[[Clip, Floats], list[npt.NDArray[np.float32]]]
    """posed (V, 3) at times in s"""
    view: View | Camera = "mouth"


def by_looks(rig: Rig) -> Target:
    """Our head, as the rig's controls look on it."""
    head = load_head()

    def posed(clip: Clip, times: Floats) -> list[npt.NDArray[np.float32]]:
        seen = rig.to_canonical(clip) if rig.looks else clip
        return list(head.pose_many(seen.select(head.shape_names).at(times)))

    def gaps(clip: Clip) -> Floats:
        seen = rig.to_canonical(clip) if rig.looks else clip
        return head.aperture_curve(seen.select(head.shape_names).values)

    return Target(rig, head, gaps, posed)


@cache
def bones() -> Target:
    """Our head on its bones."""
    head, rig = load_head(), load_rig("bones")
    skinned: SkinnedMesh = skin_mesh(head, rig)

    def posed(clip: Clip, times: Floats) -> list[npt.NDArray[np.float32]]:
        return list(posed_at(skinned, rig, clip, times))

    return Target(rig, head, lambda clip: head.aperture(np.stack(posed(clip, clip.times))), posed)


@cache
def crab() -> Target:
    """The crab of the examples, whose lips are looked at where they are farthest apart."""
    sys.path.insert(0, str(EXAMPLES))
    from crab.model import CAMERA
    from crab.model import crab as make
    from crab.mouth import lip_pairs

    mesh, pairs = make(), lip_pairs()

    def posed(clip: Clip, times: Floats) -> list[npt.NDArray[np.float32]]:
        return list(mesh.pose_many(clip.select(mesh.shape_names).at(times)))

    def gaps(clip: Clip) -> Floats:
        heights = np.stack(posed(clip, clip.times))[:, :, 1]
        start = next(part for part in mesh.parts if part.name == "shell").vertices.start
        upper, lower = (heights[:, start + pairs[:, side]] for side in (0, 1))
        return np.asarray(np.maximum(upper - lower, 0).max(axis=1), np.float64)

    return Target(load_rig(EXAMPLES / "crab" / "crab.rig.json"), mesh, gaps, posed, CAMERA)


def target(name: str) -> Target:
    """The target by the name of its rig."""
    return {"bones": bones, "crab": crab}.get(name, lambda: by_looks(load_rig(name)))()


def animated(sentence: Sentence) -> Clip:
    """The canonical curves of a sentence."""
    with open_audio(sentence.audio, ALIGNMENT_RATE) as sound:
        return animate_track(sentence.track, audio=sound)


@dataclass
class Score:
    """What is counted on one target."""

    r: list[float]
    shut: int = 0
    closures: int = 0
    bilabials: int = 0
    widest: float = 0.0
    """the largest aperture at a closure, of the 95th percentile"""


def measure(score: Score, source: Floats, moved: Floats, clip: Clip, track: PhoneTrack) -> None:
    """Add one sentence."""
    start, end = speech_span(track)
    inside = (clip.times >= start) & (clip.times <= end)
    score.r.append(float(np.corrcoef(source[inside], moved[inside])[0, 1]))
    own, theirs = source / np.percentile(source, 95), moved / np.percentile(moved, 95)
    for phone, first, last in track:
        if phone not in BILABIALS:
            continue
        score.bilabials += 1
        frames = np.flatnonzero((clip.times >= first - 0.02) & (clip.times <= last + 0.02))
        if own[frames].min() >= TOUCHING:
            continue
        tightest = float(theirs[frames].min())
        score.closures += 1
        score.shut += tightest < SHUT
        score.widest = max(score.widest, tightest)


def table(names: list[str], count: int) -> None:
    """Print a line a target."""
    chosen = sentences("test")[:count]
    clips = [animated(sentence) for sentence in chosen]
    head = target("arkit")
    sources = [head.gaps(clip) for clip in clips]
    print(f"{len(chosen)} sentences; closures: p b m at which the head's own lips meet")
    print(f"{'rig':14} {'controls':>8} {'r':>7} {'least r':>8} {'closures':>9} {'widest':>7}")
    for name in names:
        aim, score = target(name), Score([])
        for sentence, clip, source in zip(chosen, clips, sources, strict=True):
            moved = retarget(clip, aim.rig, sentence.track)
            measure(score, source, aim.gaps(moved), clip, sentence.track)
        print(
            f"{name:14} {len(aim.rig.controls):8} {np.mean(score.r):7.3f} {min(score.r):8.3f} "
            f"{score.shut:4}/{score.closures:<4} {score.widest:7.3f}",
            flush=True,
        )
    print(f"{score.bilabials} p b m in all")


def sheet(path: Path, size: int = 136) -> None:
    """Draw the test sentence with the most p b m on the five targets, a column a moment."""
    from PIL import Image, ImageDraw, ImageFont

    sentence = max(sentences("test"), key=lambda s: sum(p in BILABIALS for p in s.track.phones))
    clip, track = animated(sentence), sentence.track
    spoken = [index for index, phone in enumerate(track.phones) if phone != "sil"]
    chosen = [spoken[round(place)] for place in np.linspace(0, len(spoken) - 1, MOMENTS)]
    chosen = sorted({*chosen, *(i for i in spoken if track.phones[i] in BILABIALS)})
    times = np.array([(track.edges[i] + track.edges[i + 1]) / 2 for i in chosen])
    label, side = 40, 92
    picture = Image.new("RGB", (side + len(chosen) * size, len(SHOWN) * size + label), "white")
    pen, large, small = ImageDraw.Draw(picture), ImageFont.load_default(18), 14
    for row, name in enumerate(SHOWN):
        aim = target(name)
        moved = retarget(clip, aim.rig, track)
        pen.text((8, row * size + size / 2), name, "black", large, anchor="lm")
        with Renderer(aim.mesh, 2 * size, 2 * size, view=aim.view) as renderer:
            for column, vertices in enumerate(aim.vertices(moved, times)):
                drawn = Image.fromarray(renderer.draw(vertices)).resize((size, size))
                picture.paste(drawn, (side + column * size, row * size))
    for column, index in enumerate(chosen):
        word, middle = track.word_at(index), side + (column + 0.5) * size
        height = len(SHOWN) * size
        pen.text((middle, height + 18), word.text if word else "", "black", large, anchor="ms")
        pen.text((middle, height + 34), track.phones[index], "#555555",
                 ImageFont.load_default(small), anchor="ms")  # fmt: skip
    with write_whole(path) as part:
        picture.save(part, optimize=True)
    print(f"{path}: {sentence.text!r} on {', '.join(SHOWN)}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sentences", type=int, default=50)
    parser.add_argument("--rigs", nargs="*")
    parser.add_argument("--sheet", type=Path)
    chosen = parser.parse_args()
    if chosen.sheet:
        sheet(chosen.sheet)
        return
    own = [name for name in RIGS if load_rig(name).looks or name in ("arkit", "bones")]
    table(chosen.rigs or [*own, "crab"], chosen.sentences)


if __name__ == "__main__":
    main()
