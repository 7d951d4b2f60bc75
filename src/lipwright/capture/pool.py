"""Worker processes, one tracker each, for recordings side by side."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from multiprocessing import get_context
from multiprocessing.connection import wait as wait_for
from multiprocessing.process import parent_process
from pathlib import Path
from typing import Any, Final

from lipwright.capture.job import CaptureOptions, Outcome, capture_recording
from lipwright.capture.sources import Source

Tick = Callable[[float], None]

WAITING: Final = 4  # recordings handed out ahead of time
PATIENCE: Final = 0.5  # s between two looks at how far the work is


def all_outcomes(
    sources: Sequence[Source], path: Path, options: CaptureOptions, jobs: int, tick: Tick
) -> Iterator[Outcome]:
    """Each source's outcome as it comes; a source that brings its process down fails alone.

    Args:
        sources: what to capture.
        path: the dataset's folder.
        options: how.
        jobs: recordings at once.
        tick: told now and then how many recordings the work in hand comes to.
    """
    ready = []
    for source in sources:
        if source.problem is None:
            ready.append(source)
        else:
            yield Outcome(source.name, error=source.problem)
    jobs = min(jobs, len(ready))
    while ready:
        suspects: list[Source] = []
        for source, outcome in _pooled(ready, path, options, jobs, tick):
            if outcome is None:
                suspects.append(source)
            else:
                ready.remove(source)
                yield outcome
        if not suspects:
            break
        for source in suspects:  # one of them did it; each gets a process of its own
            ready.remove(source)
            [(_, outcome)] = _pooled([source], path, options, 1, tick)
            yield outcome or Outcome(
                source.name,
                error=f"{source.face}: the tracker's process died of it; convert the video",
            )


def _pooled(
    sources: Sequence[Source], path: Path, options: CaptureOptions, jobs: int, tick: Tick
) -> Iterator[tuple[Source, Outcome | None]]:
    """Outcomes as they come; after a crash None for each source that was in hand, then the end."""
    context = get_context("spawn")
    shares = context.Array("d", jobs, lock=False)  # of its recording that each worker has done
    pool = ProcessPoolExecutor(
        jobs, context, initializer=_start_worker, initargs=(shares, context.Value("i", 0))
    )
    waiting = list(reversed(sources))
    running: dict[Future[Outcome], Source] = {}
    try:
        while waiting or running:
            while waiting and len(running) < jobs + (WAITING if jobs > 1 else 0):
                source = waiting.pop()
                running[pool.submit(_capture, source, path, options)] = source
            done, _ = wait(running, PATIENCE, return_when=FIRST_COMPLETED)
            tick(sum(shares))
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


def _capture(source: Source, path: Path, options: CaptureOptions) -> Outcome:
    [tell] = _own
    try:
        return capture_recording(source, path, options, tell)
    finally:
        tell(0.0)


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


_own: list[Callable[[float], None]] = []
"""in a worker: what to tell of its recording"""


def _start_worker(shares: Any, started: Any) -> None:
    """A worker leaves interrupts to its parent, and ends with it."""
    with started.get_lock():
        place = started.value % len(shares)
        started.value += 1

    def tell(share: float) -> None:
        shares[place] = share

    _own[:] = [tell]
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    parent = parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    wait_for([sentinel])
    os._exit(1)
