"""espeak-ng: IPA and speech in over a hundred languages, from a process of its own.

espeak-ng is GPL, so it is never loaded into ours: `child.py` holds it, and we send text and get
IPA, sound and times back. The extra `espeak` brings the library; else that of the system is used.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache
from types import MappingProxyType
from typing import Any, Final

from lipwright.errors import LipwrightError
from lipwright.espeak.corrections import corrected
from lipwright.espeak.process import EXTRA, KEEPER, find_library
from lipwright.espeak.values import Clause, EspeakLanguage, PhoneEvent, Speech, WordEvent

__all__ = [
    "EXTRA",
    "MUTE",
    "Clause",
    "EspeakLanguage",
    "PhoneEvent",
    "Speech",
    "WordEvent",
    "find_language",
    "is_available",
    "languages",
    "speak",
    "to_clauses",
    "to_ipa",
    "variants",
    "version",
    "words_to_ipa",
]

MAX_CHARACTERS: Final = 100_000
"""in a request; longer texts are given in parts"""
MAX_SECONDS: Final = 3600.0
"""of sound from a request"""
MUTE: Final = frozenset(("xex", "fo", "kaa"))
"""codes of a test language, and of Faroese and Karakalpak: 1.52 has no dictionary of theirs, and
says nothing"""
WORDS_PER_MINUTE: Final = 175
"""espeak-ng's own speed, `espeakRATE_NORMAL` in speak_lib.h"""
MIN_WORDS_PER_MINUTE: Final = 80  # speak_lib.h: espeakRATE
MAX_WORDS_PER_MINUTE: Final = 900
_SAMPLE_RATE: Final = 22_050  # Hz, of every voice that is not MBROLA's
_TIMEOUT: Final = 20.0  # s; and for each character, which takes about 0.1 ms:
_TIMEOUT_PER_CHARACTER: Final = 0.01
# What a code alone means to us: the text front ends are of the same countries.
_USUAL: Final = MappingProxyType({"en": "en-us", "zh": "cmn", "fr": "fr-fr", "pt": "pt-br"})
_BETWEEN: Final = "_"  # phonemes, when we ask for IPA; only the "k_h" of Thai and Shan has one
_SWITCH: Final = re.compile(r"\([a-z][a-zA-Z0-9-]*\)")  # "(en)": from here on in that language
_VOICE: Final = re.compile(r"([A-Za-z0-9-]+)(?:\+([A-Za-z0-9_-]{1,30}))?")
_VARIANT: Final = re.compile(r"[A-Za-z0-9_-]{1,30}")


def is_available() -> bool:
    """Whether espeak-ng is installed, in a version that we can use."""
    if find_library() is None:
        return False
    try:
        version()
    except LipwrightError:
        return False
    return True


def version() -> str:
    """Of espeak-ng, such as "1.52.0".

    Raises:
        MissingExtraError: espeak-ng is not installed.
        LipwrightError: it is too old or cannot be loaded.
    """
    return KEEPER.version()


@cache
def languages() -> tuple[EspeakLanguage, ...]:
    """What espeak-ng speaks, in order of code; a code that two voices share is named once.

    Raises:
        LipwrightError: as `version`.
    """
    found: dict[str, EspeakLanguage] = {}
    for identifier, name, codes in _ask({"verb": "voices"}, 0)[0]["voices"]:
        # Variants change the timbre alone; MBROLA voices need files that are not here.
        if codes and not identifier.startswith(("!v/", "mb/")):
            code = identifier.rpartition("/")[2].lower() if codes[0] in found else codes[0].lower()
            language = EspeakLanguage(code, name.strip(), tuple(codes), identifier)
            found.setdefault(code, language)
    return tuple(found[code] for code in sorted(found))


@cache
def variants() -> tuple[str, ...]:
    """What may follow a voice's name and a plus, to change its timbre: "f2", "m3", "croak".

    Raises:
        LipwrightError: as `version`.
    """
    rows = _ask({"verb": "variants"}, 0)[0]["variants"]
    names = (identifier.rpartition("/")[2] for identifier in rows)
    return tuple(sorted(name for name in names if _VARIANT.fullmatch(name)))


