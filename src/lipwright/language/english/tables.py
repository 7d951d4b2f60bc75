"""What English writes short and says long."""

from __future__ import annotations

from types import MappingProxyType
from typing import Final, Literal

Where = Literal["anywhere", "dot", "title", "dotted title", "number"]
"""where an abbreviation is one: anywhere; with a dot; capitalised before a capitalised word, with
or without a dot, or only with a dot; before a number. Elsewhere it is a word of its own: "no.",
"the rep." """

ABBREVIATIONS: Final = MappingProxyType[str, tuple[str, Where]]({
    # titles
    "mr": ("mister", "anywhere"), "mrs": ("missus", "anywhere"), "dr": ("doctor", "anywhere"),
    "prof": ("professor", "title"), "st": ("saint", "title"), "mt": ("mount", "title"),
    "ft": ("fort", "dotted title"), "gen": ("general", "dotted title"),
    "col": ("colonel", "dotted title"),
    "capt": ("captain", "title"), "lt": ("lieutenant", "title"), "sgt": ("sergeant", "title"),
    "rev": ("reverend", "dotted title"), "hon": ("honorable", "dotted title"),
    "gov": ("governor", "dotted title"),
    "sen": ("senator", "dotted title"), "rep": ("representative", "dotted title"),
    "pres": ("president", "dotted title"),
    "jr": ("junior", "anywhere"), "sr": ("senior", "dot"), "ph.d": ("p h d", "anywhere"),
    "phd": ("p h d", "anywhere"),
    # months and days; "sat.", "sun." and "mon." end sentences
    "jan": ("january", "number"), "feb": ("february", "number"), "mar": ("march", "number"),
    "apr": ("april", "number"), "jun": ("june", "number"), "jul": ("july", "number"),
    "aug": ("august", "number"), "sep": ("september", "number"), "sept": ("september", "number"),
    "oct": ("october", "number"), "nov": ("november", "number"), "dec": ("december", "number"),
    "tues": ("tuesday", "dot"), "thurs": ("thursday", "dot"), "fri": ("friday", "dot"),
    # places and firms
    "ave": ("avenue", "dot"), "blvd": ("boulevard", "anywhere"), "rd": ("road", "dot"),
    "dept": ("department", "anywhere"), "ltd": ("limited", "anywhere"),
    "corp": ("corporation", "dot"),
    "inc": ("incorporated", "dot"), "bros": ("brothers", "dot"), "at&t": ("a t and t", "anywhere"),
    # references and phrases
    "no": ("number", "number"), "nos": ("numbers", "number"), "vol": ("volume", "number"),
    "fig": ("figure", "number"), "p": ("page", "number"), "pp": ("pages", "number"),
    "ch": ("chapter", "number"), "vs": ("versus", "anywhere"), "etc": ("et cetera", "anywhere"),
    "e.g": ("for example", "anywhere"), "i.e": ("that is", "anywhere"), "approx":
    ("approximately", "anywhere"), "est": ("established", "number"),
    "govt": ("government", "anywhere"),
    "misc": ("miscellaneous", "dot"), "w/": ("with", "anywhere"), "w/o": ("without", "anywhere"),
    "24/7": ("twenty four seven", "anywhere"),
})  # fmt: skip
"""lower case without the last dot, to the words and where it is read so"""

UNITS: Final = MappingProxyType[str, tuple[str, str]]({
    "mm": ("millimeter", "millimeters"), "cm": ("centimeter", "centimeters"),
    "m": ("meter", "meters"),
    "km": ("kilometer", "kilometers"), "ft": ("foot", "feet"),
    "yd": ("yard", "yards"), "mi": ("mile", "miles"),
    "mg": ("milligram", "milligrams"), "g": ("gram", "grams"), "kg": ("kilogram", "kilograms"),
    "oz": ("ounce", "ounces"), "lb": ("pound", "pounds"), "lbs": ("pound", "pounds"),
    "ml": ("milliliter", "milliliters"), "mL": ("milliliter", "milliliters"),
    "l": ("liter", "liters"),
    "L": ("liter", "liters"), "gal": ("gallon", "gallons"),
    "ms": ("millisecond", "milliseconds"), "s": ("second", "seconds"), "sec": ("second", "seconds"),
    "min": ("minute", "minutes"), "h": ("hour", "hours"), "hr": ("hour", "hours"), "hrs":
    ("hour", "hours"), "mph": ("mile per hour", "miles per hour"),
    "km/h": ("kilometer per hour", "kilometers per hour"), "kph":
    ("kilometer per hour", "kilometers per hour"), "m/s": ("meter per second", "meters per second"),
    "fps": ("frame per second", "frames per second"),
    "Hz": ("hertz", "hertz"), "kHz": ("kilohertz", "kilohertz"), "MHz": ("megahertz", "megahertz"),
    "GHz": ("gigahertz", "gigahertz"), "dB": ("decibel", "decibels"), "V": ("volt", "volts"),
    "W": ("watt", "watts"), "kW": ("kilowatt", "kilowatts"), "MW": ("megawatt", "megawatts"),
    "kWh": ("kilowatt hour", "kilowatt hours"),
    "KB": ("kilobyte", "kilobytes"), "kB": ("kilobyte", "kilobytes"),
    "MB": ("megabyte", "megabytes"),
    "GB": ("gigabyte", "gigabytes"), "TB": ("terabyte", "terabytes"),
    "°": ("degree", "degrees"), "°C": ("degree celsius", "degrees celsius"),
    "°F": ("degree fahrenheit", "degrees fahrenheit"), "%": ("percent", "percent"),
    "¢": ("cent", "cents"), "k": ("thousand", "thousand"), "K": ("thousand", "thousand"),
    "bn": ("billion", "billion"), "px": ("pixel", "pixels"),
})  # fmt: skip
"""behind a number, case as written, to one and several"""

