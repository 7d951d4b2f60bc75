"""A script as the lines that hibari says: its letters, and the words and phones that they mean."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final

from lipwright.errors import LipwrightError
from lipwright.language.base import Language
from lipwright.speech.voices.misaki import (
    PAUSES,
    PRIMARY,
    SECONDARY,
    Sound,
    read_sounds,
    write_phones,
)
from lipwright.speech.voices.values import Emphasis, Piece, Script

G2P = Any
"""`hibari.g2p.G2P`, which has no types"""

# hibari's own limit of a line, `hibari.tts.MAX_PHONEMES`; the model never saw longer ones.
MOST_LETTERS: Final = 400
_VOWELS: Final = frozenset("aeiouyáàâäéèêëíìîïóòôöúùûü")
_ENDS: Final = frozenset(".!?…")
_MARKS: Final = re.compile(r"([,;:.!?…—–-]*)[\"'”’»)\]}*_]*$")
_CORE: Final = re.compile(r"\w(?:.*\w)?", re.DOTALL)
_ABBREVIATION: Final = re.compile(r"[^\W\d_]+\.|(?:[^\W\d_]\.)+")


@dataclass(frozen=True)
class Line:
    """What the model says at once."""

    letters: str
    """in the alphabet of `misaki`"""
    sounds: tuple[Sound, ...]
    """its phones, at least one"""
    words: tuple[str, ...] = ()
    """what the sounds' `word` counts"""
    rate: float = 1.0
    emphasis: tuple[tuple[int, int, Emphasis], ...] = ()
    """first letter, letter after the last, and how the letters between are said"""
    pause: float | None = None
    """s of silence up to the next line, exactly; None for what the voice makes by itself"""


@dataclass(frozen=True)
class _Item:
    """A word on its way to letters."""

    word: str
    """as it is spoken; "" for phones that belong to no word"""
    written: str
    """as the voice's g2p reads it best"""
    mark: str = ""
    """one of PAUSES behind it, or "" """
    phones: tuple[str, ...] = ()
    """said instead of what g2p would give"""
    emphasis: Emphasis | None = None


@dataclass
class _Run:
    """Items that are said without a break and at one rate."""

    rate: float
    items: list[_Item] = field(default_factory=list)
    pause: float | None = None


def script_lines(
    script: Script, language: Language, g2p: G2P, known: frozenset[str], source: str
) -> tuple[float, list[Line]]:
    """The pause before everything (s), and the lines.

    Args:
        script: what is said.
        language: writes out numbers and abbreviations.
        g2p: hibari's.
        known: the letters that the model takes.
        source: the script's name in errors.

    Raises:
        LipwrightError: nothing is said, or letters are not the language's.
    """
    before, runs = _runs(script, language, source)
    lines: list[Line] = []
    for run in runs:
        for items in _sentences(run.items):
            lines += _lines(items, run.rate, g2p, known, language)
        lines[-1] = replace(lines[-1], pause=run.pause)
    return before, lines


def _runs(script: Script, language: Language, source: str) -> tuple[float, list[_Run]]:
    before, runs = 0.0, list[_Run]()
    fresh = True
    for piece in script:
        for item in _items(piece, language, source):
            if not item.written and not item.phones:  # marks alone belong to the word before
                if runs and not fresh:
                    last = runs[-1].items[-1]
                    runs[-1].items[-1] = replace(last, mark=last.mark or item.mark)
                continue
            if fresh or not runs or runs[-1].rate != piece.rate:
                runs.append(_Run(piece.rate))
            runs[-1].items.append(item)
            fresh = False
        if piece.pause:
            if not runs:
                before += piece.pause
            else:
                runs[-1].pause = (runs[-1].pause or 0.0) + piece.pause
            fresh = True
    if not runs:
        raise LipwrightError(f"{source}: has no words; give the words that are spoken")
    return before, runs


def _items(piece: Piece, language: Language, source: str) -> Iterator[_Item]:
    if piece.phones:
        written = piece.text.split()
        mark = _mark(written[-1]) if written else ""
        name = "-".join(found[0] for word in written if (found := _CORE.search(word)))
        yield _Item(name, name, mark, piece.phones, piece.emphasis)
        return
    if not any(char.isalnum() for char in piece.text):
        yield _Item("", "", _mark(piece.text.strip()))
        return
    # White space before it puts the piece where it stands in the source, for errors.
    text = "\n" * (piece.line - 1) + " " * (piece.column - 1) + piece.text
    words = deque(language.normalize(text, source))
    shouted = not any(char.islower() for char in piece.text)
    for line, content in enumerate(text.split("\n"), 1):
        for found in re.finditer(r"\S+", content):
            spoken: list[str] = []
            while words and (words[0].line, words[0].column) <= (line, found.end()):
                spoken.append(words.popleft().text)
            mark = _mark(found[0])
            if not spoken:
                if not any(char.isalnum() for char in found[0]):
                    yield _Item("", "", mark)
                continue
            if mark == "." and _ABBREVIATION.fullmatch(_trim(found[0])) and (
                " ".join(spoken) != _trim(found[0]).rstrip(".").casefold()
            ):  # fmt: skip
                mark = _stop_of_abbreviation(content[found.end() :])
            for number, word in enumerate(spoken, 1):
                as_read = _as_read(word, found[0], len(spoken), shouted)
                phones: tuple[str, ...] = ()
                if len(word) > 1 and not as_read.isupper() and not _VOWELS & set(word):
                    phones = language.pronounce(word)[0].phones  # hibari would spell "shh"
                yield _Item(word, as_read, mark if number == len(spoken) else "", phones,
                            piece.emphasis)  # fmt: skip
        if not content.strip():
            yield _Item("", "", ".")  # an empty line ends a paragraph


