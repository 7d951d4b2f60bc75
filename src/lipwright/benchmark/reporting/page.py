"""The report as one page, and its drawings as files.

The page needs no network, no server and no scripts; only the videos lie beside it. The same
benchmark gives the same bytes, but for what it cost.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final
from urllib.parse import quote

from lipwright.benchmark.reporting import tables
from lipwright.benchmark.reporting.figures import ReportFigures, SplitFigures
from lipwright.benchmark.reporting.numbers import scale_of
from lipwright.benchmark.reporting.plots import DotPlot, HeatMap, dot_plots, heat_map
from lipwright.benchmark.reporting.summary import summarise
from lipwright.benchmark.reporting.tables import View
from lipwright.benchmark.reporting.traces import TracePlot, trace_plot
from lipwright.benchmark.values import Benchmark
from lipwright.errors import MissingExtraError
from lipwright.evaluate.measures import MEASURES
from lipwright.files import write_whole

INDEX: Final = "index.html"
PLOTS: Final = "plots"
VIDEOS: Final = "videos"
TEMPLATES: Final = Path(__file__).with_name("templates")
PAIRED: Final = ("r", "joint_sd")  # measures whose pairs are shown
KINDS: Final = {
    "learnt": "trained here", "shipped": "as it ships", "rules": "by rule", "peer": "a peer",
    "curves": "given curves", "real": "the real face",
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Section:
    """What the page shows of a split."""

    heading: str
    about: str
    summary: list[str]
    scores: list[View]
    further: list[View]
    pairs: list[View]
    dots: list[DotPlot]
    heat: HeatMap | None
    traces: list[TracePlot]
    split: SplitFigures


def write_page(figures: ReportFigures, folder: Path) -> None:
    """Write index.html and plots/.

    Raises:
        LipwrightError: a file cannot be written.
        MissingExtraError: jinja2 is not installed.
    """
    environment = _environment()
    sections = [_section(figures, split) for split in figures.splits]
    page = environment.get_template(INDEX).render(
        benchmark=figures.benchmark, figures=figures, sections=sections, kinds=KINDS,
        facts=list(_facts(figures.benchmark.facts)), measures=MEASURES.values(),
        costs=tables.cost_view(figures.benchmark), videos=_videos(figures.benchmark, folder),
        bridged=[one.title for one in figures.benchmark.entries if one.bridged],
        bridge=_bridge(figures), present=sorted({one.kind for one in figures.benchmark.entries}),
        alpha=tables.ALPHA,
    )  # fmt: skip
    _write(folder / INDEX, page)
    _write_plots(environment, sections, folder / PLOTS)


def _write(path: Path, text: str) -> None:
    with write_whole(path) as part:
        part.write_text(text, "utf-8", errors="replace", newline="\n")


def _environment() -> Any:
    try:
        import jinja2
    except ImportError as error:
        raise MissingExtraError("jinja2, which writes the report's page", "bench") from error
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals["styles"] = {
        name: (TEMPLATES / f"{name}.css").read_text("utf-8") for name in ("colours", "report")
    }
    return environment


def _section(figures: ReportFigures, split: SplitFigures) -> Section:
    further = (tables.ceiling_view(figures, split), *tables.head_views(figures, split),
               tables.pass_view(figures, split))  # fmt: skip
    pairs = (tables.pair_view(figures, split, name) for name in PAIRED)
    scores = (tables.score_view(figures, split, group) for group in ("error", "lips"))
    return Section(
        heading=tables.heading_of(split.result.name),
        about=split.result.about,
        summary=summarise(figures, split),
        scores=[view for view in scores if view.columns],
        further=[view for view in further if view is not None],
        pairs=[view for view in pairs if view is not None],
        dots=list(dot_plots(figures, split)),
        heat=heat_map(figures, split),
        traces=[
            trace_plot(figures.benchmark, split.result.name, number, curves)
            for number, curves in enumerate(split.result.curves, 1)
        ],
        split=split,
    )


def _facts(facts: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """Name and value of each plain fact, those within others by their path."""
    for key in sorted(facts, key=str):
        name, value = f"{path}{key}", facts[key]
        if isinstance(value, Mapping):
            yield from _facts(value, f"{name}: ")
        elif isinstance(value, list | tuple):
            yield name, ", ".join(map(str, value)) or "–"
        else:
            yield name, "–" if value is None else str(value)


def _bridge(figures: ReportFigures) -> list[tuple[str, str, str]]:
    """Title, value and unit of each of the bridge's own errors."""
    found = []
    for name, measure in MEASURES.items():
        if name in figures.bridge:
            scale = scale_of([figures.bridge[name].value])
            value = scale.shown(figures.bridge[name].value)
            found.append((measure.title, value, scale.unit(measure.unit)))
    return found


def _videos(benchmark: Benchmark, folder: Path) -> list[tuple[str, str]]:
    """Address and recording of the videos that lie in the folder."""
    known = {name for split in benchmark.splits for name in split.recordings}
    found = sorted((folder / VIDEOS).glob("*.mp4"))
    return [(quote(f"{VIDEOS}/{path.name}"), path.stem) for path in found if path.stem in known]


def _write_plots(environment: Any, sections: list[Section], folder: Path) -> None:
    """Each drawing as an SVG that stands alone, light or dark as the reader has it."""
    drawings = environment.get_template("drawings.svg").module
    style = environment.globals["styles"]["colours"]
    for section in sections:
        for plot in section.dots:
            _write(folder / f"{plot.name}.svg", str(drawings.draw_dots(plot, style)).strip() + "\n")
        if section.heat is not None:
            heat = str(drawings.draw_heat(section.heat, style)).strip()
            _write(folder / f"{section.heat.name}.svg", heat + "\n")
        for trace in section.traces:
            text = str(drawings.draw_trace(trace, style)).strip()
            _write(folder / f"{trace.name}.svg", text + "\n")
