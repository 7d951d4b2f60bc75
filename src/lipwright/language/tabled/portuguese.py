"""Portuguese of Brazil.

The sounds and their example words follow Barbosa and Albano, "Brazilian Portuguese" (Journal of
the International Phonetic Association 34, 2004). gruut's lexicon from a dictionary is Brazilian
and has no stress; its other one, made with espeak, is European. Stress follows the spelling.
"""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import Final

from lipwright.language.tabled.sounds import plain
from lipwright.language.tabled.values import Amounts, Place, Tables, Way, tokens_mended

SOUNDS: Final = MappingProxyType({
    # vowels
    "i": "lI", "e": "lÊ", "ɛ": "pÉ", "a": "pÁ", "ɐ": "casA", "ɔ": "pÓ", "o": "avÔ", "u": "tU",
    "ĩ": "vIM", "ẽ": "tEMpo", "ɐ̃": "lÃ", "õ": "sOM", "ũ": "UM",
    "ai̯": "pAI", "ei̯": "lEI", "ɛi̯": "papÉIs", "oi̯": "bOI", "ɔi̯": "dÓI", "ui̯": "fUI",
    "au̯": "pAU", "eu̯": "mEU", "ɛu̯": "cÉU", "iu̯": "vIU", "ou̯": "sOUl", "ɐ̃w̃": "pÃO",
    "ɐ̃j̃": "mÃE", "ẽj̃": "bEM", "õj̃": "pÕE", "ũj̃": "mUIto", "ɔu̯": "sOL", "uu̯": "azUL",
    # consonants
    "p": "Pato", "b": "Bato", "t": "Tato", "d": "Data", "k": "Cato", "ɡ": "Gato", "tʃ": "Tia",
    "dʒ": "Dia", "m": "Mato", "n": "Nato", "ɲ": "piNHa", "f": "Fato", "v": "Vaca", "s": "Sapo",
    "z": "caSa", "ʃ": "CHato", "ʒ": "Jato", "l": "Lata", "ʎ": "paLHa", "ɾ": "caRa", "ʁ": "Rata",
    "j": "IogUrte", "w": "qUatro",
})  # fmt: skip

_GLIDES: Final = tuple(
    (f"{vowel}{glide}", f"{vowel.replace('ɐ', 'a')}{other}")
    for vowel in ("ɐ", "e", "ɛ", "o", "ɔ", "u", "i")
    for glide, other in (("j", "i̯"), ("w", "u̯"))
)
_LEXICON: Final = tokens_mended(
    ("t ʃ", "tʃ"), ("d ʒ", "dʒ"), ("g", "ɡ"), ("ɹ", "ɾ"), ("h", "ʁ"), *_GLIDES,
    (r"j(?! [ˈˌ]?[aeiouɛɔɐĩẽõũ])", "i"),
    ("ɔ w", "ɔu̯"), ("u w", "uu̯"), ("i w(?! [ˈˌ]?[aeiouɛɔɐ])", "iu̯"),
)  # fmt: skip

_ACUTE: Final = "áéíóúâêôàãõ"
_GROUP: Final = re.compile(r"qu(?=[eiéíê])|gu(?=[eiéíê])")
_NUCLEUS: Final = re.compile(
    r"ão|ãe|õe|[áâàã]i?|[éê]u?|[óôõ]i?|[íú]|[aeo][iu](?![mnrl]$|nh)|[ui]i?|[aeo]"
)
_OPEN_END: Final = re.compile(r"(?:[aeo]|am|em|as|es|os|ens)$")


def stress(word: str, sounds: tuple[str, ...], vowels: tuple[int, ...]) -> int:
    """A written accent; else by the ending: the last syllable behind i, u, r, l, z and nasals.

    Cunha and Cintra, "Nova gramática do português contemporâneo" (1985).
    """
    nuclei = [found[0] for found in _NUCLEUS.finditer(_GROUP.sub("k", word))]
    marked = [at for at, text in enumerate(nuclei) if set(text) & set("áéíóúâêô")]
    marked = marked or [at for at, text in enumerate(nuclei) if set(text) & set("ãõ")]
    if marked and len(nuclei) <= len(vowels):
        behind = len(nuclei) - 1 - marked[-1]
    elif marked:
        behind = min(len(nuclei) - 1 - marked[-1], len(vowels) - 1)
    else:
        behind = 1 if _OPEN_END.search(word) else 0
    del sounds
    return vowels[max(0, len(vowels) - 1 - behind)]


