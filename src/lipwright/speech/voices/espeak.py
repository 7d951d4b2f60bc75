"""The voices of espeak-ng: over a hundred languages, in a process of their own."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from lipwright import espeak
from lipwright.errors import LipwrightError
from lipwright.phones import BILABIALS, SILENCE
from lipwright.speech.voices.espeak_phones import phoneme_input
from lipwright.speech.voices.espeak_text import (
    MANDARIN,
    UNSPACED,
    SaidText,
    mandarin_text,
    one_word,
    plain_text,
)
from lipwright.speech.voices.espeak_times import spoken_samples, to_stretch
from lipwright.speech.voices.scripts import check_text
from lipwright.speech.voices.timeline import Stretch, Timeline
from lipwright.speech.voices.values import Emphasis, Piece, Script, Utterance, VoiceInfo
from lipwright.speech.voices.written_out import written_out

if TYPE_CHECKING:
    from lipwright.speech.aligner import Progress

NAME: Final = "espeak"
DEFAULT: Final = "en-us"
RATE: Final = 22_050  # Hz, of every voice of espeak-ng

# ISO codes as `lipwright.language` has them, where espeak-ng's own differ.
_ISO: Final = MappingProxyType({
    "en-us": "en", "fr-fr": "fr", "cmn-latn-pinyin": "cmn", "nb": "no",
})  # fmt: skip
# espeak-ng drops the end of longer clauses and words; of Japanese ones behind 66 characters.
_MOST_AT_ONCE: Final = 500  # characters of a clause; Mandarin ends at 150 syllables, 600 characters
_MOST_UNSPACED: Final = 120  # the same of scripts without spaces; 199 of Chinese are said
_LONG_WORD: Final = re.compile(r"\S{80}(?=\S)")
_LONG_RUN: Final = re.compile(r"[^\s。！？，；：、]{30}(?=[^\s。！？，；：、])")
_ENOUGH: Final = 250  # characters; short sentences are said together
_SENTENCE_END: Final = re.compile(r"(?<=[.!?…])\s+|(?<=[。！？])|\n\s*\n")
_CLAUSE_END: Final = ".!?…:;,。！？，；：、"
_PLACES_TO_CUT: Final = (_CLAUSE_END, " \n\t")

# Between these the speed does what it says; above, espeak-ng compresses and its times drift.
_SLOWEST: Final = espeak.MIN_WORDS_PER_MINUTE
_FASTEST: Final = 440
_CLOSE_ENOUGH: Final = 0.01  # of the duration
_MOST_TRIES: Final = 4
_LEAST_STRETCH: Final = 0.03  # of the duration; less is not worth the loss


@dataclass(frozen=True)
class _Manner:
    """What emphasis changes."""

    pitch: int
    """0 to 100; 50 is the voice's own"""
    pitch_range: int
    """0 to 100; 50 is the voice's own"""
    rate: float
    """factor of the speed"""


# Ours: SSML 1.1 leaves it to the voice; emphasised words are higher and slower.
_MANNERS: Final = MappingProxyType[Emphasis | None, _Manner]({
    None: _Manner(50, 50, 1.0), "none": _Manner(50, 50, 1.0), "reduced": _Manner(45, 30, 1.1),
    "moderate": _Manner(56, 65, 0.93), "strong": _Manner(62, 80, 0.85),
})  # fmt: skip


class EspeakVoice:
    """A voice of espeak-ng; made by `EspeakBackEnd.open`."""

    def __init__(self, info: VoiceInfo, voice: str) -> None:
        """`voice` is its name without "espeak:"."""
        self._info, self._voice = info, voice

    @property
    def info(self) -> VoiceInfo:
        """Its name and language."""
        return self._info

    def speak(
        self, script: Script, source: str = "text", progress: Progress | None = None
    ) -> Utterance:
        """Say the script, as `Voice.speak` describes it.

        Breaks last as long as they ask for, from the last phone before to the first one after.

        Raises:
            LipwrightError: nothing is said, or a control character stands in the text.
        """
        for piece in script:
            check_text(piece, source)
        script = written_out(script, self._info.language, source)
        timeline = Timeline(RATE)
        whole = sum(map(_size, script)) or 1
        done, joins = 0, False
        for number, piece in enumerate(script):
            goes_on = _goes_on(piece, script[number + 1 :])
            for text, last in _parts(piece):
                said = self._say(piece, text)
                timeline.add(said.trimmed(joins, last and (goes_on or piece.pause > 0)))
                joins = False
                done += len(text)
                if progress:
                    progress(min(done / whole, 1.0))
            if piece.pause:
                timeline.silence(piece.pause)
            joins = goes_on or piece.pause > 0
        if not timeline.says_something:
            raise LipwrightError(
                f"{source}: line {script[0].line}: espeak-ng finds nothing to say; write words"
            )
        return timeline.utterance(" ".join(piece.text for piece in script if piece.text))

    def _say(self, piece: Piece, text: str) -> Stretch:
        """A part of a piece, or its phones, at its rate."""
        manner = _MANNERS[piece.emphasis]
        wanted = 1 / (piece.rate * manner.rate)
        if piece.phones:
            return self._say_phones(piece, manner, wanted)
        reads_pinyin = self._voice.partition("+")[0] == MANDARIN
        said = mandarin_text(text) if reads_pinyin else plain_text(text)
        return self._timed(said, self._voice, manner, wanted)

    def _say_phones(self, piece: Piece, manner: _Manner, wanted: float) -> Stretch:
        """The phones of a piece; by the English voice where this one leaves closures out."""
        label = "".join(piece.text.split()) or "-".join(piece.phones)
        asked = sum(phone in BILABIALS for phone in piece.phones)
        for voice in (self._voice, _variant(DEFAULT, self._voice)):
            text = phoneme_input(piece.phones, voice)
            said = self._timed(one_word(text, label), voice, manner, wanted, mnemonics=True)
            heard = [one.phone for one in said.phones if one.phone != SILENCE]
            if len(heard) >= len(piece.phones) and asked == sum(one in BILABIALS for one in heard):
                break
        return said

    def _timed(
        self, text: SaidText, voice: str, manner: _Manner, wanted: float, mnemonics: bool = False
    ) -> Stretch:
        """The text in `wanted` times the voice's own time.

        Words a minute are not the speed of any text: it is said until its duration fits, and
        stretched where espeak-ng cannot say it so fast or slowly.
        """

        def said(speed: int) -> espeak.Speech:
            return espeak.speak(
                text.text, voice, words_per_minute=speed, pitch=manner.pitch,
                pitch_range=manner.pitch_range, phoneme_input=mnemonics, end_pause=True,
            )  # fmt: skip

        speed = espeak.WORDS_PER_MINUTE
        speech = said(speed)
        goal = spoken_samples(speech) * wanted
        for _ in range(_MOST_TRIES if goal else 0):
            ratio = spoken_samples(speech) / goal
            better = round(min(max(speed * ratio, _SLOWEST), _FASTEST))
            if abs(ratio - 1) <= _CLOSE_ENOUGH or better == speed:
                break
            speed = better
            speech = said(speed)
        found = to_stretch(speech, text, voice)
        factor = goal / spoken_samples(speech) if goal else 1.0
        return found.stretched(factor, RATE) if abs(factor - 1) > _LEAST_STRETCH else found


