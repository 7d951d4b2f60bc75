"""Choice of a format by the suffix of a file, or by its name."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TypeVar

from lipwright.errors import LipwrightError

Entry = TypeVar("Entry")


def by_suffix(
    table: Mapping[str, Entry], path: str | os.PathLike[str], name: str | None, what: str,
    remedy: str = "name one of {} by the file's suffix or by --format",
) -> Entry:  # fmt: skip
    """The entry for `path`; the longest suffix wins, capitals do not count.

    Args:
        table: suffix, with its dot and in small letters, to entry.
        path: the file.
        name: a suffix, with or without its dot, that goes before that of the file.
        what: what the file holds, for the error: `phone track`.
        remedy: for a suffix that no entry has, with {} for those that there are.

    Raises:
        LipwrightError: no entry has the suffix; names those that are known.
    """
    known = ", ".join(table)
    if name is not None:
        key = "." + name.strip().casefold().removeprefix(".")
        if key not in table:
            raise LipwrightError(f"{path}: no {what} format {name!r}; the formats are {known}")
        return table[key]
    file_name = Path(path).name.casefold()
    for suffix in sorted(table, key=len, reverse=True):
        if file_name.endswith(suffix) and file_name != suffix:
            return table[suffix]
    found = Path(path).suffix
    which = f"suffix {found!r} is" if found else "a file without a suffix is"
    raise LipwrightError(f"{path}: {which} no {what} format; {remedy.format(known)}")
