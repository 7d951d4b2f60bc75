"""Spine skeletons in JSON, version 4.2: one slot whose mouth drawings are switched.

The layout is Esoteric Software's "JSON export format": `skeleton`, `bones`, `slots`, `skins`,
`events` and `animations`. There is one bone `root`, one slot `mouth`, a region attachment
`mouth_NAME` in the default skin for each drawing, in small letters (`mouth_a` for Rhubarb's A), and
the animation `speech` with the times (s, four decimals) at which the slot shows another one. Where
the sound is known, an event of its name plays it from the start. Import it into a project, or copy
the animation into one whose slot and attachments have these names.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path, PurePath
from typing import Any, Final

from lipwright.errors import LipwrightError
from lipwright.export.drawn import drawn_shapes, sound_name
from lipwright.export.performance import ExportOptions, Output, Performance, text_output
from lipwright.retarget.shapes import ShownShape, rest_shape
from lipwright.rig import Rig

RIG: Final = "rhubarb"
VERSION: Final = "4.2.00"
SLOT: Final = "mouth"
ANIMATION: Final = "speech"
SIZE: Final = 100  # units, of drawings that the artist's pictures replace


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: shapes cannot be chosen for these curves, or two have one name in small
            letters.
    """
    rig, choose = drawn_shapes(path, performance, RIG)
    _check_names(path, rig)
    sound = PurePath(sound_name(performance)).name
    return [text_output(path, lambda: _lines(choose(), rig, sound))]


def _lines(shown: tuple[ShownShape, ...], rig: Rig, sound: str) -> Iterator[str]:
    region = {"width": SIZE, "height": SIZE}
    attachments = {_attachment(name): region for name in rig.names}
    switches = [{"time": round(shape.start, 4), "name": _attachment(shape.name)} for shape in shown]
    animation: dict[str, Any] = {"slots": {SLOT: {"attachment": switches}}}
    skeleton: dict[str, Any] = {
        "skeleton": {"spine": VERSION, "images": "./images/", "audio": "./audio/"},
        "bones": [{"name": "root"}],
        "slots": [{"name": SLOT, "bone": "root", "attachment": _attachment(rest_shape(rig))}],
        "skins": [{"name": "default", "attachments": {SLOT: attachments}}],
    }
    if sound:
        skeleton["events"] = {ANIMATION: {"audio": sound}}
        animation["events"] = [{"time": 0, "name": ANIMATION}]
    skeleton["animations"] = {ANIMATION: animation}
    yield json.dumps(skeleton, ensure_ascii=False, indent=1) + "\n"


def _check_names(path: Path, rig: Rig) -> None:
    seen: dict[str, str] = {}
    for name in rig.names:
        if other := seen.get(_attachment(name)):
            raise LipwrightError(
                f"{path}: the drawings {other!r} and {name!r} are both {_attachment(name)!r} in "
                "Spine; rename one in the rig"
            )
        seen[_attachment(name)] = name


def _attachment(name: str) -> str:
    return f"{SLOT}_{name.lower()}"
