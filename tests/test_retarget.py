"""One performance on every rig: lips meet where they did, and follow as far as they went."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.evaluate.lips import BILABIALS
from lipwright.export import EXPORTERS, ExportOptions, Performance, in_rig_of, read_performance_json
from lipwright.export.rigged import for_rig
from lipwright.face.head import Head
from lipwright.face.mesh import Mesh
from lipwright.retarget import retarget
from lipwright.retarget.skinned import posed_at, skin_mesh
from lipwright.rig import (
    RIGS,
    Control,
    Corrective,
    LinearMapping,
    Rig,
    Row,
    canonical_rig,
    load_rig,
)
from lipwright.track import PhoneTrack

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
HELLO = EXAMPLES / "hello.clip.json"
Gaps = Callable[[Clip], np.ndarray]


@pytest.fixture(scope="module")
def hello() -> Performance:
    """The example's curves and phones, as `lipwright animate --keys 0.01` wrote them."""
    return read_performance_json(HELLO)


@pytest.fixture(scope="module")
def crab() -> Mesh:
    sys.path.insert(0, str(EXAMPLES))
    try:
        from crab.model import crab
    finally:
        sys.path.remove(str(EXAMPLES))
    return crab()


def on_head(rig: Rig, head: Head) -> Gaps:
    def gaps(clip: Clip) -> np.ndarray:
        seen = rig.to_canonical(clip) if rig.looks else clip
        return head.aperture_curve(seen.select(CANONICAL).values)

    return gaps


def on_bones(rig: Rig, head: Head) -> Gaps:
    skinned = skin_mesh(head, rig)

    def gaps(clip: Clip) -> np.ndarray:
        return head.aperture(np.stack(list(posed_at(skinned, rig, clip, clip.times))))

    return gaps


def on_crab(mesh: Mesh) -> Gaps:
    from crab.mouth import lip_pairs

    shell = next(part for part in mesh.parts if part.name == "shell").vertices.start
    upper, lower = (shell + lip_pairs()).T

    def gaps(clip: Clip) -> np.ndarray:
        heights = mesh.pose_many(clip.select(mesh.shape_names).values)[:, :, 1]
        return np.maximum(heights[:, upper] - heights[:, lower], 0).max(axis=1)

    return gaps


def closures(track: PhoneTrack, times: np.ndarray, gaps: np.ndarray) -> list[float]:
    """How far each p, b, m is open at its tightest, over the 95th percentile."""
    spans = [(start, end) for phone, start, end in track if phone in BILABIALS]
    inside = [(times >= start - 0.02) & (times <= end + 0.02) for start, end in spans]
    return [float(gaps[mask].min() / np.percentile(gaps, 95)) for mask in inside]


class TestFiveTargets:
    """The head, FaceFX poses, VRM expressions, bones, and a crab."""

    @pytest.mark.parametrize("name", ["arkit", "facefx", "vrm1", "bones", "crab"])
    def test_lips_are_shut_at_every_bilabial(
        self, name: str, hello: Performance, head: Head, crab: Mesh
    ) -> None:
        path = EXAMPLES / "crab" / "crab.rig.json" if name == "crab" else name
        rig = load_rig(path)
        gaps = {"bones": lambda: on_bones(rig, head), "crab": lambda: on_crab(crab)}.get(
            name, lambda: on_head(rig, head)
        )()
        assert hello.track is not None
        moved = retarget(hello.clip, rig, hello.track)
        shut = closures(hello.track, moved.times, gaps(moved))
        assert len(shut) == 7
        assert max(shut) < 0.15

    @pytest.mark.parametrize("name", ["facefx", "vrm1", "vrm0", "oculus", "mmd", "bones"])
    def test_the_aperture_follows_that_of_the_head(
        self, name: str, hello: Performance, head: Head
    ) -> None:
        rig = load_rig(name)
        gaps = on_bones(rig, head) if name == "bones" else on_head(rig, head)
        source = on_head(canonical_rig(), head)(hello.clip)
        assert np.corrcoef(source, gaps(retarget(hello.clip, rig)))[0, 1] >= 0.97


SMALL = Rig(
    "small",
    (Control("wide", -1, 1), Control("open", 0, 2, 0.5), Control("fix"), Control("still", rest=1)),
    {},
    mapping=LinearMapping(
        {
            "wide": Row({"mouthSmile": 2.0, "mouthPucker": -1.0}),
            "open": Row({"jawOpen": 3.0}, offset=0.25, clamp=(0.25, 1.5)),
        },
        (Corrective("fix", ("jawOpen", "mouthClose"), 4.0),),
    ),
)


def posed(**weights: float) -> Clip:
    row = [weights.get(name, 0.0) for name in CANONICAL]
    return Clip(CANONICAL, 30, np.array([row], np.float32))