def to_ipa(text: str, language: str, separator: str = "") -> str:
    """The IPA of a text: words with spaces between them, a line for each clause.

    Stress and length marks stay; marks of a change of language are dropped.

    Args:
        text: plain text.
        language: a code of `languages()`.
        separator: one character between the phonemes of a word, or "".

    Raises:
        LipwrightError: no such language, a character that cannot be said, or as `version`.
    """
    return words_to_ipa((text,), language, separator)[0]


def words_to_ipa(texts: Sequence[str], language: str, separator: str = "") -> tuple[str, ...]:
    """The IPA of each text alone, in one request; as `to_ipa`.

    Raises:
        LipwrightError: as `to_ipa`.
    """
    if len(separator) > 1:
        raise ValueError(f"the separator {separator!r} is more than one character")
    voice, code = _checked_voice(language)
    plain = [_plain(text) for text in texts]
    count = sum(map(len, plain)) + len(plain)
    request = {"verb": "ipa", "voice": voice, "texts": plain, "separator": _BETWEEN}
    answer, _ = _ask(request, count)
    return tuple(
        "\n".join(filter(None, (_joined(ipa, code, separator) for ipa, _ in clauses)))
        for clauses in answer["clauses"]
    )


def to_clauses(text: str, language: str) -> tuple[Clause, ...]:
    """A text as espeak-ng parts it at punctuation.

    Raises:
        LipwrightError: as `to_ipa`.
    """
    voice, code = _checked_voice(language)
    plain = _plain(text)
    request = {"verb": "ipa", "voice": voice, "texts": [plain], "separator": _BETWEEN}
    answer, _ = _ask(request, len(plain))
    return tuple(
        Clause(
            part,
            tuple(tuple((one, corrected(one, code)) for one in word) for word in _words(ipa)),
        )
        for ipa, part in _whole_words(answer["clauses"][0])
    )


