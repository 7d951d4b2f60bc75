"""Phones of a recording without words, from hama, a small neural network for English and Korean.

The network writes, for each 20 ms, how likely each symbol is: sounds in IPA letters, the end of a
word, or nothing new. Its times are coarse and late; `retiming` finds the edges.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError
from lipwright.phones import SILENCE, parse_phone
from lipwright.speech.features import RATE, Floats

if TYPE_CHECKING:
    from lipwright.audio import Audio, Sound

FRAME: Final = 320 / RATE  # s between two rows of the network's output
LATE: Final = 0.07  # s by which the network writes a phone after its beginning, GRID speaker 1

WORD_END: Final = "|"
NOTHING: Final = ""

# Letters that mean something else here than in `phones`: hama writes them, in English, for these.
_LETTERS: Final = MappingProxyType({"e": "EY", "o": "AO", "a": "AE", "ə": "AH", "ɚ": "ER",
                                    "x": "K"})  # fmt: skip
_LOUDNESS: Final = 0.1  # root mean square of the loud frames of a piece, full scale is 1
_THREADS: Final = 4  # at most; the network itself runs on one


@lru_cache(maxsize=1)
def symbols() -> tuple[tuple[str, ...], npt.NDArray[np.intp]]:
    """The S phones that are told apart, with WORD_END and NOTHING last, and each token's index.

    A token that is no sound of its own (tone, tie, mark of length) counts as nothing.
    """
    from hama.vocab import Vocabulary

    tokens = [_symbol(token) for token in Vocabulary.load(None).decoder] + [WORD_END, NOTHING]
    found = [*sorted({*tokens} - {WORD_END, NOTHING}), WORD_END, NOTHING]
    return tuple(found), np.array([found.index(token) for token in tokens], np.intp)


def _symbol(token: str) -> str:
    if token in _LETTERS:
        return _LETTERS[token]
    try:
        phone = parse_phone(token, "ipa")[0]
    except (LipwrightError, IndexError):
        return NOTHING
    return NOTHING if phone == SILENCE else phone


def is_available() -> bool:
    """Whether hama is installed and runs on this machine."""
    try:
        from hama import _engine
    except ImportError:
        return False
    return bool(_engine.available())


@lru_cache(maxsize=1)
def _sessions() -> tuple[Any, ...]:
    """One network a thread; they share nothing."""
    from hama.asr import ASRModel

    return tuple(ASRModel().session for _ in range(min(_THREADS, os.cpu_count() or 1)))


def log_probabilities(samples: Floats, session: int = 0) -> Floats:
    """(T, S) natural logarithms of how likely each of `symbols` is, for samples at 16 kHz."""
    names, columns = symbols()
    loud = float(np.sqrt(np.mean(np.square(samples, dtype=np.float64)))) if len(samples) else 0.0
    scaled = np.clip(samples * np.float32(_LOUDNESS / max(loud, 1e-6)), -1, 1)
    feeds = {"waveform": scaled[None], "waveform_lengths": np.array([len(samples)])}
    heard = _sessions()[session].run(["log_probs", "out_lengths"], feeds)[0][0]
    total = np.zeros((len(heard), len(names)), np.float32)
    np.add.at(total.T, columns, np.exp(heard).T)
    return np.asarray(np.log(np.maximum(total, 1e-12)), np.float32)


def recognise(
    sound: Sound, spans: Sequence[tuple[float, float]], report: Callable[[float], None]
) -> Iterator[Floats]:
    """Log-probabilities of each piece of `sound`, whose starts and ends in s `spans` has."""
    count = len(_sessions())
    with ThreadPoolExecutor(count) as pool:
        for first in range(0, len(spans), count):
            some = spans[first : first + count]
            pieces = [_at_rate(sound.read(start, end)) for start, end in some]
            yield from pool.map(log_probabilities, pieces, range(len(pieces)))
            report(min(first + count, len(spans)) / len(spans))


def _at_rate(audio: Audio) -> Floats:
    from lipwright.audio import resampled

    return (audio if audio.rate == RATE else resampled(audio, RATE)).samples
