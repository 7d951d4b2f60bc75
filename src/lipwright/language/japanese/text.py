"""Japanese text to words: kana, numbers, and words in Latin letters."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.language.base import SpokenWord
from lipwright.language.dictionary import Dictionary, word_key
from lipwright.language.japanese.kana import is_kana
from lipwright.language.japanese.numbers import CURRENCIES, LETTERS, NUMBER, SIGNS, say_number
from lipwright.language.unspaced import split_unspaced

_MARKS: Final = "，。！？、；：…・｡､,.;:!?"
_AROUND: Final = "「」『』（）()〔〕［］[]{}｛｝〈〉《》【】“”\"'‘’*_—–-＝=＆&/／" + _MARKS
_PART: Final = re.compile(
    f'[^{re.escape("，。！？、；：…・｡､")}]+[{re.escape(_MARKS)}]*[」』）)”"]*'
)
_LONGEST: Final = 500  # characters of a word, as in other languages
_SPELT: Final = 5  # capitals, at most
_KATAKANA: Final = r"[ァ-ヺー]+"
_PIECE: Final = re.compile(
    # katakana, then a particle that begins what is behind it, or any other kana
    rf"(?P<kata>{_KATAKANA})|(?P<number>{NUMBER.pattern})|(?P<latin>[A-Za-z]+(?:['’][A-Za-z]+)?)"
    r"|(?P<hira>[ぁ-ゖゝゞー]+)|(?P<other>.)",
    re.DOTALL,
)


def read_text(
    text: str, source: str, dictionary: Dictionary | None = None
) -> tuple[SpokenWord, ...]:
    """The words of `text`, which errors call `source`; kana as written, numbers in kana.

    Raises:
        LipwrightError: no words, a character of Chinese, or none of Japanese; with its place.
    """
    has_kana = any(map(is_kana, unicodedata.normalize("NFKC", text)))
    words: list[SpokenWord] = []
    for written, line, column in split_unspaced(text, source):
        words += _words(written, (source, line, column), dictionary, has_kana)
    if not words:
        raise LipwrightError(f"{source}: has no words; give the words that are spoken")
    return tuple(words)


def _words(
    written: str, place: tuple[str, int, int], dictionary: Dictionary | None, has_kana: bool
) -> Iterator[SpokenWord]:
    """The words in what stands between marks."""
    _, line, column = place
    plain = unicodedata.normalize("NFKC", written).replace("〜", "ー").replace("~", "ー")
    plain = plain.strip(_AROUND)
    for key in (word_key(written), word_key(plain)):
        if dictionary and key and key in dictionary:
            yield SpokenWord(key, written, line, column)
            return
    if plain[:1] in CURRENCIES and (number := NUMBER.match(plain, 1)):
        plain = number[0] + CURRENCIES[plain[0]] + plain[number.end() :]
    at = 0
    spoken = []
    while at < len(plain):
        found = _PIECE.match(plain, at)
        assert found is not None  # the last branch takes anything
        at = found.end()
        if found["number"]:
            said, used = say_number(found[0], _kana_behind(plain, at))
            at += used
            sign = next((key for key in _BY_LENGTH if plain.startswith(key, at)), "")
            at += len(sign)
            spoken.append(said + SIGNS.get(sign, ""))
        elif found["latin"]:
            spoken += _latin(found[0], written, place, has_kana)
        elif found["kata"] or found["hira"]:
            spoken.append(found[0])
        else:
            _refuse(found[0], written, place)
    yield from (SpokenWord(word, written, line, column) for word in _joined(spoken))


_BY_LENGTH: Final = sorted(SIGNS, key=len, reverse=True)


def _kana_behind(text: str, at: int) -> str:
    found = re.compile("[ぁ-ゖァ-ヺー]+").match(text, at)
    return found[0] if found else ""


def _joined(spoken: list[str]) -> list[str]:
    """Hiragana goes with the number or word before it, but for particles behind katakana."""
    joined: list[str] = []
    for word in spoken:
        if joined and word[0] in "はへを" and not _is_hiragana(joined[-1][-1]):
            joined += [word[0], word[1:]] if len(word) > 1 else [word]
        elif joined and _is_hiragana(word[0]) and _is_hiragana(joined[-1][-1]):
            joined[-1] += word
        else:
            joined.append(word)
    return joined


def _is_hiragana(char: str) -> bool:
    return "ぁ" <= char <= "ゖ"


def _latin(letters: str, written: str, place: tuple[str, int, int], has_kana: bool) -> list[str]:
    """Capitals by their names, other words as English says them, in a text with kana."""
    source, line, column = place
    if not has_kana:
        raise LipwrightError(
            f"{source}: line {line}, column {column + max(written.find(letters[0]), 0)}: "
            f"{letters[:40]!r} is in Latin letters; write Japanese in kana, as in 'こんにちは'"
        )
    if (letters.isupper() and len(letters) <= _SPELT) or len(letters) == 1:
        return ["".join(LETTERS[letter] for letter in letters.lower())]
    return [letters.lower().replace("’", "'")]


def _refuse(char: str, written: str, place: tuple[str, int, int]) -> None:
    """Pass over emoji and signs; anything else cannot be read.

    Raises:
        LipwrightError: it is a letter.
    """
    if not char.isalpha():
        return
    source, line, column = place
    column += max(written.find(char), 0)
    name = unicodedata.name(char, "")
    if name.startswith("CJK") or char in "々〆〇":
        raise LipwrightError(
            f"{source}: line {line}, column {column}: {char!r} is no kana, and how it is read here "
            "cannot be told; write the word in kana, as in 'にほんご', or put it into a dictionary"
        )
    raise LipwrightError(
        f"{source}: line {line}, column {column}: {char!r} is no letter of Japanese; write kana"
    )
