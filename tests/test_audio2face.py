"""Audio2Face weights, read back with json and with OpenFaceFX's reader."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from engine_clips import waves
from lipwright.controls import ARKIT, CANONICAL
from lipwright.errors import LipwrightError
from lipwright.export import export_clip


def test_the_fields_are_those_that_audio2face_writes(tmp_path: Path) -> None:
    clip = waves(*CANONICAL, "headYaw", still="")
    export_clip(path := tmp_path / "a.a2f.json", clip, audio=Path("takes/hello.wav"))
    found = json.loads(path.read_text())
    assert list(found) == [
        "exportFps", "trackPath", "numPoses", "numFrames", "facsNames", "weightMat",
    ]  # fmt: skip
    assert (found["exportFps"], found["numPoses"], found["numFrames"]) == (60, 52, len(clip))
    assert isinstance(found["exportFps"], int)
    assert found["trackPath"] == "hello.wav"
    assert tuple(found["facsNames"]) == ARKIT
    weights = np.array(found["weightMat"])
    assert weights.min() >= 0
    np.testing.assert_allclose(weights, clip.select(ARKIT).values, atol=1e-6)


def test_another_reader_finds_the_same_curves(tmp_path: Path) -> None:
    reader = pytest.importorskip("openfacefx.export_a2f", reason="openfacefx is not installed")
    clip = waves("jawOpen", "tongueOut", fps=29.97, still="")
    export_clip(path := tmp_path / "a.a2f.json", clip)
    track, _ = reader.read_a2f(str(path), epsilon=1e-6)
    curves = {channel.name: channel.keys for channel in track.channels}
    for name in clip.names:
        keys = np.array([(key.time, key.value) for key in curves[name]])
        seen = np.interp(clip.times, keys[:, 0], keys[:, 1])
        np.testing.assert_allclose(seen, clip.curve(name), atol=1e-4)  # it thins keys


def test_curves_of_no_face_are_refused(tmp_path: Path) -> None:
    with pytest.raises(LipwrightError, match=r"a\.a2f\.json: the curves have no ARKit controls"):
        export_clip(tmp_path / "a.a2f.json", waves("claw"))
