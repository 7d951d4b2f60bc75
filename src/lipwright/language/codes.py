"""Names of languages to our codes: ISO 639, BCP 47 tags and English names.

Our codes are ISO 639-1 where that has one, else 639-3 ("cmn", as "zh" means all of Chinese), with
a region only where its speech is another language to us: "en" is American, "en-gb" British.
Two- and three-letter codes after the code tables of ISO 639-2 (Library of Congress; both its
bibliographic and terminological codes) and ISO 639-3 (SIL), tags after BCP 47 (RFC 5646).
"""

from __future__ import annotations

import difflib
import unicodedata
from types import MappingProxyType
from typing import Final

from lipwright.errors import LipwrightError

# Languages that Lipwright reads itself: code, English name, other codes and names.
_OURS: Final = (
    ("en", "English", "eng american american-english english-us english-united-states"),
    ("en-gb", "English (Britain)",
     "british british-english english-uk english-united-kingdom english-britain en-uk en-ie en-au "
     "en-nz en-za en-in en-sg en-hk en-ke en-ng en-gb-x-rp"),
    ("sv", "Swedish", "swe svenska"),
    ("cmn", "Mandarin", "zh zho chi chinese zh-cmn mandarin-chinese chinese-mandarin guoyu"),
    ("de", "German", "deu ger deutsch"),
    ("es", "Spanish", "spa castilian espanol latin-american-spanish mexican"),
    ("fr", "French", "fra fre francais"),
    ("it", "Italian", "ita italiano"),
    ("nl", "Dutch", "nld dut flemish nederlands"),
    ("pt", "Portuguese", "por portugues brazilian brazilian-portuguese portuguese-brazil"),
    ("ja", "Japanese", "jpn jp nihongo"),
)  # fmt: skip

