"""Words that the lexicon lacks, from words that it has: inflected, put together, or guessed."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from types import MappingProxyType
from typing import Final

from lipwright.language.swedish.assimilation import join
from lipwright.language.swedish.letters import by_rule
from lipwright.language.swedish.sounds import is_vowel

Sounds = tuple[str, ...]
Lookup = Callable[[str], tuple[Sounds, ...]]

# Longest first; SAOL and Teleman, Hellberg and Andersson, "Svenska Akademiens grammatik" (1999).
_ENDINGS: Final = MappingProxyType({
    "arnas": "a r n a s", "ornas": "ʊ r n a s", "ernas": "ɛ r n a s", "andes": "a n d ɛ s",
    "heten": "h ˌeː t ɛ n", "heter": "h ˌeː t ɛ r", "ningen": "n ɪ ŋ ɛ n", "ningar": "n ɪ ŋ a r",
    "arna": "a r n a", "orna": "ʊ r n a", "erna": "ɛ r n a", "aste": "a s t ɛ", "ades": "a d ɛ s",
    "ande": "a n d ɛ", "ende": "ɛ n d ɛ", "ning": "n ɪ ŋ", "aren": "a r ɛ n", "ares": "a r ɛ s",
    "het": "h ˌeː t", "are": "a r ɛ", "ast": "a s t", "ade": "a d ɛ", "lig": "l ɪ ɡ",
    "ens": "ɛ n s", "ets": "ɛ t s", "ing": "ɪ ŋ", "iga": "ɪ ɡ a", "isk": "ɪ s k",
    "en": "ɛ n", "et": "ɛ t", "ar": "a r", "or": "ʊ r", "er": "ɛ r", "na": "n a", "at": "a t",
    "ad": "a d", "as": "a s", "te": "t ɛ", "de": "d ɛ", "it": "ɪ t", "ig": "ɪ ɡ", "ts": "t s",
    "ne": "n ɛ", "es": "ɛ s", "tt": "t", "ns": "n s", "rs": "r s", "dd": "d",
    "s": "s", "n": "n", "t": "t", "r": "r", "a": "a", "e": "ɛ", "d": "d",
})  # fmt: skip
"""ending of an inflected or derived word to its sounds"""

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
_UNSTRESSED: Final = frozenset(("be", "för"))
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
_NEVER_PARTS: Final = frozenset((
    "dig", "mig", "sig", "den", "det", "dem", "och", "att", "ett", "hon", "han", "var", "vad",
    "din", "min", "sin", "där", "här", "nej", "när", "ska", "kan", "er", "ens", "men", "som",
    "var", "ger", "tar", "ser", "ner",
))  # fmt: skip
"""words too short and frequent to be taken for parts of compounds"""
_SHORTEST: Final = 3  # letters of a compound's part
_FEWEST: Final = 3  # letters of a stem before an ending
_KNOWN, _INFLECTED, _ENDED, _GUESSED, _LETTER, _SHORT = 1.0, 1.3, 0.7, 2.0, 0.35, 0.6
"""costs of a part of a compound: of the lexicon, inflected, guessed and each of its letters, and
what a part of three letters costs more"""
_DEPTH: Final = 3  # endings upon endings


def inflected(word: str, lookup: Lookup, depth: int = _DEPTH) -> tuple[Sounds, ...]:
    """The ways to say an inflected form of a word that `lookup` has; none if there is no such."""
    if not depth:
        return ()
    for ending, written in _ENDINGS.items():
        stem = word.removesuffix(ending)
        if stem == word or len(stem) < _FEWEST:
            continue
        for base, cut in _bases(stem, ending):
            ways = lookup(base)
            if not ways and len(ending) == 1 and ending in "sn":
                ways = inflected(base, lookup, depth - 1)
            if ways:
                tail = tuple(written.split())
                return tuple(_put(cut(way), tail) for way in ways)
    return ()


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


def _put(base: Sounds, tail: Sounds) -> Sounds:
    if base[-1:] == ("ɡ",) and tail[0] == "t":
        base = (*base[:-1], "k")
    return join((base, tail))


class Compounds:
    """Words as parts, each known, inflected or guessed; the fewest and surest parts win."""

    def __init__(self, lookup: Lookup, guess: Callable[[str], Sounds] = by_rule) -> None:
        """`lookup` knows words; `guess` says what is no word."""
        self._lookup = lookup
        self._guess = guess
        self._parts: dict[tuple[str, bool], tuple[float, Sounds] | None] = {}

    def say(self, word: str) -> tuple[Sounds, bool]:
        """The sounds of a word, and whether each of its parts is known."""
        best: list[tuple[float, tuple[Sounds, ...], bool] | None] = [None] * (len(word) + 1)
        best[0] = (0.0, (), True)
        for end in range(1, len(word) + 1):
            for start in range(end):
                before = best[start]
                if before is None:
                    continue
                for cost, sounds, sure in self._ways(word[start:end], start, end == len(word)):
                    total = before[0] + cost
                    here = best[end]
                    if here is None or total < here[0]:
                        best[end] = (total, (*before[1], sounds), before[2] and sure)
        whole = best[-1]
        assert whole is not None  # the word itself is a part
        return join_parts(whole[1]), whole[2]

    def _ways(self, part: str, start: int, is_last: bool) -> list[tuple[float, Sounds, bool]]:
        """Costs, sounds and sureness of one part, which begins at `start`."""
        if not start and not is_last and part in _FIRST_PARTS:
            return [(_KNOWN, tuple(_FIRST_PARTS[part].split()), True)]
        if start and is_last and part in _LAST_PARTS:
            return [(_ENDED, tuple(_LAST_PARTS[part].split()), True)]
        if len(part) >= _SHORTEST and part not in _NEVER_PARTS:
            known = self._known(part, is_last)
            if known is not None:
                return [(*known, True)]
        is_whole = not start and is_last
        if is_whole or (len(part) > _SHORTEST and any(letter in "aeiouyåäö" for letter in part)):
            return [(_GUESSED + _LETTER * len(part), self._guess(part), False)]
        return []

    def _known(self, part: str, is_last: bool) -> tuple[float, Sounds] | None:
        key = (part, is_last)
        if key not in self._parts:
            self._parts[key] = self._find(part, is_last)
        return self._parts[key]

    def _find(self, part: str, is_last: bool) -> tuple[float, Sounds] | None:
        short = _SHORT if len(part) <= _SHORTEST else 0.0
        if ways := self._lookup(part) or ([] if is_last else self._lookup(part + "-")):
            return _KNOWN + short, ways[0]
        if not is_last:
            if part.endswith("s") and (ways := self._lookup(part[:-1])):
                return _KNOWN + short + 0.1, join((ways[0], ("s",)))
            # A first part loses its last vowel, or changes it: "flick-skola", "kyrko-herde".
            for base in (part + "a", part + "e", part[:-1] + "a", part[:-1] + "e"):
                if len(part) > _SHORTEST and (ways := self._lookup(base)):
                    way = _without_vowel(ways[0])
                    link = _LINKS.get(part[-1]) if len(base) == len(part) else ""
                    if link is not None:
                        return _INFLECTED + short, (*way, *link.split())
        if len(part) > _SHORTEST and (ways := inflected(part, self._lookup)):
            return _INFLECTED + (_SHORT if len(part) < 6 else 0.0), ways[0]
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
