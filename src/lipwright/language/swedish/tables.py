"""What Swedish writes short and says long."""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

ABBREVIATIONS: Final = MappingProxyType({
    "t.ex": "till exempel", "tex": "till exempel", "bl.a": "bland annat", "osv": "och så vidare",
    "o.s.v": "och så vidare", "m.m": "med mera", "mm.": "med mera", "m.fl": "med flera",
    "mfl": "med flera", "dvs": "det vill säga", "d.v.s": "det vill säga", "fr.o.m": "från och med",
    "from.": "från och med", "t.o.m": "till och med", "tom.": "till och med", "s.k": "så kallad",
    "f.d": "före detta", "p.g.a": "på grund av", "pga": "på grund av", "m.a.o": "med andra ord",
    "i.o.m": "i och med", "o.d": "och dylikt", "o.dyl": "och dylikt", "e.d": "eller dylikt",
    "f.n": "för närvarande", "f.ö": "för övrigt", "fö": "för övrigt",
    "f.v.b": "för vidare befordran",
    "t.v": "tills vidare", "u.a": "utan anmärkning", "e.kr": "efter kristus",
    "f.kr": "före kristus", "a.a": "anfört arbete", "i.e": "det vill säga", "e.g": "till exempel",
    "ca": "cirka", "c:a": "cirka", "kl": "klockan", "nr": "nummer", "st": "stycken",
    "dr": "doktor", "prof.": "professor", "hr": "herr", "resp": "respektive", "ev": "eventuellt",
    "inkl": "inklusive", "exkl": "exklusive", "jfr": "jämför", "tel": "telefon", "kap": "kapitel",
    "sid": "sidan", "forts": "fortsättning", "ung.": "ungefär", "max.": "maximalt",
    "min.": "minst", "mån.": "månader", "tim": "timmar", "sek": "sekunder", "bil.": "bilaga",
    "red.": "redaktör", "övers.": "översättning", "dir.": "direktör", "st.f": "ställföreträdande",
    "s:t": "sankt", "s:ta": "sankta", "s:a": "summa", "kung.": "kunglig", "kgl": "kunglig",
    "c/o": "care of", "mvh": "med vänlig hälsning", "etc": "et cetera", "ang": "angående",
    "obs": "observera", "p.s": "post skriptum", "v.": "vecka", "vs": "versus",
    "jan.": "januari", "feb.": "februari", "febr.": "februari", "aug.": "augusti",
    "sept.": "september", "okt.": "oktober", "nov.": "november", "dec.": "december",
})  # fmt: skip
"""lower case; one that ends in a dot here is one only with its dot, others with or without"""

UNITS: Final = MappingProxyType({
    # as written: one, several, whether one of it is "en"
    "kr": ("krona", "kronor", True), "SEK": ("krona", "kronor", True),
    ":-": ("krona", "kronor", True), "öre": ("öre", "öre", False),
    "mkr": ("miljon kronor", "miljoner kronor", True),
    "tkr": ("tusen kronor", "tusen kronor", False), "€": ("euro", "euro", True),
    "EUR": ("euro", "euro", True), "$": ("dollar", "dollar", True), "USD": ("dollar",
    "dollar", True),
    "£": ("pund", "pund", False), "%": ("procent", "procent", True),
    "‰": ("promille", "promille", True), "mm": ("millimeter", "millimeter", True),
    "cm": ("centimeter", "centimeter", True), "dm": ("decimeter", "decimeter", True),
    "m": ("meter", "meter", True), "km": ("kilometer", "kilometer", True),
    "mil": ("mil", "mil", True), "m²": ("kvadratmeter", "kvadratmeter", True),
    "km²": ("kvadratkilometer", "kvadratkilometer", True),
    "kvm": ("kvadratmeter", "kvadratmeter", True), "m³": ("kubikmeter", "kubikmeter", True),
    "mg": ("milligram", "milligram", False), "g": ("gram", "gram", False),
    "hg": ("hekto", "hekto", False), "kg": ("kilo", "kilo", False), "ton": ("ton", "ton", False),
    "ml": ("milliliter", "milliliter", True), "cl": ("centiliter", "centiliter", True),
    "dl": ("deciliter", "deciliter", True), "l": ("liter", "liter", True),
    "msk": ("matsked", "matskedar", True), "tsk": ("tesked", "teskedar", True),
    "ms": ("millisekund", "millisekunder", True), "s": ("sekund", "sekunder", True),
    "sek": ("sekund", "sekunder", True), "min": ("minut", "minuter", True),
    "h": ("timme", "timmar", True), "tim": ("timme", "timmar", True),
    "km/h": ("kilometer i timmen", "kilometer i timmen", True),
    "km/tim": ("kilometer i timmen", "kilometer i timmen", True),
    "m/s": ("meter per sekund", "meter per sekund", True), "Hz": ("hertz", "hertz", True),
    "kHz": ("kilohertz", "kilohertz", True), "MHz": ("megahertz", "megahertz", True),
    "GHz": ("gigahertz", "gigahertz", True), "dB": ("decibel", "decibel", True),
    "V": ("volt", "volt", True), "W": ("watt", "watt", True), "kW": ("kilowatt", "kilowatt", True),
    "kWh": ("kilowattimme", "kilowattimmar", True), "kB": ("kilobyte", "kilobyte", True),
    "MB": ("megabyte", "megabyte", True), "GB": ("gigabyte", "gigabyte", True),
    "°": ("grad", "grader", True), "°C": ("grad celsius", "grader celsius", True),
    "st": ("styck", "stycken", False), "st.": ("styck", "stycken", False),
    "mn": ("miljon", "miljoner", True), "milj": ("miljon", "miljoner", True),
    "mdr": ("miljard", "miljarder", True), "md": ("miljard", "miljarder", True),
})  # fmt: skip
"""behind a number, case as written"""

