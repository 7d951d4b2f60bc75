"""Training of the hmm engine: states of phones in context, clustered by decision trees.

As HTS does it (Zen et al. 2007; Taylor et al. 2017, section 8.1): the states of each phone begin
of equal length; trees cluster them by context; then each phone's frames are dealt out anew, the
likeliest way, and clustered again. Phones keep their edges, which forced alignment gave them, as
they will when something is said. No library covers this: hmmlearn ties no states and takes no
edges.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from lipwright.engines.hmm import MIDDLE, PLACES, RATES, STATES, Forest, Voice
from lipwright.errors import LipwrightError
from lipwright.features import FeatureSet
from lipwright.features.known import seen_phones
from lipwright.phones import SILENCE
from lipwright.train.config import need
from lipwright.train.hmm_questions import Questions, all_questions, questions_of
from lipwright.train.hmm_states import Piece, align, evenly, pieces_of, scores_of
from lipwright.train.hmm_trees import Grown, Statistics, Stopping, grow, variances
from lipwright.train.learner import Fitted, LearnerConfig, Report, silence_first

if TYPE_CHECKING:
    from lipwright.train.takes import Corpus

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

LEAST_DEVIATION = 1e-4  # of a control in training; a leaf of one that never moves needs some


@dataclass(frozen=True, kw_only=True)
class HmmConfig(LearnerConfig):
    """How the hmm engine is trained."""

    rate: float = 200.0
    """frames a second of the states, 5 ms as in HTS; the video is interpolated to it"""
    least: int = 50
    """observations of a leaf, Taylor et al. 2017"""
    observation: Literal["frames", "video", "visits"] = "frames"
    """what an observation is: a frame of `rate`, as in HTS; as much of them as one frame of the
    video gave; or all of them in one visit of a state"""
    price: float = 1.0
    """of a number of a Gaussian, in those of the minimum description length; 1 is the criterion"""
    trees: Literal["state", "phone"] = "state"
    """one tree for each of the five states, or for each state of each phone"""
    rounds: int = 2
    """alignments after the first, even one"""
    floor: float = 0.01
    """the least variance, of that of all frames; that of HTS"""

    def __post_init__(self) -> None:
        """Check."""
        super().__post_init__()
        low, high = RATES
        need(low <= self.rate <= high, "rate", f"is {self.rate:g}, not {low:g} to {high:g}")
        need(1 <= self.least <= 10**6, "least", f"is {self.least}, not 1 to 1000000")
        need(0 <= self.price <= 1000, "price", f"is {self.price:g}, not 0 to 1000")
        need(0 <= self.rounds <= 20, "rounds", f"is {self.rounds}, not 0 to 20")
        need(0 < self.floor <= 1, "floor", f"is {self.floor:g}, not above 0 to 1")


CONFIG = HmmConfig


@dataclass(frozen=True, eq=False)
class Seen:
    """All that an alignment of the recordings says, of U contexts."""

    contexts: Indices
    """(U, 5)"""
    tables: Floats
    """(5, U, 1 + 2 * 3 C), of each state: frames, sums, sums of squares"""
    visits: Indices
    """(5,), of each state"""
    durations: Floats
    """(U, 1 + 2 * 5), s, of the states of whole phones"""


def fit(corpus: Corpus, config: HmmConfig, report: Report) -> Fitted:
    """Learn the model of a corpus.

    Raises:
        LipwrightError: no part of a recording is long enough to learn from, or nothing is said.
    """
    takes = corpus.of("train")
    phones = silence_first(config.phones or seen_phones(take.track for take in takes))
    if len(phones) < 2:
        raise LipwrightError(
            f"{corpus.path}: nothing but {SILENCE} is said in training; record speech, or name "
            "more 'phones'"
        )
    pieces = list(pieces_of(takes, phones))
    if not pieces:
        raise LipwrightError(
            f"{corpus.path}: no recording for training shows a face in 4 frames in a row; "
            "capture it again, or run: lipwright dataset split"
        )
    questions = questions_of(phones)
    voice: Voice | None = None
    for turn in range(config.rounds + 1):
        seen = look(pieces, config.rate, voice)
        voice = cluster(seen, questions, config, corpus.fps, phones)
        report("train", (turn + 1) / (config.rounds + 1))
    assert voice is not None
    features = FeatureSet(("raw",), 1, corpus.fps, phones)
    return Fitted("hmm", arrays_of(voice), features, notes_of(voice, questions, config, seen))


def look(pieces: list[Piece], rate: float, voice: Voice | None) -> Seen:
    """What is seen in each state of each context: states of equal length, or the likeliest."""
    contexts = np.unique(np.concatenate([piece.contexts for piece in pieces]), axis=0)
    number = {tuple(row): index for index, row in enumerate(contexts.tolist())}
    size = 3 * pieces[0].values.shape[1]
    tables = np.zeros((STATES, len(contexts), 1 + 2 * size))
    durations = np.zeros((len(contexts), 1 + 2 * STATES))
    visits = np.zeros(STATES, np.int64)
    for piece in pieces:
        frames = piece.frames(rate)
        scores = None if voice is None else scores_of(voice, piece, frames)
        flat = frames.reshape(len(frames), -1)
        for phone, first, stop in piece.visits(rate):
            if scores is None:
                states = evenly(stop - first)
            else:
                states = align(scores[first:stop, STATES * phone : STATES * (phone + 1)])
            lasted = np.bincount(states, minlength=STATES)
            context = number[tuple(piece.contexts[phone].tolist())]
            held = np.flatnonzero(lasted)
            rows = flat[first:stop]
            marks = np.searchsorted(states, held)
            tables[held, context, 0] += lasted[held]
            tables[held, context, 1 : 1 + size] += np.add.reduceat(rows, marks)
            tables[held, context, 1 + size :] += np.add.reduceat(rows**2, marks)
            visits += lasted > 0
            spans = lasted / rate
            durations[context] += np.concatenate(([1.0], spans, spans**2))
    return Seen(contexts, tables, visits, durations)


def cluster(
    seen: Seen, questions: Questions, config: HmmConfig, fps: float, phones: tuple[str, ...]
) -> Voice:
    """The models of what was seen."""
    count = len(phones)
    whole = seen.tables.sum(axis=(0, 1))
    size = (len(whole) - 1) // 2
    _, spread = variances(whole, np.full(size, LEAST_DEVIATION**2))
    floor = config.floor * spread
    states, roots = Grown(questions), np.zeros((STATES, count), np.int64)
    for state, table in enumerate(seen.tables):
        weight = {
            "frames": 1.0, "video": min(fps / config.rate, 1.0),
            "visits": seen.visits[state] / max(table[:, 0].sum(), 1.0),
        }[config.observation]  # fmt: skip
        stopping = Stopping(config.least, float(weight), config.price)
        for chosen in _groups(seen.contexts, config.trees, count):
            rows = np.flatnonzero(np.isin(seen.contexts[:, MIDDLE], chosen) & (table[:, 0] > 0))
            data = Statistics(seen.contexts[rows], table[rows])
            roots[state, chosen] = grow(states, data, floor, stopping)
    mean, variance = variances(np.array(states.leaves), floor)
    lengths = Grown(questions)
    least = np.full(STATES, (0.5 / config.rate) ** 2)  # a state lasts a whole number of frames
    tree = grow(lengths, Statistics(seen.contexts, seen.durations), least,
                Stopping(config.least, 1.0, config.price))  # fmt: skip
    spans, _ = variances(np.array(lengths.leaves), least)
    shape = (-1, 3, size // 3)
    return Voice(
        phones, config.rate, states.forest, roots, mean.reshape(shape), 1 / variance.reshape(shape),
        lengths.forest, np.full(count, tree), np.maximum(spans, 0.1 / config.rate),
    )  # fmt: skip


def _groups(contexts: Indices, trees: str, phones: int) -> list[Indices]:
    """The phones that share a tree."""
    every = np.arange(phones)
    if trees == "state":
        return [every]
    heard = np.isin(every, contexts[:, MIDDLE])
    # One that never occurs, but is named in the configuration, is taken for silence.
    return [np.append(0, every[~heard]) if phone == 0 else every[phone : phone + 1]
            for phone in every if heard[phone] or phone == 0]  # fmt: skip


def arrays_of(voice: Voice) -> dict[str, npt.NDArray[Any]]:
    """The arrays of model.npz."""
    return {
        "rate": np.array([voice.rate], np.float64),
        "means": voice.means.astype(np.float32),
        "deviations": (voice.precisions**-0.5).astype(np.float32),
        "durations": voice.durations.astype(np.float32),
        "state_roots": voice.roots.astype(np.int32),
        "duration_roots": voice.length_roots.astype(np.int32),
        **_arrays_of_forest("state", voice.states),
        **_arrays_of_forest("duration", voice.lengths),
    }


def _arrays_of_forest(name: str, forest: Forest) -> dict[str, npt.NDArray[Any]]:
    return {
        f"{name}_place": forest.place.astype(np.int8),
        f"{name}_members": forest.members,
        f"{name}_branches": forest.branches.astype(np.int32),
        f"{name}_leaf": forest.leaf.astype(np.int32),
    }


def notes_of(voice: Voice, questions: Questions, config: HmmConfig, seen: Seen) -> tuple[str, ...]:
    """Lines for the card."""
    frames = int(seen.tables[..., 0].sum())
    return (
        f"{len(voice.means)} leaves of {STATES} states, {len(voice.durations)} of durations, of "
        f"{len(seen.contexts)} quinphones; {frames} frames of {1000 / config.rate:g} ms, "
        f"{int(seen.visits.sum())} visits of states",
        f"{len(all_questions())} questions about {PLACES} phones, of which {len(questions)} differ "
        "in the phones heard",
        f"minimum description length times {config.price:g}, leaves of at least {config.least} "
        f"observations ({config.observation}), {config.rounds} alignments",
    )
