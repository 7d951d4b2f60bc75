"""Quality of captured recordings: figures with planted answers, reasons, pictures and pages."""

from __future__ import annotations

import io
import os
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lipwright.capture.plots import histogram, plot_rows
from lipwright.capture.quality import (
    BILABIALS,
    LIP_LANDMARKS,
    agreement,
    bilabial_closures,
    eye_distance,
    head_turns,
    lip_jitter,
    loud_aperture,
    measure_quality,
)
from lipwright.capture.rejection import DEFAULT_LIMITS, RejectLimits, reject_reasons
from lipwright.dataset.folder import FORMAT, RECORDINGS, VERSION, Dataset
from lipwright.dataset.recording import (
    MOTION_FILE,
    PHONES_FILE,
    PICTURE_FILE,
    Flag,
    Motion,
    Recording,
    read_recording,
    save_motion,
    to_json,
    write_info,
)
from lipwright.errors import LipwrightError
from lipwright.evaluate.lips import runs
from lipwright.formats import write_track
from lipwright.track import PhoneTrack, Word

FPS = 25.0
TRACK = PhoneTrack(
    ("sil", "M", "AA", "B", "IY", "sil"),
    np.array([0.0, 0.4, 0.6, 1.0, 1.2, 1.6, 2.0]),
    (Word("ma", 1, 3, 0.9), Word("be", 3, 5, 0.7)),
)
T = 50
TIMES = (np.arange(T) + 0.5) / FPS


def lips(*, closing: tuple[float, ...] = (0.5, 1.1)) -> np.ndarray:
    """(T,), open by 0.2 while TRACK speaks, shut in silence and within 60 ms of `closing`."""
    values = np.where((TIMES > 0.4) & (TIMES < 1.6), 0.2, 0.0)
    for time in closing:
        values[np.abs(TIMES - time) < 0.06] = 0.001
    return values


def posed(turn_deg: float = 0.0, eyes: float = 60.0, at: tuple[float, float] = (160, 120)) -> Any:
    """(T, 3, 4), a head turned aside by `turn_deg`, its eyes `eyes` pixels apart."""
    a = np.radians(turn_deg)
    rotation = np.array([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]])
    pose = np.concatenate([rotation * eyes, np.array([[*at, 0.0]]).T], axis=1)
    return np.repeat(pose[None], T, axis=0)


def face() -> np.ndarray:
    """(478, 3), points on a disc, in eye distances."""
    angle = np.arange(478) * 2.4
    radius = np.sqrt(np.arange(478) / 478)
    return np.stack([radius * np.cos(angle), 0.5 + radius * np.sin(angle), 0 * angle], axis=1)


def motion(flags: np.ndarray | None = None, **changes: Any) -> Motion:
    fields: dict[str, Any] = {
        "fps": FPS,
        "flags": np.zeros(T, np.uint8) if flags is None else flags,
        "arkit": np.full((T, 52), 0.1),
        "landmarks": np.repeat(face()[None], T, axis=0),
        "head_pose": posed(),
        "aperture": lips(),
        "aperture_raw": lips(),
    }
    return Motion(**(fields | changes))


def flagged(**spans: tuple[int, int]) -> np.ndarray:
    flags = np.zeros(T, np.uint8)
    for name, (first, stop) in spans.items():
        flags[first:stop] |= int(Flag[name])
    return flags


# --- figures


def test_runs_are_counted_once_each() -> None:
    assert len(runs(np.array([True, True, False, True, False, False, True]))) == 3
    assert len(runs(np.zeros(5, bool))) == 0


@given(st.floats(0, 80), st.floats(20, 500))
def test_turn_and_distance_of_the_eyes_are_read_from_the_pose(turn: float, eyes: float) -> None:
    pose = posed(turn, eyes)
    assert eye_distance(pose) == pytest.approx(eyes)
    np.testing.assert_allclose(head_turns(pose), turn, atol=1e-5)


