"""Italian: the standard pronunciation, with long consonants.

The sounds and their example words follow Rogers and d'Arcangeli, "Italian" (Journal of the
International Phonetic Association 34, 2004). gruut's lexicon made from a dictionary is asked
first, as it has stress, open vowels and long consonants; the one made with espeak after it.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

from lipwright.language.tabled.values import Amounts, Place, Tables, Way, tokens_mended

SOUNDS: Final = MappingProxyType({
    # vowels
    "i": "vIte", "e": "rEte", "ɛ": "mEta", "a": "rAta", "ɔ": "mOto", "o": "dOve", "u": "mUto",
    # consonants
    "p": "Pane", "b": "Banco", "t": "Tana", "d": "Danno", "k": "Cane", "ɡ": "Gamba",
    "ts": "Zio", "dz": "Zona", "tʃ": "Ciro", "dʒ": "Giro", "m": "Mano", "n": "Nano", "ɲ": "GNomo",
    "ŋ": "aNche", "ɱ": "iNfame", "f": "Fare", "v": "Vano", "s": "Sano", "z": "Sbaglio",
    "ʃ": "SCendo", "ʒ": "garaGe", "l": "Lana", "ʎ": "GLi", "r": "Rana", "j": "Iato", "w": "Uomo",
    # long consonants
    "pː": "caPPa", "bː": "gaBBia", "tː": "faTTo", "dː": "caDDe", "kː": "eCCo", "ɡː": "leGGo",
    "tsː": "piZZa", "dzː": "meZZo", "tʃː": "faCCia", "dʒː": "oGGi", "mː": "maMMa", "nː": "aNNo",
    "ɲː": "baGNo", "fː": "baFFo", "vː": "beVVi", "sː": "caSSa", "ʃː": "faSCia", "lː": "paLLa",
    "ʎː": "fiGLio", "rː": "caRRo",
})  # fmt: skip

_LONG: Final = tuple((f"({single}) [ˈˌ]?{single}", rf"{single}ː") for single in "pbtdkɡmnɲfvsʃlʎr")
_UNTIED: Final = (("t͡s", "ts"), ("d͡z", "dz"), ("t͡ʃ", "tʃ"), ("d͡ʒ", "dʒ"), ("g", "ɡ"))
_AFFRICATES: Final = tuple(
    (rf"{stop} ([ˈˌ]?){stop}{rest}", rf"\g<1>{stop}{rest}ː") for stop, rest in
    (("t", "s"), ("d", "z"), ("t", "ʃ"), ("d", "ʒ"))
)  # fmt: skip
_LEXICON: Final = tokens_mended(*_UNTIED, *_AFFRICATES, *_LONG)
_ESPEAK: Final = tokens_mended(
    ("zː|z z", "z"), ("h", ""), ("t̪", "t"), ("d̪", "d"), ("t̪ː", "tː"), ("ə", "e"),
    ("y", "u"), ("ʌ", "a"), ("ɒ", "ɔ"), ("ɜː", "ɛ"), ("ʁ|ɹ|ɾ", "r"), ("ɪː?", "i"), ("ʊ", "u"),
    *((f"{vowel}ː", vowel) for vowel in "aeiouɛɔ"),
    ("t s", "ts"), ("d z", "dz"), ("t ʃ", "tʃ"), ("d ʒ", "dʒ"),
    ("t sː", "tsː"), ("d zː", "dzː"), ("t ʃː", "tʃː"), ("d ʒː", "dʒː"), *_LONG,
    (r"(?<=[aeiouɛɔ] )([ɲʎ])(?= )", r"\1ː"), (r"(?<=[aeiouɛɔ] )ʃ(?= )", "ʃː"),
    (r"ts i(?= [ˈˌ][aeouɛɔ])", "ts j"), (r"n(?= [kɡ])", "ŋ"),
)  # fmt: skip

_LIPS: Final = frozenset(("p", "b", "m"))


def link(word: str, ways: tuple[Way, ...], place: Place) -> tuple[Way, ...]:
    """The m that n is before lips: "in bocca"; Rogers and d'Arcangeli 2004."""
    del word
    if not place.after_sounds or place.after_sounds[0] not in _LIPS:
        return ways
    return tuple(
        Way((*way.sounds[:-1], "m"), way.source) if way.sounds[-1] == "n" else way for way in ways
    )


