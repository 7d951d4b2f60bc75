"""`Dataset`: a folder of recordings with its manifest."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.dataset.recording import (
    FACE_FILE,
    INFO_FILE,
    Recording,
    from_json,
    is_safe_name,
    read_recording,
    to_json,
)
from lipwright.errors import LipwrightError
from lipwright.files import write_whole

FORMAT: Final = "lipwright-dataset"
VERSION: Final = 1  # raise when the layout changes
MANIFEST_FILE: Final = "dataset.json"
RECORDINGS: Final = "recordings"
REPORT: Final = "report"

CAPTURED, REJECTED, FAILED = "captured", "rejected", "failed"
STATUSES: Final = (CAPTURED, REJECTED, FAILED)

_BLOCK: Final = 1 << 20  # bytes read at a time


def refuse_links(root: Path, path: Path) -> Path:
    """`path` below `root`, where nothing on the way is a link, which could lead out of it.

    Raises:
        LipwrightError: something is.
    """
    for place in (path, *path.parents):
        if place == root:
            break
        if place.is_symlink():
            raise LipwrightError(f"{place}: is a link, and a dataset has none; replace it")
    return path


def sha256_of(path: Path) -> str:
    """The SHA-256 of a file's bytes, in hexadecimal.

    Raises:
        LipwrightError: it cannot be read.
    """
    digest = hashlib.sha256()
    try:
        with path.open("rb") as file:
            while block := file.read(_BLOCK):
                digest.update(block)
    except OSError as error:
        raise LipwrightError(f"{path}: cannot be read: {error.strerror}") from error
    return digest.hexdigest()


@dataclass(frozen=True, eq=False)
class Dataset:
    """A folder of recordings; its manifest says which of them are good for what."""

    path: Path
    manifest: dict[str, Any]
    """dataset.json, as docs/dataset.md describes it"""

    @property
    def entries(self) -> list[dict[str, Any]]:
        """The manifest's entries, one a recording: name, status, reasons, split, files."""
        return list(self.manifest["recordings"])

    def entry(self, name: str) -> dict[str, Any]:
        """The manifest's entry of a recording.

        Raises:
            LipwrightError: there is none.
        """
        for entry in self.manifest["recordings"]:
            if entry["name"] == name:
                return dict(entry)
        raise LipwrightError(f"{self.path}: has no recording {name!r}; see: lipwright dataset info")

    def names(self, split: str | None = None, *, usable: bool = True) -> tuple[str, ...]:
        """The names of the recordings, in order.

        Args:
            split: only those of this split.
            usable: only those that were captured and not rejected.
        """
        return tuple(
            entry["name"]
            for entry in self.manifest["recordings"]
            if (split is None or entry.get("split") == split)
            and (not usable or entry["status"] == CAPTURED)
        )

    def folder(self, name: str) -> Path:
        """Where a recording's files lie."""
        return self.path / RECORDINGS / name

    def recording(self, name: str) -> Recording:
        """A recording.

        Raises:
            LipwrightError: it is not in the dataset, failed, or its files are broken.
        """
        if self.entry(name)["status"] == FAILED:
            raise LipwrightError(f"{self.path}: the recording {name!r} failed to be captured")
        return read_recording(self.folder(name))

    def save_face(self, name: str, arrays: Mapping[str, npt.ArrayLike]) -> None:
        """Write the parameters of the reference face of a recording: name to array (T, ...).

        The manifest learns of them by `with_files`.

        Raises:
            LipwrightError: the file cannot be written.
        """
        named: dict[str, Any] = {key: np.asarray(value) for key, value in arrays.items()}
        assert not any(array.dtype.hasobject for array in named.values())  # would be a pickle
        with write_whole(refuse_links(self.path, self.folder(name) / FACE_FILE)) as part:
            np.savez_compressed(part, **named)

    def with_files(self, names: tuple[str, ...], file: str = FACE_FILE) -> Dataset:
        """The dataset whose manifest has the present hash of `file` of the named recordings.

        Raises:
            LipwrightError: a file cannot be read.
        """
        chosen = set(names)
        entries = [
            {**entry, "files": {**entry.get("files", {}),
                                file: sha256_of(self.folder(entry["name"]) / file)}}
            if entry["name"] in chosen else entry
            for entry in self.manifest["recordings"]
        ]  # fmt: skip
        return Dataset(self.path, {**self.manifest, "recordings": entries})

    def save(self) -> None:
        """Write the manifest.

        Raises:
            LipwrightError: it cannot be written.
        """
        with write_whole(refuse_links(self.path, self.path / MANIFEST_FILE)) as part:
            part.write_text(to_json(self.manifest), "utf-8")


def open_dataset(path: str | os.PathLike[str]) -> Dataset:
    """The dataset in a folder.

    Raises:
        LipwrightError: there is none, or its manifest is broken or of another version.
    """
    root = Path(path)
    source = root / MANIFEST_FILE
    try:
        manifest = from_json(source.read_text("utf-8"))
    except FileNotFoundError as error:
        raise LipwrightError(
            f"{path}: not a dataset: it has no {MANIFEST_FILE}; make one with: lipwright capture"
        ) from error
    except OSError as error:
        raise LipwrightError(f"{source}: cannot be read: {error.strerror}") from error
    except (ValueError, RecursionError) as error:
        raise LipwrightError(
            f"{source}: not JSON ({error}); restore it, or delete it and capture again"
        ) from error
    _check_manifest(source, manifest)
    return Dataset(root, manifest)


def _check_manifest(source: Path, manifest: Any) -> None:
    if not isinstance(manifest, dict) or manifest.get("format") != FORMAT:
        raise LipwrightError(f"{source}: not the manifest of a dataset; name another folder")
    if manifest.get("version") != VERSION:
        raise LipwrightError(
            f"{source}: version {manifest.get('version')!r} of the layout, not {VERSION}; "
            "capture again, or use the Lipwright that made it"
        )
    entries = manifest.get("recordings")
    if not isinstance(entries, list):
        raise LipwrightError(f"{source}: has no list of recordings; delete it and capture again")
    seen: set[str] = set()
    for number, entry in enumerate(entries, 1):
        if not isinstance(entry, dict) or not is_safe_name(entry.get("name")):
            raise LipwrightError(f"{source}: recording {number} has no name that can be one")
        if entry["name"] in seen:
            raise LipwrightError(f"{source}: the recording {entry['name']!r} is there twice")
        seen.add(entry["name"])
        if entry.get("status") not in STATUSES:
            raise LipwrightError(
                f"{source}: {entry['name']!r} has the status {entry.get('status')!r}, "
                f"not one of: {', '.join(STATUSES)}"
            )
        reasons, split = entry.get("reasons", []), entry.get("split", "")
        if not isinstance(split, str | None) or not (
            isinstance(reasons, list) and all(isinstance(reason, str) for reason in reasons)
        ):
            raise LipwrightError(f"{source}: {entry['name']!r} has no readable reasons or split")
        files = entry.get("files", {})
        if not isinstance(files, dict) or not all(is_safe_name(file) for file in files):
            raise LipwrightError(f"{source}: {entry['name']!r} names files out of its folder")


def recording_files(folder: Path) -> dict[str, str]:
    """File name to SHA-256 of what lies in a recording's folder, but recording.json.

    Raises:
        LipwrightError: a file cannot be read.
    """
    return {
        path.name: sha256_of(path)
        for path in sorted(folder.iterdir())
        if path.is_file() and path.name != INFO_FILE and not path.name.startswith(".")
    }
