"""What life and expressions do to a recording, beside what was measured on people.

    python bench/life.py                    # examples/hello.flac, said again and again
    python bench/life.py --minutes 10 --seeds 5
    python bench/life.py --sheet docs/layers.png

Blinks: how many a minute, and the share of them that begin within half a second of a phrase's end,
beside the share of time that lies there. Head: standard deviations, fastest turn, share of the
motion's power under 2 Hz, and how its pitch goes with the loudness and the pitch of the voice.
Expressions: closures that stay, and r of the aperture with that of the speech alone, by engine.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from lipwright.audio import Audio, read_audio
from lipwright.clip import Clip
from lipwright.controls import CANONICAL, HEAD_ANGLES
from lipwright.evaluate.lips import CLOSED, CLOSURE_TOLERANCE, LOUD_PERCENTILE
from lipwright.expressions import EXPRESSIONS, load_expression
from lipwright.face.head import load_head
from lipwright.face.png import write_png
from lipwright.face.render import Renderer
from lipwright.face.shading import Camera
from lipwright.life import add_life, find_phrases, hear_voice, life
from lipwright.life.voice import STEP
from lipwright.passes import expression, speech_share
from lipwright.phones import BILABIALS
from lipwright.pipeline import AnimateOptions, animate
from lipwright.track import PhoneTrack

HELLO = Path(__file__).resolve().parents[1] / "examples" / "hello.flac"
RATE = 16000  # Hz
FPS = 60.0
SLOW = 2.0  # Hz
NEAR = 0.5  # s from the end of a phrase
ENGINES = ("dominance", "window", "bigram")


def repeated(track: PhoneTrack, sound: Audio, minutes: float) -> tuple[PhoneTrack, Audio]:
    """The track and its sound, said again and again for so long."""
    times = max(round(minutes * 60 / track.end), 1)
    edges = [track.edges[1:] + index * track.end for index in range(times)]
    long = PhoneTrack(track.phones * times, np.concatenate([track.edges[:1], *edges]))
    samples = sound.read(0, track.end).samples
    return long, Audio(np.tile(samples, times), sound.rate)


def measure(track: PhoneTrack, sound: Audio, seed: int) -> dict[str, float]:
    """The figures of one life."""
    began = time.process_time()
    living = life(track, sound, FPS, seed)
    seconds = time.process_time() - began
    voice = hear_voice(sound)
    lids = living.curve("eyeBlinkLeft")
    blinks = np.flatnonzero((lids[1:] > 0) & (lids[:-1] == 0)) / FPS
    ends = np.array([phrase.end for phrase in find_phrases(track)])
    degrees = np.degrees(living.select(HEAD_ANGLES).values.astype(np.float64))
    power = np.abs(np.fft.rfft(degrees - degrees.mean(axis=0), axis=0)) ** 2
    hertz = np.fft.rfftfreq(len(degrees), 1 / FPS)
    clock = (np.arange(len(voice.level)) + 0.5) * STEP
    pitch = np.interp(clock, living.times, degrees[:, 1])
    voiced = np.isfinite(voice.pitch)

    def near(times: np.ndarray) -> float:
        return float((np.abs(times[:, None] - ends).min(axis=1) < NEAR).mean())

    return {
        "blinks a minute": len(blinks) / track.end * 60,
        "blinks near phrase ends": near(blinks),
        "time near phrase ends": near(np.arange(0, track.end, 0.1)),
        "yaw, sd degrees": float(degrees[:, 0].std()),
        "pitch, sd degrees": float(degrees[:, 1].std()),
        "roll, sd degrees": float(degrees[:, 2].std()),
        "fastest, degrees a second": float(np.abs(np.diff(degrees, axis=0)).max() * FPS),
        f"power under {SLOW:g} Hz": float(power[hertz < SLOW].sum() / power.sum()),
        "r of head pitch and voice pitch": float(
            np.corrcoef(pitch[voiced], voice.pitch[voiced])[0, 1]
        ),
        "s of processor to make it": seconds,
    }


def closures(aperture: np.ndarray, clip: Clip, track: PhoneTrack) -> tuple[int, int]:
    """How many p b m are closed as evaluation judges them, and how many there are."""
    most = CLOSED * np.percentile(aperture, LOUD_PERCENTILE)
    near = [
        aperture[(clip.times >= a - CLOSURE_TOLERANCE) & (clip.times <= b + CLOSURE_TOLERANCE)]
        for phone, a, b in track
        if phone in BILABIALS
    ]
    return sum(bool(part.min() < most) for part in near), len(near)


def tell_expressions(engine: str) -> PhoneTrack:
    """Print what each expression leaves of an engine's speech; gives the track."""
    head = load_head()
    result = animate(
        HELLO, HELLO.with_suffix(".txt").read_text(), options=AnimateOptions(engine=engine)
    )
    speech, track = result.clip.select(CANONICAL), result.track
    inside = speech_share(track, speech.times) == 1
    before = head.aperture_curve(speech.values)
    for name in EXPRESSIONS:
        after = head.aperture_curve(expression(load_expression(name))(speech, track).values)
        shut, count = closures(after, speech, track)
        r = np.corrcoef(before[inside], after[inside])[0, 1]
        print(f"  {engine:10} {name:14} closures {shut}/{count}  r {r:.3f}")
    return track


