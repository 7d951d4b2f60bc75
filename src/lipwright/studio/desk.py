"""Everything that one editor holds: the set, the line and the head."""

from __future__ import annotations

from pathlib import Path
from threading import RLock

from lipwright.studio.line import Line, line_of_text, line_of_track
from lipwright.studio.pictures import Pictures
from lipwright.studio.workspace import Workspace
from lipwright.track import PhoneTrack


class Desk:
    """What the server's answers are made of.

    Attributes:
        workspace: the set.
        pictures: of the head.
        line: what is said; None for nothing yet.
    """

    def __init__(
        self, workspace: Workspace, text: str = "", track: tuple[str, PhoneTrack] | None = None
    ) -> None:
        """Lay a line on the desk: a text, or a phone track and its name.

        Raises:
            LipwrightError: the line cannot be used.
        """
        self.workspace = workspace
        self.pictures = Pictures(workspace.bigrams.rig)
        self.line: Line | None = None
        if track is not None:
            self.line = line_of_track(*track)
        elif text:
            self.say(text)

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
