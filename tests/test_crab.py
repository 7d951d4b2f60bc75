"""The crab of the examples: a character that is no human head, from its mesh to its files."""

from __future__ import annotations

import json
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import lipwright
from lipwright.bigrams.families import load_bigrams
from lipwright.bigrams.file import load_set
from lipwright.bigrams.missing import missing, needed_pairs
from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.evaluate.lips import BILABIALS
from lipwright.export import ExportOptions, export_all, export_clip
from lipwright.face.head import Head
from lipwright.face.mesh import Mesh
from lipwright.face.render import Renderer
from lipwright.retarget import retarget
from lipwright.retarget.pose_files import read_poses
from lipwright.rig import load_rig

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
sys.path.insert(0, str(EXAMPLES))

from crab.model import CAMERA, POSES, crab  # noqa: E402  # beside the example that uses them
from crab.mouth import COLUMNS, FIRST_LIP_RING, LIP_RINGS, REACH_M, lip_pairs  # noqa: E402
from crab.sketch import TARGETS, sketch, sketch_missing  # noqa: E402

SET = EXAMPLES / "crab" / "crab.bigrams.json"
RIG = EXAMPLES / "crab" / "crab.rig.json"
SHUT_M = 1e-4  # a tenth of a millimetre, on a mouth of nine centimetres
OPENERS = {"bare teeth", "mouth open", "mouth OO"}
TONGUES = {"tongue up", "tongue down", "tongue out"}


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    return crab()


@pytest.fixture(scope="module")
def talking() -> lipwright.Result:
    words = (EXAMPLES / "hello.txt").read_text("utf-8")
    options = lipwright.AnimateOptions(bigrams=SET)
    return lipwright.animate(EXAMPLES / "hello.flac", text=words, options=options)


def posed(mesh: Mesh, **weights: float) -> np.ndarray:
    """Vertices (V, 3); names with _ for a space."""
    named = {name.replace("_", " "): weight for name, weight in weights.items()}
    assert set(named) <= set(POSES)
    return mesh.pose([named.get(name, 0.0) for name in mesh.shape_names])


def gap(vertices: np.ndarray) -> float:
    """The widest gap between the lips, m."""
    return float((vertices[lip_pairs(), 1] @ [1, -1]).max())


def part(mesh: Mesh, vertices: np.ndarray, name: str) -> np.ndarray:
    (found,) = (part for part in mesh.parts if part.name == name)
    return vertices[found.vertices]


