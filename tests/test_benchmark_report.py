"""The report of a benchmark: the same bytes twice, files that agree, a page that shows all."""

from __future__ import annotations

import csv
import json
import math
import re
import shutil
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from benchmark_values import CLASSES, ENTRIES, NAMES, planted_benchmark, planted_rows, planted_split
from lipwright.audio import Audio, write_wav
from lipwright.benchmark.reporting import (
    RealMouth,
    markdown_tables,
    real_mouth,
    write_report,
    write_video,
)
from lipwright.benchmark.reporting.figures import find_figures
from lipwright.benchmark.reporting.mouths import TILE, real_tiles
from lipwright.benchmark.reporting.numbers import scale_of
from lipwright.benchmark.reporting.plots import dot_plots
from lipwright.benchmark.values import Benchmark
from lipwright.clip import Clip
from lipwright.dataset.recording import Motion, Recording
from lipwright.evaluate.measures import MEASURES, Rows
from lipwright.track import PhoneTrack

SHARED = Path(__file__).parents[2] / "shared" / "corpora"
REPEATABLE = ("report.json", "figures.csv", "recordings.csv", "pairs.csv", "classes.csv")
HOSTILE = '=<b onload="x">|`&'


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("report")
    write_report(planted_benchmark(), folder)
    return folder


