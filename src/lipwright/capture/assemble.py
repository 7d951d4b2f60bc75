"""The manifest of a dataset, out of what its recordings' folders hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from lipwright.capture.job import CaptureOptions, Outcome
from lipwright.dataset.folder import (
    CAPTURED,
    FAILED,
    FORMAT,
    MANIFEST_FILE,
    RECORDINGS,
    REJECTED,
    VERSION,
    Dataset,
    open_dataset,
    sha256_of,
)
from lipwright.dataset.recording import FACE_FILE, INFO_FILE, read_info
from lipwright.dataset.splits import split_dataset, split_options
from lipwright.errors import LipwrightError
from lipwright.version import VERSION as LIPWRIGHT


def assemble(path: Path, outcomes: Sequence[Outcome], options: CaptureOptions) -> Dataset:
    """Write the manifest: what was captured now and before, and what failed.

    The same folders and outcomes give the same bytes.

    Raises:
        LipwrightError: it cannot be written.
    """
    before = open_dataset(path) if (path / MANIFEST_FILE).is_file() else None
    known = {entry["name"]: entry for entry in before.entries} if before else {}
    entries = {name: entry for name, entry in known.items() if entry["status"] == FAILED}
    for folder in sorted((path / RECORDINGS).iterdir()):
        if folder.is_dir() and not folder.name.startswith("."):
            entries[folder.name] = _entry(folder, known.get(folder.name, {}), options)
    for entry in entries.values():
        if "split" in (old := known.get(entry["name"], {})):
            entry["split"] = old["split"]
    for outcome in outcomes:
        if outcome.error is not None and outcome.name not in entries:
            entries[outcome.name] = _failure(outcome.name, outcome.error)
        elif outcome.error is not None:
            entries[outcome.name] |= {"status": FAILED, "reasons": [outcome.error]}
    manifest = {
        "format": FORMAT,
        "version": VERSION,
        "lipwright": LIPWRIGHT,
        "name": options.name or (before.manifest.get("name") if before else None) or path.name,
        "licence": options.licence or (before.manifest.get("licence", "") if before else ""),
        "options": options.shaping(),
        **({"split": before.manifest["split"]} if before and "split" in before.manifest else {}),
        "recordings": [entries[name] for name in sorted(entries)],
    }
    dataset = split_dataset(Dataset(path, manifest), split_options(manifest), keep=True)
    dataset.save()
    return dataset


def _failure(name: str, reason: str) -> dict[str, Any]:
    return {"name": name, "status": FAILED, "reasons": [reason], "files": {}}


def _entry(folder: Path, before: Mapping[str, Any], options: CaptureOptions) -> dict[str, Any]:
    """The manifest's entry of a captured recording."""
    try:
        info = read_info(folder)
        files = {**info["files"], INFO_FILE: sha256_of(folder / INFO_FILE)}
    except (LipwrightError, KeyError, TypeError) as error:
        return _failure(folder.name, f"{folder}: {error}; capture it again")
    face = before.get("files", {}).get(FACE_FILE)
    if face is not None and (folder / FACE_FILE).is_file():
        files[FACE_FILE] = face
    rejected = options.reject and info["reject"]
    return {
        "name": folder.name,
        "status": REJECTED if rejected else CAPTURED,
        "reasons": info["reject"],
        "files": dict(sorted(files.items())),
    }
