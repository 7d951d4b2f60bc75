"""Words that the lexicon lacks, from words that it has: inflected or put together."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from types import MappingProxyType
from typing import Final

from lipwright.language.swedish.assimilation import join
from lipwright.language.swedish.sounds import SHORT_OF, is_vowel, plain

Sounds = tuple[str, ...]
Lookup = Callable[[str], tuple[Sounds, ...]]

# See Teleman, Hellberg and Andersson, "Svenska Akademiens grammatik" (1999).
ENDINGS: Final = MappingProxyType({
    "arnas": "a r n a s", "ornas": "ʊ r n a s", "ernas": "ɛ r n a s", "andes": "a n d ɛ s",
    "heten": "h ˌeː t ɛ n", "heter": "h ˌeː t ɛ r", "ningen": "n ɪ ŋ ɛ n", "ningar": "n ɪ ŋ a r",
    "arna": "a r n a", "orna": "ʊ r n a", "erna": "ɛ r n a", "aste": "a s t ɛ", "ades": "a d ɛ s",
    "ande": "a n d ɛ", "ende": "ɛ n d ɛ", "ning": "n ɪ ŋ", "aren": "a r ɛ n", "ares": "a r ɛ s",
    "het": "h ˌeː t", "are": "a r ɛ", "ast": "a s t", "ade": "a d ɛ", "lig": "l ɪ ɡ",
    "ens": "ɛ n s", "ets": "ɛ t s", "ing": "ɪ ŋ", "iga": "ɪ ɡ a", "isk": "ɪ s k",
    "en": "ɛ n", "et": "ɛ t", "ar": "a r", "or": "ʊ r", "er": "ɛ r", "na": "n a", "at": "a t",
    "ad": "a d", "as": "a s", "te": "t ɛ", "de": "d ɛ", "it": "ɪ t", "ig": "ɪ ɡ", "ts": "t s",
    "es": "ɛ s", "tt": "t", "tte": "t ɛ", "ttes": "t ɛ s", "tts": "t s", "dde": "d ɛ",
    "ddes": "d ɛ s", "ns": "n s", "rs": "r s", "dd": "d",
    "s": "s", "n": "n", "t": "t", "r": "r", "a": "a", "e": "ɛ", "d": "d",
})  # fmt: skip
"""ending of an inflected or derived word to its sounds"""

_LONGEST_FIRST: Final = tuple(sorted(ENDINGS.items(), key=lambda item: len(item[0]), reverse=True))
_LINKS: Final = MappingProxyType({"o": "ʊ", "u": "ɵ", "a": "a", "e": "ɛ"})
"""vowels that a first part may end in instead of its own: "kyrko-gård", "salu-hall" """
_FIRST_PARTS: Final = MappingProxyType({
    "ut": "ˈʉː t", "in": "ˈɪ n", "av": "ˈɑː v", "an": "ˈa n", "på": "p ˈoː", "om": "ˈɔ m",
    "o": "ˈuː", "bi": "b ˈiː", "å": "ˈoː", "ö": "ˈøː", "be": "b ɛ", "för": "f œ r", "ur": "ˈʉː r",
    "vid": "v ˈiː d", "upp": "ˈɵ p", "ned": "n ˈeː d", "till": "t ˈɪ l", "från": "f r ˈoː n",
    "miss": "m ˈɪ s", "sam": "s ˈa m", "van": "v ˈɑː n", "tele": "t ˈeː l ɛ", "is": "ˈiː s",
    "under": "ˈɵ n d ɛ r", "över": "ˈøː v ɛ r", "mot": "m ˈuː t", "med": "m ˈeː d", "al": "ˈɑː l",
    "tv": "t ˈeː v ˌeː", "it": "ˈiː t ˌeː", "eu": "ˈeː ˌʉː", "fn": "ˈɛ f ˌɛ n", "cd": "s ˈeː d ˌeː",
})  # fmt: skip
"""first parts that are short or are said in another way alone"""
_LAST_PARTS: Final = MappingProxyType({
    "lig": "l ɪ ɡ", "ligt": "l ɪ k t", "liga": "l ɪ ɡ a", "sam": "s a m", "samt": "s a m t",
    "samma": "s a m a", "bar": "b ˌɑː r", "bart": "b ˌɑː r t", "bara": "b ˌɑː r a", "dom": "d ʊ m",
    "domen": "d ʊ m ɛ n", "skap": "s k ˌɑː p", "skapet": "s k ˌɑː p ɛ t", "het": "h ˌeː t",
    "heten": "h ˌeː t ɛ n", "heter": "h ˌeː t ɛ r", "vis": "v ˌiː s", "ning": "n ɪ ŋ",
    "nings": "n ɪ ŋ s", "else": "ɛ l s ɛ", "elsen": "ɛ l s ɛ n", "elser": "ɛ l s ɛ r",
    "are": "a r ɛ",
    "inna": "ˌɪ n a", "tion": "ɧ ˌuː n", "tions": "ɧ ˌuː n s", "tionen": "ɧ ˌuː n ɛ n",
    "tioner": "ɧ ˌuː n ɛ r",
})  # fmt: skip
"""endings that are joined to a stem as the last part of a compound is"""
_NEVER_PARTS: Final = frozenset(("erar", "erat", "erad", "tion", "inte", "eller"))
"""words of the lexicon, or forms of them, that look like endings or are never parts of compounds"""
_SHORTEST: Final = 4  # letters of a compound's part
_FEWEST: Final = 3  # letters of a stem before an ending
_LONGEST: Final = 30  # letters of a compound's part
_KNOWN, _INFLECTED, _ENDED, _LINK = 1.0, 1.3, 0.7, 0.1
"""costs of a part of a compound: of the lexicon, inflected, an ending, and a linking s"""
_DEPTH: Final = 3  # endings upon endings


def inflected(word: str, lookup: Lookup, depth: int = _DEPTH) -> tuple[Sounds, ...]:
    """The ways to say an inflected form of a word that `lookup` has; none if there is no such."""
    if not depth:
        return ()
    for ending, written in _LONGEST_FIRST:
        stem = word.removesuffix(ending)
        if stem == word or len(stem) < _FEWEST or _is_doubled(stem, ending):
            continue
        for base, cut in _bases(stem, ending):
            ways = lookup(base)
            if not ways and len(ending) == 1 and ending in "sn":
                ways = inflected(base, lookup, depth - 1)
            if ways:
                tail = tuple(written.split())
                fullest = sorted(ways, key=len, reverse=True)
                cut_ways = (cut(way) for way in fullest)
                if ending[:2] in ("tt", "dd"):
                    cut_ways = (_shortened(way) for way in cut_ways)
                return tuple(_put(way, tail) for way in cut_ways)
    return ()


def _is_doubled(stem: str, ending: str) -> bool:
    """Whether the cut would part a doubled consonant, which shortens the vowel: "vin", "vinn"."""
    if ending[:2] in ("tt", "dd"):
        return stem[-1] not in "aeiouyåäö"
    return stem[-1] == ending[0]


def _bases(stem: str, ending: str) -> list[tuple[str, Callable[[Sounds], Sounds]]]:
    """Words that a stem may be the rest of, and what the ending takes from their sounds."""
    bases: list[tuple[str, Callable[[Sounds], Sounds]]] = [(stem, lambda way: way)]
    if stem[-1] not in "aeouyåäö":
        if ending[0] in "aeioutdn" and ending not in ("n", "t", "a", "e", "d"):
            bases += [(stem + "a", _without_vowel), (stem + "e", _without_vowel)]
        elif ending in ("a", "e", "d"):
            bases += [(stem + "e", _without_vowel), (stem + "a", _without_vowel)]
        if stem[-2:] in ("mm", "nn") and ending[0] in "aeio":
            bases.append((stem[:-1], lambda way: way))
        if ending[0] in "aeo" and stem[-1] in "lrn" and stem[-2] not in "aeiouyåäölrn":
            bases.append((stem[:-1] + "e" + stem[-1], _without_e))
            bases.append((stem[:-1] + "a" + stem[-1], _without_e))
    elif ending in ("r", "n", "s", "t", "tt", "dd", "rs", "ns", "ts", "na", "er", "ende"):
        return bases
    return bases


def _without_vowel(way: Sounds) -> Sounds:
    return way[:-1] if is_vowel(way[-1]) else way


def _without_e(way: Sounds) -> Sounds:
    return way[:-2] + way[-1:] if len(way) > 2 and is_vowel(way[-2]) else way


def _shortened(way: Sounds) -> Sounds:
    """The stem before a doubled consonant: "fri" but "fritt"."""
    last = plain(way[-1])
    return (*way[:-1], way[-1].replace(last, SHORT_OF.get(last, last)))


def _put(base: Sounds, tail: Sounds) -> Sounds:
    if base[-2:] == ("ʊ", "r") and tail[:2] == ("ɛ", "r"):  # "doktor" but "doktorer"
        start = tuple(SHORT_OF.get(plain(sound), plain(sound)) for sound in base[:-2])
        return (*start, "ˈuː", "r", *tail)
    if base[-1:] == ("ɡ",) and tail[0] == "t":
        base = (*base[:-1], "k")
    return join((base, tail))


class Compounds:
    """Words as parts that are known; the fewest and surest parts win."""

    def __init__(self, lookup: Lookup) -> None:
        """`lookup` knows words."""
        self._lookup = lookup
        self._parts: dict[tuple[str, bool], tuple[float, Sounds] | None] = {}

    def say(self, word: str) -> Sounds | None:
        """The sounds of a word whose parts are all known; None if they are not."""
        best: list[tuple[float, tuple[Sounds, ...]] | None] = [None] * (len(word) + 1)
        best[0] = (0.0, ())
        for end in range(1, len(word) + 1):
            for start in range(max(0, end - _LONGEST), end):
                before = best[start]
                part = before and self._part(word[start:end], start, end == len(word))
                if before and part:
                    total, here = before[0] + part[0], best[end]
                    if here is None or total < here[0]:
                        best[end] = (total, (*before[1], part[1]))
        whole = best[-1]
        return join_parts(whole[1]) if whole else None

    def _part(self, part: str, start: int, is_last: bool) -> tuple[float, Sounds] | None:
        """Cost and sounds of one part, which begins at `start`; None if it is not known."""
        if not start and not is_last and part in _FIRST_PARTS:
            return _KNOWN, tuple(_FIRST_PARTS[part].split())
        if start and is_last and part in _LAST_PARTS:
            return _ENDED, tuple(_LAST_PARTS[part].split())
        if len(part) >= _SHORTEST and part not in _NEVER_PARTS:
            return self._known(part, is_last)
        return None

    def _known(self, part: str, is_last: bool) -> tuple[float, Sounds] | None:
        key = (part, is_last)
        if key not in self._parts:
            self._parts[key] = self._find(part, is_last)
        return self._parts[key]

    def _find(self, part: str, is_last: bool) -> tuple[float, Sounds] | None:
        if ways := self._lookup(part) or (() if is_last else self._lookup(part + "-")):
            return _KNOWN, max(ways, key=len)
        if not is_last and (linked := self._linked(part)):
            return linked
        if ways := inflected(part, self._lookup):
            return _INFLECTED, ways[0]
        return None

    def _linked(self, part: str) -> tuple[float, Sounds] | None:
        """A first part with an s, without its last vowel, or with another: "kyrko-gård"."""
        if part.endswith("s") and (ways := self._lookup(part[:-1])):
            return _KNOWN + _LINK, join((ways[0], ("s",)))
        if part.endswith("s") and (ways := self._lookup(part[:-1] + "e")):
            return _INFLECTED, (*_without_vowel(ways[0]), "s")
        for base in (part + "a", part + "e", part[:-1] + "a", part[:-1] + "e"):
            link = _LINKS.get(part[-1]) if len(base) == len(part) else ""
            if link is not None and (ways := self._lookup(base)):
                return _INFLECTED, (*_without_vowel(ways[0]), *link.split())
        return None


def join_parts(parts: Iterable[Sounds]) -> Sounds:
    """The sounds of a compound: its first stress is the main one, the others are lesser."""
    sounds = join(parts)
    stressed = [index for index, sound in enumerate(sounds) if sound[0] in "ˈˌ"]
    if not stressed:
        return sounds
    lesser = tuple(sound.replace("ˈ", "ˌ") for sound in sounds)
    first = stressed[0]
    return (*lesser[:first], lesser[first].replace("ˌ", "ˈ"), *lesser[first + 1 :])