# Languages that espeak-ng 1.52 reads, by its own code.
_ESPEAK: Final = (
    ("af", "Afrikaans", "afr"),
    ("am", "Amharic", "amh"),
    ("an", "Aragonese", "arg"),
    ("ar", "Arabic", "ara arb"),
    ("as", "Assamese", "asm"),
    ("az", "Azerbaijani", "aze azj"),
    ("ba", "Bashkir", "bak"),
    ("be", "Belarusian", "bel"),
    ("bg", "Bulgarian", "bul"),
    ("bn", "Bengali", "ben bangla"),
    ("bpy", "Bishnupriya Manipuri", ""),
    ("bs", "Bosnian", "bos"),
    ("ca", "Catalan", "cat"),
    ("cs", "Czech", "ces cze"),
    ("cv", "Chuvash", "chv"),
    ("cy", "Welsh", "cym wel"),
    ("da", "Danish", "dan"),
    ("el", "Greek", "ell gre modern-greek"),
    ("eo", "Esperanto", "epo"),
    ("et", "Estonian", "est ekk"),
    ("eu", "Basque", "eus baq"),
    ("fa", "Persian", "fas per farsi pes prs"),
    ("fi", "Finnish", "fin"),
    ("fo", "Faroese", "fao"),
    ("ga", "Irish", "gle gaelic irish-gaelic"),
    ("gd", "Scottish Gaelic", "gla gaelic-scottish"),
    ("gn", "Guarani", "grn gug"),
    ("grc", "Ancient Greek", ""),
    ("gu", "Gujarati", "guj"),
    ("hak", "Hakka Chinese", "zh-hakka"),
    ("haw", "Hawaiian", ""),
    ("he", "Hebrew", "heb iw ivrit"),
    ("hi", "Hindi", "hin"),
    ("hr", "Croatian", "hrv hbs serbo-croatian"),
    ("ht", "Haitian Creole", "hat haitian"),
    ("hu", "Hungarian", "hun"),
    ("hy", "Armenian", "hye arm hy-arevela"),
    ("hyw", "Western Armenian", "hy-arevmda"),
    ("ia", "Interlingua", "ina"),
    ("id", "Indonesian", "ind in"),
    ("io", "Ido", "ido"),
    ("is", "Icelandic", "isl ice"),
    ("jbo", "Lojban", ""),
    ("ka", "Georgian", "kat geo"),
    ("kaa", "Karakalpak", ""),
    ("kk", "Kazakh", "kaz"),
    ("kl", "Greenlandic", "kal kalaallisut"),
    ("kn", "Kannada", "kan"),
    ("ko", "Korean", "kor"),
    ("kok", "Konkani", "gom"),
    ("ku", "Kurdish", "kur kmr kurmanji"),
    ("ky", "Kyrgyz", "kir kirghiz"),
    ("la", "Latin", "lat"),
    ("lb", "Luxembourgish", "ltz"),
    ("lfn", "Lingua Franca Nova", ""),
    ("lt", "Lithuanian", "lit"),
    ("ltg", "Latgalian", ""),
    ("lv", "Latvian", "lav lvs"),
    ("mi", "Māori", "mri mao maori"),
    ("mk", "Macedonian", "mkd mac"),
    ("ml", "Malayalam", "mal"),
    ("mr", "Marathi", "mar"),
    ("ms", "Malay", "msa may zsm"),
    ("mt", "Maltese", "mlt"),
    ("mto", "Totontepec Mixe", ""),
    ("my", "Burmese", "mya bur myanmar"),
    ("nb", "Norwegian Bokmål", "nob no nor nn nno norwegian bokmal nynorsk"),
    ("nci", "Classical Nahuatl", ""),
    ("ne", "Nepali", "nep npi"),
    ("nog", "Nogai", ""),
    ("om", "Oromo", "orm gaz"),
    ("or", "Odia", "ori oriya ory"),
    ("pa", "Punjabi", "pan panjabi"),
    ("pap", "Papiamento", ""),
    ("pl", "Polish", "pol"),
    ("qu", "Quechua", "que quz"),
    ("quc", "K'iche'", ""),
    ("qya", "Quenya", ""),
    ("ro", "Romanian", "ron rum mo mol moldovan"),
    ("ru", "Russian", "rus"),
    ("sd", "Sindhi", "snd"),
    ("shn", "Shan", ""),
    ("si", "Sinhala", "sin sinhalese"),
    ("sjn", "Sindarin", ""),
    ("sk", "Slovak", "slk slo"),
    ("sl", "Slovenian", "slv"),
    ("smj", "Lule Sami", ""),
    ("sq", "Albanian", "sqi alb als"),
    ("sr", "Serbian", "srp"),
    ("sw", "Swahili", "swa swh kiswahili"),
    ("ta", "Tamil", "tam"),
    ("te", "Telugu", "tel"),
    ("th", "Thai", "tha"),
    ("ti", "Tigrinya", "tir"),
    ("tk", "Turkmen", "tuk"),
    ("tn", "Tswana", "tsn setswana"),
    ("tr", "Turkish", "tur"),
    ("tt", "Tatar", "tat"),
    ("ug", "Uyghur", "uig uighur"),
    ("uk", "Ukrainian", "ukr"),
    ("ur", "Urdu", "urd"),
    ("uz", "Uzbek", "uzb uzn"),
    ("vi", "Vietnamese", "vie"),
    ("yue", "Cantonese", "zh-yue zh-hk zh-mo yue-hant yue-hans"),
    # regions and scripts that espeak-ng reads otherwise than the language alone
    ("ca-ba", "Catalan (Balearic)", ""), ("ca-nw", "Catalan (North-western)", ""),
    ("ca-va", "Catalan (Valencian)", "valencian ca-valencia"),
    ("chr-us-qaaa-x-west", "Cherokee", "chr cherokee"),
    ("en-gb-scotland", "English (Scotland)", "en-scotland scottish-english sco-en"),
    ("en-gb-x-gbclan", "English (Lancaster)", ""),
    ("en-gb-x-gbcwmd", "English (West Midlands)", ""),
    ("en-shaw", "English (Shavian)", ""), ("en-us-nyc", "English (New York City)", ""),
    ("fa-latn", "Persian (in Latin letters)", ""),
    ("ru-lv", "Russian (Latvia)", ""), ("ru-cl", "Russian (Classic)", ""),
    ("vi-vn-x-central", "Vietnamese (Central)", ""), ("vi-vn-x-south", "Vietnamese (Southern)", ""),
    ("yue-latn-jyutping", "Cantonese (in Jyutping)", "jyutping"),
    # made languages
    ("piqd", "Klingon", "tlh"), ("py", "Pyash", ""), ("qdb", "Lang Belta", "belter"),
)  # fmt: skip


