"""Spanish of Castile, with the seseo and yeísmo of most other speakers as second ways.

The sounds and their example words follow Martínez-Celdrán, Fernández-Planas and Carrera-Sabaté,
"Castilian Spanish" (Journal of the International Phonetic Association 33, 2003), and so do the
spirants and the nasals at word edges: b d g are stops after a pause and a nasal (d after l too),
and elsewhere approximants, at which the lips do not shut. Of gruut's two lexicons the one made
with espeak is used, as the other has neither stress nor approximants.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

from lipwright.language.tabled.sounds import plain
from lipwright.language.tabled.values import Amounts, Place, Tables, Way, tokens_mended

SOUNDS: Final = MappingProxyType({
    # vowels
    "a": "pAso", "e": "pEso", "i": "pIso", "o": "pOso", "u": "pUso",
    "ai̯": "bAIle", "ei̯": "pEIne", "oi̯": "hOY", "au̯": "cAUsa", "eu̯": "dEUda", "ou̯": "bOU",
    "i̯": "muY", "u̯": "miAU",
    # consonants
    "p": "Pala", "b": "Bala", "t": "Tela", "d": "Duna", "k": "Cama", "ɡ": "Gama", "β": "haBa",
    "ð": "haDa", "ɣ": "haGa", "tʃ": "muCHo", "m": "Mapa", "n": "Nada", "ɲ": "aÑo", "ŋ": "heNGo",
    "f": "Fama", "θ": "caZa", "s": "caSa", "x": "Jota", "ʝ": "YeSo", "ʃ": "SHow", "l": "Lana",
    "ʎ": "LLano", "ɾ": "caRo", "r": "caRRo", "j": "vIuda", "w": "hUeso",
})  # fmt: skip

_ESPEAK: Final = tokens_mended(
    ("ɾ ɾ", "r"), ("t ʃ", "tʃ"), ("ɛ", "e"), ("ɡ|g", "ɡ"), ("h", "x"), ("ɟ|ʒ", "ʝ"), ("pː", "p"),
    (r"(?<=[aeiou] )j(?= [ˈˌ]?[aeiou])", "ʝ"),
    ("a ɪ", "ai̯"), ("e ɪ", "ei̯"), ("o ɪ", "oi̯"), ("a ʊ", "au̯"), ("e ʊ", "eu̯"), ("o ʊ", "ou̯"),
    (r"(?<=^)ɾ|(?<=[nsl] )ɾ", "r"), ("ɪ", "i̯"), ("ʊ", "u̯"),
)  # fmt: skip

_SPIRANTS: Final = MappingProxyType({"b": "β", "d": "ð", "ɡ": "ɣ"})
_STOPS: Final = MappingProxyType({spirant: stop for stop, spirant in _SPIRANTS.items()})
_NASALS: Final = frozenset("mnɲŋ")
_LIPS: Final = frozenset("pbm")
_ELSEWHERE: Final = MappingProxyType({"θ": "s", "ʎ": "ʝ"})


def finish(word: str, sounds: tuple[str, ...]) -> tuple[str, ...]:
    """The w that ü is, of which the lexicon makes a syllable: "pingüino"."""
    if "ü" not in word:
        return sounds
    done = list(sounds)
    for at in range(1, len(done) - 1):
        around = (plain(done[at - 1]), plain(done[at]), plain(done[at + 1])[0])
        if around[0] in ("ɡ", "ɣ") and around[1] == "u" and around[2] in "ei":
            before = [vowel for vowel in range(at) if plain(done[vowel])[0] in "aeiou"]
            if done[at][0] == "ˈ" and before:  # "bilingüe"
                done[before[-1]] = "ˈ" + plain(done[before[-1]])
            elif done[at][0] == "ˈ":
                done[at + 1] = "ˈ" + plain(done[at + 1])
            done[at] = "w"
    return tuple(done)


def link(word: str, ways: tuple[Way, ...], place: Place) -> tuple[Way, ...]:
    """What b d g are after their neighbour, m for n before lips, and seseo and yeísmo."""
    del word
    linked = []
    for way in ways:
        sounds = list(way.sounds)
        before = plain(place.before_sounds[-1]) if place.before_sounds else ""
        stop = not before or before in _NASALS or (before == "l" and sounds[0] in ("d", "ð"))
        table = _STOPS if stop else _SPIRANTS
        sounds[0] = table.get(sounds[0], sounds[0])
        if sounds[-1] == "n" and place.after_sounds and place.after_sounds[0] in (*_LIPS, "β"):
            sounds[-1] = "m"
        linked.append(Way(tuple(sounds), way.source))
    first = linked[0]
    other = tuple(_ELSEWHERE.get(sound, sound) for sound in first.sounds)
    return (*linked, *((Way(other, "rule"),) if other != first.sounds else ()))


AMOUNTS: Final = Amounts(
    num2words="es", comma="coma", minus="menos", plus="más", to="a", over="partido por",
    percent="por ciento",
    months=("enero", "febrero", "marzo", "abril", "mayo", "junio", "julio", "agosto",
            "septiembre", "octubre", "noviembre", "diciembre"),
    date="{day} de {month} de {year}", first_day="uno", day_is="cardinal",
    time="{hour} y {minute}", hour="{hour}", hour_words=("hora", "horas", "h"),
    money="{whole} con {cents}",
    currencies={
        "€": ("euro", "euros", "céntimo", "céntimos"),
        "EUR": ("euro", "euros", "céntimo", "céntimos"),
        "$": ("dólar", "dólares", "centavo", "centavos"),
        "£": ("libra", "libras", "penique", "peniques"),
        "¥": ("yen", "yenes", "", ""), "US$": ("dólar", "dólares", "centavo", "centavos"),
    },
    units={
        "mm": ("milímetro", "milímetros"), "cm": ("centímetro", "centímetros"),
        "m": ("metro", "metros"), "km": ("kilómetro", "kilómetros"),
        "mg": ("miligramo", "miligramos"), "g": ("gramo", "gramos"), "kg": ("kilo", "kilos"),
        "t": ("tonelada", "toneladas"), "l": ("litro", "litros"), "ml": ("mililitro", "mililitros"),
        "h": ("hora", "horas"), "min": ("minuto", "minutos"), "s": ("segundo", "segundos"),
        "km/h": ("kilómetro por hora", "kilómetros por hora"),
        "m²": ("metro cuadrado", "metros cuadrados"), "m2": ("metro cuadrado", "metros cuadrados"),
        "°C": ("grado centígrado", "grados centígrados"),
        "ºC": ("grado centígrado", "grados centígrados"),
        "°": ("grado", "grados"), "Hz": ("hercio", "hercios"), "kHz": ("kilohercio", "kilohercios"),
        "MB": ("megabyte", "megabytes"), "GB": ("gigabyte", "gigabytes"),
    },
    magnitudes={"millón": "millón", "millones": "millones", "mil": "mil", "billones": "billones"},
    of="de",
    ones={"uno": ("un", "una"), "veintiuno": ("veintiún", "veintiuna")},
    feminine=frozenset(("hora", "horas", "libra", "libras", "tonelada", "toneladas")),
    ordinals=((r"\.?ª|a|ra|da|ta", "f"), (r"\.?(?:[º°]|er)|o|ro|do|to|vo|mo|no", "m")),
    fractions={"1/2": "un medio", "1/3": "un tercio", "2/3": "dos tercios", "1/4": "un cuarto",
               "3/4": "tres cuartos"},
    roman="ordinal to ten",
)  # fmt: skip

ABBREVIATIONS: Final = MappingProxyType({
    "sr": "señor", "sra": "señora", "srta": "señorita", "sres": "señores", "dr": "doctor",
    "dra": "doctora", "d.": "don", "dña": "doña", "prof.": "profesor", "ud": "usted",
    "uds": "ustedes", "vd": "usted", "vds": "ustedes", "etc": "etcétera", "p.ej": "por ejemplo",
    "ej.": "ejemplo", "núm": "número", "nº": "número", "n.º": "número", "pág": "página",
    "págs": "páginas", "av.": "avenida", "avda": "avenida", "c/": "calle", "tel.": "teléfono",
    "aprox": "aproximadamente", "cía": "compañía", "ee.uu": "estados unidos",
    "eeuu": "estados unidos", "a.c": "antes de cristo", "d.c": "después de cristo",
    "s.a": "sociedad anónima", "vol.": "volumen", "gral": "general", "ing.": "ingeniero",
    "lic.": "licenciado", "sto": "santo", "sta": "santa", "depto": "departamento",
    "máx.": "máximo", "mín.": "mínimo", "a.m": "de la mañana", "p.m": "de la tarde",
})  # fmt: skip

LETTER_NAMES: Final = MappingProxyType({
    "a": "a", "b": "be", "c": "ce", "d": "de", "e": "e", "f": "efe", "g": "ge", "h": "hache",
    "i": "i", "j": "jota", "k": "ka", "l": "ele", "m": "eme", "n": "ene", "ñ": "eñe", "o": "o",
    "p": "pe", "q": "cu", "r": "erre", "s": "ese", "t": "te", "u": "u", "v": "uve",
    "w": "uve doble", "x": "equis", "y": "ye", "z": "zeta",
})  # fmt: skip

SAID: Final = MappingProxyType({
    "be": "b ˈe", "ce": "θ ˈe", "ge": "x ˈe", "ka": "k ˈa", "cu": "k ˈu", "eñe": "ˈe ɲ e",
    "uve": "ˈu β e", "ye": "ʝ ˈe", "e": "e", "y": "i", "o": "o", "u": "u", "a": "a",
    "méxico": "m ˈe x i k o", "mexicano": "m e x i k ˈa n o", "mexicana": "m e x i k ˈa n a",
    "texas": "t ˈe x a s", "oaxaca": "o a x ˈa k a", "israel": "i s r a ˈe l",
    "onu": "ˈo n u", "otan": "ˈo t a n", "yo": "ʝ ˈo", "ya": "ʝ ˈa", "muy": "m ˈu i̯",
    "wifi": "w ˈi f i", "google": "ɡ ˈu ɣ l e",
})  # fmt: skip

TABLES: Final = Tables(
    code="es", name="Spanish", package="gruut_lang_es", lexicons=("espeak",),
    letters="áéíóúüñç", sounds=SOUNDS, vowels="aeiou", mends={"espeak": _ESPEAK},
    amounts=AMOUNTS, abbreviations=ABBREVIATIONS,
    symbols={"&": "y", "@": "arroba", "%": "por ciento", "+": "más", "=": "igual a", "°": "grados",
             "º": "grados", "×": "por", "÷": "entre", "€": "euros", "$": "dólares", "£": "libras",
             "#": "almohadilla"},
    address={".": "punto", "/": "barra", "@": "arroba", "-": "guion", "_": "guion bajo"},
    letter_names=LETTER_NAMES, said=SAID,
    spelt=frozenset(("usa", "ue", "iva", "adn", "pp", "dni", "tv", "onu")) - {"onu", "iva"},
    finish=finish, link=link,
)  # fmt: skip
"""the language with the code "es" """
