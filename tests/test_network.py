"""Model folders: what runs, and the one clear line about each that does not."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import pytest
from google.protobuf.message import DecodeError
from hypothesis import given, settings
from hypothesis import strategies as st
from onnx import TensorProto, helper, numpy_helper

from lipwright.errors import LipwrightError
from lipwright.features import FeatureSet
from lipwright.network import ModelMeta, check_golden, load_network, shipped_models
from lipwright.onnx_bytes import has_external_data
from planted import (
    FEATURES,
    PHONES,
    change_meta,
    graph,
    middle_frame,
    middle_frame_sequence,
    rehash,
    sequence_graph,
    windows_graph,
    write_model,
)

D = FEATURES.size
ZEROS = np.zeros((1, 2))


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A whole model."""
    return middle_frame(tmp_path / "model")


def refusal(model: Path | str, use: Callable[[Any], object] = load_network) -> str:
    with pytest.raises(LipwrightError) as caught:
        use(model)
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 600
    return message


def replace_model(folder: Path, content: bytes | onnx.ModelProto) -> None:
    """Another model.onnx with a hash that fits."""
    data = content if isinstance(content, bytes) else content.SerializeToString()
    (folder / "model.onnx").write_bytes(data)
    rehash(folder)


class TestRunning:
    def test_a_windows_model_gives_what_its_weights_say(self, model: Path) -> None:
        network = load_network(model)
        rows = np.zeros((2, D), np.float32)
        rows[0, FEATURES.names.index("M at frame 1")] = 1
        rows[1, FEATURES.names.index("AA at frame 1")] = 0.5
        assert network.run(rows).tolist() == [[[1, 0]], [[0, 0.5]]]
        assert network.meta.controls == ("mouthClose", "jawOpen")
        assert network.path == model

    def test_a_sequence_model_gives_a_frame_for_each_whole_window(self, tmp_path: Path) -> None:
        network = load_network(middle_frame_sequence(tmp_path / "model"))
        said = np.eye(len(PHONES), dtype=np.float32)[[0, 3, 1, 0]]  # sil M AA sil
        assert network.run(said[None]).tolist() == [[[1, 0], [0, 1]]]

    def test_the_same_input_gives_the_same_bytes_from_two_sessions(self, tmp_path: Path) -> None:
        rng = np.random.default_rng(1)
        model = windows_graph(rng.normal(size=(D, 6)), rng.normal(size=(3, 2)))
        folder = write_model(
            tmp_path / "m", model, FEATURES, ("jawOpen", "mouthClose"), output_window=3
        )
        rows = rng.normal(size=(50, D)).astype(np.float32)
        first, second = load_network(folder).run(rows), load_network(folder).run(rows)
        assert first.tobytes() == second.tobytes()

    def test_no_rows_give_no_controls(self, model: Path) -> None:
        assert load_network(model).run(np.zeros((0, D), np.float32)).shape == (0, 1, 2)

    @pytest.mark.parametrize("shape", [(D,), (2, D + 1), (1, 2, D)])
    def test_features_of_another_shape_are_a_mistake_of_the_caller(
        self, shape: tuple[int, ...], model: Path
    ) -> None:
        with pytest.raises(ValueError, match=re.escape(f"not (N, {D})")):
            load_network(model).run(np.zeros(shape, np.float32))

    def test_a_sequence_shorter_than_a_window_is_a_mistake_of_the_caller(
        self, tmp_path: Path
    ) -> None:
        network = load_network(middle_frame_sequence(tmp_path / "model"))
        with pytest.raises(ValueError, match="3 or more"):
            network.run(np.zeros((1, 2, len(PHONES)), np.float32))

    def test_loading_and_running_print_nothing(
        self, model: Path, capfd: pytest.CaptureFixture[str]
    ) -> None:
        load_network(model).run(np.zeros((3, D), np.float32))
        replace_model(model, b"\x08\x08nonsense")
        refusal(model)
        assert capfd.readouterr() == ("", "")

    def test_numbers_that_are_not_finite_are_refused(self, model: Path) -> None:
        nodes = [
            helper.make_node("Log", ["features"], ["log"]),  # of 0
            helper.make_node("Gemm", ["log", "w"], ["flat"]),
            helper.make_node("Reshape", ["flat", "shape"], ["controls"]),
        ]
        tensors = {"w": np.ones((D, 2), np.float32), "shape": np.array([-1, 1, 2])}
        replace_model(model, graph(nodes, tensors, ["N", D], ["N", 1, 2]))
        assert "values that are not finite" in refusal(model)


