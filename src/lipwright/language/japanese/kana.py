"""Kana to the sounds of Tokyo Japanese.

Sounds after Okada, "Japanese" (Handbook of the International Phonetic Association, 1999), and
Vance, "The Sounds of Japanese" (2008): u is spread or pressed together and never pursed, hu is
bilabial and lets air through, n at a syllable's end takes the place of what follows, so that the
lips shut before p, b and m. Devoicing and pitch are not seen.
"""

from __future__ import annotations

from collections.abc import Iterator
from types import MappingProxyType
from typing import Final

VOWELS: Final = ("a", "i", "ɯ", "e", "o")
NASAL: Final = "ん"
HELD: Final = "っ"
_LENGTH: Final = "ー"

# Five kana of a row, and the consonant of each.
_ROWS: Final = (
    ("あいうえお", ("", "", "", "", "")),
    ("かきくけこ", ("k", "k", "k", "k", "k")), ("がぎぐげご", ("ɡ", "ɡ", "ɡ", "ɡ", "ɡ")),
    ("さしすせそ", ("s", "ɕ", "s", "s", "s")), ("ざじずぜぞ", ("z", "ʑ", "z", "z", "z")),
    ("たちつてと", ("t", "tɕ", "ts", "t", "t")), ("だぢづでど", ("d", "ʑ", "z", "d", "d")),
    ("なにぬねの", ("n", "ɲ", "n", "n", "n")), ("まみむめも", ("m", "m", "m", "m", "m")),
    ("はひふへほ", ("h", "ç", "ɸ", "h", "h")), ("ばびぶべぼ", ("b", "b", "b", "b", "b")),
    ("ぱぴぷぺぽ", ("p", "p", "p", "p", "p")), ("らりるれろ", ("ɾ", "ɾ", "ɾ", "ɾ", "ɾ")),
)  # fmt: skip
# The same, where rows have holes: kana and sounds.
_SINGLE: Final = MappingProxyType({
    "や": "j a", "ゆ": "j ɯ", "よ": "j o", "わ": "w a", "ゐ": "i", "ゑ": "e", "を": "o",
    "ゔ": "b ɯ", "ぁ": "a", "ぃ": "i", "ぅ": "ɯ", "ぇ": "e", "ぉ": "o", "ゃ": "j a", "ゅ": "j ɯ",
    "ょ": "j o", "ゎ": "w a", "ゕ": "k a", "ゖ": "k e",
})  # fmt: skip
# Kana of the i column with a small ya, yu, yo or e; these consonants have the y in them.
_PALATALS: Final = frozenset({"ɕ", "ʑ", "tɕ", "ɲ", "ç"})
_SMALL_Y: Final = MappingProxyType({"ゃ": "a", "ゅ": "ɯ", "ょ": "o", "ぇ": "e"})
# Syllables of words from abroad; v is a b to most speakers (Vance 2008).
_FOREIGN: Final = MappingProxyType({
    "ふぁ": "ɸ a", "ふぃ": "ɸ i", "ふぇ": "ɸ e", "ふぉ": "ɸ o", "ふゅ": "ɸ j ɯ",  # FAito
    "てぃ": "t i", "でぃ": "d i", "とぅ": "t ɯ", "どぅ": "d ɯ", "てゅ": "t j ɯ", "でゅ": "d j ɯ",
    "つぁ": "ts a", "つぃ": "ts i", "つぇ": "ts e", "つぉ": "ts o",  # pittsA
    "すぃ": "s i", "ずぃ": "z i", "いぇ": "j e",
    "うぃ": "w i", "うぇ": "w e", "うぉ": "w o",  # uISUkii
    "くぁ": "k w a", "くぃ": "k w i", "くぇ": "k w e", "くぉ": "k w o", "くゎ": "k w a",
    "ぐぁ": "ɡ w a", "ぐぃ": "ɡ w i", "ぐぇ": "ɡ w e", "ぐぉ": "ɡ w o", "ぐゎ": "ɡ w a",
    "ゔぁ": "b a", "ゔぃ": "b i", "ゔぇ": "b e", "ゔぉ": "b o", "ゔゅ": "b j ɯ",  # baiorin
})  # fmt: skip


def _moras() -> Iterator[tuple[str, tuple[str, ...]]]:
    for row, consonants in _ROWS:
        for kana, consonant, vowel in zip(row, consonants, VOWELS, strict=True):
            yield kana, (consonant, vowel) if consonant else (vowel,)
        if consonant := consonants[1]:
            for small, vowel in _SMALL_Y.items():
                glide = () if consonant in _PALATALS else ("j",)
                yield row[1] + small, (consonant, *glide, vowel)
    for table in (_SINGLE, _FOREIGN):
        for kana, sounds in table.items():
            yield kana, tuple(sounds.split())


