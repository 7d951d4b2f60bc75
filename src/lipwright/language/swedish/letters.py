"""Letters to sounds by rule, for parts of words that no lexicon has.

After Garlén, "Svenskans fonologi" (1988) and Riad, "The Phonology of Swedish" (2014): where the
stress is, whether the stressed vowel is long, and what letters are before front vowels.
"""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import Final

from lipwright.language.swedish.sounds import LONG_R, LONG_VOWELS

_VOWEL: Final = "aeiouyåäöéèàüæø"
_FRONT: Final = "eiyäöéèüø"

_LONG: Final = MappingProxyType({
    "a": "ɑː", "e": "eː", "i": "iː", "o": "uː", "u": "ʉː", "y": "yː", "å": "oː", "ä": "ɛː",
    "ö": "øː", "é": "eː", "è": "ɛː", "à": "ɑː", "ü": "yː", "æ": "ɛː", "ø": "øː",
})  # fmt: skip
_SHORT: Final = MappingProxyType({
    "a": "a", "e": "ɛ", "i": "ɪ", "o": "ɔ", "u": "ɵ", "y": "ʏ", "å": "ɔ", "ä": "ɛ",
    "ö": "œ", "é": "eː", "è": "ɛ", "à": "a", "ü": "ʏ", "æ": "ɛ", "ø": "œ",
})  # fmt: skip

# Ending of a loan, with the stressed vowel in capitals, and its sound where no rule gives it.
_STRESSED_ENDINGS: Final = (
    ("tIOn", "ɧ uː n"), ("ssIOn", "ɧ uː n"), ("sIOn", "ɧ uː n"), ("xIOn", "k ɧ uː n"),
    ("Age", "ɑː ɧ"), ("Ör", ""), ("Ös", ""), ("Era", ""), ("Erar", ""), ("Erad", ""),
    ("Erade", ""), ("Erat", ""), ("Ering", ""), ("Ist", ""), ("Ism", ""), ("itEt", ""),
    ("Ent", ""), ("Ant", ""), ("Ans", ""), ("Ens", ""), ("Ell", ""), ("Ett", ""), ("tEk", ""),
    ("Anda", ""), ("tIs", ""), ("Ik", ""), ("Al", ""), ("Är", ""), ("itOt", ""),
    ("ogrAf", ""), ("ogrAfi", ""), ("logI", ""), ("grafI", ""), ("nomI", ""), ("lOg", "oː ɡ"),
    ("tEt", ""), ("sIv", ""), ("fOn", "oː n"), ("rOn", "uː n"), ("sOf", "oː f"), ("tOr", ""),
    ("Isk", ""), ("Iskt", ""), ("Iska", ""), ("tUr", ""), ("tAt", ""), ("kAt", ""),
    ("rAt", ""), ("An", ""), ("En", ""), ("In", ""), ("Ang", ""), ("Ment", ""), ("itIs", ""),
    ("Oid", ""),
)  # fmt: skip

_UNSTRESSED_PREFIX: Final = re.compile(r"(be|för|ge)(?=[^aeiouyåäö]+[aeiouyåäö][^aeiouyåäö])")

_CONSONANTS: Final = (
    # letters, what must be before, what must follow, sounds
    ("sch", "", "", "ɧ"), ("skj", "", "", "ɧ"), ("stj", "", "", "ɧ"), ("ssj", "", "", "ɧ"),
    ("sj", "", "", "ɧ"), ("sk", "^|be|för|ge", f"[{_FRONT}]", "ɧ"), ("sh", "", "", "ɧ"),
    ("ck", "", "", "k"), ("tch", "", "", "t ɕ"), ("ch", "", "[lrn]", "k"), ("ch", "", "", "ɧ"),
    ("tj", "^|be|för|ge|[lr]", "", "ɕ"), ("kj", "^|be|för", "", "ɕ"),
    ("k", "^|be|för|ge", f"[{_FRONT}]", "ɕ"),
    ("gj", "", "", "j"), ("hj", "", "", "j"), ("dj", "^|be|för", "", "j"), ("lj", "^|be|för",
    "", "j"),
    ("gn", "[aeiouyåäö]", "", "ŋ n"), ("ng", "", "", "ŋ"), ("nk", "", "", "ŋ k"),
    ("nx", "", "", "ŋ k s"), ("g", "[lr]", "$|[ds]", "j"), ("g", "^|be|för|ge", f"[{_FRONT}]", "j"),
    ("gg", "", "", "ɡ"), ("g", "", "t", "k"),
    ("cc", "", f"[{_FRONT}]", "k s"), ("c", "", f"[{_FRONT}]", "s"), ("c", "", "", "k"),
    ("x", "", "", "k s"), ("zz", "", "", "t s"), ("z", "", "", "s"), ("qu", "", "", "k v"),
    ("q", "", "", "k"), ("w", "", "", "v"), ("ph", "", "", "f"), ("th", "", "", "t"),
    ("rh", "", "", "r"), ("dt", "", "", "t"), ("rr", "", "", LONG_R), ("ç", "", "", "s"),
    ("ñ", "", "", "n j"), ("ß", "", "", "s"), ("g", "", "", "ɡ"),
)  # fmt: skip
_VOWEL_PAIRS: Final = (
    ("eau", "oː"), ("au", "a ʊ"), ("eu", "ɛ ɵ"), ("ou", "ʊ"), ("ee", "eː"), ("oo", "uː"),
    ("ai", "a j"), ("ei", "ɛ j"), ("ey", "ɛ j"), ("ay", "ɛ j"), ("aa", "oː"),
)  # fmt: skip


