"""Videos of everybody side by side with the real mouth."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

from lipwright.benchmark.entrants import REAL
from lipwright.benchmark.reporting.videos import RealMouth, write_video
from lipwright.benchmark.scoring import Performance, Stage
from lipwright.dataset.recording import Recording

VIDEOS: Final = "videos"


def write_sheets(
    out: Path, stage: Stage, found: Mapping[str, Performance], count: int,
    report: Callable[[str, float], None],
) -> None:  # fmt: skip
    """The first `count` recordings, each as a video of the real mouth and all heads."""
    for number, recording in enumerate(stage.recordings[:count]):
        tiles = [
            (name, clip) for name, one in found.items()
            if name != REAL and (clip := one.moves[number].animated) is not None
        ]  # fmt: skip
        if not tiles:
            return
        (out / VIDEOS).mkdir(exist_ok=True)
        write_video(
            out / VIDEOS / f"{recording.name}.mp4", real_mouth(recording), tiles, recording.audio,
            recording.offset,
        )  # fmt: skip
        report("videos", (number + 1) / count)


def real_mouth(recording: Recording) -> RealMouth | None:
    """What the camera saw; None where the video is gone."""
    source = recording.info.get("source", {})
    video = source.get("video", {}) if isinstance(source, dict) else {}
    path = Path(str(video.get("path", ""))) if isinstance(video, dict) else Path()
    motion = recording.motion
    if not path.is_file() or motion.landmarks is None or motion.head_pose is None:
        return None
    return RealMouth(path, motion.head_pose, motion.landmarks, motion.fps, recording.start)
