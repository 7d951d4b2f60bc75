"""The acoustic model of pocketsphinx: how well each senone explains each frame.

A senone is a tied state of context-dependent phones. The model is "phonetically tied": the
senones of one base phone share a codebook of 128 Gaussians and differ in their mixture weights.
The files are read as they lie in the wheel of pocketsphinx; their layouts are those that
sphinxtrain writes ("s3" tables, the binary model definition, the quantised mixture weights).
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from functools import lru_cache
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import Final, Literal

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError
from lipwright.speech.features import N_CEPSTRA

Floats = npt.NDArray[np.float32]
Ints = npt.NDArray[np.int32]

N_DENSITIES: Final = 128  # Gaussians of a codebook
PAUSE: Final = "SIL"
NOISE: Final = "+NSN+"  # breath, smacks, knocks
FILLERS: Final = frozenset((PAUSE, NOISE, "+SPN+"))
# Nats under the best density of a frame: no senone is impossible, and no number is denormal.
_LEAST: Final = np.float32(-60.0)
# Matrix products this small stay on one thread in OpenBLAS, and in the cache. Its threads spin
# while they wait for each other: on a busy machine that took six times as long.
_AT_ONCE: Final = 64  # frames
_ROWS_AT_ONCE: Final = 32  # senones


Position = Literal["inner", "first", "last", "only"]
_POSITIONS: Final[dict[Position, int]] = {"inner": 0, "first": 1, "last": 2, "only": 3}

_VARIANCE_FLOOR: Final = 1e-4  # pocketsphinx, varfloor
_LOG_STEP: Final = 1024 * np.log(1.0001)  # nats a unit of the quantised mixture weights
_WEIGHTS: Final = np.exp(-_LOG_STEP * np.arange(256)).astype(np.float32)


def model_folder() -> Path | None:
    """Where the wheel of pocketsphinx keeps the English model, or None without it."""
    spec = find_spec("pocketsphinx")
    if spec is None or not spec.submodule_search_locations:
        return None
    folder = Path(spec.submodule_search_locations[0], "model", "en-us", "en-us")
    return folder if (folder / "mdef").is_file() else None


@dataclass(frozen=True, eq=False)
class AcousticModel:
    """The parameters of a phonetically tied model."""

    base_phones: tuple[str, ...]
    """B names; base phone b owns codebook b"""
    triphones: Ints
    """(4, B, B, B) row of `sequences` by position, phone, left and right phone; -1 where none"""
    sequences: Ints
    """(Q, 3) senones of the three states"""
    senone_base: Ints
    """(S,) the base phone of each senone"""
    weights: npt.NDArray[np.uint8]
    """(3 streams, S, 128) quantised negative logarithms of the mixture weights"""
    gaussians: tuple[Floats, ...]
    """for each stream (B, 128, 2 D + 1): factors of x, of x squared, and the constant"""
    transitions: Floats
    """(B, 3, 2) log-probabilities of staying in a state and of leaving it"""

    def base(self, phone: str) -> int:
        """The index of a base phone."""
        return self.base_phones.index(phone)

    def sequence(self, phone: int, left: int, right: int, position: Position) -> int:
        """The row of `sequences` for a phone in its context; the nearest that was trained."""
        row = self.triphones[:, phone, left, right]
        exact = int(row[_POSITIONS[position]])
        if exact >= 0:
            return exact
        known = row[row >= 0]
        return int(known[0]) if len(known) else phone

    def score(self, features: Floats, senones: npt.NDArray[np.integer]) -> Floats:
        """(T, len(senones)) log-likelihoods of `features` (T, 39)."""
        # Senones of one codebook side by side, time along the rows: both make it much faster.
        order = np.argsort(self.senone_base[senones], kind="stable")
        ordered = senones[order]
        groups = _groups(self.senone_base[ordered])
        mixtures = _WEIGHTS[self.weights[:, ordered]]  # (3, S, 128)
        likelihoods = np.empty((len(features), len(senones)), np.float32)
        for start in range(0, len(features), _AT_ONCE):
            some = slice(start, start + _AT_ONCE)
            likelihoods[some, order] = self._score(features[some].T, mixtures, groups).T
        return likelihoods

    def _score(self, features: Floats, mixtures: Floats, groups: list[tuple[int, slice]]) -> Floats:
        """(S, T) log-likelihoods of `features` (39, T)."""
        likelihoods = np.zeros((mixtures.shape[1], features.shape[1]), np.float32)
        total = np.empty_like(likelihoods)
        for stream, gaussians in enumerate(self.gaussians):
            x = features[stream * N_CEPSTRA : (stream + 1) * N_CEPSTRA]
            density = gaussians @ np.concatenate([x, x * x, np.ones_like(x[:1])])  # (B, 128, T)
            peak = density.max(axis=(0, 1))
            density -= peak
            np.maximum(density, _LEAST, out=density)
            np.exp(density, out=density)
            for base, rows in groups:
                np.matmul(mixtures[stream, rows], density[base], out=total[rows])
            likelihoods += np.log(total, out=total)
            likelihoods += peak
        return likelihoods


def _groups(bases: npt.NDArray[np.integer]) -> list[tuple[int, slice]]:
    """Rows of equal base phone, sorted by it, in pieces of at most _ROWS_AT_ONCE."""
    cuts = np.flatnonzero(np.diff(bases, prepend=-1, append=-1)).tolist()
    return [
        (int(bases[low]), slice(first, min(first + _ROWS_AT_ONCE, high)))
        for low, high in pairwise(cuts)
        for first in range(low, high, _ROWS_AT_ONCE)
    ]


def _read_s3(path: Path) -> tuple[tuple[int, ...], Floats]:
    data = path.read_bytes()
    start = data.index(b"endhdr\n") + 7
    if struct.unpack_from("<I", data, start)[0] != 0x11223344:
        raise ValueError("unexpected byte order")
    # Integers are small, so the first 4 bytes of the values never look like a size.
    if path.name == "transition_matrices":
        sizes = struct.unpack_from("<4i", data, start + 4)
        return sizes[:3], np.frombuffer(data, "<f4", sizes[3], start + 20)
    n_codebooks, n_streams, n_densities = struct.unpack_from("<3i", data, start + 4)
    lengths = struct.unpack_from(f"<{n_streams}i", data, start + 16)
    (count,) = struct.unpack_from("<i", data, start + 16 + 4 * n_streams)
    values = np.frombuffer(data, "<f4", count, start + 20 + 4 * n_streams)
    return (n_codebooks, n_streams, n_densities, *lengths), values


def _read_gaussians(folder: Path) -> tuple[Floats, ...]:
    shape, means = _read_s3(folder / "means")
    _, variances = _read_s3(folder / "variances")
    if shape != (shape[0], 3, N_DENSITIES, N_CEPSTRA, N_CEPSTRA, N_CEPSTRA):
        raise ValueError(f"unexpected shape {shape}")
    mean = means.reshape(shape[0], 3, N_DENSITIES, N_CEPSTRA).astype(np.float64)
    variance = np.maximum(variances.reshape(mean.shape), _VARIANCE_FLOOR).astype(np.float64)
    constant = -0.5 * (np.log(2 * np.pi * variance) + mean**2 / variance).sum(-1, keepdims=True)
    table = np.concatenate([mean / variance, -0.5 / variance, constant], axis=-1)
    return tuple(np.ascontiguousarray(table[:, stream], np.float32) for stream in range(3))


def _read_transitions(folder: Path) -> Floats:
    sizes, values = _read_s3(folder / "transition_matrices")
    table = values.reshape(sizes)  # (B, from 3, to 4)
    table = table / table.sum(-1, keepdims=True)
    stay = table[:, range(3), range(3)]
    leave = table[:, range(3), range(1, 4)]
    return np.log(np.stack([stay, leave], axis=-1)).astype(np.float32)


def _read_weights(folder: Path, n_senones: int) -> npt.NDArray[np.uint8]:
    path = folder / "sendump"
    with path.open("rb") as file:
        while length := struct.unpack("<i", file.read(4))[0]:
            file.seek(length, 1)
        n_densities, count = struct.unpack("<2i", file.read(8))
        start = file.tell()
    if (n_densities, count) != (N_DENSITIES, n_senones):
        raise ValueError(f"unexpected shape {(n_densities, count)}")
    table = np.fromfile(path, np.uint8, 3 * n_densities * n_senones, offset=start)
    return np.ascontiguousarray(table.reshape(3, n_densities, n_senones).transpose(0, 2, 1))


def _read_definition(folder: Path) -> tuple[tuple[str, ...], Ints, Ints, Ints]:
    data = (folder / "mdef").read_bytes()
    if data[:4] != b"BMDF":
        raise ValueError("not a binary model definition")
    start = 12 + struct.unpack_from("<i", data, 8)[0]
    sizes = struct.unpack_from("<10i", data, start)
    n_base, n_phones, _, _, n_senones, _, n_sequences, _, n_tree, _ = sizes
    names_end = start + 40
    names = []
    for _ in range(n_base):
        stop = data.index(b"\0", names_end)
        names.append(data[names_end:stop].decode("ascii"))
        names_end = stop + 1
    phones_start = start + 40 + -(-(names_end - start - 40) // 4) * 4 + 8 * n_tree
    rows = np.frombuffer(data, "<i4", 3 * n_phones, phones_start).reshape(-1, 3)
    context = rows[n_base:, 2:].copy().view(np.int8)  # position, phone, left, right
    sequences = np.frombuffer(data, "<i2", 3 * n_sequences, phones_start + 12 * n_phones + 4)
    sequences = sequences.reshape(-1, 3).astype(np.int32)
    triphones = np.full((4, n_base, n_base, n_base), -1, np.int32)
    triphones[tuple(context.T.astype(np.intp))] = rows[n_base:, 0]
    senone_base = np.zeros(n_senones, np.int32)
    senone_base[sequences[rows[n_base:, 0]]] = context[:, 1:2]
    senone_base[sequences[rows[:n_base, 0]]] = np.arange(n_base)[:, None]
    if not np.array_equal(rows[:n_base, 0], np.arange(n_base)):
        raise ValueError("base phones do not come first")
    return tuple(names), triphones, sequences, senone_base


@lru_cache(maxsize=1)
def load_model() -> AcousticModel:
    """The English model.

    Raises:
        LipwrightError: pocketsphinx is missing, or its model is not the one that we know.
    """
    folder = model_folder()
    if folder is None:
        raise LipwrightError(
            "pocketsphinx is not installed; run: pip install 'pocketsphinx>=5.1.1'"
        )
    try:
        names, triphones, sequences, senone_base = _read_definition(folder)
        return AcousticModel(
            names, triphones, sequences, senone_base, _read_weights(folder, len(senone_base)),
            _read_gaussians(folder), _read_transitions(folder),
        )  # fmt: skip
    except (OSError, ValueError, IndexError, struct.error) as error:
        raise LipwrightError(
            f"{folder}: not the model of pocketsphinx 5.1: {error}; "
            "run: pip install --force-reinstall 'pocketsphinx>=5.1.1'"
        ) from error
