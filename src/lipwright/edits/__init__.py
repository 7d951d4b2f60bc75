"""What an animator changed in exported curves, kept and applied again to later results."""

from __future__ import annotations

from lipwright.edits.file import load_edits, save_edits
from lipwright.edits.keeping import Kept, export_with_edits
from lipwright.edits.values import Edits

__all__ = ["Edits", "Kept", "export_with_edits", "load_edits", "save_edits"]