class TestMeta:
    def test_it_survives_json(self, model: Path) -> None:
        meta = load_network(model).meta
        content = json.loads(json.dumps(meta.to_json()))
        assert ModelMeta.from_json(content) == meta
        assert content == json.loads((model / "meta.json").read_text())

    def test_modes_of_a_reference_face_are_no_controls_of_heads(self, model: Path) -> None:
        assert load_network(model).meta.moves_heads
        change_meta(model, target="joint", controls=["joint1", "joint2"])
        assert not load_network(model).meta.moves_heads

    @pytest.mark.parametrize(
        "field",
        ["lipwright", "name", "kind", "features", "output_window", "controls", "target", "files",
         "licence", "data", "metrics", "date"],
    )  # fmt: skip
    @pytest.mark.parametrize("value", [None, 1.5, [[]]])
    def test_a_field_that_is_missing_or_of_another_kind_is_named(
        self, field: str, value: object, model: Path
    ) -> None:
        change_meta(model, **{field: value})
        message = refusal(model)
        assert message.startswith(f"{model / 'meta.json'}: {field!r} ")
        assert "lipwright train" in message

    @pytest.mark.parametrize(
        ("fields", "needle"),
        [
            ({"kind": "lstm"}, "'kind' is 'lstm', not one of windows, sequence"),
            ({"target": "flame"}, "'target' is 'flame', not one of arkit, shape, joint"),
            ({"output_window": 4}, "'output_window' is 4, not odd"),
            ({"output_window": -1}, "'output_window' is -1"),
            ({"output_window": 3, "kind": "sequence"}, "of a sequence is 3, not 1"),
            ({"controls": []}, "'controls' is not a list of names"),
            ({"controls": ["jawOpen", 3]}, "'controls' is not a list of names"),
            ({"controls": ["jawOpen", "jawOpen"]}, "'controls' has 'jawOpen' twice"),
            ({"controls": ["jawOpen", "shape1"]}, "'shape1', which is none of arkit"),
            ({"controls": ["shape1", "shape0"], "target": "shape"}, "'shape0'"),
            ({"controls": ["shape1", "joint2"], "target": "shape"}, "'joint2'"),
            ({"files": {}}, "SHA-256 of model.onnx"),
            ({"files": {"model.onnx": "0" * 64, "golden.npz": "short"}}, "SHA-256 of golden.npz"),
            ({"files": {"model.onnx": 1, "golden.npz": 2}}, "'files' has other values than text"),
            ({"date": "yesterday"}, "'date' is 'yesterday', not YYYY-MM-DD"),
            ({"name": ""}, "'name' is empty"),
            ({"features": {"kinds": ["raw"]}}, "'features': "),
            ({"features": FEATURES.to_json() | {"window": 4}}, "'features': "),
            ({"features": FEATURES.to_json() | {"fps": 1e9}}, "1e+09 fps"),
            ({"features": FEATURES.to_json() | {"fps": 10**400}}, "not a number above 0"),
            ({"features": FEATURES.to_json() | {"window": 1_000_001}}, "more than 1001 frames"),
            ({"features": FEATURES.to_json() | {"frame": ["x"]}}, "not those of this version"),
        ],
    )
    def test_a_field_out_of_range_is_named_with_its_value(
        self, fields: dict[str, Any], needle: str, model: Path
    ) -> None:
        change_meta(model, **fields)
        assert needle in refusal(model)

    def test_a_sequence_has_no_spans(self, model: Path) -> None:
        spans = FeatureSet(("raw", "spans"), 3, 25, PHONES)
        change_meta(model, kind="sequence", features=spans.to_json())
        assert "spans, which only windows have" in refusal(model)

    @pytest.mark.parametrize(
        ("text", "needle"),
        [
            ("", "line 1, column 1: not JSON"),
            ('{"format": "lipwright-model", "version": 1', "not JSON"),
            ('{"format": "lipwright-clip", "version": 1}', "'lipwright-clip'"),
            ("[1]", "names no format"),
            ('{"format": "lipwright-model", "version": 2}', "is of version 2"),
            ('{"format": "lipwright-model"}', "is of version None"),
        ],
    )
    def test_a_file_that_is_not_ours_is_refused(self, text: str, needle: str, model: Path) -> None:
        (model / "meta.json").write_text(text)
        message = refusal(model)
        assert message.startswith(f"{model / 'meta.json'}: ")
        assert needle in message


