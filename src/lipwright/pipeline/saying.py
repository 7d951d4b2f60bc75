"""From text to a performance: a voice says it, and the face follows the voice's own times."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.export.performance import Performance
from lipwright.export.rigged import for_rig
from lipwright.pipeline.motion import animate_track
from lipwright.pipeline.options import AnimateOptions, PathLike, Report, quiet
from lipwright.pipeline.values import Result
from lipwright.pipeline.words import AUTO, language_of
from lipwright.speech.voices import MAX_RATE, MIN_RATE, Script, find_voice, read_script, speak
from lipwright.speech.voices.ssml import language_tag

MOST_CHARACTERS: Final = 50_000  # an hour of speech; its curves take 100 MB


@dataclass(frozen=True)
class SayOptions:
    """Who says a text, and how.

    Raises:
        LipwrightError: the rate is out of range.
    """

    voice: str | None = None
    """"hibari", "espeak:sv", "piper:FILE.onnx", "http://..."; by default that of the language"""
    language: str | None = None
    """ISO 639 code or name, or "auto" to tell it from the text; by default the voice's, or English
    """
    rate: float = 1.0
    """times as fast as the voice by itself, 0.25 to 4"""
    dictionary: PathLike | None = None
    """a file of pronunciations that override the voice's own"""

    def __post_init__(self) -> None:
        """Check."""
        if not MIN_RATE <= self.rate <= MAX_RATE:
            raise LipwrightError(
                f"the rate {self.rate:g} is out of range; use {MIN_RATE:g} (slow) to "
                f"{MAX_RATE:g} (fast)"
            )


def say(
    text: str,
    *,
    options: AnimateOptions | None = None,
    voice: SayOptions | None = None,
    text_source: str = "text",
    report: Report = quiet,
) -> Result:
    """A text as speech and motion; the sound is the performance's.

    Args:
        text: what is said, as plain text or SSML that begins with <speak.
        options: engine, model, frame rate, intensity and passes.
        voice: who says it, and how.
        text_source: the text's name in errors.
        report: told how far it is.

    Raises:
        LipwrightError: there is no such voice, or it cannot say the text; names the place and the
            remedy.
    """
    options, voice = options or AnimateOptions(), voice or SayOptions()
    rig = options.target  # before the work is done
    if len(text) > MOST_CHARACTERS:
        raise LipwrightError(
            f"{text_source}: {len(text)} characters, more than the {MOST_CHARACTERS} that are said "
            "at once; split the text"
        )
    asked = voice.language or language_tag(text)
    known = language_of(asked, "", text_source) if asked not in ("", AUTO) else None
    script = _at_rate(read_script(text, text_source, known), voice.rate)
    words = " ".join(piece.text for piece in script)
    language = language_of(AUTO, words, text_source) if voice.language == AUTO else known
    speaker = find_voice(voice.voice, language)
    notes = _misgivings(words, speaker.info.language or language or "en", text_source)
    dictionary = None if voice.dictionary is None else Path(voice.dictionary)
    said = speak(
        speaker, script, text_source, dictionary, lambda share: report("say", share), language
    )
    assert said.track is not None  # speak aligns what tells no times
    report("animate", 0.0)
    clip = animate_track(said.track, options, said.audio)
    performance = for_rig(Performance(clip, said.track, said.audio), rig)
    report("animate", 1.0)
    return Result(performance, utterance=said, notes=notes)


def _misgivings(words: str, code: str, source: str) -> tuple[str, ...]:
    """What the user should know of words that seem to be of another language.

    Raises:
        LipwrightError: their letters are not those of the language.
    """
    from lipwright.language.detect import check_language

    note = check_language(words, code, source)
    return (note,) if note else ()


def _at_rate(script: Script, rate: float) -> Script:
    if rate == 1:
        return script
    return tuple(
        replace(piece, rate=min(max(piece.rate * rate, MIN_RATE), MAX_RATE)) for piece in script
    )
