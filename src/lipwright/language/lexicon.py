"""A lexicon file in the CMU format, sorted by word and searched where it lies."""

from __future__ import annotations

import mmap
import os
from pathlib import Path


class Lexicon:
    """Words to pronunciations; the lines of the file are sorted by word without `(2)`.

    A search reads about twenty lines, so that a few words do not cost the reading of them all.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """The file, which must stay where it is."""
        with Path(path).open("rb") as file:
            self._data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        self._found: dict[str, tuple[tuple[str, ...], ...]] = {}

    def __contains__(self, word: object) -> bool:
        """Whether the lexicon has the word, given in lower case."""
        return isinstance(word, str) and bool(self.lookup(word))

    def lookup(self, word: str) -> tuple[tuple[str, ...], ...]:
        """The phones of each way to say the word, given in lower case; none if it is missing."""
        if word not in self._found:
            self._found[word] = self._search(word.encode())
        return self._found[word]

    def _next(self, start: int) -> int:
        """The start of the line after the one at `start`."""
        end = self._data.find(b"\n", start)
        return len(self._data) if end < 0 else end + 1

    def _line(self, start: int) -> tuple[bytes, tuple[str, ...]]:
        """The word and the phones of the line that begins at `start`."""
        word, *phones = self._data[start : self._next(start)].split()
        return word.partition(b"(")[0], tuple(phone.decode() for phone in phones)

    def _search(self, word: bytes) -> tuple[tuple[str, ...], ...]:
        low, high = 0, len(self._data)  # both at the start of a line; the word is in between
        while low < high:
            middle = self._data.rfind(b"\n", low, (low + high) // 2) + 1 or low
            if self._line(middle)[0] < word:
                low = self._next(middle)
            else:
                high = middle
        ways = []
        while low < len(self._data) and (line := self._line(low))[0] == word:
            ways.append(line[1])
            low = self._next(low)
        return tuple(ways)
