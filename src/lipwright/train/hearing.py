"""The sound of recordings as features, in other voices too: what a process of its own can do."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Listening:
    """What to listen to."""

    audio: Path
    times: npt.NDArray[np.float64]
    """(T,), s"""
    voices: tuple[float, ...] = ()
    """V factors of the formants; see `lipwright.features.sound.warped`"""


def listen(task: Listening) -> tuple[Floats, ...]:
    """V + 1 arrays (T, S): the sound as it is, and in each other voice.

    Raises:
        LipwrightError: the sound cannot be read.
    """
    from lipwright.audio import read_audio
    from lipwright.features.sound import hear, to_features, warped
    from lipwright.speech.features import RATE
    from lipwright.speech.recording import spectra

    sound = read_audio(task.audio, RATE)
    power = spectra(sound)
    throats = (power, *(warped(power, factor) for factor in task.voices))
    return tuple(to_features(hear(sound, throat), task.times) for throat in throats)


def listen_to_all(tasks: Sequence[Listening]) -> Iterator[tuple[Floats, ...]]:
    """`listen` to each task, in order; several processes share long work."""
    if sum(1 + len(task.voices) for task in tasks) < 64:
        yield from map(listen, tasks)
        return
    context = multiprocessing.get_context("spawn")  # a fork would copy torch's threads half
    with ProcessPoolExecutor(os.cpu_count(), context) as pool:
        yield from pool.map(listen, tasks, chunksize=4)
