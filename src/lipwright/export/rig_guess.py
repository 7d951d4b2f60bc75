"""A rig for a character of which only the names of its controls are known.

Names are looked up, by `loose_name`, among canonical controls and those of the rigs that ship; the
rig that knows most of them is asked first, so that an `O` beside `A` and `E` is a vowel of VRM and
not a drawing of Rhubarb.

A jaw without a control like `mouthClose` follows `jawOpen` less `mouthClose`, so that lips meet:
`mouthClose` undoes `jawOpen` about one to one (least squares on the blendshapes of our head: 0.99).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from lipwright.controls import CANONICAL, is_text
from lipwright.errors import LipwrightError
from lipwright.export.gltf_file import read_gltf
from lipwright.export.gltf_names import Character, loose_name
from lipwright.rig import RIGS, Control, Corrective, LinearMapping, Rig, Row, load_rig

# What avatars write before the names of visemes: Ready Player Me, VRChat, VRoid, Rocketbox.
_VISEME: Final = re.compile(r"^(?:.*\.)?(?:viseme_|v_|Fcl_(?:MTH|EYE|ALL)_|AA_VI_\d+_)(?=\w)")
_VOWELS: Final = {"I": "ih", "O": "oh", "U": "ou"}
"""names of Ready Player Me and Rocketbox beside the other visemes of Oculus, which they share"""


SHORTEST: Final = 5  # letters of a name that is taken for the end of a canonical one


@dataclass(frozen=True)
class Guess:
    """A rig, and what its controls were taken for."""

    rig: Rig
    known: Mapping[str, tuple[str, str]]
    """control to the rig that ships, and the control of it, that it was taken for"""
    shutting: tuple[str, ...] = ()
    """controls of the jaw that shut the lips as well"""


def character_controls(path: Path) -> tuple[str, ...]:
    """The names of the morph targets of a GLB or glTF file, each once.

    Raises:
        LipwrightError: the file cannot be used, or has no morph targets with names.
    """
    targets = Character(read_gltf(path)).targets.values()
    names = tuple(dict.fromkeys(name for mesh in targets for name in mesh if name))
    if not names:
        raise LipwrightError(
            f"{path}: has no morph targets with names; export them with their names"
        )
    return names


def guess_rig(name: str, controls: Iterable[str], like: Rig | None = None) -> Guess:
    """A rig of these controls, with a row for each whose name says what it is.

    Args:
        name: of the rig.
        controls: their names.
        like: the only rig to look them up in; by default all that ship.

    Raises:
        LipwrightError: a name is empty, stands twice, or has a control character or a line's end.
    """
    names = tuple(controls)
    if len(set(names)) != len(names) or not all(names):
        twice = next((repr(n) for n in names if names.count(n) > 1), "an empty name")
        raise LipwrightError(f"the controls have {twice} twice; give each control its own name")
    for each in (name, *names):
        if not each or not is_text(each):
            raise LipwrightError(
                f"{each[:40]!a} is no name: it is empty, or has a control character or a line's "
                "end; rename it"
            )
    found = _look_up(names, [like] if like is not None else [load_rig(rig) for rig in RIGS])
    mapping = _mapping(found)
    jaws = _jaws(found, mapping)
    if mapping is not None:
        mapping = LinearMapping(
            {**mapping.rows, **{jaw: _shut(mapping.rows[jaw]) for jaw in jaws}}, mapping.correctives
        )
    rig = Rig(
        name=name,
        controls=tuple(_control(control, found.get(control)) for control in names),
        mirror=_mirror(names),
        title=name,
        source="names of the character; what they follow is guessed by lipwright rigs new",
        looks=dict(_looks(found)),
        mapping=mapping,
    )
    return Guess(rig, {new: (known.name, old) for new, (known, old) in found.items()}, jaws)


def _look_up(names: tuple[str, ...], rigs: list[Rig]) -> dict[str, tuple[Rig, str]]:
    """Control to the rig and its control that it was taken for."""
    tables = [(rig, {loose_name(control): control for control in rig.names}) for rig in rigs]
    matches = [
        (rig, {n: table[key] for n in names for key in _spellings(n) if key in table})
        for rig, table in tables
    ]
    # sorted() keeps the order of RIGS where two rigs know as many.
    ranked = sorted(matches, key=lambda match: -len(match[1]))
    found: dict[str, tuple[Rig, str]] = {}
    for rig, known in ranked:
        taken = {(other.name, old) for other, old in found.values()}
        for new, old in known.items():
            if new not in found and (rig.name, old) not in taken and _follows(rig, old):
                found[new] = (rig, old)
                taken.add((rig.name, old))
    for arkit in (rig for rig in rigs if rig.mapping is None):
        for new in names:
            ends = [name for name in CANONICAL if name.casefold().endswith(loose_name(new))]
            if new not in found and len(ends) == 1 and len(loose_name(new)) >= SHORTEST:
                found[new] = (arkit, ends[0])
    return {name: found[name] for name in names if name in found}


def _spellings(name: str) -> Iterator[str]:
    """The loose names to look for; what is found last wins, so the plainest comes last."""
    bare = _VISEME.sub("", name)
    if bare != name:
        yield loose_name(bare)
        if bare in _VOWELS:
            yield loose_name(_VOWELS[bare])
    yield loose_name(name)


def _follows(rig: Rig, control: str) -> bool:
    """Whether a control of a rig that ships follows canonical ones."""
    if rig.mapping is None:
        return control in CANONICAL
    return isinstance(rig.mapping, LinearMapping) and control in rig.mapping.controls


def _control(name: str, found: tuple[Rig, str] | None) -> Control:
    if found is None:
        return Control(name)
    rig, old = found
    known = rig.controls[rig.names.index(old)]
    return Control(name, known.low, known.high, known.rest)


def _looks(found: Mapping[str, tuple[Rig, str]]) -> Iterator[tuple[str, Mapping[str, float]]]:
    for new, (rig, old) in found.items():
        if rig.mapping is None:
            yield new, {old: 1.0}
        elif old in rig.looks:
            yield new, rig.looks[old]


def _mapping(found: Mapping[str, tuple[Rig, str]]) -> LinearMapping | None:
    rows: dict[str, Row] = {}
    correctives: list[Corrective] = []
    for new, (rig, old) in found.items():
        if not isinstance(rig.mapping, LinearMapping):
            rows[new] = Row({old: 1.0})
            continue
        if old in rig.mapping.rows:
            rows[new] = rig.mapping.rows[old]
        correctives += [
            Corrective(new, c.of, c.gain) for c in rig.mapping.correctives if c.control == old
        ]
    return LinearMapping(rows, tuple(correctives)) if rows or correctives else None


def _jaws(found: Mapping[str, tuple[Rig, str]], mapping: LinearMapping | None) -> tuple[str, ...]:
    """The controls of the jaw, where no control shuts the lips."""
    if mapping is None or "mouthClose" in mapping.sources:
        return ()
    jaws = [name for name, row in mapping.rows.items() if "jawOpen" in row.gains]
    return tuple(name for name in jaws if "jaw" in found[name][1].casefold())


def _shut(row: Row) -> Row:
    """The row, with `mouthClose` against `jawOpen`."""
    return Row({**row.gains, "mouthClose": -row.gains["jawOpen"]}, row.offset, row.clamp)


def _mirror(names: tuple[str, ...]) -> dict[str, str]:
    """Pairs of names that differ only by their side."""
    loose = {loose_name(name): name for name in names}
    mirror: dict[str, str] = {}
    for key, name in loose.items():
        other = loose.get(_other_side(key))
        if other is not None and other != name and name not in mirror:
            mirror[name], mirror[other] = other, name
    return mirror


def _other_side(key: str) -> str:
    for side, other in (("left", "right"), ("right", "left")):
        if key.endswith(side):
            return key.removesuffix(side) + other
        if key.startswith(side):
            return other + key.removeprefix(side)
    return key
