"""A Piper voice's network: numbers of phonemes in, sound and their durations out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError
from lipwright.onnx_session import import_onnxruntime, open_session
from lipwright.speech.voices.onnx_nodes import Contents, read_contents
from lipwright.speech.voices.onnx_outputs import with_output
from lipwright.speech.voices.piper_config import REMEDY, PiperConfig

if TYPE_CHECKING:
    from collections.abc import Sequence

Samples = npt.NDArray[np.float32]

MAX_BYTES: Final = 2**31 - 1  # the most that an ONNX file can have, being one protobuf message
SEED: Final = 0  # of its noise, so that the same program sounds the same every time
_INPUTS: Final = frozenset(("input", "input_lengths", "scales"))
_SPEAKER: Final = "sid"
_ROUNDED_UP: Final = "Ceil"
"""durations are whole frames: VITS rounds them up before it repeats each phoneme so often"""


class PiperModel:
    """A network that is ready to run."""

    def __init__(self, path: Path, config: PiperConfig) -> None:
        """The network in the file `path`.

        Raises:
            LipwrightError: it is missing, no Piper voice, or keeps weights in other files.
        """
        self._path, self._config = path, config
        content = _read(path)
        try:
            contents = read_contents(content)
        except ValueError as error:
            raise LipwrightError(f"{path}: not an ONNX model: {error}; {REMEDY}") from error
        if contents.needs_files:
            raise LipwrightError(
                f"{path}: keeps weights in other files, which is not allowed; export it as one file"
            )
        self._durations = _durations(contents)
        if self._durations and self._durations not in contents.outputs:
            content = with_output(content, self._durations)
        self._sound = contents.outputs[0]
        self._session = self._open(content)
        names = {port.name for port in self._session.get_inputs()}
        self._has_speakers = _SPEAKER in names
        if not names - {_SPEAKER} == _INPUTS:
            raise LipwrightError(
                f"{path}: has the inputs {', '.join(sorted(names))[:80]}, not those of a Piper "
                f"voice ({', '.join(sorted(_INPUTS))}); {REMEDY}"
            )

    @property
    def tells_durations(self) -> bool:
        """Whether it tells how long each phoneme lasts."""
        return self._durations is not None

    def run(
        self, ids: Sequence[int], length_scale: float, speaker: int
    ) -> tuple[Samples, npt.NDArray[np.float64] | None]:
        """The sound of phonemes.

        Args:
            ids: L numbers.
            length_scale: factor of the durations.
            speaker: its number; ignored by a voice of one speaker.

        Returns:
            The sound, (N,), and the end of each phoneme in samples, (L,), if the voice tells it.

        Raises:
            LipwrightError: the network fails, or gives what no voice can.
        """
        config = self._config
        feeds: dict[str, npt.NDArray[Any]] = {
            "input": np.asarray([ids], np.int64),
            "input_lengths": np.asarray([len(ids)], np.int64),
            "scales": np.asarray([config.noise_scale, length_scale, config.noise_w], np.float32),
        }
        if self._has_speakers:
            feeds[_SPEAKER] = np.asarray([speaker], np.int64)
        wanted = [self._sound, *([self._durations] if self._durations else [])]
        try:
            given = self._session.run(wanted, feeds)
        except Exception as error:  # onnxruntime has a class for each kind of failure
            raise self._fails(" ".join(str(error).split())[:120]) from error
        samples: Samples = np.asarray(given[0], np.float32).reshape(-1)
        if not len(samples) or not np.isfinite(samples).all():
            raise self._fails("its sound is empty or not finite")
        if self._durations is None:
            return samples, None
        frames = np.asarray(given[1], np.float64).reshape(-1)
        total = float(frames.sum()) if len(frames) == len(ids) else 0.0
        if not np.isfinite(frames).all() or (frames < 0).any() or total <= 0:
            raise self._fails(f"its durations are not those of {len(ids)} phonemes")
        return samples, np.cumsum(frames) * (len(samples) / total)

    def _fails(self, reason: str) -> LipwrightError:
        return LipwrightError(f"{self._path}: the voice fails: {reason}; {REMEDY}")

    def _open(self, content: bytes) -> Any:
        import_onnxruntime().set_seed(SEED)
        try:
            return open_session(content)
        except Exception as error:  # onnxruntime has a class for each kind of refusal
            reason = " ".join(str(error).split())[:120]
            raise LipwrightError(
                f"{self._path}: onnxruntime cannot run it ({reason}); {REMEDY}"
            ) from error


def _durations(contents: Contents) -> str | None:
    """The name of the value that holds the durations, if it can be told.

    Voices patched or exported for it have it as their second output. Else it is what the model
    rounds up; where it rounds up more than one, that which it counts up afterwards.
    """
    if len(contents.outputs) > 1:
        return contents.outputs[1]
    rounded = [node.outputs[0] for node in contents.nodes
               if node.op_type == _ROUNDED_UP and node.outputs]  # fmt: skip
    if len(rounded) == 1:
        return rounded[0]
    counted = {name for node in contents.nodes if node.op_type == "CumSum" for name in node.inputs}
    left = [name for name in rounded if name in counted]
    return left[0] if len(left) == 1 else None


def _read(path: Path) -> bytes:
    try:
        if not path.is_file():
            reason = "is a folder; name the .onnx file in it" if path.is_dir() else "no such file"
            raise LipwrightError(f"{path}: {reason}; a Piper voice is --voice piper:FILE.onnx")
        if path.stat().st_size > MAX_BYTES:
            raise LipwrightError(f"{path}: is larger than 2 GB, which no voice is; {REMEDY}")
        return path.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise LipwrightError(f"{path}: cannot be read: {reason}") from error
