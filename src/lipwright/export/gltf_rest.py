"""`Rests`: where the nodes of a glTF file are at rest."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from lipwright.export.gltf_curves import multiply
from lipwright.export.gltf_names import Character

Floats = npt.NDArray[np.float64]

SMALLEST = 1e-6  # a scale below makes a node vanish


class Rests:
    """Rest transforms of a character's nodes; those with a matrix get its parts instead.

    Raises:
        LipwrightError: a node is its own ancestor or has two parents, or its numbers are none.
    """

    def __init__(self, character: Character) -> None:
        """Read the nodes of `character`."""
        self.character = character
        self.file = character.file
        self.parents: dict[int, int] = {}
        for number, node in enumerate(character.nodes):
            for child in character.children(node):
                if child in self.parents:
                    self.file.fail(f"node {child} has two parents")
                self.parents[child] = number
        for number in range(len(character.nodes)):
            self._check(number)
        self._check_circles()

    def _check(self, number: int) -> None:
        node, where = self.character.nodes[number], f"node {number}"
        for key, default in (
            ("matrix", [0.0] * 16), ("translation", [0.0] * 3), ("rotation", [0.0, 0.0, 0.0, 1.0]),
            ("scale", [1.0] * 3),
        ):  # fmt: skip
            self.file.numbers(node, key, default, where)

    def _check_circles(self) -> None:
        safe: set[int] = set()
        for number in range(len(self.character.nodes)):
            way: dict[int, None] = {}
            node: int | None = number
            while node is not None and node not in safe:
                if node in way:
                    self.file.fail(f"node {node} is its own ancestor")
                way[node] = None
                node = self.parents.get(node)
            safe.update(way)

    def translation(self, number: int) -> Floats:
        """(3,), in the parent's axes."""
        self._split(number)
        return np.array(self.character.nodes[number].get("translation", [0.0] * 3), np.float64)

    def rotation(self, number: int) -> Floats:
        """(4,), a unit quaternion."""
        self._split(number)
        return self._turn(number)

    def parent_turn(self, number: int) -> Floats:
        """(4,), how the axes of a node's parent are turned in the scene."""
        turn = np.array([0.0, 0.0, 0.0, 1.0])
        for parent in self._ancestors(number):
            turn = multiply(self._turn(parent), turn)
        return turn

    def parent_scale(self, number: int) -> float:
        """How long a unit of a node's parent is in the scene, in m."""
        scale = 1.0
        for parent in self._ancestors(number):
            node = self.character.nodes[parent]
            if "matrix" in node:
                axes = np.array(node["matrix"], np.float64).reshape(4, 4)[:3, :3]
                scale *= abs(float(np.linalg.det(axes))) ** (1 / 3)
            else:
                sides = np.array(node.get("scale", [1.0] * 3), np.float64)
                scale *= abs(float(np.prod(sides))) ** (1 / 3)
        if not SMALLEST < scale < 1 / SMALLEST:
            self.file.fail(f"node {number} is scaled to {scale:g}")
        return scale

    def _ancestors(self, number: int) -> list[int]:
        found = []
        parent = self.parents.get(number)
        while parent is not None:
            found.append(parent)
            parent = self.parents.get(parent)
        return found

    def _turn(self, number: int) -> Floats:
        node = self.character.nodes[number]
        if "matrix" in node:
            return self._parts(number)[1]
        turn = np.array(node.get("rotation", [0.0, 0.0, 0.0, 1.0]), np.float64)
        length = float(np.linalg.norm(turn))
        if length < SMALLEST:
            self.file.fail(f"node {number} has a rotation of length 0")
        return np.asarray(turn / length)

    def _parts(self, number: int) -> tuple[Floats, Floats, Floats]:
        """Translation, rotation and scale of a node's matrix, which stands column by column."""
        from scipy.spatial.transform import Rotation

        matrix = np.array(self.character.nodes[number]["matrix"], np.float64).reshape(4, 4)
        axes = matrix[:3, :3]  # rows are the images of x, y and z
        scale = np.linalg.norm(axes, axis=1)
        if scale.min() < SMALLEST:
            self.file.fail(f"node {number} has a flat matrix")
        scale[0] *= np.sign(np.linalg.det(axes)) or 1.0
        turn = Rotation.from_matrix((axes / scale[:, None]).T).as_quat()
        return matrix[3, :3], np.asarray(turn), scale

    def _split(self, number: int) -> None:
        """Say a node's matrix as its parts: what has a matrix cannot be animated."""
        node = self.character.nodes[number]
        if "matrix" in node:
            translation, rotation, scale = self._parts(number)
            del node["matrix"]
            node["translation"] = translation.tolist()
            node["rotation"] = rotation.tolist()
            node["scale"] = scale.tolist()
