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
from lipwright.dataset.recording import FACE_FILE, INFO_FILE, PHONES_FILE, read_info
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
    named = {outcome.name for outcome in outcomes}
    trackers = set()
    for folder in sorted((path / RECORDINGS).iterdir()):
        if folder.is_dir() and not folder.name.startswith("."):
            old = known.get(folder.name, {})
            entry, tracker = _entry(folder, old, options)
            if old and folder.name not in named:  # what an earlier run found stands
                entry |= {"status": old["status"], "reasons": old.get("reasons", [])}
            entries[folder.name] = entry
            trackers.add(tracker)
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
        "trackers": sorted(trackers - {""}),
        **({"split": before.manifest["split"]} if before and "split" in before.manifest else {}),
        "recordings": [entries[name] for name in sorted(entries)],
    }
    dataset = split_dataset(Dataset(path, manifest), split_options(manifest), keep=True)
    dataset.save()
    return dataset


def _failure(name: str, reason: str) -> dict[str, Any]:
    return {"name": name, "status": FAILED, "reasons": [reason], "files": {}}


def _entry(
    folder: Path, before: Mapping[str, Any], options: CaptureOptions
) -> tuple[dict[str, Any], str]:
    """The manifest's entry of a captured recording, and what tracked it."""
    try:
        info = read_info(folder)
        files = {**info["files"], INFO_FILE: sha256_of(folder / INFO_FILE)}
        reasons, tracker = list(info["reject"]), str(info["tracker"])
    except (LipwrightError, KeyError, TypeError) as error:
        return _failure(folder.name, f"{folder}: {error}; capture it again"), ""
    accepted = before.get("files", {})
    face, phones = folder / FACE_FILE, folder / PHONES_FILE
    if FACE_FILE in accepted and face.is_file():
        files[FACE_FILE] = accepted[FACE_FILE]
    if phones.is_file() and sha256_of(phones) == accepted.get(PHONES_FILE):
        files[PHONES_FILE] = accepted[PHONES_FILE]  # by `dataset check --accept`
    entry = {
        "name": folder.name,
        "status": REJECTED if options.reject and reasons else CAPTURED,
        "reasons": reasons,
        "files": dict(sorted(files.items())),
    }
    return entry, tracker