class TestPoses:
    @pytest.mark.parametrize("name", POSES)
    def test_a_pose_moves_only_what_is_near_the_mouth(self, mesh: Mesh, name: str) -> None:
        moved, _ = mesh.shape(name)
        parts = {p.name for p in mesh.parts if set(moved) & set(range(*p.vertices.indices(10**6)))}
        allowed = {"tongue"} if name in TONGUES else {"shell", "teethUpper", "teethLower", "tongue"}
        assert parts <= allowed
        lips = mesh.vertices[FIRST_LIP_RING * COLUMNS :][: LIP_RINGS * COLUMNS]
        last = mesh.parts[0].vertices.stop - 2  # the poles lie within
        outside = moved[(moved >= FIRST_LIP_RING * COLUMNS) & (moved < last)]
        away = np.linalg.norm(mesh.vertices[outside][:, None] - lips[None, ::9], axis=-1)
        assert (away.min(axis=1) < REACH_M + 0.002).all()

    def test_every_edge_of_the_mesh_has_a_triangle_on_either_side(self, mesh: Mesh) -> None:
        edges = mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
        forwards = Counter(map(tuple, edges.tolist()))
        assert set(forwards.values()) == {1}
        assert all((end, start) in forwards for start, end in forwards)

    def test_the_lips_are_shut_at_rest_and_where_nothing_opens_them(self, mesh: Mesh) -> None:
        assert abs(mesh.vertices[lip_pairs(), 1] @ [1, -1]).max() < 1e-7
        for name in set(POSES) - OPENERS:
            for weight in (0.3, 1.0):
                assert gap(posed(mesh, **{name: weight})) < SHUT_M, name

    @pytest.mark.parametrize("name", sorted(OPENERS))
    def test_what_opens_the_lips_opens_them_wide(self, mesh: Mesh, name: str) -> None:
        assert gap(posed(mesh, **{name: 1.0})) > 0.02
        assert gap(posed(mesh, **{name: 0.5})) == pytest.approx(gap(posed(mesh, **{name: 1.0})) / 2)

    def test_a_smile_lifts_the_corners_and_a_frown_lowers_them(self, mesh: Mesh) -> None:
        left, right = FIRST_LIP_RING * COLUMNS, FIRST_LIP_RING * COLUMNS + COLUMNS // 2
        rest = mesh.vertices
        for corner in (left, right):
            assert posed(mesh, smile=1)[corner, 1] > rest[corner, 1] + 0.01
            assert posed(mesh, frown=1)[corner, 1] < rest[corner, 1] - 0.01
        assert posed(mesh, smile=1)[left, 0] > rest[left, 0] > 0

    def test_a_round_mouth_is_narrow_and_stands_out(self, mesh: Mesh) -> None:
        left, right = FIRST_LIP_RING * COLUMNS, FIRST_LIP_RING * COLUMNS + COLUMNS // 2
        vertices = posed(mesh, mouth_OO=1)
        width = vertices[left, 0] - vertices[right, 0]
        assert width < (mesh.vertices[left, 0] - mesh.vertices[right, 0]) / 3
        assert width < 1.2 * gap(vertices)
        assert vertices[left, 2] > mesh.vertices[left, 2] + 0.01

    def test_bare_teeth_stay_clenched_and_an_open_mouth_parts_them(self, mesh: Mesh) -> None:
        def apart(vertices: np.ndarray) -> float:
            upper, lower = (part(mesh, vertices, f"teeth{row}") for row in ("Upper", "Lower"))
            return float(upper[:, 1].min() - lower[:, 1].max())

        assert apart(posed(mesh, bare_teeth=1)) < 0.001
        assert apart(posed(mesh, mouth_open=1)) > 0.02

    def test_the_tongue_goes_where_its_poses_say(self, mesh: Mesh) -> None:
        rest = part(mesh, mesh.vertices, "tongue")
        tip = int(np.argmax(rest[:, 2]))
        moved = {name: part(mesh, posed(mesh, **{name: 1}), "tongue") - rest for name in TONGUES}
        assert moved["tongue up"][tip, 1] > 0.01
        assert moved["tongue down"][tip, 1] < -0.01
        out = part(mesh, posed(mesh, mouth_open=0.5, tongue_out=1), "tongue")
        lips = posed(mesh, mouth_open=0.5)[lip_pairs()]
        assert out[:, 2].max() > lips[..., 2].max() + 0.01

    def test_poses_add_up(self, mesh: Mesh) -> None:
        both = posed(mesh, mouth_open=0.6, smile=0.8) - mesh.vertices
        one, other = posed(mesh, mouth_open=0.6), posed(mesh, smile=0.8)
        assert both == pytest.approx(one + other - 2 * mesh.vertices, abs=1e-6)

    def test_weights_for_another_face_are_refused(self, mesh: Mesh) -> None:
        with pytest.raises(ValueError, match="not \\(8,\\)"):
            mesh.pose(np.zeros(55))


