"""The phone bigrams of Mandarin and Swedish: what they add to the English set and change in it.

    python bench/language_bigrams.py                     # into the package
    python bench/language_bigrams.py --english SET -o FOLDER

A language is a child of "english": its phones are in English classes where they look like English
ones, and in classes of their own where they do not (Xu et al. 2013, section 4.4). Each class of its
own has a pair with every class, both ways, and with itself and silence, by rule from
src/lipwright/bigrams/pose_targets.csv. Run it again when the English classes or that table change.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from lipwright.bigrams.families import SETS, load_bigrams
from lipwright.bigrams.fields import SetFile
from lipwright.bigrams.file import save_set
from lipwright.bigrams.rules import load_targets, rule_curves
from lipwright.bigrams.values import Bigram, BigramSet, Pair

ENGLISH: Final = "english"


@dataclass(frozen=True)
class Added:
    """A class of which a language makes every pair."""

    phones: tuple[str, ...]
    note: str
    """what its pairs look like, and from which sounds that is taken"""
    rule: str = ""
    """the class of the table of targets, if it has another name there"""


@dataclass(frozen=True)
class Tongue:
    """What a language adds to English."""

    name: str
    language: str
    source: str
    alike: Mapping[str, tuple[str, ...]]
    """English class to phones that join it"""
    added: Mapping[str, Added] = field(default_factory=dict)
    """class to what it holds; one of English is made anew"""


MANDARIN: Final = Tongue(
    "mandarin",
    "cmn",
    "pinyin in the classes of English, and ü with its pairs, by rule from articulation",
    {
        "ah": ("XOW",),  # gE
        "er": ("XRI",),  # shI
        "ih": ("Y",),  # Ya; English has it with sh, which no spread glide looks like
        "z": ("XC", "XTC", "XTS", "XSI"),  # Xi, Ji, Zi, sI: teeth together, lips back
        "sh": ("XS", "XZ", "XCH"),  # SHi, Ri, ZHi
    },
    {"yu": Added(("XIY", "XIH"), "yu, the ü of nü: lips as for w, jaw and tongue as for ih")},
)

SWEDISH: Final = Tongue(
    "swedish",
    "sv",
    "Swedish in the classes of English, and what looks different, by rule from articulation",
    {
        "ao": ("XEH",),  # rÖtt, as open and round as Å in rått
        "d": ("XT", "XD", "XN"),  # koRT, boRD, baRN: only the tongue knows
        "ih": ("Y",),  # Ja
        "l": ("XL",),  # käRL
    },
    {
        "r": Added(("R", "XR"), "r, trilled or tapped: lips free as for d, tongue as for l", "rr"),
        "yu": Added(("XIY", "XIH"), "yu, the y of ny: lips as for w, jaw and tongue as for ih"),
        "uu": Added(("UX",), "uu, the u of hus: as w with the lips nearly shut, tongue as for ih"),
        "oe": Added(("XEY",), "oe, the ö of söt: lips as for ow, jaw between eh and w"),
        "rs": Added(("XS",), "rs of fors: as sh with the lips less forward and the tongue up"),
        "sj": Added(
            ("XH",), "sj of själ: lips as for r, a little looser than w, tongue back as for kg"
        ),
        "tj": Added(("XC",), "tj of tjog: teeth as for z, lips spread as for ih"),
    },
)

LANGUAGES: Final = (MANDARIN, SWEDISH)


def classes(tongue: Tongue, english: BigramSet) -> dict[str, tuple[str, ...]]:
    """The classes that a language adds or changes."""
    moved = {phone for phones in tongue.alike.values() for phone in phones}
    moved |= {phone for added in tongue.added.values() for phone in added.phones}
    joined = {
        name: (*(phone for phone in english.classes[name] if phone not in moved), *phones)
        for name, phones in tongue.alike.items()
    }
    return joined | {name: added.phones for name, added in tongue.added.items()}


def pairs(tongue: Tongue, english: BigramSet) -> Iterator[Bigram]:
    """The pairs that a language adds or makes anew."""
    rules = load_targets()
    targets = {**rules, **{name: rules[one.rule or name] for name, one in tongue.added.items()}}
    names = dict.fromkeys((*english.classes, *tongue.added))
    for first in names:
        for second in names:
            notes = [tongue.added[one].note for one in (first, second) if one in tongue.added]
            if notes:
                curves = rule_curves(first, second, targets)
                note = "; ".join(dict.fromkeys(notes))
                yield Bigram(first, second, curves, source="rule", note=note)


def make_set(tongue: Tongue, english: BigramSet) -> SetFile:
    """The file of a language's set."""
    bigrams: dict[Pair, Bigram] = {bigram.pair: bigram for bigram in pairs(tongue, english)}
    return SetFile(
        name=tongue.name,
        language=tongue.language,
        licence="Apache-2.0",
        source=tongue.source,
        parent=ENGLISH,
        classes=classes(tongue, english),
        bigrams=bigrams,
    )


def main() -> None:
    """Write the set of each language."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--english", default=ENGLISH, help="the set that they are children of")
    parser.add_argument("-o", "--output", type=Path, default=SETS, help="folder")
    options = parser.parse_args()
    english = load_bigrams(options.english)
    for tongue in LANGUAGES:
        said = make_set(tongue, english)
        save_set(options.output / f"{tongue.name}.json", said)
        print(f"{tongue.name}: {len(said.bigrams)} pairs, {len(tongue.added)} classes of its own")


if __name__ == "__main__":
    main()
