"""One JSON request to a voice server and its answer, with everything that may go wrong named."""

from __future__ import annotations

import http.client
import json
import os
import time
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Mapping
from dataclasses import dataclass
from email.message import Message
from typing import IO, Any, Final

from lipwright.errors import LipwrightError
from lipwright.version import VERSION

TOKEN: Final = "LIPWRIGHT_VOICE_TOKEN"  # noqa: S105  # its name, not its value
"""environment variable whose value goes into the header Authorization, as a bearer token"""
WAIT: Final = 60.0  # s for the server to say anything
MOST_WAIT: Final = 600.0  # s for the whole answer
MOST_BYTES: Final = 100 << 20
_BLOCK: Final = 1 << 20  # bytes
_LOCAL: Final = frozenset(("127.0.0.1", "localhost", "::1"))
_SHOWN: Final = 120  # characters of what a server says about its own error


@dataclass(frozen=True)
class Address:
    """Where a voice server is.

    Raises:
        LipwrightError: it is not the address of a server; made by `read_address`.
    """

    url: str
    """without the name of the voice"""
    voice: str
    """what followed #, or "" """
    shown: str
    """as it is printed: without the query, which may hold a key"""

    @property
    def is_local(self) -> bool:
        """Whether it is this machine."""
        return urllib.parse.urlsplit(self.url).hostname in _LOCAL

    @property
    def is_secret(self) -> bool:
        """Whether nobody between can read along."""
        return self.is_local or self.url.casefold().startswith("https:")


def read_address(text: str) -> Address:
    """The address of a voice server as `--voice` takes it.

    Raises:
        LipwrightError: it is no address, of another kind than http and https, or has a password.
    """
    remedy = "write it as http://127.0.0.1:8123/speak#name"
    try:
        parts = urllib.parse.urlsplit(text)
        host, _ = parts.hostname, parts.port
    except ValueError as error:
        reason = "" if "@" in text else f" ({error})"  # which may quote a password
        raise LipwrightError(
            f"the voice {_without_secrets(text)!a} is no address{reason}; {remedy}"
        ) from None
    if parts.scheme not in ("http", "https") or not host:
        raise LipwrightError(
            f"the voice {_without_secrets(text)!a} is not the address of a server; {remedy}"
        )
    if "@" in parts.netloc:
        raise LipwrightError(
            f"the voice {parts.scheme}://...@{host}: has a password in its address; put a token "
            f"into the environment variable {TOKEN}"
        )
    path = urllib.parse.quote(parts.path or "/", safe="/%:@!$&'()*+,;=~-._")
    query = urllib.parse.quote(parts.query, safe="/%:@!$&'()*+,;=~-._?")
    url = urllib.parse.urlunsplit((parts.scheme, parts.netloc, path, query, ""))
    if not url.isascii() or any(char <= " " for char in url):
        raise LipwrightError(
            f"the voice {_without_secrets(text)!a} is not the address of a server; {remedy}"
        )
    shown = urllib.parse.urlunsplit((parts.scheme, parts.netloc, path, "", ""))
    return Address(url, urllib.parse.unquote(parts.fragment), shown)


def _without_secrets(text: str) -> str:
    """What is no address, as it is printed: without a password, or a query that may hold a key."""
    start, mark, rest = text.partition("?")[0].partition("://")
    return f"{start}{mark}{'...@' if '@' in rest else ''}{rest.rpartition('@')[2]}"[:80]


def post(address: Address, request: Mapping[str, object]) -> Any:
    """What the server answers to `request`, as JSON.

    Raises:
        LipwrightError: it cannot be reached, refuses, takes too long, sends too much, sends the
            request elsewhere, or does not answer in JSON.
    """
    body = json.dumps(request, ensure_ascii=False, allow_nan=False).encode()
    headers = {
        "Content-Type": "application/json; charset=utf-8", "Accept": "application/json",
        "User-Agent": f"lipwright/{VERSION}", **_authorization(address),
    }  # fmt: skip
    # The scheme was checked by read_address.
    asked = urllib.request.Request(address.url, body, headers, method="POST")  # noqa: S310
    try:
        with _opener(address).open(asked, timeout=WAIT) as answer:
            content = _read(address, answer)
    except urllib.error.HTTPError as error:
        with error:
            raise LipwrightError(_status(address, error)) from None
    except TimeoutError:
        raise _too_slow(address, WAIT) from None
    except (urllib.error.URLError, OSError, http.client.HTTPException, ValueError) as error:
        reason = getattr(error, "reason", error)
        if isinstance(reason, TimeoutError):
            raise _too_slow(address, WAIT) from None
        said = _clean(getattr(reason, "strerror", None) or str(reason) or type(reason).__name__)
        raise LipwrightError(
            f"{address.shown}: the voice server cannot be reached: {said}; start it, or correct "
            "the address"
        ) from None
    return _parse(address, content)


