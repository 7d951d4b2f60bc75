"""The network of hama 1.7 in numpy: about six times as fast as hama's own engine.

Weights of another release that cannot be read here are left to that engine.

A conformer (Gulati et al. 2020, "Conformer: Convolution-augmented Transformer for Speech
Recognition") of four blocks without positions: 80 log mel bands each 10 ms, a convolution that
halves the rate, then in each block half a feed-forward step, self-attention, a convolution over
31 frames, another half step. Weights are read from the package, which keeps them by name; the
layers that have none of their own are in the order in which the network was exported.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

import numpy as np

from lipwright.errors import LipwrightError
from lipwright.speech.features import Floats

_MAGIC: Final = b"HAMAPK"
_WIDTH: Final = 144  # D
_HEADS: Final = 4
_BLOCKS: Final = 4
_FFT, _HOP = 400, 160  # samples at 16 kHz
_KERNEL: Final = 31  # frames of the convolution in a block
_FLOOR: Final = 1e-10  # mel power
_EPSILON: Final = 1e-5
_PREFIX: Final = "acoustic_model.model."
_FIRST_MATRIX, _MATRICES = 829, (0, 1, 2, 6, 7, 8)  # numbers of a block's matrices after the first
_FIRST_KERNEL: Final = 801

# OpenBLAS keeps a product of fewer multiplications on one thread. Its threads spin while they wait
# for each other: on a busy machine that took thirty times as long.
_ONE_THREAD: Final = 2**18

Weights = Mapping[str, Floats]


def weights_path() -> Path | None:
    """Where hama keeps the weights, or None without it."""
    spec = find_spec("hama")
    if spec is None or not spec.submodule_search_locations:
        return None
    path = Path(spec.submodule_search_locations[0], "assets", "asr_waveform.hama")
    return path if path.is_file() else None


@lru_cache(maxsize=1)
def load_weights() -> Weights | None:
    """Name to array, or None where hama's network is not the one that we know.

    Raises:
        LipwrightError: hama is missing.
    """
    path = weights_path()
    if path is None:
        raise LipwrightError("hama is not installed; run: pip install 'hama==1.7.*'")
    try:
        weights = _read_archive(path.read_bytes())
        _run(np.zeros(_FFT, np.float32), weights)
    except (OSError, ValueError, KeyError, IndexError, struct.error):
        return None
    return weights


def _read_archive(data: bytes) -> Weights:
    """Records of name, type (0: float32, 1: float16), shape and place, then the numbers."""
    if not data.startswith(_MAGIC):
        raise ValueError("not an archive of weights")
    (count,) = struct.unpack_from("<I", data, 8)
    place, records = 12, []
    for _ in range(count):
        (length,) = struct.unpack_from("<H", data, place)
        name = data[place + 2 : place + 2 + length].decode()
        kind, rank = struct.unpack_from("<BB", data, place + 2 + length)
        shape = struct.unpack_from(f"<{rank}I", data, place + 4 + length)
        place += 4 + length + 4 * rank
        records.append((name, kind, shape, *struct.unpack_from("<QQ", data, place)))
        place += 16
    start = -(-place // 16) * 16
    return {
        name.removeprefix(_PREFIX).removeprefix("onnx::"): np.frombuffer(
            data, (np.float32, np.float16)[kind], int(np.prod(shape)), start + offset
        )
        .reshape(shape)
        .astype(np.float32)
        for name, kind, shape, offset, _ in records
    }


def log_probabilities(samples: Floats) -> Floats:
    """(T, 191) logarithms of the probabilities of hama's tokens, for N samples at 16 kHz."""
    weights = load_weights()
    return _run_hama(samples) if weights is None else _run(samples, weights)


def _run_hama(samples: Floats) -> Floats:
    """The same by hama's own engine."""
    rows: Floats = _hama().session.run(["log_probs"], {"waveform": samples[None]})[0][0]
    return rows


@lru_cache(maxsize=1)
def _hama() -> Any:
    from hama.asr import ASRModel

    try:
        return ASRModel()
    except (OSError, RuntimeError, ValueError) as error:
        raise LipwrightError(
            f"hama cannot load its network: {error}; run: pip install 'hama==1.7.*'"
        ) from error


def _run(samples: Floats, weights: Weights) -> Floats:
    hidden = _stem(_log_mel(samples, weights), weights)  # (T, D)
    for block in range(_BLOCKS):
        hidden = _block(hidden, block, weights)
    scores = _product(hidden, weights["proj.weight"][:, :, 0].T) + weights["proj.bias"]
    scores -= scores.max(axis=1, keepdims=True)
    scores -= np.log(np.exp(scores).sum(axis=1, keepdims=True))
    return np.asarray(scores, np.float32)


