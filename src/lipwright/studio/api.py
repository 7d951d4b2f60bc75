"""The server's answers. Every value of a request is checked by the types of the set itself."""

from __future__ import annotations

import os
from collections.abc import Awaitable, Callable
from importlib.resources import files
from types import MappingProxyType
from typing import Annotated, Any, Final

from fastapi import APIRouter, Depends, FastAPI, Request
from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, ConfigDict, Field
from starlette.exceptions import HTTPException
from starlette.responses import JSONResponse, Response
from starlette.types import ASGIApp

from lipwright.bigrams.values import Pair
from lipwright.errors import LipwrightError
from lipwright.studio.describe import (
    dense_to_json,
    known_pair,
    pair_to_json,
    set_to_json,
    status_to_json,
)
from lipwright.studio.desk import Desk
from lipwright.studio.errors import ConflictError
from lipwright.studio.guard import Guard
from lipwright.studio.line import line_to_json, motion_to_json
from lipwright.studio.wire import MAX_NOTE, drawn_bigram

MAX_NAME: Final = 200  # characters of a key or pose
MAX_POSES: Final = 200

PAGE_FILES: Final = MappingProxyType({
    name: kind
    for kind, names in {
        "text/html; charset=utf-8": ("index.html",),
        "text/css; charset=utf-8": ("style.css",),
        "text/javascript; charset=utf-8": (
            "main.js", "bars.js", "drawing.js", "face.js", "header.js", "keys.js", "line.js",
            "matrix.js", "pair.js", "play.js", "points.js", "server.js",
        ),
        "image/svg+xml": ("icon.svg",),
    }.items()
    for name in names
})  # fmt: skip
"""the page's files and their kinds: nothing else is served"""

Key = Annotated[str, Field(max_length=2 * MAX_NAME)]
Points = list[Annotated[list[float], Field(min_length=2, max_length=2)]]


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class Drawn(_Message):
    """A pair as somebody draws it."""

    pair: Key
    curves: Annotated[dict[str, Points], Field(max_length=MAX_POSES)]
    note: Annotated[str, Field(max_length=MAX_NOTE)] = ""


class Edit(Drawn):
    """A pair to keep."""

    revision: int


class OnePair(_Message):
    """A pair to put back."""

    pair: Key
    revision: int


class Revision(_Message):
    """What the page knows."""

    revision: int


class Decision(_Message):
    """About unsaved edits."""

    keep: bool


class Said(_Message):
    """A line of text."""

    text: Annotated[str, Field(max_length=5000)]


class Weights(_Message):
    """How far each pose is on."""

    poses: Annotated[dict[str, float], Field(max_length=MAX_POSES)]
    view: str = "face"


def _desk(request: Request) -> Desk:
    desk: Desk = request.app.state.desk
    return desk


# Answers are made here: FastAPI would look at each of ten thousand numbers, for 40 ms.
At = Annotated[Desk, Depends(_desk)]
router = APIRouter()


@router.get("/")
def index() -> Response:
    """The page."""
    return page_file("index.html")


@router.get("/page/{name}")
def page_file(name: str) -> Response:
    """Its scripts and style; the name is looked up, it never becomes a path."""
    if name not in PAGE_FILES:
        raise HTTPException(404, "there is no such page")
    content = files("lipwright.studio").joinpath("page", name).read_bytes()
    return Response(content, media_type=PAGE_FILES[name])


@router.get("/api/set")
def whole_set(desk: At) -> JSONResponse:
    """Everything that the page begins with."""
    with desk.lock:
        return JSONResponse(
            {
                "set": set_to_json(desk.workspace),
                "status": status_to_json(desk.workspace),
                "line": line_to_json(desk.line) if desk.line else None,
                "motion": _motion(desk),
                "picture": desk.pictures.trouble,
            }
        )


@router.get("/api/pair")
def one_pair(desk: At, pair: Key) -> JSONResponse:
    """One pair with its curves."""
    with desk.lock:
        found = known_pair(desk.workspace.bigrams, pair)
        return JSONResponse(pair_to_json(desk.workspace, found))


@router.post("/api/preview")
def preview(desk: At, drawn: Drawn) -> JSONResponse:
    """What an edit would make, while the mouse still moves; nothing is kept."""
    bigrams = desk.workspace.bigrams
    pair = known_pair(bigrams, drawn.pair)
    bigram = drawn_bigram(bigrams, pair, drawn.curves, drawn.note)
    line = desk.line
    return JSONResponse(
        {
            "dense": dense_to_json(bigram),
            "motion": motion_to_json(line, bigrams.with_bigram(bigram)) if line else None,
        }
    )