def finish(word: str, sounds: tuple[str, ...]) -> tuple[str, ...]:
    """Open a but for an unstressed one at the end, which the lexicon does not tell."""
    del word
    last = next((at for at in range(len(sounds) - 1, -1, -1) if plain(sounds[at]) == "ɐ"), -1)
    at_end = last >= 0 and sounds[last + 1 :] in ((), ("s",), ("z",)) and sounds[last] == "ɐ"
    return tuple(
        sound.replace("ɐ", "a") if plain(sound) == "ɐ" and not (at_end and at == last) else sound
        for at, sound in enumerate(sounds)
    )


_VOICED: Final = frozenset("bdɡvzʒmnɲlʎɾʁ") | {"dʒ"}
_V: Final = "ieɛaɐɔouĩẽɐ̃õũ"


def link(word: str, ways: tuple[Way, ...], place: Place) -> tuple[Way, ...]:
    """The z that a last s is before vowels and voiced consonants: "dos outros", "os dois"."""
    del word
    if not place.after_sounds:
        return ways
    first = plain(place.after_sounds[0])
    if first not in _VOICED and first[0] not in _V:
        return ways
    return tuple(
        Way((*way.sounds[:-1], "z"), way.source) if way.sounds[-1] == "s" else way for way in ways
    )


AMOUNTS: Final = Amounts(
    num2words="pt_BR", comma="vírgula", minus="menos", plus="mais", to="a", over="sobre",
    percent="por cento",
    months=("janeiro", "fevereiro", "março", "abril", "maio", "junho", "julho", "agosto",
            "setembro", "outubro", "novembro", "dezembro"),
    date="{day} de {month} de {year}", first_day="primeiro", day_is="cardinal",
    time="{hour} e {minute}", hour="{hour} horas", hour_words=("hora", "horas", "h"),
    money="{whole} e {cents}",
    currencies={
        "R$": ("real", "reais", "centavo", "centavos"),
        "€": ("euro", "euros", "cêntimo", "cêntimos"),
        "$": ("dólar", "dólares", "centavo", "centavos"),
        "US$": ("dólar", "dólares", "centavo", "centavos"),
        "£": ("libra", "libras", "pêni", "pence"), "¥": ("iene", "ienes", "", ""),
    },
    units={
        "mm": ("milímetro", "milímetros"), "cm": ("centímetro", "centímetros"),
        "m": ("metro", "metros"), "km": ("quilômetro", "quilômetros"),
        "mg": ("miligrama", "miligramas"), "g": ("grama", "gramas"), "kg": ("quilo", "quilos"),
        "t": ("tonelada", "toneladas"), "l": ("litro", "litros"), "ml": ("mililitro", "mililitros"),
        "h": ("hora", "horas"), "min": ("minuto", "minutos"), "s": ("segundo", "segundos"),
        "km/h": ("quilômetro por hora", "quilômetros por hora"),
        "m²": ("metro quadrado", "metros quadrados"), "m2": ("metro quadrado", "metros quadrados"),
        "°C": ("grau celsius", "graus celsius"), "ºC": ("grau celsius", "graus celsius"),
        "°": ("grau", "graus"), "Hz": ("hertz", "hertz"), "kHz": ("quilohertz", "quilohertz"),
        "MB": ("megabyte", "megabytes"), "GB": ("gigabyte", "gigabytes"),
    },
    magnitudes={"milhão": "milhão", "milhões": "milhões", "mil": "mil", "bilhão": "bilhão",
                "bilhões": "bilhões"},
    of="de",
    ones={"um": ("um", "uma"), "dois": ("dois", "duas")},
    feminine=frozenset(("hora", "horas", "libra", "libras", "tonelada", "toneladas")),
    ordinals=((r"\.?ª|a", "f"), (r"\.?[º°]|o", "m")),
    fractions={"1/2": "um meio", "1/3": "um terço", "2/3": "dois terços", "1/4": "um quarto",
               "3/4": "três quartos"},
    roman="ordinal to ten",
)  # fmt: skip