SHOWN = ("happy", "sad", "angry", "surprised")
MOMENTS = (0.3, 1.925, 2.05, 2.91, 4.46, 7.9)  # s of hello.flac: rest, M, F, ER, AO, Y
LIVELY = (0.3, 1.15, 1.925, 3.43, 4.46, 7.9)  # s, of the row with life

SIDE = 200  # px
NEAR_BY = Camera((0.0, 0.05, 1.30), (0.0, 0.012, 0.02), 11.5)


def draw_sheet(path: Path) -> None:
    """Speech alone, under four expressions, and with life over a smile: a row each."""
    result = animate(HELLO, HELLO.with_suffix(".txt").read_text())
    speech, track = result.clip.select(CANONICAL), result.track
    rows = [(speech, MOMENTS)]
    rows += [(expression(load_expression(name))(speech, track), MOMENTS) for name in SHOWN]
    smile = expression(load_expression("happy"), 0.6)(speech, track)
    rows.append((add_life(smile, track, read_audio(HELLO, RATE), seed=1), LIVELY))
    with Renderer(load_head(), SIDE, SIDE, view=NEAR_BY) as renderer:
        write_png(path, np.vstack([pictures(renderer, clip, times) for clip, times in rows]))


def pictures(renderer: Renderer, clip: Clip, times: Sequence[float]) -> np.ndarray:
    """The clip at some times, side by side."""
    weights, turns = (clip.select(names).at(times) for names in (CANONICAL, HEAD_ANGLES))
    return np.hstack([renderer.render(*parts) for parts in zip(weights, turns, strict=True)])


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--minutes", type=float, default=10.0, help="how long it is said")
    parser.add_argument("--seeds", type=int, default=3, help="lives whose mean is told")
    parser.add_argument("--sheet", type=Path, help="draw pictures of the layers instead")
    choices = parser.parse_args()
    if choices.sheet is not None:
        draw_sheet(choices.sheet)
        return
    print("expressions")
    tracks = [tell_expressions(engine) for engine in ENGINES]
    track, sound = repeated(tracks[0], read_audio(HELLO, RATE), choices.minutes)
    rows = [measure(track, sound, seed) for seed in range(choices.seeds)]
    print(f"life, {track.end / 60:.1f} minutes, mean of {len(rows)} seeds")
    for name in rows[0]:
        print(f"  {name:34} {np.mean([row[name] for row in rows]):.3f}")


if __name__ == "__main__":
    main()
