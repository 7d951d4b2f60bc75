"""Voices: text to sound with phone times, one module a back end."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, cast

from lipwright.errors import LipwrightError
from lipwright.speech.voices.values import (
    MAX_RATE,
    MIN_RATE,
    Emphasis,
    Piece,
    Script,
    Utterance,
    Voice,
    VoiceBackEnd,
    VoiceInfo,
)

if TYPE_CHECKING:
    from lipwright.speech.aligner import Progress

__all__ = [
    "BACK_ENDS",
    "MAX_RATE",
    "MIN_RATE",
    "Emphasis",
    "Piece",
    "Script",
    "Utterance",
    "Voice",
    "VoiceBackEnd",
    "VoiceInfo",
    "find_voice",
    "get_back_end",
    "read_script",
    "speak",
]

BACK_ENDS: Final = MappingProxyType({
    "hibari": "lipwright.speech.voices.hibari",
    "espeak": "lipwright.speech.voices.espeak",
    "piper": "lipwright.speech.voices.piper",
    "http": "lipwright.speech.voices.http",
})  # fmt: skip
"""name to the module that makes the back end, by its function `back_end() -> VoiceBackEnd`"""

_DEFAULTS: Final = MappingProxyType({"en": "hibari"})
_OTHERWISE: Final = "espeak"
_SPEAKS_RATE: Final = 16000  # Hz, what the aligner hears
_MOST_NAMED: Final = 8


def get_back_end(name: str) -> VoiceBackEnd:
    """The back end of that name.

    Raises:
        LipwrightError: there is none.
    """
    if name not in BACK_ENDS:
        raise LipwrightError(f"unknown voice {name[:60]!r}; {_known()}")
    return cast(VoiceBackEnd, import_module(BACK_ENDS[name]).back_end())


def _known() -> str:
    names: list[str] = []
    for back_end in map(get_back_end, BACK_ENDS):
        if back_end.is_available():
            names += [info.name for info in back_end.voices()[:_MOST_NAMED]]
    return (
        f"use one of: {', '.join(names)}, ..., piper:FILE.onnx, or the address of a voice server; "
        "'lipwright voices' lists them all"
    )


def find_voice(name: str | None = None, language: str | None = None) -> Voice:
    """The voice of that name, or the usual one of a language; by default the English one.

    Args:
        name: "espeak:sv", or a back end alone, or the address of a voice server.
        language: ISO code; a voice of another language is refused.

    Raises:
        LipwrightError: there is no such voice (lists the known ones), or it is not installed.
    """
    if not name:
        name = _DEFAULTS.get(language or "en", _OTHERWISE)
    server = name.casefold().startswith(("http://", "https://"))
    kind, _, voice = ("http", "", name) if server else name.partition(":")
    back_end = get_back_end(kind.casefold())
    if not back_end.is_available():
        raise LipwrightError(f"the voice {name} is not installed; run: {back_end.remedy()}")
    found = back_end.open(voice, language)
    spoken = found.info.language
    if language is not None and spoken and spoken.partition("-")[0] != language.partition("-")[0]:
        raise LipwrightError(
            f"the voice {found.info.name} speaks {spoken}, not {language}; leave --voice out for "
            f"the usual voice of {language}, or name another one"
        )
    return found


def read_script(text: str, source: str = "text", language: str | None = None) -> Script:
    """Plain text, or SSML that begins with <speak, as a script; see `ssml.read_script`.

    Args:
        text: what is said.
        source: its name in errors.
        language: ISO code, by which dates and ordinals of SSML are read.

    Raises:
        LipwrightError: the text has nothing to say, or the SSML cannot be used.
    """
    from lipwright.speech.voices.ssml import read_script as read

    return read(text, source, language)


def speak(
    voice: Voice, script: Script, source: str = "text", dictionary: Path | None = None,
    progress: Progress | None = None, language: str | None = None,
) -> Utterance:  # fmt: skip
    """Let a voice say a script; a voice that tells no times is aligned with its words.

    Args:
        voice: who speaks.
        script: what is said.
        source: the script's name in errors.
        dictionary: a file of pronunciations that go before the voice's own.
        progress: told how far it is.
        language: ISO code of the words, where the voice has none of its own.

    Raises:
        LipwrightError: something cannot be said, or the voice's sound does not fit its words.
    """
    if dictionary is not None:
        from lipwright.speech.voices.own_words import with_dictionary

        script = with_dictionary(script, dictionary)
    said = replace(voice.speak(script, source, progress), voice=voice.info.name)
    if said.track is not None:
        return said
    from lipwright.audio import resampled
    from lipwright.language import get_language
    from lipwright.speech import align

    code = voice.info.language or language or "en"
    words = get_language(code).normalize(said.text, source)
    try:
        track = align(resampled(said.audio, _SPEAKS_RATE), words, code).track
    except LipwrightError as error:
        raise LipwrightError(
            f"{voice.info.name} tells no times, and its sound cannot be aligned: {error}"
        ) from error
    return replace(said, track=track, timing="aligner")
