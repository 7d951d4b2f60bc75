"""Landmarks of a character that nobody gave: the face tracker looks at its picture."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from lipwright.capture import character_landmarks
from lipwright.capture.character_landmarks import find_landmarks
from lipwright.errors import LipwrightError
from lipwright.face.head import Head
from lipwright.face.head_landmarks import named_points, pairs
from lipwright.face.surface import Surface, mesh_surface

pytest.importorskip("mediapipe", reason="the face tracker is not installed")

FAR_M = 0.012  # the tracker, made for photographs, sees a drawn head this well
SIZE = 2.5  # of the character, moved to where its origin might be


def test_those_of_our_head_are_found_wherever_it_stands_and_however_large(head: Head) -> None:
    surface = mesh_surface(head)
    shift = np.array([3.0, -1.0, 0.5])
    moved = Surface(surface.vertices * SIZE + shift, surface.triangles, surface.welds)
    found = pairs(head, find_landmarks(moved, head))
    assert len(found.names) > len(named_points()) * 0.8
    off = np.linalg.norm((found.points - shift) / SIZE - found.on(head.vertices), axis=1)
    assert off.max() < FAR_M


def test_a_mesh_without_a_face_is_told(head: Head) -> None:
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    tetrahedron = Surface(corners, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]))
    with pytest.raises(LipwrightError, match=r"no face is seen in the mesh; .* --landmarks"):
        find_landmarks(tetrahedron, head)


def test_a_face_seen_beside_the_mesh_is_too_little(
    head: Head, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Confused:
        """A tracker that takes a corner of the picture for a face."""

        def track_frame(self, picture: npt.NDArray[np.uint8]) -> list[npt.NDArray[np.float64]]:
            del picture
            return [np.random.default_rng(1).uniform(0, 9, (478, 3))]

    monkeypatch.setattr(character_landmarks, "Tracker", Confused)
    with pytest.raises(LipwrightError, match=r"too little of a face .* give --landmarks"):
        find_landmarks(mesh_surface(head), head)
