"""What each step of the runtime does to the curves of a line: figures 6 to 10 of the paper.

Xu et al. 2013, section 2.2: the curves of the pairs, stitched, without valleys, within the
constraints, within the speed limit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from lipwright.bigrams.runtime import Span, pair_clips, stitch
from lipwright.bigrams.values import BigramSet
from lipwright.clip import Clip
from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.files import write_whole
from lipwright.passes.poses import bigram_passes
from lipwright.track import PhoneTrack

FPS: Final = 200.0  # finer than any picture shows
MOST_POSES: Final = 4  # that are told apart in one panel
MOST_SECONDS: Final = 20.0  # that phones can be read in
PACE: Final = 3.6  # inches a second
WIDTHS: Final = (9.0, 40.0)  # inches, least and most
PANEL_HEIGHT: Final = 1.75  # inches
DPI: Final = 110

COLOURS: Final = ("#c8323f", "#1a6fb5", "#b87400", "#1d8a5f")  # told apart by most eyes
PALE: Final = 0.55  # opacity of the curve before
GREY, BAND = "#5b6472", "#f1f3f7"


@dataclass(frozen=True, eq=False)
class Steps:
    """The curves after each step."""

    pairs: Sequence[tuple[Span, Clip]]
    clips: Sequence[Clip]
    """stitched, without valleys, within the constraints, within the speed limit"""


def run_steps(bigrams: BigramSet, track: PhoneTrack, fps: float = FPS) -> Steps:
    """The runtime, step by step."""
    clips = [stitch(bigrams, track, fps)]
    for step in bigram_passes(bigrams):
        clips.append(step(clips[-1], track))
    return Steps(pair_clips(bigrams, track, fps), clips)


def write_panels(
    path: Path, bigrams: BigramSet, track: PhoneTrack, poses: Sequence[str] = ()
) -> tuple[str, ...]:
    """Draw the five panels; the poses that are drawn.

    Args:
        path: the PNG.
        bigrams: the set.
        track: what is said.
        poses: to draw, at most four; by default those that move most.

    Raises:
        LipwrightError: an unknown pose, too many, a track too long to read, or the file cannot
            be written.
    """
    if track.end > MOST_SECONDS:
        raise LipwrightError(
            f"the line lasts {track.end:.0f} s; draw at most {MOST_SECONDS:.0f} s at a time"
        )
    for pose in poses:
        if pose not in bigrams.poses:
            raise LipwrightError(
                f"{bigrams.name} has no pose {pose[:40]!r}; it has: {', '.join(bigrams.poses)}"
            )
    if len(set(poses)) > MOST_POSES:
        raise LipwrightError(f"{len(set(poses))} poses in one picture; give at most {MOST_POSES}")
    steps = run_steps(bigrams, track)
    chosen = tuple(dict.fromkeys(poses)) or _moving_most(steps.clips[0])
    figure = _figure(bigrams, track, steps, chosen)
    with write_whole(path) as part:
        figure.savefig(part, format="png", dpi=DPI, metadata={"Software": None})
    return chosen


def _moving_most(clip: Clip) -> tuple[str, ...]:
    """The poses of the largest areas, largest first; the set's first where none moves."""
    areas = dict(zip(clip.names, np.abs(clip.values).sum(axis=0), strict=True))
    ranked = sorted((name for name in areas if areas[name] > 0), key=lambda name: -areas[name])
    return tuple(ranked[:MOST_POSES]) or clip.names[:1]


def _titles(bigrams: BigramSet, poses: Sequence[str]) -> list[str]:
    said = [
        f"C({one}, {other}) = {most:g}"
        for (one, other), most in bigrams.constraints.items()
        if one in poses and other in poses
    ]
    rest = f"C = {bigrams.otherwise:g} {'otherwise' if said else 'for these poses'}"
    return [
        "The curves of each pair, over the time of both phones",
        "Stitched: the greater of two pairs",
        f"Valleys between maxima within {2 * bigrams.smoothing:g} s removed",
        f"Constraints: {', '.join([*said, rest])}",
        f"Speed limit: {bigrams.speed_limit:g} a second",
    ]


