"""What several test modules share."""

from __future__ import annotations

import pytest

from lipwright.errors import LipwrightError
from lipwright.face.build import install_head
from lipwright.face.head import Head, load_head


@pytest.fixture(scope="session")
def head() -> Head:
    """The installed head; installed now, from the package registry, where there is none."""
    try:
        return load_head()
    except LipwrightError:
        install_head()
        return load_head()