@router.put("/api/pair")
def edit(desk: At, change: Edit) -> JSONResponse:
    """Keep an edit."""
    pair = known_pair(desk.workspace.bigrams, change.pair)
    bigram = drawn_bigram(desk.workspace.bigrams, pair, change.curves, change.note)
    with desk.lock:
        desk.workspace.edit(bigram, change.revision)
        return _after(desk, pair)


@router.post("/api/revert")
def revert(desk: At, which: OnePair) -> JSONResponse:
    """Drop the file's own curves of a pair."""
    pair = known_pair(desk.workspace.bigrams, which.pair)
    with desk.lock:
        desk.workspace.revert(pair, which.revision)
        return _after(desk, pair)


@router.post("/api/undo")
def undo(desk: At, known: Revision) -> JSONResponse:
    """Take the last edit back."""
    with desk.lock:
        return _after(desk, desk.workspace.undo(known.revision))


@router.post("/api/redo")
def redo(desk: At, known: Revision) -> JSONResponse:
    """Make it again."""
    with desk.lock:
        return _after(desk, desk.workspace.redo(known.revision))


@router.post("/api/save")
def save(desk: At, known: Revision) -> JSONResponse:
    """Write the file."""
    with desk.lock:
        desk.workspace.save(known.revision)
        return JSONResponse({"status": status_to_json(desk.workspace)})


@router.post("/api/recover")
def recover(desk: At, decision: Decision) -> JSONResponse:
    """Take up, or forget, the unsaved edits of the last time."""
    with desk.lock:
        desk.workspace.recover(keep=decision.keep)
        return whole_set(desk)


@router.post("/api/reload")
def reload(desk: At, decision: Decision) -> JSONResponse:
    """Read the file again, with or without the unsaved edits on top."""
    with desk.lock:
        desk.workspace.reload(keep=decision.keep)
        return whole_set(desk)


@router.post("/api/line")
def say_line(desk: At, said: Said) -> JSONResponse:
    """Another line of text."""
    desk.say(said.text)
    with desk.lock:
        assert desk.line is not None  # just said
        return JSONResponse({"line": line_to_json(desk.line), "motion": _motion(desk)})


@router.post("/api/picture")
def picture(desk: At, weights: Weights) -> Response:
    """The head with these poses, as PNG."""
    png = desk.pictures.png(desk.workspace.bigrams, weights.poses, weights.view)
    return Response(png, media_type="image/png")


def _motion(desk: Desk) -> dict[str, Any] | None:
    return motion_to_json(desk.line, desk.workspace.bigrams) if desk.line else None


def _after(desk: Desk, pair: Pair) -> JSONResponse:
    return JSONResponse(
        {
            "status": status_to_json(desk.workspace),
            "pair": pair_to_json(desk.workspace, pair),
            "motion": _motion(desk),
        }
    )


def create_app(desk: Desk, host: str) -> ASGIApp:
    """The guarded application of one desk, listening at `host`."""
    app = FastAPI(title="Lipwright", docs_url=None, redoc_url=None, openapi_url=None)
    app.state.desk = desk
    app.include_router(router)
    handlers: dict[type[Exception], Callable[[Request, Any], Awaitable[Response]]] = {
        LipwrightError: _user_error,
        RequestValidationError: _malformed,
        HTTPException: _http_error,
        Exception: _bug,
    }
    for kind, handler in handlers.items():
        app.add_exception_handler(kind, handler)
    return Guard(app, host)


def _error(status: int, message: str) -> JSONResponse:
    return JSONResponse({"error": " ".join(message.split())}, status)


async def _user_error(request: Request, error: LipwrightError) -> Response:
    del request
    return _error(409 if isinstance(error, ConflictError) else 400, str(error))


async def _malformed(request: Request, error: RequestValidationError) -> Response:
    del request
    first = error.errors()[0]
    place = ".".join(str(part)[:40] for part in first["loc"][1:]) or "the request"
    return _error(422, f"{place}: {first['msg']}")


async def _http_error(request: Request, error: HTTPException) -> Response:
    del request
    return _error(error.status_code, str(error.detail))


async def _bug(request: Request, error: Exception) -> Response:
    del request
    if os.environ.get("LIPWRIGHT_DEBUG"):
        raise error
    return _error(500, f"failed inside ({type(error).__name__}); this is a bug: report it")
