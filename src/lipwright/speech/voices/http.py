"""Voices behind an address: any server that speaks the small schema of docs/voices.md."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Final

from lipwright.audio import resampled
from lipwright.errors import LipwrightError
from lipwright.language import get_language
from lipwright.speech.voices.http_answer import VERSION, read_sound, read_times
from lipwright.speech.voices.http_client import Address, post, read_address
from lipwright.speech.voices.values import Piece, Script, Utterance, VoiceInfo

if TYPE_CHECKING:
    from lipwright.audio import Audio
    from lipwright.speech.aligner import Progress
    from lipwright.track import PhoneTrack

NAME: Final = "http"
_ALIGNER_RATE: Final = 16000  # Hz
_NEAR: Final = 0.15  # s, by which a word of the aligner may lie from where the server has it


class HttpVoice:
    """A voice behind an address."""

    def __init__(self, address: Address, language: str) -> None:
        """`language` is the ISO code of what it will say, or ""."""
        self._address, self._language = address, language

    @property
    def info(self) -> VoiceInfo:
        """Its name and language."""
        name = self._address.voice
        shown = f"{self._address.shown}#{name}" if name else self._address.shown
        return VoiceInfo(shown, self._language, "a voice server")

    def speak(
        self, script: Script, source: str = "text", progress: Progress | None = None
    ) -> Utterance:
        """Say the script, as `Voice.speak` describes it.

        The track is the server's where it tells phones. Where it tells words alone, their phones
        come from the aligner if it agrees on the words, and are placed in them otherwise.

        Raises:
            LipwrightError: the server cannot be used, or answers what is not the schema.
        """
        del source
        text = " ".join(piece.text for piece in script if piece.text)
        answer: Any = post(self._address, self._request(script, text))
        place, language = self._address.shown, self._language or "en"
        audio = read_sound(answer, place)
        track = read_times(answer, audio.duration, language, place)
        if progress:
            progress(1.0)
        if track is None or answer.get("phones"):
            return Utterance(audio, track, text)
        aligned = _aligned(audio, track, text, language)
        if aligned is None:
            return Utterance(audio, track, text)
        return Utterance(audio, aligned, text, timing="aligner")

    def _request(self, script: Script, text: str) -> dict[str, object]:
        rates = {piece.rate for piece in script}
        return {
            "version": VERSION, "text": text, "language": self._language or None,
            "voice": self._address.voice or None, "rate": rates.pop() if len(rates) == 1 else 1.0,
            "pieces": [_piece(piece) for piece in script],
        }  # fmt: skip


def _piece(piece: Piece) -> dict[str, object]:
    row = asdict(piece)
    return {key: row[key] for key in ("text", "phones", "pause", "emphasis", "rate")}


def _aligned(audio: Audio, track: PhoneTrack, text: str, language: str) -> PhoneTrack | None:
    """The aligner's track of the same words, if it puts them where the server does."""
    from lipwright.speech import align

    try:
        words = get_language(language).normalize(text)
        found = align(resampled(audio, _ALIGNER_RATE), words, language)
    except LipwrightError:
        return None
    starts = [track.word_span(word)[0] for word in track.words]
    near = all(
        min(abs(found.track.word_span(word)[0] - start) for word in found.track.words) <= _NEAR
        for start in starts
    )
    return found.track if near and not found.misfits and found.track.words else None


class HttpBackEnd:
    """Voice servers; the name of a voice is its address."""

    name = NAME

    def is_available(self) -> bool:
        """It needs nothing."""
        return True

    def remedy(self) -> str:
        """The command that installs what is missing: nothing is."""
        return "pip install lipwright"

    def voices(self) -> Sequence[VoiceInfo]:
        """None: nobody is asked before the user gives an address."""
        return ()

    def open(self, voice: str, language: str | None) -> HttpVoice:
        """The voice at an address, "http://127.0.0.1:8123/speak#name".

        Raises:
            LipwrightError: it is no address of a server.
        """
        return HttpVoice(read_address(voice), language or "")


def back_end() -> HttpBackEnd:
    """The back end of the registry."""
    return HttpBackEnd()
