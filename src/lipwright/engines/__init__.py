"""Engines: PhoneTrack to Clip. Each is one module, registered here by name."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, Protocol, cast

from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.audio import AudioFile
    from lipwright.clip import Clip
    from lipwright.track import PhoneTrack

DEFAULT: Final = "dominance"


class Engine(Protocol):
    """What every engine does."""

    def __call__(self, track: PhoneTrack, fps: float, audio: AudioFile | None = None) -> Clip:
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


ENGINES: Final = MappingProxyType(
    {
        "dominance": EngineEntry(
            "lipwright.engines.dominance",
            "dominance functions (Cohen and Massaro 1993), targets fitted to a real speaker",
        ),
    }
)
"""name to engine; a new engine is one module and one row"""


def get_engine(name: str) -> Engine:
    """The engine of that name.

    Raises:
        LipwrightError: no such engine; lists the known ones.
    """
    if name not in ENGINES:
        raise LipwrightError(f"no engine {name!r}; the engines are: {', '.join(ENGINES)}")
    return cast("Engine", import_module(ENGINES[name].module).animate)
