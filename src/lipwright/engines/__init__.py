"""Engines: PhoneTrack to Clip. Each is one module, registered here by name."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, Literal, Protocol, TypeAlias, cast

from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.audio import Sound
    from lipwright.bigrams.values import BigramSet
    from lipwright.clip import Clip
    from lipwright.engines.learnt import Learnt
    from lipwright.track import PhoneTrack

DEFAULT: Final = "window"
DEFAULT_MODEL: Final = "lipwright"  # of the engines that run networks
OF_MODELS: Final = "window"  # the engine that a model without an engine means
OF_BIGRAMS: Final = "bigram"  # the engine that a bigram set means

Runs = Literal["rules", "models", "bigrams"]
Model: TypeAlias = "str | Path | BigramSet | None"
"""the name of a model that ships, or a model's folder; or a bigram set, its name or its file"""


class Engine(Protocol):
    """What every engine does."""

    def __call__(self, track: PhoneTrack, fps: float, audio: Sound | None = None) -> Clip:
        """The motion that says `track`, from 0 s to its end.

        Args:
            track: phones with times.
            fps: frames a second of the clip.
            audio: the sound, for engines that listen to it.
        """
        ...


@dataclass(frozen=True)
class EngineEntry:
    """A row of the registry."""

    module: str
    """imported when the engine is asked for; has a function `animate` with Engine's signature"""
    summary: str
    """one line for lists"""
    runs: Runs = "rules"
    """for models and bigrams `animate` takes `model` too: a model's name or folder, or the name or
    file of a bigram set. Modules that run models have `open_network(model)`, and `predict_at(model,
    track, times, audio)`: all that the model predicts, (T, C) of its own controls"""
    ships: bool = True
    """whether it works as it comes; else a model has to be trained and named"""


ENGINES: Final = MappingProxyType(
    {
        "dominance": EngineEntry(
            "lipwright.engines.dominance",
            "dominance functions (Cohen and Massaro 1993), targets fitted to a real speaker",
        ),
        "window": EngineEntry(
            "lipwright.engines.window",
            "a network over a sliding window (Taylor et al. 2017), trained on real speakers",
            runs="models",
        ),
        "hmm": EngineEntry(
            "lipwright.engines.hmm",
            "hidden Markov models of phones in context (Zen et al. 2007); train your own",
            runs="models",
            ships=False,
        ),
        "dynamic": EngineEntry(
            "lipwright.engines.dynamic",
            "recorded gestures (dynamic visemes, Taylor et al. 2012); train your own",
            runs="models",
            ships=False,
        ),
        "lstm": EngineEntry(
            "lipwright.engines.lstm",
            "a recurrent network (Fan et al. 2015); train your own",
            runs="models",
            ships=False,
        ),
        "trees": EngineEntry(
            "lipwright.engines.trees",
            "decision trees over a sliding window (Kim et al. 2015); train your own",
            runs="models",
            ships=False,
        ),
        "overlay": EngineEntry(
            "lipwright.engines.overlay",
            "vowels eased into each other, consonants laid over them (the 2018 thesis)",
        ),
        "static": EngineEntry(
            "lipwright.engines.static",
            "one pose a viseme, straight lines between them",
        ),
        "bigram": EngineEntry(
            "lipwright.engines.bigram",
            "curves drawn for pairs of phones (Xu et al. 2013), on any set of poses",
            runs="bigrams",
        ),
    }
)
"""name to engine; a new engine is one module and one row"""


def choose_engine(name: str | None = None, model: Model = None) -> str:
    """The engine that is meant: that of the name, or that of models, or the default.

    Raises:
        LipwrightError: no such engine, or one of rules alone was given a model.
    """
    chosen = name or (DEFAULT if model is None else _engine_of(model))
    if chosen not in ENGINES:
        raise LipwrightError(f"no engine {chosen!r}; the engines are: {', '.join(ENGINES)}")
    if model is not None and ENGINES[chosen].runs == "rules":
        *most, last = (known for known, entry in ENGINES.items() if entry.runs != "rules")
        runners = f"{', '.join(most)} and {last}"
        raise LipwrightError(
            f"--model is for the engines {runners}, not for {chosen}; leave one of them out"
        )
    return chosen


def _engine_of(model: Model) -> str:
    """The engine of a model that was named without one; opening it says what may be wrong."""
    from lipwright.network.folder import find_model, read_meta

    if not isinstance(model, str | Path):
        return OF_MODELS
    try:
        return read_meta(find_model(model)).engine
    except LipwrightError:
        return OF_MODELS


def get_engine(name: str | None = None, model: Model = None) -> Engine:
    """The engine of that name, with a model where it runs one.

    Args:
        name: of ENGINES; by default that of models where one is given, or else the default.
        model: the name of a model that ships, or a model's folder; or the name or file of a
            bigram set, for the engine of those.

    Raises:
        LipwrightError: no such engine, lists the known ones; or it has only rules.
    """
    entry = ENGINES[choose_engine(name, model)]
    animate = import_module(entry.module).animate
    return cast("Engine", animate if entry.runs == "rules" else partial(animate, model=model))


def engine_learnt(
    name: str | None = None, model: Model = None
) -> tuple[frozenset[str], frozenset[str]]:
    """The phones and controls that an engine learnt from real faces; none of one with rules.

    Raises:
        LipwrightError: as `engine_controls`.
    """
    network = _network_of(name, model)
    if network is None:
        return frozenset(), frozenset()
    return frozenset(network.meta.features.phones), frozenset(network.meta.controls)


def engine_controls(name: str | None = None, model: Model = None) -> tuple[str, ...]:
    """The controls that an engine moves; a model is loaded to know.

    Poses of a bigram set are not asked for here: its rig puts them on a head.

    Raises:
        LipwrightError: as `get_engine`, or the model cannot be used.
    """
    from lipwright.controls import CANONICAL

    network = _network_of(name, model)
    return CANONICAL if network is None or network.meta.moves_heads else network.meta.controls


def _network_of(name: str | None, model: Model) -> Learnt | None:
    """What an engine learnt and runs; None of one with rules."""
    entry = ENGINES[choose_engine(name, model)]
    return import_module(entry.module).open_network(model) if entry.runs == "models" else None
