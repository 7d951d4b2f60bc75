"""Frames of the talking crab with what is being said: the picture of docs/crab.md.

python bench/crab_strip.py -o docs/crab.png
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import lipwright
from lipwright.face.render import Renderer
from lipwright.files import write_whole

EXAMPLES = Path(__file__).parents[1] / "examples"
SHOWN = (
    # phone of the recording and the share of it that is over
    (2, 0.5), (3, 0.5), (4, 0.7), (6, 0.5), (8, 0.5), (11, 0.4),
    (12, 0.5), (58, 0.5), (61, 0.6), (67, 0.3), (79, 0.7), (80, 0.5),
)  # fmt: skip
COLUMNS = 6
TILE = (216, 162)  # pixels
LABEL = 36  # pixels below each


def main() -> None:
    """Draw the strip."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("-o", "--output", type=Path, default=Path("crab.png"))
    target = parser.parse_args().output
    sys.path.insert(0, str(EXAMPLES))
    from crab.model import CAMERA, crab
    from PIL import Image, ImageDraw, ImageFont

    options = lipwright.AnimateOptions(bigrams=EXAMPLES / "crab" / "crab.bigrams.json")
    words = (EXAMPLES / "hello.txt").read_text("utf-8")
    result = lipwright.animate(EXAMPLES / "hello.flac", text=words, options=options)
    track = result.track
    rows = -(-len(SHOWN) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * TILE[0], rows * (TILE[1] + LABEL)), "white")
    pen = ImageDraw.Draw(sheet)
    large, small = ImageFont.load_default(16), ImageFont.load_default(12)
    with Renderer(crab(), 2 * TILE[0], 2 * TILE[1], view=CAMERA) as renderer:
        for place, (index, share) in enumerate(SHOWN):
            time = track.edges[index] + share * track.durations[index]
            frame = round(time * result.clip.fps)
            picture = Image.fromarray(renderer.render(result.clip.values[frame])).resize(TILE)
            x, y = place % COLUMNS * TILE[0], place // COLUMNS * (TILE[1] + LABEL)
            sheet.paste(picture, (x, y))
            word = track.word_at(index)
            middle = x + TILE[0] / 2
            said = "I" if word and word.text == "i" else word.text if word else ""
            pen.text((middle, y + TILE[1] + 17), said, "black", large, anchor="ms")
            pen.text((middle, y + TILE[1] + 32), track.phones[index], "#555555", small, anchor="ms")
    with write_whole(target) as part:
        sheet.save(part, optimize=True)
    print(f"{target}: {len(SHOWN)} frames")


if __name__ == "__main__":
    main()
