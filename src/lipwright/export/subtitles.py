"""Subtitles from the words of the track: SubRip, `.srt`, and WebVTT, `.vtt`.

SubRip numbers its cues and writes times as `00:00:01,250 --> 00:00:02,000`; WebVTT (W3C, "WebVTT:
The Web Video Text Tracks Format") starts with its name, has points for the commas, and `&`, `<` and
`>` in text are escaped. Times are exact to 1 ms.

A cue has at most two lines of 42 characters and lasts 1 to 7 s where the words allow it, as the
usual rules of broadcasters have it (Netflix Timed Text Style Guide: 42 characters a line, 20 a
second, 5/6 to 7 s, two frames between cues). Cues end at pauses and behind full stops rather than
within a phrase: of all ways to part the words, the one with the least cost is taken.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise
from pathlib import Path
from typing import Final
from unicodedata import east_asian_width

from lipwright.errors import LipwrightError
from lipwright.export.performance import ExportOptions, Output, Performance, text_output
from lipwright.track import PhoneTrack

LINE: Final = 42  # characters; those of Chinese count twice
LONGEST: Final = 7.0  # s
SHORTEST: Final = 1.0  # s
READ: Final = 17.0  # characters a second that people read at ease
GAP: Final = 0.08  # s between cues: two frames of 24 a second
PAUSE: Final = 0.6  # s without words; a cue does not last through it
BREATH: Final = 0.2  # s; a shorter gap is none

# What a cue costs, in arbitrary units.
EACH: Final = 1.0  # few cues
JOINED: Final = 1.5  # a full stop within one
SPLIT: Final = 2.0  # that ends within a phrase
SHORT: Final = 2.0  # a second that it is too short to be read

STOPS: Final = (".", "!", "?", "…", "。", "！", "？")
COMMAS: Final = (",", ";", ":", "、", "，", "；", "：")


@dataclass(frozen=True)
class Cue:
    """One subtitle."""

    start: float
    """s"""
    end: float
    """s"""
    lines: tuple[tuple[int, ...], ...]
    """indices of the words of each line"""


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one SubRip file.

    Raises:
        LipwrightError: nobody says which words are spoken.
    """
    track = track_with_words(path, performance)
    return [text_output(path, lambda: srt_lines(track))]


def track_with_words(path: Path, performance: Performance) -> PhoneTrack:
    """The performance's track.

    Raises:
        LipwrightError: nobody says which words are spoken.
    """
    track = performance.track
    if track is None or not track.words:
        raise LipwrightError(
            f"{path}: subtitles need words, and these curves have none; animate the recording with "
            "its words, or name a TextGrid that has them"
        )
    return track


def srt_lines(track: PhoneTrack) -> Iterator[str]:
    """The text of a SubRip file."""
    for number, cue in enumerate(make_cues(track), 1):
        yield f"{number}\n{_clock(cue.start, ',')} --> {_clock(cue.end, ',')}\n"
        for line in cue.lines:
            text = _joined([track.words[index].text for index in line])
            yield text.replace("-->", "->") + "\n"
        yield "\n"


def vtt_lines(track: PhoneTrack, *, word_times: bool = False) -> Iterator[str]:
    """The text of a WebVTT file.

    Args:
        track: has words.
        word_times: put the time before each word but a cue's first, as for karaoke.
    """
    yield "WEBVTT\n"
    for cue in make_cues(track):
        yield f"\n{_clock(cue.start, '.')} --> {_clock(cue.end, '.')}\n"
        for line in cue.lines:
            texts = [track.words[index].text for index in line]
            shown = [escape(text, quote=False) for text in texts]
            if word_times:
                times = [track.word_span(track.words[index])[0] for index in line]
                shown = [
                    f"<{_clock(time, '.')}>{text}" if cue.start < time < cue.end else text
                    for time, text in zip(times, shown, strict=True)
                ]
            yield _joined(texts, shown) + "\n"


def make_cues(track: PhoneTrack) -> tuple[Cue, ...]:
    """The words of a track as subtitles: in order, apart, all words."""
    texts = [word.text for word in track.words]
    spans = [track.word_span(word) for word in track.words]
    best = [0.0] + [float("inf")] * len(texts)  # to have parted the first words
    came = [0] * (len(texts) + 1)
    for stop in range(1, len(texts) + 1):
        for first in range(stop - 1, -1, -1):
            cost = _cost(texts, spans, first, stop)
            if cost is None:
                break
            if best[first] + cost < best[stop]:
                best[stop], came[stop] = best[first] + cost, first
    cuts = [len(texts)]
    while cuts[-1]:
        cuts.append(came[cuts[-1]])
    cuts.reverse()
    runs = list(pairwise(cuts))
    ends = [_end(texts, spans, first, stop) for first, stop in runs]
    return tuple(
        Cue(spans[first][0], end, _lines(texts, first, stop))
        for (first, stop), end in zip(runs, ends, strict=True)
    )


