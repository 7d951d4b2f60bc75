"""The window engine: whole, as a stream, and from the command line."""

from __future__ import annotations

import contextlib
import io
import json
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import PchipInterpolator

from lipwright.audio import Audio, read_audio
from lipwright.cli import run
from lipwright.cli.modelling import models
from lipwright.clip import Clip, frame_times
from lipwright.controls import CANONICAL
from lipwright.engines import DEFAULT_MODEL, engine_controls, get_engine, window
from lipwright.engines.resample import Resampler, monotone_cubic
from lipwright.engines.window import FrameMean, animate, open_network
from lipwright.engines.window_stream import Stream
from lipwright.errors import LipwrightError
from lipwright.export import read_clip
from lipwright.features import FeatureSet
from lipwright.features.sound import sound_features
from lipwright.formats import write_track
from lipwright.network import Network, load_network
from lipwright.phones import PHONES as TABLE
from lipwright.pipeline import AnimateOptions, animate_track
from lipwright.track import PhoneTrack
from planted import (
    FEATURES,
    PHONES,
    change_meta,
    middle_frame,
    middle_frame_sequence,
    sequence_graph,
    windows_graph,
    write_model,
)

HELLO = Path(__file__).parents[1] / "examples" / "hello.flac"
KINDS = ("raw", "spans", "attributes", "transitions", "timing")
CONTROLS = ("jawOpen", "mouthClose")

Values = npt.NDArray[np.float32]


def track(phones: str, each: float = 0.12) -> PhoneTrack:
    symbols = tuple(phones.split())
    return PhoneTrack(symbols, np.arange(len(symbols) + 1) * each)


def random_network(
    folder: Path, kind: str, kinds: Sequence[str], window: int, output_window: int, fps: float
) -> Network:
    """Weights without any symmetry that could hide a mistake."""
    features = FeatureSet(tuple(kinds), window, fps, PHONES)
    rng = np.random.default_rng(3)
    if kind == "windows":
        weights = rng.normal(0, 0.1, (features.size, output_window * 2))
        graph = windows_graph(weights, rng.normal(0, 0.1, (output_window, 2)))
    else:
        graph = sequence_graph(rng.normal(0, 0.1, (2, features.frame_size, window)))
    write_model(folder, graph, features, CONTROLS, kind=kind, output_window=output_window)
    return load_network(folder)


class TestFrameMean:
    def test_overlapping_windows_are_averaged_as_by_hand(self) -> None:
        mean = FrameMean(3, 1)
        outputs = np.array([[1, 2, 4], [8, 16, 32], [64, 128, 256]], np.float32)[:, :, None]
        # Frame 0 is in windows 0 and 1, frame 1 in all three, frame 2 in windows 1 and 2; what
        # lies before the first frame or after the last (1 and 256) counts for nothing.
        assert mean.add(outputs).ravel().tolist() == [(2 + 8) / 2, np.float32((4 + 16 + 64) / 3)]
        assert mean.end().ravel().tolist() == [(32 + 128) / 2]

    def test_windows_of_one_frame_pass_through(self) -> None:
        outputs = np.arange(6, dtype=np.float32).reshape(3, 1, 2)
        mean = FrameMean(1, 2)
        assert mean.add(outputs).tolist() == [[0, 1], [2, 3], [4, 5]]
        assert mean.end().shape == (0, 2)

    @settings(max_examples=50, deadline=None)
    @given(st.sampled_from([1, 3, 5, 15]), st.lists(st.integers(0, 9), min_size=1, max_size=6))
    def test_it_is_the_mean_of_all_that_cover_a_frame_however_they_come(
        self, output_window: int, sizes: list[int]
    ) -> None:
        count, half = sum(sizes), output_window // 2
        outputs = np.random.default_rng(0).normal(size=(count, output_window, 2)).astype("f4")
        mean = FrameMean(output_window, 2)
        edges = np.cumsum([0, *sizes])
        got = [mean.add(outputs[a:b]) for a, b in pairwise(edges)]
        found = np.concatenate([*got, mean.end()])
        assert len(found) == count
        for frame in range(count):
            covering = range(max(frame - half, 0), min(frame + half, count - 1) + 1)
            expected = np.mean([outputs[w, frame - w + half] for w in covering], axis=0)
            np.testing.assert_allclose(found[frame], expected, atol=1e-6)


