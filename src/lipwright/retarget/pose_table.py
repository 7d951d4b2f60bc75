"""`PoseTable`: an artist's poses by their names, and the mapping that they give a rig."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Final

from lipwright.clip import Clip
from lipwright.controls import GROUPS, both_sides
from lipwright.errors import LipwrightError
from lipwright.face.shapes import MEAN, SHUT, load_reference_shape
from lipwright.rig import MODES, SIGMA, Control, PoseMapping, Rig, RigPose, Row

STILL: Final = 1e-4  # of a control's range; what moves less in a frame does not move
UNSEEN: Final = frozenset((*GROUPS["tongue"], *GROUPS["eyes"], *GROUPS["brows"]))
"""canonical controls that no shape mode of the lower face shows"""
_LABEL: Final = re.compile(r"mode([1-9][0-9]{0,2})([+-](?:[0-9]*\.)?[0-9]+)")


@dataclass(frozen=True)
class PoseTable:
    """Named poses as a file has them, before they meet a rig."""

    poses: Mapping[str, Mapping[str, float]]
    """`mean`, `shut` and `mode1-3` and so on, to control and value"""
    reference: str = PoseMapping.reference
    rows: Mapping[str, Row] = field(default_factory=dict)
    """control that no mode shows, to what it is made of"""


def pose_labels(modes: int = MODES) -> tuple[str, ...]:
    """The names of the poses of the first modes: `mode1-3`, `mode1+3`, `mode2-3` and so on."""
    return tuple(
        RigPose(mode, sigma, {}).label for mode in range(1, modes + 1) for sigma in (-SIGMA, SIGMA)
    )


def to_mapping(table: PoseTable, rig: Rig, modes: int = MODES) -> PoseMapping:
    """The poses as a mapping of a rig.

    Raises:
        LipwrightError: a pose is missing, unknown, twice or moves nothing, a control is unknown,
            or a value is out of its range.
    """
    shape = load_reference_shape(table.reference)
    sides: dict[tuple[int, bool], RigPose] = {}
    for label, values in table.poses.items():
        _check_values(label, values, rig)
        if label in {MEAN, SHUT}:
            continue
        found = _LABEL.fullmatch(label)
        if found is None or float(found[2]) == 0 or int(found[1]) > len(shape):
            raise LipwrightError(
                f"no pose {label!r}; the poses are {MEAN}, {SHUT} and mode1-3, mode1+3 to "
                f"mode{len(shape)}+3"
            )
        pose = RigPose(int(found[1]), float(found[2]), values)
        side = (pose.mode, pose.sigma > 0)
        if side in sides:
            raise LipwrightError(
                f"{label} and {sides[side].label} are one pose twice; keep one a side"
            )
        sides[side] = pose
    _check_complete(sides, modes)
    _check_names("controls", table.rows, rig)
    mean = table.poses.get(MEAN, {})
    poses = tuple(sides[side] for side in sorted(sides))
    if not any(_moves(pose.values, mean, rig) for pose in poses):
        raise LipwrightError("no pose moves anything; set the controls that show each picture")
    mapping = PoseMapping(mean, poses, table.reference, table.poses.get(SHUT, {}))
    return replace(mapping, rows={**_kept_rows(rig, mapping.controls), **table.rows})


def _kept_rows(rig: Rig, posed: set[str]) -> dict[str, Row]:
    """What moves the controls that no pose moves and no mode shows: tongue, eyes and brows."""
    own = {name: Row({name: 1.0}) for name in UNSEEN}
    rows = own if rig.mapping is None else rig.mapping.rows
    return {
        name: row for name, row in rows.items()
        if name in rig.names and name not in posed
        and all(set(both_sides(source)) <= UNSEEN for source in row.gains)
    }  # fmt: skip


def _check_complete(sides: Iterable[tuple[int, bool]], modes: int) -> None:
    there = set(sides)
    most = max([modes, *(mode for mode, _ in there)])
    wanted = {(mode, plus) for mode in range(1, most + 1) for plus in (False, True)}
    if missing := [f"mode{mode}{'+' if plus else '-'}3" for mode, plus in sorted(wanted - there)]:
        raise LipwrightError(
            f"the pose {missing[0]} is missing"
            + (f", and {len(missing) - 1} more" if len(missing) > 1 else "")
            + f"; each of {most} modes needs both, and may be as the mean where nothing shows it"
        )


def _check_values(label: str, values: Mapping[str, float], rig: Rig) -> None:
    _check_names(label, values, rig)
    for control in rig.controls:
        value = values.get(control.name, control.rest)
        if (
            isinstance(value, bool)
            or not isinstance(value, int | float)
            or not math.isfinite(value)
        ):
            raise LipwrightError(f"{label}: {control.name!r} is {value!r}, not a number")
        slack = STILL * (control.high - control.low)
        if not control.low - slack <= value <= control.high + slack:
            raise LipwrightError(
                f"{label}: {control.name!r} is {value:g}, and its range in the rig {rig.name!r} is "
                f"{control.low:g} to {control.high:g}; change the pose or the rig"
            )


def _check_names(label: str, names: Iterable[str], rig: Rig) -> None:
    for name in names:
        if name not in rig.names:
            raise LipwrightError(
                f"{label}: the rig {rig.name!r} has no control {name!r}; it has "
                f"{', '.join(rig.names)}"
            )


def _moves(values: Mapping[str, float], mean: Mapping[str, float], rig: Rig) -> bool:
    rest = {control.name: control.rest for control in rig.controls}
    return any(value != mean.get(name, rest[name]) for name, value in values.items())


def frames_to_poses(frames: Clip, rig: Rig, modes: int = MODES) -> PoseTable:
    """The poses that the frames of a clip in a rig's controls show, one each.

    As many as there are poses; one more where the mean stands before them; two more where the shut
    pose stands after them as well. Controls that rest all the time are left out; shut lips hold
    all others.

    Raises:
        LipwrightError: another number of frames.
    """
    labels = pose_labels(modes)
    orders = {len(labels): labels, len(labels) + 1: (MEAN, *labels),
              len(labels) + 2: (MEAN, *labels, SHUT)}  # fmt: skip
    if len(frames) not in orders:
        raise LipwrightError(
            f"has {len(frames)} frames; {modes} modes have {len(labels)} poses, or "
            f"{len(labels) + 1} with the mean before them, or {len(labels) + 2} with the shut "
            "lips after them"
        )
    names = [control.name for control in rig.controls if _leaves_rest(frames, control)]
    values = frames.select(names).values.astype(float).round(6).tolist()
    rows = zip(orders[len(frames)], values, strict=True)
    return PoseTable({label: dict(zip(names, row, strict=True)) for label, row in rows})


def _leaves_rest(frames: Clip, control: Control) -> bool:
    if control.name not in frames.names:
        return False
    apart = abs(frames.curve(control.name) - control.rest).max()
    return bool(apart > STILL * (control.high - control.low))
