"""Stretches of speech with their phones, put one after the other into one utterance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.audio import Audio
from lipwright.phones import BILABIALS, SILENCE
from lipwright.speech.voices.stretching import stretch
from lipwright.speech.voices.values import Utterance
from lipwright.track import PhoneTrack, Word

Samples = npt.NDArray[np.float32]

LEAST: Final = 0.015  # s, of a phone that the voice gave no time
LEAST_CLOSURE: Final = 0.03  # s, of p b m, which must be seen
AROUND: Final = 0.05  # s of silence before the first phone and after the last, at least


@dataclass(frozen=True)
class Timed:
    """A phone in a stretch of speech; it lasts until the next one begins."""

    phone: str
    """symbol of the phone table, or sil"""
    start: int
    """samples from the start of the stretch"""
    stress: int | None = None
    """as in a phone track"""
    word: int | None = None
    """index of its word among those of the stretch"""


@dataclass(frozen=True, eq=False)
class Stretch:
    """Speech with its phones."""

    samples: Samples
    """(N,)"""
    phones: tuple[Timed, ...]
    """in order; what is before the first is silence"""
    words: tuple[str, ...]
    """as written, without white space"""

    def trimmed(self, start: bool, end: bool) -> Stretch:
        """The stretch without the silence at one end or both."""
        phones, samples = list(self.phones), self.samples
        while phones and phones[0].phone == SILENCE:
            phones.pop(0)
        if end:
            while phones and phones[-1].phone == SILENCE:
                samples = samples[: phones.pop().start]
        if not phones:
            return Stretch(samples[:0], (), ())
        cut = phones[0].start if start else 0
        moved = tuple(replace(phone, start=phone.start - cut) for phone in phones)
        return Stretch(samples[cut:], moved, self.words)

    def stretched(self, factor: float, rate: int) -> Stretch:
        """The same speech `factor` times as long, at the same pitch."""
        phones = tuple(replace(one, start=round(one.start * factor)) for one in self.phones)
        return Stretch(stretch(self.samples, rate, factor), phones, self.words)


class Timeline:
    """Stretches and silences at one rate, one after the other."""

    def __init__(self, rate: int) -> None:
        """`rate` in samples a second."""
        self.rate = rate
        self._samples: list[Samples] = []
        self._length = 0
        self._phones: list[Timed] = []
        self._words: list[str] = []

    @property
    def says_something(self) -> bool:
        """Whether there is a phone that is not silence."""
        return any(phone.phone != SILENCE for phone in self._phones)

    def silence(self, seconds: float) -> None:
        """Silence, exact to the sample."""
        count = round(seconds * self.rate)
        if count:
            self._begin(SILENCE)
            self._push(np.zeros(count, np.float32))

    def add(self, said: Stretch) -> None:
        """Speech."""
        if not len(said.samples):
            return
        if not said.phones or said.phones[0].start > 0:
            self._begin(SILENCE)
        shift, first_word = self._length, len(self._words)
        for phone in said.phones:
            if phone.phone == SILENCE and self._phones and self._phones[-1].phone == SILENCE:
                continue
            word = None if phone.word is None else phone.word + first_word
            self._phones.append(replace(phone, start=phone.start + shift, word=word))
        self._words += said.words
        self._push(said.samples)

    def end_speech(self) -> None:
        """Cut the silence at the end, so that what follows comes right behind the last phone."""
        if not self._phones or self._phones[-1].phone != SILENCE:
            return
        count = self._length - self._phones.pop().start
        self._length -= count
        while count:
            last = self._samples.pop()
            if len(last) > count:
                self._samples.append(last[: len(last) - count])
            count = max(count - len(last), 0)

    def audio(self) -> Audio:
        """The sound alone."""
        return Audio(self._sound(0, 0), self.rate)

    def utterance(self, text: str) -> Utterance:
        """All of it, with silence around it.

        Raises:
            ValueError: nothing is said.
        """
        if not self.says_something:
            raise ValueError("an utterance without phones")
        head = self._missing(0) if self._phones[0].phone == SILENCE else AROUND
        tail = self._missing(-1) if self._phones[-1].phone == SILENCE else AROUND
        before, after = round(head * self.rate), round(tail * self.rate)
        samples = self._sound(before, after)
        phones = list(self._phones)
        if phones[-1].phone != SILENCE:
            phones.append(Timed(SILENCE, self._length))
        starts = [phone.start + before for phone in phones]
        if phones[0].phone == SILENCE:
            starts[0] = 0
        else:
            phones.insert(0, Timed(SILENCE, 0))
            starts.insert(0, 0)
        edges = self._rising(phones, [*starts, len(samples)])
        track = PhoneTrack(
            tuple(phone.phone for phone in phones), edges / self.rate, self._spans(phones),
            tuple(phone.stress for phone in phones),
        )  # fmt: skip
        return Utterance(Audio(samples, self.rate), track, text)

    def _sound(self, before: int, after: int) -> Samples:
        """All samples, so many of silence around them, and none above full scale."""
        loudest = max((float(np.abs(part).max(initial=0.0)) for part in self._samples), default=0.0)
        samples = np.zeros(before + self._length + after, np.float32)
        place = before
        for part in self._samples:
            samples[place : place + len(part)] = part
            place += len(part)
        if loudest > 1:
            samples /= np.float32(loudest)
        # An hour of speech is 300 MB; the parts are let go of.
        self._samples = [samples[before:place]]
        return samples

    def _begin(self, phone: str) -> None:
        if not self._phones or self._phones[-1].phone != phone:
            self._phones.append(Timed(phone, self._length))

    def _push(self, samples: Samples) -> None:
        self._samples.append(samples)
        self._length += len(samples)

    def _missing(self, index: int) -> float:
        """S that the silence at one end lacks."""
        ends = [*(phone.start for phone in self._phones), self._length]
        lasts = ends[1] if index == 0 else ends[-1] - ends[-2]
        return max(0.0, AROUND - lasts / self.rate)

    def _rising(self, phones: Sequence[Timed], edges: list[int]) -> npt.NDArray[np.float64]:
        """(P + 1,), the edges, moved where a phone would have no time."""
        leasts = [LEAST_CLOSURE if one.phone in BILABIALS else LEAST for one in phones]
        least = np.round(np.asarray(leasts) * self.rate)
        room = edges[-1] - edges[0]
        if least.sum() > room:
            least = least * (room / least.sum())
        # A sound that got no time is most often heard at the end of the one before it, so first
        # each takes from what is before; the second way lets none begin too early.
        moved = np.asarray(edges, np.float64)
        for index in range(len(phones) - 1, 0, -1):
            moved[index] = min(moved[index], moved[index + 1] - least[index])
        for index in range(1, len(phones)):
            moved[index] = max(moved[index], moved[index - 1] + least[index - 1])
        return moved

    def _spans(self, phones: Sequence[Timed]) -> tuple[Word, ...]:
        """The words as runs of phones, in the order of these; one without a phone is left out."""
        places: dict[int, list[int]] = {}
        for index, phone in enumerate(phones):
            if phone.word is not None and phone.phone != SILENCE:
                places.setdefault(phone.word, []).append(index)
        # A word in two places ends where another begins.
        stops = [*(found[0] for found in places.values()), len(phones)][1:]
        return tuple(
            Word(self._words[word], found[0], min(found[-1] + 1, stop))
            for (word, found), stop in zip(places.items(), stops, strict=True)
        )
