"""SmartBody's sets of phone bigrams: their class names, their JSON, and what we make of them.

SmartBody (Thiebaux, Shapiro and others, USC Institute for Creative Technologies) is the system of
Xu et al. 2013. Its sets say nothing of which phones a class holds, how poses exclude each other,
or which face they are for; the tables here do.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final

from lipwright.bigrams.curves import read_curve
from lipwright.bigrams.fields import SetFile
from lipwright.bigrams.fresh import COMMON_CLASSES, FACEFX_CONSTRAINTS, FACEFX_POSES
from lipwright.bigrams.jsonvalues import check_keys, named, object_at, word_at
from lipwright.bigrams.places import Fault, Step
from lipwright.bigrams.values import OTHERWISE, Bigram, Pair, Points, Pose, check_pose_name
from lipwright.phones import PHONES, SILENCE, is_silence_label

Classes = Mapping[str, tuple[str, ...]]

LICENCE: Final = "LGPL-2.1"
SILENT: Final = "_"
"""their class of silence"""
JSON_KEYS: Final = ("set", "classes", "poses", "bigrams")

# The sets "neutral" and "angry" have a few poses of their own; `ah` drops the jaw. Ours.
EXPRESSIVE_POSES: Final = MappingProxyType({
    "ah": Pose("ah", 0), "oh": Pose("oh", 1), "oo": Pose("oo", 1), "ee": Pose("ee", 2),
    "sh": Pose("sh", 3), "lowerLipUp": Pose("lowerLipUp", 4, "widen"),
    "bmp": Pose("bmp", 5, "widen"), "lowerLipDown": Pose("lowerLipDown", 0),
    "stickyLips": Pose("stickyLips", 0), "snarl": Pose("snarl", 0), "tBack": Pose("tBack", 0),
    "tRoof": Pose("tRoof", 0), "tTeeth": Pose("tTeeth", 0),
})  # fmt: skip
EXPRESSIVE_CLASSES: Final[Classes] = MappingProxyType({
    SILENCE: (SILENCE,),
    "ah": ("AA", "AE", "AH", "AX", "AY", "HH", "HV", "Q"),  # the jaw down, the lips at ease
    "eh": ("EH", "EY", "IY"),  # its curves spread the lips with the jaw high
    "er": ("ER", "AXR"),
    "ih": ("IH", "IX", "Y"),
    "ow": ("OW", "AO", "AW", "OY"),  # open and rounded
    "w": ("W", "WH", "UW", "UH", "UX"),  # narrow and rounded
    "r": ("R",),
    "l": ("L", "EL", "TH", "DH"),  # the tongue's tip is seen
    # The jaw high, the lips apart, the tongue behind the teeth: as S and Z.
    "z": ("S", "Z", "T", "D", "N", "EN", "DX", "NX", "K", "G", "NG", "ENG"),
    "sh": ("SH", "ZH", "CH", "JH"),
    "f": ("F", "V"),
    "bmp": ("P", "B", "M", "EM"),
})  # fmt: skip
"""the 13 classes of "neutral" and "angry": one stands for several sounds, by articulation"""
EXPRESSIVE_CONSTRAINTS: Final = MappingProxyType({
    ("ah", "bmp"): 1.0, ("ah", "lowerLipUp"): 1.0, ("ah", "sh"): 1.0,
})  # fmt: skip
"""C of 1: f and sh are drawn with the jaw half down, and bmp rings on through a short vowel"""


@dataclass(frozen=True, eq=False)
class Imported:
    """A set of another format, and what had to be changed."""

    said: SetFile
    notes: tuple[str, ...] = ()
    """a line each"""


def is_smartbody_json(content: object) -> bool:
    """Whether a value of JSON is a set of SmartBody's."""
    return (
        isinstance(content, dict)
        and "format" not in content
        and isinstance(content.get("bigrams"), list)
    )


