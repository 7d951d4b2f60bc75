"""What several test modules share."""

from __future__ import annotations

import os

import pytest
from hypothesis import settings

from lipwright.errors import LipwrightError
from lipwright.face.build import install_head
from lipwright.face.head import Head, load_head

# In continuous integration a search starts from the same place each time, so that it judges the
# change and not the luck of the draw; on a developer's machine it keeps looking.
settings.register_profile("ci", derandomize=True)
if os.environ.get("CI"):
    settings.load_profile("ci")


@pytest.fixture(scope="session")
def head() -> Head:
    """The installed head; installed now, from the package registry, where there is none."""
    try:
        return load_head()
    except LipwrightError:
        install_head()
        return load_head()
