"""The GRID recordings as the benchmarks use them: words, splits, tracked lips, aligned phones.

Tracked landmarks and aligned phones are kept in `bench/cache`, since tracking all 880 videos
takes a quarter of an hour.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from lipwright.capture.landmarks import aperture, eye_distance, mouth_width
from lipwright.dataset.splits import split_order
from lipwright.evaluate.lips import Aperture, video_times
from lipwright.track import PhoneTrack

if TYPE_CHECKING:
    from lipwright.capture.tracker import Tracker

CORPORA = Path(__file__).resolve().parents[2] / "shared" / "corpora"
CACHE = Path(__file__).resolve().parent / "cache"

COMMANDS = {"b": "bin", "l": "lay", "p": "place", "s": "set"}
COLOURS = {"b": "blue", "g": "green", "r": "red", "w": "white"}
PREPOSITIONS = {"a": "at", "b": "by", "i": "in", "w": "with"}
_DIGIT_NAMES = "zero one two three four five six seven eight nine"
DIGITS = dict(zip("z123456789", _DIGIT_NAMES.split(), strict=True))
ADVERBS = {"a": "again", "n": "now", "p": "please", "s": "soon"}

TEST = VALIDATION = 50  # sentences
UNSEEN = "mvy"  # letters that models for the unseen words never learnt


@dataclass(frozen=True)
class Sentence:
    """One of the recordings."""

    name: str
    root: Path

    @property
    def text(self) -> str:
        """The words; the letter in capitals, as a letter's name."""
        command, colour, preposition, letter, digit, adverb = self.name
        return " ".join(
            (COMMANDS[command], COLOURS[colour], PREPOSITIONS[preposition], letter.upper(),
             DIGITS[digit], ADVERBS[adverb])
        )  # fmt: skip

    @property
    def audio(self) -> Path:
        """The sound, 16 kHz."""
        return self.root / "audio" / f"{self.name}.flac"

    @property
    def video(self) -> Path:
        """The picture, 25 fps, without sound."""
        return self.root / "video" / f"{self.name}.mp4"

    @cached_property
    def landmarks(self) -> npt.NDArray[np.float32]:
        """(T, 478, 3), pixels; tracked once and kept."""
        path = CACHE / "landmarks" / f"{self.name}.npz"
        if not path.exists():
            from lipwright.files import write_whole

            path.parent.mkdir(parents=True, exist_ok=True)
            points = _tracker().track_video(self.video).points
            with write_whole(path) as part:
                np.savez_compressed(part, points=points)
        with np.load(path) as data:
            return np.asarray(data["points"])

    @cached_property
    def eyes(self) -> npt.NDArray[np.float64]:
        """(T,), the distance between the eyes' centres in pixels."""
        return eye_distance(self.landmarks)

    @property
    def aperture(self) -> Aperture:
        """The real lips' aperture."""
        return Aperture(video_times(len(self.landmarks), 25), aperture(self.landmarks))

    @property
    def mouth_width(self) -> npt.NDArray[np.float64]:
        """(T,), the distance of the mouth's corners over that of the eyes."""
        return mouth_width(self.landmarks)

    @cached_property
    def track(self) -> PhoneTrack:
        """The aligned phones; aligned once and kept."""
        from lipwright.formats import read_track, write_track

        path = CACHE / "phones" / f"{self.name}.TextGrid"
        if not path.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            write_track(path, self.align())
        return read_track(path)

    def align(self) -> PhoneTrack:
        """Align now, whatever is kept."""
        from lipwright.pipeline import align_speech

        return align_speech(self.audio, self.text).track


@cache
def _tracker() -> Tracker:
    from lipwright.capture.tracker import Tracker

    return Tracker()


def sentences(split: str = "all", corpora: Path = CORPORA) -> list[Sentence]:
    """The sentences of a split, in its order: all, test, validation, train, or unseen.

    Unseen are those with the letters m, v and y, for models that were trained without them.
    """
    root = corpora / "grid-s1"
    names = sorted((path.stem for path in (root / "video").glob("*.mp4")), key=split_order)
    if split == "unseen":
        return [Sentence(name, root) for name in names if name[3] in UNSEEN]
    bounds = {
        "all": slice(None),
        "test": slice(TEST),
        "validation": slice(TEST, TEST + VALIDATION),
        "train": slice(TEST + VALIDATION, None),
    }
    return [Sentence(name, root) for name in names[bounds[split]]]
