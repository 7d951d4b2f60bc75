"""Our end of the process that holds espeak-ng: one request at a time, started anew if it dies."""

from __future__ import annotations

import atexit
import ctypes.util
import importlib.util
import json
import os
import re
import struct
import subprocess
import sys
import threading
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import IO, Any, Final

from lipwright.errors import LipwrightError, MissingExtraError

EXTRA: Final = "espeak"
WHAT: Final = "espeak-ng"
OLDEST: Final = (1, 52)
"""version; 1.51 spells Mandarin characters as the names of letters"""
START_TIMEOUT: Final = 20.0  # s; it takes 0.05 s on an idle machine
LOADER: Final = "espeakng_loader"
_MOST_HEADER: Final = 1 << 28  # bytes; 100,000 events take about 5 MB


class _DiedError(Exception):
    """The process ended before it had answered."""


class Child:
    """A running process and its pipes; used by one thread at a time."""

    def __init__(self, library: str, data: str) -> None:
        """Start it with a library and the folder of its data.

        Raises:
            LipwrightError: it cannot be started, or the library is too old.
        """
        script = str(Path(__file__).with_name("child.py"))
        self._running = subprocess.Popen(
            [sys.executable, "-I", "-S", script, library, data],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        assert self._running.stdin is not None
        assert self._running.stdout is not None
        self._requests: IO[bytes] = self._running.stdin
        self._answers: IO[bytes] = self._running.stdout
        try:
            hello, _ = self._timed(None, START_TIMEOUT)
            self.version = _checked_version(hello, library)
        except BaseException:
            self.stop()
            raise

    @property
    def pid(self) -> int:
        """The number of the process."""
        return self._running.pid

    def ask(self, request: dict[str, Any], timeout: float) -> tuple[dict[str, Any], bytes]:
        """Header and sound of the answer; whatever goes wrong, the process is gone afterwards.

        Raises:
            LipwrightError: it died, or took longer than `timeout` s.
        """
        try:
            return self._timed(request, timeout)
        except BaseException:
            self.stop()
            raise

    def _timed(
        self, request: dict[str, Any] | None, timeout: float
    ) -> tuple[dict[str, Any], bytes]:
        late = threading.Event()

        def end() -> None:
            late.set()
            self._running.kill()

        clock = threading.Timer(timeout, end)
        clock.daemon = True
        clock.start()
        try:
            if request is not None:
                data = json.dumps(request).encode()
                self._requests.write(struct.pack(">I", len(data)) + data)
                self._requests.flush()
            header = json.loads(self._read(self._read_size()))
            return header, self._read(header.get("pcm", 0))
        except (OSError, ValueError, _DiedError) as error:
            if late.is_set():
                raise LipwrightError(
                    f"espeak-ng did not answer within {timeout:.0f} s and was ended; try again "
                    "with less text"
                ) from error
            raise LipwrightError(
                f"espeak-ng ended unexpectedly ({self._fate()}); try again, or with other words"
            ) from error
        finally:
            clock.cancel()

    def _fate(self) -> str:
        try:
            status = self._running.wait(1.0)
        except subprocess.TimeoutExpired:
            return "its answer was damaged"
        return f"signal {-status}" if status < 0 else f"status {status}"

    def _read_size(self) -> int:
        size: int = struct.unpack(">I", self._read(4))[0]
        if size > _MOST_HEADER:
            raise ValueError(f"a header of {size} bytes")
        return size

    def _read(self, count: int) -> bytes:
        data = self._answers.read(count) if count else b""
        if len(data) < count:
            raise _DiedError
        return data

    def stop(self) -> None:
        """End it and take its status, so that no zombie stays."""
        self._running.kill()
        for pipe in (self._requests, self._answers):
            with suppress(OSError):
                pipe.close()
        self._running.wait()

    def forget(self) -> None:
        """After a fork: the process is our parent's; drop our copies of its pipes."""
        for pipe in (self._requests, self._answers):
            with suppress(OSError):
                os.close(pipe.fileno())
        self._running.returncode = 0  # not ours to wait for


def _checked_version(hello: dict[str, Any], library: str) -> str:
    if "refused" in hello:
        raise LipwrightError(
            f"{library}: espeak-ng cannot be loaded: {hello['refused']}; run: "
            f"pip install --force-reinstall 'lipwright[{EXTRA}]'"
        )
    text = str(hello["version"])
    parts = re.match(r"(\d+)\.(\d+)", text)
    if parts is None or (int(parts[1]), int(parts[2])) < OLDEST:
        raise LipwrightError(
            f"{library}: espeak-ng {text} is too old, {OLDEST[0]}.{OLDEST[1]} or later is needed; "
            f"run: pip install 'lipwright[{EXTRA}]'"
        )
    return text


@cache
def find_library() -> tuple[str, str] | None:
    """The library and the folder of its data ("" for its own), or None where there is none."""
    spec = importlib.util.find_spec(LOADER)
    if spec is not None and spec.origin is not None:
        folder = Path(spec.origin).parent
        names = ("libespeak-ng.so", "libespeak-ng.dylib", "espeak-ng.dll", "libespeak-ng.dll")
        data = folder / "espeak-ng-data"
        for name in names:
            if (folder / name).is_file() and data.is_dir():
                return str(folder / name), str(data)
    for name in ("espeak-ng", "libespeak-ng"):
        found = ctypes.util.find_library(name)
        if found is not None:
            return found, ""
    return None


class _Keeper:
    """The one process of this program, and who may talk to it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._child: Child | None = None

    def child(self) -> Child:
        """The running process; started if there is none. The lock must be held."""
        if self._child is None:
            found = find_library()
            if found is None:
                raise MissingExtraError(WHAT, EXTRA)
            self._child = Child(*found)
        return self._child

    def ask(self, request: dict[str, Any], timeout: float) -> tuple[dict[str, Any], bytes]:
        with self._lock:
            child = self.child()
            try:
                return child.ask(request, timeout)
            except BaseException:
                self._child = None
                raise

    def version(self) -> str:
        with self._lock:
            return self.child().version

    def pid(self) -> int | None:
        with self._lock:
            return None if self._child is None else self._child.pid

    def stop(self) -> None:
        with self._lock:
            if self._child is not None:
                self._child.stop()
                self._child = None

    def after_fork(self) -> None:
        """In a forked process: its parent may have held the lock, and owns the process."""
        self._lock = threading.Lock()
        if self._child is not None:
            self._child.forget()
            self._child = None


KEEPER: Final = _Keeper()
atexit.register(KEEPER.stop)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=KEEPER.after_fork)