def _variant(code: str, voice: str) -> str:
    """The voice of another language with the same timbre."""
    timbre = voice.partition("+")[2]
    return f"{code}+{timbre}" if timbre else code


def _size(piece: Piece) -> int:
    return len(piece.text) or len(piece.phones)


def _goes_on(piece: Piece, rest: Sequence[Piece]) -> bool:
    """Whether what comes next belongs to the same clause."""
    more = any(_size(one) for one in rest[:1])
    return more and not piece.pause and not piece.text.rstrip().endswith(tuple(_CLAUSE_END))


def _parts(piece: Piece) -> Iterator[tuple[str, bool]]:
    """The texts of a piece that are said at once, and whether each is the last."""
    if piece.phones:
        yield piece.text or " ", True
        return
    parts: list[str] = []
    for sentence in _SENTENCE_END.split(piece.text):
        for part in _cut(sentence):
            enough = _MOST_UNSPACED if UNSPACED.search(part) else _ENOUGH
            if parts and len(parts[-1]) + len(part) < enough:
                parts[-1] += " " + part
            elif part.strip():
                parts.append(part)
    for number, part in enumerate(parts, 1):
        yield part, number == len(parts)


def _cut(sentence: str) -> Iterator[str]:
    """A sentence in pieces of which espeak-ng says all, cut at punctuation or spaces if it can."""
    unspaced = UNSPACED.search(sentence) is not None
    most = _MOST_UNSPACED if unspaced else _MOST_AT_ONCE
    sentence = (_LONG_RUN if unspaced else _LONG_WORD).sub(r"\g<0> ", sentence)
    while len(sentence) > most:
        head = sentence[:most]
        places = (max(map(head.rfind, marks)) for marks in _PLACES_TO_CUT)
        place = next((place for place in places if place > 0), most - 1) + 1
        yield sentence[:place]
        sentence = sentence[place:]
    yield sentence


class EspeakBackEnd:
    """What espeak-ng speaks."""

    name = NAME

    def is_available(self) -> bool:
        """Whether espeak-ng is installed."""
        return espeak.is_available()

    def remedy(self) -> str:
        """The command that installs what is missing."""
        return f"pip install 'lipwright[{espeak.EXTRA}]'"

    def voices(self) -> Sequence[VoiceInfo]:
        """A voice for each language, English first."""
        left_out = {"cmn", *espeak.MUTE}  # the first is offered by its pinyin voice
        found = [_info(one) for one in espeak.languages() if one.code not in left_out]
        return tuple(sorted(found, key=lambda info: info.name != f"{NAME}:{DEFAULT}"))

    def open(self, voice: str, language: str | None) -> EspeakVoice:
        """The voice of that name, "" for that of the language.

        Raises:
            LipwrightError: there is none; lists the known ones.
        """
        wanted = voice or (language or DEFAULT)
        found = espeak.find_language(wanted)
        if found.code in espeak.MUTE:
            raise LipwrightError(
                f"espeak-ng has no dictionary of {found.name} and cannot say it; name another voice"
            )
        if found.code == "cmn":  # characters are given as pinyin, which is read without gaps
            found = espeak.find_language(MANDARIN)
        variant = wanted.partition("+")[2]
        info = _info(found)
        timbre = f"+{variant}" if variant else ""
        return EspeakVoice(replace(info, name=info.name + timbre), found.code + timbre)


def _info(language: espeak.EspeakLanguage) -> VoiceInfo:
    code = _ISO.get(language.code, language.code)
    name, about = language.code, language.name
    if language.code == MANDARIN:
        name, about = "cmn", "Chinese (Mandarin)"
    return VoiceInfo(f"{NAME}:{name}", code, f"{about}, by espeak-ng")


def back_end() -> EspeakBackEnd:
    """The back end of the registry."""
    return EspeakBackEnd()
