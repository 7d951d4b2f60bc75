"""Folders of curves: how any engine takes part, one CSV file a recording.

`NAME.csv` has `time` and one column a control, as `lipwright animate -o NAME.csv` writes it;
`NAME.livelink.csv` is a recording of Live Link Face. Controls are canonical ones (0 at rest, 1 in
full), joint modes of a reference face (`joint1`, `joint2`..., in standard deviations), or both.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Final

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.export import export_clip, read_clip_csv
from lipwright.export.livelink_read import is_live_link, read_clip_live_link

SUFFIXES: Final = (".csv", ".livelink.csv")  # of formats that `lipwright convert` reads
NAMED: Final = 5  # missing recordings and wrong controls that an error lists
_MODE: Final = re.compile(r"(joint|shape|inner|outer)[1-9][0-9]*")
MOST: Final = 3.0  # of a canonical control; more is percent, or no weight at all
MOST_OF_MODES: Final = 1000.0  # standard deviations; no face comes near, and squares stay finite


def read_curves(folder: str | os.PathLike[str], names: Iterable[str]) -> dict[str, Clip]:
    """The curves of recordings.

    Args:
        folder: of the files; those of other recordings are left alone.
        names: of the recordings.

    Returns:
        Name to clip, in the order of `names`. Turns of the head are left out.

    Raises:
        LipwrightError: the folder or a recording's file is missing, or a file cannot be used; names
            file, line and column.
    """
    place = Path(folder)
    if not os.path.isdir(place):  # noqa: PTH112  # also one too long for a path
        raise LipwrightError(f"{place}: is no folder; name one with a CSV file for each recording")
    files = {name: _file_of(place, name) for name in names}
    missing = [name for name, file in files.items() if file is None]
    if missing:
        raise LipwrightError(
            f"{place}: has no curves of {_listed(missing)}, {len(missing)} of {len(files)} "
            f"recordings; add {missing[0]}{SUFFIXES[0]}"
        )
    clips = {name: _read(file) for name, file in files.items() if file is not None}
    _check_alike(place, clips)
    return clips


def write_curves(folder: str | os.PathLike[str], clips: Mapping[str, Clip]) -> None:
    """Write each clip as NAME.csv; the folder is made where it is missing.

    What is read back differs by half of a hundred-thousandth at most.

    Raises:
        LipwrightError: a name is no file's, a control is neither canonical nor a mode, or a file
            cannot be written.
    """
    place = Path(folder)
    for name, clip in clips.items():
        if not name or Path(name).name != name:
            raise LipwrightError(f"{place}: {name!r} is no name of a file; rename the recording")
        _check(place / f"{name}{SUFFIXES[0]}", clip)
    try:
        place.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LipwrightError(f"{place}: cannot be made: {error.strerror}; name another") from error
    for name, clip in clips.items():
        export_clip(place / f"{name}{SUFFIXES[0]}", clip, format=SUFFIXES[0])


def _file_of(folder: Path, name: str) -> Path | None:
    found = [path for suffix in SUFFIXES if (path := folder / f"{name}{suffix}").is_file()]
    if len(found) > 1:
        both = " and ".join(path.name for path in found)
        raise LipwrightError(f"{folder}: has both {both}; keep one of them")
    return found[0] if found else None


def _read(path: Path) -> Clip:
    clip = read_clip_live_link(path) if is_live_link(path) else read_clip_csv(path)
    clip = clip.select(name for name in clip.names if name not in HEAD_ANGLES)
    _check(path, clip)
    return clip


def _check(path: Path, clip: Clip) -> None:
    """Refuse curves that say nothing of a face that we know."""
    weights = [name for name in clip.names if name in CANONICAL]
    modes = [name for name in clip.names if _MODE.fullmatch(name)]
    others = sorted({*clip.names} - {*weights, *modes})
    if others or not clip.names:
        what = f"unknown controls {_listed(others)}" if others else "no controls"
        raise LipwrightError(
            f"{path}: line 1: {what}; use canonical controls such as jawOpen ('lipwright rigs show "
            "arkit' lists them) or modes of the reference face, joint1, joint2..."
        )
    for names, limit, kind, remedy in (
        (modes, MOST_OF_MODES, "mode", "modes are in standard deviations, scale them"),
        (weights, MOST, "control", "weights are from 0 to 1, divide them"),
    ):
        for name in names:
            most = float(abs(clip.curve(name)).max())
            if most > limit:
                raise LipwrightError(f"{path}: the {kind} {name} goes up to {most:g}; {remedy}")
    if len(clip) < 2:
        raise LipwrightError(f"{path}: has one frame, which is no motion; give two or more")


def _check_alike(place: Path, clips: Mapping[str, Clip]) -> None:
    """Refuse weights for some recordings only, or modes."""
    for what, has in (
        ("canonical controls", {name: not _weightless(clip) for name, clip in clips.items()}),
        ("modes of the reference face", {name: _has_modes(clip) for name, clip in clips.items()}),
    ):
        without = [name for name, found in has.items() if not found]
        if 0 < len(without) < len(has):
            raise LipwrightError(
                f"{place}: the curves of {_listed(without)} have no {what}, and others have; give "
                "all of them the same"
            )


def _weightless(clip: Clip) -> bool:
    return not any(name in CANONICAL for name in clip.names)


def _has_modes(clip: Clip) -> bool:
    return any(_MODE.fullmatch(name) for name in clip.names)


def _listed(names: list[str]) -> str:
    shown = ", ".join(repr(name) for name in names[:NAMED])
    return shown if len(names) <= NAMED else f"{shown} and {len(names) - NAMED} more"