class TestFolder:
    def test_a_name_that_nothing_has_is_refused_with_the_names_that_ship(self) -> None:
        message = refusal("nobody")
        assert "no model 'nobody'" in message
        assert all(name in message for name in shipped_models())

    @pytest.mark.parametrize("name", ["", "no/such/folder", "x" * 5000, "a\0b"])
    def test_a_path_that_leads_nowhere_is_refused(self, name: str) -> None:
        refusal(name) if name else refusal(Path("no-such"))

    def test_a_file_is_no_model(self, model: Path) -> None:
        assert "a model is a folder" in refusal(model / "model.onnx")

    @pytest.mark.parametrize("name", ["meta.json", "model.onnx"])
    def test_a_missing_file_is_named(self, name: str, model: Path) -> None:
        (model / name).unlink()
        assert refusal(model).startswith(f"{model / name}: is missing; ")

    @pytest.mark.parametrize("keep", [0, 1, 100, -1])
    def test_a_truncated_model_is_refused_by_its_hash(self, keep: int, model: Path) -> None:
        content = (model / "model.onnx").read_bytes()
        (model / "model.onnx").write_bytes(content[:keep])
        assert "is not the file that meta.json was written with, but cut off" in refusal(model)

    @pytest.mark.parametrize("name", ["meta.json", "model.onnx"])
    def test_links_out_of_the_folder_are_not_followed(
        self, name: str, model: Path, tmp_path: Path
    ) -> None:
        outside = tmp_path / name
        shutil.move(model / name, outside)
        (model / name).symlink_to(outside)
        assert refusal(model).startswith(f"{model / name}: is a link out of the model's folder")

    def test_links_within_the_folder_and_to_it_are_followed(
        self, model: Path, tmp_path: Path
    ) -> None:
        (model / "model.onnx").rename(model / "model-7.onnx")
        (model / "model.onnx").symlink_to("model-7.onnx")
        (tmp_path / "best").symlink_to(model)
        assert load_network(tmp_path / "best").meta.name == "planted"

    def test_what_is_no_file_is_refused(self, model: Path) -> None:
        path = model / "model.onnx"
        path.unlink()
        path.symlink_to(path)
        assert "cannot be read" in refusal(model)
        path.unlink()
        os.mkfifo(path)
        assert "is not a file" in refusal(model)
        path.unlink()
        path.mkdir()
        assert "is not a file" in refusal(model)

    @pytest.mark.parametrize("name", shipped_models())
    def test_a_model_that_ships_gives_its_golden_output(self, name: str) -> None:
        assert check_golden(name) < 1e-4


def one_node(takes: list[Any], gives: list[Any], **changes: Any) -> onnx.ModelProto:
    """Sums of columns: (N, D) to (N, 1, 2)."""
    tensors = {"w": np.ones((D, 2), np.float32), "shape": np.array([-1, 1, 2])}
    names = changes.get("names", ("features", "controls"))
    nodes = [
        helper.make_node("Gemm", [names[0], "w"], ["flat"]),
        helper.make_node("Reshape", ["flat", "shape"], [names[1]]),
    ]
    return graph(nodes, tensors, takes, gives, **changes)


