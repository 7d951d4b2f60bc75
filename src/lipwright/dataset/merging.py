"""Several datasets as one."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np

from lipwright.dataset.folder import (
    FAILED,
    FORMAT,
    RECORDINGS,
    VERSION,
    Dataset,
    sha256_of,
)
from lipwright.dataset.lock import LOCK_FILE, locked
from lipwright.dataset.recording import (
    FACE_FILE,
    INFO_FILE,
    PHONES_FILE,
    is_safe_name,
    read_info,
    read_recording,
    write_info,
)
from lipwright.errors import LipwrightError
from lipwright.version import VERSION as LIPWRIGHT

UNKNOWN: Final = "unknown"  # a licence, tracker or face that is not named


@dataclass(frozen=True)
class MergeOptions:
    """How to merge."""

    prefixes: tuple[str, ...] = ()
    """put before the names of each dataset's recordings; () for none"""
    mixed: bool = False
    """recordings of several trackers may come together"""


@dataclass(frozen=True, eq=False)
class _Row:
    """A recording on its way."""

    source: Dataset
    entry: dict[str, Any]
    name: str
    """in the merged dataset"""

    @property
    def folder(self) -> Path:
        return self.source.folder(self.entry["name"])

    @cached_property
    def info(self) -> dict[str, Any]:
        return read_info(self.folder)

    @property
    def is_there(self) -> bool:
        """Whether it has files: one that failed need not."""
        return self.entry["status"] != FAILED or self.folder.is_dir()


def merge_datasets(
    datasets: Sequence[Dataset],
    out: Path,
    options: MergeOptions | None = None,
    report: Callable[[str, float], None] = lambda stage, share: None,
) -> tuple[Dataset, tuple[str, ...]]:
    """Copy the recordings of `datasets` into a new dataset; all of it is there or nothing.

    Splits stay as they are, so that nothing that was trained on is tested.

    Args:
        datasets: two or more.
        out: the new folder.
        options: how.
        report: told how far it is.

    Returns:
        The new dataset, and lines about what the user should know of it.

    Raises:
        LipwrightError: names or trackers clash, a file is missing or has changed, or `out` is
            there already or cannot be written.
    """
    options = options or MergeOptions()
    rows = _rows(datasets, options)
    notes = [*_tracker_notes(rows, options), *_fps_notes(rows), *_licence_notes(datasets)]
    faces = _face_models(rows)
    if len(faces) > 1:
        notes.append(
            f"parameters of {len(faces)} reference faces do not mix and were left out; "
            "run: lipwright face fit"
        )
    with _made_whole(out, datasets) as part:
        entries = []
        for number, row in enumerate(rows, 1):
            entries.append(_copy(row, part, with_face=len(faces) <= 1))
            report("merge", number / len(rows))
        manifest = _manifest(out, datasets, entries)
        Dataset(part, manifest).save()
    return Dataset(out, manifest), tuple(notes)


def _manifest(
    out: Path, datasets: Sequence[Dataset], entries: Sequence[dict[str, Any]]
) -> dict[str, Any]:
    return {
        "format": FORMAT, "version": VERSION, "lipwright": LIPWRIGHT, "name": out.name,
        "licence": join_licences([d.manifest.get("licence") for d in datasets]),
        "merged": [d.manifest.get("name") or d.path.name for d in datasets],
        "recordings": sorted(entries, key=lambda entry: str(entry["name"])),
    }  # fmt: skip


def join_licences(licences: Sequence[object]) -> str:
    """One expression out of several, each once, in order; empty where none is named."""
    named = dict.fromkeys(str(licence or "").strip() or UNKNOWN for licence in licences)
    if len(named) == 1:
        [only] = named
        return "" if only == UNKNOWN else only
    return " AND ".join(f"({one})" if " OR " in one else one for one in named)


def _rows(datasets: Sequence[Dataset], options: MergeOptions) -> list[_Row]:
    if len(datasets) < 2:
        raise LipwrightError("name two datasets or more to merge")
    prefixes = options.prefixes or ("",) * len(datasets)
    if len(prefixes) != len(datasets):
        raise LipwrightError(
            f"--prefix: {len(prefixes)} for {len(datasets)} datasets; give one for each, in order"
        )
    rows: dict[str, _Row] = {}
    for dataset, prefix in zip(datasets, prefixes, strict=True):
        for entry in dataset.entries:
            name = prefix + entry["name"]
            if not is_safe_name(name):
                raise LipwrightError(f"--prefix {prefix!r}: {name!r} cannot be a recording's name")
            if name.casefold() in rows:  # as on disks that do not tell capitals apart
                raise LipwrightError(
                    f"{dataset.path}: the recording {name!r} is in "
                    f"{rows[name.casefold()].source.path} too; tell them apart with --prefix, "
                    "one for each dataset"
                )
            rows[name.casefold()] = _Row(dataset, entry, name)
    return list(rows.values())


