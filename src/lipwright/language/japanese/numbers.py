"""Numbers of Japanese text as they are said, in hiragana."""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import Final

NUMBER: Final = re.compile(r"\d{1,3}(?:,\d{3})+(?:\.\d+)?|\d+(?:\.\d+)?")
_MOST: Final = 16  # digits; longer ones are said digit by digit
_DIGITS: Final = ("ゼロ", "いち", "に", "さん", "よん", "ご", "ろく", "なな", "はち", "きゅう")

# Number and the kana behind it that are said otherwise than one after the other: hours, months,
# people, things, minutes. After "Genki" (Banno et al. 2020), tables of counters.
_COUNTED: Final = MappingProxyType({
    "4じ": "よじ", "7じ": "しちじ", "9じ": "くじ", "4がつ": "しがつ", "7がつ": "しちがつ",
    "9がつ": "くがつ", "1にん": "ひとり", "2にん": "ふたり", "4にん": "よにん", "4ねん": "よねん",
    "4えん": "よえん", "1つ": "ひとつ", "2つ": "ふたつ", "3つ": "みっつ", "4つ": "よっつ",
    "5つ": "いつつ", "6つ": "むっつ", "7つ": "ななつ", "8つ": "やっつ", "9つ": "ここのつ",
    "14じ": "じゅうよじ", "17じ": "じゅうしちじ", "19じ": "じゅうくじ", "20さい": "はたち",
})  # fmt: skip
# Numbers that end shortened before the p, k, s and t of a counter: jUPPUN, haKKAI, iSSAI.
_SHORTENED: Final = (
    ("じゅう", "じゅっ", "ぷかさこそせきけくちたとて"),
    ("いち", "いっ", "ぷぽぱかさこそせきけくちたとて"),
    ("はち", "はっ", "ぷぽぱかさこそせきけくちたとて"), ("ろく", "ろっ", "ぷぽぱかこきけく"),
    ("ひゃく", "ひゃっ", "ぷぽぱかこきけく"),
)  # fmt: skip
_PARTICLES: Final = ("から", "くらい", "ころ", "こそ", "とか", "そして", "それ", "くだ", "です")

SIGNS: Final = MappingProxyType({
    "%": "パーセント", "％": "パーセント", "°C": "ど", "℃": "ど", "km/h": "キロ",
    "km": "キロメートル",
    "cm": "センチメートル", "mm": "ミリメートル",
    "kg": "キログラム", "m": "メートル", "g": "グラム",
    "l": "リットル", "L": "リットル", "ml": "ミリリットル", "°": "ど",
})  # fmt: skip
"""what stands behind a number to how it is said"""
CURRENCIES: Final = MappingProxyType({
    "¥": "えん", "￥": "えん", "$": "ドル", "€": "ユーロ", "£": "ポンド",
})  # fmt: skip
"""what stands before a number to how it is said behind it"""

LETTERS: Final = MappingProxyType({
    "a": "エー", "b": "ビー", "c": "シー", "d": "ディー", "e": "イー", "f": "エフ", "g": "ジー",
    "h": "エイチ", "i": "アイ", "j": "ジェー", "k": "ケー", "l": "エル", "m": "エム", "n": "エヌ",
    "o": "オー", "p": "ピー", "q": "キュー", "r": "アール", "s": "エス", "t": "ティー",
    "u": "ユー", "v": "ブイ", "w": "ダブリュー", "x": "エックス", "y": "ワイ", "z": "ゼット",
})  # fmt: skip
"""Latin letter to its Japanese name"""


def say_number(digits: str, behind: str = "") -> tuple[str, int]:
    """A number in kana with what is behind it, as far as that changes it.

    Args:
        digits: as `NUMBER` finds it.
        behind: the kana right behind it.

    Returns:
        The kana, and how many characters of `behind` are in it.
    """
    plain = digits.replace(",", "")
    for counter in sorted({key.lstrip("0123456789") for key in _COUNTED}, key=len, reverse=True):
        said = _COUNTED.get(plain + counter)
        if said and behind.startswith(counter):
            return said, len(counter)
    said = _say(plain)
    if len(behind) > 1 and not behind.startswith(_PARTICLES):
        for full, short, before in _SHORTENED:
            if said.endswith(full) and behind[0] in before:
                return said.removesuffix(full) + short, 0
    return said, 0


def _say(plain: str) -> str:
    whole, _, decimals = plain.partition(".")
    if len(whole) > _MOST or (whole.startswith("0") and len(whole) > 1):
        said = "".join(_DIGITS[int(digit)] for digit in whole)
    else:
        from num2words import num2words

        said = str(num2words(int(whole), lang="ja", reading=True))
    return said + ("てん" + "".join(_DIGITS[int(digit)] for digit in decimals) if decimals else "")