def _authorization(address: Address) -> dict[str, str]:
    token = os.environ.get(TOKEN, "").strip()
    if not token:
        return {}
    if not token.isascii() or not token.isprintable():
        raise LipwrightError(f"{TOKEN} has characters that no header takes; set it anew")
    if not address.is_secret:
        raise LipwrightError(
            f"{address.shown}: the token of {TOKEN} would cross the network in the clear; use "
            "https, or unset it"
        )
    return {"Authorization": f"Bearer {token}"}


class _SameHost(urllib.request.HTTPRedirectHandler):
    """Follows a redirect with the same request, on the same server only."""

    def __init__(self, address: Address) -> None:
        self._address = address

    def redirect_request(
        self, req: urllib.request.Request, fp: IO[bytes], code: int, msg: str,
        headers: Message, newurl: str,
    ) -> urllib.request.Request:  # fmt: skip
        """The request at the new address."""
        del code, msg, headers
        here, there = (urllib.parse.urlsplit(url) for url in (self._address.url, newurl))
        if (here.scheme, here.netloc) != (there.scheme, there.netloc):
            fp.close()
            raise LipwrightError(
                f"{self._address.shown}: the voice server sends the text on to "
                f"{_clean(there.netloc)}, which is not allowed; give that address yourself"
            )
        headers_sent = dict(req.header_items())
        # Of the scheme that it had before.
        return urllib.request.Request(newurl, req.data, headers_sent, method="POST")  # noqa: S310


def _opener(address: Address) -> urllib.request.OpenerDirector:
    """What opens http and https and nothing else; this machine without a proxy."""
    opener = urllib.request.OpenerDirector()
    for handler in (
        urllib.request.ProxyHandler({} if address.is_local else None),
        urllib.request.HTTPHandler(), urllib.request.HTTPSHandler(),
        urllib.request.HTTPDefaultErrorHandler(), urllib.request.HTTPErrorProcessor(),
        _SameHost(address),
    ):  # fmt: skip
        opener.add_handler(handler)
    return opener


def _read(address: Address, answer: http.client.HTTPResponse) -> bytes:
    until = time.monotonic() + MOST_WAIT
    content = bytearray()
    while block := answer.read1(_BLOCK):
        content += block
        if len(content) > MOST_BYTES:
            raise LipwrightError(
                f"{address.shown}: the voice server sends more than {MOST_BYTES >> 20} MB; say "
                "the text in parts"
            )
        if time.monotonic() > until:
            raise _too_slow(address, MOST_WAIT)
    expected = answer.headers.get("Content-Length", "")
    if expected.isdecimal() and len(content) < int(expected):
        raise LipwrightError(
            f"{address.shown}: the answer of the voice server is cut off; try again"
        )
    return bytes(content)


def _parse(address: Address, content: bytes) -> Any:
    try:
        return json.loads(content.decode("utf-8"), parse_constant=_no_number)
    except RecursionError:
        reason = "too deep"
    except ValueError as error:
        reason = _clean(str(error))
    raise LipwrightError(
        f"{address.shown}: the voice server does not answer in JSON ({reason}); docs/voices.md "
        "has what it should answer"
    )


def _no_number(text: str) -> float:
    raise ValueError(f"{text} is no number of JSON")


def _status(address: Address, error: urllib.error.HTTPError) -> str:
    try:
        said = _clean(error.read(4 * _SHOWN).decode("utf-8", "replace"))
    except (OSError, http.client.HTTPException):
        said = ""
    told = f": {said}" if said else ""
    remedy = {
        401: f"; set the token in {TOKEN}", 403: f"; set the token in {TOKEN}",
        404: "; correct the address", 405: "; it must take POST at this address",
    }.get(error.code, "; see what the server logs")  # fmt: skip
    return f"{address.shown}: the voice server answers {error.code}{told}{remedy}"


def _too_slow(address: Address, seconds: float) -> LipwrightError:
    return LipwrightError(
        f"{address.shown}: the voice server did not answer within {seconds:g} s; try a shorter text"
    )


def _clean(text: str) -> str:
    """One short line of what a server says, without the token."""
    token = os.environ.get(TOKEN, "").strip()
    if token:
        text = text.replace(token, "...")
    line = " ".join("".join(char if char.isprintable() else " " for char in text).split())
    return line if len(line) <= _SHOWN else line[:_SHOWN] + "..."