def _figure(bigrams: BigramSet, track: PhoneTrack, steps: Steps, poses: Sequence[str]) -> Any:
    try:
        from matplotlib.figure import Figure
    except ModuleNotFoundError as error:
        raise MissingExtraError("matplotlib", "studio") from error
    width = float(np.clip(track.end * PACE, *WIDTHS))
    figure = Figure(figsize=(width, 5 * PANEL_HEIGHT + 1.5), layout="constrained")
    panels = figure.subplots(5, 1, sharex=True, sharey=True)
    shown = [clip.select(poses).values for clip in steps.clips]
    top = max(0.55, 1.06 * max(float(values.max()) for values in shown))
    _pairs(panels[0], steps.pairs, poses, strong=True)
    _pairs(panels[1], steps.pairs, poses, strong=False)
    _after(panels[1], steps.clips[0], None, poses)
    for panel, before, after in zip(panels[2:], steps.clips[:-1], steps.clips[1:], strict=True):
        _after(panel, after, before, poses)
    for number, (panel, title) in enumerate(zip(panels, _titles(bigrams, poses), strict=True)):
        panel.set_title(f"{number + 1}  {title}", loc="left", fontsize=10.5, pad=5)
        panel.set(xlim=(track.start, track.end), ylim=(-0.04, top), yticks=(0, 0.5, 1))
        panel.spines[["top", "right"]].set_visible(False)
        panel.tick_params(labelsize=8, colors=GREY)
        _edges(panel, track)
    _rows(panels[4], bigrams, track)
    _legend(figure, poses)
    return figure


def _pairs(
    panel: Any, pairs: Sequence[tuple[Span, Clip]], poses: Sequence[str], *, strong: bool
) -> None:
    for span, clip in pairs:
        times = np.minimum(span.start + clip.times, span.end)
        for pose, colour in zip(poses, COLOURS, strict=False):
            curve = clip.curve(pose)
            if curve.any():
                panel.plot(
                    times, curve, "-" if strong else "--", color=colour,
                    linewidth=1.6 if strong else 1.1, alpha=1.0 if strong else PALE,
                )  # fmt: skip


def _after(panel: Any, after: Clip, before: Clip | None, poses: Sequence[str]) -> None:
    """The curves of a step, and pale those before it, with what was changed between shaded."""
    for pose, colour in zip(poses, COLOURS, strict=False):
        curve = after.curve(pose)
        if before is not None:
            old = before.curve(pose)
            panel.fill_between(after.times, old, curve, color=colour, alpha=0.22, linewidth=0)
            panel.plot(after.times, old, "--", color=colour, linewidth=1.1, alpha=PALE)
        panel.plot(after.times, curve, color=colour, linewidth=1.8)


def _edges(panel: Any, track: PhoneTrack) -> None:
    for edge in track.edges:
        panel.axvline(edge, color="#c9cfda", linewidth=0.7, zorder=0)
    for index, (_, start, end) in enumerate(track):
        if index % 2:
            panel.axvspan(start, end, color=BAND, zorder=-1, linewidth=0)


def _rows(panel: Any, bigrams: BigramSet, track: PhoneTrack) -> None:
    """Phones, their classes and the words below the last panel, with the clock."""
    from matplotlib.transforms import blended_transform_factory

    place = blended_transform_factory(panel.transData, panel.transAxes)
    for name, row, left in (
        ("s", -0.095, -0.022), ("phones", -0.22, -0.008), ("classes", -0.37, -0.008),
        ("words", -0.53, -0.008),
    ):  # fmt: skip
        panel.text(
            left, row, name, transform=panel.transAxes, ha="right", va="center", fontsize=8,
            color=GREY,
        )  # fmt: skip
    for phone, start, end in track:
        for text, row, colour in (
            (phone, -0.22, "black"),
            (bigrams.class_of(phone) or "-", -0.37, GREY),
        ):
            panel.text(
                (start + end) / 2, row, text, transform=place, ha="center", va="center",
                fontsize=9, color=colour,
            )  # fmt: skip
    for word in track.words:
        panel.text(
            sum(track.word_span(word)) / 2, -0.53, word.text, transform=place, ha="center",
            va="center", fontsize=10, fontweight="bold",
        )  # fmt: skip


def _legend(figure: Any, poses: Sequence[str]) -> None:
    from matplotlib.lines import Line2D

    handles = [Line2D([], [], color=c) for _, c in zip(poses, COLOURS, strict=False)]
    handles.append(Line2D([], [], color=GREY, linestyle="--", alpha=PALE))
    figure.legend(
        handles, [*poses, "before the step"], loc="outside upper right", ncols=len(handles),
        frameon=False, fontsize=9.5,
    )  # fmt: skip