def by_rule(word: str) -> tuple[str, ...]:
    """The sounds of a word or a part of one, in letters of Swedish and its loans."""
    stress, end, ending = _find_stress(word)
    sounds: list[str] = []
    place = 0
    while place < len(word):
        if ending and place == stress:
            sounds += [_mark(sound) for sound in ending.split()]
            place = end
            continue
        length, said = _at(word, place, place == stress)
        if place == stress and said and not any(sound[0] == "ˈ" for sound in said):
            said = [_mark(sound) for sound in said]
        sounds += said
        place += length
    return tuple(sounds)


def _mark(sound: str) -> str:
    return (
        "ˈ" + sound if sound in LONG_VOWELS or sound in _SHORT.values() or sound == "ʊ" else sound
    )


def _find_stress(word: str) -> tuple[int, int, str]:
    """Where the stressed vowel or ending begins, where that ending ends, and its sounds."""
    vowels = [place for place, letter in enumerate(word) if letter in _VOWEL]
    if accents := [place for place in vowels if word[place] in "éèà"]:
        return accents[-1], 0, ""
    for pattern, sounds in _STRESSED_ENDINGS:
        letters = pattern.lower()
        start = len(word) - len(letters)
        if word.endswith(letters) and any(place < start for place in vowels) and start > 1:
            capital = next(i for i, char in enumerate(pattern) if char.isupper())
            if not sounds:
                return start + capital, 0, ""
            first = (
                start
                if sounds[0] not in _LONG.values() and sounds[:2] not in LONG_VOWELS
                else start + capital
            )
            return first, len(word), sounds
    if found := _UNSTRESSED_PREFIX.match(word):
        return next((place for place in vowels if place >= found.end()), 0), 0, ""
    return vowels[0] if vowels else -1, 0, ""


def _at(word: str, place: int, is_stressed: bool) -> tuple[int, list[str]]:
    """How many letters from `place` on are said together, and as what."""
    if word[place] in _VOWEL:
        for letters, sounds in _VOWEL_PAIRS:
            if word.startswith(letters, place):
                return len(letters), sounds.split()
        return 1, [_vowel(word, place, is_stressed)]
    for letters, before, follows, sounds in _CONSONANTS:
        if word.startswith(letters, place):
            rest = word[place + len(letters) :]
            if (not follows or re.match(follows, rest)) and (
                not before or re.search(f"(?:{_anchored(before)})$", word[:place])
            ):
                return len(letters), sounds.split()
    double = 2 if word[place + 1 : place + 2] == word[place] else 1
    return double, [word[place]] if word[place].isalpha() else []


def _anchored(before: str) -> str:
    return "|".join(one if one == "^" or one[0] == "[" else "^" + one for one in before.split("|"))


def _vowel(word: str, place: int, is_stressed: bool) -> str:
    letter, rest = word[place], word[place + 1 :]
    if is_stressed and _is_long(letter, rest):
        return "ˈ" + _LONG[letter]
    if letter == "o" and not is_stressed and re.match(rf"$|r$|[^{_VOWEL}]?[{_VOWEL}]", rest):
        return "ʊ"
    return ("ˈ" if is_stressed else "") + _SHORT[letter]


def _is_long(letter: str, rest: str) -> bool:
    """Whether a stressed vowel is long: before one consonant, or a few pairs of them."""
    follows = re.match(rf"[^{_VOWEL}]*", rest)
    consonants = follows[0] if follows else ""
    is_end = len(consonants) == len(rest)
    if consonants in ("x", "j", "ng", "ck", "sch", "m" if is_end else "x"):
        return False
    if len(consonants) <= 1:
        return True
    if consonants in ("rn", "rd", "rl") or (consonants == "rt" and letter in "au"):
        return letter in "aäåouöe"
    return not is_end and bool(re.fullmatch(r"[bdgvkptf][lrn]", consonants))
