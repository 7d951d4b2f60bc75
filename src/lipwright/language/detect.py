"""Which language a text is written in: by its script, its frequent words, then a classifier.

Scripts and frequent words tell most texts at once. What they leave open goes to py3langid
(naive Bayes over byte n-grams, Lui and Baldwin 2012, "langid.py"), which takes most of a second
to load; its evidence and that of the frequent words are added.
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Collection, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any, Final

from lipwright.errors import LipwrightError
from lipwright.language.codes import NAMES, OURS
from lipwright.language.frequent_words import ALPHABETS, FREQUENT_WORDS
from lipwright.language.scripts import SCRIPTS_OF, USUAL, count_scripts, script_of

_ENOUGH: Final = 6_000  # characters of the text that are looked at
_SURE: Final = 0.6  # confidence from which on it is no guess
_DOMINANT: Final = 0.6  # share of the letters

# Chinese characters that Cantonese is written with and Mandarin is not.
_CANTONESE: Final = frozenset("嘅唔佢哋咗喺冇嚟啲嗰咁諗攞")

# Frequent words: a language with so many and so much more than the next is told without more.
_CLEAR_SCORE: Final = 1.0  # a word that no other has
_CLEAR_RATIO: Final = 2.5
_CLEAR_SHARE: Final = 0.2  # of the words
_WORD: Final = re.compile(r"[^\W\d_]+(?:['’][^\W\d_]+)?")
_STRANGE: Final = 0.5  # what a word with a letter that a language lacks counts against it

# The classifier's natural logarithms of likelihood, and what is added to them.
_OURS_LIKELIER: Final = 4.0
_PER_WORD: Final = 4.0  # for each point of the frequent words' score
_LETTERS: Final = 4.0  # letters of a text that may well be wrong
_CLASSES: Final = MappingProxyType({"zh": "cmn", "no": "nb", "nn": "nb"})  # py3langid's to ours

_TONED: Final = re.compile("[a-zü:]*(?:[āáǎàēéěèīíǐìōóǒòūúǔùǖǘǚǜ][a-zü:]*)+|(?:[a-zü:]+[1-5])+")
# Macron, caron and digits; the acute and the grave are of many languages.
_TONES_ONLY: Final = re.compile("[āēīōūǖǎěǐǒǔǚ]|[a-zü][1-5]", re.IGNORECASE)


def detect_language(
    text: str, among: Collection[str] | None = None, source: str = "text"
) -> tuple[str, float]:
    """The code of the language of a text, and how sure that is, from 0 to 1.

    English is always "en".

    Args:
        text: words; a few are enough in most languages.
        among: the codes that it may have; None is all that Lipwright and espeak-ng know.
        source: names the text in errors.

    Raises:
        LipwrightError: it has no letters, or it may be one of several languages.
    """
    sample = text[:_ENOUGH]
    allowed = frozenset(NAMES if among is None else among)
    counts = count_scripts(sample)
    if not counts:
        raise LipwrightError(
            f"{source}: has no letters to tell a language by; name it with --language"
        )
    script = "Kana" if counts["Kana"] and "ja" in allowed else counts.most_common(1)[0][0]
    if script == "Kana" and counts["Latin"] > 3 * (counts["Kana"] + counts["Han"]):
        script = "Latin"
    fitting = [code for code in NAMES if script in SCRIPTS_OF[code] and code in allowed]
    code, confidence = _told(sample, script, fitting)
    if confidence < _SURE:
        raise LipwrightError(
            f"{source}: cannot tell the language of {_short(sample)}; name it with --language"
        )
    return code, confidence


def check_language(text: str, code: str, source: str = "text") -> str:
    """What is odd about a text as one of the language `code`; "" if nothing is.

    Raises:
        LipwrightError: it is written in a script that the language is not; names the place.
    """
    sample = text[:_ENOUGH]
    scripts = SCRIPTS_OF.get(code)
    counts = count_scripts(sample)
    if scripts is None or not counts:
        return ""
    script, count = counts.most_common(1)[0]
    if script not in scripts and count > _DOMINANT * counts.total():
        if script == "Latin" and code not in OURS:
            return f"{source} is written in Latin letters, which {NAMES[code]} is not"
        raise LipwrightError(_misfit(sample, script, code, source))
    if script != "Latin" or scripts[0] != "Latin":
        return ""
    mine = "en" if code == "en-gb" else code
    scores = _scores(_words(sample))
    best = max(scores, key=scores.__getitem__, default=mine)
    if best == mine or not _is_clear(scores, best, len(_words(sample)), scores.get(mine, 0.0)):
        return ""
    return f"{source} looks {NAMES[best]}, not {NAMES[mine]}; if it is, use --language {best}"


def _told(text: str, script: str, fitting: list[str]) -> tuple[str, float]:
    """The likeliest of the languages of a script, and how likely."""
    if script == "Han" and "cmn" in fitting:
        cantonese = "yue" in fitting and len(_CANTONESE.intersection(text)) > 1
        return ("yue", 0.9) if cantonese else ("cmn", 0.95)
    if len(fitting) == 1:
        return fitting[0], 0.99
    if script == "Latin":
        return (
            ("cmn", 0.97) if "cmn" in fitting and _is_pinyin(text) else _told_latin(text, fitting)
        )
    return _classified(text, fitting, {})


def _told_latin(text: str, fitting: list[str]) -> tuple[str, float]:
    """The likeliest of the languages in Latin letters, and how likely."""
    words = _words(text)
    scores = {code: score for code, score in _scores(words).items() if code in fitting}
    best = max(scores, key=scores.__getitem__, default="")
    if best and _is_clear(scores, best, len(words)):
        return best, 0.97
    return _classified(text, [code for code in fitting if SCRIPTS_OF[code][0] == "Latin"], scores)


def _words(text: str) -> list[str]:
    return [
        word.replace("’", "'") for word in _WORD.findall(unicodedata.normalize("NFC", text).lower())
    ]


def _scores(words: list[str]) -> dict[str, float]:
    """How much of a text each language's frequent words are; a word that n share counts 1/n."""
    scores = dict.fromkeys(FREQUENT_WORDS, 0.0)
    for word in words:
        having = [code for code, frequent in FREQUENT_WORDS.items() if word in frequent]
        for code in having:
            scores[code] += 1 / len(having)
        strange = {char for char in word if char > "z"}
        for code, letters in ALPHABETS.items():
            if strange and not strange.issubset(letters):
                scores[code] -= _STRANGE
    return scores


