"""French: the standard pronunciation of France, with liaison and mute e.

The sounds and their example words follow Fougeron and Smith, "French" (Journal of the
International Phonetic Association 23, 1993). Liaison follows Grevisse and Goosse, "Le bon usage"
(2011): after determiners, pronouns, prepositions and adjectives before their noun it is made,
after "est", "sont" and short adverbs it may be, after "et" never; words with aspirated h and a few
with a glide take none. Of gruut's two lexicons the one made from a dictionary is used; the other
says /z/ in "yeux" alone and marks liaison with "-".
"""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import Final

from lipwright.language.tabled.sounds import plain
from lipwright.language.tabled.values import Amounts, Place, Tables, Way, tokens_mended

_V: Final = "iyueøoɛœɔaɑə"

SOUNDS: Final = MappingProxyType({
    # vowels
    "i": "sI", "e": "cES", "ɛ": "sEt", "a": "pAtte", "ɔ": "mOrt", "o": "sOt", "u": "cOUp",
    "y": "pUr",
    "ø": "cEUx", "œ": "sEUl", "ə": "jE", "ɛ̃": "pAIN", "ɑ̃": "ANge", "ɔ̃": "bON", "œ̃": "brUN",
    # consonants
    "p": "Pas", "b": "Bas", "t": "Tas", "d": "Dos", "k": "Cas", "ɡ": "Gars", "m": "Mais",
    "n": "Non", "ɲ": "aGNeau", "ŋ": "parkiNG", "f": "Feu", "v": "Vous", "s": "Sous", "z": "Zone",
    "ʃ": "CHou", "ʒ": "Joue", "tʃ": "TCHèque", "dʒ": "DJinn", "ʁ": "Roue", "l": "Loup",
    "j": "Yeux", "w": "OUi", "ɥ": "hUIt",
})  # fmt: skip

_LEXICON: Final = tokens_mended(
    ("SIL", ""), ("t ʃ", "tʃ"), ("d ʒ", "dʒ"), ("g", "ɡ"), ("r", "ʁ"), ("h", ""),
)  # fmt: skip

_Z: Final = frozenset(
    ("les", "des", "ces", "mes", "tes", "ses", "nos", "vos", "leurs", "aux", "quelques",
     "plusieurs", "certains", "certaines", "nous", "vous", "ils", "elles", "deux", "trois", "chez",
     "sans", "sous", "dans", "très", "quels", "quelles", "beaux", "gros", "grandes", "grands",
     "petits", "petites", "bonnes", "bons", "autres", "mauvais", "premiers", "dernières",
     "derniers", "vieux", "nouveaux")
)  # fmt: skip
_N: Final = frozenset(("un", "mon", "ton", "son", "aucun", "en", "on", "bien", "rien"))
_N_OPENS: Final = MappingProxyType({"bon": "b ɔ n", "plein": "p l ɛ n", "ancien": "ɑ̃ s j ɛ n",
                                    "prochain": "p ʁ ɔ ʃ ɛ n"})  # fmt: skip
_T: Final = frozenset(
    ("petit", "grand", "quand", "tout", "cet", "vingt", "cent", "saint", "dont", "second")
)
_MAY: Final = MappingProxyType({
    "est": "t", "sont": "t", "ont": "t", "était": "t", "étaient": "t", "fait": "t", "doit": "t",
    "peut": "t", "avait": "t", "font": "t", "vont": "t", "pas": "z", "plus": "z", "moins": "z",
    "mais": "z", "suis": "z", "sommes": "z", "êtes": "z", "jamais": "z", "toujours": "z",
    "avons": "z", "avez": "z", "trop": "p", "beaucoup": "p", "assez": "z", "puis": "z", "fort": "t",
    "premier": "ʁ", "dernier": "ʁ", "léger": "ʁ", "soit": "t", "serait": "t",
    "comment": "t", "cents": "z",
})  # fmt: skip
_MUST: Final = MappingProxyType(
    {**dict.fromkeys(_Z, "z"), **dict.fromkeys(_N, "n"), **dict.fromkeys(_T, "t")}
)

