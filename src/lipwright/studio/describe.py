"""A workspace as the page shows it."""

from __future__ import annotations

from typing import Any, Final

from lipwright.bigrams.missing import stand_in
from lipwright.bigrams.spline import dense
from lipwright.bigrams.values import Bigram, BigramSet, Pair
from lipwright.errors import LipwrightError
from lipwright.phones import PHONES
from lipwright.studio.wire import bigram_to_json, pair_key, split_key
from lipwright.studio.workspace import Workspace

DECIMALS: Final = 4
EXAMPLES: Final = 3  # words of a class


def set_to_json(workspace: Workspace) -> dict[str, Any]:
    """What no edit of a pair changes."""
    bigrams = workspace.bigrams
    return {
        "name": bigrams.name,
        "file": workspace.path.name,
        "parent": bigrams.parent,
        "language": bigrams.language,
        "licence": bigrams.licence,
        "source": bigrams.source,
        "speed_limit": bigrams.speed_limit,
        "poses": [
            {"name": pose.name, "priority": pose.priority, "limit": pose.limit}
            for pose in bigrams.poses.values()
        ],
        "classes": [
            {
                "name": name,
                "phones": list(phones),
                "examples": [PHONES[phone].example for phone in phones[:EXAMPLES]],
            }
            for name, phones in bigrams.classes.items()
        ],
        "constraints": [[*poses, most] for poses, most in bigrams.constraints.items()],
        "otherwise": bigrams.otherwise,
    }


def status_to_json(workspace: Workspace) -> dict[str, Any]:
    """What edits change: who drew which pair, what is unsaved, what can be undone."""
    pending = workspace.pending
    undoable, redoable = workspace.undoable, workspace.redoable
    return {
        "revision": workspace.revision,
        "exists": workspace.exists,
        "sources": {pair_key(p): one.source for p, one in workspace.bigrams.bigrams.items()},
        "inherited": [pair_key(p) for p in workspace.bigrams.bigrams if workspace.is_inherited(p)],
        "unsaved": [pair_key(pair) for pair in workspace.unsaved],
        "undo": pair_key(undoable) if undoable else "",
        "redo": pair_key(redoable) if redoable else "",
        "pending": [pair_key(pair) for pair in pending.edits] if pending else [],
        "stale": workspace.is_stale,
    }


def pair_to_json(workspace: Workspace, pair: Pair) -> dict[str, Any]:
    """One pair with its curves; a missing one has none."""
    bigram = workspace.bigrams.bigrams.get(pair)
    other = stand_in(workspace.bigrams, pair)[1] if bigram is None else None
    return {
        "pair": pair_key(pair),
        "missing": bigram is None,
        "stand_in": pair_key(other) if other else "",
        "own": workspace.own(pair) is not None,
        "has_inherited": workspace.has_inherited(pair),
        **(bigram_to_json(bigram or Bigram(*pair, {}))),
        "dense": dense_to_json(bigram),
    }


def dense_to_json(bigram: Bigram | None) -> dict[str, list[float]]:
    """The curve of each pose, at even times from 0 to 1."""
    curves = bigram.curves if bigram is not None else {}
    return {
        pose: [round(value, DECIMALS) for value in dense(points).tolist()]
        for pose, points in curves.items()
    }


def known_pair(bigrams: BigramSet, key: str) -> Pair:
    """The pair of a key.

    Raises:
        LipwrightError: the set has no such classes.
    """
    pair = split_key(key)
    for name in pair:
        if name not in bigrams.classes:
            raise LipwrightError(f"the set has no class {name[:40]!r}")
    return pair
