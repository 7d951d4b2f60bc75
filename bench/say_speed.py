"""How fast text becomes a moving face: cold, as a new process, and warm, in one that is ready.

    python bench/say_speed.py                       # hibari and espeak, 5 cold runs each
    python bench/say_speed.py --voices hibari --cold 9

Cold: the whole command `lipwright say TEXT -o x.csv`, interpreter included, best and median.
Warm: text to curves by `lipwright.pipeline.say`, in seconds of speech a second, and where the time
goes; the best of three, since other work on the machine only makes it slower.
"""

from __future__ import annotations

import argparse
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Final

from lipwright.engines import get_engine  # noqa: F401  # loaded before the clock runs
from lipwright.errors import LipwrightError
from lipwright.pipeline import SayOptions, say
from lipwright.speech.voices import find_voice, read_script

SENTENCE: Final = "Maybe Bob and Pam will come by at seven tomorrow."
PARAGRAPH: Final = Path(__file__).parents[1] / "examples" / "sentences.txt"
RUNS: Final = 3


def cold(voice: str, runs: int) -> tuple[list[float], list[float]]:
    """Seconds of each run of the command, by the clock and of a processor."""
    found, busy = [], []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(runs):
            started, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run(
                [sys.executable, "-m", "lipwright", "say", SENTENCE, "--voice", voice,
                 "-o", f"{folder}/x.csv"], check=True, capture_output=True,
            )  # fmt: skip
            found.append(time.perf_counter() - started)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            busy.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return found, busy


def warm(voice: str, text: str) -> tuple[float, float, float]:
    """Seconds of speech, of the whole way, and of the voice alone."""
    speaker = find_voice(voice)
    script = read_script(text)
    options = SayOptions(voice)
    say(SENTENCE, voice=options)
    alls, voices, length = [], [], 0.0
    for _ in range(RUNS):
        started = time.perf_counter()
        length = speaker.speak(script).audio.duration
        voices.append(time.perf_counter() - started)
        started = time.perf_counter()
        say(text, voice=options)
        alls.append(time.perf_counter() - started)
    return length, min(alls), min(voices)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--voices", nargs="+", default=["hibari", "espeak:en-us"])
    parser.add_argument("--cold", type=int, default=5, help="runs of the command")
    options = parser.parse_args()
    lines = PARAGRAPH.read_text("utf-8").splitlines()
    text = " ".join(line.rpartition("\t")[2].strip() for line in lines)
    for voice in options.voices:
        try:
            if options.cold:
                times, busy = cold(voice, options.cold)
                print(f"{voice}: cold {min(times):.2f} s best, {statistics.median(times):.2f} s "
                      f"median; {min(busy):.2f} s of a processor")  # fmt: skip
            length, whole, spoken = warm(voice, text)
        except LipwrightError as error:
            print(f"{voice}: {error}")
            continue
        print(f"{voice}: warm {length / whole:.0f} times real time from text to curves "
              f"({length:.0f} s of speech in {whole:.2f} s); the voice alone "
              f"{length / spoken:.0f}")  # fmt: skip


if __name__ == "__main__":
    main()