LONE_UNITS: Final = frozenset((
    "mm", "cm", "km", "mg", "kg", "lbs", "mph", "km/h", "kph", "kHz", "MHz", "GHz",
))  # fmt: skip
"""units that are read out without a number as well, as none of them is a word"""

CURRENCIES: Final = MappingProxyType[str, tuple[str, str, str, str]]({
    "$": ("dollar", "dollars", "cent", "cents"), "£": ("pound", "pounds", "penny", "pence"),
    "€": ("euro", "euros", "cent", "cents"), "¥": ("yen", "yen", "sen", "sen"),
    "₹": ("rupee", "rupees", "paisa", "paise"),
})  # fmt: skip
"""sign to one and several, whole and hundredth"""

MAGNITUDES: Final = MappingProxyType[str, str]({
    "k": "thousand", "K": "thousand", "thousand": "thousand", "m": "million", "M": "million",
    "mn": "million", "million": "million", "b": "billion", "B": "billion", "bn": "billion",
    "billion": "billion", "tn": "trillion", "trillion": "trillion",
})  # fmt: skip
"""what follows an amount of money, to its word"""

SYMBOLS: Final = MappingProxyType[str, str]({
    "&": "and", "@": "at", "%": "percent", "+": "plus", "=": "equals", "°": "degrees",
    "§": "section",
    "×": "times", "÷": "divided by", "±": "plus or minus", "$": "dollars", "£": "pounds",
    "€": "euros", "¥": "yen", "₹": "rupees", "¢": "cents", "∞": "infinity",
})  # fmt: skip
"""a sign that stands alone or between words"""

ADDRESS_SYMBOLS: Final = MappingProxyType[str, str]({
    ".": "dot", "/": "slash", "@": "at", "-": "dash", "_": "underscore", ":": "colon", "#": "hash",
    "?": "question mark", "&": "and", "=": "equals", "+": "plus", "%": "percent", "~": "tilde",
})  # fmt: skip
"""a sign in an e-mail or web address"""

ROMAN: Final = MappingProxyType[str, str]({
    "II": "two", "III": "three", "IV": "four", "VI": "six", "VII": "seven", "VIII": "eight",
    "IX": "nine", "XI": "eleven", "XII": "twelve", "XIII": "thirteen", "XIV": "fourteen",
    "XV": "fifteen", "XVI": "sixteen",
})  # fmt: skip
"""behind a capitalised word: "World War II" """

MONTHS: Final = (
    "january", "february", "march", "april", "may", "june", "july", "august", "september",
    "october", "november", "december",
)  # fmt: skip

DENOMINATORS: Final = frozenset((2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 16, 20, 32, 64, 100))
"""what is read as a fraction below a smaller number; 9/11 is nine eleven"""

LETTERS: Final = str.maketrans({
    "ß": "ss", "ẞ": "SS", "æ": "ae", "Æ": "AE", "œ": "oe", "Œ": "OE", "ø": "o", "Ø": "O", "đ": "d",
    "Đ": "D", "ð": "d", "Ð": "D", "þ": "th", "Þ": "TH", "ł": "l", "Ł": "L", "ı": "i", "ŋ": "ng",
    "ħ": "h", "Ħ": "H",
})  # fmt: skip
"""Latin letters of other languages that have no accent to take off, in English spelling"""

ALSO_SAID: Final = MappingProxyType[str, tuple[str, ...]]({
    # letters, as the British say them
    "z": ("Z EH D",), "r": ("AA",), "h": ("HH EY CH",),
    # said weakly; Wells, "Longman Pronunciation Dictionary", weak forms
    "with": ("W AH DH", "W AH TH", "W IH"),
})  # fmt: skip
"""ways to say a word of the lexicon that it lacks; docs/log.md has what more of them cost"""
