"""A lexicon of gruut, searched where it lies, and its model of letters to sounds.

gruut-lang-* (MIT) holds `lexicon.db`, SQLite with word_phonemes(word, pron_order, phonemes), and
`g2p/model.crf`, a conditional random field whose layout of features gruut's g2p.py documents.
"""

from __future__ import annotations

import json
import sqlite3
from base64 import b64decode, b64encode
from collections.abc import Iterable
from contextlib import closing
from functools import cache, cached_property
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

from lipwright.errors import LipwrightError, MissingExtraError

_AROUND: Final = 3  # letters each side that the model sees
_SILENT: Final = "_"
_PARTED: Final = "|"


class Lexicon:
    """Words to sounds as the lexicon spells them, parted by spaces.

    The table has no index, so that a search reads it all, in 3 to 60 ms: ask for many words at
    once by `remember`. What was asked for is kept.
    """

    def __init__(self, package: str, folder: str, language: str) -> None:
        """The lexicon in `folder` of `package`.

        Raises:
            MissingExtraError: the package is not installed.
        """
        spec = find_spec(package)
        if spec is None or not spec.submodule_search_locations:
            raise MissingExtraError(f"{language} lexicon", "languages")
        self._folder = Path(spec.submodule_search_locations[0]) / folder
        self._found: dict[str, tuple[str, ...]] = {}

    def remember(self, words: Iterable[str]) -> None:
        """Search for all the words in one go."""
        fresh = sorted({word for word in words if word not in self._found})
        if not fresh:
            return
        ways: dict[str, list[str]] = {word: [] for word in fresh}
        path = self._folder / "lexicon.db"
        try:
            with closing(sqlite3.connect(f"{path.as_uri()}?mode=ro&immutable=1", uri=True)) as base:
                rows = base.execute(
                    "SELECT word, phonemes FROM word_phonemes WHERE word IN "
                    "(SELECT value FROM json_each(?)) ORDER BY word, pron_order, id",
                    (json.dumps(fresh),),
                )
                for word, sounds in rows:
                    if sounds not in ways[word]:
                        ways[word].append(sounds)
        except sqlite3.Error as error:
            raise LipwrightError(
                f"{path}: cannot be read: {error}; install its package again"
            ) from error
        self._found.update((word, tuple(found)) for word, found in ways.items())

    def lookup(self, word: str) -> tuple[str, ...]:
        """The ways to say the word, given in lower case; none if it is missing."""
        if word not in self._found:
            self.remember([word])
        return self._found[word]

    def __contains__(self, word: object) -> bool:
        """Whether the lexicon has the word, given in lower case."""
        return isinstance(word, str) and bool(self.lookup(word))

    @cached_property
    def _model(self) -> Any:
        import pycrfsuite

        model = pycrfsuite.Tagger()
        model.open(str(self._folder / "g2p" / "model.crf"))
        return model

    def guess(self, word: str) -> str:
        """The sounds of a word that is missing, spelt as the lexicon does."""
        labels = self._model.tag([_features(word, at) for at in range(len(word))])
        parts = (part for label in labels for part in _decode(label).split(_PARTED))
        return " ".join(part for part in parts if part != _SILENT)


def _features(word: str, at: int) -> dict[str, str | bool | float]:
    """What the model sees at a letter: the letter, three on each side, and the word's ends."""
    seen: dict[str, str | bool | float] = {"bias": 1.0, "grapheme": _encode(word[at])}
    for away in range(1, _AROUND + 1):
        if at >= away:
            seen[f"grapheme-{away}"] = _encode(word[at - away])
        if at + away < len(word):
            seen[f"grapheme+{away}"] = _encode(word[at + away])
    if at == 0:
        seen["begin"] = True
    if at == len(word) - 1:
        seen["end"] = True
    return seen


@cache
def _encode(text: str) -> str:
    return b64encode(text.encode()).decode("ascii")


@cache
def _decode(text: str) -> str:
    return b64decode(text.encode("ascii")).decode()
