"""`ArrayModel`: a model that is arrays, which the engine of its kind reads (docs/models.md)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError
from lipwright.network.folder import REMEDY, PathLike, find_model, read_hashed, read_meta
from lipwright.network.meta import ARRAYS_FILE, META_FILE, Kind, ModelMeta
from lipwright.npz import BROKEN, read_arrays, reason_of

Arrays = Mapping[str, npt.NDArray[Any]]

MOST: Final = 1e9  # of a number; sums of larger ones, as float32, may be infinite


@dataclass(frozen=True, eq=False)
class ArrayModel:
    """What was learnt, by name; made by `load_arrays`."""

    path: Path
    """the model's folder"""
    meta: ModelMeta
    arrays: Arrays
    """read-only"""

    def array(self, name: str, kind: str, shape: tuple[int | None, ...]) -> npt.NDArray[Any]:
        """An array of the model.

        Args:
            name: of the array.
            kind: of its numbers, as `dtype.kind` has it: "f", "i", "u", "b", "U".
            shape: sizes; None for any.

        Raises:
            LipwrightError: it is missing, of another kind or shape, not finite, or huge.
        """
        found = self.arrays.get(name)
        place = self.path / ARRAYS_FILE
        if found is None:
            raise LipwrightError(f"{place}: has no array {name!r}; {REMEDY}")
        fits = len(found.shape) == len(shape) and all(
            want is None or size == want for size, want in zip(found.shape, shape, strict=True)
        )
        if found.dtype.kind != kind or not fits:
            raise LipwrightError(
                f"{place}: {name!r} is {found.dtype} of the shape {found.shape}, which does not "
                f"fit; {REMEDY}"
            )
        if kind == "f" and not np.isfinite(found).all():
            raise LipwrightError(f"{place}: {name!r} has values that are not finite; {REMEDY}")
        if kind == "f" and np.abs(found).max(initial=0) > MOST:
            raise LipwrightError(f"{place}: {name!r} has values over {MOST:g}; {REMEDY}")
        return found


def load_arrays(model: PathLike, kind: Kind) -> ArrayModel:
    """The arrays of a model's folder; nothing in it is unpickled.

    Raises:
        LipwrightError: there is no such model, it is of another kind, or it is damaged.
    """
    folder = find_model(model)
    meta = read_meta(folder)
    check_kind(folder, meta, (kind,))
    content = read_hashed(folder, meta, ARRAYS_FILE)
    path = folder / ARRAYS_FILE
    try:
        arrays = read_arrays(content)
    except BROKEN as error:
        raise LipwrightError(f"{path}: damaged ({reason_of(error)}); {REMEDY}") from error
    for array in arrays.values():
        array.setflags(write=False)
    return ArrayModel(folder, meta, MappingProxyType(arrays))


def check_kind(folder: Path, meta: ModelMeta, kinds: tuple[Kind, ...]) -> None:
    """Refuse a model of another engine.

    Raises:
        LipwrightError: it is one; names its engine.
    """
    if meta.kind not in kinds:
        raise LipwrightError(
            f"{folder}: is a model of the engine {meta.engine}; use it with: "
            f"--engine {meta.engine} --model {folder}"
        )


def open_arrays(model: PathLike, kind: Kind) -> ArrayModel:
    """As `load_arrays`, loaded once while the files stay as they are.

    Raises:
        LipwrightError: as `load_arrays`.
    """
    folder = find_model(model)
    return _load(folder, kind, stamps(folder))


def stamps(folder: Path) -> tuple[tuple[int, int], ...]:
    """When each file of a model was written, and its size; zeros for one that is not there."""
    return tuple(_stamp(path) for path in (folder / META_FILE, *sorted(folder.glob("model.*"))))


def _stamp(path: Path) -> tuple[int, int]:
    try:
        found = path.stat()
    except OSError:  # loading it says what is wrong
        return 0, 0
    return found.st_mtime_ns, found.st_size


@lru_cache(maxsize=4)
def _load(folder: Path, kind: Kind, stamps: tuple[tuple[int, int], ...]) -> ArrayModel:
    del stamps
    return load_arrays(folder, kind)