def table(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


class Page(HTMLParser):
    """The texts and the addresses of a page, and its elements."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.texts: list[str] = []
        self.addresses: list[str] = []
        self.tags: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        self.addresses += [value or "" for name, value in attrs if name in {"href", "src"}]

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


def page_of(folder: Path) -> Page:
    return Page((folder / "index.html").read_text("utf-8"))


def test_a_report_is_the_same_bytes_twice_whatever_it_cost(folder: Path, tmp_path: Path) -> None:
    again = planted_benchmark()
    costs = {name: replace(cost, training_s=1.5) for name, cost in again.costs.items()}
    write_report(replace(again, costs=costs), tmp_path)
    plots = [f"plots/{path.name}" for path in (folder / "plots").iterdir()]
    for name in (*REPEATABLE, *plots):
        assert (tmp_path / name).read_bytes() == (folder / name).read_bytes(), name
    assert (tmp_path / "costs.json").read_bytes() != (folder / "costs.json").read_bytes()


def test_json_has_the_figures_of_the_rows(folder: Path) -> None:
    told = json.loads((folder / "report.json").read_text("utf-8"))
    split = planted_benchmark().splits[0]
    for entry, scores in split.scores.items():
        for name, rows in scores.items():
            figure = told["splits"]["test"]["figures"][entry][name]
            assert figure["value"] == pytest.approx(rows.value, rel=1e-5)
            assert figure["low"] <= figure["value"] <= figure["high"]
            assert figure["recordings"] == 19  # the first recording has none of it
            values = told["splits"]["test"]["values"][entry][name]
            assert values["rec00"] is None
            assert values["rec05"] == pytest.approx(rows.each[5], rel=1e-5)
    assert told["splits"]["test"]["ceiling"]["own"]["r"]["value"] > 0.8
    assert told["facts"] == {"face": {"hash": "ab12"}, "lipwright": "0.1.0", "quick": False}
    assert "training_s" not in json.dumps(told)


def test_csv_and_json_agree(folder: Path) -> None:
    told = json.loads((folder / "report.json").read_text("utf-8"))["splits"]
    rows = table(folder / "figures.csv")
    assert len(rows) == 2 * len(NAMES) * len(MEASURES)
    for row in rows:
        figure = told[row["split"]]["figures"][row["entry"]][row["measure"]]
        for end in ("value", "low", "high"):
            assert float(row[end]) == figure[end]
        assert row["unit"] == MEASURES[row["measure"]].unit
    for row in table(folder / "recordings.csv"):
        value = told[row["split"]]["values"][row["entry"]][row["measure"]][row["recording"]]
        assert row["value"] == "" if value is None else float(row["value"]) == value
    pairs = [(row["split"], row["measure"], row["first"], row["second"], float(row["p_holm"]))
             for row in table(folder / "pairs.csv")]  # fmt: skip
    assert pairs == [
        (split, name, pair["first"], pair["second"], pair["p_holm"])
        for split in ("test", "unseen") for name in MEASURES
        for pair in told[split]["pairs"][name]
    ]  # fmt: skip
    assert {row["class"] for row in table(folder / "classes.csv")} == set(CLASSES)
    assert {row["entry"] for row in table(folder / "costs.csv")} == set(NAMES) - {"captured"}


def test_every_pair_but_those_with_the_real_face_is_compared() -> None:
    figures = find_figures(planted_benchmark()).splits[0]
    for name in MEASURES:
        pairs = {(pair.first, pair.second) for pair in figures.pairs[name]}
        assert len(pairs) == 6
        assert not any("captured" in pair for pair in pairs)
    ahead = figures.pair("joint_sd", "lipwright", "trees")
    behind = figures.pair("joint_sd", "trees", "lipwright")
    assert ahead is not None
    assert behind is not None
    assert ahead.difference == -behind.difference < 0
    assert (ahead.low, ahead.high) == (-behind.high, -behind.low)


def test_the_best_is_the_lowest_the_highest_or_the_nearest_to_zero() -> None:
    benchmark = planted_benchmark()
    split, random = benchmark.splits[0], np.random.default_rng(0)
    lags = {"lipwright": -30.0, "window": 4.0, "trees": -3.0, "dominance": 50.0, "captured": 0.0}
    scores = {
        name: {**split.scores[name], "lag": planted_rows(random, lag, 20)}
        for name, lag in lags.items()
    }
    figures = find_figures(replace(benchmark, splits=(replace(split, scores=scores),)))
    table = figures.splits[0].scores
    assert figures.best(table, "lag") == "trees"  # the real face is no entrant
    assert figures.best(table, "joint_sd") == figures.best(table, "r") == "lipwright"


def test_the_page_shows_every_entry_and_measure_and_asks_nobody_for_anything(folder: Path) -> None:
    page, benchmark = page_of(folder), planted_benchmark()
    text = " ".join(page.texts)
    for entry in benchmark.entries:
        assert entry.title in text
        assert entry.about in text
    for measure in MEASURES.values():
        assert measure.title in text
        assert measure.about in text
    for name in (*CLASSES, *benchmark.heads, benchmark.licence, "Held-out", "Unseen words"):
        assert name in text
    assert all(address.startswith("#") for address in page.addresses)
    assert not page.tags & {"script", "link", "iframe", "object"}
    source = (folder / "index.html").read_text("utf-8")
    assert not re.search(r"https?://(?!www\.w3\.org/2000/svg)|url\(|@import", source)


def test_plots_are_svg_that_stand_alone(folder: Path) -> None:
    found = sorted(path.stem for path in (folder / "plots").iterdir())
    kinds = ("classes", "curves-1", "curves-2", "errors", "figure10", "lips", "timing")
    assert found == sorted(f"{split}-{kind}" for split in ("test", "unseen") for kind in kinds)
    for path in (folder / "plots").iterdir():
        root = ElementTree.fromstring(path.read_text("utf-8"))
        assert root.tag == "{http://www.w3.org/2000/svg}svg"
        assert "prefers-color-scheme: dark" in path.read_text("utf-8")


def test_dots_stand_in_the_order_of_their_figures() -> None:
    figures = find_figures(planted_benchmark())
    for plot in dot_plots(figures, figures.splits[0]):
        for panel in plot.panels:
            places = [dot.x for dot in panel.dots]
            assert all(panel.left <= dot.low <= dot.x <= dot.high for dot in panel.dots)
            assert max(dot.high for dot in panel.dots) <= panel.left + panel.width
            name = next(key for key, one in MEASURES.items() if panel.title.startswith(one.title)
                        and panel.title[len(one.title):].strip()[0] in "↓↑→")  # fmt: skip
            values = [figures.splits[0].scores[entry][name].value for entry in NAMES]
            through = MEASURES[name].group == "error"  # the lips are measured on heads
            assert [dot.hollow for dot in panel.dots] == [
                through and one.bridged for one in ENTRIES
            ]
            assert np.argsort(places).tolist() == np.argsort(values).tolist()


def test_hostile_names_are_text_everywhere(tmp_path: Path) -> None:
    benchmark = planted_benchmark()
    entries = (replace(benchmark.entries[0], title=HOSTILE, about=HOSTILE), *benchmark.entries[1:])
    split = benchmark.splits[0]
    named = replace(split, recordings=("=1+1", *split.recordings[1:]), about=HOSTILE)
    write_report(
        replace(benchmark, entries=entries, dataset=HOSTILE, splits=(named,), facts={"a": HOSTILE}),
        tmp_path,
    )
    page = page_of(tmp_path)
    assert "b" in page.tags  # of the best
    assert "onload" not in " ".join(page.addresses)
    assert '<b onload="x">' not in (tmp_path / "index.html").read_text("utf-8")
    assert HOSTILE in page.texts
    for path in (tmp_path / "plots").iterdir():
        ElementTree.fromstring(path.read_text("utf-8"))
    markdown = (tmp_path / "report.md").read_text("utf-8")
    assert "<b" not in markdown
    assert r"\|" in markdown
    assert {row["recording"] for row in table(tmp_path / "recordings.csv")} >= {"'=1+1"}


def smaller(benchmark: Benchmark) -> Benchmark:
    """One entry, one split and nothing besides, with a measure of which nobody has any."""
    split = planted_split("test", ceiling=False)
    none = Rows(np.zeros(20), np.zeros(20))
    scores = {"lipwright": {"r": split.scores["lipwright"]["r"], "closures": none}}
    split = replace(split, scores=scores, by_head={}, bare={}, classes={}, curves=())
    return replace(benchmark, entries=benchmark.entries[:1], splits=(split,), costs={}, bridge={},
                   heads=())  # fmt: skip


def test_a_report_of_one_entry_without_all_else_is_whole(tmp_path: Path) -> None:
    write_report(smaller(planted_benchmark()), tmp_path)
    text = " ".join(page_of(tmp_path).texts)
    assert "nobody else has it" in text
    assert "No ceiling" in text
    assert "Unseen words" not in text
    figure = json.loads((tmp_path / "report.json").read_text("utf-8"))["splits"]["test"]["figures"]
    assert figure["lipwright"]["closures"]["value"] is None
    assert "–" in (tmp_path / "index.html").read_text("utf-8")
    row = next(row for row in table(tmp_path / "figures.csv") if row["measure"] == "closures")
    assert (row["value"], row["recordings"]) == ("", "0")


def test_markdown_tables_are_whole_and_mark_the_best() -> None:
    markdown = markdown_tables(planted_benchmark())
    blocks = [block.splitlines() for block in markdown.split("\n\n") if block.startswith("|")]
    assert len(blocks) == 2 * 6 + 1
    for lines in blocks:
        assert len({line.count("|") for line in lines}) == 1
    errors = next(block for block in markdown.split("\n\n") if "parameters, each" in block)
    assert errors.count("**") == 2 * sum(one.group == "error" for one in MEASURES.values())
    assert re.search(r"\d of 0\.\d+ \|", markdown)  # the ceiling beside r


def test_a_summary_says_who_is_best_and_who_cannot_be_told_from_it(folder: Path) -> None:
    text = " ".join(page_of(folder).texts)
    assert re.search(r"Parameters, each over its deviation: Lipwright is lowest with 0\.\d+", text)
    assert "every other entry differs from it" in text
    assert "it cannot be told from" in text


@pytest.mark.parametrize(
    ("values", "shown"),
    [
        ((0.851, 1.2), ["0.851", "1.200"]), ((0.00061, 0.0012), ["0.610", "1.200"]),
        ((41.2, 58.0), ["41.2", "58.0"]), ((-0.5, math.nan), ["−0.500", "–"]), ((0.0,), ["0.00"]),
    ],
)  # fmt: skip
def test_numbers_have_the_digits_that_their_column_needs(
    values: tuple[float, ...], shown: list[str]
) -> None:
    scale = scale_of(values)
    assert [scale.shown(value) for value in values] == shown


# The real mouth.


def write_levels(path: Path, count: int, fps: int = 25) -> None:
    """A video whose frame i is grey, 20 + 6 i."""
    av = pytest.importorskip("av")
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=fps, options={"crf": "4"})
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuv420p"
        for i in range(count):
            picture = np.full((48, 64, 3), 20 + 6 * i, np.uint8)
            frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))


def standing(video: Path, count: int, fps: float = 25.0, start: float = 0.0) -> RealMouth:
    """A head that stands still in a picture of 64 x 48."""
    pose = np.zeros((count, 3, 4))
    pose[:, [0, 1, 2], [0, 1, 2]], pose[:, :2, 3] = 12.0, (32, 16)
    pose[3] = np.nan
    landmarks = np.zeros((count, 478, 3))
    landmarks[:, :, 1] = 0.6
    return RealMouth(video, pose, landmarks, fps, start)


def test_tiles_of_the_real_mouth_are_the_frames_of_the_times(tmp_path: Path) -> None:
    pytest.importorskip("cv2")
    write_levels(tmp_path / "levels.mp4", 25)
    real = standing(tmp_path / "levels.mp4", 25, start=0.3)
    times = 0.3 + (np.array([0, 0, 4, 9, 20, 24]) + 0.5) / 25
    levels = [tile[TILE // 2, TILE // 2, 0] for tile in real_tiles(real, times)]
    assert np.abs(np.array(levels, float) - (20 + 6 * np.array([0, 0, 4, 9, 20, 24]))).max() < 4


def read_video(path: Path) -> tuple[list[Any], dict[str, float]]:
    av = pytest.importorskip("av")
    with av.open(str(path)) as container:
        lengths = {s.type: float(s.duration * s.time_base) for s in container.streams}
        return [f.to_ndarray(format="rgb24") for f in container.decode(video=0)], lengths


def talking(seconds: float) -> Clip:
    values = np.linspace(0, 1, round(seconds * 60), dtype=np.float32)[:, None]
    return Clip(("jawOpen",), 60.0, values)


@pytest.mark.usefixtures("head")
def test_a_video_has_the_size_the_length_and_the_sound_of_the_real_one(tmp_path: Path) -> None:
    pytest.importorskip("PIL")
    write_levels(tmp_path / "levels.mp4", 10)
    write_wav(tmp_path / "sound.wav", Audio(np.zeros(16000, np.float32), 16000))
    real = standing(tmp_path / "levels.mp4", 10)
    out = tmp_path / "out.mp4"
    write_video(out, real, [("one", talking(1.0)), ("x" * 80, talking(1.0))],
                tmp_path / "sound.wav", 0.04)  # fmt: skip
    frames, lengths = read_video(out)
    assert len(frames) == 10
    assert {frame.shape for frame in frames} == {(192 + 26 + 8, 3 * 196 + 4, 3)}
    assert lengths["video"] == pytest.approx(0.4)
    assert lengths["audio"] == pytest.approx(0.4, abs=0.03)
    levels = np.array([float(frame[100, 100].mean()) for frame in frames])
    assert np.abs(levels - (20 + 6 * np.arange(10))).max() < 6
    mouths = [frame[4:196, 200:392].astype(float) for frame in frames]
    assert np.abs(mouths[9] - mouths[2]).mean() > 0.5  # the head opens its mouth


@pytest.mark.usefixtures("head")
def test_where_the_video_is_gone_its_tile_says_so(tmp_path: Path) -> None:
    pytest.importorskip("PIL")
    out = tmp_path / "out.mp4"
    write_video(out, standing(tmp_path / "gone.mp4", 5), [("one", talking(0.3))], None, 0.0)
    frames, lengths = read_video(out)
    assert len(frames) == 5
    assert set(lengths) == {"video"}
    tile = frames[0][4:196, 4:196].astype(float)
    assert tile.std() > 1
    assert np.abs(tile - frames[4][4:196, 4:196]).mean() < 1


@pytest.mark.usefixtures("head")
def test_a_real_recording_gives_its_mouth(tmp_path: Path) -> None:
    found = next(iter(sorted((SHARED / "grid-s1" / "video").glob("*.mp4"))), None)
    if found is None:
        pytest.skip("the videos of GRID are not beside the repository")
    count = 20  # of the 75 that the video has
    pose = np.zeros((count, 3, 4), np.float32)
    pose[:, [0, 1, 2], [0, 1, 2]], pose[:, :2, 3] = 55.0, (180, 140)
    points = np.zeros((count, 478, 3), np.float32)
    points[:, :, 1] = 1.1
    motion = Motion(
        25.0, np.zeros(count, np.uint8), np.zeros((count, 52), np.float32), points, pose
    )
    info = {"source": {"video": {"path": str(found)}}}
    track = PhoneTrack(("sil",), np.array([0.0, 3.0]))
    real = real_mouth(Recording("x", motion, track, 0.0, info, tmp_path))
    assert real is not None
    assert real.duration == 0.8
    out = tmp_path / "out.mp4"
    write_video(out, real, [("one", talking(0.8))], None, 0.0)
    frames, lengths = read_video(out)
    assert len(frames) == count
    assert lengths["video"] == pytest.approx(0.8)
    assert frames[15][4:196, 4:196].std() > 10


def test_the_page_lists_the_videos_of_its_recordings(tmp_path: Path) -> None:
    (tmp_path / "videos").mkdir()
    for name in ("rec00.mp4", "another.mp4"):
        (tmp_path / "videos" / name).write_bytes(b"")
    write_report(smaller(planted_benchmark()), tmp_path)
    assert "videos/rec00.mp4" in page_of(tmp_path).addresses
    assert "videos/another.mp4" not in page_of(tmp_path).addresses


def test_the_page_fits_a_telephone_in_a_real_browser(folder: Path) -> None:
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    found = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
    if found is None:
        pytest.skip("there is no Chromium here")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=found, args=["--headless", "--no-sandbox"])
        page = browser.new_page(viewport={"width": 390, "height": 800})
        asked: list[str] = []
        page.on("request", lambda request: asked.append(request.url))
        page.goto((folder / "index.html").as_uri())
        assert page.evaluate("document.documentElement.scrollWidth") == 390
        assert len(asked) == 1
        browser.close()