def stress(word: str, sounds: tuple[str, ...], vowels: tuple[int, ...]) -> int:
    """A written accent at the end, else the last vowel but one."""
    del sounds
    return vowels[-1] if word[-1:] in "àèéìòóù" or len(vowels) == 1 else vowels[-2]


AMOUNTS: Final = Amounts(
    num2words="it", comma="virgola", minus="meno", plus="più", to="a", over="fratto",
    percent="per cento",
    months=("gennaio", "febbraio", "marzo", "aprile", "maggio", "giugno", "luglio", "agosto",
            "settembre", "ottobre", "novembre", "dicembre"),
    date="{day} {month} {year}", first_day="primo", day_is="cardinal",
    time="{hour} e {minute}", hour="{hour}", hour_words=("ora", "ore"),
    money="{whole} e {number}",
    currencies={
        "€": ("euro", "euro", "centesimo", "centesimi"),
        "EUR": ("euro", "euro", "centesimo", "centesimi"),
        "$": ("dollaro", "dollari", "centesimo", "centesimi"),
        "£": ("sterlina", "sterline", "penny", "pence"), "¥": ("yen", "yen", "", ""),
    },
    units={
        "mm": ("millimetro", "millimetri"), "cm": ("centimetro", "centimetri"),
        "m": ("metro", "metri"), "km": ("chilometro", "chilometri"),
        "mg": ("milligrammo", "milligrammi"), "g": ("grammo", "grammi"), "kg": ("chilo", "chili"),
        "t": ("tonnellata", "tonnellate"), "l": ("litro", "litri"),
        "ml": ("millilitro", "millilitri"),
        "h": ("ora", "ore"), "min": ("minuto", "minuti"), "s": ("secondo", "secondi"),
        "km/h": ("chilometro all'ora", "chilometri all'ora"),
        "m²": ("metro quadrato", "metri quadrati"), "m2": ("metro quadrato", "metri quadrati"),
        "°C": ("grado celsius", "gradi celsius"), "°": ("grado", "gradi"),
        "Hz": ("hertz", "hertz"), "kHz": ("chilohertz", "chilohertz"),
        "MB": ("megabyte", "megabyte"), "GB": ("gigabyte", "gigabyte"),
    },
    magnitudes={"milione": "milione", "milioni": "milioni", "miliardo": "miliardo",
                "miliardi": "miliardi"},
    of="di",
    ones={"uno": ("un", "una")},
    feminine=frozenset(("ora", "ore", "sterlina", "sterline", "tonnellata", "tonnellate")),
    ordinals=(("ª|a", "f"), ("[º°]|o|esimo", "m")),
    fractions={"1/2": "un mezzo", "1/3": "un terzo", "2/3": "due terzi", "1/4": "un quarto",
               "3/4": "tre quarti"},
    roman="ordinal",
)  # fmt: skip

ABBREVIATIONS: Final = MappingProxyType({
    "sig": "signor", "sig.ra": "signora", "sig.na": "signorina", "sigg": "signori",
    "dott": "dottor", "dott.ssa": "dottoressa", "dr": "dottor", "prof": "professor",
    "prof.ssa": "professoressa", "avv": "avvocato", "ing.": "ingegner", "ecc": "eccetera",
    "etc": "eccetera", "es.": "esempio", "p.es": "per esempio", "n.": "numero", "n°": "numero",
    "nº": "numero", "pag.": "pagina", "pagg.": "pagine", "tel.": "telefono", "a.c": "avanti cristo",
    "d.c": "dopo cristo", "ca.": "circa", "s.p.a": "società per azioni",
    "spa": "società per azioni",
    "v.le": "viale", "p.zza": "piazza", "c.so": "corso", "cap.": "capitolo", "vol.": "volume",
    "art.": "articolo", "max.": "massimo", "min.": "minimo", "gen.": "gennaio", "feb.": "febbraio",
    "ott.": "ottobre", "nov.": "novembre", "dic.": "dicembre",
})  # fmt: skip