MORAS: Final = MappingProxyType(dict(_moras()))
"""hiragana of a mora, one or two letters, to its sounds; not n, small tsu and the long mark"""

# A vowel that lengthens the one before it, by the kana that writes it: toKEI, kyOU, ookII, nEe.
_LENGTHENED: Final = frozenset(
    {("a", "あ"), ("i", "い"), ("ɯ", "う"), ("e", "え"), ("o", "お"), ("e", "い"), ("o", "う"),
     ("a", "ぁ"), ("i", "ぃ"), ("ɯ", "ぅ"), ("e", "ぇ"), ("o", "ぉ")}
)  # fmt: skip
# Verbs whose last u is a syllable of its own: to think, to hesitate, to commute, to pick up, ...
_VERBS_IN_U: Final = ("おもう", "まよう", "かよう", "ひろう", "さそう", "あらそう", "ただよう")

_LIPS: Final = frozenset({"p", "b", "m"})
_TIP: Final = frozenset({"t", "d", "n", "ts", "z", "dz", "ɾ"})
_PALATE: Final = frozenset({"ɲ", "tɕ", "ʑ", "dʑ"})
_BACK: Final = frozenset({"k", "ɡ"})
_CLOSED_FIRST: Final = MappingProxyType({
    "ts": "t", "tɕ": "t", "z": "d", "ʑ": "d",
})  # fmt: skip
"""what is held before an affricate"""
_NOT_HELD: Final = frozenset({*VOWELS, "j", "w", "n", "m", "ɲ", "ɾ", NASAL, ""})
_STRONG: Final = MappingProxyType(
    {"z": "dz", "ʑ": "dʑ"}
)  # at the start, and behind n and small tsu


def to_hiragana(text: str) -> str:
    """Katakana as hiragana; all else as it is."""
    return "".join(
        chr(ord(char) - 0x60) if "ァ" <= char <= "ヶ" or char in "ヽヾ" else char for char in text
    )


def is_kana(char: str) -> bool:
    """Whether it is a letter of hiragana or katakana, the long mark included."""
    return "ぁ" <= char <= "ゖ" or "ァ" <= char <= "ヺ" or char in "ーゝゞヽヾ"


def sounds_of(word: str, following: str = "") -> tuple[str, ...]:
    """The sounds of a word of kana in IPA, long vowels with ː, held consonants twice.

    Args:
        word: kana alone.
        following: the sound that comes right after the word; "" a pause.

    Raises:
        KeyError: something that is no kana.
    """
    sounds = _unassimilated(_repeated(to_hiragana(word)))
    return tuple(
        _assimilated(sounds, at, sounds[at + 1] if at + 1 < len(sounds) else following)
        for at in range(len(sounds))
    )


def _repeated(word: str) -> str:
    """The word with its iteration marks written out; "ゞ" repeats with voice."""
    written = ""
    for char in word:
        repeats = char in "ゝゞ" and written
        written += chr(ord(written[-1]) + (char == "ゞ")) if repeats else char
    return written


def _unassimilated(word: str) -> list[str]:
    """The sounds, with n and small tsu as themselves."""
    sounds: list[str] = []
    at = 0
    while at < len(word):
        kana = word[at : at + 2] if word[at : at + 2] in MORAS else word[at]
        lengthens = not (word in _VERBS_IN_U and at == len(word) - 1)
        at += len(kana)
        last = sounds[-1] if sounds else ""
        if kana in (NASAL, HELD):
            sounds.append(kana)
        elif kana == _LENGTH:
            if last in VOWELS:
                sounds[-1] += "ː"
            elif last.rstrip("ː") in VOWELS:
                sounds.append(last.rstrip("ː"))
        elif (last, kana) in _LENGTHENED and lengthens:
            sounds[-1] += "ː"
        else:
            sounds += MORAS[kana]
    return sounds


def _assimilated(sounds: list[str], at: int, following: str) -> str:
    """The sound at a place, as what stands around it makes it."""
    sound = sounds[at]
    if sound == NASAL:
        return _nasal(following)
    if sound == HELD:
        return "ʔ" if following in _NOT_HELD else _CLOSED_FIRST.get(following, following)
    if at == 0 or sounds[at - 1] in (NASAL, HELD):
        return _STRONG.get(sound, sound)
    return sound


def _nasal(following: str) -> str:
    if following in _LIPS:
        return "m"
    if following in _TIP:
        return "n"
    if following in _PALATE:
        return "ɲ"
    return "ŋ" if following in _BACK else "ɴ"
