"""What the benchmark finds, as values: `Benchmark`, of which the report is drawn."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from lipwright.evaluate.measures import Rows, Scores

Floats = npt.NDArray[np.float64]
Kind = Literal["learnt", "shipped", "rules", "peer", "curves", "real"]


@dataclass(frozen=True)
class Entry:
    """One that takes part: an engine, a peer, a folder of curves, or the real face itself."""

    name: str
    """short and unique, safe as a file's name: `window`, `hmm`, `openfacefx`"""
    title: str
    """for people"""
    kind: Kind
    """learnt: trained here on the recordings for training; shipped: a model that comes with
    Lipwright; real: the captured weights, which say how much of a figure is the ruler's fault"""
    about: str
    """a sentence: what it is, with its source"""
    bridged: bool
    """its errors against the reference face come through the map from weights to modes"""


@dataclass(frozen=True)
class Cost:
    """What an entry costs; None where it has no such thing. Differs from run to run."""

    model_bytes: int | None
    training_s: float | None
    """of the model that the test recordings are measured with"""
    real_time: float | None
    """s of speech animated in a second, model loaded, from phones and sound to curves at 60 fps"""


@dataclass(frozen=True, eq=False)
class Curves:
    """Apertures of one recording, to be drawn."""

    recording: str
    text: str
    phones: tuple[str, ...]
    edges: Floats
    """(P + 1,) s"""
    times: Floats
    """(T,) s, the video's frames"""
    real: Floats
    """(T,) of the tracked lips, over its 95th percentile; NaN where the face was lost"""
    estimated: Mapping[str, Floats]
    """entry to (T,), over its own 95th percentile, on our head"""


@dataclass(frozen=True, eq=False)
class Ceiling:
    """The speaker against himself: other takes of the same first words, warped by phone edges.

    All figures are over those words only.
    """

    words: int
    """first words that are shared: 4"""
    recordings: tuple[str, ...]
    """S' of the split that have such a partner"""
    partners: int
    """pairs in all"""
    own: Scores
    """the speaker: rows over `recordings`; each is the mean over its partners"""
    own_median_r: float
    """median of r over the pairs"""
    mean_of_takes: Scores
    """the mean of all partners' curves as an estimate, where there are two or more"""
    entries: Mapping[str, Scores]
    """every entry over the same words of the same recordings"""


@dataclass(frozen=True, eq=False)
class SplitResult:
    """All that was measured on one split."""

    name: Literal["test", "unseen"]
    about: str
    """a sentence: which recordings these are, and what the engines learnt from"""
    recordings: tuple[str, ...]
    """S names, the order of all rows"""
    frames: int
    speech_s: float
    scores: Mapping[str, Scores]
    """entry to rows of MEASURES; of the lips' measures those on the head where r is lower. A
    measure that an entry cannot have is not there"""
    by_head: Mapping[str, Mapping[str, Scores]]
    """head to entry to rows of the lips' measures"""
    bare: Mapping[str, Scores]
    """entry to rows of the lips' measures on our head without the passes that `animate` applies"""
    classes: Mapping[str, Mapping[str, Rows]]
    """entry to class of phones to its squared error in `joint_sd`; its counts are frames"""
    ceiling: Ceiling | None
    """None where no two recordings begin alike"""
    curves: tuple[Curves, ...]


@dataclass(frozen=True, eq=False)
class Benchmark:
    """The whole."""

    dataset: str
    licence: str
    seed: int
    facts: Mapping[str, Any]
    """what the figures depend on, as plain values: versions, hashes, options; no times"""
    entries: tuple[Entry, ...]
    """in the order of tables"""
    splits: tuple[SplitResult, ...]
    costs: Mapping[str, Cost]
    bridge: Scores
    """the real weights through the map from weights to modes, on the test split: its own error"""
    heads: tuple[str, ...]
    """our head, and the second one where there is one"""
