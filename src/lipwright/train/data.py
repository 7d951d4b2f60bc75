"""Arrays that networks learn from: all frames of a split end to end, and windows cut from them.

A window is made when a batch asks for it: those of Taylor et al. 2017 would fill gigabytes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt
import torch
from torch import Tensor

from lipwright.features import KINDS as FEATURE_KINDS
from lipwright.features import FeatureSet
from lipwright.features.featureset import HEARD as HEARD_SOUND
from lipwright.features.known import seen_phones
from lipwright.features.sound import SOUND_NAMES
from lipwright.features.timing import TIMING
from lipwright.phones import SILENCE
from lipwright.train.config import Config
from lipwright.train.learner import silence_first
from lipwright.train.takes import Corpus, Take

Floats = npt.NDArray[np.float64]
Splits = dict[str, "Arrays"]

HEARD: Final = 3  # times in training from which a phone has columns of its own
STILL: Final = 1e-6  # standard deviation under which a value counts as constant


def feature_set(config: Config, corpus: Corpus) -> FeatureSet:
    """What a model sees: the phones of the configuration, or those heard in training."""
    takes = corpus.of("train")
    phones = config.phones
    if phones is None:
        count = Counter(phone for take in takes for phone in take.track.phones)
        seen = seen_phones(take.track for take in takes)
        phones = tuple(phone for phone in seen if phone == SILENCE or count[phone] >= HEARD)
    kinds = tuple(kind for kind in FEATURE_KINDS if kind in config.features)
    return FeatureSet(kinds, config.input_window, corpus.fps, silence_first(phones))


@dataclass(frozen=True, eq=False)
class Scaling:
    """Means and standard deviations that the network does without: they are in the ONNX graph."""

    input_mean: Floats
    """(F,) of one frame; 0 for columns of 0 and 1, and for sound"""
    input_sd: Floats
    """(F,); 1 for these columns too, and endless for those that never change in training"""
    mean: Floats
    """(C,) of the targets"""
    sd: Floats
    """(C,) that the loss divides by"""
    spread: Floats
    """(C,) standard deviations of the targets in training, whatever the loss divides by"""


def find_scaling(takes: Sequence[Take], features: FeatureSet, config: Config) -> Scaling:
    """The scaling of a configuration, out of the frames for training."""
    rows = np.concatenate([features.frames(t.track, t.times, t.sound) for t in takes])
    numbers = np.asarray(~np.isin(rows, (0, 1)).all(axis=0))
    # Sound is scaled by its recording, and rare likenesses must not grow large.
    numbers[[name not in TIMING for name in features.frame_names]] = False
    input_mean = np.where(numbers, rows.mean(axis=0, dtype=np.float64), 0)
    input_sd = np.where(numbers, spread_of(rows), 1)
    # What never changes in training has weights that nothing has taught: it must not count later.
    still = np.ptp(rows, axis=0) == 0
    if config.augment.deaf and HEARD_SOUND in features.frame_names:
        still[features.frame_names.index(HEARD_SOUND)] = False
    input_sd[still] = np.inf
    targets = np.concatenate([take.targets[take.valid] for take in takes])
    mean, spread = targets.mean(axis=0, dtype=np.float64), spread_of(targets)
    if config.scaling == "none":
        mean, sd = np.zeros_like(mean), np.ones_like(spread)
    elif config.scaling == "common":
        sd = np.full_like(spread, np.sqrt(targets.var(axis=0, dtype=np.float64).mean()))
    else:
        sd = spread
    return Scaling(input_mean, input_sd, mean, sd, spread)


def spread_of(rows: npt.NDArray[np.float32]) -> Floats:
    """(C,) the standard deviations of the columns of (T, C); 1 of those that do not move."""
    found = rows.std(axis=0, dtype=np.float64)
    return np.where(found > STILL, found, 1)


@dataclass(frozen=True, eq=False)
class Arrays:
    """N frames of several takes. Around each take its end frames repeat, as windows see them."""

    takes: tuple[Take, ...]
    features: FeatureSet
    frames: Tensor
    """(R, F) scaled features, R rows for N frames and those around the takes"""
    targets: Tensor
    """(R, C) scaled"""
    mask: Tensor
    """(R,) 1 where a face was seen, else 0"""
    rows: Tensor
    """(N,) which of the R rows each frame is"""
    starts: tuple[int, ...]
    """index of the first frame of each take, and N"""
    span_columns: Tensor
    """which spans are there, window after window"""
    span_starts: Tensor
    """(N + 1,) where those of each window begin"""
    voices: Tensor
    """(V, R, S) sound features of other voices"""

    def __len__(self) -> int:
        """N."""
        return len(self.rows)

    def taught(self, *, windows: bool) -> Tensor:
        """(D,) of windows or (F,) of frames: which columns are ever other than 0."""
        frame = (self.frames != 0).any(dim=0)
        if not windows:
            return frame
        spans = self.features.size - self.features.window * len(frame)
        held = torch.bincount(self.span_columns, minlength=spans) > 0
        return torch.cat([frame.repeat(self.features.window), held])

    def windows(self, chosen: Tensor) -> Tensor:
        """(B, D), the windows around the frames `chosen` (B,)."""
        half = self.features.window // 2
        flat = self._cut(chosen, half, half).flatten(start_dim=1)
        if "spans" not in self.features.kinds:
            return flat
        whole = torch.zeros(len(chosen), self.features.size)
        whole[:, : flat.shape[1]] = flat
        first = self.span_starts[chosen]
        counts = self.span_starts[chosen + 1] - first
        line = torch.repeat_interleave(torch.arange(len(chosen)), counts)
        before = counts.cumsum(0) - counts
        place = torch.arange(len(line)) + (first - before)[line]
        whole[line, flat.shape[1] + self.span_columns[place]] = 1
        return whole

    def stretches(self, chosen: Tensor, length: int) -> Tensor:
        """(B, W, F), what convolutions need for `length` frames from `chosen` (B,) on."""
        half = self.features.window // 2
        return self._cut(chosen, half, length - 1 + half)

    def voiced_stretch(self, voice: int, chosen: int, length: int) -> Tensor:
        """(W, S), the sound of a stretch in another voice."""
        half = self.features.window // 2
        first = int(self.rows[chosen]) - half
        return self.voices[voice, first : first + length + 2 * half]

    def _cut(self, chosen: Tensor, before: int, after: int) -> Tensor:
        return self.frames[self.rows[chosen, None] + torch.arange(-before, after + 1)]

    def reference(self, chosen: Tensor, before: int, after: int) -> tuple[Tensor, Tensor]:
        """Controls (B, L, C) and mask (B, L) from `before` frames before to `after` after."""
        rows = self.rows[chosen, None] + torch.arange(-before, after + 1)
        return self.targets[rows], self.mask[rows]


def make_arrays(
    takes: Sequence[Take], features: FeatureSet, scaling: Scaling, config: Config
) -> Arrays:
    """The arrays of some takes."""
    pad = max(config.input_window, config.output_window) // 2
    frames, voices, targets, masks, rows, columns, counts = [], [], [], [], [], [], []
    starts, row = [0], 0
    most = max(len(take.voices) for take in takes)
    for take in takes:
        count = len(take.times)
        seen = features.frames(take.track, take.times, take.sound)
        frames.append(_with_ends((seen - scaling.input_mean) / scaling.input_sd, pad))
        voices.append(_voices(take, pad, most))
        apart = (take.targets - scaling.mean) / scaling.sd
        targets.append(_with_ends(np.where(take.valid[:, None], apart, 0), pad))
        masks.append(_with_ends(take.valid, pad))
        rows.append(row + pad + np.arange(count))
        row += count + 2 * pad
        starts.append(starts[-1] + count)
        if "spans" in features.kinds:
            line, column = features.span_indices(take.track, take.times)
            columns.append(column)
            counts.append(np.bincount(line, minlength=count))
    held = np.concatenate([[0], *counts]).cumsum()
    return Arrays(
        tuple(takes), features, _joined(frames), _joined(targets), _joined(masks),
        torch.from_numpy(np.concatenate(rows)), tuple(starts),
        torch.from_numpy(np.concatenate([np.empty(0, np.int64), *columns])),
        torch.from_numpy(held.astype(np.int64)),
        torch.from_numpy(np.concatenate(voices, axis=1)),
    )  # fmt: skip


def _voices(take: Take, pad: int, count: int) -> npt.NDArray[np.float32]:
    """(V, R, S), the sound of a take in `count` other voices; zeros where it has no sound."""
    if not take.voices:
        return np.zeros((count, len(take.times) + 2 * pad, len(SOUND_NAMES)), np.float32)
    return np.stack([_with_ends(voice, pad) for voice in take.voices])


def _with_ends(values: npt.NDArray[np.generic], pad: int) -> npt.NDArray[np.float32]:
    """Frames with the first and last one repeated."""
    around = ((pad, pad), *((0, 0),) * (values.ndim - 1))
    return np.pad(values, around, mode="edge").astype(np.float32)


def _joined(parts: Sequence[npt.NDArray[np.float32]]) -> Tensor:
    return torch.from_numpy(np.concatenate(parts))


@dataclass(frozen=True, eq=False)
class Data:
    """All that a training learns from and is judged by."""

    corpus: Corpus
    features: FeatureSet
    scaling: Scaling
    train: Arrays
    validation: Arrays
    opening: Tensor | None
    """(C,) eye distances by which each scaled control opens the lips; None where nobody asks"""
    test: Arrays | None
    """None where the dataset keeps no recording for the test"""

    @property
    def controls(self) -> tuple[str, ...]:
        """C names."""
        return self.corpus.controls


def make_data(corpus: Corpus, config: Config) -> Data:
    """The arrays of a corpus as a configuration wants them.

    Raises:
        LipwrightError: a window is longer than a recording.
    """
    corpus.check_window(max(config.input_window, config.output_window))
    features = feature_set(config, corpus)
    scaling = find_scaling(corpus.of("train"), features, config)
    train, validation, test = (
        make_arrays(corpus.of(split), features, scaling, config) if corpus.of(split) else None
        for split in ("train", "validation", "test")
    )
    assert train is not None
    assert validation is not None
    opening = None
    if config.loss.lips and config.targets in {"arkit", "both"}:
        opening = _opening(corpus.controls, scaling)
    return Data(corpus, features, scaling, train, validation, opening, test)


def _opening(controls: Sequence[str], scaling: Scaling) -> Tensor:
    from lipwright.controls import CANONICAL
    from lipwright.face.head import load_head

    opens = dict(zip(CANONICAL, load_head().opening, strict=True))
    opening = np.array([opens.get(name, 0.0) for name in controls])  # modes are no head's
    return torch.from_numpy((opening * scaling.sd).astype(np.float32))
