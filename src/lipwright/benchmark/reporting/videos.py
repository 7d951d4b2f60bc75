"""Side-by-side videos: the real mouth, and beside it each entry's curves on our head.

All tiles of a frame show the same instant on the clock of the sound: the picture's own time less
the offset of the recording, as `Recording.times` has it.
"""

from __future__ import annotations

import math
from collections.abc import Generator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.audio import Audio, open_audio
from lipwright.benchmark.reporting.mouths import TILE, Picture, RealMouth, head_camera, real_tiles
from lipwright.clip import Clip
from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.files import write_whole

VIDEO_FPS: Final = 25.0  # frames a second: GRID's, and enough to see a closure
COLUMNS: Final = 4
CAPTION: Final = 26  # px below a tile
LETTERS: Final = 14  # px
EDGE: Final = 4  # px around a tile
PAPER: Final = (16, 18, 20)
INK: Final = (236, 238, 240)


def write_video(
    path: Path, real: RealMouth | None, tiles: Sequence[tuple[str, Clip]], audio: Path | None,
    offset: float,
) -> None:  # fmt: skip
    """Write an MP4, H.264 and AAC, of the real mouth and of clips on our head, side by side.

    Where the real video is gone, its tile says so.

    Args:
        path: of the MP4.
        real: the tracked video; None where there never was one.
        tiles: name and clip of each head, in the controls of our head, on the clock of the sound.
        audio: the file of the sound.
        offset: s, by how much the picture is late against the sound.

    Raises:
        LipwrightError: the sound or video cannot be read, the MP4 not be written, or no head is
            installed.
        MissingExtraError: pillow or av is not installed.
        ValueError: there are no tiles.
    """
    if not tiles:
        raise ValueError("a video needs at least one clip")
    _need("PIL", "pillow")
    _need("av", "av")
    import av

    from lipwright.export.mp4 import encode
    from lipwright.export.performance import ExportOptions

    times = _times(real, tiles, offset)
    names = ["real mouth", *(name for name, _ in tiles)]
    with write_whole(path) as part, closing(_pictures(real, tiles, names, times, offset)) as shown:
        try:
            sound = _sound(audio, float(times[0]) - 0.5 / VIDEO_FPS, len(times) / VIDEO_FPS)
            options = ExportOptions(size=_size(len(names)), title=path.stem)
            encode(part, shown, VIDEO_FPS, options, sound)
        except av.FFmpegError as error:
            raise LipwrightError(f"{path}: cannot be encoded: {error.strerror}") from error


def _need(module: str, package: str) -> None:
    from importlib.util import find_spec

    if find_spec(module) is None:
        raise MissingExtraError(f"{package}, which side-by-side videos need,", "bench")


def _times(
    real: RealMouth | None, tiles: Sequence[tuple[str, Clip]], offset: float
) -> npt.NDArray[np.float64]:
    """The middle of each video frame, s on the clock of the sound."""
    if real is None:
        start, duration = 0.0, max(clip.duration for _, clip in tiles)
    else:
        start, duration = real.start - offset, real.duration
    count = max(math.floor(duration * VIDEO_FPS + 1e-6), 1)
    return np.asarray((np.arange(count) + 0.5) / VIDEO_FPS + start)


def _sound(audio: Path | None, start: float, duration: float) -> Audio | None:
    """The sound from `start` on, silence where there is none, as long as the picture."""
    if audio is None:
        return None
    with open_audio(audio) as file:
        heard = file.read(max(start, 0.0), max(start + duration, 0.0)).samples
        samples = np.zeros(round(duration * file.rate), np.float32)
        first = round(max(-start, 0.0) * file.rate)
        part = heard[: max(len(samples) - first, 0)]
        samples[first : first + len(part)] = part
        return Audio(samples, file.rate)


def _layout(count: int) -> tuple[int, int]:
    """Columns and rows: rows as even as they can be."""
    rows = math.ceil(count / COLUMNS)
    return math.ceil(count / rows), rows


def _size(count: int) -> tuple[int, int]:
    """Width and height of the video in pixels, both even."""
    columns, rows = _layout(count)
    return columns * (TILE + EDGE) + EDGE, rows * (TILE + CAPTION + EDGE) + EDGE


def _pictures(
    real: RealMouth | None, tiles: Sequence[tuple[str, Clip]], names: Sequence[str],
    times: npt.NDArray[np.float64], offset: float,
) -> Generator[Picture, None, None]:  # fmt: skip
    """Each frame of the video."""
    from lipwright.face.head import load_head
    from lipwright.face.render import Renderer

    head = load_head()
    posed = [clip.select(head.shape_names).at(times) for _, clip in tiles]
    page, gone = _page(names), _message("the video is gone")
    mouths = iter(()) if real is None else real_tiles(real, times + offset)
    last: Picture | None = None
    with Renderer(head, TILE, TILE, view=head_camera(head)) as renderer:
        for frame in range(len(times)):
            last = next(mouths, last)
            picture = page.copy()
            _put(picture, 0, gone if last is None else last, len(names))
            for number, weights in enumerate(posed, 1):
                _put(picture, number, renderer.render(weights[frame]), len(names))
            yield picture


def _place(number: int, count: int) -> tuple[int, int]:
    """X and y of a tile's corner."""
    columns, _ = _layout(count)
    row, column = divmod(number, columns)
    return EDGE + column * (TILE + EDGE), EDGE + row * (TILE + CAPTION + EDGE)


def _put(picture: Picture, number: int, tile: Picture, count: int) -> None:
    x, y = _place(number, count)
    picture[y : y + TILE, x : x + TILE] = tile


def _page(names: Sequence[str]) -> Picture:
    """The frame without its tiles: the names."""
    from PIL import Image, ImageDraw, ImageFont

    image = Image.new("RGB", _size(len(names)), PAPER)
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(LETTERS)
    for number, name in enumerate(names):
        x, y = _place(number, len(names))
        middle = (x + TILE / 2, y + TILE + CAPTION / 2)
        draw.text(middle, _fitted(name, font), INK, font, anchor="mm")
    return np.asarray(image, np.uint8)


def _message(words: str) -> Picture:
    from PIL import Image, ImageDraw, ImageFont

    image = Image.new("RGB", (TILE, TILE), (36, 39, 43))
    font = ImageFont.load_default(LETTERS)
    ImageDraw.Draw(image).text((TILE / 2, TILE / 2), words, INK, font, anchor="mm")
    return np.asarray(image, np.uint8)


def _fitted(name: str, font: Any) -> str:
    """A name, cut to the width of a tile."""
    shown = "".join(c if c.isprintable() else " " for c in name)
    if font.getlength(shown) <= TILE:
        return shown
    while shown and font.getlength(f"{shown}…") > TILE:
        shown = shown[:-1]
    return f"{shown}…"