class TestContract:
    @pytest.mark.parametrize(
        ("content", "needle"),
        [
            (b"", "onnxruntime cannot run it"),
            (b"not a model at all, whatever its hash", "not ONNX"),
            (b"\x00" * 64, "not ONNX"),
            (b"\x08\x08", "onnxruntime cannot run it"),
        ],
    )
    def test_a_file_that_is_no_network_is_refused(
        self, content: bytes, needle: str, model: Path
    ) -> None:
        replace_model(model, content)
        message = refusal(model)
        assert message.startswith(f"{model / 'model.onnx'}: ")
        assert needle in message

    def test_an_operator_that_nobody_knows_is_refused(self, model: Path) -> None:
        nodes = [helper.make_node("Teleport", ["features"], ["controls"])]
        replace_model(model, graph(nodes, {}, ["N", D], ["N", 1, 2]))
        assert "onnxruntime cannot run it" in refusal(model)

    @pytest.mark.parametrize(
        ("other", "needle"),
        [
            (one_node(["N", D], ["N", 1, 2], names=("x", "controls")), "its input is 'x'"),
            (one_node(["N", D], ["N", 1, 2], names=("features", "y")), "its output is 'y'"),
            (one_node([4, D], ["N", 1, 2]), "its input has the shape [4"),
            (windows_graph(np.zeros((D + 1, 2)), ZEROS), f"not (any, {D})"),
            (windows_graph(np.zeros((D, 6)), np.zeros((3, 2))), "not (any, 1, 2)"),
            (windows_graph(np.zeros((D, 3)), np.zeros((1, 3))), "not (any, 1, 2)"),
            (sequence_graph(np.zeros((2, len(PHONES), 3))), f"not (any, {D})"),
        ],
    )
    def test_ports_other_than_those_of_meta_are_refused(
        self, other: onnx.ModelProto, needle: str, model: Path
    ) -> None:
        replace_model(model, other)
        message = refusal(model)
        assert message.startswith(f"{model / 'model.onnx'}: its ")
        assert needle in message

    def test_numbers_of_another_kind_are_refused(self, model: Path) -> None:
        nodes = [helper.make_node("Reshape", ["features", "shape"], ["controls"])]
        tensors = {"shape": np.array([-1, 1, 2])}
        double = graph(nodes, tensors, ["N", D], ["N", 1, 2], element=TensorProto.DOUBLE)
        replace_model(model, double)
        assert "its input is tensor(double), not float32" in refusal(model)

    def test_a_second_input_is_refused(self, model: Path) -> None:
        other = one_node(["N", D], ["N", 1, 2])
        other.graph.input.append(
            helper.make_tensor_value_info("secret", TensorProto.FLOAT, ["N", 1])
        )
        replace_model(model, other)
        assert "its input is 'features, secret'" in refusal(model)

    @pytest.mark.parametrize(
        ("shape", "needle"),
        [([1, -1, 2], "gives the shape (1, 2, 2)"), ([7, 1, 2], "does not run")],
    )
    def test_an_output_that_only_running_shows_is_refused(
        self, shape: list[int], needle: str, model: Path
    ) -> None:
        tensors = {
            "w": np.ones((D, 2), np.float32), "zero": np.zeros(1, np.float32),
            "shape": np.array(shape),
        }  # fmt: skip
        nodes = [
            helper.make_node("Gemm", ["features", "w"], ["flat"]),
            helper.make_node("Mul", ["features", "zero"], ["zeros"]),
            helper.make_node("ReduceSum", ["zeros"], ["sum"], keepdims=0),
            helper.make_node("Cast", ["sum"], ["nothing"], to=TensorProto.INT64),
            helper.make_node("Add", ["shape", "nothing"], ["hidden"]),
            helper.make_node("Reshape", ["flat", "hidden"], ["controls"]),
        ]
        replace_model(model, graph(nodes, tensors, ["N", D], None))
        assert needle in refusal(model)

    @pytest.mark.parametrize("share", [0.1, 0.35, 0.6, 0.85, 0.99])
    def test_a_cut_off_file_with_a_hash_that_fits_is_refused(
        self, share: float, model: Path
    ) -> None:
        content = (model / "model.onnx").read_bytes()
        replace_model(model, content[: int(share * len(content))])
        refusal(model)


def external(tensor: onnx.TensorProto, location: str) -> onnx.TensorProto:
    tensor.data_location = TensorProto.EXTERNAL
    tensor.ClearField("raw_data")
    tensor.external_data.add(key="location", value=location)
    return tensor


def away(location: str) -> onnx.TensorProto:
    return external(numpy_helper.from_array(np.ones(3, np.float32), "t"), location)


class TestExternalData:
    @pytest.mark.parametrize("location", ["weights.bin", "../weights.bin", "/etc/hostname"])
    def test_weights_in_other_files_are_refused(self, location: str, model: Path) -> None:
        other = onnx.load_from_string((model / "model.onnx").read_bytes())
        external(other.graph.initializer[0], location)
        (model / "weights.bin").write_bytes(bytes(4 * D * 2))
        replace_model(model, other)
        assert "keeps weights in other files, which is not allowed" in refusal(model)

    def test_they_are_found_wherever_a_tensor_can_stand(self) -> None:
        def model_of(*nodes: onnx.NodeProto) -> onnx.ModelProto:
            return graph(nodes, {}, ["N", D], ["N", 1, 2])

        constant = helper.make_node("Constant", [], ["c"], value=away("b"))
        branch = helper.make_graph([constant], "branch", [], [])
        function = model_of()
        function.functions.append(
            helper.make_function("d", "f", [], ["c"], [constant], [helper.make_opsetid("", 17)])
        )
        sparse = model_of()
        sparse.graph.sparse_initializer.add().values.CopyFrom(away("c"))
        for found in (
            model_of(constant),
            model_of(helper.make_node("If", ["x"], ["y"], then_branch=branch)),
            function,
            sparse,
        ):
            assert has_external_data(found.SerializeToString())

    def test_weights_in_the_file_itself_are_none(self, model: Path) -> None:
        assert not has_external_data((model / "model.onnx").read_bytes())

    @settings(deadline=None)
    @given(st.integers(0, 10_000), st.binary(max_size=3), st.integers(0, 3))
    def test_whatever_onnx_itself_reads_as_external_is_found(
        self, place: int, put: bytes, skip: int
    ) -> None:
        constant = helper.make_node("Constant", [], ["c"], value=away("a"))
        tensors = {"x": np.ones(2, np.float32)}
        whole = graph([constant], tensors, ["N", D], ["N", 1, 2]).SerializeToString()
        place %= len(whole)
        damaged = whole[:place] + put + whole[place + skip :]
        try:
            read = onnx.load_from_string(damaged)
        except DecodeError:
            with suppress(ValueError):
                has_external_data(damaged)
            return
        held = [*read.graph.initializer, *(a.t for n in read.graph.node for a in n.attribute)]
        if any(t.data_location == TensorProto.EXTERNAL or t.external_data for t in held):
            assert has_external_data(damaged)