def json_to_set(content: Mapping[str, Any]) -> Imported:
    """The set of SmartBody's as JSON.

    Raises:
        Fault: something in it is wrong.
    """
    check_keys(content, JSON_KEYS, ())
    name = word_at(content["set"], ("set",)) if "set" in content else "smartbody"
    curves: dict[Pair, Mapping[str, Points]] = {}
    notes: list[str] = []
    for place, entry in enumerate(content["bigrams"]):
        path: tuple[Step, ...] = ("bigrams", place)
        fields = object_at(entry, path)
        check_keys(fields, ("from", "to", "curves"), path)
        for key in ("from", "to", "curves"):
            if key not in fields:
                raise Fault(path, f'has no "{key}"')
        first, second = (class_name(fields[key], (*path, key)) for key in ("from", "to"))
        if (first, second) in curves:
            notes.append(repeated_note((first, second)))
        rows = object_at(fields["curves"], (*path, "curves"))
        curves[first, second] = {
            pose: _curve(pose, row, (*path, "curves", pose)) for pose, row in rows.items()
        }
    return curves_to_set(name, curves, notes)


def _curve(pose: str, row: object, path: tuple[Step, ...]) -> Points:
    try:
        check_pose_name(pose)
    except ValueError as error:
        raise Fault(path, str(error), of_key=True) from None
    return read_curve(row, path)


def class_name(value: object, path: tuple[Step, ...]) -> str:
    """Our name of a class of theirs.

    Raises:
        Fault: it is none.
    """
    name = word_at(value, path)
    if name.split() != [name]:
        raise Fault(path, f"{named(path)}: the class {name[:40]!r} has white space")
    return SILENCE if is_silence_label(name) else name


def repeated_note(pair: Pair) -> str:
    """What is said of a pair that stands twice."""
    return f"the pair {' '.join(pair)!r} stands twice; the later one is taken, as in SmartBody"


def curves_to_set(
    name: str, curves: Mapping[Pair, Mapping[str, Points]], notes: Sequence[str] = ()
) -> Imported:
    """A set of imported curves, with classes, poses and constraints by our tables."""
    clipped = 0
    bigrams = {}
    for pair, drawn in curves.items():
        inside = {pose: _inside(points) for pose, points in drawn.items()}
        clipped += sum(
            one != other
            for pose, points in drawn.items()
            for one, other in zip(points, inside[pose], strict=True)
        )
        bigrams[pair] = Bigram(pair[0], pair[1], inside, "imported")
    if clipped:
        notes = [*notes, f"{clipped} control points lay a little out of 0 to 1 and are now at it"]
    names = list(dict.fromkeys(one for pair in bigrams for one in pair))
    moved = dict.fromkeys(pose for bigram in bigrams.values() for pose in bigram.curves)
    is_facefx = set(moved) <= set(FACEFX_POSES)
    known = FACEFX_POSES if is_facefx else EXPRESSIVE_POSES
    poses = {pose: known[pose] for pose in known if is_facefx or pose in moved}
    poses |= {pose: Pose(pose) for pose in moved if pose not in known}
    constraints = FACEFX_CONSTRAINTS if is_facefx else EXPRESSIVE_CONSTRAINTS
    said = SetFile(
        name=name,
        language="en",
        licence=LICENCE,
        source=f"the set {name!r} of SmartBody, the system of Xu et al. 2013",
        rig="facefx" if is_facefx else "smartbody",
        classes=classes_of(names),
        poses=poses,
        constraints={pair: c for pair, c in constraints.items() if set(pair) <= set(poses)},
        otherwise=OTHERWISE,
        bigrams=bigrams,
    )
    return Imported(said, tuple(notes))


def classes_of(names: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """Classes of theirs to our phones.

    A set whose classes are those of "neutral" takes `EXPRESSIVE_CLASSES`, any other
    `COMMON_CLASSES`; a class in neither is the phone of that name, if there is one, or else none.
    So are j, oh and oo of "default", which have a few pairs and no phone of their own.
    """
    is_expressive = set(names) <= set(EXPRESSIVE_CLASSES)
    table = EXPRESSIVE_CLASSES if is_expressive else {**COMMON_CLASSES, SILENCE: (SILENCE,)}
    own = {name: name.upper() for name in names if name not in table and name.upper() in PHONES}
    return {
        name: (own[name],)
        if name in own
        else tuple(phone for phone in table.get(name, ()) if phone not in own.values())
        for name in sorted(names)
    }


def _inside(points: Points) -> Points:
    return tuple((min(max(time, 0.0), 1.0), value) for time, value in points)