LETTER_NAMES: Final = MappingProxyType({
    "a": "a", "b": "bi", "c": "ci", "d": "di", "e": "e", "f": "effe", "g": "gi", "h": "acca",
    "i": "i", "j": "i lunga", "k": "cappa", "l": "elle", "m": "emme", "n": "enne", "o": "o",
    "p": "pi", "q": "cu", "r": "erre", "s": "esse", "t": "ti", "u": "u", "v": "vu",
    "w": "vu doppia", "x": "ics", "y": "ipsilon", "z": "zeta",
})  # fmt: skip

SAID: Final = MappingProxyType({
    "bi": "b ˈi", "ci": "tʃ i", "gi": "dʒ ˈi", "acca": "ˈa kː a", "emme": "ˈɛ mː e",
    "enne": "ˈɛ nː e", "effe": "ˈɛ fː e", "elle": "ˈɛ lː e", "erre": "ˈɛ rː e", "esse": "ˈɛ sː e",
    "pi": "p ˈi", "cu": "k ˈu", "ti": "t i", "vu": "v ˈu", "ics": "ˈi k s",
    "ipsilon": "ˈi p s i l o n",
    "e": "e", "è": "ˈɛ", "o": "o", "a": "a", "i": "i", "u": "u", "un": "u n", "casa": "k ˈa s a",
    "zio": "ts ˈi o / dz ˈi o", "zia": "ts ˈi a / dz ˈi a",
    "aiuola": "a j w ˈɔ l a", "due": "d ˈu e",
})  # fmt: skip

TABLES: Final = Tables(
    code="it", name="Italian", package="gruut_lang_it", lexicons=("", "espeak"),
    letters="àèéìíîòóùú", sounds=SOUNDS, vowels="aeiouɛɔ",
    mends={"": _LEXICON, "espeak": _ESPEAK},
    amounts=AMOUNTS, abbreviations=ABBREVIATIONS,
    symbols={"&": "e", "@": "chiocciola", "%": "per cento", "+": "più", "=": "uguale",
             "°": "gradi", "§": "paragrafo", "×": "per", "÷": "diviso", "€": "euro",
             "$": "dollari", "£": "sterline", "#": "cancelletto"},
    address={".": "punto", "/": "barra", "@": "chiocciola", "-": "trattino", "_": "trattino basso"},
    letter_names=LETTER_NAMES, said=SAID,
    clitics={"l'": "l", "un'": "u n", "d'": "d", "c'": "tʃ", "s'": "s", "m'": "m", "t'": "t",
             "v'": "v", "n'": "n", "gl'": "ʎ", "dell'": "d e lː", "all'": "a lː", "nell'": "n e lː",
             "sull'": "s u lː", "dall'": "d a lː", "quell'": "k w e lː", "bell'": "b ɛ lː",
             "quest'": "k w e s t", "sant'": "s a n t", "com'": "k o m", "dov'": "d o v",
             "cos'": "k ɔ s", "anch'": "a ŋ k", "senz'": "s ɛ n ts", "tutt'": "t u tː",
             "mezz'": "m ɛ dzː", "buon'": "b w ɔ n", "qualcos'": "k w a l k ɔ z", "coll'": "k o lː",
             "grand'": "ɡ r a n d", "nient'": "n j ɛ n t", "vent'": "v e n t",
             "trent'": "t r e n t"},
    spelt=frozenset(("usa", "ue", "tv", "dna", "pd", "pc")), stress=stress, link=link,
    guess_plain=True,
)  # fmt: skip
"""the language with the code "it" """