class TestSet:
    def test_poses_and_rig_and_mesh_are_one_set_of_names(self, mesh: Mesh) -> None:
        assert tuple(load_bigrams(SET).poses) == load_rig(RIG).names == mesh.shape_names == POSES

    def test_it_is_filled_in_part_and_says_how_each_pair_came_about(self) -> None:
        drawn = load_bigrams(SET)
        assert {bigram.source for bigram in drawn.bigrams.values()} == {"drawn", "rule"}
        assert len(drawn.bigrams) < 100 < len(drawn.classes) ** 2

    def test_it_has_every_pair_of_the_sentence(self, talking: lipwright.Result) -> None:
        drawn = load_bigrams(SET)
        assert len(needed_pairs(drawn, [talking.track])) > 50
        assert missing(drawn, talking.track) == []

    def test_a_pair_that_it_lacks_has_a_stand_in_with_a_name(self) -> None:
        drawn = load_bigrams(SET)
        track = lipwright.PhoneTrack(("sil", "AA", "SH", "sil"), np.array([0, 0.2, 0.4, 0.6, 0.8]))
        rows = missing(drawn, track)
        assert {pair for pair, _, _ in rows} >= {("aa", "sh")}
        assert all(other in drawn.bigrams for _, _, other in rows)

    def test_the_pairs_by_rule_are_those_of_the_sketch(self) -> None:
        by_rule = [b for b in load_bigrams(SET).bigrams.values() if b.source == "rule"]
        for bigram in by_rule:
            assert dict(sketch(*bigram.pair).curves) == dict(bigram.curves), bigram.pair

    def test_the_sketch_has_a_target_for_each_class_and_rounds_early(self) -> None:
        assert set(TARGETS) == set(load_bigrams(SET).classes)
        curve = dict(sketch("d", "w").curves["mouth OO"])
        assert curve[0.25] > 0.4
        assert curve[0.75] > 0.9
        assert "mouth OO" not in sketch("d", "ah").curves

    def test_the_sketch_adds_what_is_missing_and_keeps_what_is_drawn(self) -> None:
        said, whole = load_set(SET), load_bigrams(SET)
        more = sketch_missing(said, whole, "Thirty thrifty whales.")
        assert len(more.bigrams) > len(said.bigrams)
        assert all(more.bigrams[pair] is bigram for pair, bigram in said.bigrams.items())

    def test_a_pose_that_the_rig_lacks_is_named_with_what_it_has(self, tmp_path: Path) -> None:
        rig = json.loads(RIG.read_text("utf-8"))
        rig["controls"] = [c for c in rig["controls"] if c["name"] != "tongue out"]
        del rig["mapping"]  # which moves it too
        (tmp_path / RIG.name).write_text(json.dumps(rig))
        (tmp_path / SET.name).write_bytes(SET.read_bytes())
        options = lipwright.AnimateOptions(bigrams=tmp_path / SET.name)
        with pytest.raises(LipwrightError, match=r"'tongue out'.*mouth open, mouth OO") as caught:
            lipwright.animate(EXAMPLES / "hello.flac", text="hello", options=options)
        assert "\n" not in str(caught.value)


class TestTalking:
    def test_the_lips_are_shut_at_every_bilabial(
        self, mesh: Mesh, talking: lipwright.Result
    ) -> None:
        poses = talking.clip.select(mesh.shape_names).values
        seen = 0
        for phone, start, end in talking.track:
            if phone in BILABIALS:
                frame = round((start + end) / 2 * talking.clip.fps)
                assert gap(mesh.pose(poses[frame])) < SHUT_M, (phone, start)
                seen += 1
        assert seen > 5

    def test_the_mouth_opens_for_vowels_and_rests_in_pauses(
        self, mesh: Mesh, talking: lipwright.Result
    ) -> None:
        poses = talking.clip.select(mesh.shape_names).values
        first, middle = talking.track.phones.index("EH"), 0.2
        time = talking.track.edges[first : first + 2].mean()
        assert gap(mesh.pose(poses[round(time * talking.clip.fps)])) > 0.01
        assert np.abs(poses[round(middle * talking.clip.fps)]).max() < 1e-6

    def test_no_pose_leaves_its_range_or_moves_too_fast(self, talking: lipwright.Result) -> None:
        values, speed = talking.clip.values, load_bigrams(SET).speed_limit
        assert values.min() >= 0
        assert values.max() <= 1
        assert np.abs(np.diff(values, axis=0)).max() * talking.clip.fps < speed * 1.001


