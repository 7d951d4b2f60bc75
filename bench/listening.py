"""How well phones are recognised without words, and what other sounds do to the mouth.

    python bench/listening.py                    # all tables
    python bench/listening.py --first 10         # fewer sentences of each kind
    python bench/listening.py --json figures.json

Speech: the GRID test sentences as recorded and in the other voices of bench/voices.py, four hand-
labelled sentences of an Australian speaker, and twenty sentences of the voice of hibari, against
phones that were aligned with the words. Then some of them with noise and music under them, through
a telephone, clipped, loud and quiet. Then sounds in which nobody speaks: what counts is how often
a mouth would shut. Lips are bench/lips.py's: `python bench/lips.py --listen`.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from grid import CORPORA, sentences
from lipwright.audio import Audio, read_audio, resampled
from lipwright.errors import LipwrightError
from lipwright.files import write_whole
from lipwright.language import get_language
from lipwright.phones import BILABIALS, SILENCE
from lipwright.speech import align
from lipwright.speech.listening import listen
from lipwright.track import PhoneTrack
from other_sounds import OTHER_SOUNDS, RATE, Samples, drums, music, pink_noise
from phone_errors import PhoneErrors
from voices import VOICES, shifted_file

# The first twelve of the Harvard sentences (IEEE 1969, list 1), and eight full of p, b and m.
SPOKEN = (
    "The birch canoe slid on the smooth planks.",
    "Glue the sheet to the dark blue background.",
    "It's easy to tell the depth of a well.",
    "These days a chicken leg is a rare dish.",
    "Rice is often served in round bowls.",
    "The juice of lemons makes fine punch.",
    "The box was thrown beside the parked truck.",
    "The hogs were fed chopped corn and garbage.",
    "Four hours of steady work faced us.",
    "A large size in stockings is hard to sell.",
    "The boy was there when the sun rose.",
    "A rod is used to catch pink salmon.",
    "The source of the huge river is the clear spring.",
    "Kick the ball straight and follow through.",
    "Help the woman get back to her feet.",
    "My brother bought a cheap computer from the market.",
    "Maybe we should move before somebody complains about the problem.",
    "Please put the paper cup back on the table by the window.",
    "I have never been able to understand why people behave like that.",
    "Pamela, would you bring me a bag of apples and some bread?",
)


@dataclass(frozen=True, eq=False)
class Spoken:
    """Speech whose phones are known."""

    sound: Audio
    track: PhoneTrack


def grid(voice: str | None, first: int) -> list[Spoken]:
    """Test sentences of GRID, in another voice."""
    chosen = sentences("test")[:first]
    files = [s.audio if voice is None else shifted_file(s, voice) for s in chosen]
    return [Spoken(at_rate(read_audio(f)), s.track) for s, f in zip(chosen, files, strict=True)]


def labelled() -> list[Spoken]:
    """The Australian speaker; phones by our aligner, whose errors bench/alignment.py has."""
    found = []
    for path in sorted((CORPORA / "aligned-phones").glob("*.flac")):
        found.append(aligned(at_rate(read_audio(path)), path.with_suffix(".txt").read_text()))
    return found


def hibari(first: int) -> list[Spoken]:
    """A voice of today's text-to-speech."""
    from hibari import SAMPLE_RATE, Hibari

    voice = Hibari()
    made = []
    for text in SPOKEN[:first]:
        samples = np.pad(np.asarray(voice(text), np.float32).ravel(), SAMPLE_RATE // 4)
        made.append(aligned(at_rate(Audio(samples, SAMPLE_RATE)), text))
    return made


def aligned(sound: Audio, text: str) -> Spoken:
    """The sound with the phones of its words."""
    words = get_language("en").normalize(text, "text", None)
    return Spoken(sound, align(sound, words).track)


def at_rate(sound: Audio) -> Audio:
    """The sound at 16 kHz."""
    return sound if sound.rate == RATE else resampled(sound, RATE)


def under(other: Samples, ratio: float) -> Callable[[Samples], Samples]:
    """Mix `other` under speech, `ratio` dB lower."""

    def mix(speech: Samples) -> Samples:
        bed = np.resize(other, len(speech))
        gain = np.sqrt(np.mean(speech**2) / np.mean(bed**2) / 10 ** (ratio / 10))
        return speech + gain * bed

    return mix


def telephone(speech: Samples) -> Samples:
    """300 to 3400 Hz."""
    from scipy.signal import butter, sosfilt

    band = butter(4, (300, 3400), "bandpass", fs=RATE, output="sos")
    return np.asarray(sosfilt(band, speech))


def peak(speech: Samples, loudest: float) -> Samples:
    """The same at another loudness; what is over full scale is clipped."""
    return np.clip(speech * loudest / np.abs(speech).max(), -1, 1)


def conditions() -> dict[str, Callable[[Samples], Samples]]:
    """What may be wrong with a recording."""
    noise, tune, loop = pink_noise(12), music(12), drums(12)
    return {
        "as recorded": lambda x: x,
        **{f"music {r} dB lower": under(tune, r) for r in (20, 10, 5, 0)},
        "drums 5 dB lower": under(loop, 5),
        **{f"pink noise {r} dB lower": under(noise, r) for r in (20, 10, 0)},
        "telephone": telephone,
        "clipped, 26 dB too loud": lambda x: peak(x, 20.0),
        "peak -50 dB": lambda x: peak(x, 0.003),
    }


@dataclass(frozen=True)
class Row:
    """What some recordings gave."""

    errors: PhoneErrors
    confidence: float
    speed: float
    """times real time"""
    failed: int
    """recordings in which nothing was recognised"""

    def __str__(self) -> str:
        """One line."""
        return (
            f"{self.errors}; confidence {self.confidence:.2f}, {self.speed:.0f} times real time, "
            f"{self.failed} without phones"
        )


def measure(spoken: list[Spoken], change: Callable[[Samples], Samples] = lambda x: x) -> Row:
    """Recognise all."""
    errors, sure, failed, took = PhoneErrors(), [], 0, 0.0
    for one in spoken:
        sound = Audio(np.clip(change(one.sound.samples), -1, 1).astype(np.float32), RATE)
        start = time.perf_counter()
        try:
            heard = listen(sound)
            sure.append(heard.confidence)
            track: PhoneTrack | None = heard.alignment.track
        except LipwrightError:
            track, failed = None, failed + 1
        took += time.perf_counter() - start
        errors.add(one.track, track)
    seconds = sum(one.sound.duration for one in spoken)
    return Row(errors, float(np.mean(sure)) if sure else 0.0, seconds / took, failed)


def other(samples: Samples) -> str:
    """What a sound without speech gives."""
    sound = Audio(samples.astype(np.float32), RATE)
    try:
        track = listen(sound).alignment.track
    except LipwrightError:
        return "nothing"
    said = [p for p in track.phones if p != SILENCE]
    shut = sum(p in BILABIALS for p in said)
    return f"{len(said) / sound.duration:.1f} phones a second, {shut} closures: {' '.join(said)}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--first", type=int, default=50, help="sentences of each kind, at most")
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    options = parser.parse_args()
    plain, voice = grid(None, options.first), hibari(options.first)
    speakers = {"GRID speaker 1": plain, "Australian": labelled(), "hibari": voice}
    speakers |= {f"GRID, {name}": grid(name, min(options.first, 15)) for name in VOICES}
    rows = {name: measure(spoken) for name, spoken in speakers.items()}
    some = [*plain[:12], *voice[:12], *speakers["Australian"]]
    rows |= {name: measure(some, change) for name, change in conditions().items()}
    for name, row in rows.items():
        print(f"{name}: {row}")
    print("by class:")
    for name, (count, share) in sorted(rows["GRID speaker 1"].errors.by_class().items()):
        print(f"  {name:12} {count:5} phones, {share:.3f} wrong")
    for name, make in OTHER_SOUNDS.items():
        print(f"{name}: {other(make(5.0))}")
    if options.json:
        figures = {
            name: {"rate": row.errors.rate(), "bilabials": row.errors.bilabials(),
                   "confidence": row.confidence, "speed": row.speed, "failed": row.failed}
            for name, row in rows.items()
        }  # fmt: skip
        with write_whole(options.json) as part:
            part.write_text(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main()
