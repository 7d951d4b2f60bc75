"""Capturing many recordings: several at once, to be taken up again wherever it was stopped."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import wait as wait_for
from multiprocessing.process import parent_process
from pathlib import Path
from typing import Any, Final

from lipwright.capture.filling import sweep
from lipwright.capture.job import CaptureOptions, Outcome, capture_recording, prepare
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

WAITING: Final = 4  # recordings handed out a worker ahead of time


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
        report("capture", 0.0)
        for outcome in _all_outcomes(sources, path, options, jobs or os.cpu_count() or 1):
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
    found = [file.name for file in path.iterdir() if file.name not in ours]
    recordings = path / RECORDINGS
    if recordings.is_dir():
        found += [
            f"{RECORDINGS}/{folder.name}"
            for folder in recordings.iterdir()
            if folder.name[0] != "." and not (folder / INFO_FILE).is_file()
        ]
    return sorted(found)


def _all_outcomes(
    sources: Sequence[Source], path: Path, options: CaptureOptions, jobs: int
) -> Iterator[Outcome]:
    """Each source's outcome as it comes; a source that brings its process down fails alone."""
    ready = []
    for source in sources:
        if source.problem is None:
            ready.append(source)
        else:
            yield Outcome(source.name, error=source.problem)
    jobs = min(jobs, len(ready))
    suspects: list[Source] = []
    while ready:
        suspects = []
        for source, outcome in _pooled(ready, path, options, jobs):
            if outcome is None:
                suspects.append(source)
            else:
                ready.remove(source)
                yield outcome
        if not suspects:
            break
        for source in suspects:  # one of them did it; each gets a process of its own
            ready.remove(source)
            [(_, outcome)] = _pooled([source], path, options, 1)
            yield outcome or Outcome(
                source.name,
                error=f"{source.face}: the tracker's process died of it; convert the video",
            )


def _pooled(
    sources: Sequence[Source], path: Path, options: CaptureOptions, jobs: int
) -> Iterator[tuple[Source, Outcome | None]]:
    """Outcomes as they come; after a crash None for each source that was in hand, then the end."""
    pool = ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=_start_worker)
    waiting = list(reversed(sources))
    running: dict[Future[Outcome], Source] = {}
    try:
        while waiting or running:
            while waiting and len(running) < jobs + (WAITING if jobs > 1 else 0):
                source = waiting.pop()
                running[pool.submit(capture_recording, source, path, options)] = source
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                try:
                    outcome = future.result()
                except BrokenProcessPool:
                    yield from ((source, None) for source in running.values())
                    return
                yield running.pop(future), outcome
    except BrokenProcessPool:  # on handing out
        yield from ((source, None) for source in running.values())
    finally:
        _stop(pool)


def _stop(pool: ProcessPoolExecutor) -> None:
    """End the workers now; what they have in hand is lost and swept by the next run."""
    processes: dict[int, Any] = dict(getattr(pool, "_processes", None) or {})
    pool.shutdown(wait=False, cancel_futures=True)
    for process in processes.values():
        with suppress(OSError, ValueError):
            process.terminate()
    for process in processes.values():
        with suppress(OSError, ValueError, AssertionError):
            process.join(5)


def _start_worker() -> None:
    """A worker leaves interrupts to its parent, and ends with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    parent = parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    wait_for([sentinel])
    os._exit(1)