def _product(rows: Floats, columns: Floats) -> Floats:
    """`rows` (..., T, K) times `columns` (..., K, N), a few rows at a time."""
    *lead, count, depth = rows.shape
    some = max(_ONE_THREAD // (depth * columns.shape[-1]), 1)
    groups = -(-count // some)
    padded = np.zeros((*lead, groups * some, depth), np.float32)
    padded[..., :count, :] = rows
    parts = padded.reshape(*lead, groups, some, depth) @ columns[..., None, :, :]
    return np.asarray(parts.reshape(*lead, groups * some, -1)[..., :count, :])


def _log_mel(samples: Floats, weights: Weights) -> Floats:
    padded = np.pad(samples, _FFT // 2, "reflect")
    windows = np.lib.stride_tricks.sliding_window_view(padded, _FFT)[::_HOP]
    spectra = np.fft.rfft(windows * weights["stft_real_kernel"][0, 0])  # its cosine of 0 Hz is 1
    power = _product((spectra.real**2 + spectra.imag**2).astype(np.float32), weights["mel_fb"])
    # The network was exported in half precision.
    logs = np.log(np.maximum(power, np.float32(_FLOOR)))
    return np.asarray(logs.astype(np.float16).astype(np.float32))


def _stem(mel: Floats, weights: Weights) -> Floats:
    """Three frames of mel to one of the network, every other frame."""
    from scipy.special import erf

    count = (len(mel) - 1) // 2 + 1
    padded = np.pad(mel, ((1, 1), (0, 0)))
    rows = np.concatenate([padded[k : k + 2 * count - 1 : 2] for k in range(3)], axis=1)
    kernel = weights[f"Conv_{_FIRST_KERNEL}"].transpose(2, 1, 0).reshape(-1, _WIDTH)
    x = _product(rows, kernel) + weights[f"Conv_{_FIRST_KERNEL + 1}"]
    return np.asarray(0.5 * x * (1 + erf(x / np.sqrt(2))), np.float32)


def _block(hidden: Floats, block: int, weights: Weights) -> Floats:
    name, first = f"blocks.{block}.", _FIRST_MATRIX + 9 * block
    up1, down1, qkv, out, up2, down2 = (weights[f"MatMul_{first + k}"] for k in _MATRICES)
    hidden = hidden + 0.5 * _feed_forward(hidden, name + "ffn1.", up1, down1, weights)
    hidden = hidden + _attend(hidden, name, qkv, out, weights)
    hidden = hidden + _convolve(hidden, name + "conv.", block, weights)
    hidden = hidden + 0.5 * _feed_forward(hidden, name + "ffn2.", up2, down2, weights)
    return _normal(hidden, name + "norm", weights)


def _normal(x: Floats, name: str, weights: Weights) -> Floats:
    centred = x - x.mean(axis=1, keepdims=True)
    spread = np.sqrt(np.mean(np.square(centred), axis=1, keepdims=True) + np.float32(_EPSILON))
    return np.asarray(centred / spread * weights[name + ".weight"] + weights[name + ".bias"])


def _sigmoid(x: Floats) -> Floats:
    return np.asarray(1 / (1 + np.exp(-np.clip(x, -80, 80))))


def _feed_forward(x: Floats, name: str, up: Floats, down: Floats, weights: Weights) -> Floats:
    inside = _product(_normal(x, name + "norm", weights), up) + weights[name + "fc1.bias"]
    return np.asarray(_product(inside * _sigmoid(inside), down) + weights[name + "fc2.bias"])


def _attend(x: Floats, name: str, qkv: Floats, out: Floats, weights: Weights) -> Floats:
    inside = _product(_normal(x, name + "attn_norm", weights), qkv)
    inside += weights[name + "attn.in_proj_bias"]
    # (3, heads, T, D / heads)
    query, key, value = inside.reshape(len(x), 3, _HEADS, -1).transpose(1, 2, 0, 3)
    scores = _product(query, key.transpose(0, 2, 1)) / np.float32(np.sqrt(_WIDTH / _HEADS))
    scores -= scores.max(axis=2, keepdims=True)
    np.exp(scores, out=scores)
    scores /= scores.sum(axis=2, keepdims=True)
    heard = _product(scores, value).transpose(1, 0, 2).reshape(len(x), _WIDTH)
    return np.asarray(_product(heard, out) + weights[name + "attn.out_proj.bias"])


def _convolve(x: Floats, name: str, block: int, weights: Weights) -> Floats:
    inside = _product(
        _normal(x, name + "norm", weights), weights[name + "pointwise1.weight"][:, :, 0].T
    )
    inside += weights[name + "pointwise1.bias"]
    gated = inside[:, :_WIDTH] * _sigmoid(inside[:, _WIDTH:])
    number = _FIRST_KERNEL + 3 * (block + 1)
    kernel, half = weights[f"Conv_{number}"][:, 0], _KERNEL // 2
    padded = np.pad(gated, ((half, half), (0, 0)))
    mixed = weights[f"Conv_{number + 1}"] + np.zeros_like(gated)
    for shift in range(_KERNEL):
        mixed += padded[shift : shift + len(gated)] * kernel[:, shift]
    mixed = mixed * _sigmoid(mixed)
    kernel2 = weights[name + "pointwise2.weight"][:, :, 0].T
    return np.asarray(_product(mixed, kernel2) + weights[name + "pointwise2.bias"])