def _cost(
    texts: Sequence[str], spans: Sequence[tuple[float, float]], first: int, stop: int
) -> float | None:
    """Of one cue of the words from `first` to `stop`; None where they are too many for one."""
    alone = stop - first == 1
    seconds = spans[stop - 1][1] - spans[first][0]
    if not alone and (
        seconds > LONGEST
        or spans[first + 1][0] - spans[first][1] >= PAUSE
        or not _fits(texts, first, stop)
    ):
        return None
    cost = EACH
    if stop < len(texts):
        gap = spans[stop][0] - spans[stop - 1][1]
        if not texts[stop - 1].endswith(STOPS) and gap < PAUSE:
            phrase = texts[stop - 1].endswith(COMMAS) or gap >= BREATH
            cost += SPLIT / 2 if phrase else SPLIT
    cost += sum(JOINED for text in texts[first : stop - 1] if text.endswith(STOPS))
    shown = _end(texts, spans, first, stop) - spans[first][0]
    return cost + SHORT * max(0.0, _needed(texts, first, stop) - shown)


def _needed(texts: Sequence[str], first: int, stop: int) -> float:
    """Seconds to read the words."""
    return min(max(SHORTEST, _width(texts, first, stop) / READ), LONGEST)


def _end(
    texts: Sequence[str], spans: Sequence[tuple[float, float]], first: int, stop: int
) -> float:
    """The end of a cue in s: that of its words, or later if there is time to read it in."""
    start, spoken = spans[first][0], spans[stop - 1][1]
    if stop == len(texts):
        return max(spoken, start + _needed(texts, first, stop))
    free = spans[stop][0] - GAP
    end = max(spoken, start + _needed(texts, first, stop))
    return max(min(end, free), min(start + GAP, spans[stop][0]))


def _lines(texts: Sequence[str], first: int, stop: int) -> tuple[tuple[int, ...], ...]:
    """The words in one line, or in two that are as long as each other."""
    if _width(texts, first, stop) <= LINE or stop - first == 1:
        return (tuple(range(first, stop)),)
    cuts = [
        cut for cut in range(first + 1, stop)
        if max(_width(texts, first, cut), _width(texts, cut, stop)) <= LINE
    ] or [*range(first + 1, stop)]  # fmt: skip
    cut = min(cuts, key=lambda cut: abs(_width(texts, first, cut) - _width(texts, cut, stop)))
    return tuple(range(first, cut)), tuple(range(cut, stop))


def _fits(texts: Sequence[str], first: int, stop: int) -> bool:
    if _width(texts, first, stop) <= LINE:
        return True
    return any(
        max(_width(texts, first, cut), _width(texts, cut, stop)) <= LINE
        for cut in range(first + 1, stop)
    )


def _width(texts: Sequence[str], first: int, stop: int) -> int:
    """Characters of the words from `first` to `stop`, joined; wide ones count twice."""
    text = _joined(texts[first:stop])
    return len(text) + sum(_is_wide(letter) for letter in text)


def _is_wide(letter: str) -> bool:
    return not letter.isascii() and east_asian_width(letter) in "WF"


def _joined(texts: Sequence[str], shown: Sequence[str] | None = None) -> str:
    """The words with spaces between them, but not between those that are written without.

    `shown` are the same words as they stand in the file.
    """
    shown = texts if shown is None else shown
    parts = list(shown[:1])
    for (before, text), word in zip(pairwise(texts), shown[1:], strict=True):
        parts += [word] if _is_wide(before[-1]) and _is_wide(text[0]) else [" ", word]
    return "".join(parts)


def _clock(seconds: float, point: str) -> str:
    """`HH:MM:SS.mmm`, with `point` before the thousandths."""
    whole, thousandths = divmod(round(seconds * 1000), 1000)
    minutes, second = divmod(whole, 60)
    hour, minute = divmod(minutes, 60)
    return f"{hour:02}:{minute:02}:{second:02}{point}{thousandths:03}"