# h that bars elision and liaison ("Le bon usage"), and glides that do
_ASPIRATED: Final = re.compile(
    r"(?:hach|hagar|hai[en]|haine|haïr|hais|haillon|hall|halt|hamac|hameau|hamburger|hamster"
    r"|hanche|hand|hangar|hanneton|hant|happ|harangu|haras|harcel|hard|harem|hareng|hargn|haricot"
    r"|harnais|harp|hasard|hât|hauss|haut|havre|hennir|hér[ié]ss|hernie|héron|héros$|hêtr|heurt"
    r"|hibou|hid|hiérarch|hipp(?:ie|y)|hiss|hobby|hoch|hockey|holland|homard|hongr|hont|hoquet|hors"
    r"|houe|houille|houl|hous|houx|hublot|huée|huer|huit|hurl|hutte|onz|oui|yacht|yaourt|yo[gy]a?"
    r"|week|whisky|web|ouistiti|uhlan)"
)
_SILENT: Final = MappingProxyType({
    "six": ("s i", "z"), "dix": ("d i", "z"), "huit": ("ɥ i", "t"),
})  # fmt: skip
_ONES: Final = frozenset(("deux", "trois", "quatre", "cinq", "six", "sept", "huit", "neuf"))
_BEFORE: Final = MappingProxyType({
    "vingt": ("v ɛ̃ t", _ONES), "neuf": ("n ˈœ v", frozenset(("heures", "ans"))),
})  # fmt: skip
"""word to what it is before certain others"""


def link(word: str, ways: tuple[Way, ...], place: Place) -> tuple[Way, ...]:
    """Liaison before a vowel, the lexicon's liaisons elsewhere left out, and mute e."""
    ways = _with_liaison(word, ways, place)
    return (*ways, *(short for way in ways for short in _without_schwa(way, place)))


def _takes_liaison(place: Place) -> bool:
    after = place.after_sounds
    return (
        bool(after)
        and place.after not in ("et", "ou")
        and plain(after[0])[0] in _V + "jwɥ"
        and not _ASPIRATED.match(place.after)
        and (plain(after[0])[0] in _V or place.after[0] in "aeiouyhéèêâîôûœ")
    )


def _with_liaison(word: str, ways: tuple[Way, ...], place: Place) -> tuple[Way, ...]:
    word = word.rpartition("'")[2]
    takes = _takes_liaison(place)
    if word in _SILENT and place.after:
        return _number(word, ways, takes)
    if word in _BEFORE and place.after in _BEFORE[word][1]:
        return (Way(tuple(_BEFORE[word][0].split()), "rule"),)
    if word in _N_OPENS and takes:
        return (Way(tuple(_N_OPENS[word].split()), "rule"), *ways)
    consonant = _MUST.get(word) or _MAY.get(word)
    alone = tuple(way for way in ways if way.sounds[-1] != consonant)
    if not consonant or not alone:
        return ways
    if not takes:
        return alone
    linked = Way((*alone[0].sounds, consonant), "rule")
    return (linked, *alone) if word in _MUST else (*alone, linked)


def _number(word: str, ways: tuple[Way, ...], takes: bool) -> tuple[Way, ...]:
    """six, dix and huit before another word."""
    bare, consonant = _SILENT[word]
    if takes:
        return (Way((*bare.split(), consonant), "rule"),)
    return (Way(tuple(bare.split()), "rule"), *ways)


def _without_schwa(way: Way, place: Place) -> tuple[Way, ...]:
    """The way without an e that may fall: alone behind a vowel, last, or between VC and CV."""
    for at in range(2, len(way.sounds) - 2):
        around = [plain(sound)[0] in _V for sound in way.sounds[at - 2 : at + 3]]
        if way.sounds[at] == "ə" and around == [True, False, True, False, True]:
            return (Way(way.sounds[:at] + way.sounds[at + 1 :], "rule"),)
    *front, last = way.sounds
    if plain(last) != "ə" or not front:
        return ()
    if len(way.sounds) > 2:
        return (Way(tuple(front), "rule"),)
    follows_vowel = bool(place.before_sounds) and plain(place.before_sounds[-1])[0] in _V
    return (Way(tuple(front), "rule"),) if follows_vowel and place.after else ()


