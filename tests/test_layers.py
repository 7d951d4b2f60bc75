"""Layers over speech: intensity by name, and expressions; neither opens a closure."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping
from importlib.resources import files
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lipwright.audio import AudioFile, open_audio
from lipwright.clip import Clip, frame_times
from lipwright.controls import CANONICAL, GROUPS, HEAD_ANGLES
from lipwright.engines import engine_learnt, get_engine
from lipwright.engines.dominance import animate as by_rules
from lipwright.errors import LipwrightError
from lipwright.evaluate.lips import CLOSED, CLOSURE_TOLERANCE, LOUD_PERCENTILE
from lipwright.export import export_clip
from lipwright.expressions import ABOUT, EXPRESSIONS, POSE, load_expression, parse_expression
from lipwright.face.head import Head
from lipwright.passes import (
    CLASSES,
    apply_passes,
    bigram_passes,
    closures_kept,
    default_passes,
    expression,
    finishing_passes,
    intensities,
    intensity,
    learnt_passes,
    limit,
    parse_intensities,
    pose_clip,
    speech_share,
)
from lipwright.passes.expression import CORNERS, MOUTH
from lipwright.passes.intensities import EDGE, PHONE_CLASSES, controls_of, phone_amounts
from lipwright.passes.openings import OPENINGS, gaps, lips_held
from lipwright.phones import BILABIALS, COMMON, MANNERS, PHONES, PLACES
from lipwright.pipeline import AnimateOptions, align_sound, rig_of
from lipwright.rig import canonical_rig
from lipwright.track import PhoneTrack

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / "bench"))

from lip_openings import DECIMALS, openings  # noqa: E402  # after its folder is known

HELLO = ROOT / "examples" / "hello.flac"
ENGINES = ("dominance", "window", "bigram")
quick = settings(deadline=None, max_examples=25)
Floats = npt.NDArray[np.float64]

# "Pam, if May moved": closures at the beginning, at the end of a phrase and side by side.
TRACK = PhoneTrack(
    ("sil", "P", "AE", "M", "sil", "IH", "F", "M", "EY", "M", "UW", "V", "D", "sil"),
    np.cumsum([0, 1.2, 0.08, 0.15, 0.1, 0.5, 0.09, 0.1, 0.08, 0.18, 0.07, 0.14, 0.08, 0.07, 1.5]),
)
SPEECH = apply_passes(by_rules(TRACK, 60.0), TRACK, default_passes())
weights = st.dictionaries(st.sampled_from(CANONICAL), st.floats(0, 1), max_size=len(CANONICAL))


@pytest.fixture(scope="module")
def sound() -> Iterator[AudioFile]:
    with open_audio(HELLO, 16000) as opened:
        yield opened


@pytest.fixture(scope="module")
def spoken(sound: AudioFile) -> PhoneTrack:
    return align_sound(sound, HELLO.with_suffix(".txt").read_text()).track


@pytest.fixture(scope="module")
def raw(sound: AudioFile, spoken: PhoneTrack) -> dict[str, Clip]:
    """What each engine says before its passes."""
    clips = {name: get_engine(name)(spoken, 60.0, sound) for name in ENGINES if name != "bigram"}
    bigrams = AnimateOptions(engine="bigram").bigram_set
    assert bigrams is not None
    stitched = get_engine("bigram", bigrams)(spoken, 60.0)
    stitched = apply_passes(stitched, spoken, bigram_passes(bigrams))
    return clips | {"bigram": rig_of(bigrams).to_canonical(stitched)}


def said(
    raw: Mapping[str, Clip], engine: str, track: PhoneTrack, amount: float = 1.0,
    amounts: Mapping[str, float] | None = None,
) -> Clip:  # fmt: skip
    """What an engine says, after the passes that are its own, in canonical controls."""
    amounts = amounts or {}
    if engine == "bigram":
        passes = finishing_passes(amount, amounts)
    elif (learnt := engine_learnt(engine))[0]:
        passes = learnt_passes(amount, *learnt, amounts)
    else:
        passes = default_passes(amount, amounts)
    return canonical_rig().fit(apply_passes(raw[engine], track, passes))


def closures(head: Head, clip: Clip, track: PhoneTrack) -> tuple[int, int]:
    """How many p b m are closed as evaluation judges them, and how many there are."""
    aperture = head.aperture_curve(clip.select(CANONICAL).values)
    most = CLOSED * np.percentile(aperture, LOUD_PERCENTILE)
    spans = [(start, end) for phone, start, end in track if phone in BILABIALS]
    near = [
        (clip.times >= start - CLOSURE_TOLERANCE) & (clip.times <= end + CLOSURE_TOLERANCE)
        for start, end in spans
    ]
    return sum(bool(aperture[frames].min() < most) for frames in near), len(near)


# --- intensity by name ---


def test_every_class_holds_a_phone_and_none_is_a_control() -> None:
    assert set(CLASSES) == {"vowels", "consonants", "rounded", *PLACES, *MANNERS, *COMMON}
    for name in CLASSES:
        assert any(name in kinds for kinds in PHONE_CLASSES.values()), f"no phone is {name}"
        assert not controls_of(name)


def test_all_of_jaw_and_lips_by_name_is_the_intensity() -> None:
    for amount in (0.0, 0.5, 1.3, 3.0):
        by_name = intensities({"jaw": amount, "lips": amount})(SPEECH, TRACK)
        assert np.allclose(by_name.values, intensity(amount)(SPEECH, TRACK).values, atol=1e-6)


def test_amounts_of_one_change_nothing() -> None:
    same = intensities(dict.fromkeys(("jaw", "vowels", "bmp", "eyeBlink"), 1.0))(SPEECH, TRACK)
    assert (same.values == SPEECH.values).all()
    assert intensities({})(SPEECH, TRACK) is SPEECH


@pytest.mark.parametrize(
    ("name", "moved"),
    [
        ("tongue", GROUPS["tongue"]),
        ("mouthPucker", ("mouthPucker",)),
        ("mouthLowerDown", ("mouthLowerDownLeft", "mouthLowerDownRight")),
        ("mouthLowerDownLeft", ("mouthLowerDownLeft",)),
    ],
)
def test_a_name_scales_its_controls_only(name: str, moved: tuple[str, ...]) -> None:
    scaled = intensities({name: 0.5})(SPEECH, TRACK)
    for control in CANONICAL:
        share = 0.5 if control in moved else 1.0
        assert np.allclose(scaled.curve(control), share * SPEECH.curve(control), atol=1e-6)


def test_amounts_of_several_names_multiply_up_to_three() -> None:
    rest = Clip(("jawOpen",), 60, np.full((len(SPEECH), 1), 0.1, np.float32))
    both = intensities({"jaw": 1.5, "jawOpen": 0.5})(rest, TRACK)
    assert np.allclose(both.values, 0.075)
    most = intensities({"jaw": 3, "vowels": 3, "jawOpen": 3})(rest, TRACK)
    assert np.allclose(most.values.max(), 0.3)


def test_a_class_counts_while_its_phones_sound() -> None:
    amount = phone_amounts(TRACK, SPEECH.times, {"vowels": 2.0, "bilabial": 0.5})
    for phone, start, end in TRACK:
        inside = (SPEECH.times > start + EDGE) & (SPEECH.times < end - EDGE)
        middle = np.abs(SPEECH.times - (start + end) / 2) < 1e-9
        expected = 2.0 if PHONES[phone].is_vowel else 0.5 if phone in BILABIALS else 1.0
        assert (amount[inside | middle] == expected).all(), phone


@quick
@given(
    st.lists(st.sampled_from(["AA", "M", "S", "UW", "sil", "F"]), min_size=1, max_size=12),
    st.randoms(use_true_random=False),
    st.sampled_from(["vowels", "bilabial", "rounded", "fricative"]),
)
def test_amounts_change_without_steps(phones: list[str], random, name: str) -> None:  # type: ignore[no-untyped-def]
    lengths = [random.uniform(0.03, 0.4) for _ in phones]
    track = PhoneTrack(tuple(phones), np.cumsum([0.0, *lengths]))
    amount = phone_amounts(track, frame_times(track.end, 1000.0), {name: 2.0})
    # From 1 to 2 in a short phone of 30 ms: the easing's steepest slope is under 2.5 times that.
    assert np.abs(np.diff(amount)).max(initial=0) <= 2.5 / 30
    assert 1 <= amount.min() <= amount.max() <= 2


@pytest.mark.parametrize("engine", ENGINES)
def test_lips_close_at_any_intensity(
    engine: str, head: Head, raw: dict[str, Clip], spoken: PhoneTrack
) -> None:
    choices: list[tuple[float, dict[str, float]]] = [
        (0.5, {}), (1.5, {}), (1.0, {"jaw": 1.5}), (1.0, {"lips": 0.5}),
        (1.2, {"vowels": 1.5, "bilabial": 1.5}), (1.5, {"mouthClose": 0.0, "bmp": 3.0}),
    ]  # fmt: skip
    for amount, amounts in choices:
        clip = said(raw, engine, spoken, amount, amounts)
        shut, all_of_them = closures(head, clip, spoken)
        assert shut == all_of_them > 0, (amount, amounts)


@pytest.mark.parametrize("engine", ENGINES)
def test_vowels_grow_by_their_intensity(
    engine: str, head: Head, raw: dict[str, Clip], spoken: PhoneTrack
) -> None:
    def loud(amounts: dict[str, float]) -> float:
        clip = said(raw, engine, spoken, 1.0, amounts)
        return float(np.percentile(head.aperture_curve(clip.values), LOUD_PERCENTILE))

    assert loud({"vowels": 1.4}) > 1.2 * loud({}) > 1.2 * loud({"vowels": 0.7})


def test_a_guarded_pass_opens_no_closure_and_scales_the_rest(head: Head) -> None:
    held = lips_held(SPEECH, TRACK) == 1
    free = intensities({"jaw": 2.0})(SPEECH, TRACK)
    kept = closures_kept(intensities({"jaw": 2.0}))(SPEECH, TRACK)
    before = head.aperture_curve(SPEECH.values)
    assert (head.aperture_curve(free.values)[held] > before[held] + 0.05).any()
    assert (head.aperture_curve(kept.values)[held] <= before[held] + 1e-3).all()
    loose = lips_held(SPEECH, TRACK) == 0
    assert (kept.values[loose] == free.values[loose]).all()


def test_unknown_names_and_wrong_amounts_are_told_in_one_line() -> None:
    with pytest.raises(LipwrightError, match=r"'jowl'.*jaw.*vowels.*bilabial.*bmp") as error:
        intensities({"jowl": 1.0})
    assert "\n" not in str(error.value)
    for wrong in ("mouth", "", "headYaw"):  # mouthLeft and mouthRight are no sides of one control
        with pytest.raises(LipwrightError, match="has an intensity"):
            intensities({wrong: 1.0})
    for amount in (-0.1, 3.1, float("nan")):
        with pytest.raises(LipwrightError, match=r"vowels is .* from 0 to 3"):
            intensities({"vowels": amount})


def test_intensities_are_read_from_options() -> None:
    assert parse_intensities([]) == (1.0, {})
    found = parse_intensities(["1.2", "jaw=0.8", "vowels=1.3", "jaw=0.9"])
    assert found == (1.2, {"jaw": 0.9, "vowels": 1.3})
    for text, match in [
        ("loud", "neither an amount"), ("jaw=loud", "neither an amount"), ("=1", "has an intens"),
        ("4", "from 0 to 3"), ("nan", "from 0 to 3"), ("jaw=4", "jaw is 4"), ("a=b=1", "'a=b'"),
    ]:  # fmt: skip
        with pytest.raises(LipwrightError, match=match):
            parse_intensities([text])


# --- expressions ---


def test_the_table_of_openings_is_that_of_the_head(head: Head) -> None:
    assert dict(OPENINGS) == openings(head)
    mean = np.array([np.mean(OPENINGS.get(name, (0, 0, 0))) for name in CANONICAL])
    assert np.allclose(mean, head.opening, atol=10**-DECIMALS)
    assert set(CORNERS) | set(MOUTH) < set(CANONICAL)
    opens = {name for name, row in OPENINGS.items() if max(row) > 0.01}
    assert opens <= MOUTH, "what opens the lips gives way to speech"


@quick
@given(weights, st.floats(0, 2))
def test_no_expression_opens_a_closure(head: Head, pose: dict[str, float], amount: float) -> None:
    before = head.aperture_curve(SPEECH.values)
    after = head.aperture_curve(expression(pose, amount)(SPEECH, TRACK).values)
    held = lips_held(SPEECH, TRACK) == 1
    assert (after[held] <= before[held] + 1e-3).all()
    most = CLOSED * np.percentile(before, LOUD_PERCENTILE)
    spoken = speech_share(TRACK, SPEECH.times) == 1
    shut = spoken & (before < most)
    assert shut.sum() > 10
    assert (after[shut] <= most + 1e-3).all()


@pytest.mark.parametrize("engine", ENGINES)
def test_closures_of_every_engine_stay_under_every_expression(
    engine: str, head: Head, raw: dict[str, Clip], spoken: PhoneTrack
) -> None:
    clip = said(raw, engine, spoken)
    before = head.aperture_curve(clip.values)
    inside = speech_share(spoken, clip.times) == 1
    for name in EXPRESSIONS:
        after = expression(load_expression(name))(clip, spoken)
        shut, all_of_them = closures(head, after, spoken)
        assert shut == all_of_them > 0, name
        aperture = head.aperture_curve(after.values)
        r = np.corrcoef(aperture[inside], before[inside])[0, 1]
        assert r > 0.85, f"{name} leaves too little of the speech: {r:.3f}"


@quick
@given(weights)
def test_no_amount_is_no_change(pose: dict[str, float]) -> None:
    assert expression(pose, 0.0)(SPEECH, TRACK) is SPEECH
    nothing = expression(dict.fromkeys(pose, 0.0))(SPEECH, TRACK)
    assert (nothing.select(SPEECH.names).values == SPEECH.values).all()


@quick
@given(weights)
def test_an_expression_shows_in_full_where_nothing_is_said(pose: dict[str, float]) -> None:
    shown = expression(pose)(SPEECH, TRACK)
    rest = np.flatnonzero(SPEECH.values.max(axis=1) == 0)
    rest = rest[(SPEECH.times[rest] < 0.6) | (SPEECH.times[rest] > TRACK.end - 0.6)]
    assert len(rest) > 20
    whole = pose_clip(pose).select(CANONICAL).values[0] if pose else np.zeros(len(CANONICAL))
    assert np.allclose(shown.values[rest], whole, atol=1e-6)


@quick
@given(weights)
def test_the_upper_face_shows_all_along_and_nothing_leaves_its_range(
    pose: dict[str, float],
) -> None:
    shown = expression(pose)(SPEECH, TRACK)
    for name in GROUPS["eyes"] + GROUPS["brows"]:
        assert np.allclose(shown.curve(name), pose.get(name, 0.0), atol=1e-6)
    assert shown.values.min() >= 0
    assert shown.values.max() <= 1 + 1e-6


def test_the_lip_stays_on_the_teeth() -> None:
    pose = dict.fromkeys((*MOUTH, "mouthSmileLeft", "mouthSmileRight"), 0.7)
    shown = expression(pose)(SPEECH, TRACK)
    lips = [n for n in MOUTH if n not in ("jawOpen", "mouthClose")]  # which give back the smile's
    for phone, start, end in TRACK:
        if phone in ("F", "V"):
            inside = (SPEECH.times >= start) & (SPEECH.times <= end)
            assert (shown.select(lips).values[inside] == SPEECH.select(lips).values[inside]).all()
            more = gaps(shown)[inside] - gaps(SPEECH)[inside]
            assert (more <= 1e-3).all()
            assert (more >= -0.02).all(), "a fiftieth of the eyes' distance at most"


def test_what_a_smile_takes_of_the_aperture_the_jaw_gives_back(head: Head) -> None:
    before = head.aperture_curve(SPEECH.values)
    smile = {"mouthSmile": 0.6, "cheekSquint": 0.5}
    after = head.aperture_curve(expression(smile)(SPEECH, TRACK).values)
    inside = speech_share(TRACK, SPEECH.times) == 1
    assert np.corrcoef(before[inside], after[inside])[0, 1] > 0.999


def test_an_open_mouth_fades_without_steps() -> None:
    shown = expression({"jawOpen": 0.4, "mouthFunnel": 0.5})(SPEECH, TRACK)
    added = np.abs(np.diff(shown.values - SPEECH.values, axis=0)).max() * SPEECH.fps
    assert added < 10, "full ranges a second; speech itself is allowed 15"


def test_a_moving_expression_holds_its_last_frame_and_turns_the_head() -> None:
    names = ("browInnerUp", "headYaw")
    moving = Clip(names, 10, np.array([[0, 0], [0.5, 0.1], [1, -0.2]], np.float32))
    turned = SPEECH.select((*CANONICAL, "headYaw")).with_curves(
        {"headYaw": np.full(len(SPEECH), 0.3)}
    )
    shown = expression(moving, 0.5)(turned, TRACK)
    assert shown.curve("browInnerUp")[[0, 6, 12, 13, -1]] == pytest.approx(
        [0, 0.25, 0.5, 0.5, 0.5], abs=1e-6
    )
    assert shown.curve("headYaw")[[0, 6, -1]] == pytest.approx([0.3, 0.35, 0.2], abs=1e-6)
    assert set(expression(moving)(SPEECH, TRACK).names) == {*CANONICAL, "headYaw"}


def test_a_sideless_weight_is_that_of_both_sides() -> None:
    clip = pose_clip({"mouthSmile": 0.5, "mouthSmileLeft": 0.25, "jawOpen": 0.125})
    assert dict(zip(clip.names, clip.values[0].tolist(), strict=True)) == {
        "mouthSmileLeft": 0.25, "mouthSmileRight": 0.5, "jawOpen": 0.125,
    }  # fmt: skip


def test_wrong_expressions_are_refused() -> None:
    for pose in ({"smile": 0.5}, {"mouth": 0.5}, {"mode 1": 0.5}):
        with pytest.raises(LipwrightError, match="is no canonical control"):
            expression(pose)
    for weight in (-0.1, 1.1, float("nan")):
        with pytest.raises(LipwrightError, match="from 0 to 1"):
            expression({"jawOpen": weight})
    for amount in (-0.1, 2.1, float("nan")):
        with pytest.raises(LipwrightError, match="from 0 to 2"):
            expression({"jawOpen": 0.5}, amount)
    modes = Clip(("mode 1",), 60, np.zeros((9, 1), np.float32))
    with pytest.raises(LipwrightError, match="before retargeting"):
        expression({"jawOpen": 0.5})(modes, TRACK)


# --- expressions in files ---


def test_the_shipped_expressions_are_the_files_and_say_their_source() -> None:
    folder = files("lipwright").joinpath("expressions")
    shipped = {entry.name for entry in folder.iterdir() if entry.name.endswith(".json")}
    assert shipped == {f"{name}.json" for name in EXPRESSIONS}
    for name in EXPRESSIONS:
        data = json.loads(folder.joinpath(f"{name}.json").read_text("utf-8"))
        assert data["name"] == name
        assert data["source"]
        assert set(data) <= {POSE, *ABOUT}
        clip = load_expression(name)
        assert len(clip) == 1
        assert set(clip.names) < set(CANONICAL)
        assert not set(clip.names) & set(GROUPS["tongue"])


def test_poses_and_clips_are_read_from_files(tmp_path: Path) -> None:
    path = tmp_path / "smirk.json"
    path.write_text('{"mouthSmileLeft": 0.5}')
    assert load_expression(path).names == ("mouthSmileLeft",)
    path.write_text('{"source": "me", "pose": {"mouthSmile": 0.5}}')
    assert load_expression(str(path)).names == ("mouthSmileLeft", "mouthSmileRight")
    moving = Clip(("browInnerUp", *HEAD_ANGLES), 10, np.eye(4, dtype=np.float32))
    for suffix in (".json", ".csv"):
        export_clip(tmp_path / f"wave{suffix}", moving)
        found = load_expression(tmp_path / f"wave{suffix}")
        assert found.names == moving.names
        assert np.allclose(found.values, moving.values)


def test_expressions_are_read_from_options(tmp_path: Path) -> None:
    assert parse_expression("happy")[1] == 1.0
    clip, amount = parse_expression("happy=0.5")
    assert amount == 0.5
    assert (clip.values == load_expression("happy").values).all()
    path = tmp_path / "a=b.json"
    path.write_text('{"jawOpen": 0.5}')
    assert parse_expression(str(path))[1] == 1.0
    assert parse_expression(f"{path}=0.25")[1] == 0.25


@pytest.mark.parametrize(
    ("content", "match"),
    [
        ("{", r":1:2: .*a pose is a JSON file"),
        ("[1]", "no object of controls and weights"),
        ("{}", "has no weights"),
        ('{"pose": 1}', "has no weights"),
        ('{"smile": 1}', "'smile', which is no canonical control"),
        ('{"jawOpen": "wide"}', "'jawOpen' is 'wide', not a weight"),
        ('{"jawOpen": true}', "not a weight"),
        ('{"jawOpen": NaN}', "not a weight"),
        ('{"jawOpen": 1.5}', "from 0 to 1"),
        ('{"format": "lipwright-rig"}', "lipwright-rig"),
        ("[" * 100_000, "nested too deeply"),
    ],
)
def test_a_wrong_file_is_named_in_one_line(tmp_path: Path, content: str, match: str) -> None:
    path = tmp_path / "pose.json"
    path.write_text(content)
    with pytest.raises(LipwrightError, match=match) as error:
        load_expression(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


def test_an_unknown_expression_lists_what_ships(tmp_path: Path) -> None:
    with pytest.raises(LipwrightError, match=r"no expression 'hapy'.*happy"):
        load_expression("hapy")
    with pytest.raises(LipwrightError, match=r"missing\.json"):
        load_expression(tmp_path / "missing.json")
    export_clip(tmp_path / "modes.csv", Clip(("mode 1",), 10, np.zeros((2, 1), np.float32)))
    with pytest.raises(LipwrightError, match=r"modes\.csv: 'mode 1' is no canonical control"):
        load_expression(tmp_path / "modes.csv")


def test_layers_keep_within_range_together(head: Head) -> None:
    layered = apply_passes(
        SPEECH, TRACK, [expression(load_expression("happy")), expression({"jawOpen": 1.0}), limit()]
    )
    assert closures(head, layered, TRACK) == closures(head, SPEECH, TRACK)
