"""The poses that a mapping is fitted to: what speech does with canonical controls."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.controls import CANONICAL, both_sides
from lipwright.engines import engine_learnt, get_engine
from lipwright.passes import apply_passes, learnt_passes
from lipwright.phones import PHONES, SILENCE
from lipwright.track import PhoneTrack

PHONE_SECONDS: Final = 0.12  # of ordinary running speech
POSES_FPS: Final = 4.0  # a pose for two phones


def every_pair() -> PhoneTrack:
    """English syllables: every consonant before every vowel, and a pause after each consonant."""
    english = [phone for name, phone in PHONES.items() if not name.startswith("X")]
    consonants = [phone.symbol for phone in english if phone.is_consonant]
    vowels = [phone.symbol for phone in english if phone.is_vowel]
    spoken: list[str] = []
    for row, consonant in enumerate(consonants):
        turned = vowels[row % len(vowels) :] + vowels[: row % len(vowels)]
        spoken += [SILENCE, *(phone for vowel in turned for phone in (consonant, vowel))]
    spoken.append(SILENCE)
    edges = np.arange(len(spoken) + 1, dtype=np.float64) * PHONE_SECONDS
    return PhoneTrack(tuple(spoken), edges)


CLOSURE: Final = MappingProxyType(
    {"jawOpen": 0.1, "mouthClose": 0.1, "mouthPress": 0.25, "mouthRollUpper": 0.1}
)
"""what p, b and m do after open vowels; see `lipwright.passes.SHUT`"""
BESIDE: Final = ("mouthSmile", "mouthFrown", "mouthDimple", "mouthStretch", "mouthPucker",
                 "cheekPuff")  # fmt: skip
"""what a face does that smiles, or rounds its lips early, while they are shut"""
TEACHERS: Final = ("window", "dominance")
"""engines: one moves as a recorded face does, one as articulation has it"""


@cache
def speech_poses() -> npt.NDArray[np.float64]:
    """(N, C), canonical controls while two engines speak `every_pair`; read-only."""
    track = every_pair()
    spoken = []
    for engine in TEACHERS:
        passes = learnt_passes(1.0, *engine_learnt(engine))
        clip = apply_passes(get_engine(engine)(track, POSES_FPS), track, passes)
        spoken.append(clip.select(CANONICAL).values.astype(np.float64))
    poses = np.concatenate(spoken)
    poses.setflags(write=False)
    return poses


def shut_poses() -> npt.NDArray[np.float64]:
    """(N, C), closures, and rest, each with one other control at half and in full."""
    beside = Sources(BESIDE).alone()
    closure = sum(weight * Sources((name,)).alone() for name, weight in CLOSURE.items())
    return np.concatenate([share * beside + shut for share in (0.5, 1.0) for shut in (closure, 0)])


@dataclass(frozen=True)
class Sources:
    """P names, each a canonical control or both sides of one, and how poses give them."""

    names: tuple[str, ...]

    def of(self, poses: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """(N, P) of canonical poses (N, C)."""
        return np.stack(
            [
                poses[:, [CANONICAL.index(side) for side in both_sides(name)]].mean(axis=1)
                for name in self.names
            ],
            axis=1,
        )

    def alone(self) -> npt.NDArray[np.float64]:
        """(P, C), each source in full, on both sides where it means both."""
        poses = np.zeros((len(self.names), len(CANONICAL)))
        for row, name in enumerate(self.names):
            poses[row, [CANONICAL.index(side) for side in both_sides(name)]] = 1.0
        return poses
