"""Papagayo's own files, with which its and Papagayo-NG's users correct phrases, words and phonemes.

Text, as `LipsyncDoc` of Papagayo and Papagayo-NG reads it: the line `lipsync version 1`, the sound,
frames a second (a whole number), frames of the sound, the number of voices; of each voice, one tab
in, its name, its text (`|` breaks lines) and the number of phrases; of each phrase, two tabs in,
its text, first frame, last frame and number of words; of each word a line of three tabs, `WORD
FIRST LAST COUNT`, and for each of its phonemes one of four, `FRAME NAME`. Frames count from 0. A
phoneme shows until the next one or the end of its word; outside of words the mouth rests.

There are 24 frames a second, or as many as the clip has where that is 24 to 30; each is nearest to
its time. The names are Preston-Blair's, or those of the drawn rig that the curves are in.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from lipwright.export.drawn import (
    as_text,
    drawn_fps,
    drawn_shapes,
    shape_frames,
)
from lipwright.export.performance import ExportOptions, Output, Performance, text_output
from lipwright.retarget.shapes import ShownShape, rest_shape
from lipwright.track import PhoneTrack

RIG: Final = "preston-blair"
PAUSE: Final = 0.3  # s between words; a longer one starts a phrase
VOICE: Final = "Voice 1"  # as Papagayo calls the first
UNKNOWN: Final = "speech"  # the one word where nobody says what is spoken


@dataclass(frozen=True)
class _Word:
    text: str
    first: int
    """frame"""
    last: int
    """frame"""


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: shapes cannot be chosen for these curves.
    """
    rig, choose = drawn_shapes(path, performance, RIG)
    fps = round(drawn_fps(performance))
    sound = _sound(path, performance) or f"{path.stem}.wav"

    def lines() -> Iterator[str]:
        shown = choose()
        names = _frame_names(shown, fps)
        phrases = _phrases(performance.track, names, rest_shape(rig), fps)
        yield f"lipsync version 1\n{sound}\n{fps}\n{len(names)}\n1\n"
        yield from _voice_lines(phrases, names)

    return [text_output(path, lines)]


def _sound(path: Path, performance: Performance) -> str:
    """The sound from the file's folder where it lies there or below, else its whole path."""
    if performance.audio_path is None:
        return ""
    sound, folder = performance.audio_path.resolve(), path.resolve().parent
    seen = sound.relative_to(folder) if sound.is_relative_to(folder) else sound
    return as_text(seen)


def _frame_names(shown: tuple[ShownShape, ...], fps: int) -> list[str]:
    """The shape of each frame."""
    frames = shape_frames(shown, fps)
    count = max(math.ceil(shown[-1].end * fps - 1e-6), frames[-1][0] + 1)
    names: list[str] = []
    for index, (_, name) in enumerate(frames):
        stop = frames[index + 1][0] if index + 1 < len(frames) else count
        names += ["_".join(name.split())] * (stop - len(names))
    return names


def _phrases(track: PhoneTrack | None, names: list[str], rest: str, fps: int) -> list[list[_Word]]:
    """Words in phrases; in pauses they reach as far as the mouth moves for them."""
    spoken: list[tuple[str, float, float]] = []
    if track is not None:
        spoken = [(word.text, *track.word_span(word)) for word in track.words]
    spoken = spoken or [(UNKNOWN, 0.0, len(names) / fps)]
    phrases: list[list[_Word]] = []
    free = 0  # the first frame that no word has
    ended = -math.inf
    for index, (text, start, end) in enumerate(spoken):
        after = spoken[index + 1][1] if index + 1 < len(spoken) else math.inf
        first, last = max(round(start * fps), free), round(end * fps) - 1
        if start - ended > PAUSE:
            middle = free if ended == -math.inf else max(free, math.ceil((ended + start) / 2 * fps))
            moving = [f for f in range(middle, min(first, len(names))) if names[f] != rest]
            first = min([first, *moving])
        if after - end > PAUSE:
            middle = len(names) if after == math.inf else math.ceil((end + after) / 2 * fps)
            moving = [f for f in range(last + 1, min(middle, len(names))) if names[f] != rest]
            last = max([last, *moving])
        elif after < math.inf:
            last = round(after * fps) - 1
        if first >= len(names):
            break
        last = min(max(first, last), len(names) - 1)
        if start - ended > PAUSE:
            phrases.append([])
        phrases[-1].append(_Word(text, first, last))
        free, ended = last + 1, end
    return phrases


def _voice_lines(phrases: list[list[_Word]], names: list[str]) -> Iterator[str]:
    texts = [" ".join(word.text for word in phrase) for phrase in phrases]
    yield f"\t{VOICE}\n\t{'|'.join(texts)}\n\t{len(phrases)}\n"
    for phrase, text in zip(phrases, texts, strict=True):
        yield f"\t\t{text}\n\t\t{phrase[0].first}\n\t\t{phrase[-1].last}\n\t\t{len(phrase)}\n"
        for word in phrase:
            shown = range(word.first, word.last + 1)
            starts = [f for f in shown if f == word.first or names[f] != names[f - 1]]
            yield f"\t\t\t{word.text} {word.first} {word.last} {len(starts)}\n"
            for frame in starts:
                yield f"\t\t\t\t{frame} {names[frame]}\n"
