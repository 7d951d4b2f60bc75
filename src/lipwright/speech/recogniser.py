"""Phones of a recording without words, from hama, a small neural network for English and Korean.

The network says, for each 20 ms, how likely each symbol is: sounds in IPA letters, the end of a
word, or nothing new. Its times are coarse and late; `retiming` finds the edges.
"""

from __future__ import annotations

from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError
from lipwright.phones import SILENCE, parse_phone
from lipwright.speech.conformer import log_probabilities
from lipwright.speech.features import RATE, Floats

if TYPE_CHECKING:
    from lipwright.audio import Sound

FRAME: Final = 320 / RATE  # s between two rows of the network's output
LATE: Final = 0.07  # s by which the network writes a phone after its beginning, GRID speaker 1

WORD_END: Final = "|"
NOTHING: Final = ""

# Letters that mean something else here than in `phones`: hama writes them, in English, for these.
_LETTERS: Final = MappingProxyType({
    "e": "EY", "o": "AO", "a": "AE", "ə": "AH", "ɚ": "ER", "x": "K",
})  # fmt: skip
_LOUDNESS: Final = 0.025  # root mean square of a piece as the network hears it, full scale is 1
_LEAST: Final = np.float32(1e-12)  # probability


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


def recognise(sound: Sound, start: float, end: float) -> Floats:
    """(T, S) logarithms of how likely each of `symbols` is, from `start` to `end` s of `sound`."""
    names, columns = symbols()
    samples = _at_rate(sound, start, end)
    if not len(samples):
        return np.zeros((0, len(names)), np.float32)
    loud = float(np.sqrt(np.mean(np.square(samples, dtype=np.float64))))
    scaled = np.clip(samples * np.float32(_LOUDNESS / max(loud, 1e-6)), -1, 1)
    rows = log_probabilities(scaled)
    total = np.zeros((len(names), len(rows)), np.float32)
    np.add.at(total, columns, np.exp(rows).T)
    return np.asarray(np.log(np.maximum(total, _LEAST)).T)


def _at_rate(sound: Sound, start: float, end: float) -> Floats:
    from lipwright.audio import resampled

    audio = sound.read(max(start, 0.0), max(end, 0.0))
    return (audio if audio.rate == RATE else resampled(audio, RATE)).samples
