"""How far a voice's own phone times lie from its sound: by the sound itself, and by the aligner.

    python bench/voice_lags.py                              # hibari, examples/sentences.txt
    python bench/voice_lags.py --voice espeak:en-us
    python bench/voice_lags.py --voice espeak:sv --text swedish.txt --no-aligner

Positive is late: the voice says that a phone begins after it does. The detector knows nothing of
the voice's times but where to look, 60 ms around an edge: it takes the instant of the steepest
change of the sound's power in one band, smoothed over 10 ms. Closures are falls above 500 Hz,
fricatives rises above 3.5 kHz, vowels rises from 200 to 1200 Hz after what has no voice. Beside
them stands the aligner on the same words. "p b m": in how many of those beside a vowel is the
power above 500 Hz at least 4 dB under that of the vowel (medians within the voice's times)?
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.audio import Audio, resampled
from lipwright.errors import LipwrightError
from lipwright.language import get_language
from lipwright.phones import BILABIALS, PHONES
from lipwright.speech import align
from lipwright.speech.voices import Voice, find_voice, read_script
from lipwright.track import PhoneTrack

SENTENCES = Path(__file__).parents[1] / "examples" / "sentences.txt"
RATE: Final = 16000  # Hz
HOP: Final = 16  # samples, 1 ms
WINDOW: Final = 160  # samples, 10 ms
NEAR: Final = 60  # ms on both sides of an edge
# Hz: closures and bilabials are seen where vowels have their first formants and above, fricatives
# where nothing else is loud, vowels at their first formant.
MOUTH, HISS, VOWEL = (500, 8000), (3500, 8000), (200, 1200)
SMOOTH: Final = 10  # ms
WEAKER: Final = 4.0  # dB; m through the nose is the loudest of p b m
# Phones of dictionaries that differ by nothing that either could time.
SAME: Final = {"AX": "AH", "IX": "IH", "AXR": "ER", "DX": "T"}
Curve = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Said:
    """One sentence."""

    audio: Audio
    """at RATE"""
    track: PhoneTrack
    text: str


def band_level(audio: Audio, low: int, high: int) -> Curve:
    """(T,), dB of the power from `low` to `high` Hz, one value a ms, smoothed."""
    padded = np.pad(audio.samples.astype(np.float64), WINDOW // 2)
    frames = np.lib.stride_tricks.sliding_window_view(padded, WINDOW)[::HOP]
    power = np.abs(np.fft.rfft(frames * np.hanning(WINDOW), axis=1)) ** 2
    hertz = np.fft.rfftfreq(WINDOW, 1 / RATE)
    band = power[:, (hertz >= low) & (hertz < high)].sum(axis=1)
    level = 10 * np.log10(band + 1e-7 * band.max() + 1e-20)
    return np.convolve(level, np.ones(SMOOTH) / SMOOTH, "same")


def steepest(level: Curve, at: float, sign: int) -> float | None:
    """When the level changes most near `at` s, up (sign 1) or down (-1); None if hardly."""
    first, stop = max(round(at * 1000) - NEAR, 0), round(at * 1000) + NEAR
    slope = sign * np.diff(level[first:stop])
    if not len(slope) or slope.max() < 0.5:  # dB a ms
        return None
    return (first + int(np.argmax(slope)) + 0.5) / 1000


def edge_kind(  # noqa: PLR0911  # a table in the shape of tests
    before: str, after: str
) -> tuple[str, tuple[int, int], int] | None:
    """What the detector can find where two phones meet: its name, band and direction."""
    one, other = PHONES[before], PHONES[after]
    if other.manner == "stop" and (one.is_vowel or one.manner == "approximant"):
        return ("closure, " + ("lips" if other.place == "bilabial" else "tongue"), MOUTH, -1)
    if other.manner == "nasal" and one.is_vowel:
        return "nasal", MOUTH, -1
    if after in ("S", "SH", "Z", "XS", "XC") and (one.is_vowel or one.manner == "nasal"):
        return "fricative", HISS, 1
    unvoiced = one.is_consonant and not one.voiced
    if other.is_vowel and unvoiced and one.manner in ("fricative", "affricate", "stop"):
        return "vowel after " + ("burst" if one.manner == "stop" else "hiss"), VOWEL, 1
    if one.manner == "stop" and one.place == "bilabial" and other.is_vowel:
        return "lips open", MOUTH, 1
    if one.is_silence and not other.is_silence and other.manner not in ("stop", "affricate"):
        return "after silence", VOWEL if other.voiced else HISS, 1
    return None  # nothing that the power of one band tells


def by_sound(said: Said) -> Iterator[tuple[str, float]]:
    """Kind and lateness (ms) of the edges that the detector finds."""
    levels = {band: band_level(said.audio, *band) for band in (MOUTH, HISS, VOWEL)}
    for index in range(1, len(said.track)):
        kind = edge_kind(*said.track.phones[index - 1 : index + 1])
        if kind is None:
            continue
        edge = float(said.track.edges[index])
        found = steepest(levels[kind[1]], edge, kind[2])
        if found is not None:
            yield kind[0], 1000 * (edge - found)


def by_aligner(said: Said, language: str) -> Iterator[tuple[str, float]]:
    """Kind and lateness (ms) against the aligner, where both have the same phones."""
    words = get_language(language).normalize(said.text)
    reference = align(said.audio, words, language).track
    one, other = ([SAME.get(phone, phone) for phone in track.phones]
                  for track in (reference, said.track))  # fmt: skip
    for block in SequenceMatcher(a=one, b=other, autojunk=False).get_matching_blocks():
        for step in range(1, block.size):
            here = block.b + step
            kind = edge_kind(*said.track.phones[here - 1 : here + 1])
            late = said.track.edges[here] - reference.edges[block.a + step]
            yield kind[0] if kind else "other", 1000 * float(late)


def closures(said: Said) -> Iterator[bool]:
    """Whether the sound is weak in each p, b and m beside the vowels around it."""
    level = band_level(said.audio, *MOUTH)
    medians = [np.median(level[round(start * 1000) : round(end * 1000)])
               for _, start, end in said.track]  # fmt: skip
    for index, phone in enumerate(said.track.phones):
        beside = [medians[place] for place in (index - 1, index + 1)
                  if phone in BILABIALS and PHONES[said.track.phones[place]].is_vowel]  # fmt: skip
        if beside:
            yield bool(medians[index] <= min(beside) - WEAKER)


def say_all(voice: Voice, texts: Sequence[str]) -> list[Said]:
    """Every text in the voice."""
    found = []
    for text in texts:
        utterance = voice.speak(read_script(text))
        if utterance.track is None:
            raise LipwrightError(f"{voice.info.name} tells no times")
        found.append(Said(resampled(utterance.audio, RATE), utterance.track, utterance.text))
    return found


def print_rows(title: str, rows: Sequence[tuple[str, float]]) -> None:
    """Median, spread and count of each kind, and of all."""
    print(f"{title:22} {'median':>7} {'spread':>7} {'90 % of |x|':>12} {'n':>5}   (ms, late is +)")
    kinds = sorted({kind for kind, _ in rows})
    for kind in (*kinds, "all"):
        values = np.array([value for name, value in rows if kind in (name, "all")])
        middle = np.median(values)
        spread = np.median(np.abs(values - middle))
        most = np.percentile(np.abs(values), 90)
        print(f"  {kind:20} {middle:7.1f} {spread:7.1f} {most:12.1f} {len(values):5d}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--voice", default="hibari")
    parser.add_argument("--text", type=Path, default=SENTENCES, help="a sentence a line")
    parser.add_argument("--no-aligner", action="store_true")
    options = parser.parse_args()
    lines = options.text.read_text("utf-8").splitlines()
    texts = [line.rpartition("\t")[2].strip() for line in lines if line.strip()]
    voice = find_voice(options.voice)
    said = say_all(voice, texts)
    seconds = sum(one.audio.duration for one in said)
    shut = [ok for one in said for ok in closures(one)]
    print(f"{voice.info.name}: {len(said)} sentences, {seconds:.0f} s")
    print_rows("by the sound", [row for one in said for row in by_sound(one)])
    if not options.no_aligner:
        language = voice.info.language or "en"
        print_rows("by the aligner", [row for one in said for row in by_aligner(one, language)])
    print(f"p b m: {sum(shut)} of {len(shut)} where the sound is shut")


if __name__ == "__main__":
    main()
