"""Everything that one editor holds: the set, the line and the head."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from threading import RLock
from types import MappingProxyType
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.studio.line import Line, line_of_text, line_of_track
from lipwright.studio.pictures import Pictures
from lipwright.studio.workspace import Workspace
from lipwright.track import PhoneTrack

FIRST_LINES: Final = MappingProxyType({
    "en": "Oh no, we are late.", "sv": "Oj, vi är sena.", "cmn": "wo3 men5 lai2 wan3 le5.",
})  # fmt: skip
"""language to a line to begin with"""


class Desk:
    """What the server's answers are made of.

    Attributes:
        workspace: the set.
        pictures: of the head.
        line: what is said; None for nothing yet.
    """

    def __init__(
        self,
        workspace: Workspace,
        text: str | None = None,
        track: tuple[str, PhoneTrack] | None = None,
    ) -> None:
        """Lay a line on the desk: a phone track and its name, a text, or one that we know.

        Raises:
            LipwrightError: the line cannot be used.
        """
        self.workspace = workspace
        self.pictures = Pictures(workspace.bigrams.rig)
        self.line: Line | None = None
        if track is not None:
            self.line = line_of_track(*track)
        elif text is not None:
            self.say(text)
        else:
            with suppress(LipwrightError):  # the language may want a package that is not here
                self.say(FIRST_LINES.get(workspace.bigrams.language, ""))

    @property
    def lock(self) -> RLock:
        """Hold it to read several things of one moment."""
        return self.workspace.lock

    @property
    def path(self) -> Path:
        """The file that is written."""
        return self.workspace.path

    def say(self, text: str) -> None:
        """Another line.

        Raises:
            LipwrightError: it cannot be said.
        """
        self.line = line_of_text(text, self.workspace.bigrams.language)

    def close(self) -> None:
        """Give back what the head holds."""
        self.pictures.close()