def test_a_head_tilted_to_the_shoulder_is_not_turned_away() -> None:
    pose = posed()
    pose[:, :2, :2] = 60 * np.array([[0.8, -0.6], [0.6, 0.8]])
    np.testing.assert_allclose(head_turns(pose), 0, atol=1e-6)


def test_jitter_is_the_noise_of_the_points_whatever_the_lips_do() -> None:
    sigma, frames = 0.004, 400
    rng = np.random.default_rng(1)
    raw = np.repeat(face()[None], frames, axis=0) + rng.normal(0, sigma, (frames, 478, 3))
    talking = (np.arange(frames) % 40) < 20
    raw[:, list(LIP_LANDMARKS), 1] += (talking * (np.arange(frames) % 2) * 0.2)[:, None]
    assert lip_jitter(raw) == pytest.approx(sigma * np.sqrt(2), rel=0.1)  # x and y


def test_jitter_is_none_of_a_steady_movement() -> None:
    raw = np.repeat(face()[None], T, axis=0) + 0.01 * np.arange(T)[:, None, None]
    assert lip_jitter(raw) == pytest.approx(0, abs=1e-9)


def test_jitter_of_lost_or_too_few_frames_is_unknown() -> None:
    assert np.isnan(lip_jitter(np.full((T, 478, 3), np.nan)))
    assert np.isnan(lip_jitter(np.zeros((2, 478, 3))))


def test_the_bilabials_are_those_of_the_phone_table() -> None:
    assert {"P", "B", "M"} <= BILABIALS


def test_closures_are_found_where_the_lips_shut() -> None:
    found = bilabial_closures(lips(), TIMES, 1 / FPS, TRACK)
    assert [(c.phone, c.closed) for c in found] == [("M", True), ("B", True)]
    found = bilabial_closures(lips(closing=(0.5,)), TIMES, 1 / FPS, TRACK)
    assert [c.closed for c in found] == [True, False]
    assert found[1].share == pytest.approx(1.0)


def test_a_closure_one_frame_beside_the_phone_counts_and_two_frames_do_not() -> None:
    for frames_late, closed in ((1, True), (2, False)):
        values = np.full(T, 0.2)
        values[29 + frames_late] = 0.0  # frame 29 is the last inside of B
        assert bilabial_closures(values, TIMES, 1 / FPS, TRACK)[1].closed is closed


def test_the_offset_brings_late_closures_back_to_their_phones() -> None:
    late = np.roll(lips(), 5)
    aside = Motion(FPS, np.zeros(T, np.uint8), np.zeros((T, 52)), aperture=late, aperture_raw=late)
    assert measure_quality(aside, TRACK, 0.0)["bilabials_closed"] < 2
    assert measure_quality(aside, TRACK, 5 / FPS)["bilabials_closed"] == 2


def test_a_bilabial_whose_frames_are_lost_is_not_seen_rather_than_open() -> None:
    values = lips(closing=(0.5,))
    values[26:28] = np.nan
    seen = bilabial_closures(values, TIMES, 1 / FPS, TRACK)
    assert [c.share is None for c in seen] == [False, True]
    values[24:31] = np.nan
    assert bilabial_closures(values, TIMES, 1 / FPS, TRACK)[1].share is None


def test_a_bilabial_after_the_picture_ends_is_not_seen() -> None:
    early = bilabial_closures(lips(closing=())[:20], TIMES[:20], 1 / FPS, TRACK)
    assert early[1].share is None


def test_agreement_is_the_correlation_and_the_slope() -> None:
    x = np.random.default_rng(2).random(100)
    y = 0.8 * x + 0.1 * np.random.default_rng(3).random(100)
    r, gain = agreement(x, y)
    assert r == pytest.approx(np.corrcoef(x, y)[0, 1])
    assert gain == pytest.approx(np.polyfit(x, y, 1)[0])
    assert np.isnan(agreement(x, np.zeros(100))).all()


