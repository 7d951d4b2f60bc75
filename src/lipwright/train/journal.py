"""What a kill or a full disk leaves of the journal of a search, made good."""

from __future__ import annotations

from pathlib import Path

from lipwright.files import write_whole


def mend(path: Path) -> None:
    """Cut a last line that was not written to its end, and drop the lock of a killed program.

    Optuna would write its next line behind such a half, and with a lock whose link leads nowhere,
    as that of a relative path does, it waits without end.

    Args:
        path: the journal, if there is one. Nobody else may be at it: hold the folder's lock.

    Raises:
        LipwrightError: it cannot be written.
        OSError: it cannot be read.
    """
    path.with_name(f"{path.name}.lock").unlink(missing_ok=True)
    content = path.read_bytes() if path.is_file() else b""
    whole = content[: content.rfind(b"\n") + 1]
    if whole != content:
        with write_whole(path) as part:
            part.write_bytes(whole)