class TestResampling:
    @settings(deadline=None)
    @given(st.integers(1, 12), st.integers(0, 99))
    def test_it_is_the_monotone_cubic_of_scipy(self, count: int, seed: int) -> None:
        values = np.random.default_rng(seed).normal(size=(count, 3)).round(1).astype(np.float32)
        place = np.linspace(0, count - 1, 61)
        expected = (
            PchipInterpolator(np.arange(count), values.astype(np.float64))(place)
            if count > 1
            else np.repeat(values, 61, axis=0)
        )
        np.testing.assert_allclose(monotone_cubic(values, place), expected, atol=1e-6)

    @settings(deadline=None)
    @given(st.integers(2, 12), st.integers(0, 99))
    def test_it_never_passes_its_neighbours(self, count: int, seed: int) -> None:
        values = np.random.default_rng(seed).normal(size=(count, 2)).astype(np.float32)
        place = np.linspace(0, count - 1, 101)
        low = np.minimum(place.astype(int), count - 2)
        ends = np.stack([values[low], values[low + 1]])
        between = monotone_cubic(values, place)
        assert (between >= ends.min(axis=0) - 1e-6).all()
        assert (between <= ends.max(axis=0) + 1e-6).all()

    def test_it_is_nearer_to_a_smooth_curve_than_straight_lines(self) -> None:
        curve = np.sin(np.arange(101) / 100 * 4 * np.pi)[:, None]
        coarse = Clip(("jawOpen",), 25, curve[::4])
        cubic = monotone_cubic(coarse.values, np.arange(101) / 4)
        lines = coarse.at(np.arange(101) / 100)
        assert np.square(cubic - curve).mean() < 0.7 * np.square(lines - curve).mean()

    @settings(deadline=None)
    @given(
        st.lists(st.integers(0, 7), min_size=1, max_size=8).filter(any),
        st.sampled_from([25.0, 10.0, 24.0, 29.97, 30.0, 60.0, 100.0]),
    )
    def test_frames_in_pieces_give_what_the_whole_gives(self, sizes: list[int], fps: float) -> None:
        count = sum(sizes)
        values = np.random.default_rng(1).normal(size=(count, 2)).astype(np.float32)
        duration = (count - 1.5) / 25 if count > 1 else 0.0
        resampler, edges = Resampler(25, fps, 2), np.cumsum([0, *sizes])
        parts = [resampler.add(values[a:b]) for a, b in pairwise(edges)]
        found = np.concatenate([*parts, resampler.end(duration)])
        times = frame_times(duration, fps)
        if fps == 25:
            assert found.tobytes() == values.tobytes()
        else:
            assert len(found) == len(times)
            expected = monotone_cubic(values, np.minimum(times * 25, count - 1))
            np.testing.assert_allclose(found, expected, atol=1e-5)


