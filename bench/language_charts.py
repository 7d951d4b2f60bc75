"""A chart for each language: its sounds, the phones that show them, and the mouth of each.

    python bench/language_charts.py docs/charts docs/language-charts.md

Writes a picture a language into the folder and the page with all tables. Consonants stand between
two short neutral vowels, vowels between silences; the picture shows the middle, of a diphthong the
second part too. Default engine and passes. Needs the extra languages and `lipwright head install`.
"""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

from lips import ours
from lipwright.controls import CANONICAL
from lipwright.face.head import load_head
from lipwright.face.render import Renderer
from lipwright.files import write_whole
from lipwright.language import LANGUAGES, Language, Phoneme, get_language
from lipwright.phones import PHONES, SILENCE
from lipwright.track import PhoneTrack
from phones_chart import CONSONANT, CROP, NEUTRAL, PICTURE, REST, TILE, VOWEL, row

COLUMNS = 10
SCALE = 0.6  # of a tile of phones_chart.py
LABEL = 34  # pixels below each
SIZE = (round(TILE[0] * SCALE), round(TILE[1] * SCALE))
COLOURS = 128  # of the picture's palette


def moments(sound: Phoneme) -> tuple[PhoneTrack, list[float]]:
    """A track with the sound, and the times in s at which it is looked at."""
    parts = [(p, CONSONANT if PHONES[p].is_consonant else VOWEL) for p in sound.phones]
    around = NEUTRAL if PHONES[sound.phones[0]].is_consonant else None
    shown = [part for part in ((SILENCE, REST), around, *parts, around, (SILENCE, REST)) if part]
    track = row(*shown)
    first = 2 if around else 1
    times = []
    for index in range(first, first + len(parts)):
        start, end = track.edges[index], track.edges[index + 1]
        shares = (0.2, 0.8) if PHONES[track.phones[index]].is_diphthong else (0.5,)
        times += [float(start + share * (end - start)) for share in shares]
    return track, times


def draw(path: Path, language: Language) -> None:
    """Write the chart of one language as PNG."""
    from matplotlib import get_data_path
    from PIL import Image, ImageDraw, ImageFont

    font = Path(get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"  # has the letters of IPA
    animate = partial(ours(None), audio=None)
    tiles = [(s, *moments(s)) for s in language.inventory()]
    pictures = [(sound, track, time) for sound, track, times in tiles for time in times]
    rows = -(-len(pictures) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * SIZE[0], rows * (SIZE[1] + LABEL)), "white")
    pen = ImageDraw.Draw(sheet)
    fonts = [ImageFont.truetype(str(font), size) for size in (15, 11)]
    with Renderer(load_head(), PICTURE, PICTURE, view="mouth") as renderer:
        for index, (sound, track, time) in enumerate(pictures):
            pose = animate(track).select(CANONICAL).at([time])[0]
            mouth = Image.fromarray(renderer.render(pose)).crop(CROP).resize(SIZE)
            x, y = index % COLUMNS * SIZE[0], index // COLUMNS * (SIZE[1] + LABEL)
            sheet.paste(mouth, (x, y))
            label = f"{sound.ipa}  {' '.join(sound.phones)}"
            pen.text((x + 4, y + SIZE[1]), label, "black", fonts[0])
            pen.text((x + 4, y + SIZE[1] + 17), sound.example, "#555555", fonts[1])
    with write_whole(path) as part:
        sheet.quantize(COLOURS).save(part, "PNG", optimize=True)


def table(language: Language) -> list[str]:
    """The rows of one language for the page."""
    lines = [
        "| IPA | phones | class | how it is made | example |",
        "| --- | --- | --- | --- | --- |",
    ]
    for sound in language.inventory():
        classes = " ".join(PHONES[phone].common for phone in sound.phones)
        made = "; ".join(_made(phone) for phone in sound.phones)
        lines.append(
            f"| {sound.ipa} | {' '.join(sound.phones)} | {classes} | {made} | {sound.example} |"
        )
    return lines


def _made(symbol: str) -> str:
    phone = PHONES[symbol]
    kind = f"{phone.height} {phone.backness}" if phone.is_vowel else f"{phone.place} {phone.manner}"
    return f"{kind}, rounded" if phone.rounded else kind


def main() -> None:
    """Write the pictures and the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("page", type=Path)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    lines = [
        "# Sounds and mouths of each language",
        "",
        "Every sound that the text of a language may give, the phones of the phone table that show",
        "it, and the mouth that `lipwright animate` gives those. Written by",
        "`python bench/language_charts.py docs/charts docs/language-charts.md`.",
    ]
    for code in LANGUAGES:
        language = get_language(code)
        draw(options.folder / f"{code}.png", language)
        picture = f"![Mouths of {language.name}]({options.folder.name}/{code}.png)"
        lines += ["", f"## {language.name} (`{code}`)", "", picture, "", *table(language)]
    with write_whole(options.page) as part:
        part.write_text("\n".join(lines) + "\n", "utf-8")


if __name__ == "__main__":
    main()
