"""What goes wrong on the user's side, as one clear line each.

A message names the file, the place in it and the remedy. The command line prints it and ends
with status 2; a program catches `LipwrightError`.
"""

from __future__ import annotations


class LipwrightError(Exception):
    """Input, option or installation that cannot be used; the message is one line for the user."""


class MissingExtraError(LipwrightError):
    """An optional part is not installed."""

    def __init__(self, what: str, extra: str) -> None:
        """`what` needs the extra `extra`."""
        super().__init__(f"{what} is not installed; run: pip install 'lipwright[{extra}]'")
        self.extra = extra