def test_the_loud_opening_ignores_lost_frames() -> None:
    assert loud_aperture(np.array([np.nan, 1.0, 1.0])) == 1.0
    assert np.isnan(loud_aperture(np.full(3, np.nan)))


def test_quality_has_every_planted_figure() -> None:
    flags = flagged(LOST=(0, 5), DROPPED=(48, 50), BLINK=(10, 13), CROWD=(20, 25))
    flags[15] |= int(Flag.BLINK)
    made = motion(flags, head_pose=posed(20, 44))
    quality = measure_quality(made, TRACK, 0.0, misfits=1, arkit_aperture=lips() * 0.9)
    expected = {
        "tracked": round(43 / 48, 4), "dropped": 2, "frames": T, "blinks": 2, "second_face": 0.1,
        "confidence": 0.8, "words": 2, "misfits": 1, "eye_distance_px": 44.0, "turn_deg": 20.0,
        "bilabials": 2, "bilabials_closed": 2, "bilabials_closed_before": 2, "bilabials_unseen": 0,
        "bilabials_open": 0, "unclosed": [], "closure_share_after": 0.0025, "arkit_r": 1.0,
        "arkit_gain": 0.9, "jitter": None,
    }  # fmt: skip
    assert {key: quality[key] for key in expected} == expected
    to_json(quality)  # no NaN, no arrays


@pytest.mark.filterwarnings("error")
def test_quality_of_a_recording_without_landmarks_or_without_a_face_is_json() -> None:
    imported = Motion(FPS, np.zeros(T, np.uint8), np.zeros((T, 52)))
    quality = measure_quality(imported, TRACK, 0.0, arkit_aperture=np.zeros(T))
    assert quality["tracked"] == 1.0
    assert quality["bilabials"] is None
    to_json(quality)
    lost = motion(flagged(LOST=(0, T)))
    quality = measure_quality(lost, TRACK, 0.0, landmarks_raw=lost.landmarks)
    assert quality["tracked"] == 0.0
    assert quality["bilabials_unseen"] == 2
    to_json(quality)


def test_smoothing_that_opens_closures_shows() -> None:
    quality = measure_quality(motion(aperture=np.maximum(lips(), 0.05)), TRACK, 0.0)
    assert quality["bilabials_closed_before"] == 2
    assert quality["bilabials_closed"] == 0
    assert quality["closure_share_before"] < 0.01 < quality["closure_share_after"]


# --- reasons


GOOD = measure_quality(motion(), TRACK, 0.0)
GOOD_OFFSET = {"seconds": 0.01, "r": 0.9, "r_at_zero": 0.89, "trusted": False}


def test_a_good_recording_has_no_reason() -> None:
    assert reject_reasons(GOOD, GOOD_OFFSET) == []
    assert reject_reasons({}) == []
    nothing = dict.fromkeys(GOOD)
    assert reject_reasons(nothing, dict.fromkeys(GOOD_OFFSET)) == []


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"tracked": 0.9}, "90.0 %"),
        ({"dropped": 5}, "5 of 50"),
        ({"second_face": 0.2}, "second face"),
        ({"turn_usual_deg": 44.0}, "44 degrees"),
        ({"eye_distance_px": 12.0}, "12 pixels"),
        ({"jitter": 0.02}, "0.0200"),
        ({"opening": 0.01}, "hardly move"),
        ({"bilabials_open": 1}, "1 of 2"),
        ({"confidence": 0.3}, "0.30"),
        ({"misfits": 1}, "1 of 2"),
    ],
)
def test_each_defect_is_one_line_with_its_figure(change: dict[str, Any], says: str) -> None:
    (reason,) = reject_reasons(GOOD | change, GOOD_OFFSET)
    assert says in reason
    assert "\n" not in reason