class TestGolden:
    def test_a_whole_model_gives_its_golden_output(self, model: Path, tmp_path: Path) -> None:
        assert check_golden(model) == 0
        assert check_golden(middle_frame_sequence(tmp_path / "sequence")) == 0

    @pytest.mark.parametrize(("error", "fits"), [(0.5e-4, True), (2e-4, False), (np.nan, False)])
    def test_one_ten_thousandth_of_a_full_range_is_what_it_may_miss(
        self, error: float, fits: bool, model: Path
    ) -> None:
        with np.load(model / "golden.npz") as stored:
            taken, given_ = stored["features"], stored["controls"].copy()
        given_[3, 0, 1] += error
        np.savez(model / "golden.npz", features=taken, controls=given_)
        rehash(model)
        if fits:
            assert check_golden(model) == pytest.approx(error, rel=0.01)
        else:
            assert "golden.npz: not reproduced: jawOpen differs by" in refusal(model, check_golden)

    def test_a_file_that_is_not_the_one_of_meta_is_refused(self, model: Path) -> None:
        (model / "golden.npz").write_bytes((model / "golden.npz").read_bytes()[:-9])
        assert "cut off" in refusal(model, check_golden)
        (model / "golden.npz").unlink()
        assert "golden.npz: is missing" in refusal(model, check_golden)

    def test_links_out_of_the_folder_are_not_followed(self, model: Path, tmp_path: Path) -> None:
        shutil.move(model / "golden.npz", tmp_path / "golden.npz")
        (model / "golden.npz").symlink_to(tmp_path / "golden.npz")
        assert "is a link out of the model's folder" in refusal(model, check_golden)

    @pytest.mark.parametrize(
        "arrays",
        [
            {},
            {"features": np.zeros((2, D), np.float32)},
            {"features": np.zeros((2, D + 1), np.float32), "controls": np.zeros((2, 1, 2))},
            {"features": np.zeros((2, D), np.float32), "controls": np.zeros((2, 1, 3), np.float32)},
            {"features": np.zeros((2, D)), "controls": np.zeros((2, 1, 2))},
            {"features": np.array([{"a": 1}], object), "controls": np.zeros((2, 1, 2))},
        ],
        ids=["empty", "no controls", "other features", "other controls", "doubles", "pickle"],
    )
    def test_arrays_that_do_not_fit_are_refused_and_pickles_not_read(
        self, arrays: dict[str, Any], model: Path
    ) -> None:
        np.savez(model / "golden.npz", **arrays)
        rehash(model)
        assert refusal(model, check_golden).startswith(f"{model / 'golden.npz'}: ")

    def test_a_file_that_is_no_archive_is_refused(self, model: Path) -> None:
        (model / "golden.npz").write_bytes(b"\x80\x04N.")  # a pickle of None
        rehash(model)
        assert "golden.npz: damaged" in refusal(model, check_golden)


def test_running_a_network_leaves_nothing_in_the_temporary_folder(tmp_path: Path) -> None:
    """onnxruntime writes an identifier there, for usage metrics, unless it is told not to."""
    code = "from lipwright.network import load_network; load_network('lipwright')"
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    environment.pop("ORT_DISABLE_TELEMETRY", None)
    subprocess.run([sys.executable, "-c", code], check=True, env=environment)
    assert list(tmp_path.iterdir()) == []
