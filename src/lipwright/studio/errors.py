"""What the studio cannot do now, but could a moment ago or after a decision."""

from __future__ import annotations

from lipwright.errors import LipwrightError


class ConflictError(LipwrightError):
    """Somebody else was quicker, or something must be decided first; nothing was changed."""
