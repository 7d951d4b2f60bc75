"""The editor's server: one desk, one address of this machine, until Ctrl-C."""

from __future__ import annotations

import os
import signal
import socket
from collections.abc import Callable, Generator
from contextlib import contextmanager

import uvicorn

from lipwright.errors import LipwrightError
from lipwright.studio.api import create_app
from lipwright.studio.desk import Desk

LAST_ANSWERS = 2  # s that requests have when it ends


class _Server(uvicorn.Server):
    """Ends on Ctrl-C as on any other wish, without a signal sent again to those who call it."""

    @contextmanager
    def capture_signals(self) -> Generator[None, None, None]:
        numbers = (signal.SIGINT, signal.SIGTERM)
        before = {number: signal.signal(number, self.handle_exit) for number in numbers}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)


def listen(host: str, port: int) -> socket.socket:
    """A socket at that address; port 0 takes a free one.

    Raises:
        LipwrightError: the address is not this machine's, or is taken.
    """
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        # asyncio sends at once (TCP_NODELAY) only where the protocol is named; else 40 ms are lost.
        listening = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
        try:
            if os.name == "posix":
                listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listening.bind((host, port))
            listening.listen()
        except BaseException:
            listening.close()
            raise
    except (OSError, OverflowError, UnicodeError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise LipwrightError(
            f"{host[:80]}:{port}: cannot be listened on: {reason}; choose another --port or --host"
        ) from error
    return listening


def address(host: str, listening: socket.socket) -> str:
    """What to open in a browser."""
    name = {"0.0.0.0": "127.0.0.1", "::": "[::1]", "": "127.0.0.1"}.get(host, host)  # noqa: S104  # only compared
    if ":" in name and not name.startswith("["):
        name = f"[{name}]"
    return f"http://{name}:{listening.getsockname()[1]}/"


def serve(desk: Desk, host: str, listening: socket.socket, begun: Callable[[], None]) -> None:
    """Answer until somebody stops it; `begun` is called when answers can be had."""
    level = "error" if os.environ.get("LIPWRIGHT_DEBUG") else "critical"
    config = uvicorn.Config(
        create_app(desk, host), log_level=level, access_log=False, server_header=False,
        timeout_graceful_shutdown=LAST_ANSWERS, ws="none", lifespan="off", proxy_headers=False,
    )  # fmt: skip
    server = _Server(config)
    begun()
    try:
        server.run(sockets=[listening])
    finally:
        desk.close()
