"""Subtitles from the words of the track as WebVTT; the cues are those of `subtitles`."""

from __future__ import annotations

from pathlib import Path

from lipwright.export.performance import ExportOptions, Output, Performance, text_output
from lipwright.export.subtitles import track_with_words, vtt_lines


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: nobody says which words are spoken.
    """
    track = track_with_words(path, performance)
    return [text_output(path, lambda: vtt_lines(track))]