COMMON: Final = frozenset(
    ("krona", "kronor", "miljon", "miljoner", "gång", "dag", "timme", "person", "mil")
)
"""nouns of common gender: one of it is "en", not "ett" """

COUNTED: Final = frozenset(("procent", "kronor", "personer", "gånger", "meter"))
"""nouns whose number is no year: "1990 kronor" """

LONE_UNITS: Final = frozenset(
    ("kr", "mm", "cm", "dm", "km", "kg", "mg", "kvm", "km/h", "kHz", "MHz")
)
"""units that are read out without a number too, as none of them is a word"""

SYMBOLS: Final = MappingProxyType({
    "&": "och", "@": "snabel a", "%": "procent", "‰": "promille", "+": "plus", "=": "lika med",
    "°": "grader", "§": "paragraf", "×": "gånger", "÷": "delat med", "±": "plus minus",
    "€": "euro", "$": "dollar", "£": "pund", "#": "nummer", "<": "mindre än", ">": "större än",
    "²": "i kvadrat", "³": "i kubik", "½": "en halv", "¼": "en fjärdedel", "¾": "tre fjärdedelar",
})  # fmt: skip
"""a sign that stands alone or between words"""

ADDRESS_SYMBOLS: Final = MappingProxyType({
    ".": "punkt", "/": "snedstreck", "@": "snabel a", "-": "bindestreck", "_": "understreck",
    ":": "kolon", "?": "frågetecken", "&": "och", "=": "lika med", "+": "plus", "#": "hashtag",
})  # fmt: skip
"""a sign in an e-mail or web address"""

CURRENCIES: Final = frozenset("€$£")
"""signs that stand before a number or behind it"""

MONTHS: Final = (
    "januari", "februari", "mars", "april", "maj", "juni", "juli", "augusti", "september",
    "oktober", "november", "december",
)  # fmt: skip

DENOMINATORS: Final = MappingProxyType({
    2: ("halv", "halva"), 3: ("tredjedel", "tredjedelar"), 4: ("fjärdedel", "fjärdedelar"),
    5: ("femtedel", "femtedelar"), 6: ("sjättedel", "sjättedelar"), 8: ("åttondel", "åttondelar"),
    10: ("tiondel", "tiondelar"), 100: ("hundradel", "hundradelar"),
})  # fmt: skip

NAMED_NUMBERS: Final = MappingProxyType({
    "1": "ettan", "2": "tvåan", "3": "trean", "4": "fyran", "5": "femman", "6": "sexan",
    "7": "sjuan", "8": "åttan", "9": "nian", "10": "tian", "11": "elvan", "12": "tolvan",
})  # fmt: skip
"""what the bus or the child with the number is called: "1:an" """

ROMAN: Final = MappingProxyType({
    "II": 2, "III": 3, "IV": 4, "VI": 6, "VII": 7, "VIII": 8, "IX": 9, "XI": 11, "XII": 12,
    "XIII": 13, "XIV": 14, "XV": 15, "XVI": 16,
})  # fmt: skip
"""behind a name: "Gustav III" is Gustav den tredje"""

SAID_AS_WORDS: Final = frozenset((
    "NATO", "IKEA", "SAAB", "SIDA", "SÄPO", "LAS", "VAB", "PISA", "UNESCO", "UNICEF", "AIDS",
    "NASA", "FIFA", "UEFA", "COVID", "BRIS", "ROT", "RUT", "ICA", "SAS", "OBS", "PIN", "SIM", "LO",
    "MUF", "ABBA", "UNHCR",
))  # fmt: skip
"""words in capitals that are not spelt out"""

LETTERS: Final = str.maketrans({
    "æ": "ä", "Æ": "Ä", "ø": "ö", "Ø": "Ö", "œ": "ö", "Œ": "Ö", "ß": "ss", "ẞ": "SS", "ð": "d",
    "Ð": "D", "þ": "t", "Þ": "T", "ł": "l", "Ł": "L", "đ": "d", "Đ": "D", "ı": "i",
    "ç": "s", "Ç": "S",
})  # fmt: skip
"""Latin letters of other languages that have no accent to take off, in Swedish spelling"""