def stress(word: str, sounds: tuple[str, ...], vowels: tuple[int, ...]) -> int:
    """The last vowel that is no schwa."""
    del word
    full = [at for at in vowels if sounds[at] != "ə"]
    return (full or list(vowels))[-1]


AMOUNTS: Final = Amounts(
    num2words="fr", comma="virgule", minus="moins", plus="plus", to="à", over="sur",
    percent="pour cent",
    months=("janvier", "février", "mars", "avril", "mai", "juin", "juillet", "août", "septembre",
            "octobre", "novembre", "décembre"),
    date="{day} {month} {year}", first_day="premier", day_is="cardinal",
    time="{hour} heures {minute}", hour="{hour} heures", hour_words=("heure", "heures", "h"),
    money="{whole} {number}",
    currencies={
        "€": ("euro", "euros", "centime", "centimes"),
        "EUR": ("euro", "euros", "centime", "centimes"),
        "$": ("dollar", "dollars", "cent", "cents"), "£": ("livre", "livres", "penny", "pence"),
        "¥": ("yen", "yens", "", ""), "CHF": ("franc", "francs", "centime", "centimes"),
    },
    units={
        "mm": ("millimètre", "millimètres"), "cm": ("centimètre", "centimètres"),
        "m": ("mètre", "mètres"), "km": ("kilomètre", "kilomètres"),
        "mg": ("milligramme", "milligrammes"), "g": ("gramme", "grammes"), "kg": ("kilo", "kilos"),
        "t": ("tonne", "tonnes"), "l": ("litre", "litres"), "ml": ("millilitre", "millilitres"),
        "h": ("heure", "heures"), "min": ("minute", "minutes"), "s": ("seconde", "secondes"),
        "km/h": ("kilomètre heure", "kilomètres heure"),
        "m²": ("mètre carré", "mètres carrés"), "m2": ("mètre carré", "mètres carrés"),
        "°C": ("degré celsius", "degrés celsius"), "°": ("degré", "degrés"),
        "Hz": ("hertz", "hertz"), "kHz": ("kilohertz", "kilohertz"),
        "Mo": ("mégaoctet", "mégaoctets"),
        "Go": ("gigaoctet", "gigaoctets"),
    },
    magnitudes={"million": "million", "millions": "millions", "milliard": "milliard",
                "milliards": "milliards"},
    of="de",
    ones={"un": ("un", "une")},
    feminine=frozenset(("heure", "heures", "livre", "livres", "tonne", "tonnes", "minute",
                        "minutes", "seconde", "secondes")),
    ordinals=(("re|ère|nde", "f"), ("er|e|è|ème|ième|nd", "m")),
    first=("premier", "première"),
    fractions={"1/2": "un demi", "1/3": "un tiers", "2/3": "deux tiers", "1/4": "un quart",
               "3/4": "trois quarts"},
    roman="cardinal", roman_ranks="er|re|e|è|ème|ère",
)  # fmt: skip

ABBREVIATIONS: Final = MappingProxyType({
    "m.": "monsieur", "mm.": "messieurs", "mme": "madame", "mmes": "mesdames",
    "mlle": "mademoiselle", "mlles": "mesdemoiselles", "dr": "docteur", "pr.": "professeur",
    "me.": "maître", "etc": "et cætera", "c.-à-d": "c'est à dire", "p.ex": "par exemple",
    "p.": "page", "n°": "numéro", "nº": "numéro", "tél.": "téléphone", "av.": "avenue",
    "bd": "boulevard", "st": "saint", "ste": "sainte", "env.": "environ", "vol.": "volume",
    "chap.": "chapitre", "art.": "article", "apr.": "après", "j.-c": "jésus christ",
    "cf": "confer", "max.": "maximum", "min.": "minimum", "svp": "s'il vous plaît",
    "s.v.p": "s'il vous plaît", "janv.": "janvier", "févr.": "février", "juil.": "juillet",
    "sept.": "septembre", "oct.": "octobre", "nov.": "novembre", "déc.": "décembre",
})  # fmt: skip