def _is_clear(
    scores: Mapping[str, float], best: str, count: int, other: float | None = None
) -> bool:
    """Whether the best score is so much better than `other`, or the next, that it decides."""
    others = [score for code, score in scores.items() if code != best]
    other = max(others, default=0.0) if other is None else other
    return (
        scores[best] >= max(_CLEAR_SCORE, _CLEAR_SHARE * count)
        and scores[best] >= _CLEAR_RATIO * other
    )  # fmt: skip


def _is_pinyin(text: str) -> bool:
    """Whether a text is pinyin with tones."""
    tokens = [token.strip("\"'.,;:!?()-“”‘’…") for token in text.lower().split()]
    tokens = [unicodedata.normalize("NFC", token) for token in tokens if token]
    toned = sum(bool(_TONED.fullmatch(token)) for token in tokens)
    if toned < (0.4 if _TONES_ONLY.search(text) else 1) * max(len(tokens), 2):
        return False
    from lipwright.language.mandarin.pinyin import NotPinyinError, syllables_of

    read = 0
    for token in tokens:
        try:
            read += bool(syllables_of(token))
        except NotPinyinError:
            continue
    return read >= 0.9 * len(tokens)


def _classified(
    text: str, fitting: Collection[str], scores: Mapping[str, float]
) -> tuple[str, float]:
    """The likeliest language by the classifier and the frequent words' scores."""
    letters = sum(map(str.isalpha, text))
    evidence: dict[str, float] = {}
    for label, likelihood in _classifier().rank(_plain(text)):
        code = _CLASSES.get(label, label)
        if code in fitting:
            total = likelihood + _PER_WORD * scores.get(code, 0.0)
            total += _OURS_LIKELIER * (code in OURS)
            evidence[code] = max(total, evidence.get(code, -math.inf))
    if not evidence:
        return "", 0.0
    best = max(evidence, key=evidence.__getitem__)
    share = 1 / sum(math.exp(max(other - evidence[best], -700)) for other in evidence.values())
    return best, share * letters / (letters + _LETTERS)


@cache
def _classifier() -> Any:
    from py3langid.langid import MODEL_FILE, LanguageIdentifier

    return LanguageIdentifier.from_model_file(MODEL_FILE, norm_probs=False)


def _plain(text: str) -> str:
    """The text as the classifier learnt it: words in lower case, without digits and signs."""
    return " ".join(_words(text)) or text


def _misfit(text: str, script: str, code: str, source: str) -> str:
    at = next(index for index, char in enumerate(text) if script_of(char) == script)
    line = text.count("\n", 0, at) + 1
    column = at - text.rfind("\n", 0, at)
    others = [other for other in NAMES if SCRIPTS_OF[other][0] == script]
    other = USUAL.get(script, others[0] if others else "")
    remedy = f"such as {other}" if other else "that is"
    names = {"Han": "Chinese characters", "Kana": "kana"}
    return (
        f"{source}: line {line}, column {column}: {_short(text[at:])} is written in "
        f"{names.get(script, script + ' letters')}, which {NAMES[code]} is not; "
        f"name a language {remedy} with --language"
    )


def _short(text: str) -> str:
    text = " ".join(text.split())
    return repr(text if len(text) <= 30 else text[:27] + "...")