class TestAnimating:
    def test_the_middle_frame_moves_what_it_says(self, tmp_path: Path) -> None:
        clip = animate(track("sil M AA sil"), 25, model=middle_frame(tmp_path / "m"))
        assert clip.names == CANONICAL
        assert clip.fps == 25
        said = [0] * 3 + [1] * 3 + [0] * 7
        assert clip.curve("mouthClose").tolist() == said
        assert clip.curve("jawOpen").tolist() == [0] * 6 + [1] * 3 + [0] * 4
        rest = [name for name in CANONICAL if name not in ("mouthClose", "jawOpen")]
        assert not clip.select(rest).values.any()

    def test_a_phone_that_was_never_learnt_moves_like_the_nearest(self, tmp_path: Path) -> None:
        model = middle_frame(tmp_path / "m")
        seen = animate(track("sil M AA sil"), 25, model=model)
        unseen = animate(track("sil P AA sil"), 25, model=model)
        assert unseen.values.tobytes() == seen.values.tobytes()

    def test_frames_near_the_ends_are_means_of_fewer(self, tmp_path: Path) -> None:
        graph = windows_graph(np.zeros((FEATURES.size, 3)), np.array([[0.0], [1], [2]]))
        folder = write_model(tmp_path / "m", graph, FEATURES, ("jawOpen",), output_window=3)
        curve = animate(track("sil AA sil"), 25, model=folder).curve("jawOpen")
        assert curve.tolist() == [0.5, *[1.0] * 8, 1.5]

    @pytest.mark.parametrize("fps", [1, 24, 25, 29.97, 60, 1000])
    def test_any_rate_covers_the_track(self, fps: float, tmp_path: Path) -> None:
        clip = animate(track("sil M AA sil"), fps, model=middle_frame(tmp_path / "m"))
        assert len(clip) == len(frame_times(0.48, fps))
        assert 0 <= clip.values.min() <= clip.values.max() <= 1

    def test_other_rates_agree_where_frames_meet(self, tmp_path: Path) -> None:
        network = random_network(tmp_path / "m", "windows", KINDS, 5, 3, 25)
        coarse, fine = (animate(track("sil M AA S sil"), fps, model=network) for fps in (25, 100))
        np.testing.assert_allclose(fine.values[::4], coarse.values, atol=1e-6)

    @pytest.mark.parametrize("kind", ["windows", "sequence"])
    def test_chunks_give_what_the_whole_gives(
        self, kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        kinds = KINDS if kind == "windows" else ("raw", "transitions", "timing")
        network = random_network(tmp_path / "m", kind, kinds, 7, 5 if kind == "windows" else 1, 50)
        said = track("sil M AA S IH M OY HH sil", 0.17)
        whole = animate(said, 60, model=network)
        monkeypatch.setattr(window, "CHUNK_FRAMES", 8)
        np.testing.assert_allclose(animate(said, 60, model=network).values, whole.values, atol=1e-6)

    def test_a_sequence_gives_what_the_same_windows_give(self, tmp_path: Path) -> None:
        said = track("AA M IH sil S AA")
        one = animate(said, 60, model=middle_frame(tmp_path / "windows"))
        other = animate(said, 60, model=middle_frame_sequence(tmp_path / "sequence"))
        assert one.values.tobytes() == other.values.tobytes()

    def test_a_sequence_of_random_weights_pads_as_windows_do(self, tmp_path: Path) -> None:
        rng = np.random.default_rng(2)
        features = FeatureSet(("raw", "timing"), 5, 25, PHONES)
        kernel = rng.normal(0, 0.2, (2, features.frame_size, 5))
        flat = kernel.transpose(2, 1, 0).reshape(-1, 2)  # window frame by frame, then control
        graph = windows_graph(flat, np.zeros((1, 2)))
        one = write_model(tmp_path / "w", graph, features, CONTROLS)
        other = write_model(
            tmp_path / "s", sequence_graph(kernel), features, CONTROLS, kind="sequence"
        )
        clips = [animate(track("AA M IH sil S"), 25, model=model) for model in (one, other)]
        np.testing.assert_allclose(clips[0].values, clips[1].values, atol=1e-5)

    def test_the_same_track_gives_the_same_bytes(self, tmp_path: Path) -> None:
        folder = tmp_path / "m"
        random_network(folder, "windows", KINDS, 11, 5, 25)
        said = track("sil M AA S IH sil")
        clips = [animate(said, 60, model=load_network(folder)) for _ in range(2)]
        assert clips[0].values.tobytes() == clips[1].values.tobytes()

    def test_a_model_is_loaded_once_and_anew_when_it_changes(self, tmp_path: Path) -> None:
        folder = middle_frame(tmp_path / "m")
        network = open_network(folder)
        assert open_network(folder) is network
        change_meta(folder, name="another")
        assert open_network(folder).meta.name == "another"
        (folder / "model.onnx").write_bytes(b"")
        with pytest.raises(LipwrightError, match="cut off"):
            open_network(folder)


class TestSound:
    """Of networks that hear: planted weights on the columns of the sound."""

    @pytest.fixture
    def network(self, tmp_path: Path) -> Network:
        features = FeatureSet(("raw", "sound"), 3, 25, PHONES)
        weights = np.zeros((features.size, 2))
        weights[features.names.index("sound at frame 1"), 0] = 1
        weights[features.names.index("level at frame 1"), 1] = 1
        graph = windows_graph(weights, np.zeros((1, 2)))
        write_model(tmp_path / "m", graph, features, CONTROLS)
        return load_network(tmp_path / "m")

    def test_it_is_heard_where_there_is_any(self, network: Network) -> None:
        said = track("sil M AA S sil", 0.5)
        heard = animate(said, 25, read_audio(HELLO, 16000), network)
        assert (heard.curve("jawOpen") == 1).all()
        assert np.ptp(heard.curve("mouthClose")) > 1  # silence and speech

    def test_without_it_phones_must_do(self, network: Network) -> None:
        assert not animate(track("sil M AA S sil"), 25, None, network).values.any()

    def test_networks_that_hear_nothing_are_not_disturbed(self, tmp_path: Path) -> None:
        model, said = middle_frame(tmp_path / "m"), track("sil M AA sil")
        loud = Audio(np.ones(16000, np.float32), 16000)
        assert animate(said, 25, loud, model).values.tobytes() == (
            animate(said, 25, None, model).values.tobytes()
        )

    def test_a_stream_hears_as_the_whole_does(self, network: Network) -> None:
        said, audio = track("sil M AA S sil", 0.5), read_audio(HELLO, 16000)
        rows = sound_features(audio, frame_times(said.end, 25))
        stream, parts = Stream(network, 60, sound=True), []
        for index, phone in enumerate(said):
            stream.push(*phone)
            stream.hear(rows[index * 13 : (index + 1) * 13])
            parts.append(stream.frames())
        found = np.concatenate([*parts, stream.finish()])
        np.testing.assert_allclose(found, animate(said, 60, audio, network).values, atol=1e-5)

    def test_a_stream_that_lacks_sound_cannot_finish(self, network: Network) -> None:
        stream = Stream(network, 60, sound=True)
        stream.push("AA", 0, 1)
        with pytest.raises(ValueError, match="sound features of 0 frames, not 26"):
            stream.finish()


@st.composite
def tracks(draw: st.DrawFn) -> PhoneTrack:
    """Random phones of the whole table, from shorter than a frame to longer than a window."""
    phones = draw(st.lists(st.sampled_from(list(TABLE)), min_size=1, max_size=14))
    lengths = st.sampled_from([0.004, 0.02, 0.04, 0.0777, 0.13, 0.3, 1.1])
    durations = [draw(lengths) for _ in phones]
    start = draw(st.sampled_from([0.0, 0.04, 0.333]))
    return PhoneTrack(tuple(phones), start + np.cumsum([0.0, *durations]))


NETWORKS = {
    "identity": ("windows", ("raw",), 1, 1, 25.0),
    "window": ("windows", KINDS, 11, 5, 25.0),
    "thesis": ("windows", ("raw",), 5, 15, 30.0),
    "linguistic": ("windows", ("raw", "spans", "attributes", "transitions"), 7, 3, 25.0),
    "sequence": ("sequence", ("raw", "attributes", "transitions", "timing"), 9, 1, 50.0),
}


@pytest.fixture(scope="module")
def networks(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Network]:
    place = tmp_path_factory.mktemp("networks")
    return {name: random_network(place / name, *options) for name, options in NETWORKS.items()}


class TestStream:
    @pytest.mark.parametrize("name", NETWORKS)
    @given(said=tracks(), fps=st.sampled_from([10.0, 25.0, 30.0, 60.0]), often=st.booleans())
    @settings(deadline=None, max_examples=40)
    def test_it_gives_what_the_whole_gives_as_early_as_it_says(
        self, name: str, networks: dict[str, Network], said: PhoneTrack, fps: float, often: bool
    ) -> None:
        network = networks[name]
        whole = animate(said, fps, model=network)
        stream = Stream(network, fps)
        given_, slack = [np.zeros((0, len(CANONICAL)), np.float32)], 1 / fps + 2 / 25
        for index, (phone, start, end) in enumerate(said):
            stream.push(phone, start, end)
            if often or index % 3 == 2:
                given_.append(stream.frames())
                whole_phones = start if phone in ("HH", "HV", "Q") else end
                sure = whole_phones - stream.look_ahead - slack
                assert sum(map(len, given_)) >= sure * fps
        given_.append(stream.finish())
        found = np.concatenate(given_)
        assert stream.names == whole.names
        assert found.shape == whole.values.shape
        assert np.abs(found - whole.values).max() <= 1e-5

    @pytest.mark.parametrize("name", NETWORKS)
    def test_it_forgets_what_it_no_longer_needs(
        self, name: str, networks: dict[str, Network]
    ) -> None:
        stream = Stream(networks[name], 60)
        for index in range(200):
            stream.push("AA" if index % 2 else "M", index * 0.1, index * 0.1 + 0.1)
            stream.frames()
        assert len(stream._phones) < 30  # those of about two seconds

    def test_nothing_is_given_before_it_is_sure(self, networks: dict[str, Network]) -> None:
        stream = Stream(networks["identity"], 25)
        stream.push("sil", 0, 1)
        assert len(stream.frames()) == 25
        stream.push("HH", 1, 2)
        assert len(stream.frames()) == 0  # it takes the mouth of the vowel to come
        stream.push("AA", 2, 3)
        assert len(stream.frames()) == 50
        assert len(stream.frames()) == 0
        assert len(stream.finish()) == 1

    def test_the_look_ahead_is_that_of_windows_features_and_rates(
        self, networks: dict[str, Network]
    ) -> None:
        ahead = {name: Stream(network, 25).look_ahead for name, network in networks.items()}
        assert ahead["identity"] == 0
        assert ahead["window"] == pytest.approx((5 + 2) / 25 + 0.5)  # timing sees half a second
        assert ahead["thesis"] == pytest.approx((2 + 7) / 30 + 2 / 30)  # and two for 25 of 30
        assert ahead["linguistic"] == pytest.approx((3 + 1) / 25 + 1 / 25)  # the next phone
        assert ahead["sequence"] == pytest.approx(4 / 50 + 0.5 + 2 / 50)

    @pytest.mark.parametrize(
        ("phone", "start", "end", "needle"),
        [
            ("XX", 1, 2, "phone table"),
            ("AA", 1.5, 2, "but the one before ends at 1"),
            ("AA", 0.5, 2, "but the one before ends at 1"),
            ("AA", 1, 1, "lasts from"),
            ("AA", 1, float("nan"), "lasts from"),
            ("AA", 1, float("inf"), "lasts from"),
            ("AA", -1, 2, "lasts from"),
        ],
    )
    def test_phones_that_do_not_follow_are_refused(
        self, phone: str, start: float, end: float, needle: str, networks: dict[str, Network]
    ) -> None:
        stream = Stream(networks["identity"], 60)
        stream.push("sil", 0, 1)
        with pytest.raises(ValueError, match=needle):
            stream.push(phone, start, end)
        stream.push("AA", 1, 2)  # it is as it was

    def test_after_the_end_nothing_follows(self, networks: dict[str, Network]) -> None:
        stream = Stream(networks["identity"], 60)
        assert len(stream.frames()) == 0
        with pytest.raises(ValueError, match="no phones"):
            stream.finish()
        stream.push("sil", 0, 1)
        stream.finish()
        assert len(stream.frames()) == 0
        for late in (stream.finish, lambda: stream.push("AA", 1, 2)):
            with pytest.raises(ValueError, match="finished"):
                late()

    def test_sound_is_for_networks_that_hear(self, networks: dict[str, Network]) -> None:
        with pytest.raises(ValueError, match="hears no sound"):
            Stream(networks["identity"], 60, sound=True)
        with pytest.raises(ValueError, match="no sound"):
            Stream(networks["identity"], 60).hear(np.zeros((1, 3)))
        with pytest.raises(ValueError, match="fps"):
            Stream(networks["identity"], 0)


class TestChoosing:
    def test_a_model_means_the_engine_that_runs_it(self, tmp_path: Path) -> None:
        model, said = middle_frame(tmp_path / "m"), track("sil M AA sil")
        one, other = (get_engine(name, model)(said, 25.0) for name in (None, "window"))
        assert one.values.tobytes() == other.values.tobytes()
        assert one.curve("mouthClose").max() == 1

    def test_engines_that_run_no_model_refuse_one(self) -> None:
        with pytest.raises(
            LipwrightError,
            match="window, hmm, dynamic, lstm, trees and bigram, not for dominance",
        ):
            AnimateOptions(engine="dominance", model="anna")

    def test_the_controls_of_an_engine_are_known_before_the_work(self, tmp_path: Path) -> None:
        assert engine_controls("dominance") == CANONICAL
        model = middle_frame(tmp_path / "m")
        assert engine_controls(None, model) == CANONICAL
        change_meta(model, target="joint", controls=["joint1", "joint2"])
        assert AnimateOptions(model=model).controls() == ("joint1", "joint2")

    def test_a_default_model_that_does_not_ship_is_named(self) -> None:
        from lipwright.network import shipped_models

        if DEFAULT_MODEL in shipped_models():
            assert engine_controls("window") == CANONICAL
        else:
            with pytest.raises(LipwrightError, match=f"no model '{DEFAULT_MODEL}'"):
                engine_controls("window")

    def test_passes_close_the_lips_that_a_network_leaves_open(self, tmp_path: Path) -> None:
        graph = windows_graph(np.zeros((FEATURES.size, 1)), np.array([[1.5]]))
        model = write_model(tmp_path / "m", graph, FEATURES, ("jawOpen",))
        said = track("sil AA P AA sil", 0.3)
        assert (animate(said, 60, model=model).curve("jawOpen") == 1.5).all()
        clip = animate_track(said, AnimateOptions(model=model))
        assert clip.names == CANONICAL
        jaw = clip.curve("jawOpen")
        assert jaw[30] == 1  # of AA, within its range
        assert jaw[np.abs(clip.times - 0.65) < 0.1].min() < 0.1  # of P
        assert jaw[0] == 0

    def test_modes_of_a_reference_face_are_left_as_they_are(self, tmp_path: Path) -> None:
        graph = windows_graph(np.zeros((FEATURES.size, 2)), np.array([[2.5, -1.5]]))
        names = ("shape1", "shape2")
        model = write_model(tmp_path / "m", graph, FEATURES, names, target="shape")
        clip = animate_track(track("sil P sil"), AnimateOptions(model=model, fps=25))
        assert clip.names == names
        assert clip.values.tolist() == [[2.5, -1.5]] * 10


def lipwright(*arguments: object, cwd: Path) -> tuple[int, str]:
    """Status and standard error of a command."""
    errors = io.StringIO()
    with contextlib.chdir(cwd), contextlib.redirect_stderr(errors):
        return run(list(map(str, arguments))), errors.getvalue()


class TestCommands:
    @pytest.fixture
    def place(self, tmp_path: Path) -> Path:
        """A folder with a model, and the phones of hello.flac, made by hand."""
        middle_frame(tmp_path / "anna")
        edges = [0.0, 0.6, 0.7, 0.75, 0.84, 1.0, read_audio(HELLO).duration]
        said = PhoneTrack(("sil", "HH", "AA", "M", "OW", "sil"), np.array(edges))
        write_track(tmp_path / "hello.TextGrid", said)
        return tmp_path

    def animate(self, place: Path, *arguments: object) -> tuple[int, str]:
        return lipwright("animate", HELLO, "--phones", "hello.TextGrid", *arguments, cwd=place)

    def test_animate_runs_a_model_and_does_it_again_to_the_byte(self, place: Path) -> None:
        for name in ("a.csv", "b.csv"):
            status, errors = self.animate(place, "--model", "anna", "-o", name)
            assert (status, errors) == (0, f"{name}: 9.3 s, 6 phones, 0 words\n")
        assert (place / "a.csv").read_bytes() == (place / "b.csv").read_bytes()
        clip = read_clip(place / "a.csv")
        assert clip.names == CANONICAL
        assert clip.curve("jawOpen")[clip.times < 0.5].max() == 0
        assert clip.curve("jawOpen")[(clip.times > 0.6) & (clip.times < 0.75)].max() > 0.5

    @pytest.mark.parametrize(
        ("arguments", "needle"),
        [
            (["--model", "bert"], "no model 'bert': no such folder"),
            (["--model", "hello.TextGrid"], "a model is a folder"),
            (
                ["--engine", "dominance", "--model", "anna"],
                "--model is for the engines window, hmm, dynamic, lstm, trees and bigram",
            ),
            (["--engine", "magic"], "no engine 'magic'; the engines are: dominance, window"),
        ],
    )
    def test_what_cannot_be_run_is_refused_in_one_line(
        self, arguments: list[str], needle: str, place: Path
    ) -> None:
        status, errors = self.animate(place, *arguments, "-o", "a.csv")
        assert status == 2
        assert errors.startswith("lipwright: ")
        assert errors.count("\n") == 1
        assert needle in errors
        assert not (place / "a.csv").exists()

    def test_a_damaged_model_is_refused_before_the_recording_is_read(self, place: Path) -> None:
        (place / "anna" / "model.onnx").write_bytes(b"")
        status, errors = lipwright(
            "animate", "missing.wav", "--text", "hi", "--model", "anna", "-o", "a.csv", cwd=place
        )
        assert status == 2
        assert "model.onnx" in errors

    @pytest.mark.parametrize("name", ["a.mp4", "a.glb", "a.livelink.csv"])
    def test_modes_of_a_reference_face_are_not_put_on_a_head(self, name: str, place: Path) -> None:
        change_meta(place / "anna", target="joint", controls=["joint1", "joint2"])
        status, errors = self.animate(place, "--model", "anna", "-o", "b.csv", "-o", name)
        assert status == 2
        assert errors.count("\n") == 1
        assert errors.startswith(f"lipwright: {name}: anna predicts modes of a reference face")
        assert "lipwright train" in errors
        assert not (place / "b.csv").exists()

    def test_modes_of_a_reference_face_are_written_to_tables(self, place: Path) -> None:
        change_meta(place / "anna", target="joint", controls=["joint1", "joint2"])
        status, errors = self.animate(
            place, "--model", "anna", "--fps", "25", "-o", "a.csv", "-o", "a.json"
        )
        assert status == 0, errors
        for name in ("a.csv", "a.json"):
            clip = read_clip(place / name)
            assert clip.names == ("joint1", "joint2")
            assert clip.fps == 25
            assert clip.values[20].tolist() == [1, 0]  # M, at 0.8 s, with no pass over it

    def test_models_are_described_and_checked(
        self, place: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        folder = str(place / "anna")
        change_meta(place / "anna", licence="CC0\x1b[2J\ud800", metrics={"test": {"r": 0.8125}})
        models.main(["info", folder], standalone_mode=False)
        shown = capsys.readouterr().out
        assert "predicts: ARKit weights, 2 controls\n" in shown
        assert "sees: raw; 3 frames at 25 a second\n" in shown
        assert "test, r: 0.8125\n" in shown
        assert "\x1b" not in shown
        models.main(["info", folder, "--json"], standalone_mode=False)
        assert json.loads(capsys.readouterr().out)["controls"] == ["mouthClose", "jawOpen"]
        models.main(["check", folder], standalone_mode=False)
        assert "gives its golden output" in capsys.readouterr().err
        (place / "anna" / "golden.npz").unlink()
        with pytest.raises(LipwrightError, match="is missing"):
            models.main(["check", folder], standalone_mode=False)

    def test_the_models_that_ship_are_listed(self, capsys: pytest.CaptureFixture[str]) -> None:
        from lipwright.network import shipped_models

        models.main(["list", "--json"], standalone_mode=False)
        assert list(json.loads(capsys.readouterr().out)) == list(shipped_models())
        models.main(["list"], standalone_mode=False)
        assert capsys.readouterr().out.count("\n") == max(len(shipped_models()), 1)
