"""Fits put into rigs that follow something already."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from lipwright.controls import both_sides
from lipwright.retarget.fitting import SPEECH, Fitted
from lipwright.rig import LinearMapping, Rig


def refitted(rig: Rig, fitted: Fitted) -> Rig:
    """The rig with what was fitted, and with its own rows for all that was not."""
    own = rig.mapping if isinstance(rig.mapping, LinearMapping) else LinearMapping({})
    new = fitted.mapping
    rows = {name: row for name, row in own.rows.items() if name not in fitted.controls}
    kept = tuple(c for c in own.correctives if c.control not in fitted.controls)
    merged = {
        name: {**rows, **new.rows}[name] for name in rig.names if name in {**rows, **new.rows}
    }
    return replace(rig, mapping=LinearMapping(merged, (*kept, *new.correctives)))


def follows_speech(rig: Rig, sources: Collection[str] = SPEECH) -> tuple[str, ...]:
    """The controls that a fit to speech may change: those that follow it already.

    Where the rig follows nothing yet, all of them. What follows eyes and brows keeps its rows, and
    what rests in a rig whose other controls follow something, as moods do, goes on resting.
    """
    if not isinstance(rig.mapping, LinearMapping) or not rig.mapping.controls:
        return rig.names
    heard = {
        name for name, row in rig.mapping.rows.items()
        if any(set(both_sides(source)) & set(sources) for source in row.gains)
    }  # fmt: skip
    return tuple(name for name in rig.names if name in heard)
