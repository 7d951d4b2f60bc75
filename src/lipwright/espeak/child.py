"""The program that holds espeak-ng: a process of its own, which `lipwright.espeak.process` starts.

It runs as a script without any package, so that it is ready within tens of milliseconds. Its
arguments are the library and, if not the library's own, the folder of its data. A request on
standard input is a length of four bytes, big-endian, and so much JSON. An answer on standard
output is the same, and after it as many bytes of sound as its field `pcm` says. The first answer
comes unasked and says which version is ready. It ends when its input does.

Structures and numbers: speak_lib.h of espeak-ng 1.52.
"""

from __future__ import annotations

import ctypes
import json
import os
import signal
import struct
import sys
from collections.abc import Callable
from typing import IO, Any, ClassVar, Final

SYNCHRONOUS: Final = 2  # AUDIO_OUTPUT_SYNCHRONOUS: sound goes to the callback only
PHONEME_EVENTS: Final = 0x1  # of espeak_Initialize
PHONEME_IPA: Final = 0x2
DONT_EXIT: Final = 0x8000
UTF8: Final = 1  # of espeak_Synth and espeak_TextToPhonemes
SSML: Final = 0x10
PHONEMES: Final = 0x100  # [[...]] is phoneme mnemonics
END_PAUSE: Final = 0x1000  # the pause after the last sentence is made too
RATE: Final = 1  # parameters
PITCH: Final = 3
RANGE: Final = 4
EVENT_END: Final = 0  # kinds of event
EVENT_WORD: Final = 1
EVENT_PHONEME: Final = 7
AS_IPA: Final = 0x2  # of espeak_TextToPhonemes; a separator stands in bits 8 to 23
SAMPLE_BYTES: Final = 2


class _Id(ctypes.Union):
    _fields_: ClassVar = [
        ("number", ctypes.c_int),
        ("name", ctypes.c_char_p),
        ("string", ctypes.c_char * 8),
    ]


class _Event(ctypes.Structure):
    _fields_: ClassVar = [
        ("type", ctypes.c_int),
        ("unique_identifier", ctypes.c_uint),
        ("text_position", ctypes.c_int),  # of a word: characters from 1
        ("length", ctypes.c_int),  # of a word: characters
        ("audio_position", ctypes.c_int),  # ms
        ("sample", ctypes.c_int),
        ("user_data", ctypes.c_void_p),
        ("id", _Id),
    ]


class _Voice(ctypes.Structure):
    _fields_: ClassVar = [
        ("name", ctypes.c_char_p),
        ("languages", ctypes.c_void_p),  # byte of priority, code, NUL; again; NUL
        ("identifier", ctypes.c_char_p),
        ("gender", ctypes.c_ubyte),
        ("age", ctypes.c_ubyte),
        ("variant", ctypes.c_ubyte),
        ("xx1", ctypes.c_ubyte),
        ("score", ctypes.c_int),
        ("spare", ctypes.c_void_p),
    ]


_SYNTH_CALLBACK: Final = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.POINTER(ctypes.c_short), ctypes.c_int, ctypes.POINTER(_Event)
)
_URI_CALLBACK: Final = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p
)

Answer = tuple[dict[str, Any], bytes]


class _RefusedError(Exception):
    """A request that cannot be met; the message goes back."""