LETTER_NAMES: Final = MappingProxyType({
    "a": "a", "b": "bé", "c": "cé", "d": "dé", "e": "e", "f": "effe", "g": "gé", "h": "ache",
    "i": "i", "j": "ji", "k": "ka", "l": "elle", "m": "emme", "n": "enne", "o": "o", "p": "pé",
    "q": "ku", "r": "erre", "s": "esse", "t": "té", "u": "u", "v": "vé", "w": "double vé",
    "x": "ixe", "y": "i grec", "z": "zède",
})  # fmt: skip

SAID: Final = MappingProxyType({
    "ne": "n ə", "e": "ə", "i": "i", "o": "o", "u": "y", "y": "i", "a": "a", "à": "a", "bé": "b e",
    "cé": "s e", "dé": "d e", "gé": "ʒ e", "ache": "a ʃ", "ji": "ʒ i", "ka": "k a", "emme": "ɛ m",
    "enne": "ɛ n", "effe": "ɛ f", "erre": "ɛ ʁ", "esse": "ɛ s", "pé": "p e", "ku": "k y",
    "té": "t e",
    "vé": "v e", "ixe": "i k s", "zède": "z ɛ d", "grec": "ɡ ʁ ɛ k", "cætera": "s e t e ʁ a",
    "chat": "ʃ a", "les": "l e", "des": "d e", "un": "œ̃", "est": "ɛ", "plus": "p l y / p l y s",
    "six": "s i s", "dix": "d i s", "tous": "t u / t u s", "en": "ɑ̃", "on": "ɔ̃", "dans": "d ɑ̃",
    "lui": "l ɥ i", "louis": "l w i",
    "hier": "j ɛ ʁ / i j ɛ ʁ", "se": "s ə", "huit": "ɥ i t", "aulnes": "o n",
    "vingt": "v ɛ̃", "gens": "ʒ ɑ̃", "cet": "s ɛ t",
})  # fmt: skip

TABLES: Final = Tables(
    code="fr", name="French", package="gruut_lang_fr", lexicons=("",),
    letters="àâæçéèêëîïôœùûüÿ", sounds=SOUNDS, vowels=_V, mends={"": _LEXICON},
    amounts=AMOUNTS, abbreviations=ABBREVIATIONS,
    symbols={"&": "et", "@": "arobase", "%": "pour cent", "+": "plus", "=": "égale", "°": "degrés",
             "§": "paragraphe", "×": "fois", "÷": "divisé par", "€": "euros", "$": "dollars",
             "£": "livres", "#": "dièse"},
    address={".": "point", "/": "barre", "@": "arobase", "-": "tiret", "_": "tiret bas"},
    letter_names=LETTER_NAMES, said=SAID,
    clitics={"l'": "l", "d'": "d", "j'": "ʒ", "m'": "m", "t'": "t", "s'": "s", "n'": "n", "c'": "s",
             "qu'": "k", "jusqu'": "ʒ y s k", "lorsqu'": "l ɔ ʁ s k", "puisqu'": "p ɥ i s k",
             "quoiqu'": "k w a k", "quelqu'": "k ɛ l k", "presqu'": "p ʁ ɛ s k", "t": "t"},
    spelt=frozenset(("usa", "ue", "pdg", "sncf", "tv", "tgv", "adn", "sa", "pc")),
    joined_by_hyphen=re.compile("-t-(?:il|elle|on)s?$"), stress=stress, link=link,
)  # fmt: skip
"""the language with the code "fr" """
