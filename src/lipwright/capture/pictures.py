"""Contact sheets: frames of a recording with the landmarks drawn on them."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.capture.pose import to_picture
from lipwright.dataset.recording import Flag, Motion
from lipwright.errors import MissingExtraError
from lipwright.evaluate.lips import speech_span
from lipwright.phones import BILABIALS, SILENCE
from lipwright.track import PhoneTrack

if TYPE_CHECKING:
    from PIL.Image import Image

Picture = npt.NDArray[np.uint8]
Points = npt.NDArray[np.floating]

FRAMES: Final = 12  # of a sheet
AROUND: Final = 0.2  # s before and after speech from which frames are chosen
COLUMNS: Final = 4
TILE: Final = 240  # pixels, side of a frame in the sheet
CAPTION: Final = 24  # pixels, height of the line below it
MARGIN: Final = 1.12  # side of the cut-out over that of the face
QUALITY: Final = 75  # of the JPEG

# Chains of landmarks, as in FaceLandmarksConnections of mediapipe.
LIPS: Final = (
    (61, 146, 91, 181, 84, 17, 314, 405, 321, 375, 291),
    (61, 185, 40, 39, 37, 0, 267, 269, 270, 409, 291),
    (78, 95, 88, 178, 87, 14, 317, 402, 318, 324, 308),
    (78, 191, 80, 81, 82, 13, 312, 311, 310, 415, 308),
)
EYES: Final = (
    (263, 249, 390, 373, 374, 380, 381, 382, 362), (263, 466, 388, 387, 386, 385, 384, 398, 362),
    (33, 7, 163, 144, 145, 153, 154, 155, 133), (33, 246, 161, 160, 159, 158, 157, 173, 133),
)  # fmt: skip
JAW: Final = (
    (454, 323, 361, 288, 397, 365, 379, 378, 400, 377, 152,
     148, 176, 149, 150, 136, 172, 58, 132, 93, 234),
)  # fmt: skip

# RGB: lips, eyes and jaw apart on any skin.
OUTLINES: Final = ((LIPS, (255, 214, 64)), (EYES, (92, 225, 255)), (JAW, (92, 225, 255)))
POINT: Final = (255, 255, 255)
PAPER: Final = (28, 30, 34)
INK: Final = (236, 238, 240)
ALARM: Final = (255, 96, 88)

_SHIFT: Final = 4  # bits of a pixel's fraction in cv2's coordinates


@dataclass(frozen=True, eq=False)
class SheetFrame:
    """One frame of a contact sheet."""

    time: float
    """s, on the clock of the sound"""
    picture: Picture
    """(height, width, 3), RGB"""
    points: Points | None
    """(478, 2 or more), pixels of the picture; None where no face was found"""
    label: str
    """what is said there"""
    notes: tuple[str, ...] = ()
    """what is odd: `lost`, `blink`, `second face`"""


def pixel_landmarks(motion: Motion) -> Points | None:
    """(T, 478, 2), the smoothed landmarks in pixels of the picture; NaN where lost."""
    if motion.landmarks is None or motion.head_pose is None:
        return None
    return to_picture(motion.landmarks, motion.head_pose)[..., :2]


def choose_frames(
    motion: Motion, track: PhoneTrack, lag: float = 0.0, n: int = FRAMES
) -> tuple[int, ...]:
    """The `n` frames that show most: closures, the widest opening, a lost frame, the rest evenly.

    Args:
        motion: what the face did.
        track: the phones, on the clock of the sound.
        lag: by how much a frame's time is ahead of the clock of the sound, s.
        n: how many; a shorter video gives all that it has.

    Returns:
        Rising indices of frames that the video has.
    """
    there = np.flatnonzero((motion.flags & Flag.DROPPED) == 0)
    if len(there) <= n:
        return tuple(map(int, there))
    chosen: list[int] = []
    lost = there[~motion.valid[there]]
    if len(lost):
        chosen.append(int(lost[len(lost) // 2]))
    if motion.aperture is not None and motion.valid.any():
        chosen.append(int(np.nanargmax(motion.aperture)))
        chosen += _spread(_tightest_frames(motion, track, lag), n // 2)
    chosen = sorted(set(chosen))[:n] or [int(there[0])]
    spoken = there[_in_speech(frame_times(motion, lag)[there], track)]
    rest = spoken if len(spoken) >= n else there
    while len(chosen) < n:  # the frame that is farthest from those chosen
        distance = np.abs(rest[:, None] - np.array(chosen)).min(axis=1)
        chosen.append(int(rest[np.argmax(distance)]))
    return tuple(sorted(chosen))


def _in_speech(times: npt.NDArray[np.float64], track: PhoneTrack) -> npt.NDArray[np.bool_]:
    if all(phone == SILENCE for phone in track.phones):
        return np.zeros(len(times), bool)
    start, end = speech_span(track)
    return (times >= start - AROUND) & (times <= end + AROUND)


def _tightest_frames(motion: Motion, track: PhoneTrack, lag: float) -> list[int]:
    """The frame with the least aperture in each p, b, m."""
    assert motion.aperture is not None
    times = frame_times(motion, lag)
    found = []
    for phone, start, end in track:
        near = (times >= start - 0.5 / motion.fps) & (times <= end + 0.5 / motion.fps)
        inside = np.flatnonzero(near & motion.valid)
        if phone in BILABIALS and len(inside):
            found.append(int(inside[np.argmin(motion.aperture[inside])]))
    return found


def _spread(values: list[int], most: int) -> list[int]:
    if len(values) <= most:
        return values
    return [values[i] for i in np.linspace(0, len(values) - 1, most).round().astype(int)]


def frame_times(motion: Motion, lag: float = 0.0) -> npt.NDArray[np.float64]:
    """(T,), s, the middles of the frames on the clock of the sound."""
    return np.asarray((np.arange(len(motion)) + 0.5) / motion.fps - lag, np.float64)


def phone_at(track: PhoneTrack, time: float) -> str:
    """The phone that sounds at `time` in s, with its word; empty outside of the track."""
    index = int(np.searchsorted(track.edges, time, side="right")) - 1
    if not 0 <= index < len(track):
        return ""
    word = track.word_at(index)
    return f"{track.phones[index]}  {word.text}" if word else track.phones[index]


def sheet_frames(
    motion: Motion, track: PhoneTrack, lag: float, pictures: Mapping[int, Picture]
) -> list[SheetFrame]:
    """The frames whose pictures are given, with their landmarks, times, phones and notes.

    Args:
        motion: what the face did.
        track: the phones, on the clock of the sound.
        lag: by how much a frame's time is ahead of the clock of the sound, s.
        pictures: index of the frame to its picture.
    """
    times, points = frame_times(motion, lag), pixel_landmarks(motion)
    found = []
    for index in sorted(pictures):
        flags = int(motion.flags[index])
        names = ((Flag.LOST, "lost"), (Flag.BLINK, "blink"), (Flag.CROWD, "second face"))
        found.append(
            SheetFrame(
                time=float(times[index]),
                picture=pictures[index],
                points=points[index] if points is not None and motion.valid[index] else None,
                label=phone_at(track, float(times[index])),
                notes=tuple(name for flag, name in names if flags & flag),
            )
        )
    return found


def contact_sheet(frames: Sequence[SheetFrame]) -> bytes:
    """A JPEG of the frames, cut to the face, landmarks drawn, time and phone below each.

    Raises:
        MissingExtraError: the extra `capture` is not installed.
        ValueError: there are no frames.
    """
    try:
        import cv2  # noqa: F401  # used by the tiles
        from PIL import Image
    except ImportError as error:
        raise MissingExtraError("drawing of contact sheets", "capture") from error
    if not frames:
        raise ValueError("no frames for a contact sheet")
    columns = min(COLUMNS, len(frames))
    rows = -(-len(frames) // columns)
    sheet = Image.new("RGB", (columns * TILE, rows * (TILE + CAPTION)), PAPER)
    boxes = face_boxes(frames)
    for index, (frame, box) in enumerate(zip(frames, boxes, strict=True)):
        corner = (index % columns * TILE, index // columns * (TILE + CAPTION))
        sheet.paste(Image.fromarray(_draw_tile(frame, box)), corner)
        _write_caption(sheet, frame, corner)
    stream = io.BytesIO()
    sheet.save(stream, "JPEG", quality=QUALITY, optimize=True)
    return stream.getvalue()


def face_boxes(frames: Sequence[SheetFrame]) -> list[tuple[float, float, float]]:
    """Left, top and side in pixels of the square to cut out of each frame; one side for all.

    A frame without a face is cut where the face was in the frame nearest in time.
    """
    spans = [
        None if f.points is None else (f.points[:, :2].min(axis=0), f.points[:, :2].max(axis=0))
        for f in frames
    ]
    known = [i for i, span in enumerate(spans) if span is not None]
    if not known:
        sizes = [f.picture.shape[:2] for f in frames]
        return [((w - max(h, w)) / 2, (h - max(h, w)) / 2, float(max(h, w))) for h, w in sizes]
    side = MARGIN * max(float((high - low).max()) for low, high in filter(None, spans))
    boxes = []
    for frame in frames:
        nearest = min(known, key=lambda i: abs(frames[i].time - frame.time))
        low, high = spans[nearest] or (np.zeros(2), np.zeros(2))
        left, top = (low + high) / 2 - side / 2
        boxes.append((float(left), float(top), side))
    return boxes


def _draw_tile(frame: SheetFrame, box: tuple[float, float, float]) -> Picture:
    import cv2

    left, top, side = box
    scale = TILE / side
    # Shrinking by much takes steps of area averaging first: an affine warp alone would alias.
    picture: npt.NDArray[Any] = frame.picture
    shrunk = 1
    while scale * shrunk < 0.5:
        picture = cv2.resize(picture, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
        shrunk *= 2
    ratio = scale * shrunk
    # Pixel centres lie at whole numbers in the warp, at halves in the landmarks.
    matrix = np.array(
        [[ratio, 0, 0.5 * ratio - 0.5 - left * scale], [0, ratio, 0.5 * ratio - 0.5 - top * scale]]
    )
    tile = cv2.warpAffine(
        picture, matrix, (TILE, TILE), flags=cv2.INTER_CUBIC, borderValue=(*PAPER, 0)
    )
    if frame.points is not None:
        _draw_landmarks(tile, (frame.points[:, :2] - (left, top)) * scale - 0.5)
    if "lost" in frame.notes:
        cv2.rectangle(tile, (1, 1), (TILE - 2, TILE - 2), ALARM, 3)
    return np.asarray(tile, np.uint8)


def _draw_landmarks(tile: npt.NDArray[Any], points: Points) -> None:
    """Draw on `tile` in place; `points` in its pixels."""
    import cv2

    fixed = np.round(points * (1 << _SHIFT)).astype(np.int32)
    dots = tile.copy()
    for x, y in fixed.tolist():
        cv2.circle(dots, (x, y), 11, POINT, -1, cv2.LINE_AA, _SHIFT)
    cv2.addWeighted(dots, 0.55, tile, 0.45, 0, dst=tile)
    for chains, colour in OUTLINES:
        lines = [fixed[list(chain)] for chain in chains]
        cv2.polylines(tile, lines, False, colour, 1, cv2.LINE_AA, _SHIFT)


def _write_caption(sheet: Image, frame: SheetFrame, corner: tuple[int, int]) -> None:
    from PIL import ImageDraw, ImageFont

    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(15)
    middle = corner[1] + TILE + CAPTION / 2
    draw.text((corner[0] + 6, middle), f"{frame.time:.2f} s", INK, font, anchor="lm")
    draw.text((corner[0] + 74, middle), frame.label[:16], INK, font, anchor="lm")
    notes = ", ".join(frame.notes)
    draw.text((corner[0] + TILE - 8, middle), notes, ALARM, font, anchor="rm")