class TestLinear:
    def test_gains_offsets_clamps_and_correctives_by_hand(self) -> None:
        moved = retarget(posed(mouthSmileLeft=0.4, mouthPucker=0.1, jawOpen=0.5), SMALL)
        # 2 x the mean of 0.4 and 0, less 0.1; 0.25 + 3 x 0.5, clamped; 0.5 x 0; at rest
        assert moved.values[0].tolist() == pytest.approx([0.3, 1.5, 0, 1])
        moved = retarget(posed(mouthSmileLeft=1, mouthSmileRight=1, jawOpen=0.5, mouthClose=0.5),
                         SMALL)  # fmt: skip
        assert moved.values[0].tolist() == pytest.approx([1, 1.5, 1, 1])  # wide: within its range

    def test_at_rest_every_control_is_at_its_offset_or_at_rest(self) -> None:
        assert retarget(posed(), SMALL).values[0].tolist() == pytest.approx([0, 0.25, 0, 1])

    @given(arrays(np.float32, (5, len(CANONICAL)), elements=st.floats(0, 1, width=32)))
    def test_every_shipped_rig_stays_within_its_ranges_whatever_the_face(
        self, values: np.ndarray
    ) -> None:
        clip = Clip(CANONICAL, 60, values)
        for name in RIGS:
            rig = load_rig(name)
            moved = retarget(clip, rig)
            assert moved.names == rig.names
            for control in rig.controls:
                curve = moved.curve(control.name)
                assert curve.min() >= np.float32(control.low)
                assert curve.max() <= np.float32(control.high)

    def test_the_rig_of_the_canonical_controls_changes_nothing(self, hello: Performance) -> None:
        moved = retarget(hello.clip, canonical_rig())
        assert moved.select(hello.clip.names).values == pytest.approx(
            hello.clip.values.clip(0, 1), abs=1e-6
        )


class TestKinds:
    def test_drawings_show_one_at_a_time_in_full(self, hello: Performance) -> None:
        moved = retarget(hello.clip, load_rig("rhubarb"), hello.track)
        assert set(np.unique(moved.values)) == {0, 1}
        assert (moved.values.sum(axis=1) == 1).all()

    def test_turns_of_the_head_go_along(self, hello: Performance) -> None:
        turning = hello.clip.select((*hello.clip.names, *HEAD_ANGLES))
        turning = turning.with_curves({"headYaw": np.linspace(0, 0.2, len(turning))})
        moved = retarget(turning, load_rig("vrm1"))
        assert moved.names == (*load_rig("vrm1").names, *HEAD_ANGLES)
        assert moved.curve("headYaw")[-1] == pytest.approx(0.2)

    def test_modes_of_a_reference_face_move_a_head(self, head: Head) -> None:
        mode = Clip(("shape1",), 30, np.linspace(-3, 3, 7, dtype=np.float32)[:, None])
        gaps = head.aperture_curve(retarget(mode, canonical_rig()).values)
        assert (np.diff(gaps) >= 0).all()
        assert gaps[-1] > gaps[0] + 0.1  # Taylor et al. 2017: mode 1 is how open the mouth is

    def test_curves_of_another_rig_are_refused(self) -> None:
        clip = Clip(("aa", "ih"), 30, np.zeros((2, 2), np.float32))
        with pytest.raises(LipwrightError, match=r"curves of aa, ih\.\.\. cannot move the rig 'cc"):
            retarget(clip, load_rig("cc4"))

    def test_a_rig_that_does_not_say_how_it_follows_is_refused(self) -> None:
        rig = Rig("mute", (Control("lid"),), {})
        with pytest.raises(LipwrightError, match=r"'mute' does not say how .*lipwright rigs fit"):
            retarget(posed(jawOpen=1), rig)


class TestExport:
    def test_an_exporter_with_a_rig_gets_canonical_curves_in_it(self, hello: Performance) -> None:
        moved = in_rig_of(EXPORTERS[".vrma"], hello, ExportOptions())
        assert moved.rig is not None
        assert moved.rig.name == "vrm1"
        assert moved.clip.names == moved.rig.names

    def test_curves_of_a_rig_go_to_another_by_their_looks(self, hello: Performance) -> None:
        oculus = for_rig(hello, load_rig("oculus"))
        moved = in_rig_of(EXPORTERS[".vrma"], oculus, ExportOptions())
        straight = in_rig_of(EXPORTERS[".vrma"], hello, ExportOptions())
        r = np.corrcoef(moved.clip.curve("aa"), straight.clip.curve("aa"))[0, 1]
        assert r > 0.8

    def test_a_head_shows_what_another_rig_looks_like(self, hello: Performance, head: Head) -> None:
        shown = in_rig_of(EXPORTERS[".mp4"], for_rig(hello, load_rig("vrm1")), ExportOptions())
        assert shown.rig is None
        source = head.aperture_curve(hello.clip.select(CANONICAL).values)
        assert np.corrcoef(source, head.aperture_curve(shown.clip.values))[0, 1] > 0.97

    def test_tables_keep_curves_in_their_own_rig(self, hello: Performance) -> None:
        own = for_rig(hello, load_rig("cc4"))
        assert in_rig_of(EXPORTERS[".csv"], own, ExportOptions()) is own
