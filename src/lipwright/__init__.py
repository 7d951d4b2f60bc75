"""Speech in, natural facial animation out, on any character.

    import lipwright

    result = lipwright.animate("hello.wav", text="Hello, how are you?")
    lipwright.export_all(["hello.mp4", "hello.csv"], result.performance)

Names are loaded when they are first used: `import lipwright` itself reads almost nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from lipwright.audio import Audio, read_audio
    from lipwright.clip import Clip
    from lipwright.errors import LipwrightError
    from lipwright.export import Performance, export_all, export_clip
    from lipwright.formats import read_track, write_track
    from lipwright.pipeline import (
        AlignOptions,
        AnimateOptions,
        SayOptions,
        align_speech,
        animate,
        hear_speech,
        say,
    )
    from lipwright.rig import Rig
    from lipwright.track import PhoneTrack
    from lipwright.version import VERSION as __version__  # noqa: N811  # as Python calls it

_HOMES = {
    "AlignOptions": "lipwright.pipeline",
    "AnimateOptions": "lipwright.pipeline",
    "Audio": "lipwright.audio",
    "Clip": "lipwright.clip",
    "LipwrightError": "lipwright.errors",
    "Performance": "lipwright.export",
    "PhoneTrack": "lipwright.track",
    "Rig": "lipwright.rig",
    "SayOptions": "lipwright.pipeline",
    "align_speech": "lipwright.pipeline",
    "animate": "lipwright.pipeline",
    "export_all": "lipwright.export",
    "export_clip": "lipwright.export",
    "hear_speech": "lipwright.pipeline",
    "read_audio": "lipwright.audio",
    "read_track": "lipwright.formats",
    "say": "lipwright.pipeline",
    "write_track": "lipwright.formats",
}

__all__ = [
    "AlignOptions",
    "AnimateOptions",
    "Audio",
    "Clip",
    "LipwrightError",
    "Performance",
    "PhoneTrack",
    "Rig",
    "SayOptions",
    "__version__",
    "align_speech",
    "animate",
    "export_all",
    "export_clip",
    "hear_speech",
    "read_audio",
    "read_track",
    "say",
    "write_track",
]


def __getattr__(name: str) -> Any:
    """Load a public name when it is first used."""
    if name == "__version__":
        from lipwright.version import VERSION

        return VERSION
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'lipwright' has no attribute {name!r}")


def __dir__() -> list[str]:
    """The public names."""
    return sorted(__all__)
