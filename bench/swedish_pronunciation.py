"""How well Swedish words are said: phone error rates, and what each means is worth.

    python bench/swedish_pronunciation.py --field held.crf

`held.crf` is from `python bench/swedish_g2p.py --hold-out -o held.crf`. The words that it did not
learn are taken out of the lexicon too, and said by the field, by what is left of the lexicon
(inflection and compounds), by both as the language does it, and by the field that comes with gruut,
which has learnt these very words. References are the lexicon as it is mended, so that its mistakes
are in the figures. The quoted references are those of tests/data/swedish.csv, said with all means.
"""

from __future__ import annotations

import argparse
import base64
import csv
from collections.abc import Callable, Iterable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from lipwright.language.swedish import Swedish
from lipwright.language.swedish.assimilation import assimilate, open_before_r
from lipwright.language.swedish.guess import Field
from lipwright.language.swedish.lexicon import SwedishLexicon, mend
from lipwright.language.swedish.sounds import LONG_R, plain
from lipwright.language.swedish.words import Compounds, inflected
from swedish_g2p import words

REFERENCES: Final = Path(__file__).parents[1] / "tests" / "data" / "swedish.csv"

Sounds = tuple[str, ...]


def finished(sounds: Iterable[str]) -> Sounds:
    """The sounds of a word as they are uttered, without stress."""
    done = open_before_r(assimilate(sounds))
    return tuple("r" if sound == LONG_R else plain(sound) for sound in done)


def distance(one: Sequence[str], other: Sequence[str]) -> int:
    """The fewest sounds to change, add and take away (Levenshtein)."""
    row = list(range(len(other) + 1))
    for i, sound in enumerate(one, 1):
        diagonal, row[0] = row[0], i
        for j, reference in enumerate(other, 1):
            diagonal, row[j] = (
                row[j],
                min(row[j] + 1, row[j - 1] + 1, diagonal + (sound != reference)),
            )
    return row[-1]


def error_rate(
    say: Callable[[str], Sounds | None],
    reference_of: Callable[[str], Sequence[Sounds]],
    tested: Sequence[str],
) -> tuple[float, float, int]:
    """Wrong sounds a sound, share of words without one, and how many words were said."""
    wrong = count = right = said = 0
    for word in tested:
        sounds = say(word)
        if sounds is None:
            continue
        scores = [(distance(finished(sounds), finished(way)), len(way))
                  for way in reference_of(word)]  # fmt: skip
        best = min(scores)
        wrong, count, right, said = (
            wrong + best[0], count + best[1], right + (best[0] == 0), said + 1)  # fmt: skip
    return wrong / max(count, 1), right / max(said, 1), said


def gruut_field() -> Callable[[str], Sounds | None]:
    """The field of gruut: a feature for each of seven letters, all in base 64."""
    from pycrfsuite import Tagger

    package = find_spec("gruut_lang_sv")
    assert package is not None
    assert package.origin is not None
    tagger = Tagger()
    tagger.open(str(Path(package.origin).parent / "g2p" / "model.crf"))

    def say(word: str) -> Sounds | None:
        letters = [base64.b64encode(letter.encode()).decode() for letter in word]
        rows = []
        for place, letter in enumerate(letters):
            row = {"bias": 1.0, f"grapheme:{letter}": 1.0}
            for step in (-3, -2, -1, 1, 2, 3):
                if 0 <= place + step < len(letters):
                    row[f"grapheme{step:+d}:{letters[place + step]}"] = 1.0
            row |= {"begin": 1.0} if not place else {}
            row |= {"end": 1.0} if place == len(letters) - 1 else {}
            rows.append(row)
        labels = [base64.b64decode(label).decode() for label in tagger.tag(rows)]
        written = " ".join(part for label in labels if label != "_" for part in label.split("|"))
        return mend(word, written) or ("",)

    return say


def show(name: str, result: tuple[float, float, int]) -> None:
    """Print a line."""
    print(f"{name:44} {result[0]:7.2%} {result[1]:7.1%} {result[2]:6}")


def held_out(model: Path) -> None:
    """Measure on the words that `model` did not learn."""
    whole = SwedishLexicon()
    _, tested = words(whole)
    rest = SwedishLexicon(leave_out=tested)
    field, compounds = Field(model), Compounds(rest.lookup)
    language = Swedish(rest, field, lookup_common=False)

    def by_stem(word: str) -> Sounds | None:
        return next(iter(inflected(word, rest.lookup)), None)

    print(f"{'held-out words, said by':44} {'errors':>7} {'words':>7} {'said':>6}")
    for name, say in (
        ("the field", lambda word: field.guess(word)[0]),
        ("inflection", by_stem),
        ("compounds", compounds.say),
        ("all, as the language does it", lambda word: language.pronounce(word)[0].ipa),
        ("gruut's field, which has learnt them", gruut_field()),
    ):
        show(name, error_rate(say, whole.lookup, tested))


def quoted() -> None:
    """Measure on the quoted references."""
    language = Swedish()
    rows = list(csv.DictReader(REFERENCES.read_text(encoding="utf-8").splitlines()))
    print(f"\n{'references, said with all means':44} {'errors':>7} {'right':>7} {'rows':>6}")
    for source in dict.fromkeys(row["source"] for row in rows):
        reference = {row["text"]: (split(row["ipa"]),) for row in rows if row["source"] == source}

        def say(text: str) -> Sounds:
            ways = language.pronounce_all(language.normalize(text))
            return tuple(sound for row in ways for sound in row[0].ipa)

        show(source, error_rate(say, reference.__getitem__, list(reference)))


def split(ipa: str) -> Sounds:
    """The sounds of a reference."""
    sounds: list[str] = []
    for char in ipa.replace(" ", ""):
        if char == "ː":
            sounds[-1] += char
        else:
            sounds.append(char)
    return tuple(sounds)


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--field", type=Path, help="model that did not learn the held-out words")
    options = parser.parse_args()
    if options.field:
        held_out(options.field)
    quoted()


if __name__ == "__main__":
    main()
