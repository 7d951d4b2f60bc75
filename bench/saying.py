"""What voices say, seen on the head: whether the lips meet at every bilabial, and round when due.

    python bench/saying.py                       # every language, our voices, the default engine
    python bench/saying.py --languages sv --texts examples/swedish.txt
    python bench/saying.py --languages sv --sheet docs/saying-sv.png --line 5

A bilabial counts as shut where the aperture of the head falls under 5 % of the sentence's 95th
percentile within the phone or 20 ms beside it. Rounding is mouthPucker and mouthFunnel together at
rounded vowels against spread ones (IY IH EH EY). Needs the extras espeak and languages and
`lipwright head install`.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from language_timing import TEXTS
from lipwright.clip import Clip
from lipwright.controls import CANONICAL
from lipwright.face.head import load_head
from lipwright.files import write_whole
from lipwright.phones import BILABIALS, PHONES
from lipwright.pipeline import Result, SayOptions, say
from lipwright.track import PhoneTrack

TOUCHING = 0.05  # of the 95th percentile of the aperture
REACH = 0.02  # s on both sides of a phone
SPREAD = ("IY", "IH", "EH", "EY")
ROUNDING = ("mouthPucker", "mouthFunnel")
SIDE = 240  # px of a picture in a sheet


@dataclass
class Figures:
    """What is counted in one language."""

    bilabials: int = 0
    shut: int = 0
    round: list[float] = field(default_factory=list)
    spread: list[float] = field(default_factory=list)


def measure(figures: Figures, result: Result) -> None:
    """Add one sentence."""
    clip, track = result.clip, result.track
    gaps = load_head().aperture_curve(clip.select(CANONICAL).values)
    gaps = gaps / np.percentile(gaps, 95)
    rounding = sum(clip.curve(name) for name in ROUNDING)
    for phone, start, end in track:
        inside = (clip.times >= start - REACH) & (clip.times <= end + REACH)
        if phone in BILABIALS:
            figures.bilabials += 1
            figures.shut += bool(gaps[inside].min() < TOUCHING)
        elif PHONES[phone].is_vowel:
            most = float(np.max(rounding[inside]))
            if PHONES[phone].rounded:
                figures.round.append(most)
            elif phone in SPREAD:
                figures.spread.append(most)


def moments(track: PhoneTrack) -> list[tuple[str, float]]:
    """Label and time of each bilabial and each rounded vowel."""
    return [
        (phone, (start + end) / 2)
        for phone, start, end in track
        if phone in BILABIALS or (PHONES[phone].is_vowel and PHONES[phone].rounded)
    ]


def draw_sheet(path: Path, clip: Clip, track: PhoneTrack) -> None:
    """The mouth at each of `moments`, with the phone and the time under it."""
    import io

    from PIL import Image, ImageDraw

    from lipwright.face.render import Renderer

    head = load_head()
    chosen = moments(track)
    columns = 8
    rows = -(-len(chosen) // columns)
    sheet = Image.new("RGB", (columns * SIDE, rows * (SIDE + 22)), "white")
    pen = ImageDraw.Draw(sheet)
    with Renderer(head, SIDE, SIDE, view="mouth") as renderer:
        for place, (label, time) in enumerate(chosen):
            values = clip.select(head.shape_names).at(np.array([time]))
            picture = renderer.render(values[0])
            left, top = place % columns * SIDE, place // columns * (SIDE + 22)
            sheet.paste(Image.fromarray(picture), (left, top))
            pen.text((left + 8, top + SIDE + 4), f"{label} {time:.2f} s", fill="black")
    buffer = io.BytesIO()
    sheet.save(buffer, "PNG")
    with write_whole(path) as part:
        part.write_bytes(buffer.getvalue())


def main() -> None:
    """Print a row a language."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--languages", default=",".join(TEXTS), help="ISO codes with commas")
    parser.add_argument("--texts", type=Path, help="a file of sentences, a line each")
    parser.add_argument("--voice")
    parser.add_argument("--sheet", type=Path, help="draw one sentence")
    parser.add_argument("--line", type=int, default=1, help="which, from 1")
    chosen = parser.parse_args()
    print("language  sentences  bilabials  lips shut  rounding of round / spread vowels")
    for code in chosen.languages.split(","):
        lines = chosen.texts.read_text("utf-8").split("\n") if chosen.texts else TEXTS[code]
        texts = [line for line in lines if line.strip()]
        figures = Figures()
        for number, text in enumerate(texts, 1):
            result = say(text, voice=SayOptions(chosen.voice, code))
            measure(figures, result)
            if chosen.sheet and number == chosen.line:
                draw_sheet(chosen.sheet, result.clip, result.track)
        averages = f"{np.mean(figures.round or [0]):.2f} / {np.mean(figures.spread or [0]):.2f}"
        print(f"{code:8}  {len(texts):9}  {figures.bilabials:9}  {figures.shut:9}  {averages}")


if __name__ == "__main__":
    main()
