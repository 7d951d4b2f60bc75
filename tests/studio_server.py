"""A small set of phone bigrams, and the editor's server on it."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import uvicorn

from lipwright.bigrams.file import SetFile, save_set
from lipwright.bigrams.values import Bigram, Pose
from lipwright.studio.api import create_app
from lipwright.studio.desk import Desk
from lipwright.studio.serve import listen
from lipwright.studio.workspace import Workspace

TEXT = "Fat cat."  # sil F AE T K AE T sil
F_AH = {"FV": ((0.0, 0.0), (0.2, 1.0), (0.5, 0.0)), "open": ((0.2, 0.0), (0.6, 0.5), (1.0, 0.0))}


def write_set(path: Path, **changes: Any) -> Path:
    """A small set of our own format, on the poses of FaceFX."""
    fields: dict[str, Any] = {
        "name": "small", "language": "en", "licence": "CC0-1.0", "source": "a test",
        "rig": "facefx",
        "classes": {"f": ("F", "V"), "ah": ("AE", "AH"), "d": ("T", "D", "K"), "sil": ("sil",)},
        "poses": {"open": Pose("open"), "FV": Pose("FV", 4.0, "widen"), "W": Pose("W", 1.0)},
        "bigrams": {
            ("f", "ah"): Bigram("f", "ah", F_AH, "fitted", 7, {"FV": 0.01}),
            ("ah", "d"): Bigram("ah", "d", {"open": ((0.0, 0.4), (1.0, 0.0))}),
        },
    }  # fmt: skip
    save_set(path, SetFile(**{**fields, **changes}))
    return path


def write_faceless_set(path: Path) -> Path:
    """The same on a rig that no human face shows, so that no pictures are drawn."""
    controls = [{"name": name} for name in ("open", "FV", "W")]
    rig = {"name": "box", "controls": controls, "mirror": [], "source": "", "license": ""}
    path.with_name("box.json").write_text(json.dumps(rig))
    return write_set(path, rig="box.json")


@contextmanager
def serving(workspace: Workspace, text: str = TEXT) -> Iterator[httpx.Client]:
    """The server of a workspace on a free port, and a client for it."""
    desk = Desk(workspace, text)
    listening = listen("127.0.0.1", 0)
    config = uvicorn.Config(
        create_app(desk, "127.0.0.1"), log_level="critical", access_log=False, ws="none",
        lifespan="off", timeout_graceful_shutdown=1,
    )  # fmt: skip
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
    thread.start()
    try:
        address = f"http://127.0.0.1:{listening.getsockname()[1]}"
        with httpx.Client(base_url=address, timeout=30, trust_env=False) as client:
            yield client
    finally:
        server.should_exit = True
        thread.join()
        listening.close()
        desk.close()
