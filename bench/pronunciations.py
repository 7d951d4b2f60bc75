"""How well text becomes phones, in the languages that have tables.

Each row of tests/data/pronunciations is said, and its phones are compared with those of the
reference's IPA: edits over reference phones. Beside the error of the first way there is that of
the best one, for
words and for sentences, and the error with each lexicon of the package, and with its g2p alone.

    python bench/pronunciations.py [--errors] [de es fr it nl pt]
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

from lipwright.language.base import Pronunciation
from lipwright.language.ipa import read_ipa
from lipwright.language.tabled import TABLES, Tabled, make
from lipwright.language.tabled.values import Way, tokens_mended

REFERENCES = Path(__file__).parents[1] / "tests" / "data" / "pronunciations"
# What the lexicons that the tables leave out need, to be compared at their best.
LEFT_OUT = {
    "de": ("", tokens_mended(
        ("a eː", "aɪ̯"), ("ɔʏ̯", "ɔɪ̯"), ("p͡f", "pf"), ("t͡s|t s", "ts"), ("t͡ʃ|t ʃ", "tʃ"),
        ("ʔ", ""),
        ("d͡ʒ", "dʒ"), ("g", "ɡ"), ("ɐ", "ɐ̯"), ("ə ʁ", "ɐ"), (r"(?<=[tdbpkɡfvszxnml] )ɐ̯", "ɐ"),
    )),
    "es": ("", tokens_mended(
        ("g", "ɡ"), ("t͡ʃ", "tʃ"), ("([aeo])i", r"\1i̯"), ("([ae])u", r"\1u̯"),
        ("w([aeio])", r"w \1"),
        ("([aeo]) ʝ(?= *$)", r"\1i̯"), (r"(?<=[^aeiou ] )ʝ", "j"),
        ("(?<=[aeiouɾsl] )b", "β"), ("(?<=[aeiouɾs] )d", "ð"), ("(?<=[aeiouɾsl] )ɡ", "ɣ"),
    )),
    "fr": ("espeak", tokens_mended(
        (r"\S*-", ""), ("t ʃ", "tʃ"), ("d ʒ", "dʒ"), ("ɹ|r", "ʁ"), ("y(?= [ˈˌ]?i)", "ɥ"), ("h", ""),
    )),
    "nl": ("", tokens_mended(
        ("ɹ", "r"), ("w", "ʋ"), ("h", "ɦ"), ("œː [yʏ]|œː", "œy̯"), ("[aɔ] ɔ", "ɑu̯"),
        ("ɛ ɪ|ɛː", "ɛi̯"),
        ("a", "aː"), ("o", "oː"), ("e", "eː"), ("ɔː", "oː"),
    )),
    "pt": ("espeak", tokens_mended(
        ("([aeo]) ɪ", r"\1i̯"), ("([aeo]) ʊ", r"\1u̯"), ("ɐ̃ ʊ̃", "ɐ̃w̃"), ("ʊ", "u"),
        ("ɪ|ɨ", "i"), ("ɹ", "ɾ"),
        ("ɾ ə", "ɾ"), (r"([aeiou]) ŋ", r"\1̃"), ("a", "a"),
    )),
}  # fmt: skip
COMBINATIONS = 512  # of ways of a word of several parts that are tried


@dataclass(frozen=True)
class Reference:
    """A text and how it is said."""

    text: str
    ipa: str

    @property
    def phones(self) -> tuple[str, ...]:
        """In symbols of the phone table."""
        return tuple(sound.phone for sound in read_ipa(self.ipa))

    @property
    def is_sentence(self) -> bool:
        """Whether it has several words."""
        return " " in self.text


def read_references(code: str) -> list[Reference]:
    """The rows of a language."""
    lines = (REFERENCES / f"{code}.txt").read_text("utf-8").splitlines()
    rows = (line.split("\t") for line in lines if line and not line.startswith("#"))
    return [Reference(text, ipa) for text, ipa in rows]


def edits(reference: tuple[str, ...], estimated: tuple[str, ...]) -> int:
    """Phones to put in, leave out or change."""
    row = list(range(len(estimated) + 1))
    for above, wanted in enumerate(reference, 1):
        last, row[0] = row[0], above
        for at, given in enumerate(estimated, 1):
            last, row[at] = row[at], min(row[at] + 1, row[at - 1] + 1, last + (wanted != given))
    return row[-1]


def said(language: Tabled, text: str) -> tuple[tuple[Pronunciation, ...], ...]:
    """The ways to say each word of a text."""
    return language.pronounce_all(language.normalize(text))


def joined(ways: tuple[Pronunciation, ...]) -> tuple[str, ...]:
    """The phones of words one after another."""
    return tuple(phone for way in ways for phone in way.phones)


def best_edits(reference: tuple[str, ...], words: tuple[tuple[Pronunciation, ...], ...]) -> int:
    """The edits of the best choice of ways, word after word where there are too many."""
    total = 1
    for ways in words:
        total *= len(ways)
    if total <= COMBINATIONS:
        return min(edits(reference, joined(choice)) for choice in product(*words))
    chosen = [ways[0] for ways in words]
    for at, ways in enumerate(words):
        chosen[at] = min(
            ways, key=lambda way: edits(reference, joined((*chosen[:at], way, *chosen[at + 1 :])))
        )
    return edits(reference, joined(tuple(chosen)))


def share(rows: list[tuple[int, int]]) -> float:
    """Edits over phones."""
    return sum(wrong for wrong, _ in rows) / max(1, sum(length for _, length in rows))


def measure(language: Tabled, references: list[Reference]) -> tuple[float, float]:
    """The error of the first ways and of the best."""
    said(language, " ".join(row.text for row in references))  # a search reads the whole lexicon
    first, best = [], []
    for row in references:
        words = said(language, row.text)
        first.append((edits(row.phones, joined(tuple(w[0] for w in words))), len(row.phones)))
        best.append((best_edits(row.phones, words), len(row.phones)))
    return share(first), share(best)


def by_lexicon(code: str, folder: str, guess: bool) -> float:
    """The error with one lexicon, or its g2p, and without the list of words that it has wrong."""
    tables = make(code).tables
    mends = dict([*tables.mends.items(), *([LEFT_OUT[code]] if code in LEFT_OUT else [])])
    tables = replace(tables, lexicons=(folder,), mends=mends, said={}, guess_from=folder)
    language = _Guessing(replace(tables, links=())) if guess else Tabled(tables)
    return measure(language, read_references(code))[0]


class _Guessing(Tabled):
    """A language without a lexicon."""

    def _listed(self, word: str) -> tuple[Way, ...]:
        del word
        return ()


def print_errors(language: Tabled, references: list[Reference]) -> None:
    for row in references:
        words = said(language, row.text)
        phones = joined(tuple(ways[0] for ways in words))
        if phones != row.phones:
            ipa = " ".join("".join(ways[0].ipa) for ways in words)
            print(f"  {row.text}: {row.ipa} | {ipa}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("codes", nargs="*", default=list(TABLES))
    parser.add_argument("--errors", action="store_true", help="print what differs")
    options = parser.parse_args()
    print("language  words  best  sentences  best  lexicons alone, and their g2p")
    for code in options.codes:
        language = make(code)
        references = read_references(code)
        words = measure(language, [row for row in references if not row.is_sentence])
        sentences = measure(language, [row for row in references if row.is_sentence])
        parts = [
            f"{folder or 'main'} {by_lexicon(code, folder, False):.3f}"
            f"/{by_lexicon(code, folder, True):.3f}"
            for folder in (*language.tables.lexicons, *LEFT_OUT.get(code, ())[:1])
        ]
        print(
            f"{code:8s}  {words[0]:.3f}  {words[1]:.3f}  {sentences[0]:.3f}  {sentences[1]:.3f}  "
            + ", ".join(parts)
        )
        if options.errors:
            print_errors(language, references)


if __name__ == "__main__":
    main()
