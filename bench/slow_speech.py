"""What becomes of songs and slowed speech: words kept, edges, and mouths in vowels that are held.

    python bench/slow_speech.py                    # needs pyworld-prebuilt and the extra espeak
    python bench/slow_speech.py --only sung --markdown table.md

Speech whose phone times are known is stretched two and three times by the vocoder WORLD, said at
half speed by hibari and at its slowest by espeak-ng, and sung: each vowel becomes a note of 0.25 to
5 s with vibrato, which holds the sound of the vowel at 40 % of its length. Times move along, and
the truth with them. Each is aligned with its words and, if it is English, heard without them.

An edge error is the found start of a phone minus the true one. In vowels that last 0.8 s or more,
without 0.1 s at both ends: "open" is the share of the time in which the track has a vowel, "rest"
in which it has silence; "shut" counts p, b and m; "phones" is how many are found in one.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from alignment import Labelled, match_phones
from grid import sentences
from language_timing import TEXTS
from lipwright.audio import Audio, read_audio, resampled
from lipwright.errors import LipwrightError
from lipwright.files import write_whole
from lipwright.language import get_language
from lipwright.phones import BILABIALS, PHONES, SILENCE
from lipwright.speech import align
from lipwright.speech.listening import listen
from lipwright.speech.voices.espeak import EspeakBackEnd
from lipwright.speech.voices.hibari import HibariBackEnd
from lipwright.speech.voices.values import Piece
from lipwright.track import PhoneTrack
from phone_errors import PhoneErrors
from voices import world

Floats = npt.NDArray[np.float64]

RATE = 16000  # Hz
FRAME = 0.005  # s, of WORLD
HOLDS = (0.25, 1.0, 0.4, 2.0, 0.3, 3.0, 0.5, 5.0)  # s, one vowel after the other
NOTES = (0, 2, 4, 7, 9, 7, 4, 2)  # semitones above the singer's lowest note
VIBRATO_RATE, VIBRATO_DEPTH, VIBRATO_DELAY = 5.5, 0.4, 0.3  # Hz, semitones, s
HELD = 0.8  # s, the shortest vowel that counts as held
MARGIN = 0.1  # s at both ends of it
CLOSE = 0.08  # s, how far a closure may be off
LEAST_ESPEAK = 0.46  # of its usual rate: 80 words a minute
N_SENTENCES = 6


@dataclass(frozen=True, eq=False)
class Known:
    """Speech with its words and phones."""

    audio: Audio
    track: PhoneTrack
    text: str
    language: str = "en"


def stretched(known: Known, knots: Floats, moved: Floats, tune: bool = False) -> Known:
    """The same with the times `knots` moved to `moved`, as it was spoken or sung to a tune."""
    vocoder = world()
    samples = np.ascontiguousarray(known.audio.samples, np.float64)
    f0, times = vocoder.harvest(samples, RATE)
    envelope = vocoder.cheaptrick(samples, f0, times, RATE)
    aperiodicity = vocoder.d4c(samples, f0, times, RATE)
    target = np.arange(0, moved[-1], FRAME)
    rows = np.clip(np.round(np.interp(target, moved, knots) / FRAME), 0, len(f0) - 1).astype(int)
    edges = np.interp(known.track.edges, knots, moved)
    track = PhoneTrack(known.track.phones, edges)
    pitch = np.ascontiguousarray(f0[rows])
    if tune:
        pitch = sung_pitch(target, pitch, track)
    made = vocoder.synthesize(
        pitch, np.ascontiguousarray(envelope[rows]), np.ascontiguousarray(aperiodicity[rows]), RATE
    )
    made = np.pad(made, (0, max(round(track.end * RATE) - len(made), 0)))[: round(track.end * RATE)]
    made *= 0.9 / np.abs(made).max()
    return Known(Audio(made.astype(np.float32), RATE), track, known.text, known.language)


def slowed(known: Known, factor: float) -> Known:
    """All of it `factor` times as long."""
    knots = np.array([0.0, known.track.end])
    return stretched(known, knots, factor * knots)


def sung(known: Known) -> Known:
    """Each vowel a note."""
    knots, moved, number = [0.0], [0.0], 0
    for phone, start, end in known.track:
        hold = 0.0
        if PHONES[phone].is_vowel:
            hold = max(HOLDS[number % len(HOLDS)] - (end - start), 0.0)
            number += 1
        middle = np.array([0.35, 0.45]) * (end - start)
        for time, extra in ((start + middle[0], 0.0), (start + middle[1], hold), (end, 0.0)):
            moved.append(moved[-1] + time - knots[-1] + extra)
            knots.append(time)
    return stretched(known, np.array(knots), np.array(moved), tune=True)


def sung_pitch(times: Floats, spoken: Floats, track: PhoneTrack) -> Floats:
    """The melody in Hz where there is voice, else 0."""
    lowest = float(np.median(spoken[spoken > 0])) * 0.9
    notes, voiced, since, number = np.zeros(len(times)), spoken > 0, np.zeros(len(times)), 0
    for phone, start, end in track:
        if PHONES[phone].is_vowel:
            number += 1
            here = (times >= start) & (times < end)
            voiced |= here
            since[here] = times[here] - start
        notes[times >= start] = NOTES[(number - 1) % len(NOTES)]
    glide = np.ones(13) / 13
    notes = np.convolve(np.pad(notes, 6, "edge"), glide, "valid")
    depth = VIBRATO_DEPTH * np.clip((since - VIBRATO_DELAY) / 0.3, 0, 1)
    notes += depth * np.sin(2 * np.pi * VIBRATO_RATE * times)
    return np.where(voiced, lowest * 2 ** (notes / 12), 0.0)


def at_rate(audio: Audio) -> Audio:
    """The sound at 16 kHz."""
    return audio if audio.rate == RATE else resampled(audio, RATE)


def grid() -> list[Known]:
    """Sentences of a person."""
    return [
        Known(at_rate(read_audio(s.audio)), s.track, s.text)
        for s in sentences("test")[:N_SENTENCES]
    ]


def voice(language: str, rate: float = 1.0) -> list[Known]:
    """Sentences by a voice that tells its phone times: hibari, or espeak-ng for what it lacks."""
    speaker = (HibariBackEnd() if language == "en" else EspeakBackEnd()).open(
        "" if language == "en" else language, None
    )
    return [by(speaker.speak, text, language, rate) for text in TEXTS[language][:N_SENTENCES]]


def espeak(language: str, rate: float) -> list[Known]:
    """Sentences by espeak-ng."""
    speak = EspeakBackEnd().open("en-us" if language == "en" else language, None).speak
    return [by(speak, text, language, rate) for text in TEXTS[language][:N_SENTENCES]]


def by(speak: Callable, text: str, language: str, rate: float) -> Known:
    """A sentence as a voice says it."""
    said = speak((Piece(text, rate=rate),))
    audio = at_rate(said.audio)
    return Known(audio, said.track.padded(0.0, audio.duration), text, language)


def conditions() -> dict[str, Callable[[], list[Known]]]:
    """Name to recordings."""
    return {
        "GRID as recorded": grid,
        "GRID, 2 times as slow": lambda: [slowed(k, 2.0) for k in grid()],
        "GRID, 3 times as slow": lambda: [slowed(k, 3.0) for k in grid()],
        "hibari": lambda: voice("en"),
        "hibari at rate 0.5": lambda: voice("en", 0.5),
        "hibari, 2 times as slow": lambda: [slowed(k, 2.0) for k in voice("en")],
        "hibari, 3 times as slow": lambda: [slowed(k, 3.0) for k in voice("en")],
        **{
            f"espeak-ng {code} at its slowest": lambda code=code: espeak(code, LEAST_ESPEAK)
            for code in ("en", "sv", "cmn", "de")
        },
        **{
            f"espeak-ng {code} 3 times as slow": lambda code=code: [
                slowed(k, 3.0) for k in espeak(code, 1.0)
            ]
            for code in ("en", "sv", "cmn", "de")
        },
        "GRID sung": lambda: [sung(k) for k in grid()],
        "hibari sung": lambda: [sung(k) for k in voice("en")],
        **{
            f"espeak-ng {code} sung": lambda code=code: [sung(k) for k in espeak(code, 1.0)]
            for code in ("en", "sv", "cmn", "de")
        },
    }


@dataclass
class InHeld:
    """What a track does while vowels are held."""

    seconds: float = 0.0
    open: float = 0.0
    """s with a vowel"""
    rest: float = 0.0
    """s of silence"""
    shut: int = 0
    """p, b and m"""
    vowels: int = 0
    """that are held"""
    phones: int = 0
    """found in them"""

    def add(self, reference: PhoneTrack, estimated: PhoneTrack) -> None:
        """One more recording."""
        for phone, start, end in reference:
            if not PHONES[phone].is_vowel or end - start < HELD:
                continue
            low, high = start + MARGIN, end - MARGIN
            self.vowels += 1
            self.seconds += high - low
            for found, first, last in estimated:
                inside = min(last, high) - max(first, low)
                if inside <= 0:
                    continue
                self.phones += 1
                self.open += inside * PHONES[found].is_vowel
                self.rest += inside * (found == SILENCE)
                self.shut += found in BILABIALS

    def cells(self) -> list[str]:
        """Of the table."""
        if not self.vowels:
            return ["0", "", "", "", ""]
        return [
            f"{self.vowels}", f"{100 * self.open / self.seconds:.0f} %",
            f"{100 * self.rest / self.seconds:.0f} %", f"{self.shut}",
            f"{self.phones / self.vowels:.1f}",
        ]  # fmt: skip


@dataclass
class Aligned:
    """What forced alignment gave."""

    errors: list[float] = field(default_factory=list)
    words: int = 0
    misfits: int = 0
    refused: int = 0
    closures: int = 0
    closed: int = 0
    held: InHeld = field(default_factory=InHeld)

    def add(self, known: Known, name: str) -> None:
        """One more recording."""
        words = get_language(known.language).normalize(known.text)
        self.words += len(words)
        try:
            alignment = align(known.audio, words, known.language)
        except LipwrightError as error:
            self.refused += 1
            print(f"{name}: {error}")
            return
        self.misfits += len(alignment.misfits)
        if alignment.misfits:
            print(f"{name}: {[m.written for m in alignment.misfits]} of {known.text}")
        track = alignment.track
        match = match_phones(labelled(known.track), labelled(track))
        self.errors += match.errors.tolist()
        shut = [(start, end) for phone, start, end in track if phone in BILABIALS]
        for phone, start, end in known.track:
            if phone in BILABIALS:
                self.closures += 1
                self.closed += any(s < end + CLOSE and e > start - CLOSE for s, e in shut)
        self.held.add(known.track, track)

    def cells(self) -> list[str]:
        """Of the table."""
        sizes = 1000 * np.abs(self.errors) if self.errors else np.array([np.nan])
        return [
            f"{self.misfits} of {self.words}", f"{self.refused}", f"{np.median(sizes):.0f}",
            f"{np.quantile(sizes, 0.9):.0f}", f"{self.closed} of {self.closures}",
            *self.held.cells(),
        ]  # fmt: skip


def labelled(track: PhoneTrack) -> list[Labelled]:
    """What is said."""
    return [Labelled(phone, start) for phone, start, _ in track if phone != SILENCE]


@dataclass
class Listened:
    """What was heard without words."""

    errors: PhoneErrors = field(default_factory=PhoneErrors)
    confidence: list[float] = field(default_factory=list)
    silent: int = 0
    noted: int = 0
    held: InHeld = field(default_factory=InHeld)

    def add(self, known: Known) -> None:
        """One more recording."""
        try:
            heard = listen(known.audio, known.language)
        except LipwrightError:
            self.silent += 1
            self.errors.add(known.track, None)
            return
        self.confidence.append(heard.confidence)
        self.noted += any("likely to be right" in note for note in heard.notes)
        self.errors.add(known.track, heard.alignment.track)
        self.held.add(known.track, heard.alignment.track)

    def cells(self) -> list[str]:
        """Of the table."""
        recall, precision = self.errors.bilabials()
        sure = np.mean(self.confidence) if self.confidence else np.nan
        return [
            f"{sum(self.errors.rate()):.2f}", f"{sure:.2f}", f"{self.noted}", f"{self.silent}",
            f"{recall:.2f}", f"{precision:.2f}", *self.held.cells(),
        ]  # fmt: skip


_HELD_COLUMNS = ("held vowels", "open", "rest", "shut", "phones")
ALIGNED = ("words that do not fit", "refused", "median, ms", "90th percentile, ms", "closures")
LISTENED = ("phone error rate", "confidence", "with a note", "nothing heard",
            "closures found", "closures right")  # fmt: skip


def table(columns: tuple[str, ...], rows: dict[str, list[str]]) -> str:
    """In Markdown."""
    head = ("speech", *columns, *_HELD_COLUMNS)
    lines = [f"| {' | '.join(head)} |", f"|{' --- |' * len(head)}"]
    lines += [f"| {name} | {' | '.join(cells)} |" for name, cells in rows.items()]
    return "\n".join(lines) + "\n"


def chosen(only: str) -> Iterator[tuple[str, list[Known]]]:
    """The recordings whose name has `only` in it."""
    for name, make in conditions().items():
        if only in name:
            yield name, make()


def main() -> None:
    """Measure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default="", help="part of the names of what is measured")
    parser.add_argument("--no-listening", action="store_true", help="align only")
    parser.add_argument("--markdown", type=Path, metavar="FILE", help="write the tables here")
    options = parser.parse_args()
    aligned, listened = {}, {}
    for name, recordings in chosen(options.only):
        one, other = Aligned(), Listened()
        for known in recordings:
            one.add(known, name)
            if known.language == "en" and not options.no_listening:
                other.add(known)
        aligned[name] = one.cells()
        print(name, *one.cells(), sep=" | ", flush=True)
        if known.language == "en" and not options.no_listening:
            listened[name] = other.cells()
            print(name, "heard", *other.cells(), sep=" | ", flush=True)
    text = table(ALIGNED, aligned) + "\n" + table(LISTENED, listened)
    print(text)
    if options.markdown:
        with write_whole(options.markdown) as part:
            part.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
