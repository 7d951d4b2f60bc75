"""Dutch: the standard of the Netherlands.

The sounds and their example words follow Gussenhoven, "Dutch" (Journal of the International
Phonetic Association 22, 1992). Of gruut's two lexicons the one made with espeak is asked first;
the other mixes transcribers, so that "neus" has the vowel of "nog" in it.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

from lipwright.language.tabled.values import Amounts, Place, Tables, Way, tokens_mended

SOUNDS: Final = MappingProxyType({
    # vowels
    "i": "bIEt", "y": "fUUt", "u": "hOEd", "ɪ": "bIt", "ɛ": "bEd", "ɔ": "bOt", "ʏ": "hUt",
    "ɑ": "bAd",
    "eː": "bEEt", "øː": "nEUs", "oː": "bOOt", "aː": "zAAd", "ə": "dE", "ɛi̯": "IJs", "œy̯": "lUId",
    "ɑu̯": "zOUt", "ɛː": "scÈne", "œː": "freUle", "ɔː": "zOne", "ɑ̃": "enquÊte",
    "ɛ̃": "bassIN", "ɔ̃": "chapErON",
    # consonants
    "p": "Pen", "b": "Biet", "t": "Tak", "d": "Dak", "k": "Kat", "ɡ": "Goal", "m": "Mens",
    "n": "Nek",
    "ŋ": "eNG", "ɲ": "oraNJe", "f": "Fiets", "v": "oVen", "s": "Sok", "z": "Zeep", "ʃ": "CHef",
    "ʒ": "Jury", "x": "aCHt", "ɣ": "Gaan", "ɦ": "Hoed", "ʋ": "Wang", "j": "Jas", "l": "Land",
    "r": "Rat",
})  # fmt: skip

_ESPEAK: Final = tokens_mended(
    ("ɛ ɪ", "ɛi̯"), ("œ y", "œy̯"), ("ʌ ʊ", "ɑu̯"), ("ʌ", "ɑ"), ("ɪː", "eː"), ("œ", "œy̯"),
    ("ɵ", "ʏ"), ("iː", "i"), ("uː|ʊ", "u"), ("e", "eː"), ("o|ɔː", "oː"), ("a", "aː"), ("ɒ", "ɔ"),
    ("ɑː", "aː"), ("ɜː", "œː"), ("h", "ɦ"), ("w", "ʋ"), ("[ɹɾ]", "r"), ("g", "ɡ"), ("ð", "d"),
    ("ʲ", "j"), ("θ", "t"),
)  # fmt: skip

_ENDS: Final = ("ə", "n")


def link(word: str, ways: tuple[Way, ...], place: Place) -> tuple[Way, ...]:
    """Add the way without the n of -en, which is usual; Gussenhoven 1992."""
    del place
    if not word.endswith("en") or len(word) < 4:
        return ways
    return (
        *ways,
        *(Way(way.sounds[:-1], "rule") for way in ways[:1] if way.sounds[-2:] == _ENDS),
    )


AMOUNTS: Final = Amounts(
    num2words="nl", comma="komma", minus="min", plus="plus", to="tot", over="gedeeld door",
    percent="procent",
    months=("januari", "februari", "maart", "april", "mei", "juni", "juli", "augustus",
            "september", "oktober", "november", "december"),
    date="{day} {month} {year}", first_day="één", day_is="cardinal",
    time="{hour} uur {minute}", hour="{hour} uur", hour_words=("uur",),
    money="{whole} {number}",
    currencies={
        "€": ("euro", "euro", "cent", "cent"), "EUR": ("euro", "euro", "cent", "cent"),
        "$": ("dollar", "dollar", "cent", "cent"), "£": ("pond", "pond", "penny", "pence"),
        "¥": ("yen", "yen", "", ""),
    },
    units={
        "mm": ("millimeter", "millimeter"), "cm": ("centimeter", "centimeter"),
        "m": ("meter", "meter"), "km": ("kilometer", "kilometer"),
        "mg": ("milligram", "milligram"), "g": ("gram", "gram"), "kg": ("kilo", "kilo"),
        "t": ("ton", "ton"), "l": ("liter", "liter"), "ml": ("milliliter", "milliliter"),
        "u": ("uur", "uur"), "min": ("minuut", "minuten"), "s": ("seconde", "seconden"),
        "km/u": ("kilometer per uur", "kilometer per uur"),
        "km/h": ("kilometer per uur", "kilometer per uur"),
        "m²": ("vierkante meter", "vierkante meter"), "m2": ("vierkante meter", "vierkante meter"),
        "°C": ("graad celsius", "graden celsius"), "°": ("graad", "graden"),
        "Hz": ("hertz", "hertz"), "kHz": ("kilohertz", "kilohertz"),
        "MB": ("megabyte", "megabyte"), "GB": ("gigabyte", "gigabyte"),
    },
    magnitudes={"miljoen": "miljoen", "mln": "miljoen", "miljard": "miljard", "mld": "miljard"},
    ordinals=(("e|de|ste", "m"),),
    fractions={"1/2": "een half", "1/3": "een derde", "2/3": "twee derde", "1/4": "een kwart",
               "3/4": "drie kwart"},
    roman="ordinal",
)  # fmt: skip

ABBREVIATIONS: Final = MappingProxyType({
    "dhr": "de heer", "mevr": "mevrouw", "mw": "mevrouw", "dr": "doctor", "drs": "doctorandus",
    "prof": "professor", "mr.": "meester", "ir.": "ingenieur", "ing.": "ingenieur",
    "bijv": "bijvoorbeeld", "bv.": "bijvoorbeeld", "d.w.z": "dat wil zeggen", "enz": "enzovoort",
    "etc": "et cetera", "o.a": "onder andere", "m.a.w": "met andere woorden",
    "i.p.v": "in plaats van",
    "t/m": "tot en met", "t.a.v": "ten aanzien van", "m.b.t": "met betrekking tot",
    "blz": "bladzijde", "nr": "nummer", "tel.": "telefoon", "ca": "circa", "incl": "inclusief",
    "excl": "exclusief", "evt": "eventueel", "v.chr": "voor christus", "n.chr": "na christus",
    "a.u.b": "alstublieft", "aub": "alstublieft", "st.": "sint", "mln": "miljoen",
    "mld": "miljard", "max.": "maximaal", "min.": "minimaal", "jl": "jongstleden",
    "jan.": "januari", "feb.": "februari", "aug.": "augustus", "sept.": "september",
    "okt.": "oktober", "nov.": "november", "dec.": "december",
})  # fmt: skip

LETTER_NAMES: Final = MappingProxyType({
    "a": "a", "b": "bee", "c": "cee", "d": "dee", "e": "ee", "f": "ef", "g": "gee", "h": "ha",
    "i": "i", "j": "jee", "k": "ka", "l": "el", "m": "em", "n": "en", "o": "o", "p": "pee",
    "q": "ku",
    "r": "er", "s": "es", "t": "tee", "u": "u", "v": "vee", "w": "wee", "x": "ix", "y": "ij",
    "z": "zet",
})  # fmt: skip

SAID: Final = MappingProxyType({
    "a": "ˈaː", "bee": "b ˈeː", "cee": "s ˈeː", "dee": "d ˈeː", "ee": "ˈeː", "ef": "ˈɛ f",
    "gee": "ɣ ˈeː", "ha": "ɦ ˈaː", "i": "ˈi", "jee": "j ˈeː", "ka": "k ˈaː", "el": "ˈɛ l",
    "em": "ˈɛ m", "en": "ɛ n", "o": "ˈoː", "pee": "p ˈeː", "ku": "k ˈy", "er": "ɛ r", "es": "ˈɛ s",
    "tee": "t ˈeː", "u": "ˈy", "vee": "v ˈeː", "wee": "ʋ ˈeː", "ix": "ˈɪ k s", "ij": "ˈɛi̯",
    "zet": "z ˈɛ t", "een": "ə n / ˈeː n", "één": "ˈeː n", "het": "ə t / ɦ ɛ t", "'t": "ə t",
    "'s": "s", "'n": "ə n", "m'n": "m ə n", "z'n": "z ə n", "d'r": "d ə r", "zo'n": "z oː n",
    "chef": "ʃ ˈɛ f", "dat": "d ɑ t", "dit": "d ɪ t", "tot": "t ɔ t", "dicht": "d ˈɪ x t",
    "totdat": "t ɔ t d ˈɑ t", "wonen": "ʋ ˈoː n ə n", "journalist": "ʒ u r n aː l ˈɪ s t",
    "goal": "ɡ ˈoː l", "jury": "ʒ ˈy r i", "ik": "ɪ k / ə k",
})  # fmt: skip

TABLES: Final = Tables(
    code="nl", name="Dutch", package="gruut_lang_nl", lexicons=("espeak",),
    letters="áàäâãéèêëíïîóòöôúùüûçñ", sounds=SOUNDS, vowels="iyuɪɛɔʏɑeøoaəœ",
    mends={"espeak": _ESPEAK}, amounts=AMOUNTS, abbreviations=ABBREVIATIONS,
    symbols={"&": "en", "@": "apenstaartje", "%": "procent", "+": "plus", "=": "is", "°": "graden",
             "§": "paragraaf", "×": "maal", "÷": "gedeeld door", "€": "euro", "$": "dollar",
             "£": "pond", "#": "hekje"},
    address={".": "punt", "/": "slash", "@": "apenstaartje", "-": "streepje", "_": "underscore"},
    letter_names=LETTER_NAMES, said=SAID,
    clitics={"'s": "s", "'t": "ə t", "'n": "ə n", "'k": "k", "'r": "ə r", "d'": "d", "'m": "ə m",
             "'tje": "t j ə", "'er": "ə r", "'en": "ə n"},
    spelt=frozenset(("usa", "eu", "tv", "pvv", "vvd", "cda", "pc", "dna")),
    links=(("s", "s"), ("en", "ə"), ("e", "ə"), ("n", "n")), link=link,
)  # fmt: skip
"""the language with the code "nl" """
