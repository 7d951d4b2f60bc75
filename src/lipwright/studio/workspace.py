"""`Workspace`: a set in the hands of an animator; edits, their undoing, and the journal."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from threading import RLock
from typing import Final

from lipwright.bigrams.file import editing
from lipwright.bigrams.values import Bigram, BigramSet, Pair
from lipwright.errors import LipwrightError
from lipwright.studio.errors import ConflictError
from lipwright.studio.journal import Unsaved, digest, read_journal, write_journal
from lipwright.studio.origin import Origin, open_origin, open_own
from lipwright.studio.wire import bigram_to_json, pair_key

MOST_STEPS: Final = 1000  # that can be undone

Step = tuple[Pair, Bigram | None, Bigram | None]
"""a pair, its own bigram before and after"""


class Workspace:
    """One set while it is edited; safe to use from several threads.

    Every edit is in the journal before it is answered. An edit says which revision it was made
    on, so that two pages do not overwrite each other unseen.

    Attributes:
        lock: hold it to read several things of one moment.
        revision: rises with every change.
        pending: edits of an earlier time that nobody has decided about yet.
    """

    def __init__(self, name: str, out: Path | None = None) -> None:
        """Open a set to edit; see `open_origin`.

        Raises:
            LipwrightError: the set or its journal cannot be used.
        """
        self.lock = RLock()
        self.revision = 1
        self._origin: Origin = open_origin(name, out)
        self._bigrams = self._origin.merged
        self._edits: dict[Pair, Bigram | None] = {}
        self._undo: list[Step] = []
        self._redo: list[Step] = []
        self.pending: Unsaved | None = self._left_over(read_journal(self.path, self.bigrams))

    @property
    def path(self) -> Path:
        """The file that is written."""
        return self._origin.path

    @property
    def exists(self) -> bool:
        """Whether that file was there when it was last read."""
        return bool(self._origin.digest)

    @property
    def bigrams(self) -> BigramSet:
        """The set with all edits."""
        return self._bigrams

    @property
    def unsaved(self) -> tuple[Pair, ...]:
        """The pairs that differ from the file."""
        return tuple(self._edits)

    @property
    def undoable(self) -> Pair | None:
        """The pair that `undo` changes."""
        return self._undo[-1][0] if self._undo else None

    @property
    def redoable(self) -> Pair | None:
        """The pair that `redo` changes."""
        return self._redo[-1][0] if self._redo else None

    @property
    def is_stale(self) -> bool:
        """Whether the pending edits were made on another state of the file."""
        return self.pending is not None and self.pending.base != self._origin.digest

    def own(self, pair: Pair) -> Bigram | None:
        """The pair as the file will have it; None where it has none of its own."""
        return self._edits[pair] if pair in self._edits else self._origin.content.bigrams.get(pair)

    def is_inherited(self, pair: Pair) -> bool:
        """Whether the pair is as the parent has it."""
        return self.own(pair) is None and pair in self._origin.inherited

    def has_inherited(self, pair: Pair) -> bool:
        """Whether the parent has such a pair."""
        return pair in self._origin.inherited

    def edit(self, bigram: Bigram, revision: int) -> None:
        """Change one pair; curves that are what they were change nothing.

        Raises:
            ConflictError: the page knew another revision, or pending edits wait for a decision.
            LipwrightError: the journal cannot be written.
        """
        now = self.bigrams.bigrams.get(bigram.pair)
        if now is None or (now.curves, now.note) != (bigram.curves, bigram.note):
            self._change(bigram.pair, bigram, revision)
        else:
            self._check(revision)

    def revert(self, pair: Pair, revision: int) -> None:
        """Drop the file's own curves of a pair: then the parent's hold, or none.

        Raises:
            ConflictError: as for `edit`, or there are none of its own.
            LipwrightError: the journal cannot be written.
        """
        if self.own(pair) is None:
            raise ConflictError(f"{pair_key(pair)!r} has no curves of its own here")
        self._change(pair, None, revision)

    def _change(self, pair: Pair, after: Bigram | None, revision: int) -> None:
        with self.lock:
            self._check(revision)
            before = self.own(pair)
            self._put(pair, after)
            self._undo = [*self._undo[-MOST_STEPS + 1 :], (pair, before, after)]
            self._redo = []

    def undo(self, revision: int) -> Pair:
        """Take the last edit back; the pair that it was of.

        Raises:
            ConflictError: as for `edit`, or there is none.
        """
        return self._step(self._undo, self._redo, lambda step: step[1], revision)

    def redo(self, revision: int) -> Pair:
        """Make the edit again that was taken back last; the pair that it is of.

        Raises:
            ConflictError: as for `edit`, or there is none.
        """
        return self._step(self._redo, self._undo, lambda step: step[2], revision)

    def _step(
        self, taken: list[Step], given: list[Step],
        choose: Callable[[Step], Bigram | None], revision: int,
    ) -> Pair:  # fmt: skip
        with self.lock:
            self._check(revision)
            if not taken:
                raise ConflictError("there is nothing left to undo or redo")
            step = taken[-1]
            self._put(step[0], choose(step))
            given.append(taken.pop())
            return step[0]

    def save(self, revision: int) -> None:
        """Write the file.

        Raises:
            ConflictError: as for `edit`, or another program has changed the file meanwhile.
            LipwrightError: it cannot be written.
        """
        with self.lock, editing(self.path) if self.path.exists() else nullcontext():
            self._check(revision)
            if digest(self.path) != self._origin.digest:
                raise ConflictError(
                    f"{self.path.name}: another program has changed the file since it was opened; "
                    "reload it, with or without your edits"
                )
            own = {pair: self.own(pair) for pair in (*self._origin.content.bigrams, *self._edits)}
            self._origin = self._origin.save({p: one for p, one in own.items() if one is not None})
            self._edits = {}
            self._refresh()
            write_journal(self.path, self._origin.digest, {})

    def reload(self, *, keep: bool) -> None:
        """Read the file again, and put the unsaved edits on top or forget them.

        Raises:
            LipwrightError: the file cannot be used.
        """
        with self.lock:
            self._origin = open_own(self.path) if self.path.exists() else self._origin_anew()
            self._undo, self._redo = [], []
            if not keep:
                self._edits = {}
            self._refresh()
            write_journal(self.path, self._origin.digest, self._edits)

    def recover(self, *, keep: bool) -> None:
        """Decide about the pending edits: take them up again, or forget them.

        Raises:
            ConflictError: there are none.
        """
        with self.lock:
            if self.pending is None:
                raise ConflictError("there are no unsaved edits of an earlier time")
            if keep:
                self._edits = dict(self.pending.edits)
                self._refresh()
            write_journal(self.path, self._origin.digest, self._edits)
            self.pending = None
            self.revision += 1

    def _left_over(self, unsaved: Unsaved | None) -> Unsaved | None:
        """What the file lacks of it: a kill may come before a save ends the journal."""
        own = self._origin.content.bigrams
        edits = unsaved.edits.items() if unsaved else ()
        left = {pair: one for pair, one in edits if not _same(one, own.get(pair))}
        return replace(unsaved, edits=left) if unsaved and left else None

    def _origin_anew(self) -> Origin:
        """A file that was removed by somebody is to be made anew, with what it said."""
        return replace(self._origin, digest="")

    def _check(self, revision: int) -> None:
        if self.pending is not None:
            raise ConflictError("first decide about the unsaved edits of the last time")
        if revision != self.revision:
            raise ConflictError(
                "the set was changed in another window; this page now shows what it is"
            )

    def _put(self, pair: Pair, own: Bigram | None) -> None:
        before = dict(self._edits)
        if _same(own, self._origin.content.bigrams.get(pair)):
            self._edits.pop(pair, None)
        else:
            self._edits[pair] = own
        try:
            self._refresh()
            write_journal(self.path, self._origin.digest, self._edits)
        except LipwrightError:
            self._edits = before
            self._refresh()
            raise

    def _refresh(self) -> None:
        """The set of the file, its parents and the edits."""
        found = dict(self._origin.merged.bigrams)
        for pair, own in self._edits.items():
            bigram = own if own is not None else self._origin.inherited.get(pair)
            if bigram is not None:
                found[pair] = bigram
            else:
                found.pop(pair, None)
        try:
            self._bigrams = replace(self._origin.merged, bigrams=found)
        except ValueError as error:
            raise LipwrightError(f"{self.path.name}: {error}") from error
        self.revision += 1


def _same(one: Bigram | None, other: Bigram | None) -> bool:
    if one is None or other is None:
        return one is other
    return bigram_to_json(one) == bigram_to_json(other)


def unsaved_edits(name: str, out: Path | None = None) -> tuple[Path, tuple[str, ...]]:
    """The file that an editor of the set would write, and the pairs that its journal holds.

    Raises:
        LipwrightError: the set or its journal cannot be used.
    """
    workspace = Workspace(name, out)
    pending = workspace.pending
    return workspace.path, tuple(map(pair_key, pending.edits)) if pending is not None else ()
