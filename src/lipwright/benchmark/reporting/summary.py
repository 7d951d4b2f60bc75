"""What a benchmark found, in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator

from lipwright.benchmark.reporting.figures import ReportFigures, SplitFigures
from lipwright.benchmark.reporting.numbers import scale_of, shown_p
from lipwright.benchmark.reporting.tables import ALPHA
from lipwright.evaluate.measures import MEASURES


def summarise(figures: ReportFigures, split: SplitFigures) -> list[str]:
    """A sentence for each measure, one for the ceiling and one for the hardest phones."""
    found = [_best(figures, split, name) for name in MEASURES]
    return [*filter(None, found), *_ceiling(figures, split), *_hardest(figures, split)]


def _best(figures: ReportFigures, split: SplitFigures, name: str) -> str:
    best = figures.best(split.scores, name)
    if best is None:
        return ""
    titles = {entry.name: entry.title for entry in figures.benchmark.entries}
    measure, figure = MEASURES[name], split.scores[best][name]
    scale = scale_of((figure.value, figure.low, figure.high))
    unit = scale.unit(measure.unit)
    ends = scale.interval(figure)
    value = f"{scale.shown(figure.value)}{f' {unit}' if unit else ''}{f' ({ends})' if ends else ''}"
    words = {"lower": "lowest", "higher": "highest", "zero": "nearest to 0"}[measure.better]
    sentence = f"{_upper(measure.title)}: {titles[best]} is {words} with {value}"
    others = [other for other in titles
              if other != best and split.pair(name, best, other) is not None]  # fmt: skip
    alike = [other for other in others if not _differ(split, name, best, other)]
    if not others:
        return f"{sentence}; nobody else has it."
    if not alike:
        ps = [pair.p_holm for other in others if (pair := split.pair(name, best, other))]
        return f"{sentence}; every other entry differs from it (p {shown_p(max(ps))} or less)."
    if len(alike) == len(others):
        return f"{sentence}; no other entry can be told from it."
    return f"{sentence}; it cannot be told from {_listed([titles[one] for one in alike])}."


def _differ(split: SplitFigures, name: str, first: str, second: str) -> bool:
    pair = split.pair(name, first, second)
    return pair is not None and pair.p_holm < ALPHA


def _ceiling(figures: ReportFigures, split: SplitFigures) -> Iterator[str]:
    found, made = split.result.ceiling, split.ceiling
    if found is None or made is None or "r" not in made.own:
        yield "No ceiling: no two recordings begin with the same words."
        return
    own, best = made.own["r"].value, figures.best(made.entries, "r")
    if not math.isfinite(own):
        return
    sentence = (
        f"The ceiling: over the first {found.words} words of {len(found.recordings)} recordings "
        f"the speaker follows himself with r {own:.3f} ({found.partners} pairs, median "
        f"{found.own_median_r:.3f})"
    )
    if best is not None:
        title = next(one.title for one in figures.benchmark.entries if one.name == best)
        sentence += f"; {title}, the best there, with r {made.entries[best]['r'].value:.3f}"
    yield f"{sentence}."


def _hardest(figures: ReportFigures, split: SplitFigures) -> Iterator[str]:
    means = class_means(figures, split)
    if len(means) > 2:
        ordered = sorted(means, key=lambda name: -means[name])
        scale = scale_of(means.values())
        hard = _listed([f"{name} ({scale.shown(means[name])})" for name in ordered[:3]])
        yield (
            f"Hardest phones, on average over the engines: {hard} sd²; easiest: {ordered[-1]} "
            f"({scale.shown(means[ordered[-1]])})."
        )


def class_means(figures: ReportFigures, split: SplitFigures) -> dict[str, float]:
    """Class of phones to the mean of its error over the entries but the real face."""
    found: dict[str, list[float]] = {}
    for entry in figures.benchmark.entries:
        if entry.kind != "real":
            for name, figure in split.classes.get(entry.name, {}).items():
                if math.isfinite(figure.value):
                    found.setdefault(name, []).append(figure.value)
    return {name: sum(values) / len(values) for name, values in found.items()}


def _listed(words: list[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def _upper(words: str) -> str:
    """The first letter large, but for names of figures such as r."""
    return words if words[:2] == "r " else words[:1].upper() + words[1:]