class TestCurvesOfAnyEngine:
    @pytest.mark.parametrize("engine", ["window", "dominance", "bigram"])
    def test_they_move_the_crab_and_shut_its_mouth_at_every_bilabial(
        self, mesh: Mesh, talking: lipwright.Result, head: Head, engine: str
    ) -> None:
        options = lipwright.AnimateOptions(engine=engine, fps=60)
        said = lipwright.animate(EXAMPLES / "hello.flac", phones=talking.track, options=options)
        moved = retarget(said.clip, load_rig(RIG))
        poses = moved.select(mesh.shape_names).values
        gaps = np.array([gap(mesh.pose(row)) for row in poses])
        real = head.aperture_curve(said.clip.select(head.shape_names).values)
        assert np.corrcoef(real, gaps)[0, 1] > 0.85
        for phone, start, end in said.track:
            if phone in BILABIALS:
                inside = slice(int(start * 60), int(np.ceil(end * 60)) + 1)
                assert gaps[inside].min() < SHUT_M, (phone, start)
        assert gaps.max() > 0.02

    def test_the_rig_has_the_poses_of_the_file_beside_it(self) -> None:
        rig = load_rig(RIG)
        assert rig.mapping == read_poses(RIG.with_name("crab.poses.json"), rig)

    def test_the_tongue_goes_where_ours_goes(self) -> None:
        names = ("tongueRaise", "tongueBack", "tonguePress")
        moved = retarget(Clip(names, 10, np.eye(3, dtype=np.float32)), load_rig(RIG))
        tongues = moved.select(("tongue up", "tongue down", "tongue out")).values
        np.testing.assert_array_equal(tongues, np.eye(3))


class TestFiles:
    def test_the_glb_has_the_poses_by_name_and_the_clip(
        self, mesh: Mesh, talking: lipwright.Result, tmp_path: Path
    ) -> None:
        import pygltflib

        options = ExportOptions(character=mesh)
        export_all([tmp_path / "crab.glb"], talking.performance, options=options)
        document = pygltflib.GLTF2().load(str(tmp_path / "crab.glb"))
        assert document.meshes[0].extras["targetNames"] == list(POSES)
        assert {len(p.targets) for p in document.meshes[0].primitives} == {len(POSES)}
        assert document.nodes[0].name == "crab"
        assert "Apache-2.0" in document.asset.copyright
        accessor = document.accessors[document.animations[0].samplers[0].output]
        view = document.bufferViews[accessor.bufferView]
        data = document.binary_blob()[view.byteOffset :][: view.byteLength]
        weights = np.frombuffer(data, np.float32).reshape(-1, len(POSES))
        assert weights.tolist() == talking.clip.values.tolist()
        assert (tmp_path / "crab.wav").stat().st_size > 0

    def test_the_mp4_shows_the_crab(self, mesh: Mesh, tmp_path: Path) -> None:
        import av

        clip = Clip(("mouth open",), 10, np.array([[0], [1], [1]], np.float32))
        options = ExportOptions(size=(160, 120), character=mesh, view=CAMERA)
        export_clip(tmp_path / "crab.mp4", clip, options=options)
        with av.open(str(tmp_path / "crab.mp4")) as video:
            frames = [frame.to_ndarray(format="rgb24") for frame in video.decode(video=0)]
        assert len(frames) == 3
        red, green, _ = frames[0].mean(axis=(0, 1))
        assert red > 1.2 * green
        assert np.abs(frames[0].astype(int) - frames[2]).max() > 60

    def test_curves_of_another_face_are_refused_with_the_poses_that_there_are(
        self, mesh: Mesh, tmp_path: Path
    ) -> None:
        clip = Clip(("jawOpen",), 10, np.zeros((2, 1), np.float32))
        with pytest.raises(LipwrightError, match=r"the blendshapes of the crab .bare teeth"):
            export_clip(tmp_path / "a.glb", clip, options=ExportOptions(character=mesh))
        assert not list(tmp_path.iterdir())

    def test_both_renderers_draw_the_same_crab(self, mesh: Mesh) -> None:
        pictures = []
        for backend in ("auto", "software"):
            with Renderer(mesh, 160, 120, backend, CAMERA) as renderer:
                pictures.append(renderer.render([0, 0, 0.5, 0.5, 0, 0, 0, 0.5]).astype(int))
        assert np.abs(pictures[0] - pictures[1]).mean() < 3
