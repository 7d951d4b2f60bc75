"""The line that is said while a set is edited, and the curves that the set makes of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from lipwright.bigrams.runtime import spans, stitch
from lipwright.bigrams.values import BigramSet
from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.language.pace import spoken_track
from lipwright.passes import apply_passes
from lipwright.passes.poses import bigram_passes
from lipwright.studio.wire import pair_key
from lipwright.track import PhoneTrack

FPS: Final = 100.0  # fine enough that what moves looks round
MAX_TEXT: Final = 500  # characters
MAX_SECONDS: Final = 60.0  # of a phone track
DECIMALS: Final = 4


@dataclass(frozen=True, eq=False)
class Line:
    """Something to say."""

    text: str
    """empty where a phone track was given"""
    track: PhoneTrack


def line_of_text(text: str, language: str) -> Line:
    """The line of a text, at the times of `spoken_track`.

    Raises:
        LipwrightError: the text is too long, or cannot be said.
    """
    text = " ".join(text.split())
    if len(text) > MAX_TEXT:
        raise LipwrightError(f"the line has {len(text)} characters; give at most {MAX_TEXT}")
    return Line(text, spoken_track(text, language, "the line"))


def line_of_track(name: str, track: PhoneTrack) -> Line:
    """The line of the phone track `name`.

    Raises:
        LipwrightError: it is too long to look at.
    """
    if track.end > MAX_SECONDS:
        raise LipwrightError(
            f"{name}: is {track.end:.0f} s long; give one of at most {MAX_SECONDS:.0f} s, a line"
        )
    return Line("", track)


def final_curves(bigrams: BigramSet, track: PhoneTrack, fps: float = FPS) -> Clip:
    """What a character of the set's poses would do."""
    return apply_passes(stitch(bigrams, track, fps), track, bigram_passes(bigrams))


def line_to_json(line: Line) -> dict[str, Any]:
    """The phones and words, which no edit changes."""
    track = line.track
    return {
        "text": line.text,
        "fps": FPS,
        "duration": round(track.end, DECIMALS),
        "phones": [
            {"phone": phone, "start": round(start, DECIMALS), "end": round(end, DECIMALS)}
            for phone, start, end in track
        ],
        "words": [
            {"text": word.text, "start": round(span[0], DECIMALS), "end": round(span[1], DECIMALS)}
            for word in track.words
            for span in (track.word_span(word),)
        ],
    }


def motion_to_json(line: Line, bigrams: BigramSet) -> dict[str, Any]:
    """The final curves of the poses that move, and the pairs that they are made of."""
    clip = final_curves(bigrams, line.track)
    moving = np.flatnonzero(np.abs(clip.values).max(axis=0) > 10.0**-DECIMALS)
    return {
        "curves": {
            clip.names[column]: np.round(clip.values[:, column].astype(float), DECIMALS).tolist()
            for column in moving
        },
        "pairs": [
            {
                "pair": pair_key(span.pair),
                "index": span.index,
                "start": round(span.start, DECIMALS),
                "end": round(span.end, DECIMALS),
            }
            for span in spans(bigrams, line.track)
            if not span.within_pause and set(span.pair) <= bigrams.classes.keys()
        ],
    }
