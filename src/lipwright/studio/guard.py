"""What every request must be before anything looks at it, and what every answer says.

The server is for the page of the same address and nobody else: not for other pages in the same
browser, nor for names that were made to point at this machine (DNS rebinding).
"""

from __future__ import annotations

import ipaddress
import json
from typing import Final
from urllib.parse import urlsplit

from starlette.types import ASGIApp, Message, Receive, Scope, Send

MAX_BODY: Final = 1024 * 1024  # bytes; the largest pair is some tens of thousands
WRITING: Final = frozenset(("POST", "PUT"))
METHODS: Final = frozenset(("GET", "HEAD")) | WRITING
OWN_SITE: Final = frozenset((b"same-origin", b"none"))  # Sec-Fetch-Site; none: typed by the user

HEADERS: Final = (
    (b"content-security-policy",
     b"default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
     b"connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"),
    (b"x-content-type-options", b"nosniff"),
    (b"x-frame-options", b"DENY"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cache-control", b"no-store"),
)  # fmt: skip


class _RefusedError(Exception):
    def __init__(self, status: int, message: str) -> None:
        super().__init__(message)
        self.status = status


class Guard:
    """Stands before the application."""

    def __init__(self, app: ASGIApp, host: str) -> None:
        """`host` is where the server listens."""
        self._app = app
        self._host = host

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, or pass on."""
        if scope["type"] != "http":
            if scope["type"] == "lifespan":
                await self._app(scope, receive, send)
            return  # nothing else is served; uvicorn closes it

        async def send_guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                message = {**message, "headers": [*message["headers"], *HEADERS]}
            await send(message)

        try:
            if scope["method"] in WRITING:
                # Read before anything is refused: who hangs up too soon is not heard.
                receive = _replay(await _body(scope, receive), receive)
            self._check(scope)
        except _RefusedError as error:
            await _refuse(send_guarded, error)
        else:
            await self._app(scope, receive, send_guarded)

    def _check(self, scope: Scope) -> None:
        headers = scope["headers"]
        if scope["method"] not in METHODS:
            raise _RefusedError(405, f"{scope['method'][:20]} is not answered here")
        hosts = [value.decode("latin-1") for name, value in headers if name == b"host"]
        if len(hosts) != 1 or not is_ours(hosts[0], self._host, scope["server"][1]):
            raise _RefusedError(421, "the address is not that of this editor; open the one it said")
        for name, value in headers:
            if name == b"origin" and value.decode("latin-1") != f"http://{hosts[0]}":
                raise _RefusedError(403, "the request comes from another site")
            if name == b"sec-fetch-site" and value not in OWN_SITE and not _is_visit(scope):
                raise _RefusedError(403, "the request comes from another site")
        if scope["method"] in WRITING:
            kinds = [value for name, value in headers if name == b"content-type"]
            if [kind.partition(b";")[0].strip().lower() for kind in kinds] != [b"application/json"]:
                raise _RefusedError(415, "send JSON, and say so (Content-Type: application/json)")


def is_ours(given: str, host: str, port: int) -> bool:
    """Whether a Host header names this server.

    Where it listens everywhere, any number of an address is: no name server can point to one.
    """
    try:
        parts = urlsplit(f"//{given}")
        name, given_port = parts.hostname or "", parts.port or 80
    except ValueError:
        return False
    if given_port != port or parts.netloc != given or parts.username is not None:
        return False
    if name in {"localhost", "127.0.0.1", "::1", host.strip("[]").lower()}:
        return True
    try:
        ipaddress.ip_address(name)
        return ipaddress.ip_address(host.strip("[]")).is_unspecified
    except ValueError:
        return False


def _is_visit(scope: Scope) -> bool:
    """Whether somebody followed a link to the page, which tells the site of the link nothing."""
    visits = (b"sec-fetch-mode", b"navigate") in scope["headers"]
    return visits and scope["method"] == "GET" and scope["path"] == "/"


async def _body(scope: Scope, receive: Receive) -> bytes:
    too_much = _RefusedError(413, f"more than {MAX_BODY >> 20} MB")
    for name, value in scope["headers"]:
        if name == b"content-length" and (not value.isdigit() or int(value[:20]) > MAX_BODY):
            raise too_much
    body = b""
    while True:
        message = await receive()
        if message["type"] == "http.disconnect":
            raise _RefusedError(400, "the request ends early")
        body += message.get("body", b"")
        if len(body) > MAX_BODY:
            raise too_much
        if not message.get("more_body", False):
            return body


def _replay(body: bytes, receive: Receive) -> Receive:
    """Gives the body that was read, then what comes later."""
    given = False

    async def again() -> Message:
        nonlocal given
        if given:
            return await receive()
        given = True
        return {"type": "http.request", "body": body, "more_body": False}

    return again


async def _refuse(send: Send, error: _RefusedError) -> None:
    body = json.dumps({"error": str(error)}).encode()
    headers = [
        (b"content-type", b"application/json"),
        (b"content-length", str(len(body)).encode()),
        (b"connection", b"close"),
    ]
    await send({"type": "http.response.start", "status": error.status, "headers": headers})
    await send({"type": "http.response.body", "body": body})