ABBREVIATIONS: Final = MappingProxyType({
    "sr": "senhor", "sra": "senhora", "srta": "senhorita", "dr": "doutor", "dra": "doutora",
    "prof": "professor", "profa": "professora", "d.": "dona", "etc": "et cetera",
    "p.ex": "por exemplo", "ex.": "exemplo", "nº": "número", "n.º": "número", "núm.": "número",
    "pág": "página", "págs": "páginas", "av.": "avenida", "r.": "rua", "tel.": "telefone",
    "vc": "você", "vcs": "vocês", "a.c": "antes de cristo", "d.c": "depois de cristo",
    "ltda": "limitada", "cia": "companhia", "s.a": "sociedade anônima", "eng.": "engenheiro",
    "eua": "estados unidos", "sto": "santo", "sta": "santa", "gov.": "governador",
    "máx.": "máximo", "mín.": "mínimo", "aprox": "aproximadamente", "jan.": "janeiro",
    "fev.": "fevereiro", "ago.": "agosto", "set.": "setembro", "out.": "outubro",
    "nov.": "novembro", "dez.": "dezembro",
})  # fmt: skip

LETTER_NAMES: Final = MappingProxyType({
    "a": "á", "b": "bê", "c": "cê", "d": "dê", "e": "é", "f": "efe", "g": "gê", "h": "agá",
    "i": "i",
    "j": "jota", "k": "cá", "l": "ele", "m": "eme", "n": "ene", "o": "ó", "p": "pê", "q": "quê",
    "r": "erre", "s": "esse", "t": "tê", "u": "u", "v": "vê", "w": "dáblio", "x": "xis",
    "y": "ípsilon", "z": "zê",
})  # fmt: skip

SAID: Final = MappingProxyType({
    "a": "a", "à": "a", "á": "ˈa", "e": "i", "é": "ˈɛ", "o": "u", "ó": "ˈɔ", "i": "ˈi", "u": "ˈu",
    "os": "u s", "bê": "b ˈe", "cê": "s ˈe", "dê": "d ˈe", "gê": "ʒ ˈe", "agá": "a ɡ ˈa",
    "cá": "k ˈa", "pê": "p ˈe", "quê": "k ˈe", "tê": "t ˈe", "vê": "v ˈe", "xis": "ʃ ˈi s",
    "zê": "z ˈe", "eme": "ˈẽ m i", "ene": "ˈẽ n i", "efe": "ˈɛ f i", "erre": "ˈɛ ʁ i",
    "dáblio": "d ˈa b l i u", "ípsilon": "ˈi p s i l õ", "que": "k i", "se": "s i", "de": "dʒ i",
    "do": "d u", "dos": "d u s", "no": "n u", "nos": "n u s", "por": "p o ɾ",
    "põem": "p ˈõj̃", "põem-se": "p ˈõj̃ s i",
    "das": "d a s", "luz": "l ˈu s", "voz": "v ˈɔ s", "faz": "f ˈa s", "dez": "d ˈɛ s",
})  # fmt: skip

TABLES: Final = Tables(
    code="pt", name="Brazilian Portuguese", package="gruut_lang_pt", lexicons=("",),
    letters="áâãàéêíóôõúüç", sounds=SOUNDS, vowels="ieɛaɐɔouĩẽõũ", mends={"": _LEXICON},
    amounts=AMOUNTS, abbreviations=ABBREVIATIONS,
    symbols={"&": "e", "@": "arroba", "%": "por cento", "+": "mais", "=": "igual a", "°": "graus",
             "º": "graus", "§": "parágrafo", "×": "vezes", "÷": "dividido por", "€": "euros",
             "$": "dólares", "£": "libras", "#": "cerquilha"},
    address={".": "ponto", "/": "barra", "@": "arroba", "-": "hífen", "_": "sublinhado"},
    letter_names=LETTER_NAMES, said=SAID,
    clitics={"d'": "d", "l'": "l", "n'": "n", "m'": "m", "t'": "t", "qu'": "k"},
    spelt=frozenset(("usa", "ue", "tv", "dna", "pt", "pc")), stress=stress, finish=finish,
    link=link,
)  # fmt: skip
"""the language with the code "pt", as it is spoken in Brazil"""
