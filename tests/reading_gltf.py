"""GLB, VRM and VRMA as three.js and three-vrm read them, in Chromium."""

from __future__ import annotations

import shutil
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest

WEB = Path(__file__).parent / "web"
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
ARGUMENTS = [
    "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
]  # fmt: skip


class _Handler(SimpleHTTPRequestHandler):
    """`tests/web`, and below /files/ another folder."""

    extensions_map = SimpleHTTPRequestHandler.extensions_map | {".mjs": "text/javascript"}

    def __init__(self, files: Path, *arguments: Any, **more: Any) -> None:
        self.files = files
        super().__init__(*arguments, directory=str(WEB), **more)

    def translate_path(self, path: str) -> str:
        if path.startswith("/files/"):
            return str(self.files / Path(path).name)
        return super().translate_path(path)

    def log_message(self, *arguments: Any) -> None:
        pass


class Reader:
    """A page that has loaded one file."""

    def __init__(self, page: Any, files: Path) -> None:
        self.page = page
        self.files = files
        self.loads = 0
        self.said: list[str] = []
        page.on("pageerror", lambda error: self.said.append(str(error)))
        page.on("console", self._hear)

    def _hear(self, message: Any) -> None:
        if message.type in {"error", "warning"}:
            self.said.append(message.text)

    def load(self, content: bytes) -> dict[str, Any]:
        """What the file has; nothing may be warned of."""
        self.loads += 1  # a name of its own, since browsers keep what they have read
        (self.files / f"{self.loads}.glb").write_bytes(content)
        self.said.clear()
        found: dict[str, Any] = self.call("load", f"/files/{self.loads}.glb")
        assert not self.said, self.said
        return found

    def call(self, name: str, *arguments: Any) -> Any:
        """The answer of one of the page's functions, see `web/gltf.mjs`."""
        return self.page.evaluate(f"(a) => window.reader.{name}(...a)", list(arguments))


@contextmanager
def reading(files: Path) -> Iterator[Reader]:
    """A reader; the test is skipped where there is no browser or no three.js."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    if found is None:
        pytest.skip("there is no Chromium here")
    if not (WEB / "node_modules" / "three").is_dir():
        pytest.skip("three.js is not installed; run: npm ci --prefix tests/web")
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Handler, files))
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        with playwright.sync_playwright() as driver:
            browser = driver.chromium.launch(executable_path=found, args=ARGUMENTS)
            page = browser.new_page()
            reader = Reader(page, files)
            page.goto(f"http://127.0.0.1:{server.server_port}/gltf.html")
            page.wait_for_selector("body[data-ready]", state="attached")
            yield reader
            browser.close()
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


@pytest.fixture(scope="module")
def reader(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Reader]:
    """One page for the tests of a module."""
    with reading(tmp_path_factory.mktemp("files")) as found:
        yield found
