"""German: standard pronunciation as in Mangold, "Duden: Das Aussprachewörterbuch" (2005).

The sounds and their example words follow Kohler, "German" (Journal of the International Phonetic
Association 20, 1990). Of gruut's two lexicons the one made with espeak is used; the other writes
/aɪ/ as "a eː" in 84,000 places and has no stress.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

from lipwright.language.tabled.sounds import plain
from lipwright.language.tabled.values import Amounts, Place, Tables, Way, tokens_mended

_V: Final = "aeiouyøœɛɔɪʊʏəɐ"
_VOWEL: Final = rf"[ˈˌ]?[{_V}ɑɜ]"

SOUNDS: Final = MappingProxyType({
    # vowels
    "a": "kAmm", "aː": "kAm", "ɛ": "bEtt", "ɛː": "bÄte", "eː": "bEEt", "ɪ": "mItte", "iː": "mIEte",
    "ɔ": "mOtte", "oː": "mOOr", "ʊ": "kUnst", "uː": "kUh", "œ": "gÖtter", "øː": "gOEthe",
    "ʏ": "mÜtter", "yː": "mÜhle", "ə": "bittE", "ɐ": "bittER", "ɐ̯": "meeR",
    "aɪ̯": "lEIm", "aʊ̯": "hAUs", "ɔɪ̯": "hÄUser", "ɑ̃": "chANce",
    # consonants
    "p": "Pass", "b": "Bass", "t": "Tasse", "d": "Deich", "k": "Kasse", "ɡ": "Gasse",
    "pf": "PFad", "ts": "Zahl", "tʃ": "maTSCH", "dʒ": "DSCHungel", "m": "Masse", "n": "Nasse",
    "ŋ": "laNGe", "n̩": "habEN", "m̩": "habEN (quickly)", "f": "Fass", "v": "Wasser",
    "s": "reiSSen",
    "z": "reiSen", "ʃ": "SCHal", "ʒ": "Genie", "ç": "diCH", "x": "daCH", "h": "Hasse", "j": "Jacke",
    "l": "Lasse", "ʁ": "Rasse",
})  # fmt: skip

_ESPEAK: Final = tokens_mended(
    ("t s", "ts"), ("p f", "pf"), ("t ʃ", "tʃ"), ("d ʒ", "dʒ"),
    ("a ɪ", "aɪ̯"), ("a ʊ", "aʊ̯"), ("ɔ ø", "ɔɪ̯"),
    ("ɑː|aː|ɜː(?! ɾ)", "aː"), ("ɑ|ʌ", "a"), ("ɔː|o", "oː"), ("ɒ", "ɔ"), ("e", "eː"), ("i", "iː"),
    ("ø", "øː"), ("ɡ|g", "ɡ"), ("θ", "s"), ("ð", "z"), ("w", "v"),
    ("ɐ", "ɐ̯"), ("ɜː", "œ"), (rf"[ɹrɾ](?= {_VOWEL})", "ʁ"), ("ɾ(?= ʁ)", "ɐ̯"),
    ("ə [rɾ]", "ɐ"), ("ɜ", "ɐ"), (r"(?<=[aeiouyøœɛɔɪʊʏː] )[ɾr]", "ɐ̯"), ("[ɹrɾ]", "ʁ"),
)  # fmt: skip

_SYLLABIC: Final = {"p": "m̩", "b": "m̩", "pf": "n̩", "f": "n̩", "v": "n̩"}


def link(word: str, ways: tuple[Way, ...], place: Place) -> tuple[Way, ...]:
    """Add the way of "haben" in fluent speech: -en is a nasal, after p and b with lips shut.

    Kohler 1990.
    """
    del word, place
    more = []
    for way in ways:
        *front, last, schwa, end = ("", "", *way.sounds)
        if (plain(schwa), end) == ("ə", "n") and plain(last)[:1] in tuple("pbtdkɡfvszʃçx"):
            nasal = _SYLLABIC.get(last, "n̩")
            more.append(Way((*filter(None, front), last, nasal), "rule"))
    return (*ways, *more)


AMOUNTS: Final = Amounts(
    num2words="de", comma="komma", minus="minus", plus="plus", to="bis", over="durch",
    percent="prozent",
    months=("januar", "februar", "märz", "april", "mai", "juni", "juli", "august", "september",
            "oktober", "november", "dezember"),
    date="{day} {month} {year}", first_day="erster", day_is="ordinal",
    time="{hour} uhr {minute}", hour="{hour} uhr", hour_words=("uhr",),
    money="{whole} {number}",
    currencies={
        "€": ("euro", "euro", "cent", "cent"), "EUR": ("euro", "euro", "cent", "cent"),
        "$": ("dollar", "dollar", "cent", "cent"), "£": ("pfund", "pfund", "penny", "pence"),
        "¥": ("yen", "yen", "", ""), "CHF": ("franken", "franken", "rappen", "rappen"),
    },
    units={
        "mm": ("millimeter", "millimeter"), "cm": ("zentimeter", "zentimeter"),
        "m": ("meter", "meter"), "km": ("kilometer", "kilometer"),
        "mg": ("milligramm", "milligramm"), "g": ("gramm", "gramm"),
        "kg": ("kilogramm", "kilogramm"), "t": ("tonne", "tonnen"), "l": ("liter", "liter"),
        "ml": ("milliliter", "milliliter"), "h": ("stunde", "stunden"),
        "min": ("minute", "minuten"), "s": ("sekunde", "sekunden"),
        "km/h": ("kilometer pro stunde", "kilometer pro stunde"),
        "m²": ("quadratmeter", "quadratmeter"), "m2": ("quadratmeter", "quadratmeter"),
        "°C": ("grad celsius", "grad celsius"), "°": ("grad", "grad"),
        "Hz": ("hertz", "hertz"), "kHz": ("kilohertz", "kilohertz"), "MB": ("megabyte", "megabyte"),
        "GB": ("gigabyte", "gigabyte"), "kW": ("kilowatt", "kilowatt"), "W": ("watt", "watt"),
    },
    magnitudes={"million": "million", "millionen": "millionen", "mio": "millionen",
                "milliarden": "milliarden", "mrd": "milliarden", "milliarde": "milliarde"},
    ones={"eins": ("ein", "eine")},
    feminine=frozenset(("tonne", "stunde", "minute", "sekunde", "million", "milliarde")),
    ordinals=(("ste|te", "m"),),
    ordinal_before={"": "n", "der": "", "die": "", "das": "", "am": "n", "im": "n", "zum": "n",
                    "vom": "n", "beim": "n", "den": "n", "dem": "n", "des": "n", "ein": "r",
                    "jeder": "", "dieser": "", "ihr": "r", "sein": "r"},
    fractions={"1/2": "ein halb", "1/3": "ein drittel", "2/3": "zwei drittel",
               "1/4": "ein viertel", "3/4": "drei viertel", "1/8": "ein achtel"},
    single_decimals=True, roman="ordinal",
)  # fmt: skip

ABBREVIATIONS: Final = MappingProxyType({
    "z.b": "zum beispiel", "d.h": "das heißt", "u.a": "unter anderem", "usw": "und so weiter",
    "etc": "et cetera", "bzw": "beziehungsweise", "ca": "circa", "dr": "doktor",
    "prof": "professor", "hr": "herr", "fr.": "frau", "hrn": "herrn", "nr": "nummer",
    "str.": "straße",
    "tel.": "telefon", "evtl": "eventuell", "ggf": "gegebenenfalls", "inkl": "inklusive",
    "vgl": "vergleiche", "s.o": "siehe oben", "s.u": "siehe unten", "i.d.r": "in der regel",
    "u.u": "unter umständen", "v.chr": "vor christus", "n.chr": "nach christus", "st.": "sankt",
    "jh": "jahrhundert", "mio": "millionen", "mrd": "milliarden", "max.": "maximal",
    "min.": "minimal", "abs.": "absatz", "art.": "artikel", "bd.": "band", "dipl.": "diplom",
    "ing.": "ingenieur", "gmbh": "ge em be ha", "o.ä": "oder ähnliches", "zzgl": "zuzüglich",
    "mo.": "montag", "di.": "dienstag", "mi.": "mittwoch", "do.": "donnerstag", "sa.": "samstag",
    "jan.": "januar", "feb.": "februar", "apr.": "april", "aug.": "august", "sept.": "september",
    "okt.": "oktober", "nov.": "november", "dez.": "dezember",
})  # fmt: skip

LETTER_NAMES: Final = MappingProxyType({
    "a": "a", "b": "be", "c": "ce", "d": "de", "e": "e", "f": "ef", "g": "ge", "h": "ha",
    "i": "i", "j": "jot", "k": "ka", "l": "el", "m": "em", "n": "en", "o": "o", "p": "pe",
    "q": "ku", "r": "er", "s": "es", "t": "te", "u": "u", "v": "vau", "w": "we", "x": "ix",
    "y": "ypsilon", "z": "zett", "ä": "ä", "ö": "ö", "ü": "ü", "ß": "eszett",
})  # fmt: skip

SAID: Final = MappingProxyType({
    "a": "ˈaː", "be": "b ˈeː", "ce": "ts ˈeː", "e": "ˈeː", "ef": "ˈɛ f", "ge": "ɡ ˈeː",
    "i": "ˈiː", "jot": "j ˈɔ t", "ka": "k ˈaː", "el": "ˈɛ l", "em": "ˈɛ m", "en": "ˈɛ n",
    "o": "ˈoː", "pe": "p ˈeː", "ku": "k ˈuː", "te": "t ˈeː", "u": "ˈuː", "vau": "f ˈaʊ̯",
    "we": "v ˈeː", "ix": "ˈɪ k s", "ypsilon": "ˈʏ p s iː l ɔ n", "zett": "ts ˈɛ t",
    "ä": "ˈɛː", "ö": "ˈøː", "ü": "ˈyː", "eszett": "ɛ s ts ˈɛ t",
    "goethe": "ɡ ˈøː t ə", "lippenstift": "l ˈɪ p ə n ʃ t ˌɪ f t",
    "europa": "ɔɪ̯ ʁ ˈoː p aː",
    "der": "d eː ɐ̯ / d ɐ", "er": "eː ɐ̯ / ɐ", "wer": "v eː ɐ̯", "genie": "ʒ eː n ˈiː",
    "restaurant": "ʁ ɛ s t oː ʁ ˈɑ̃", "chefin": "ʃ ˈɛ f ɪ n",
    "orange": "oː ʁ ˈɑ̃ ʒ ə / oː ʁ ˈa ŋ ʒ ə", "orangen": "oː ʁ ˈɑ̃ ʒ ə n / oː ʁ ˈa ŋ ʒ ə n",
    "orangensaft": "oː ʁ ˈɑ̃ ʒ ə n z ˌa f t / oː ʁ ˈa ŋ ʒ ə n z ˌa f t",
    "champignon": "ʃ ˈa m p ɪ n j ɔ ŋ", "champignons": "ʃ ˈa m p ɪ n j ɔ ŋ s",
    "garage": "ɡ a ʁ ˈaː ʒ ə", "garagen": "ɡ a ʁ ˈaː ʒ ə n", "journal": "ʒ ʊ ʁ n ˈaː l",
    "journalist": "ʒ ʊ ʁ n a l ˈɪ s t", "circa": "ts ˈɪ ʁ k a", "celsius": "ts ˈɛ l z iː ʊ s",
    "wachs": "v ˈa k s", "fuchs": "f ˈʊ k s", "team": "t ˈiː m", "teams": "t ˈiː m s",
    "meeting": "m ˈiː t ɪ ŋ", "cool": "k ˈuː l", "jeans": "dʒ ˈiː n s", "gin": "dʒ ˈɪ n",
    "bücher": "b ˈyː ç ɐ", "ingenieur": "ɪ n ʒ eː n j ˈøː ɐ̯", "baguette": "b a ɡ ˈɛ t",
})  # fmt: skip

TABLES: Final = Tables(
    code="de", name="German", package="gruut_lang_de", lexicons=("espeak",),
    letters="äöüßéèêàâçñô", sounds=SOUNDS, vowels=_V + "ɑ", mends={"espeak": _ESPEAK},
    amounts=AMOUNTS, abbreviations=ABBREVIATIONS,
    symbols={"&": "und", "@": "at", "%": "prozent", "+": "plus", "=": "gleich", "°": "grad",
             "§": "paragraf", "×": "mal", "÷": "geteilt durch", "€": "euro", "$": "dollar",
             "£": "pfund", "#": "raute"},
    address={".": "punkt", "/": "schrägstrich", "@": "at", "-": "minus", "_": "unterstrich"},
    letter_names=LETTER_NAMES, said=SAID, clitics={"'s": "s", "'n": "n", "'ne": "n ə"},
    spelt=frozenset(("usa", "eu", "ard", "zdf", "cdu", "spd", "fdp", "ice", "pc", "tv", "dna")),
    links=(("s", "s"), ("es", "ə s"), ("n", "n"), ("en", "ə n")), link=link,
)  # fmt: skip
"""the language with the code "de" """
