"""A planted benchmark: random rows of five who take part, two splits, ceiling and curves."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from lipwright.benchmark.values import Benchmark, Ceiling, Cost, Curves, Entry, SplitResult
from lipwright.evaluate.measures import MEASURES, Rows, Scores

NAMES = ("lipwright", "window", "trees", "dominance", "captured")
ENTRIES = (
    Entry("lipwright", "Lipwright", "learnt", "The default network.", False),
    Entry("window", "sliding-window network", "learnt", "Taylor et al. 2017.", False),
    Entry("trees", "decision trees", "learnt", "Kim et al. 2015.", False),
    Entry("dominance", "dominance functions", "rules", "Cohen and Massaro 1993.", True),
    Entry("captured", "the real face", "real", "The captured weights.", True),
)
HEADS = ("our head", "ICT-FaceKit")
LIPS = tuple(name for name, measure in MEASURES.items() if measure.group == "lips")
CLASSES = ("velar", "silence", "bilabial", "open vowel", "close vowel", "dental", "glide")
LEVELS: Mapping[str, float] = {
    "joint_sd": 0.8, "joint": 41.0, "shape": 0.02, "vertices": 0.00062, "inner": 140.0,
    "outer": 31.0, "face_r": 0.91, "r": 0.86, "r_best_lag": 0.89, "lag": 12.0, "closures": 0.82,
    "false_closures": 0.21, "silence": 0.08,
}  # fmt: skip


def planted_rows(random: Any, level: float, count: int) -> Rows:
    """Rows about `level`, one of them of a recording that has none."""
    counts = random.integers(30, 60, count).astype(float)
    counts[0] = 0
    return Rows(counts * level * random.normal(1, 0.15, count), counts)


def planted_scores(random: Any, names: tuple[str, ...], count: int, worse: float) -> Scores:
    factors = {name: 1 / worse if MEASURES[name].better == "higher" else worse for name in names}
    return {name: planted_rows(random, LEVELS[name] * factors[name], count) for name in names}


def planted_curves(random: Any, recording: str) -> Curves:
    times = (np.arange(75) + 0.5) / 25
    real = np.abs(np.sin(times * 5)) * (times > 0.4) * (times < 2.5)
    estimated = {name: np.abs(real + random.normal(0, 0.06, 75)) for name in NAMES}
    real[40:44] = np.nan
    phones = ("sil", "B", "IH", "N", "B", "L", "UW", "sil")
    edges = np.array([0, 0.5, 0.6, 0.9, 1.1, 1.2, 1.3, 2.4, 3.0])
    return Curves(recording, "bin blue", phones, edges, times, real, estimated)


def planted_split(
    name: Any, *, count: int = 20, seed: int = 0, ceiling: bool = True
) -> SplitResult:  # fmt: skip
    random = np.random.default_rng(seed)
    recordings = tuple(f"rec{i:02d}" for i in range(count))
    worse = {entry: 1 + 0.12 * i for i, entry in enumerate(NAMES)}
    scores = {
        entry: planted_scores(random, tuple(MEASURES), count, worse[entry]) for entry in NAMES
    }
    lips = {entry: planted_scores(random, LIPS, count, worse[entry]) for entry in NAMES}
    bare = {entry: lips[entry] for entry in NAMES[:4]}
    classes = {
        entry: {kind: planted_rows(random, 1.4 - 0.15 * i * worse[entry], count)
                for i, kind in enumerate(CLASSES)} for entry in NAMES
    }  # fmt: skip
    own = Ceiling(
        4, recordings[:12], 31,
        {key: planted_rows(random, 0.93, 12) for key in ("r", "face_r")}, 0.941,
        {"r": planted_rows(random, 0.95, 12)},
        {entry: {key: planted_rows(random, 0.84 / worse[entry], 12) for key in ("r", "face_r")}
         for entry in NAMES},
    )  # fmt: skip
    return SplitResult(
        name, f"{count} recordings; learnt from 780 others", recordings, 75 * count, 2.1 * count,
        scores, dict.fromkeys(HEADS, lips), bare, classes, own if ceiling else None,
        tuple(planted_curves(random, recording) for recording in recordings[:2]),
    )  # fmt: skip


def planted_benchmark() -> Benchmark:
    random = np.random.default_rng(9)
    costs = {
        "lipwright": Cost(3_400_000, 812.5, 61.25), "window": Cost(62_000_000, 480.0, 22.5),
        "trees": Cost(99_000, 31.2, 140.0), "dominance": Cost(None, None, 900.0),
    }  # fmt: skip
    return Benchmark(
        "GRID speaker 1", "CC BY 4.0, Cooke et al. 2006", 0,
        {"lipwright": "0.1.0", "face": {"hash": "ab12"}, "quick": False}, ENTRIES,
        (planted_split("test"), planted_split("unseen", seed=1, count=9)), costs,
        {key: planted_rows(random, LEVELS[key] / 3, 20) for key in ("joint_sd", "vertices")}, HEADS,
    )  # fmt: skip
