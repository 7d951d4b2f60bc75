"""What an entrant costs: the size of its model, its training, and its speed."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import ExitStack
from typing import Final

from lipwright.benchmark.motion import Performer, sound_of
from lipwright.benchmark.training import Model, model_bytes
from lipwright.benchmark.values import Cost
from lipwright.dataset.recording import Recording
from lipwright.network import find_model

RECORDINGS: Final = 10  # animated in turn
ROUNDS: Final = 3  # of which the fastest counts: others share the machine


def measure_cost(
    performer: Performer, model: Model | None, recordings: Sequence[Recording]
) -> Cost:
    """The cost of an entrant.

    Raises:
        LipwrightError: its model cannot be used.
    """
    entrant = performer.entrant
    if model is not None:
        size: int | None = model_bytes(model.folder)
    elif entrant.kind == "shipped" and performer.model is not None:
        size = model_bytes(find_model(performer.model))
    else:
        size = None
    speed = None
    if entrant.kind not in {"curves", "real"}:
        speed = real_time(performer, recordings[:RECORDINGS])
    return Cost(size, None if model is None else model.seconds, speed)


def real_time(performer: Performer, recordings: Sequence[Recording]) -> float:
    """Seconds of speech that are animated in a second, from phones and sound to curves."""
    with ExitStack() as stack:
        sounds = [stack.enter_context(sound_of(one)) for one in recordings]
        performer.animate(recordings[0].track, sounds[0])  # loads what is loaded once
        taken = []
        for _ in range(ROUNDS):
            begun = time.perf_counter()
            for recording, sound in zip(recordings, sounds, strict=True):
                performer.animate(recording.track, sound)
            taken.append(time.perf_counter() - begun)
    return sum(one.track.end for one in recordings) / min(taken)
