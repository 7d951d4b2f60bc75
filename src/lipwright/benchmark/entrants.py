"""Who takes part in the benchmark: every engine, as it is trained or as it ships."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from lipwright.benchmark.options import BenchmarkOptions
from lipwright.benchmark.peers import EXTRA, PEERS
from lipwright.benchmark.values import Kind
from lipwright.engines import DEFAULT_MODEL, ENGINES, OF_BIGRAMS
from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.network import ModelMeta, find_model
from lipwright.network.folder import read_meta
from lipwright.network.meta import TARGETS
from lipwright.pipeline import AnimateOptions
from lipwright.pipeline.options import rig_of

REAL: Final = "captured"


@dataclass(frozen=True)
class Entrant:
    """One that takes part."""

    name: str
    title: str
    kind: Kind
    about: str
    engine: str | None = None
    """of the registry; None for what has none"""
    model: str | None = None
    """that ships, or was named; None for one that is trained here"""
    config: str | None = None
    """of its training"""
    full: Mapping[str, Any] = field(default_factory=dict)
    """what the benchmark changes of the configuration"""
    quick: Mapping[str, Any] = field(default_factory=dict)
    """what a quick run changes besides"""
    folder: Path | None = None
    """of its curves"""


def _usual() -> Iterator[Entrant]:
    yield Entrant(
        "lipwright", "Lipwright", "learnt",
        "The default network's configuration, trained here: gated convolutions that also hear.",
        "window", config="lipwright",
        quick={"epochs": 10, "network.layers": [32] * 6, "augment.voices": [0.9, 1.1]},
    )  # fmt: skip
    yield Entrant(
        "default", "Lipwright, as it ships", "shipped",
        "The model that comes with Lipwright, with ARKit weights only.",
        "window", model=DEFAULT_MODEL,
    )  # fmt: skip
    yield Entrant(
        "window", "sliding-window network", "learnt",
        "Taylor et al. 2017: fully connected, 3 times 3000 units, windows of 11 and 5 frames.",
        # More passes bring little: at the end of a falling rate the error falls by 0.02 % a pass.
        "window", config="window", full={"epochs": 4},
        quick={"epochs": 10, "network.layers": [200, 200]},
    )  # fmt: skip
    yield Entrant(
        "trees", "decision trees", "learnt",
        "Kim et al. 2015: regression trees over a sliding window of 11 and 5 frames.",
        "trees", config="trees",
    )  # fmt: skip
    yield Entrant(
        "hmm", "HMM synthesis", "learnt",
        "Zen et al. 2007: clustered states of phones in context, smoothest likely trajectory.",
        "hmm", config="hmm",
    )  # fmt: skip
    yield Entrant(
        "lstm", "LSTM", "learnt",
        "Fan et al. 2015: one fully connected and two bidirectional LSTM layers of 500.",
        "lstm", config="lstm", quick={"epochs": 20, "network.layers": [64, 64, 64]},
    )  # fmt: skip
    yield Entrant(
        "dynamic", "dynamic visemes", "learnt",
        "Taylor et al. 2012: recorded gestures of 150 kinds, strung together by search.",
        "dynamic", config="dynamic",
    )  # fmt: skip
    yield Entrant(
        "bigram", "phone bigrams", "rules",
        "Xu et al. 2013: curves for pairs of phones, of the set that ships.",
        "bigram",
    )  # fmt: skip
    yield Entrant(
        "dominance", "dominance functions", "rules",
        "Cohen and Massaro 1993: weighted targets, fitted on the training sentences of GRID s1.",
        "dominance",
    )  # fmt: skip
    yield Entrant(
        "overlay", "vowels with consonants laid over", "rules",
        "The thesis's baseline (2018, 4.6.4): eased vowels, consonant visemes over them.",
        "overlay",
    )  # fmt: skip
    yield Entrant(
        "static", "static visemes", "rules",
        "One pose a viseme, straight lines between them.", "static",
    )  # fmt: skip


USUAL: Final[Mapping[str, Entrant]] = MappingProxyType({one.name: one for one in _usual()})
"""name to entrant, in the order of tables"""

FURTHER: Final[Mapping[str, Entrant]] = MappingProxyType({
    "thesis": Entrant(
        "thesis", "the thesis's network", "learnt",
        "The thesis's network (2018, 4.3): 338 and 270 units, windows of 15 frames.",
        "window", config="thesis", full={"epochs": 20},
        quick={"epochs": 2, "network.layers": [100, 80]},
    ),
})  # fmt: skip
"""those that only take part by name"""

CAPTURED: Final = Entrant(
    REAL, "the real face", "real",
    "The captured weights themselves, put on the heads: what a perfect engine of weights reaches.",
)  # fmt: skip


def choose_entrants(options: BenchmarkOptions) -> tuple[Entrant, ...]:
    """Everybody that is asked for, and the real face at the end.

    Raises:
        LipwrightError: a name is unknown, two have the same, or a model that was named cannot be
            used.
        MissingExtraError: a peer that was named is not installed.
    """
    chosen = [*_named(options.engines), *_models(options), *_folders(options), CAPTURED]
    names = [one.name for one in chosen]
    for name in names:
        if names.count(name) > 1:
            raise LipwrightError(f"two take part as {name!r}; give one another name")
    return tuple(chosen)


def _named(names: tuple[str, ...]) -> Iterator[Entrant]:
    peers = {name: Entrant(name, peer.title, "peer", peer.about) for name, peer in PEERS.items()}
    known = {**USUAL, **FURTHER, **peers}
    found: dict[str, Entrant] = {}
    for name in names:
        if name == "all":
            here = {key: peer for key, peer in peers.items() if find_spec(PEERS[key].package)}
            found |= {**USUAL, **here}
        elif name in PEERS and not find_spec(PEERS[name].package):
            raise MissingExtraError(PEERS[name].title, EXTRA)
        elif name in known:
            found[name] = known[name]
        else:
            raise LipwrightError(f"no entrant {name!r}; they are: all, {', '.join(known)}")
    yield from found.values()


def _models(options: BenchmarkOptions) -> Iterator[Entrant]:
    for name, model in options.models:
        check_name(name)
        if os.path.isfile(model):  # noqa: PTH113  # of any text, also one too long for a path
            _check_bigrams(model)
            yield Entrant(name, name, "rules", "A bigram set that was named.", OF_BIGRAMS, model)
            continue
        meta = _meta_of(model)
        about = f"A model that was named: {meta.name}, learnt from {meta.data}."
        yield Entrant(name, name, "shipped", about, meta.engine, model)


def _check_bigrams(path: str) -> None:
    """Refuse a bigram set that moves no human face."""
    bigrams = AnimateOptions(bigrams=path).bigram_set
    assert bigrams is not None
    if not rig_of(bigrams).looks:
        raise LipwrightError(
            f"{path}: is a bigram set for the rig {bigrams.rig!r}, which has no looks on a human "
            "face; leave it out"
        )


def _meta_of(model: str) -> ModelMeta:
    """What a model says of itself, after it was opened."""
    folder = find_model(model)
    meta = read_meta(folder)
    import_module(ENGINES[meta.engine].module).open_network(folder)
    if not meta.moves_heads:
        raise LipwrightError(
            f"{model}: predicts {TARGETS[meta.target]} alone, and moves no head; train it with "
            "--targets both, or give its curves with --curves"
        )
    return meta


def _folders(options: BenchmarkOptions) -> Iterator[Entrant]:
    for name, folder in options.curves:
        check_name(name)
        yield Entrant(name, name, "curves", "Curves that were given.", folder=folder)


def check_name(name: str) -> None:
    """Refuse a name that could not be a file's.

    Raises:
        LipwrightError: it is such a name.
    """
    if not name or len(name) > 40 or not all(c.isalnum() or c in "-_" for c in name):
        raise LipwrightError(
            f"{name!r} is no name for somebody who takes part; use letters, digits, - and _"
        )