def _key(name: str) -> str:
    """A code or name as it is looked up: "zh_CN.UTF-8" is "zh-cn", "Māori" is "maori"."""
    plain = unicodedata.normalize("NFKD", name.strip().casefold().partition(".")[0])
    plain = "".join(char for char in plain if not unicodedata.combining(char))
    for char in " _()":
        plain = plain.replace(char, "-")
    return "-".join(part for part in plain.split("-") if part)


NAMES: Final = MappingProxyType({code: name for code, name, _ in (*_OURS, *_ESPEAK)})
"""code to English name: our own languages first, then what espeak-ng adds"""

OURS: Final = tuple(code for code, _, _ in _OURS)
"""the codes of the languages that Lipwright reads itself"""

_CODES: Final = MappingProxyType({
    key: code
    for code, name, also in reversed((*_OURS, *_ESPEAK))
    for key in (*also.split(), _key(name), code)
})  # fmt: skip


def resolve_code(name: str) -> str:
    """Our code of a language.

    Args:
        name: an ISO 639 code, a BCP 47 tag, a locale or an English name: "zh", "cmn-Hans-CN",
            "en_GB.UTF-8", "Swedish". A region or script that changes nothing is left out.

    Raises:
        LipwrightError: no such language; lists ours.
    """
    key = _key(name)
    parts = key.split("-")
    for length in range(len(parts), 0, -1):
        code = _CODES.get("-".join(parts[:length]))
        # Parts that are left must be subtags; else "english-teacher" would be English.
        if code and (length == len(parts) or _are_subtags(parts[length:])):
            return _of_region(code, parts[length:])
    raise LipwrightError(f"unknown language {name[:60]!r}{_suggestion(key)}; {_known()}")


def _are_subtags(parts: list[str]) -> bool:
    """Whether they can be script, region, variants and extensions of a tag (RFC 5646)."""
    return all(part.isascii() and part.isalnum() and len(part) <= 8 for part in parts) and (
        len(parts[0]) in (1, 2, 4) or (len(parts[0]) == 3 and parts[0].isdigit()) or len(parts) > 1
    )


def _of_region(code: str, rest: list[str]) -> str:
    """The code that a region behind script or variant names: "zh-Hant-HK" is Cantonese."""
    for part in rest:
        if (found := _CODES.get(f"{code}-{part}")) is not None:
            return found
        if code == "cmn" and part in ("hk", "mo"):
            return "yue"
    return code


def _suggestion(key: str) -> str:
    close = difflib.get_close_matches(key, _CODES, n=1, cutoff=0.75) if len(key) > 3 else []
    return f" (did you mean {close[0]!r}?)" if close else ""


def _known() -> str:
    return (
        f"use one of: {', '.join(OURS)}; espeak-ng speaks {len(NAMES) - len(OURS)} more, such as "
        "fi, pl, ko, ru, tr, ar and hi: pip install 'lipwright[espeak]'"
    )


def is_english(code: str) -> bool:
    """Whether a code is that of English, of any country."""
    return code.partition("-")[0].casefold() == "en"
