"""Voices: text to sound with phone times, one module a back end."""

from __future__ import annotations

from lipwright.speech.voices.values import (
    Emphasis,
    Piece,
    Script,
    Utterance,
    Voice,
    VoiceBackEnd,
    VoiceInfo,
)

__all__ = ["Emphasis", "Piece", "Script", "Utterance", "Voice", "VoiceBackEnd", "VoiceInfo"]
