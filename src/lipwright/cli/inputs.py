"""What commands take: words or a file of them, a recording or a pipe."""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from lipwright.errors import LipwrightError

STDIN = "-"
MAX_TEXT = 32 * 1024 * 1024  # bytes; some forty times what is said in a day
# What separates words, lines and pages may stand in a text; other control characters may not.
_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1b\x7f-\x84\x86-\x9f]")
_TEXT_SUFFIXES = frozenset((".txt", ".text", ".lab", ".trn", ".md"))


def piped_in() -> BinaryIO:
    """Standard input.

    Raises:
        LipwrightError: it is closed.
    """
    if sys.stdin is None:
        raise LipwrightError("standard input is closed; name a file")
    return sys.stdin.buffer


def piped_out() -> BinaryIO:
    """Standard output.

    Raises:
        LipwrightError: it is closed.
    """
    if sys.stdout is None:
        raise LipwrightError("standard output is closed; name a file")
    return sys.stdout.buffer


@contextmanager
def recording(speech: str) -> Iterator[Path]:
    """The path of a recording; what comes through a pipe is kept in a file meanwhile."""
    if not speech:
        raise LipwrightError("the recording has an empty name; name a sound file, or - for a pipe")
    if speech != STDIN and not _is_pipe(speech):
        yield Path(speech)
        return
    with tempfile.TemporaryDirectory(prefix="lipwright-") as folder:
        path = Path(folder) / "standard-input"
        with path.open("wb") as file:
            if speech == STDIN:
                shutil.copyfileobj(piped_in(), file)
            else:
                with Path(speech).open("rb") as pipe:
                    shutil.copyfileobj(pipe, file)
        yield path


def _is_pipe(speech: str) -> bool:
    """Whether it can be read only once, as <(sox ...); the aligner and a video want its sound."""
    try:
        return Path(speech).is_fifo()
    except OSError:  # no such name can be; opening it will tell
        return False


def _decode(data: bytes, name: str) -> str:
    """UTF-8, or UTF-16 where a byte order mark says so."""
    marked = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    encoding, shown = ("utf-16", "UTF-16") if marked else ("utf-8-sig", "UTF-8")
    try:
        return data.decode(encoding)
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise LipwrightError(
            f"{name}: line {line}: byte {error.start} is not {shown} text; save the file as UTF-8"
        ) from error


def _looks_like_file(text: str) -> bool:
    """Whether `text` was meant as a path: one word with a folder or a text file's suffix.

    "and/or", "1/0" and "https://example.org" are words.
    """
    if len(text.split()) != 1 or "://" in text:
        return False
    path = Path(text)
    if path.suffix in _TEXT_SUFFIXES or text.startswith((os.sep, "./", "../", "~/")):
        return True
    try:
        return os.sep in text and path.parent.is_dir()
    except (OSError, ValueError):  # no such name can be
        return False


def read_text(text: str, said: str = "--text") -> tuple[str, str]:
    """The words that an option or argument means, and their name for errors.

    `text` is a file where there is one of that name, `-` standard input, else the words, which are
    called `said`.

    Raises:
        LipwrightError: the file is missing, too long or not text, or there are control characters.
    """
    words, name = _words_of(text, said)
    found = _CONTROL.search(words)
    if found:
        line = words.count("\n", 0, found.start()) + 1
        column = found.start() - words.rfind("\n", 0, found.start())
        raise LipwrightError(
            f"{name}: line {line}, column {column}: the control character U+{ord(found[0]):04X} is "
            "no text; take it out, or save the file as UTF-8"
        )
    return words, name


def _words_of(text: str, said: str) -> tuple[str, str]:
    if text == STDIN:
        return _decode(piped_in().read(MAX_TEXT), "standard input"), "standard input"
    if text.lstrip().startswith("<"):  # SSML, whose slashes are no folders
        return text, said
    try:
        is_folder = Path(text).is_dir()
        is_file = Path(text).exists() and not is_folder  # a pipe too, as of <(echo hello)
    except (OSError, ValueError):  # too long for a path, or not one
        is_file = is_folder = False
    if is_file:
        try:
            with Path(text).open("rb") as file:
                data = file.read(MAX_TEXT + 1)
            if len(data) > MAX_TEXT:
                raise LipwrightError(
                    f"{text}: more than {MAX_TEXT >> 20} MB are no transcript; name a text file"
                )
            return _decode(data, text), text
        except OSError as error:
            raise LipwrightError(f"{text}: cannot be read: {error.strerror}") from error
    if (is_folder and os.sep in text) or _looks_like_file(text):
        what = "is a folder" if is_folder else "no such file"
        takes = "takes the words" if said.startswith("-") else "may be words"
        raise LipwrightError(f"{text}: {what}; {said} {takes} or a file of them")
    return text, said
