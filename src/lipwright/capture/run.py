"""Capturing many recordings: several at once, to be taken up again wherever it was stopped."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from lipwright.capture.filling import sweep
from lipwright.capture.job import CaptureOptions, Outcome, prepare
from lipwright.capture.pool import all_outcomes
from lipwright.capture.report import STYLE
from lipwright.capture.sources import Source
from lipwright.dataset.folder import (
    MANIFEST_FILE,
    RECORDINGS,
    REPORT,
    Dataset,
    open_dataset,
    refuse_links,
)
from lipwright.dataset.lock import LOCK_FILE, locked
from lipwright.dataset.recording import INFO_FILE
from lipwright.errors import LipwrightError

Report = Callable[[str, float], None]
Tell = Callable[[Outcome], None]


@dataclass(frozen=True, eq=False)
class Captured:
    """What a run leaves."""

    dataset: Dataset
    outcomes: tuple[Outcome, ...]
    """one a source, in the order of their names"""
    rejects: bool = False
    """whether what should be left out is"""

    @property
    def failed(self) -> tuple[Outcome, ...]:
        """The sources that were not captured."""
        return tuple(outcome for outcome in self.outcomes if outcome.error is not None)


def capture(
    sources: Sequence[Source],
    path: Path,
    options: CaptureOptions,
    *,
    jobs: int | None = None,
    report: Report = lambda stage, share: None,
    tell: Tell = lambda outcome: None,
) -> Captured:
    """Capture `sources` into the dataset at `path`; what is there already stays as it is.

    Args:
        sources: what to capture.
        path: the dataset's folder; made where there is none.
        options: how, and what the manifest says of it.
        jobs: recordings at once; as many as there are processors, unless given.
        report: told how far the whole is.
        tell: told of each recording that is done.

    Raises:
        LipwrightError: the folder cannot be used or is being written to by another run, a part
            that every recording needs is missing, or the manifest cannot be written.
    """
    from lipwright.capture.assemble import assemble

    _make_folder(path)
    with locked(path):
        sweep(refuse_links(path, path / RECORDINGS))
        prepare(sources, options)
        outcomes: dict[str, Outcome] = {}

        def tick(in_hand: float) -> None:
            report("capture", min((len(outcomes) + in_hand) / len(sources), 1.0))

        tick(0.0)
        for outcome in all_outcomes(sources, path, options, jobs or os.cpu_count() or 1, tick):
            outcomes[outcome.name] = outcome
            report("capture", len(outcomes) / len(sources))
            tell(outcome)
        ordered = tuple(outcomes[source.name] for source in sources)
        return Captured(assemble(path, ordered, options), ordered, options.reject)


def _make_folder(path: Path) -> None:
    try:
        if path.exists() and not path.is_dir():
            raise LipwrightError(f"{path}: is a file; name a new folder")
        if (path / MANIFEST_FILE).is_file():
            open_dataset(path)  # refuses what is not ours
        elif strangers := _strangers(path):
            raise LipwrightError(
                f"{path}: holds {strangers[0]!r} and is no dataset; name a new folder"
            )
        (path / RECORDINGS).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LipwrightError(f"{path}: cannot be made: {error.strerror}") from error


def _strangers(path: Path) -> list[str]:
    """What no capture can have left there, were it stopped, or its manifest deleted."""
    if not path.is_dir():
        return []
    ours = {RECORDINGS, LOCK_FILE}
    if (path / REPORT / STYLE).is_file():
        ours.add(REPORT)
    found = [
        file.name
        for file in path.iterdir()
        if file.name not in ours and not file.name.startswith(".")
    ]
    recordings = path / RECORDINGS
    if recordings.is_dir():
        found += [
            f"{RECORDINGS}/{folder.name}"
            for folder in recordings.iterdir()
            if folder.name[0] != "." and not (folder / INFO_FILE).is_file()
        ]
    return sorted(found)
