"""The versions that figures depend on."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version
from typing import Final

from lipwright.version import VERSION

PACKAGES: Final = ("numpy", "scipy", "scikit-learn", "torch", "onnxruntime", "openfacefx")


def versions() -> dict[str, str]:
    """Package to version, of those that are installed."""
    found = {"lipwright": VERSION}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found