def _tracker_notes(rows: Sequence[_Row], options: MergeOptions) -> Iterator[str]:
    trackers: dict[str, Path] = {}
    for row in rows:
        if row.is_there:
            trackers.setdefault(str(row.info.get("tracker") or UNKNOWN), row.source.path)
    if len(trackers) < 2:
        return
    told = ", ".join(f"{tracker} in {path}" for tracker, path in trackers.items())
    if not options.mixed:
        raise LipwrightError(
            f"the faces were tracked in different ways ({told}); capture them in one way, or "
            "merge them as they are with --mixed"
        )
    yield f"the faces were tracked in different ways: {told}"


def _fps_notes(rows: Sequence[_Row]) -> Iterator[str]:
    rates = [row.info.get("fps") for row in rows if row.is_there]
    known = {rate for rate in rates if isinstance(rate, int | float)}
    if len(known) > 1:
        told = ", ".join(f"{rate:g}" for rate in sorted(known))
        yield f"recordings have {told} frames a second; training resamples them"


def _licence_notes(datasets: Sequence[Dataset]) -> Iterator[str]:
    for dataset in datasets:
        if not str(dataset.manifest.get("licence") or "").strip():
            yield f"{dataset.path}: names no licence; may its recordings be passed on?"


def _face_models(rows: Sequence[_Row]) -> set[str]:
    """The reference faces whose parameters there are."""
    models = set()
    for row in rows:
        if row.is_there and (row.folder / FACE_FILE).is_file():
            face = read_recording(row.folder).face() or {}
            models.add(str(face.get("model", np.asarray(UNKNOWN))))
    return models


def _copy(row: _Row, part: Path, *, with_face: bool) -> dict[str, Any]:
    """Copy a recording's files; its entry in the new manifest."""
    entry = {**row.entry, "name": row.name}
    if not row.is_there:
        return entry
    target = part / RECORDINGS / row.name
    target.mkdir()
    hashes = dict(row.entry.get("files", {}))
    if not with_face:
        hashes.pop(FACE_FILE, None)
    for file in sorted({*hashes, PHONES_FILE} - {INFO_FILE}):
        if (row.folder / file).is_symlink():
            raise LipwrightError(f"{row.folder / file}: is a link; put the file itself there")
        shutil.copyfile(row.folder / file, target / file)
        # Phones that were edited by hand stay known as edited.
        if file != PHONES_FILE and sha256_of(target / file) != hashes[file]:
            raise LipwrightError(
                f"{row.folder / file}: has changed since it was written; "
                f"see: lipwright dataset check {row.source.path}"
            )
    write_info(target, {**row.info, "name": row.name})
    if INFO_FILE in hashes:
        hashes[INFO_FILE] = sha256_of(target / INFO_FILE)
    return {**entry, "files": hashes}


@contextmanager
def _made_whole(out: Path, datasets: Sequence[Dataset]) -> Iterator[Path]:
    """A folder beside `out` that takes its place when the block ends well.

    What a killed merge into the same place left is removed first.
    """
    target = Path(os.path.abspath(out))  # noqa: PTH100  # a link stays one
    if target.exists() or target.is_symlink():
        raise LipwrightError(f"{out}: is there already; name a new folder")
    for dataset in datasets:
        if target.is_relative_to(dataset.path.resolve()):
            raise LipwrightError(f"{out}: lies in {dataset.path}; name a folder outside of it")
    if not target.parent.is_dir():
        raise LipwrightError(f"{out}: there is no folder {target.parent}; make it first")
    part = target.with_name(f".{target.name}.part")
    try:
        part.mkdir(exist_ok=True)
        with locked(part):
            try:
                shutil.rmtree(part / RECORDINGS, ignore_errors=True)
                (part / RECORDINGS).mkdir()
                yield part
                (part / LOCK_FILE).unlink()
                part.rename(target)
            except BaseException:
                shutil.rmtree(part, ignore_errors=True)
                raise
    except FileNotFoundError as error:
        raise LipwrightError(f"{error.filename}: no such file; capture again") from error
    except OSError as error:
        raise LipwrightError(f"{out}: cannot be written: {error.strerror}") from error
