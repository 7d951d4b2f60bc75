"""Fit the mappings of the rigs that ship with looks, and measure their lips on our head.

    python bench/fit_rigs.py                # fit all, compare with what ships, and measure
    python bench/fit_rigs.py vrm1 facefx    # these
    python bench/fit_rigs.py --write        # also write the mappings into src/lipwright/rigs

Fitted are the rows of a rig's mouth (`FITTED`); rows of its eyes and brows stay as its file has
them, and so does what the file says that the rig lacks. The default engine animates
`examples/hello.flac` and, where the corpora are, the first 10 test sentences of GRID speaker 1:

- r: correlation of the lips' aperture, the head of canonical controls against the rig's looks on
  the same head, over each recording; the lowest and the mean;
- lost: frames in which the first is shut, under 5 % of its 95th percentile, and the second is not,
  15 % or more of its own;
- left: mm of the motion of the mean vertex that the rig does not show, of how many there are.

Drawn mouths are measured as blends here: what their shapes at one time would look like.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path

import numpy as np

from grid import CORPORA, sentences
from lipwright.audio import open_audio
from lipwright.clip import Clip
from lipwright.controls import CANONICAL, both_sides
from lipwright.face.head import Head, load_head
from lipwright.pipeline import ALIGNMENT_RATE, AnimateOptions, animate, animate_track
from lipwright.retarget import apply_linear
from lipwright.retarget.fitting import FitOptions, Fitted, fit_looks
from lipwright.rig import LinearMapping, Rig, load_rig, rig_to_text, save_rig

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
SENTENCES = 10
SHUT, OPEN = 0.05, 0.15  # of the 95th percentile

FITTED: Mapping[str, tuple[str, ...]] = {
    "facefx": (),
    "smartbody": (
        "ah", "bmp", "ee", "lowerLipDown", "lowerLipUp", "oh", "oo", "sh", "stickyLips", "tBack",
        "tRoof", "tTeeth",
    ),
    "oculus": (),
    "vrm1": ("aa", "ih", "ou", "ee", "oh"),
    "vrm0": ("A", "I", "U", "E", "O"),
    "mmd": ("あ", "い", "う", "え", "お", "ん"),
    "preston-blair": (),
    "rhubarb": (),
}  # fmt: skip
"""rig to the controls that are fitted; none means all"""

UNSEEN = "nothing: these shapes show too little of it"


def fit(rig: Rig, head: Head) -> tuple[Rig, Fitted]:
    """The rig with a fitted mapping, and how well it does."""
    chosen = FITTED[rig.name] or rig.names
    fitted = fit_looks(rig, head, FitOptions(controls=chosen))
    assert isinstance(rig.mapping, LinearMapping)
    kept = {name: row for name, row in rig.mapping.rows.items() if name not in chosen}
    winks = [c for c in rig.mapping.correctives if c.control not in chosen]
    mapping = LinearMapping({**fitted.mapping.rows, **kept}, (*fitted.mapping.correctives, *winks))
    return replace(rig, mapping=mapping, lacks=lacking(rig, mapping)), fitted


def lacking(rig: Rig, mapping: LinearMapping) -> dict[str, str]:
    """What the file says of the canonical controls that are not heard, in its order."""
    said = {name: what for name, what in rig.lacks.items() if what != UNSEEN}
    known = {side: what for name, what in said.items() for side in both_sides(name)}
    unheard = [name for name in CANONICAL if name not in mapping.sources]
    lacks: dict[str, str] = {}
    for name in unheard:
        stem = name.removesuffix("Left").removesuffix("Right")
        both = set(both_sides(stem)) if stem != name else {name}
        what = known.get(name, UNSEEN)
        whole = both <= set(unheard) and {known.get(side, UNSEEN) for side in both} == {what}
        lacks[stem if whole and stem not in ("jaw", "mouth") else name] = what
    return lacks


def motions() -> Iterator[tuple[str, Clip]]:
    """Recording to canonical curves of the default engine."""
    text = (EXAMPLES / "hello.txt").read_text("utf-8")
    yield "hello", animate(EXAMPLES / "hello.flac", text).performance.clip
    if not CORPORA.is_dir():
        return
    for sentence in sentences("test")[:SENTENCES]:
        with open_audio(sentence.audio, ALIGNMENT_RATE) as sound:
            yield sentence.name, animate_track(sentence.track, AnimateOptions(), sound)


@dataclass(frozen=True)
class Lips:
    """How the lips of a rig follow those of the head."""

    r: float
    lost: int
    """frames"""
    shut: int
    """frames"""


def compare(clip: Clip, rig: Rig, head: Head) -> Lips:
    """The aperture of a clip against that of the rig that follows it."""
    assert isinstance(rig.mapping, LinearMapping)
    shown = rig.to_canonical(apply_linear(clip, rig, rig.mapping))
    reference = head.aperture_curve(clip.select(CANONICAL).values)
    estimated = head.aperture_curve(shown.values)
    shut = reference < SHUT * np.percentile(reference, 95)
    lost = shut & (estimated >= OPEN * np.percentile(estimated, 95))
    return Lips(float(np.corrcoef(reference, estimated)[0, 1]), int(lost.sum()), int(shut.sum()))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rigs", nargs="*", default=[*FITTED], metavar="RIG")
    parser.add_argument("--write", action="store_true", help="write src/lipwright/rigs/RIG.json")
    options = parser.parse_args()
    head = load_head()
    clips = dict(motions())
    print(f"{'rig':14} {'r hello':>8} {'r min':>7} {'r mean':>7} {'lost':>9} {'left':>14}  gains")
    for name in options.rigs:
        shipped = load_rig(name)
        rig, fitted = fit(shipped, head)
        lips = {said: compare(clip, rig, head) for said, clip in clips.items()}
        r = [each.r for each in lips.values()]
        lost = f"{sum(x.lost for x in lips.values())}/{sum(x.shut for x in lips.values())}"
        left = f"{fitted.error:.2f} of {fitted.motion:.2f}"
        gains = sum(len(row.gains) for row in fitted.mapping.rows.values())
        same = "as shipped" if rig_to_text(rig) == rig_to_text(shipped) else "differs from shipped"
        print(
            f"{name:14} {r[0]:8.3f} {min(r):7.3f} {np.mean(r):7.3f} {lost:>9} {left:>14}  "
            f"{gains}, {same}",
            flush=True,
        )
        if options.write:
            save_rig(rig, Path(str(files("lipwright"))) / "rigs" / f"{name}.json")


if __name__ == "__main__":
    main()