def _trim(written: str) -> str:
    return written.lstrip("\"'“‘«([{").rstrip("\"'”’»)]},;:!?")


def _stop_of_abbreviation(rest: str) -> str:
    """Whether the stop of "etc." ends a sentence too: at the end of a text alone."""
    return "" if rest.strip() else "."


def _mark(written: str) -> str:
    """The mark behind a word by which the voice pauses, one of PAUSES, or ""."""
    found = _MARKS.search(written)
    marks = found[1] if found else ""
    strongest = next((mark for mark in "?!….—;:," if mark in marks), "")
    if marks.startswith("..") or marks.endswith(("--", "–")):
        return "…" if "." in marks else "—"
    if not strongest and marks and marks == written:
        return "—"  # a dash between spaces
    return strongest


def _as_read(word: str, written: str, count: int, shouted: bool) -> str:
    """A spoken word as hibari's g2p should see it: as it is written, where that is the same."""
    core = _CORE.search(written)
    if count == 1 and not shouted and core:
        plain = core[0].replace("’", "'").replace("ʼ", "'")
        if plain.casefold() == word:
            return plain
    return word.upper() if len(word) == 1 and count > 1 else word


def _sentences(items: Sequence[_Item]) -> Iterator[list[_Item]]:
    sentence: list[_Item] = []
    for item in items:
        sentence.append(item)
        if item.mark in _ENDS:
            yield sentence
            sentence = []
    if sentence:
        yield sentence


def _lines(
    items: list[_Item], rate: float, g2p: G2P, known: frozenset[str], language: Language
) -> Iterator[Line]:
    spelt = [
        (item, "".join(char for char in letters if char in known))
        for item, letters in zip(items, _letters(items, g2p), strict=True)
    ]
    line: list[tuple[_Item, str]] = []
    for item, letters in spelt:
        if line and sum(len(before) + 1 for _, before in line) + len(letters) > MOST_LETTERS:
            # At the last mark, or else between two words.
            marks = [place for place, (one, _) in enumerate(line, 1) if one.mark]
            cut = marks[-1] if marks else len(line)
            yield _line(line[:cut], rate, language)
            line = line[cut:]
        line.append((item, letters))
    yield _line(line, rate, language)


def _letters(items: list[_Item], g2p: G2P) -> list[str]:
    """The letters of each item, with its mark, as g2p reads the words together."""
    said = " ".join(_for_g2p(item) for item in items)
    letters = [""]
    for token in g2p.phonemize_tokens(g2p.tokenize(said)):
        letters[-1] += token.phonemes or ""
        if token.whitespace:
            letters.append("")
    if len(letters) != len(items):  # a word that g2p takes for several
        letters = [str(g2p(_for_g2p(item), normalize_text=False)) for item in items]
    return letters


def _for_g2p(item: _Item) -> str:
    if item.phones:
        return f"[x](/{write_phones(item.phones)[0]}/){item.mark}"
    # "A" alone would be the article.
    word = "[x](/ˈA/)" if item.written == "A" and item.word == "a" else item.written
    return word + item.mark


def _line(spelt: list[tuple[_Item, str]], rate: float, language: Language) -> Line:
    letters, sounds, words = "", list[Sound](), list[str]()
    emphasis = []
    for item, found in spelt:
        if letters:
            letters += " "
        bare = found.rstrip("".join(PAUSES) + " ")
        mark = found[len(bare) :].strip() or item.mark
        phones = item.phones
        if not phones and not read_sounds(bare):  # g2p had nothing to say
            phones = language.pronounce(item.word)[0].phones
        number = len(words) if item.word else None
        start = len(letters)
        if phones:
            bare, own = write_phones(phones)
            sounds += [
                replace(one, first=one.first + start, stop=one.stop + start, word=number)
                for one in own
            ]
        else:
            bare = _stressed(bare, item.emphasis)
            sounds += read_sounds(bare, number, start)
        if item.word:
            words.append(item.word)
        if item.emphasis and item.emphasis != "none":
            emphasis.append((start, start + len(bare), item.emphasis))
        letters += bare + mark
    if letters[-1] not in PAUSES:
        letters += ","  # a line that goes on after a break
    return Line(letters, tuple(sounds), tuple(words), rate, tuple(emphasis))


def _stressed(letters: str, emphasis: Emphasis | None) -> str:
    if emphasis == "reduced":
        return letters.replace(PRIMARY, SECONDARY)
    if emphasis in ("moderate", "strong") and PRIMARY not in letters:
        if SECONDARY in letters:
            return letters.replace(SECONDARY, PRIMARY, 1)
        vowel = next((one for one in read_sounds(letters) if one.stress is not None), None)
        if vowel:
            return letters[: vowel.first] + PRIMARY + letters[vowel.first :]
    return letters
