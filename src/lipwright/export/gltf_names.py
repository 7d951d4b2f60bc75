"""`Character`: what a glTF file lets us move, by the names that it has for it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cached_property
from typing import Final

from lipwright.controls import HEAD_ANGLES
from lipwright.export.gltf_file import GltfFile
from lipwright.export.gltf_store import Json
from lipwright.export.vrm import Bind, expressions, head_bone, nodes_of_meshes
from lipwright.rig.values import CHANNELS

MAX_TARGETS: Final = 5000  # of a mesh; faces with the most correctives have some 800

_SIDE: Final = re.compile(r"(?:[._\s-]([LRlr])|(?<=[a-z])([LR]))$")
_PREFIX: Final = re.compile(
    r"^(?:arkit|bs|blendshapes?|morph(?:target)?s?|shapes?|exp|face|head|body)\d*[_.\s-]+(?=\w)",
    re.IGNORECASE,
)
_HEADS: Final = ("head", "neck")  # what turns with the head, the first of them that is there


def loose_name(name: str) -> str:
    """A name without case, underscores, spaces and usual prefixes, its side in full.

    `Head.jawOpen`, `blendShape1.jawOpen` and `jaw_open` are one, as are `mouthSmile_L` and
    `mouthSmileLeft`.
    """
    sided = _SIDE.sub(lambda end: "Left" if (end[1] or end[2]) in "lL" else "Right", name)
    last = re.split(r"[.:|/]", sided)[-1] or sided
    return re.sub(r"[\W_]+", "", _PREFIX.sub("", last)).casefold()


class Character:
    """The morph targets, expressions and bones of a file."""

    def __init__(self, file: GltfFile) -> None:
        """Read the names of `file`."""
        self.file = file
        self.nodes = file.tables("nodes")
        self.shown = nodes_of_meshes(file)

    @cached_property
    def targets(self) -> dict[int, tuple[str, ...]]:
        """Mesh to the names of its morph targets, empty where one has none."""
        return {number: self._target_names(number) for number in self.shown}

    def _target_names(self, number: int) -> tuple[str, ...]:
        file = self.file
        mesh, where = file.tables("meshes")[number], f"mesh {number}: "
        primitives = file.tables("primitives", mesh, where)
        count = len(file.tables("targets", primitives[0], where)) if primitives else 0
        if count > MAX_TARGETS:
            file.fail(f"mesh {number} has {count} morph targets, which no face has")
        # VRM 0.x writers put the names of a mesh into the extras of its primitives.
        for holder in (mesh, *primitives[:1]):
            names = file.table("extras", holder).get("targetNames")
            if isinstance(names, list):
                words = [name if isinstance(name, str) else "" for name in names[:count]]
                return tuple(words + [""] * (count - len(words)))
        return ("",) * count

    @cached_property
    def _expressions(self) -> dict[str, tuple[Bind, ...]]:
        found = {}
        for name, binds in expressions(self.file):
            known = [bind for bind in binds if bind.target < self.target_count(bind.node)]
            if known:  # others change colours alone
                found[name] = tuple(known)
        return found

    def target_count(self, node: int) -> int:
        """The number of morph targets of what a node shows."""
        mesh = self.nodes[node].get("mesh")
        return len(self.targets.get(mesh, ())) if isinstance(mesh, int) else 0

    @cached_property
    def _loose_expressions(self) -> dict[str, tuple[Bind, ...]]:
        return {loose_name(name): self._expressions[name] for name in reversed(self._expressions)}

    @cached_property
    def _exact_targets(self) -> dict[int, dict[str, int]]:
        return {mesh: _places(names) for mesh, names in self.targets.items()}

    @cached_property
    def _loose_targets(self) -> dict[int, dict[str, int]]:
        return {mesh: _places(map(loose_name, names)) for mesh, names in self.targets.items()}

    def binds(self, name: str) -> tuple[tuple[Bind, ...], bool]:
        """What a control moves, and whether its name is there letter by letter."""
        if name in self._expressions:
            return self._expressions[name], True
        exact = any(name in names for names in self._exact_targets.values())
        loose = loose_name(name)
        if not exact and loose in self._loose_expressions:
            return self._loose_expressions[loose], False
        found = []
        for mesh, nodes in self.shown.items():
            target = self._exact_targets[mesh].get(name, self._loose_targets[mesh].get(loose))
            if target is not None:
                found += [Bind(node, target) for node in nodes]
        return tuple(found), exact

    @cached_property
    def _bones(self) -> dict[str, int]:
        names = [self.file.name(node) for node in self.nodes]
        return _places(map(loose_name, names)) | _places(names)

    def bone(self, control: str) -> tuple[int, int] | None:
        """The node that a control `NAME.tx` to `NAME.rz` moves, and which of the six it is."""
        name, _, channel = control.rpartition(".")
        if not name or channel not in CHANNELS:
            return None
        node = self._bones.get(name, self._bones.get(loose_name(name)))
        return None if node is None else (node, CHANNELS.index(channel))

    @cached_property
    def head(self) -> int | None:
        """The node that turns with the head."""
        found = head_bone(self.file)
        if found is not None:
            return found
        joints: list[int] = []
        for number, skin in enumerate(self.file.tables("skins")):
            listed = skin.get("joints")
            for joint in listed if isinstance(listed, list) else ():
                joints.append(
                    self.file.index({"joint": joint}, "joint", len(self.nodes), f"skin {number}")
                )
        for wanted in _HEADS:
            for node in (*joints, *range(len(self.nodes))):
                if loose_name(self.file.name(self.nodes[node])) == wanted:
                    return node
        return None

    def knows(self, control: str) -> float:
        """How well a control is known: 1 by its name, 0.5 by a like one, 0 not at all.

        The six controls of a bone count as one.
        """
        if control in HEAD_ANGLES:
            return float(self.head is not None)
        binds, exact = self.binds(control)
        if binds:
            return 1.0 if exact else 0.5
        return 0.0 if self.bone(control) is None else 1 / len(CHANNELS)

    def names(self) -> list[str]:
        """The names of expressions and morph targets, or of bones where there are none."""
        shapes = [*self._expressions, *(n for names in self.targets.values() for n in names)]
        bones = [self.file.name(node) for node in self.nodes]
        return list(dict.fromkeys(filter(None, shapes))) or list(filter(None, bones))

    def children(self, node: Json) -> list[int]:
        """The nodes right below one."""
        listed = node.get("children", [])
        if not isinstance(listed, list):
            self.file.fail("a node's 'children' is not a list")
        return [
            self.file.index({"child": child}, "child", len(self.nodes), "a node")
            for child in listed
        ]


def _places(names: Iterable[str]) -> dict[str, int]:
    """Name to the place where it stands first."""
    places: dict[str, int] = {}
    for place, name in enumerate(names):
        if name:
            places.setdefault(name, place)
    return places
