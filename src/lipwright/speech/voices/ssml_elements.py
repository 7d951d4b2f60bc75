"""The elements of SSML, and the pieces of a script that they make.

SSML is that of the W3C recommendation "Speech Synthesis Markup Language (SSML) Version 1.1"
(2010), so far as it bears on what lips do. docs/voices.md has the table of its elements.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final, cast, get_args
from xml.parsers import expat

from lipwright.errors import LipwrightError
from lipwright.speech.voices.readings import ALPHABETS, READINGS, read_as, read_phones
from lipwright.speech.voices.values import MAX_RATE, MIN_RATE, Emphasis, Piece, Script

DEEPEST: Final = 50  # elements within each other
MOST_PAUSE: Final = 60.0  # s, of breaks that follow each other

# s; SSML 1.1 gives the order alone. Those of a comma, a sentence and a paragraph are near what
# the voices here do by themselves.
STRENGTHS: Final = MappingProxyType({
    "none": 0.0, "x-weak": 0.1, "weak": 0.2, "medium": 0.35, "strong": 0.6, "x-strong": 1.0,
})  # fmt: skip
PARAGRAPH: Final = 0.8  # s between two paragraphs
# Factors, ours: SSML 1.1 gives the order alone, with medium as the voice's own.
RATES: Final = MappingProxyType({
    "x-slow": 0.5, "slow": 0.75, "medium": 1.0, "default": 1.0, "fast": 1.25, "x-fast": 1.6,
})  # fmt: skip
ELEMENTS: Final = (
    "speak", "p", "s", "break", "emphasis", "prosody", "phoneme", "sub", "say-as", "mark",
    "lang", "token", "w", "meta", "metadata",
)  # fmt: skip
_OF_TEXT: Final = frozenset(("phoneme", "sub", "say-as", "break", "mark"))
"""elements that hold no others"""
_UNSAID: Final = frozenset(("meta", "metadata"))
_OTHER_VOICE: Final = MappingProxyType({
    "voice": "choose the voice with --voice, and remove the element",
    "audio": "sounds are not mixed in; remove the element",
    "lexicon": "give pronunciations with --dictionary, and remove the element",
    "lookup": "give pronunciations with --dictionary, and remove the element",
})  # fmt: skip
_TIME: Final = re.compile(r"\+?(\d+(?:\.\d*)?|\.\d+)(ms|s)")
_RATE: Final = re.compile(r"([+-]?)(\d+(?:\.\d*)?|\.\d+)(%?)")
_ENDS: Final = ".!?…。！？:;,、，；："
_MOST_RATE_DIGITS: Final = 12


@dataclass(frozen=True)
class _Manner:
    """How the text of an element is said."""

    name: str = ""
    """of the element"""
    rate: float = 1.0
    emphasis: Emphasis | None = None
    language: str = ""
    """ISO code without region"""
    phones: tuple[str, ...] = ()
    alias: str | None = None
    reading: tuple[str, str] | None = None
    """`interpret-as` and `format` of `say-as`"""
    silent: bool = False
    place: tuple[int, int] = (1, 1)
    """line and column of its tag"""


class Reader:
    """One SSML text on its way to pieces."""

    def __init__(self, source: str, language: str | None) -> None:
        """`source` names the text in errors; `language` is its ISO code, where it says none."""
        self._source = source
        self._open = [_Manner(language=(language or "").partition("-")[0])]
        self._pieces: list[Piece] = []
        self._text = ""
        self._start = (1, 1)
        self._above = 0
        self._paragraph = False
        self._handlers: dict[str, Callable[[_Manner, Mapping[str, str]], _Manner]] = {
            "speak": self._speak, "prosody": self._prosody, "emphasis": self._emphasis,
            "phoneme": self._phoneme, "sub": self._sub, "say-as": self._say_as,
            "break": self._break,
        }  # fmt: skip

    def read(self, text: str) -> Script:
        """The pieces of the whole text."""
        self._above = text[: len(text) - len(text.lstrip())].count("\n")
        parser = self._parser = expat.ParserCreate("utf-8")
        parser.StartElementHandler = self._begin
        parser.EndElementHandler = self._end
        parser.CharacterDataHandler = self._characters
        parser.StartDoctypeDeclHandler = self._doctype
        try:
            parser.Parse(text.lstrip().encode(), True)
        except expat.ExpatError as error:
            reason = expat.ErrorString(error.code)
            raise LipwrightError(
                f"{self._source}: line {error.lineno + self._above}, column {error.offset + 1}: "
                f"not well-formed SSML: {reason}; every tag needs its end, & is written &amp;"
            ) from error
        return tuple(self._pieces)

    def _at(self) -> tuple[int, int]:
        parser = self._parser
        return parser.CurrentLineNumber + self._above, parser.CurrentColumnNumber + 1

    def _refusal(self, problem: str, place: tuple[int, int] | None = None) -> LipwrightError:
        line, column = place or self._at()
        return LipwrightError(f"{self._source}: line {line}, column {column}: {problem}")

    def _doctype(self, *declared: object) -> None:
        del declared
        raise self._refusal("declares a document type, which is not read; remove <!DOCTYPE")

    def _begin(self, tag: str, attributes: dict[str, str]) -> None:
        self._flush()
        name = tag.removeprefix("ssml:")
        if name in _OTHER_VOICE:
            raise self._refusal(f"<{tag[:40]}> is not supported; {_OTHER_VOICE[name]}")
        if name not in ELEMENTS:
            raise self._refusal(f"unknown element <{tag[:40]}>; use one of: {', '.join(ELEMENTS)}")
        if len(self._open) == 1 and name != "speak":
            raise self._refusal(f"<{name}> is not in <speak>; write <speak>...</speak> around all")
        if len(self._open) > DEEPEST:
            raise self._refusal(f"more than {DEEPEST} elements in each other; write it flatter")
        if self._open[-1].name in _OF_TEXT:
            raise self._refusal(f"<{name}> in <{self._open[-1].name}>, which holds text alone")
        manner = replace(self._open[-1], name=name, place=self._at())
        if name in _UNSAID:
            manner = replace(manner, silent=True)
        language = attributes.get("xml:lang", "").casefold().partition("-")[0]
        if language and name != "speak" and language != manner.language:
            raise self._refusal(
                f"<{name}> in the language {language[:20]!r}; a voice says one language: put the "
                "other in a text of its own, or set xml:lang of <speak>"
            )
        if handler := self._handlers.get(name):
            manner = handler(manner, attributes)
        self._open.append(manner)

    def _end(self, tag: str) -> None:
        del tag
        self._flush()
        manner = self._open.pop()
        if manner.name in ("p", "s"):
            self._end_sentence()
            self._paragraph |= manner.name == "p"

    def _characters(self, data: str) -> None:
        if not self._text:
            self._start = self._at()
        self._text += data

    def _flush(self) -> None:
        """The text since the last tag becomes pieces."""
        text, self._text = self._text, ""
        manner = self._open[-1]
        if manner.silent:
            return
        if manner.phones or manner.alias:
            self._add(manner.alias or " ".join(text.split()), manner, manner.place)
            return
        if not text.strip():
            return
        if manner.reading:
            text = read_as(text, *manner.reading, manner.language)
        for found in re.finditer(r"\S+(?:(?!\n[^\S\n]*\n)\s+\S+)*", text):  # up to empty lines
            lines = text.count("\n", 0, found.start())
            column = found.start() - text.rfind("\n", 0, found.start())
            line = self._start[0] + lines
            self._add(found[0], manner, (line, column + (0 if lines else self._start[1] - 1)))

    def _add(self, text: str, manner: _Manner, place: tuple[int, int]) -> None:
        if manner.phones or any(char.isalnum() for char in text):
            if self._paragraph and self._pieces:
                self._pause(max(0.0, PARAGRAPH - self._pieces[-1].pause))
            self._paragraph = False
        self._pieces.append(
            Piece(text, manner.phones, 0.0, manner.emphasis, manner.rate, *place)
        )  # fmt: skip

    def _pause(self, seconds: float) -> None:
        if not seconds:
            return
        if not self._pieces:
            line, column = self._at()
            self._pieces.append(Piece(pause=seconds, line=line, column=column))
            return
        total = self._pieces[-1].pause + seconds
        if total > MOST_PAUSE:
            raise self._refusal(f"a pause of {total:g} s; at most {MOST_PAUSE:g} s")
        self._pieces[-1] = replace(self._pieces[-1], pause=total)

    def _end_sentence(self) -> None:
        """A sentence that ends without a mark gets one."""
        for place in range(len(self._pieces) - 1, -1, -1):
            piece = self._pieces[place]
            if not piece.text or piece.pause:
                return
            if not any(char.isalnum() for char in piece.text):
                if piece.text[-1] in _ENDS:
                    return
                continue
            if piece.text.rstrip("\"'”’»)]")[-1:] not in _ENDS:
                self._pieces[place] = replace(piece, text=piece.text + ".")
            return

    def _speak(self, manner: _Manner, attributes: Mapping[str, str]) -> _Manner:
        language = attributes.get("xml:lang", "").casefold().partition("-")[0]
        return replace(manner, language=language or manner.language)

    def _break(self, manner: _Manner, attributes: Mapping[str, str]) -> _Manner:
        time, strength = attributes.get("time"), attributes.get("strength")
        if time is not None:
            found = _TIME.fullmatch(time.strip())
            if not found or len(time) > _MOST_RATE_DIGITS:
                raise self._refusal(f"<break> of time {time[:40]!r}; write 500ms or 1.5s")
            seconds = float(found[1]) / (1000 if found[2] == "ms" else 1)
        elif strength is None or strength in STRENGTHS:
            seconds = STRENGTHS[strength or "medium"]
        else:
            raise self._unknown("break", "strength", strength, STRENGTHS)
        self._paragraph = False
        if seconds > MOST_PAUSE:
            raise self._refusal(f"a pause of {seconds:g} s; at most {MOST_PAUSE:g} s")
        self._pause(seconds)
        return manner

    def _emphasis(self, manner: _Manner, attributes: Mapping[str, str]) -> _Manner:
        level = attributes.get("level", "moderate")
        if level not in get_args(Emphasis):
            raise self._unknown("emphasis", "level", level, get_args(Emphasis))
        return replace(manner, emphasis=cast(Emphasis, level))

    def _prosody(self, manner: _Manner, attributes: Mapping[str, str]) -> _Manner:
        if "duration" in attributes:
            raise self._refusal("<prosody> with a duration is not supported; give a rate")
        text = attributes.get("rate", "medium").strip()
        found = _RATE.fullmatch(text)
        if text in RATES:
            factor = RATES[text]
        elif found and len(text) <= _MOST_RATE_DIGITS and (found[3] or not found[1]):
            factor = float(found[2]) / (100 if found[3] else 1)
            factor = 1 + factor * (1 if found[1] == "+" else -1) if found[1] else factor
        else:
            raise self._unknown("prosody", "rate", text, (*RATES, "80%", "+10%"))
        rate = manner.rate * factor
        if not MIN_RATE <= rate <= MAX_RATE:
            raise self._refusal(
                f"<prosody> makes the rate {rate:g}; it may be {MIN_RATE:g} to {MAX_RATE:g}"
            )
        return replace(manner, rate=rate)

    def _phoneme(self, manner: _Manner, attributes: Mapping[str, str]) -> _Manner:
        alphabet = attributes.get("alphabet", "ipa").casefold()
        if alphabet not in ALPHABETS:
            raise self._unknown("phoneme", "alphabet", alphabet, ("ipa", "x-sampa", "x-arpabet"))
        ph = attributes.get("ph", "").strip()
        if not ph:
            raise self._refusal('<phoneme> has no phonemes; write <phoneme ph="...">')
        try:
            phones = read_phones(ph, ALPHABETS[alphabet])
        except LipwrightError as error:
            raise self._refusal(f"<phoneme>: {error}") from error
        return replace(manner, phones=phones)

    def _sub(self, manner: _Manner, attributes: Mapping[str, str]) -> _Manner:
        if not (alias := attributes.get("alias", "").strip()):
            raise self._refusal('<sub> has no alias; write <sub alias="...">')
        return replace(manner, alias=alias)

    def _say_as(self, manner: _Manner, attributes: Mapping[str, str]) -> _Manner:
        kind = attributes.get("interpret-as", "")
        if kind not in READINGS:
            raise self._unknown("say-as", "interpret-as", kind, READINGS)
        return replace(manner, reading=(kind, attributes.get("format", "")))

    def _unknown(
        self, element: str, attribute: str, value: str, known: Collection[str]
    ) -> LipwrightError:
        return self._refusal(
            f"<{element}> with {attribute} {value[:40]!r}; use one of: {', '.join(known)}"
        )
