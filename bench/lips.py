"""How well animated lips follow the real lips of GRID speaker 1, on two heads.

    python bench/lips.py                    # the 50 test sentences, our engines and two peers
    python bench/lips.py --model MODEL      # the engine window with this model beside them
    python bench/lips.py --engines window:MODEL bigram:SET
    python bench/lips.py --split all        # all 880 sentences; closures and failures
    python bench/lips.py --fresh            # align anew instead of using kept phones
    python bench/lips.py --listen           # from the sound alone: no words are given

Every sentence is aligned, animated by each engine from the same phone times and the sound, posed on
each head, and its aperture compared with the tracked lips of the video (`lipwright.evaluate.lips`
defines the figures). With `--listen` its phones are recognised, and the aligned ones only say where
speech is and lips close. The peers are OpenFaceFX, and `smartbody`: the bigram set that animators
drew for SmartBody, played by our engine. Needs the extra `bench` and `lipwright head install`.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from pathlib import Path

from grid import CORPORA, Sentence, sentences
from heads import Ruler, rulers
from lipwright.audio import open_audio
from lipwright.benchmark.peers import PEERS, animate_peer
from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.evaluate.lips import Aperture, LipScore, evaluate, pool
from lipwright.files import write_whole
from lipwright.pipeline import ALIGNMENT_RATE
from lipwright.track import PhoneTrack
from phone_errors import PhoneErrors

FPS = 60.0

Animator = Callable[[PhoneTrack, Path | None], Clip]
"""phones and the file of their sound to motion"""


def ours(engine: str, model: str | None = None) -> Animator:
    """One of our engines, with the sound and the passes that `lipwright animate` gives it."""
    from lipwright.pipeline import AnimateOptions, animate_track

    options = AnimateOptions(engine=engine, model=model, fps=FPS)

    def animate(track: PhoneTrack, audio: Path | None = None) -> Clip:
        if audio is None:
            return animate_track(track, options)
        with open_audio(audio, ALIGNMENT_RATE) as sound:
            return animate_track(track, options, sound)

    return animate


def peer(name: str) -> Animator:
    """A program of others, from the same phone times."""
    return lambda track, audio=None: animate_peer(name, track, FPS)


SMARTBODY = Path("smartbody-bigrams") / "default.json"


def animator(name: str, corpora: Path) -> Animator:
    """An engine or a peer by name; `window:MODEL` and `bigram:SET` say what the engine runs."""
    if name in PEERS:
        return peer(name)
    if name == "smartbody":
        return ours("bigram", str(corpora / SMARTBODY))
    engine, _, model = name.partition(":")
    return ours(engine, model or None)


def hear(sentence: Sentence) -> PhoneTrack:
    """The phones of a sentence without its words."""
    from lipwright.speech.listening import listen

    with open_audio(sentence.audio, ALIGNMENT_RATE) as sound:
        return listen(sound).alignment.track


def phones_of(
    chosen: list[Sentence], fresh: bool, listen: bool
) -> tuple[dict[str, PhoneTrack], list[str]]:
    """Phones by the sentence's name, and what went wrong with those that have none."""
    failures: list[str] = []
    tracks: dict[str, PhoneTrack] = {}
    for sentence in chosen:
        try:
            if listen:
                tracks[sentence.name] = hear(sentence)
            else:
                tracks[sentence.name] = sentence.align() if fresh else sentence.track
        except LipwrightError as error:
            failures.append(f"{sentence.name}: {error}")
    return tracks, failures


def score(
    sentence: Sentence, track: PhoneTrack, clip: Clip, heads: dict[str, Ruler]
) -> dict[str, LipScore]:
    """Head to figures."""
    reference = sentence.aperture
    return {
        head: evaluate(reference, Aperture(clip.times, measure(clip)), track)
        for head, measure in heads.items()
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--split", default="test", choices=["all", "test", "validation", "train", "unseen"]
    )
    parser.add_argument("--first", type=int, help="only the first N sentences of the split")
    parser.add_argument(
        "--engines",
        nargs="+",
        default=["window", "bigram", "dominance", "openfacefx", "smartbody"],
    )
    parser.add_argument("--model", help="also the engine window with this model")
    parser.add_argument(
        "--without-sound", action="store_true", help="animate from the phones alone"
    )
    parser.add_argument("--corpora", type=Path, default=CORPORA)
    parser.add_argument("--fresh", action="store_true", help="align anew; count failures")
    parser.add_argument("--listen", action="store_true", help="from the sound alone")
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    options = parser.parse_args()
    if options.model is not None:
        options.engines.append(f"window:{options.model}")
    heads = rulers(options.corpora)
    chosen = sentences(options.split, options.corpora)[: options.first]
    tracks, failures = phones_of(chosen, options.fresh, options.listen)
    figures: dict[str, dict[str, dict[str, float]]] = {}
    for engine in options.engines:
        animate = animator(engine, options.corpora)
        scores: dict[str, list[LipScore]] = {head: [] for head in heads}
        for sentence in chosen:
            if sentence.name in tracks:
                track = tracks[sentence.name]
                clip = animate(track, None if options.without_sound else sentence.audio)
                reference = sentence.track if options.listen else track
                for head, value in score(sentence, reference, clip, heads).items():
                    scores[head].append(value)
        figures[engine] = {head: pool(values) for head, values in scores.items()}
    verb = "hear" if options.listen else "align"
    print(f"{len(chosen)} sentences ({options.split}), {len(failures)} failed to {verb}")
    if options.listen:
        print(PhoneErrors.of((s.track, tracks[s.name]) for s in chosen if s.name in tracks))
    for line in failures:
        print("  " + line)
    head_line = ("r", "r_median", "r_best_lag", "lag_ms", "closures", "closures_real",
                 "false_closures_per_s", "mistimed_closures_per_s", "silence")  # fmt: skip
    width = max(map(len, ("engine", *figures)))
    print(f"{'engine':{width}} {'head':11}", *(f"{name[:14]:>14}" for name in head_line))
    for engine, by_head in figures.items():
        for head, row in by_head.items():
            print(f"{engine:{width}} {head:11}", *(f"{row[name]:14.3f}" for name in head_line))
    if options.json:
        with write_whole(options.json) as part:
            part.write_text(json.dumps({"failures": failures, "figures": figures}, indent=1))
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