@pytest.mark.parametrize(
    ("offset", "says"),
    [
        ({"seconds": 0.3, "r": 0.8, "r_at_zero": 0.1, "trusted": True}, "300 ms late"),
        ({"seconds": -0.25, "r": 0.8, "r_at_zero": 0.1, "trusted": True}, "250 ms early"),
        ({"seconds": 0.3, "r": 0.5, "r_at_zero": 0.1, "trusted": False}, "r 0.10"),
    ],
)
def test_sound_and_picture_far_apart_are_rejected(offset: dict[str, Any], says: str) -> None:
    (reason,) = reject_reasons(GOOD, offset)
    assert says in reason


def test_an_offset_that_is_not_trusted_is_no_reason_by_itself() -> None:
    assert not reject_reasons(GOOD, {"seconds": 0.4, "r": 0.8, "r_at_zero": 0.79, "trusted": False})


def test_the_limits_can_be_set() -> None:
    assert reject_reasons(GOOD, GOOD_OFFSET, RejectLimits(eye_distance_px=100))
    assert replace(DEFAULT_LIMITS, tracked=0.5).tracked == 0.5


# --- pictures


def test_chosen_frames_are_distinct_rising_and_show_what_matters() -> None:
    from lipwright.capture.pictures import choose_frames

    flags = flagged(LOST=(35, 37), DROPPED=(20, 22))
    chosen = choose_frames(motion(flags), TRACK, n=8)
    assert len(chosen) == 8
    assert list(chosen) == sorted(set(chosen))
    assert not set(chosen) & {20, 21}
    assert set(chosen) & {35, 36}, "a lost frame"
    shut = [i for i in chosen if 0.36 <= TIMES[i] <= 1.2 and lips()[i] < 0.01]
    assert len(shut) >= 2, "both closures"


def test_a_video_shorter_than_the_sheet_gives_all_its_frames() -> None:
    from lipwright.capture.pictures import choose_frames

    assert choose_frames(motion(flagged(DROPPED=(0, 44))), TRACK) == tuple(range(44, 50))


def test_no_frame_is_chosen_of_a_video_without_any() -> None:
    from lipwright.capture.pictures import choose_frames

    assert choose_frames(motion(flagged(DROPPED=(0, T))), TRACK) == ()


def test_frames_are_chosen_of_faces_that_are_all_lost_and_of_silence() -> None:
    from lipwright.capture.pictures import choose_frames

    silent = PhoneTrack(("sil",), np.array([0.0, 2.0]))
    assert len(choose_frames(motion(flagged(LOST=(0, T))), silent, n=5)) == 5


