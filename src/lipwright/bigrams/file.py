"""A set of phone bigrams in a file: `load_set`, `save_set`, and `editing` by one at a time."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from lipwright.bigrams.fields import FORMAT, OTHERWISE_KEY, VERSION, SetFile, read_fields
from lipwright.bigrams.places import Fault, parse
from lipwright.bigrams.values import PLUS, Bigram, Pair, Points, Pose
from lipwright.errors import LipwrightError
from lipwright.files import write_whole
from lipwright.formats.source import decode_text, read_bytes

if TYPE_CHECKING:
    from lipwright.bigrams.smartbody import Imported

__all__ = [
    "SetFile", "editing", "is_ours", "load_any", "load_set", "read_set_text", "save_set",
    "set_to_text", "sorted_pairs",
]  # fmt: skip

PathLike = str | os.PathLike[str]

MAX_BYTES: Final = 64 * 2**20  # a hundred times a whole set of a language
DECIMALS: Final = 4  # of what is written: a tenth of a thousandth of a full pose
PATIENCE: Final = 10.0  # s to wait for another program that edits the file
_POLL: Final = 0.02  # s


def load_set(path: PathLike) -> SetFile:
    """What a file of phone bigrams says: ours, or SmartBody's as JSON or text, by its content.

    Raises:
        LipwrightError: it cannot be read or used; names line and column.
    """
    return load_any(path).said


def load_any(path: PathLike, name: str | None = None) -> Imported:
    """As `load_set`, with what had to be changed in another format.

    Args:
        path: the file.
        name: the set that is wanted, where the file has several.

    Raises:
        LipwrightError: it cannot be read or used, or has no set of that name.
    """
    from lipwright.bigrams.smartbody import Imported, is_smartbody_json, json_to_set
    from lipwright.bigrams.smartbody_text import is_smartbody_text, text_to_set

    text = read_set_text(path)
    if is_smartbody_text(text):
        return text_to_set(path, text, name)
    content = parse(path, text)
    try:
        is_theirs = is_smartbody_json(content)
        found = json_to_set(content) if is_theirs else Imported(read_fields(content))
    except Fault as fault:
        raise fault.in_file(path, text) from None
    if name not in (None, found.said.name):
        raise LipwrightError(f"{path}: has no set {name!r}; it has: {found.said.name}")
    return found


def is_ours(path: PathLike, text: str) -> bool:
    """Whether the text of the set `path` is of our format."""
    from lipwright.bigrams.smartbody import is_smartbody_json
    from lipwright.bigrams.smartbody_text import is_smartbody_text

    return not is_smartbody_text(text) and not is_smartbody_json(parse(path, text))


def read_set_text(path: PathLike) -> str:
    """The text of a file of phone bigrams.

    Raises:
        LipwrightError: it is missing, a folder, empty, no text, or too large.
    """
    content = read_bytes(path)
    if len(content) > MAX_BYTES:
        raise LipwrightError(f"{path}: larger than {MAX_BYTES >> 20} MB, no such set; name another")
    text = decode_text(path, content)
    if not text.strip():
        raise LipwrightError(f"{path}: is empty; make a set with: lipwright bigrams new")
    return text


def save_set(path: PathLike, said: SetFile) -> None:
    """Write a set, whole or not at all; the same set always gives the same text.

    Raises:
        LipwrightError: the file cannot be written.
    """
    content = set_to_text(said).encode("utf-8")
    with write_whole(path) as part:
        part.write_bytes(content)


def set_to_text(said: SetFile) -> str:
    """The JSON of a set: one curve a line, pairs in the order of the classes."""
    fields: dict[str, Any] = {
        "format": FORMAT, "version": VERSION, "name": said.name, "language": said.language,
        "licence": said.licence, "source": said.source, "parent": said.parent or None,
        "rig": said.rig,
    }  # fmt: skip
    lines = [f"{_dump(key)}: {_dump(value)}" for key, value in fields.items() if value is not None]
    for key, number in (
        ("smoothing_s", said.smoothing),
        ("speed_limit", said.speed_limit),
        ("silence_s", said.silence),
    ):
        if number is not None:
            lines.append(f'"{key}": {_setting(number)}')
    constraints = {PLUS.join(pair): most for pair, most in said.constraints.items()}
    if said.otherwise is not None:
        constraints[OTHERWISE_KEY] = said.otherwise
    pairs = sorted_pairs(said.bigrams, said.classes)
    blocks = {
        "classes": {name: _dump(list(phones)) for name, phones in said.classes.items()},
        "poses": {name: _pose(pose) for name, pose in said.poses.items()},
        "constraints": {key: _number(most) for key, most in constraints.items()},
        "bigrams": {" ".join(p): _bigram(said.bigrams[p], list(said.poses)) for p in pairs},
    }
    lines += [_block(key, rows) for key, rows in blocks.items() if rows or key == "bigrams"]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _place(order: Mapping[str, object], name: str) -> tuple[int, str]:
    """Where a name is sorted: in that order, and by the alphabet after it."""
    return (list(order).index(name) if name in order else len(order), name)


def _block(key: str, entries: Mapping[str, str], indent: str = "") -> str:
    """An object with one entry a line."""
    if not entries:
        return f'{indent}"{key}": {{}}'
    rows = (f"{indent} {_dump(name)}: {value}" for name, value in entries.items())
    return f'{indent}"{key}": {{\n' + ",\n".join(rows) + f"\n{indent}}}"


def _pose(pose: Pose) -> str:
    return f'{{"priority": {_number(pose.priority)}, "limit": {_dump(pose.limit)}}}'


def _bigram(bigram: Bigram, poses: list[str]) -> str:
    facts = [f'"source": {_dump(bigram.source)}']
    facts += [f'"count": {bigram.count}'] if bigram.count else []
    facts += [f'"note": {_dump(bigram.note)}'] if bigram.note else []
    order = dict.fromkeys(poses)
    names = sorted(bigram.curves, key=lambda pose: _place(order, pose))
    lines = [
        "  " + ", ".join(facts),
        _block("curves", {name: _points(bigram.curves[name]) for name in names}, "  "),
    ]
    if bigram.variance:
        heard = sorted(bigram.variance, key=lambda pose: _place(order, pose))
        rows = (f"{_dump(name)}: {_number(bigram.variance[name])}" for name in heard)
        lines.append('  "variance": {' + ", ".join(rows) + "}")
    return "{\n" + ",\n".join(lines) + "\n }"


def _points(points: Points) -> str:
    return "[" + ", ".join(f"[{_number(time)}, {_number(value)}]" for time, value in points) + "]"


def _number(value: float) -> str:
    """At most `DECIMALS` decimals, and none that is not needed."""
    text = f"{value:.{DECIMALS}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def _setting(value: float) -> str:
    """As `_number`, but what is not 0 stays so: no speed is 0."""
    return _number(value) if abs(value) >= 10**-DECIMALS or not value else f"{value:.{DECIMALS}g}"


def _dump(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)


@contextmanager
def editing(path: PathLike) -> Iterator[None]:
    """Hold a set's file from reading it to writing it; others who edit it wait.

    The lock is that of the file itself and goes with the process. Readers need none: a set is
    written whole.

    Raises:
        LipwrightError: the file cannot be opened, or another program holds it too long.
    """
    if Path(path).exists() and not Path(path).is_file():
        raise LipwrightError(f"{path}: is no file that can be edited; name one")
    try:
        import fcntl
    except ImportError:  # a system without such locks
        yield
        return
    until = time.monotonic() + PATIENCE
    while True:
        try:
            file = Path(path).open("rb")  # noqa: SIM115  # closed below, or with the block
        except OSError as error:
            raise LipwrightError(f"{path}: cannot be read: {error.strerror}") from error
        with file, suppress(OSError):
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if _is_still(path, pair=os.fstat(file.fileno())):
                yield
                return
        if time.monotonic() > until:
            raise LipwrightError(f"{path}: another program is editing this set; wait for its end")
        time.sleep(_POLL)


def _is_still(path: PathLike, pair: os.stat_result) -> bool:
    """Whether the file that was locked is the one of that name: edits put a new one there."""
    try:
        return os.path.samestat(pair, Path(path).stat())
    except OSError:
        return False


def sorted_pairs(pairs: Mapping[Pair, object], classes: Mapping[str, object]) -> list[Pair]:
    """Pairs in the order of classes."""
    return sorted(pairs, key=lambda pair: [_place(classes, one) for one in pair])
