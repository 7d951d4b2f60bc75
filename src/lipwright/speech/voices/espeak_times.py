"""When espeak-ng makes each sound, from its events and the sound itself.

espeak-ng tells the start of a sound to the sample, but the silence that it makes before some of
them comes before their event (`Generate` in synthesize.c: `prepause`). For a voiceless stop that
silence, 39 or 49 ms at the usual rate, is its closure, and its event is the burst. A voiced stop
behind a vowel and a nasal are told where they close. So a stop begins where the silence before its
event does; bench/voice_lags.py measures what is left.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError
from lipwright.espeak import Speech, words_to_ipa
from lipwright.language.espeak_ipa import read_espeak
from lipwright.language.ipa import Sound
from lipwright.phones import PHONES, SILENCE
from lipwright.speech.voices.espeak_text import SaidText, bare_word
from lipwright.speech.voices.timeline import Stretch, Timed

QUIET: Final = 0.002  # of full scale: what espeak-ng leaves in its silences
SHORTEST_PAUSE: Final = 0.06  # s; silence shorter than this belongs to the sounds beside it
CLOSURE: Final = 0.06  # s that a stop is shut at the end of a pause, where it cannot be heard
_STOPS: Final = ("stop", "affricate")
# Weights of a label's sounds in its time, where a label is more than one.
_VOWEL_WEIGHT: Final = 2.0
_LONG_WEIGHT: Final = 3.0
# Mandarin writes y and w before finals that begin with that sound already.
_TWICE: Final = frozenset((("Y", "Y"), ("Y", "XIY"), ("Y", "IY"), ("W", "W"), ("W", "UW")))


def spoken_samples(speech: Speech) -> int:
    """How many samples of it are not the silence at its end."""
    loud = np.flatnonzero(np.abs(speech.samples) > QUIET)
    return int(loud[-1]) + 1 if len(loud) else 0


def to_stretch(speech: Speech, text: SaidText, code: str) -> Stretch:
    """Phones and words of what espeak-ng has said.

    Args:
        speech: its sound and events.
        text: what it was given.
        code: the voice's language.
    """
    heard = _Heard(speech)
    words, owner = _words(speech, text)
    timed: list[Timed] = []
    for index, event in enumerate(speech.phones):
        sounds = _sounds(event.label, code)
        word = owner.get(event.position)
        start, stop = heard.start(index), heard.start(index + 1)
        if not sounds:
            if not timed or heard.is_pause(index):
                timed.append(Timed(SILENCE, start))
            continue
        if PHONES[sounds[0].phone].manner in _STOPS:
            start = heard.closure(index, not timed or timed[-1].phone == SILENCE)
        timed += share_time(sounds, start, stop, word)
    if code.startswith("cmn"):
        timed = _once(timed)
    timed = _parted(_without_gaps(timed, heard), text, code)
    return Stretch(speech.samples, tuple(timed), tuple(words))


class _Heard:
    """Events in samples, and where the sound is silent."""

    def __init__(self, speech: Speech) -> None:
        self.rate = speech.rate
        self._starts = [round(event.start * speech.rate) for event in speech.phones]
        self._count = len(speech.samples)
        loud = np.flatnonzero(np.abs(speech.samples) > QUIET)
        self._loud: npt.NDArray[np.int64] = loud.astype(np.int64)

    def start(self, index: int) -> int:
        """Of an event, or of the end."""
        return min(self._starts[index], self._count) if index < len(self._starts) else self._count

    def is_pause(self, index: int) -> bool:
        """Whether nothing is heard from an event to the next."""
        start, stop = self.start(index), self.start(index + 1)
        first, last = np.searchsorted(self._loud, (start, stop))
        return bool(first == last) and stop > start

    def closure(self, index: int, after_pause: bool) -> int:
        """Where a stop shuts whose event is given."""
        event = self.start(index)
        before = int(np.searchsorted(self._loud, event))
        silent = int(self._loud[before - 1]) + 1 if before else 0
        earliest = self.start(index - 1) if index else 0
        shut = max(silent, earliest)
        if after_pause:
            shut = min(shut, max(silent, event - round(CLOSURE * self.rate)))
        return max(shut, 0)


def _sounds(label: str, code: str) -> tuple[Sound, ...]:
    try:
        return read_espeak(label, code)
    except LipwrightError:  # a mnemonic that is not IPA: its letters that are
        found: list[Sound] = []
        for letter in label:
            try:
                found += read_espeak(letter, code)
            except LipwrightError:
                continue
        return tuple(found)


def share_time(sounds: Sequence[Sound], start: int, stop: int, word: int | None) -> list[Timed]:
    """The sounds of one phoneme, each with its share of the time from `start` to `stop`."""
    weights = [
        1.0 if not PHONES[sound.phone].is_vowel else _LONG_WEIGHT if "ː" in sound.ipa
        else _VOWEL_WEIGHT for sound in sounds
    ]  # fmt: skip
    ends = np.cumsum([0.0, *weights]) / sum(weights)
    return [
        Timed(sound.phone, start + round((stop - start) * float(share)), sound.stress, word)
        for sound, share in zip(sounds, ends, strict=False)
    ]


def _once(timed: Sequence[Timed]) -> list[Timed]:
    """A glide and a vowel that begins with it are one."""
    kept: list[Timed] = []
    for one in timed:
        if kept and (kept[-1].phone, one.phone) in _TWICE and kept[-1].word == one.word:
            before = kept.pop()
            one = Timed(one.phone, before.start, one.stress, one.word)  # noqa: PLW2901
        kept.append(one)
    return kept


def _without_gaps(timed: Sequence[Timed], heard: _Heard) -> list[Timed]:
    """Silences that are pauses; shorter ones belong to the phone before, the first to the next."""
    kept: list[Timed] = []
    ends = [*(one.start for one in timed[1:]), heard.start(1 << 60)]
    lead: int | None = None
    for one, end in zip(timed, ends, strict=True):
        if one.phone != SILENCE:
            start = one.start if lead is None else lead
            kept.append(Timed(one.phone, start, one.stress, one.word))
            lead = None
            continue
        if kept and kept[-1].phone == SILENCE:
            continue
        since = one.start if lead is None else lead
        if end - since >= SHORTEST_PAUSE * heard.rate or (kept and end == ends[-1]):
            kept.append(Timed(SILENCE, since))
            lead = None
        elif not kept:
            lead = since
    return kept


def _parted(timed: list[Timed], text: SaidText, code: str) -> list[Timed]:
    """The words that espeak-ng says as one, such as "on the", each with its own phones."""
    said = sorted({one.word for one in timed if one.word is not None})
    last = len(text.words)
    together = [
        range(word, min(following, last))
        for word, following in zip(said, [*said[1:], last], strict=False)
        if min(following, last) > word + 1
    ]
    words = [text.words[word] for group in together for word in group]
    counts = iter([len(_sounds(ipa, code)) for ipa in words_to_ipa(words, code)] if words else [])
    for group in together:
        owners = [word for word in group for _ in range(next(counts))]
        places = [index for index, one in enumerate(timed) if one.word == group[0]]
        if len(owners) == len(places):  # else they change each other, and stay together
            for place, owner in zip(places, owners, strict=True):
                timed[place] = replace(timed[place], word=owner)
    return timed


def _words(speech: Speech, text: SaidText) -> tuple[list[str], dict[int, int]]:
    """The words as written, and which one the sounds of each position belong to."""
    words = list(text.words)
    owner: dict[int, int] = {}
    nexts = [*(event.position for event in speech.words), len(text.text)][1:]
    for event, following in zip(speech.words, nexts, strict=False):
        around = [span for span in text.spans if span.start <= event.position]
        if not around:
            continue
        span = around[-1]
        if span.word < 0:
            stop = max(min(following, span.stop), event.position + 1)
            words.append(bare_word(text.text[event.position : stop]))
        owner[event.position] = len(words) - 1 if span.word < 0 else span.word
    return words, owner