def _whole_words(clauses: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """The clauses without the one character that espeak-ng reads ahead of each."""
    found: list[tuple[str, str]] = []
    ahead = ""
    for number, (ipa, part) in enumerate(clauses):
        text = ahead + part
        ahead = text[-1:] if number + 1 < len(clauses) and text[-1:].isalnum() else ""
        found.append((ipa, text.removesuffix(ahead)))
    return found


def speak(
    text: str, voice: str, *, words_per_minute: int = WORDS_PER_MINUTE, pitch: int = 50,
    pitch_range: int = 50, ssml: bool = False, phoneme_input: bool = False,
    mnemonics: bool = False, end_pause: bool = False,
) -> Speech:  # fmt: skip
    """Say a text.

    Args:
        text: plain text; SSML or [[mnemonics]] only where the next arguments say so.
        voice: a code of `languages()`, with a variant if wanted: "sv", "sv+f2".
        words_per_minute: the speed, MIN_WORDS_PER_MINUTE to MAX_WORDS_PER_MINUTE.
        pitch: 0 to 100; 50 is the voice's own.
        pitch_range: 0 (monotone) to 100; 50 is the voice's own.
        ssml: the text is SSML.
        phoneme_input: [[...]] in the text is espeak-ng's phoneme mnemonics.
        mnemonics: phone events carry mnemonics instead of IPA.
        end_pause: the pause that follows the last sentence is in the sound.

    Raises:
        LipwrightError: no such voice, a character that cannot be said, or as `version`.
    """
    if not MIN_WORDS_PER_MINUTE <= words_per_minute <= MAX_WORDS_PER_MINUTE:
        raise ValueError(f"{words_per_minute} words a minute")
    if not (0 <= pitch <= 100 and 0 <= pitch_range <= 100):
        raise ValueError(f"the pitch {pitch} and its range {pitch_range}")
    identifier, code = _checked_voice(voice)
    said = _plain(text, brackets=phoneme_input)
    request = {
        "verb": "speak", "voice": identifier, "text": said, "ssml": ssml,
        "wpm": words_per_minute, "pitch": pitch, "range": pitch_range, "phonemes": phoneme_input,
        "mnemonics": mnemonics, "end_pause": end_pause,
        "most_samples": round(MAX_SECONDS * _SAMPLE_RATE),
    }  # fmt: skip
    answer, pcm = _ask(request, len(said))
    return _speech(answer, pcm, None if mnemonics else code)


def _speech(answer: dict[str, Any], pcm: bytes, code: str | None) -> Speech:
    """`code`: of the language whose IPA the labels are."""
    import numpy as np

    samples = np.frombuffer(pcm, "<i2").astype(np.float32) / np.float32(32768)
    samples.setflags(write=False)
    rate = int(answer["rate"])
    phones, words = [], []
    for kind, sample, position, length, label in answer["events"]:
        if kind == 1:
            words.append(WordEvent(sample / rate, max(position - 1, 0), length))
        elif not _SWITCH.fullmatch(label):
            said = label if code is None else corrected(label, code)
            phones.append(PhoneEvent(sample / rate, said, max(position - 1, 0)))
    return Speech(samples, rate, tuple(phones), tuple(words))


def _ask(request: dict[str, Any], characters: int) -> tuple[dict[str, Any], bytes]:
    timeout = _TIMEOUT + _TIMEOUT_PER_CHARACTER * characters
    header, pcm = KEEPER.ask(request, timeout)
    if "refused" in header:
        raise LipwrightError(f"espeak-ng {header['refused']}; try other or less text")
    return header, pcm


def find_language(voice: str) -> EspeakLanguage:
    """The language of a voice's name: a code of `languages()` or of one of its voices.

    Raises:
        LipwrightError: there is none; lists the known codes.
    """
    known = {language.code: language for language in languages()}
    match = _VOICE.fullmatch(voice)
    code = "" if match is None else _USUAL.get(match[1].lower(), match[1].lower())
    also = {other.lower(): language.code for language in reversed(known.values())
            for other in language.codes}  # fmt: skip
    found = known.get(code) or known.get(also.get(code, ""))
    if found is None:
        raise LipwrightError(
            f"espeak-ng has no voice {voice[:80]!r}; use one of: {', '.join(sorted(known))}"
        )
    variant = match[2] if match is not None else None
    if variant and variant not in variants():
        raise LipwrightError(
            f"espeak-ng has no variant {variant!r} of its voices; use one of: "
            f"{', '.join(variants())}"
        )
    return found


def _checked_voice(voice: str) -> tuple[str, str]:
    """The voice as espeak-ng is told, which must not take a name for a path; its code."""
    language = find_language(voice)
    variant = voice.partition("+")[2]
    return language.identifier + (f"+{variant}" if variant else ""), language.code


def _plain(text: str, brackets: bool = False) -> str:
    """The text as espeak-ng may have it: no control characters, no mnemonics unasked."""
    if len(text) > MAX_CHARACTERS:
        raise LipwrightError(
            f"a text of {len(text)} characters is too long for espeak-ng at once; give it in "
            f"parts of at most {MAX_CHARACTERS}"
        )
    for index, letter in enumerate(text):
        if (ord(letter) < 32 and letter not in "\n\r\t") or 0x7F <= ord(letter) < 0xA0:
            raise LipwrightError(
                f"character {index + 1} of {text[:40]!a} is the control character "
                f"U+{ord(letter):04X}; remove it"
            )
        if 0xD800 <= ord(letter) < 0xE000:
            raise LipwrightError(
                f"character {index + 1} of {text[:40]!a} is half a letter; save the text as UTF-8"
            )
    return text if brackets else text.replace("[[", "((")


def _joined(ipa: str, code: str, separator: str) -> str:
    """The words of a clause, each of its phonemes as it should be."""
    words = ([corrected(one, code) for one in word] for word in _words(ipa))
    return " ".join(separator.join(word) for word in words)


def _words(ipa: str) -> list[list[str]]:
    """The words of a clause and their phonemes, without marks of language."""
    words = ([one for one in word.split(_BETWEEN) if one] for word in _SWITCH.sub("", ipa).split())
    return [word for word in words if word]