def test_the_contact_sheet_draws_the_landmarks_on_the_face() -> None:
    image_module = pytest.importorskip("PIL.Image", reason="pillow is not installed")
    from lipwright.capture.pictures import CAPTION, TILE, contact_sheet, sheet_frames

    grey = np.full((240, 320, 3), 90, np.uint8)
    made = motion(flagged(LOST=(3, 4)))
    frames = sheet_frames(made, TRACK, 0.0, {0: grey, 3: grey, 12: grey})
    assert [frame.label for frame in frames] == ["sil", "sil", "M  ma"]
    assert [frame.notes for frame in frames] == [(), ("lost",), ()]
    data = contact_sheet(frames)
    assert data == contact_sheet(frames)
    sheet = np.asarray(image_module.open(io.BytesIO(data)), int)
    assert sheet.shape == (TILE + CAPTION, 3 * TILE, 3)
    drawn, lost = (
        sheet[10 : TILE - 10, 10 : TILE - 10],
        sheet[10 : TILE - 10, TILE + 10 : -TILE - 10],
    )
    assert (np.abs(drawn - 90).max(axis=-1) > 40).mean() > 0.01
    assert (np.abs(lost - 90).max(axis=-1) < 20).all()
    assert sheet[TILE // 2, TILE + 2, 0] > 180, "a red frame around a lost face"


def test_a_landmark_lands_on_its_pixel_when_large_pictures_shrink_and_small_ones_grow() -> None:
    image_module = pytest.importorskip("PIL.Image", reason="pillow is not installed")
    from lipwright.capture.pictures import TILE, SheetFrame, contact_sheet, face_boxes

    for height, width, side in ((120, 160, 12), (2400, 3200, 240)):
        picture = np.zeros((height, width, 3), np.uint8)
        x, y = width * 3 // 5, height * 2 // 5
        picture[y : y + side, x : x + side] = 255
        corners = np.array([[x, y], [x + side, y + side]], float)
        points = np.repeat([corners[0] - 2 * side, corners[1] + 2 * side], 239, axis=0)
        frame = SheetFrame(0.0, picture, points, "")
        left, top, box = face_boxes([frame])[0]
        tile = np.asarray(image_module.open(io.BytesIO(contact_sheet([frame]))), int)[
            :TILE, :TILE, 0
        ]
        rows, columns = np.nonzero(tile[60:-60, 60:-60] > 128)
        middle = (np.array([columns.mean(), rows.mean()]) + 60.5) * box / TILE + (left, top)
        np.testing.assert_allclose(middle, [x + side / 2, y + side / 2], atol=0.06 * side)


def test_a_contact_sheet_of_nothing_is_refused() -> None:
    pytest.importorskip("PIL.Image", reason="pillow is not installed")
    from lipwright.capture.pictures import contact_sheet

    with pytest.raises(ValueError, match="no frames"):
        contact_sheet([])


def test_the_outlines_are_the_trackers_own() -> None:
    landmarker = pytest.importorskip(
        "mediapipe.tasks.python.vision.face_landmarker", reason="the tracker is not installed"
    )
    from lipwright.capture.pictures import EYES, JAW, LIPS

    known = landmarker.FaceLandmarksConnections

    def edges(connections: Any) -> set[frozenset[int]]:
        return {frozenset((c.start, c.end)) for c in connections}

    def drawn(chains: Any) -> set[frozenset[int]]:
        return {frozenset(p) for c in chains for p in pairwise(c)}

    assert drawn(LIPS) == edges(known.FACE_LANDMARKS_LIPS)
    eyes = edges(known.FACE_LANDMARKS_LEFT_EYE) | edges(known.FACE_LANDMARKS_RIGHT_EYE)
    assert drawn(EYES) == eyes
    assert drawn(JAW) < edges(known.FACE_LANDMARKS_FACE_OVAL)
    assert set(LIP_LANDMARKS) == {i for chain in LIPS for i in chain}


# --- drawings


def recording(made: Motion, folder: Path = Path(), **info: Any) -> Recording:
    return Recording("one", made, TRACK, 0.0, {"name": "one", **info}, folder)


def test_the_plot_places_time_evenly_and_breaks_where_the_face_is_lost() -> None:
    (row,) = plot_rows(recording(motion(flagged(LOST=(20, 23)))))
    smooth = dict(row.curves)["smooth"]
    assert smooth.count("M") == 2
    assert smooth.count("L") == T - 3 - 2
    assert {band.kind for band in row.bands} == {"closed", "lost"}
    assert [span.text for span in row.words] == ["ma", "be"]
    steps = np.diff([x for x, _ in row.ticks])
    np.testing.assert_allclose(steps, steps[0], atol=0.11)


def test_an_open_bilabial_and_an_unseen_one_are_told_apart() -> None:
    (row,) = plot_rows(recording(motion(aperture=lips(closing=(0.5,)))))
    assert [band.kind for band in row.bands] == ["closed", "unclosed"]
    (row,) = plot_rows(recording(motion(flagged(LOST=(24, 31)), aperture=lips(closing=(0.5,)))))
    assert {band.kind for band in row.bands} == {"closed", "unseen", "lost"}


def test_a_long_recording_takes_several_rows_and_loses_no_phone() -> None:
    phones, edges = ("sil", "AA") * 50, np.arange(101) * 0.2
    long = replace(recording(motion()), track=PhoneTrack(phones, edges))
    rows = plot_rows(long)
    assert len(rows) == 5
    assert sum(len(row.phones) for row in rows) >= 100


def test_a_histogram_counts_every_value() -> None:
    values = [0.0, 0.1, 0.1, 0.5]
    drawn = histogram("r", values)
    assert drawn is not None
    assert sum(int(bar[3].split()[0]) for bar in drawn.bars) == drawn.count == len(values)
    assert histogram("r", []) is None
    assert histogram("r", [0.3, 0.3]) is not None


# --- pages

HOSTILE = "it's 100% & #1; <b>"  # no file name has < or >, but reasons and words do


class Page(HTMLParser):
    """Links, pictures and tags of a page."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.tags: set[str] = set()
        self.feed(path.read_text("utf-8"))
        for link in self.links:
            target = path.parent / unquote(link)
            assert target.is_file(), f"{path.name} links to {link}"

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        self.links += [value for key, value in attrs if key in ("href", "src") and value]


def add(root: Path, name: str, made: Motion, **changes: Any) -> dict[str, Any]:
    """Write a recording; its entry of the manifest."""
    folder = root / RECORDINGS / name
    folder.mkdir(parents=True)
    save_motion(folder / MOTION_FILE, made)
    write_track(folder / PHONES_FILE, TRACK)
    quality = measure_quality(made, TRACK, 0.0)
    info = {
        "name": name, "text": "ma <i>be</i>", "quality": quality, "offset": GOOD_OFFSET,
        "reject": reject_reasons(quality), "warnings": [],
        "words": [{"text": "<u>ma</u>", "start": 0.4, "end": 1.0, "confidence": 0.4}],
        "source": {"video": {"path": f"/films/{name}.mp4", "sha256": "0"}},
    }  # fmt: skip
    write_info(folder, info | changes)
    return {"name": name, "status": "captured", "reasons": info["reject"], "split": "train"}


def save(root: Path, entries: list[dict[str, Any]]) -> Dataset:
    manifest = {"format": FORMAT, "version": VERSION, "name": "<b>Set</b>", "recordings": entries}
    dataset = Dataset(root, manifest)
    dataset.save()
    return dataset


@pytest.fixture
def dataset(tmp_path: Path) -> Dataset:
    """Good, bad, rejected, failed, imported, broken and oddly named recordings."""
    pytest.importorskip("jinja2", reason="jinja2 is not installed")
    odd = HOSTILE.replace("<b>", "b")
    entries = [
        add(tmp_path, "good", motion()),
        add(tmp_path, odd, motion(flagged(LOST=(0, 10))), warnings=["<script>alert(1)</script>"]),
        add(tmp_path, "imported", Motion(30.0, np.zeros(60, np.uint8), np.zeros((60, 52)))),
        add(tmp_path, "index", motion()),
        add(tmp_path, "edited", motion(), quality={"tracked": "all", "unclosed": [1]}, words=[3]),
        add(tmp_path, "broken", motion()),
        {"name": "gone", "status": "failed", "reasons": ["gone.mp4: no <face>"], "files": {}},
    ]
    entries[0]["split"] = "test"
    rejected = add(tmp_path, "shut", motion(aperture=np.full(T, 0.01)))
    entries.append(rejected | {"status": "rejected"})
    (tmp_path / RECORDINGS / "broken" / MOTION_FILE).write_bytes(b"no zip")
    (tmp_path / RECORDINGS / odd / PICTURE_FILE).write_bytes(b"a picture")
    return save(tmp_path, entries)


def test_every_link_leads_somewhere_and_nothing_of_the_users_becomes_markup(
    dataset: Dataset,
) -> None:
    from lipwright.capture.report import write_report

    index = write_report(dataset)
    assert index == dataset.path / "report" / "index.html"
    assert Page(index).tags.isdisjoint({"b>", "face", "i", "u"})
    assert index.read_text("utf-8").count("<script>") == 1
    pages = sorted(index.parent.glob("*.html"))
    assert len(pages) == 1 + 6, "all but the failed and the broken one"
    for path in pages:
        page = Page(path)
        assert "face" not in page.tags
        assert "u" not in page.tags
        assert "http" not in path.read_text("utf-8"), "no network"


def test_the_overview_tells_what_failed_was_rejected_or_should_be(dataset: Dataset) -> None:
    from lipwright.capture.report import write_report

    text = write_report(dataset).read_text("utf-8")
    assert "Failed: 2" in text
    assert "gone.mp4: no &lt;face&gt;" in text
    assert "not a readable motion" in text
    assert "Rejected: 1" in text
    assert "the lips hardly move" in text
    assert "To be rejected: 1" in text
    assert "a face in 80.0 % of the frames, under 95 %" in text


def test_a_recording_called_index_keeps_off_the_overview(dataset: Dataset) -> None:
    from lipwright.capture.report import write_report
    from lipwright.capture.summary import page_name

    write_report(dataset)
    assert page_name("index") != "index.html"
    assert (dataset.path / "report" / page_name("index")).is_file()


def test_the_same_dataset_gives_the_same_bytes(dataset: Dataset) -> None:
    from lipwright.capture.report import write_report

    def contents() -> dict[str, bytes]:
        return {path.name: path.read_bytes() for path in write_report(dataset).parent.iterdir()}

    assert contents() == contents()


def test_pages_of_recordings_that_are_gone_vanish_and_other_files_stay(dataset: Dataset) -> None:
    from lipwright.capture.report import write_report

    report = write_report(dataset).parent
    (report / "notes.html").write_text("mine")
    kept = [entry for entry in dataset.entries if entry["name"] != "good"]
    write_report(save(dataset.path, kept))
    assert not (report / "good.html").exists()
    assert (report / "notes.html").read_text() == "mine"
    assert "good.html" not in (report / "index.html").read_text("utf-8")


@pytest.mark.parametrize(
    "entries", [[], [{"name": "gone", "status": "failed", "reasons": [], "files": {}}]]
)
def test_a_dataset_with_nothing_in_it_has_a_report(
    tmp_path: Path, entries: list[dict[str, Any]]
) -> None:
    pytest.importorskip("jinja2", reason="jinja2 is not installed")
    from lipwright.capture.report import write_report

    index = write_report(save(tmp_path, entries))
    Page(index)
    assert f"of {len(entries)} recordings" in index.read_text("utf-8")


def test_totals_are_those_of_the_recordings_that_are_used(dataset: Dataset) -> None:
    from lipwright.capture.report import write_report

    text = write_report(dataset).read_text("utf-8")
    assert "<b>5</b><span>of 8 recordings are used</span>" in text
    assert "<b>4 · 0 · 1</b>" in text


def test_progress_ends_at_one(dataset: Dataset) -> None:
    from lipwright.capture.report import write_report

    shares: list[float] = []
    write_report(dataset, shares.append)
    assert shares[-1] == 1.0
    assert shares == sorted(shares)


def test_a_report_that_cannot_be_written_is_one_clear_line(dataset: Dataset) -> None:
    from lipwright.capture.report import write_report

    (dataset.path / "report").write_text("a file")
    with pytest.raises(LipwrightError, match="report") as caught:
        write_report(dataset)
    assert os.linesep not in str(caught.value)


def test_the_page_of_a_recording_shows_its_words_and_its_picture(dataset: Dataset) -> None:
    from lipwright.capture.report import write_report
    from lipwright.capture.summary import page_name

    folder = write_report(dataset).parent
    text = (folder / page_name(HOSTILE.replace("<b>", "b"))).read_text("utf-8")
    assert "&lt;u&gt;ma&lt;/u&gt;" in text
    assert "0.40" in text
    assert 'class="sheet"' in text
    assert 'class="sheet"' not in (folder / "good.html").read_text("utf-8")


def test_what_is_captured_reads_back_as_it_is_reported(dataset: Dataset) -> None:
    made = read_recording(dataset.folder("good"))
    assert measure_quality(made.motion, made.track, made.offset) == made.info["quality"] | {
        "confidence": None
    }
