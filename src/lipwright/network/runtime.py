"""`Network`: a model that is ready to run, on numpy arrays."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError
from lipwright.network.folder import REMEDY, PathLike, find_model, read_hashed, read_meta
from lipwright.network.meta import GOLDEN_FILE, MODEL_FILE, ModelMeta
from lipwright.npz import BROKEN, read_arrays, reason_of
from lipwright.onnx_bytes import has_external_data
from lipwright.onnx_session import open_session

if TYPE_CHECKING:
    from onnxruntime import InferenceSession

Floats = npt.NDArray[np.float32]

INPUT: Final = "features"
OUTPUT: Final = "controls"
GOLDEN_TOLERANCE: Final = 1e-4  # of a full range, or of a mode's standard deviation


class Network:
    """An exported network; made by `load_network`."""

    def __init__(self, path: Path, meta: ModelMeta, session: InferenceSession) -> None:
        """`session` runs the model of the folder `path`."""
        self._path, self._meta, self._session = path, meta, session

    @property
    def path(self) -> Path:
        """The model's folder."""
        return self._path

    @property
    def meta(self) -> ModelMeta:
        """What it takes and gives."""
        return self._meta

    def run(self, features: Floats) -> Floats:
        """Controls of features as they come from the model's feature set.

        Args:
            features: windows: (N, D), one row a window. Sequence: (1, W, F), W frames of which
                W - Kx + 1 have a whole window. Recurrent: (1, T, F), all frames.

        Returns:
            Windows: (N, Ky, C). Sequence: (1, W - Kx + 1, C). Recurrent: (1, T, C).

        Raises:
            ValueError: the features have another shape.
            LipwrightError: a value that it gives is not finite.
        """
        features = np.asarray(features, np.float32)
        expected = output_shape(self._meta, features.shape)
        if not expected[0]:
            return np.zeros(expected, np.float32)
        values: Floats = self._session.run([OUTPUT], {INPUT: features})[0]
        if values.shape != expected:
            raise LipwrightError(
                f"{self._path / MODEL_FILE}: gives the shape {values.shape} for "
                f"{features.shape}, not {expected} as meta.json says; {REMEDY}"
            )
        if not np.isfinite(values).all():
            raise LipwrightError(
                f"{self._path / MODEL_FILE}: gives values that are not finite; {REMEDY}"
            )
        return values


def input_width(meta: ModelMeta) -> int:
    """Columns of the input: D of windows, F of a sequence and of a recurrent network."""
    return meta.features.size if meta.kind == "windows" else meta.features.frame_size


def output_shape(meta: ModelMeta, shape: tuple[int, ...]) -> tuple[int, int, int]:
    """The shape of the controls for features of a shape.

    Raises:
        ValueError: the network takes no such features.
    """
    width, window = input_width(meta), meta.features.window
    if meta.kind == "windows":
        if len(shape) != 2 or shape[1] != width:
            raise ValueError(f"features have the shape {shape}, not (N, {width})")
        return shape[0], meta.output_window, len(meta.controls)
    if len(shape) != 3 or shape[0] != 1 or shape[1] < window or shape[2] != width:
        raise ValueError(f"features have the shape {shape}, not (1, {window} or more, {width})")
    return 1, shape[1] - window + 1, len(meta.controls)


def load_network(model: PathLike) -> Network:
    """The network of a model that ships, by its name, or of a model's folder.

    Raises:
        LipwrightError: there is no such model, or it is damaged, of another version, or not what
            its meta.json says; names the file and the remedy.
    """
    folder = find_model(model)
    meta = read_meta(folder)
    content = read_hashed(folder, meta, MODEL_FILE)
    path = folder / MODEL_FILE
    try:
        if has_external_data(content):
            raise LipwrightError(
                f"{path}: keeps weights in other files, which is not allowed; export it as one file"
            )
    except ValueError as error:
        raise LipwrightError(f"{path}: not ONNX: {error}; {REMEDY}") from error
    session = _open_session(path, content)
    _check_ports(path, meta, session)
    network = Network(folder, meta, session)
    window = meta.features.window
    probe = (2,) if meta.kind == "windows" else (1, window + 1)
    try:
        network.run(np.zeros((*probe, input_width(meta)), np.float32))
    except LipwrightError:
        raise
    except Exception as error:  # onnxruntime has a class for each of its own
        raise LipwrightError(f"{path}: does not run: {reason_of(error)}; {REMEDY}") from error
    return network


