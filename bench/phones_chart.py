"""What every phone looks like: a chart, and every pair of phones in numbers.

    python bench/phones_chart.py -o phones.png                 # as lipwright animate
    python bench/phones_chart.py --model MODEL -o phones.png
    python bench/phones_chart.py --model MODEL --pairs pairs.png --csv pairs.csv

The chart: consonants between two short neutral vowels (sil AH C AH sil), since they are made from
and to something; vowels between silences, long enough to reach their mouth. The picture shows the
middle; that of a diphthong shows it at a fifth and at four fifths, where its two parts are. A mark
says which phones the training data never had.

The pairs: every ordered pair of phones between neutral vowels, with its largest and least aperture
as shares of that of an AA alone, and the fastest control. Printed is what cannot be right: a vowel
that stays shut, a p, b or m that does not close, another consonant that is shut all the while, a
control that jumps, and what is not a number. Default passes in both.
Needs `lipwright head install`.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Callable
from dataclasses import astuple, dataclass, fields
from functools import partial
from pathlib import Path

import numpy as np
import numpy.typing as npt

from grid import sentences
from heads import Ruler, our_head
from lips import ours
from lipwright.clip import Clip
from lipwright.controls import CANONICAL
from lipwright.engines import choose_engine
from lipwright.engines.window import open_network
from lipwright.evaluate.lips import BILABIALS, CLOSED, CLOSURE_TOLERANCE, SHUT
from lipwright.files import write_whole
from lipwright.passes import SPEED_LIMIT
from lipwright.phones import PHONES, SILENCE
from lipwright.track import PhoneTrack

REST = 0.3  # s of silence at either end
NEUTRAL = ("AH", 0.12)  # s; in most data, as CMUdict writes it for the schwa
CONSONANT = 0.15  # s
VOWEL = 0.25  # s; a vowel on its own is as long in careful speech
IN_PAIR = 0.12  # s
PARTS = (0.2, 0.8)  # shares of a diphthong
LIP_TO_TEETH = ("F", "V")  # these may shut the lips' gap

PICTURE = 200  # pixels, width and height of a rendered mouth
CROP = (10, 42, 190, 166)  # pixels of it that are shown: left, top, right, bottom
TILE = (CROP[2] - CROP[0], CROP[3] - CROP[1])
LABEL = 34  # pixels below each
COLUMNS = 9
NEW = (178, 60, 20)  # colour of phones that the training data never had

Animate = Callable[[PhoneTrack], Clip]


@dataclass(frozen=True)
class Tile:
    """One picture of the chart."""

    phone: str
    track: PhoneTrack
    time: float
    """s, of the picture"""
    label: str


def row(*parts: tuple[str, float]) -> PhoneTrack:
    """Phones of given durations in s, one after the other."""
    phones, durations = zip(*parts, strict=True)
    return PhoneTrack(phones, np.concatenate([[0.0], np.cumsum(durations)]))


def tiles() -> list[Tile]:
    """The pictures, in the order of the phone table."""
    found = []
    for symbol, phone in PHONES.items():
        if phone.is_consonant:
            track = row((SILENCE, REST), NEUTRAL, (symbol, CONSONANT), NEUTRAL, (SILENCE, REST))
        else:
            track = row((SILENCE, REST), (symbol, VOWEL), (SILENCE, REST))
        middle = track.phones.index(symbol) if phone.is_consonant else 1
        start, end = track.edges[middle], track.edges[middle + 1]
        places = PARTS if phone.is_diphthong else (0.5,)
        for number, share in enumerate(places, 1):
            label = f"{symbol} {number} of {len(places)}" if len(places) > 1 else symbol
            found.append(Tile(symbol, track, float(start + share * (end - start)), label))
    return found


def trained_phones(engine: str | None, model: str | None) -> frozenset[str]:
    """The phones of the training data: of the model, or of GRID, which dominance is fitted to."""
    if choose_engine(engine, model) == "window":
        return frozenset(open_network(model).meta.features.phones)
    return frozenset(phone for sentence in sentences("train") for phone in sentence.track.phones)


def draw_chart(path: Path, animate: Animate, known: frozenset[str]) -> None:
    """Write the chart as PNG."""
    from PIL import Image, ImageDraw, ImageFont

    from lipwright.face.head import load_head
    from lipwright.face.render import Renderer

    chart = tiles()
    rows = -(-len(chart) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * TILE[0], rows * (TILE[1] + LABEL)), "white")
    pen = ImageDraw.Draw(sheet)
    large, small = ImageFont.load_default(15), ImageFont.load_default(11)
    with Renderer(load_head(), PICTURE, PICTURE, view="mouth") as renderer:
        for index, tile in enumerate(chart):
            pose = animate(tile.track).select(CANONICAL).at([tile.time])[0]
            x, y = index % COLUMNS * TILE[0], index // COLUMNS * (TILE[1] + LABEL)
            sheet.paste(Image.fromarray(renderer.render(pose)).crop(CROP), (x, y))
            seen = tile.phone in known
            pen.text((x + 5, y + TILE[1] + 1), tile.label, "black" if seen else NEW, large)
            pen.text((x + 5, y + TILE[1] + 18), PHONES[tile.phone].example, "#555555", small)
            if not seen:
                at = (x + TILE[0] - 5, y + TILE[1] + 6)
                pen.text(at, "not in the data", NEW, small, anchor="rt")
    with write_whole(path) as part:
        sheet.save(part, optimize=True)


@dataclass(frozen=True)
class Pair:
    """Two phones, one after the other, between neutral vowels."""

    first: str
    second: str
    largest: float
    """aperture in the two phones, as a share of that of an AA alone"""
    least: float
    speed: float
    """of the fastest control, full ranges a second"""
    oddities: str
    """what cannot be right; empty where nothing is"""


def measure_pairs(animate: Animate, ruler: Ruler) -> list[Pair]:
    """All ordered pairs; those with the same first phone are animated in one track."""
    symbols = [symbol for symbol in PHONES if symbol != SILENCE]
    alone = ruler(animate(row((SILENCE, REST), ("AA", VOWEL), (SILENCE, REST)))).max()
    found = []
    for first in symbols:
        parts = [(SILENCE, REST)]
        for second in symbols:
            parts += [NEUTRAL, (first, IN_PAIR), (second, IN_PAIR), NEUTRAL, (SILENCE, REST)]
        track = row(*parts)
        clip = animate(track)
        share = ruler(clip) / alone
        for number, second in enumerate(symbols):
            edges = track.edges[5 * number + 2 : 5 * number + 5]
            found.append(judge(first, second, edges, clip, share))
    return found


def judge(
    first: str, second: str, edges: npt.NDArray[np.float64], clip: Clip,
    share: npt.NDArray[np.float64],
) -> Pair:  # fmt: skip
    """The figures of one pair.

    Args:
        first: the phone from `edges[0]` to `edges[1]` s.
        second: the phone from `edges[1]` to `edges[2]` s.
        edges: (3,) s.
        clip: the animation.
        share: (T,) aperture of each of its frames over that of an AA alone.
    """
    near = (clip.times >= edges[0] - NEUTRAL[1]) & (clip.times <= edges[2] + NEUTRAL[1])
    inside = (clip.times >= edges[0]) & (clip.times <= edges[2])
    steps = np.abs(np.diff(clip.values[near], axis=0)) * clip.fps
    fastest = int(steps.max(axis=0).argmax())
    odd = []
    if not np.isfinite(share[near]).all() or not np.isfinite(clip.values[near]).all():
        odd.append("not a number")
    if steps.max() > SPEED_LIMIT * (1 + 1e-4):
        odd.append(f"{clip.names[fastest]} jumps")
    for symbol, start, end in ((first, *edges[:2]), (second, *edges[1:])):
        odd += judge_phone(symbol, start, end, clip.times, share)
    return Pair(first, second, float(share[inside].max()), float(share[inside].min()),
                float(steps.max()), ", ".join(odd))  # fmt: skip


def judge_phone(
    symbol: str, start: float, end: float, times: npt.NDArray[np.float64],
    share: npt.NDArray[np.float64],
) -> list[str]:  # fmt: skip
    """What cannot be right about the aperture of one phone."""
    phone = PHONES[symbol]
    around = share[(times >= start - CLOSURE_TOLERANCE) & (times <= end + CLOSURE_TOLERANCE)]
    if symbol in BILABIALS:
        return [f"{symbol} does not close"] if around.min() >= CLOSED else []
    if phone.is_vowel and around.max() < SHUT:
        return [f"{symbol} stays shut"]
    inside = share[(times >= start) & (times <= end)]
    if phone.is_consonant and symbol not in LIP_TO_TEETH and inside.max() < SHUT / 2:
        return [f"{symbol} is shut"]
    return []


def print_pairs(pairs: list[Pair]) -> None:
    """The figures of all pairs, and those with something odd."""
    odd = [pair for pair in pairs if pair.oddities]
    print(f"{len(pairs)} pairs, {len(odd)} odd; fastest control {max(p.speed for p in pairs):.1f} "
          f"full ranges a second")  # fmt: skip
    for what, values in (("largest", [p.largest for p in pairs]),
                         ("least", [p.least for p in pairs])):  # fmt: skip
        print(f"{what} aperture, percentiles 0, 5, 50, 95, 100:",
              *np.percentile(values, [0, 5, 50, 95, 100]).round(3))  # fmt: skip
    for pair in odd:
        print(f"  {pair.first} {pair.second}: {pair.oddities} "
              f"({pair.least:.2f} to {pair.largest:.2f}, {pair.speed:.1f} a second)")  # fmt: skip


def write_pairs(path: Path, pairs: list[Pair]) -> None:
    """All figures as CSV."""
    with write_whole(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(field.name for field in fields(Pair))
        writer.writerows(astuple(pair) for pair in pairs)


def draw_pairs(path: Path, pairs: list[Pair]) -> None:
    """Heat maps of largest and least aperture; odd pairs are framed."""
    from matplotlib.figure import Figure
    from matplotlib.patches import Rectangle

    symbols = list(dict.fromkeys(pair.first for pair in pairs))
    figure = Figure(figsize=(22, 11.5), layout="constrained")
    for axes, name in zip(figure.subplots(1, 2), ("largest", "least"), strict=True):
        values = np.array([getattr(pair, name) for pair in pairs]).reshape(len(symbols), -1)
        image = axes.imshow(values, cmap="magma", vmin=0, vmax=1.2)
        axes.set_title(f"{name} aperture, over that of AA alone")
        axes.set_xticks(range(len(symbols)), symbols, rotation=90, fontsize=7)
        axes.set_yticks(range(len(symbols)), symbols, fontsize=7)
        axes.set_ylabel("first phone")
        axes.set_xlabel("second phone")
        figure.colorbar(image, ax=axes, shrink=0.7)
        for index, pair in enumerate(pairs):
            if pair.oddities:
                y, x = divmod(index, len(symbols))
                axes.add_patch(Rectangle((x - 0.5, y - 0.5), 1, 1, fill=False, color="cyan"))
    with write_whole(path) as part:
        figure.savefig(part, dpi=70, metadata={"Software": None})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--engine", help="default: that of lipwright animate")
    parser.add_argument("--model", help="name or folder of a model, for the engine window")
    parser.add_argument("-o", "--output", type=Path, help="the chart of phones, PNG")
    parser.add_argument("--pairs", type=Path, help="the chart of pairs, PNG; prints what is odd")
    parser.add_argument("--csv", type=Path, help="the figures of the pairs")
    options = parser.parse_args()
    animate = partial(ours(options.engine, options.model), audio=None)
    if options.output:
        draw_chart(options.output, animate, trained_phones(options.engine, options.model))
    if options.pairs or options.csv:
        pairs = measure_pairs(animate, our_head())
        print_pairs(pairs)
        if options.pairs:
            draw_pairs(options.pairs, pairs)
        if options.csv:
            write_pairs(options.csv, pairs)


if __name__ == "__main__":
    main()
