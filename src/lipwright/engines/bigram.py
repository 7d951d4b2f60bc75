"""The bigram engine: curves that are drawn for pairs of phones, laid end over end.

After Xu et al. 2013: no machine learning, any set of poses, every curve open to the animator.
The clip is in the poses of the set; `passes.bigram_passes` are the paper's steps after stitching,
and a rig says how the poses look on a face.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

from lipwright.audio import Sound
from lipwright.bigrams.families import load_bigrams
from lipwright.bigrams.runtime import stitch
from lipwright.bigrams.values import BigramSet
from lipwright.clip import Clip
from lipwright.track import PhoneTrack

DEFAULT_SET: Final = "english"


def open_set(model: str | Path | BigramSet | None = None) -> BigramSet:
    """The set itself, or that of a name or file; by default the English one.

    Raises:
        LipwrightError: it cannot be used.
    """
    if isinstance(model, BigramSet):
        return model
    return load_bigrams(DEFAULT_SET if model is None else model)


def animate(
    track: PhoneTrack,
    fps: float,
    audio: Sound | None = None,
    model: str | Path | BigramSet | None = None,
) -> Clip:
    """The stitched curves of a track, in the poses of the set `model`.

    `audio` is not listened to.

    Raises:
        LipwrightError: the set cannot be used.
    """
    del audio
    return stitch(open_set(model), track, fps)