class Engine:
    """The library, initialised."""

    def __init__(self, library: str, data: str) -> None:
        """Load `library`; `data` is its folder espeak-ng-data, "" for the library's own."""
        self._lib: Any = ctypes.CDLL(library)
        self._lib.espeak_Info.restype = ctypes.c_char_p
        self._lib.espeak_ListVoices.restype = ctypes.POINTER(ctypes.POINTER(_Voice))
        self._lib.espeak_TextToPhonemes.restype = ctypes.c_char_p
        place = None
        if data:
            # The library keeps a path of at most 159 bytes; a name in the working folder is short.
            os.chdir(os.path.dirname(os.path.abspath(data)))  # noqa: PTH100, PTH120  # quick start
            place = os.path.basename(data).encode()  # noqa: PTH119
        options = PHONEME_EVENTS | PHONEME_IPA | DONT_EXIT
        self.rate: int = self._lib.espeak_Initialize(SYNCHRONOUS, 0, place, options)
        if self.rate <= 0:
            raise _RefusedError("its data cannot be read")
        self.version = self._lib.espeak_Info(None).decode("ascii", "replace")
        # Kept here, as the library does not.
        self._take = _SYNTH_CALLBACK(self._taken)
        self._refuse = _URI_CALLBACK(lambda kind, uri, base: 1)
        self._lib.espeak_SetSynthCallback(self._take)
        self._lib.espeak_SetUriCallback(self._refuse)  # SSML's audio: no file is opened
        self._pcm = bytearray()
        self._events: list[tuple[int, int, int, int, str]] = []
        self._most = 0
        self._failed: Exception | None = None

    def _taken(self, samples: Any, count: int, events: Any) -> int:
        """The library gives sound and what happens in it; 1 stops it."""
        try:
            if samples and count > 0:
                self._pcm += ctypes.string_at(samples, count * SAMPLE_BYTES)
            index = 0
            while events[index].type != EVENT_END:
                event = events[index]
                index += 1
                if event.type in (EVENT_WORD, EVENT_PHONEME):
                    label = ctypes.string_at(ctypes.addressof(event.id), 8).partition(b"\0")[0]
                    text = label.decode("utf-8", "ignore") if event.type == EVENT_PHONEME else ""
                    self._events.append(
                        (event.type, event.sample, event.text_position, event.length, text)
                    )
        except Exception as error:  # it cannot pass through C
            self._failed = error
            return 1
        return int(len(self._pcm) > self._most)

    def voices(self, request: dict[str, Any]) -> Answer:
        """Every voice: identifier, name, language codes, the main one first."""
        del request
        rows, index = [], 0
        found = self._lib.espeak_ListVoices(None)
        while found[index]:
            voice = found[index].contents
            index += 1
            codes, place = [], voice.languages
            while ctypes.string_at(place, 1) != b"\0":
                code = ctypes.string_at(place + 1)
                codes.append(code.decode("utf-8", "replace"))
                place += 2 + len(code)
            texts = (text.decode("utf-8", "replace") for text in (voice.identifier, voice.name))
            rows.append([*texts, codes])
        return {"voices": rows}, b""

    def variants(self, request: dict[str, Any]) -> Answer:
        """The identifiers of all voices that only change another one's timbre."""
        del request
        wanted = _Voice(languages=ctypes.cast(ctypes.c_char_p(b"variant"), ctypes.c_void_p))
        found, index = self._lib.espeak_ListVoices(ctypes.byref(wanted)), 0
        names = []
        while found[index]:
            names.append(found[index].contents.identifier.decode("utf-8", "replace"))
            index += 1
        return {"variants": [name for name in names if name.startswith("!v/")]}, b""

    def _choose(self, voice: str) -> None:
        if self._lib.espeak_SetVoiceByName(voice.encode()) != 0:
            raise _RefusedError(f"has no voice {voice!r}")

    def ipa(self, request: dict[str, Any]) -> Answer:
        """The IPA of each text alone."""
        self._choose(request["voice"])
        mode = AS_IPA | ord(request["separator"] or "\0") << 8
        clauses = [self._clauses(text, mode) for text in request["texts"]]
        self._forget()
        return {"clauses": clauses}, b""

    def _clauses(self, text: str, mode: int) -> list[tuple[str, str]]:
        """The IPA of each clause and its text."""
        encoded = text.encode()
        data = ctypes.create_string_buffer(encoded)
        first = ctypes.addressof(data)
        place = ctypes.c_void_p(first)
        clauses, done = [], 0
        while place.value:
            found = self._lib.espeak_TextToPhonemes(ctypes.byref(place), UTF8, mode)
            end = place.value - first if place.value else len(encoded)
            ipa = (found or b"").decode("utf-8", "replace").strip()
            clauses.append((ipa, encoded[done:end].decode("utf-8", "ignore")))
            done = end
        return clauses

    def speak(self, request: dict[str, Any]) -> Answer:
        """Sound of 16 bits, and the phones and words in it."""
        self._choose(request["voice"])
        for parameter, name in ((RATE, "wpm"), (PITCH, "pitch"), (RANGE, "range")):
            self._lib.espeak_SetParameter(parameter, request[name], 0)
        self._lib.espeak_ng_SetPhonemeEvents(1, int(not request["mnemonics"]))
        flags = UTF8
        for flag, name in ((SSML, "ssml"), (PHONEMES, "phonemes"), (END_PAUSE, "end_pause")):
            flags |= flag if request[name] else 0
        self._most = request["most_samples"] * SAMPLE_BYTES
        try:
            self._synthesise(request["text"], flags)
            pcm, events = bytes(self._pcm), self._events
        finally:
            self._pcm, self._events = bytearray(), []
            if flags & (SSML | PHONEMES):
                self._forget()
        if len(pcm) > self._most:
            raise _RefusedError("makes more sound of it than is allowed")
        return {"rate": self.rate, "events": events, "pcm": len(pcm)}, pcm

    def _forget(self) -> None:
        """Let the library say nothing, once, as it remembers what it did before.

        It goes on to read SSML and mnemonics when it translates without sound; and after it has
        translated without sound, the first word that it says may have no event.
        """
        self._synthesise(" ", UTF8)
        self._pcm, self._events = bytearray(), []

    def _synthesise(self, text: str, flags: int) -> None:
        data = text.encode() + b"\0"
        status = self._lib.espeak_Synth(data, len(data), 0, 0, 0, flags, None, None)
        if self._failed is not None:
            failed, self._failed = self._failed, None
            raise failed
        if status != 0:
            raise _RefusedError(f"gives up with status {status}")


def _answer(pipe: IO[bytes], header: dict[str, Any], pcm: bytes = b"") -> None:
    data = json.dumps(header).encode()
    pipe.write(struct.pack(">I", len(data)) + data + pcm)
    pipe.flush()


def serve(engine: Engine, requests: IO[bytes], answers: IO[bytes]) -> None:
    """Answer until there are no more requests."""
    verbs: dict[str, Callable[[dict[str, Any]], Answer]] = {
        "voices": engine.voices,
        "variants": engine.variants,
        "ipa": engine.ipa,
        "speak": engine.speak,
    }
    while len(size := requests.read(4)) == 4:
        request = json.loads(requests.read(struct.unpack(">I", size)[0]))
        try:
            header, pcm = verbs[request["verb"]](request)
        except _RefusedError as refused:
            header, pcm = {"refused": str(refused)}, b""
        _answer(answers, header, pcm)


def main() -> None:
    """Serve the library that the arguments name."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is our parent's to handle
    requests = os.fdopen(os.dup(0), "rb")
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what the library prints must not come between
    try:
        engine = Engine(sys.argv[1], sys.argv[2])
    except (OSError, AttributeError, _RefusedError) as error:
        _answer(answers, {"refused": str(error)})
        return
    _answer(answers, {"version": engine.version})
    serve(engine, requests, answers)


if __name__ == "__main__":
    main()