def _cores() -> int:
    """The cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _open_session(path: Path, content: bytes) -> InferenceSession:
    try:
        return open_session(content, _cores())
    except Exception as error:  # it has a class for each kind of refusal, with no common one
        raise LipwrightError(
            f"{path}: onnxruntime cannot run it ({reason_of(error)}); {REMEDY}"
        ) from error


def _check_ports(path: Path, meta: ModelMeta, session: InferenceSession) -> None:
    """Refuse other inputs and outputs than those of the contract."""
    width, controls = input_width(meta), len(meta.controls)
    if meta.kind == "windows":
        wanted: tuple[list[int | None], ...] = ([None, width], [None, meta.output_window, controls])
    else:
        wanted = ([1, None, width], [1, None, controls])
    ports = (session.get_inputs(), session.get_outputs())
    for found, name, shape, what in zip(
        ports, (INPUT, OUTPUT), wanted, ("input", "output"), strict=True
    ):
        names = ", ".join(port.name for port in found)
        if names != name:
            raise LipwrightError(f"{path}: its {what} is {names[:80]!r}, not {name!r}; {REMEDY}")
        _check_shape(path, what, found[0], shape)


def _check_shape(path: Path, what: str, port: Any, wanted: list[int | None]) -> None:
    if port.type != "tensor(float)":
        raise LipwrightError(f"{path}: its {what} is {port.type}, not float32; {REMEDY}")
    # A size without a number is free; the output of many exporters says less than it could.
    fits = len(port.shape) == len(wanted) and all(
        not isinstance(size, int) or (size == want if want is not None else False)
        for size, want in zip(port.shape, wanted, strict=True)
    )
    if not fits:
        shape = ", ".join("any" if want is None else str(want) for want in wanted)
        raise LipwrightError(
            f"{path}: its {what} has the shape {port.shape}, not ({shape}) as meta.json says; "
            f"{REMEDY}"
        )


def check_golden(model: PathLike) -> float:
    """The largest difference from the model's golden output, in its controls' units.

    Raises:
        LipwrightError: the model cannot be loaded, its golden.npz is damaged, or this machine
            does not reproduce it to 1e-4 of a full range.
    """
    network = load_network(model)
    path = network.path / GOLDEN_FILE
    content = read_hashed(network.path, network.meta, GOLDEN_FILE)
    try:
        stored = read_arrays(content)
        features, controls = stored[INPUT], stored[OUTPUT]
        expected = output_shape(network.meta, features.shape)
    except BROKEN as error:
        raise LipwrightError(f"{path}: damaged ({reason_of(error)}); {REMEDY}") from error
    if controls.shape != expected or {features.dtype, controls.dtype} != {np.dtype(np.float32)}:
        raise LipwrightError(
            f"{path}: 'controls' has the shape {controls.shape}, not {expected} in float32; "
            f"{REMEDY}"
        )
    difference = np.abs(network.run(features) - controls)
    worst = float(difference.max(initial=0.0))
    if not worst <= GOLDEN_TOLERANCE:
        name = network.meta.controls[int(difference.max(axis=(0, 1)).argmax())]
        raise LipwrightError(
            f"{path}: not reproduced: {name} differs by {worst:.2g}, more than "
            f"{GOLDEN_TOLERANCE:g}; update onnxruntime, or {REMEDY}"
        )
    return worst
