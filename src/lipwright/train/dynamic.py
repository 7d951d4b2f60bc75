"""Training of dynamic visemes: gestures, their clusters, their phone strings, weights of costs.

After Taylor et al. (2012), as Taylor et al. (2017), section 8.1, and the thesis of 2018, 3.2.1,
describe it. The paper clusters gestures by hidden Markov models; here they are stretched to one
length and clustered by k-means. Strings that were never heard are said by parts of gestures.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Final, Literal

import numpy as np
import numpy.typing as npt

from lipwright.engines.dynamic import curves, pieces
from lipwright.engines.dynamic_speech import PARTS
from lipwright.engines.dynamic_units import Units, Weights, make_units
from lipwright.errors import LipwrightError
from lipwright.features import FeatureSet
from lipwright.features.known import seen_phones
from lipwright.phones import SILENCE
from lipwright.train.config import need
from lipwright.train.dynamic_gestures import Gesture, gestures_of, visible_weights
from lipwright.train.dynamic_strings import unit_arrays
from lipwright.train.learner import Fitted, LearnerConfig, Report, silence_first
from lipwright.train.takes import Corpus, Take

Floats = npt.NDArray[np.float64]

ROUNDS: Final = 2  # over all weights, each time with the best of the others


@dataclass(frozen=True, kw_only=True)
class DynamicConfig(LearnerConfig):
    """How gestures are found, clustered and chosen.

    Raises:
        MisfitError: a value is out of range.
    """

    clusters: int = 150
    """dynamic visemes (thesis 3.2.1); as many as gestures, if there are fewer of those"""
    prototype: Literal["mean", "median", "exemplar"] = "mean"
    """what stands for a cluster: the mean or median of its gestures at each moment, or that
    gesture which is nearest to the mean"""
    smooth_s: float = 0.03
    """s, the deviation of the Gaussian that smooths motion before it is cut"""
    shortest_s: float = 0.1
    """s, between two cuts"""
    dimensions: int = 40
    """of gestures when they are clustered: their first principal components"""
    starts: int = 4
    """of k-means, of which the best is kept"""
    candidates: int = 8
    """clusters that are tried for a phone string, the most frequent ones"""
    smoothness: tuple[float, ...] = (4.0,)
    """weights to try of squared jumps between gestures, over the variance of the face"""
    rate: tuple[float, ...] = (4.0,)
    """weights to try of the squared logarithm of how much a gesture is stretched"""
    cut: tuple[float, ...] = (1.0,)
    """costs to try of each end that is cut inside a gesture"""
    alike: tuple[float, ...] = (2.0,)
    """costs to try of each phone that only looks like the one that is said"""

    features: ClassVar[tuple[str, ...]] = ("raw",)

    def __post_init__(self) -> None:
        """Check."""
        super().__post_init__()
        need(2 <= self.clusters <= 100_000, "clusters", "must be 2 to 100000")
        need(0 <= self.smooth_s <= 1, "smooth_s", "must be 0 to 1 s")
        need(0 <= self.shortest_s <= 1, "shortest_s", "must be 0 to 1 s")
        need(1 <= self.dimensions <= 1000, "dimensions", "must be 1 to 1000")
        need(1 <= self.starts <= 100, "starts", "must be 1 to 100")
        need(1 <= self.candidates <= 1000, "candidates", "must be 1 to 1000")
        for name in ("smoothness", "rate", "cut", "alike"):
            values = getattr(self, name)
            need(bool(values), name, "must have a value to try")
            need(all(0 <= value <= 1000 for value in values), name, "must be 0 to 1000")


CONFIG = DynamicConfig


def fit(corpus: Corpus, config: DynamicConfig, report: Report) -> Fitted:
    """Learn dynamic visemes; as `lipwright.train.learner.Fit`.

    Raises:
        LipwrightError: fewer than two gestures are found.
    """
    takes = corpus.of("train")
    frames = np.concatenate([take.targets[take.valid] for take in takes])
    visible = visible_weights(corpus.controls, frames.std(axis=0, dtype=np.float64))
    phones, gestures = _gestures(corpus, config, visible)
    report("train", 0.2)
    labels = cluster(gestures, visible, config)
    report("train", 0.5)
    prototypes = _prototypes(gestures, labels, visible, config.prototype)
    rest = np.repeat(_rest(takes)[None, None], prototypes.shape[1], axis=1)
    arrays = {
        "gestures": np.concatenate([rest, prototypes]).astype(np.float32),
        "visible": visible.astype(np.float32),
        "weights": np.zeros(4, np.float32),
        **unit_arrays(gestures, labels.tolist(), len(phones), config.candidates),
    }
    units = make_units(arrays, phones)
    weights, tries = tuned(units, corpus, config)
    chosen = [weights.smoothness, weights.rate, weights.cut, weights.alike]
    arrays["weights"] = np.array(chosen, np.float32)
    report("train", 1.0)
    notes = (*_notes(gestures, labels, corpus.fps), *tries)
    return Fitted("dynamic", arrays, FeatureSet(("raw",), 1, corpus.fps, phones), notes)


def _gestures(
    corpus: Corpus, config: DynamicConfig, visible: Floats
) -> tuple[tuple[str, ...], list[Gesture]]:
    """The phones that gestures say all of, and the gestures."""
    takes = corpus.of("train")
    phones = silence_first(config.phones or seen_phones(take.track for take in takes))
    while True:
        found = [
            gesture
            for take in takes
            for gesture in gestures_of(
                take, visible, phones, corpus.fps, config.smooth_s, config.shortest_s
            )
        ]
        said = _said(found)
        heard = tuple(phone for index, phone in enumerate(phones)
                      if phone == SILENCE or index in said)  # fmt: skip
        if heard == phones:
            break
        phones = heard
    if len(found) < 2:
        raise LipwrightError(
            f"{corpus.path}: has {len(found)} gestures for training; more recordings with speech "
            "and a face in them are needed"
        )
    return phones, found


def _said(gestures: Sequence[Gesture]) -> set[int]:
    """The phones whose every part is in some gesture."""
    parts = {
        (gesture.phones[joint // PARTS], joint % PARTS)
        for gesture in gestures
        for joint in range(gesture.part, gesture.part + len(gesture.marks) - 1)
    }
    return {phone for phone, _ in parts if all((phone, part) in parts for part in range(PARTS))}


def cluster(
    gestures: Sequence[Gesture], visible: Floats, config: DynamicConfig
) -> npt.NDArray[np.intp]:
    """The cluster of each gesture, by how the visible articulators move over its own time."""
    seen = np.stack([(g.poses * visible)[:, visible > 0].ravel() for g in gestures])
    if config.clusters >= len(gestures):
        return np.arange(len(gestures))
    from sklearn.cluster import KMeans
    from sklearn.decomposition import PCA
    from sklearn.exceptions import ConvergenceWarning
    from threadpoolctl import threadpool_limits

    # Sums in another order give other clusters; faces that repeat themselves give fewer.
    with threadpool_limits(1), warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)
        dimensions = min(config.dimensions, *seen.shape)
        shapes = PCA(dimensions, svd_solver="full", random_state=0).fit_transform(seen)
        means = KMeans(config.clusters, n_init=config.starts, random_state=config.seed)
        labels = means.fit(shapes).labels_
    _, dense = np.unique(labels, return_inverse=True)
    return np.asarray(dense, np.intp)


def _prototypes(
    gestures: Sequence[Gesture], labels: npt.NDArray[np.intp], visible: Floats, kind: str
) -> npt.NDArray[np.float32]:
    """(G, N, C), one gesture for each cluster."""
    found = []
    order = np.argsort(labels, kind="stable")
    for members in np.split(order, np.flatnonzero(np.diff(labels[order])) + 1):
        poses = np.stack([gestures[member].poses for member in members])
        if kind == "median":
            found.append(np.median(poses, axis=0))
            continue
        mean = poses.mean(axis=0, dtype=np.float64)
        if kind == "exemplar":
            apart = np.square((poses - mean) * visible).sum(axis=(1, 2))
            mean = poses[int(apart.argmin())]
        found.append(mean)
    return np.stack(found).astype(np.float32)


def _rest(takes: Sequence[Take]) -> Floats:
    """(C,), the mean pose in silence, or of all frames where nobody is silent."""
    silent, every = [], []
    for take in takes:
        place = np.searchsorted(take.track.edges, take.times, "right") - 1
        phones = np.array([*take.track.phones, SILENCE])[np.clip(place, -1, len(take.track))]
        silent.append(take.targets[take.valid & (phones == SILENCE)])
        every.append(take.targets[take.valid])
    frames = np.concatenate(silent)
    return np.asarray((frames if len(frames) else np.concatenate(every)).mean(axis=0, dtype=float))


def tuned(units: Units, corpus: Corpus, config: DynamicConfig) -> tuple[Weights, tuple[str, ...]]:
    """The best weights for the recordings for validation, one after the other; what was tried."""
    names = ("smoothness", "rate", "cut", "alike")
    best = Weights(*(getattr(config, name)[0] for name in names))
    if all(len(getattr(config, name)) == 1 for name in names):
        return best, ()
    errors: dict[tuple[float, ...], float] = {}

    def error(weights: Weights) -> float:
        key = tuple(getattr(weights, name) for name in names)
        if key not in errors:
            errors[key] = error_of(replace(units, weights=weights), corpus.of("validation"))
        return errors[key]

    for _ in range(ROUNDS):
        for name in names:
            tries = [replace(best, **{name: value}) for value in getattr(config, name)]
            best = min(tries, key=error)
    lines = (
        f"weights {', '.join(f'{name} {value:g}' for name, value in zip(names, key, strict=True))}"
        f": error {value:.4f}"
        for key, value in errors.items()
    )
    return best, tuple(lines)


def error_of(units: Units, takes: Sequence[Take]) -> float:
    """Mean squared error of the controls of takes, each over its standard deviation."""
    spread = np.concatenate([take.targets[take.valid] for take in takes]).std(axis=0)
    spread = np.where(spread > 0, spread, 1.0)
    total, count = 0.0, 0
    for take in takes:
        made = curves(units, pieces(units, take.track), take.times)
        apart = ((made - take.targets) / spread)[take.valid]
        total, count = total + float(np.square(apart).sum()), count + apart.size
    return total / count


def _notes(gestures: Sequence[Gesture], labels: npt.NDArray[np.intp], fps: float) -> Iterator[str]:
    lengths = np.array([gesture.frames / fps for gesture in gestures])
    spans: dict[int, list[Any]] = {}
    for gesture, label in zip(gestures, labels.tolist(), strict=True):
        spans.setdefault(label, []).append(len(gesture.phones))
    usual = np.array([np.median(counts) for counts in spans.values()])
    wide, joined = (100 * np.mean(usual > phones) for phones in (2, 1))
    yield f"{len(gestures)} gestures, {np.median(lengths):.3f} s long in the median"
    yield (
        f"{len(spans)} clusters; the median gesture of {joined:.0f} % says two phones or more, "
        f"whole or in part, of {wide:.0f} % more than two"
    )
