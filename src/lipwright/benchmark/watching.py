"""Videos of everybody side by side with the real mouth."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Final

from lipwright.benchmark.entrants import Entrant
from lipwright.benchmark.reporting import real_mouth, write_video
from lipwright.benchmark.scoring import Performance, Stage
from lipwright.errors import LipwrightError

VIDEOS: Final = "videos"


def write_sheets(
    out: Path, stage: Stage, entrants: Sequence[Entrant], found: Mapping[str, Performance],
    count: int, report: Callable[[str, float], None],
) -> None:  # fmt: skip
    """The first `count` recordings, each as a video of the real mouth and all heads.

    Raises:
        LipwrightError: a video cannot be written.
    """
    for number, recording in enumerate(stage.recordings[:count]):
        tiles = [
            (one.title, clip) for one in entrants
            if one.name in found and (clip := found[one.name].moves[number].animated) is not None
        ]  # fmt: skip
        if not tiles:
            return
        try:
            (out / VIDEOS).mkdir(exist_ok=True)
        except OSError as error:
            raise LipwrightError(f"{out / VIDEOS}: cannot be made: {error.strerror}") from error
        write_video(
            out / VIDEOS / f"{recording.name}.mp4", real_mouth(recording), tiles, recording.audio,
            recording.offset,
        )  # fmt: skip
        report("videos", (number + 1) / count)
