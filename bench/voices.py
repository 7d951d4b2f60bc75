"""How well lips follow speakers that nobody trained on: a stand-in, and what it is worth.

    python bench/voices.py                          # the 50 test sentences, default engine
    python bench/voices.py --model MODEL --split test
    python bench/voices.py --half-names > half.txt  # what to hold out of training
    python bench/voices.py --model MODEL --half --first 50

The sound of each sentence gets another pitch and other formants at the same times, so that the
real lips of the video stay the measure. It is aligned anew, animated, and compared with the lips
as bench/lips.py does it, beside the sound as it was. The voice `resynthesised` is neither higher
nor lower: what it loses is the vocoder's fault. Phones of the sound as it was say where closures
are looked for, for every voice alike; "edges" is how far the phone starts of the shifted sound lie
from them (median, ms).

`--half` takes the sentences of the train split at odd places of the split's order; the model must
have been trained without them (docs/window-network.md). Needs `pip install pyworld-prebuilt`
and what bench/lips.py needs. Shifted sound is kept in bench/cache/voices.
"""

from __future__ import annotations

import argparse
import json
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from grid import CACHE, CORPORA, Sentence, sentences
from heads import Ruler, rulers
from lips import Animator, ours
from lipwright.audio import Audio, read_audio, write_flac
from lipwright.errors import LipwrightError
from lipwright.evaluate.lips import Aperture, LipScore, evaluate, pool
from lipwright.files import write_whole
from lipwright.pipeline import align_speech
from lipwright.track import PhoneTrack

LOUDEST = 0.99  # of full scale; a shifted voice must not clip


@dataclass(frozen=True)
class Voice:
    """How another speaker differs from the one that was recorded."""

    pitch: float
    """factor of the fundamental frequency"""
    formants: float
    """factor of the spectral envelope's frequencies: above 1 is a shorter vocal tract"""


# Speaker 1 is a man. Women's formants lie about 15 % above men's and children's about a third
# (Peterson and Barney 1952, table II); pitch about 1.7 and 2.0 times as high.
VOICES = {
    "resynthesised": Voice(1.0, 1.0),
    "low": Voice(0.8, 0.92),
    "high": Voice(1.5, 1.12),
    "child": Voice(1.9, 1.22),
}


def shift(audio: Audio, pitch: float, formants: float) -> Audio:
    """The same words at the same times in another voice, by the vocoder WORLD.

    Args:
        audio: speech of one speaker.
        pitch: factor of the fundamental frequency.
        formants: factor of the spectral envelope's frequencies.

    Returns:
        As many samples at the same rate; quieter where it would clip.
    """
    vocoder = world()
    samples = np.ascontiguousarray(audio.samples, np.float64)
    f0, times = vocoder.harvest(samples, audio.rate)
    envelope = vocoder.cheaptrick(samples, f0, times, audio.rate)  # (T, F), power
    aperiodicity = vocoder.d4c(samples, f0, times, audio.rate)
    bins = np.arange(envelope.shape[1], dtype=np.float64)
    stretched = np.stack([np.interp(bins / formants, bins, row) for row in np.log(envelope)])
    made = vocoder.synthesize(f0 * pitch, np.exp(stretched), aperiodicity, audio.rate)
    made = np.pad(made, (0, max(len(audio) - len(made), 0)))[: len(audio)]
    loudest = float(np.abs(made).max(initial=0.0))
    return Audio((made * min(1.0, LOUDEST / max(loudest, 1e-9))).astype(np.float32), audio.rate)


def world() -> Any:
    """The vocoder, pyworld."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the package `pyworld` asks for an old setuptools
            import pyworld
    except ImportError as error:
        raise LipwrightError(
            "the vocoder WORLD is not installed; run: pip install pyworld-prebuilt"
        ) from error
    return pyworld


def shifted_file(sentence: Sentence, voice: str) -> Path:
    """The sound of a sentence in another voice; made once and kept."""
    factors = VOICES[voice]
    folder = CACHE / "voices" / f"{voice}-{factors.pitch:g}-{factors.formants:g}"
    path = folder / f"{sentence.name}.flac"
    if not path.exists():
        folder.mkdir(parents=True, exist_ok=True)
        write_flac(path, shift(read_audio(sentence.audio), factors.pitch, factors.formants))
    return path


def half(corpora: Path = CORPORA) -> list[Sentence]:
    """The half of the train split that a model for `--half` is not trained on."""
    return sentences("train", corpora)[1::2]


@dataclass(frozen=True)
class Figures:
    """What a voice gives."""

    pooled: dict[str, dict[str, float]]
    """head to figures"""
    edges: float
    """ms, median distance of phone starts from those of the sound as it was"""
    failures: tuple[str, ...]
    """sentences that could not be aligned"""


def edge_errors(reference: PhoneTrack, estimated: PhoneTrack) -> npt.NDArray[np.float64]:
    """Distances of phone starts in ms; none where the phones differ, as with a pause more."""
    if reference.phones != estimated.phones:
        return np.empty(0)
    return 1000 * np.abs(reference.edges[1:-1] - estimated.edges[1:-1])


def measure(
    chosen: list[Sentence], voice: str | None, animate: Animator, heads: dict[str, Ruler]
) -> Figures:
    """All sentences in a voice, or as they were recorded."""
    scores: dict[str, list[LipScore]] = {head: [] for head in heads}
    edges, failures = [np.empty(0)], []
    for sentence in chosen:
        path = sentence.audio if voice is None else shifted_file(sentence, voice)
        try:
            track = sentence.track if voice is None else align_speech(path, sentence.text).track
        except LipwrightError as error:
            failures.append(f"{sentence.name}: {error}")
            continue
        edges.append(edge_errors(sentence.track, track))
        clip = animate(track, path)
        for head, ruler in heads.items():
            estimated = Aperture(clip.times, ruler(clip))
            scores[head].append(evaluate(sentence.aperture, estimated, sentence.track))
    pooled = {head: pool(values) for head, values in scores.items() if values}
    found = np.concatenate(edges)
    return Figures(pooled, float(np.median(found)) if len(found) else np.nan, tuple(failures))


COLUMNS = ("r", "r_median", "r_best_lag", "closures", "false_closures_per_s", "silence")


def print_table(rows: dict[str, Figures]) -> None:
    """A line for each voice and head."""
    print(f"{'voice':14} {'head':11}", *(f"{name[:14]:>14}" for name in COLUMNS), "  edges failed")
    for voice, figures in rows.items():
        for head, row in figures.pooled.items():
            cells = (f"{row[name]:14.3f}" for name in COLUMNS)
            print(f"{voice:14} {head:11}", *cells,
                  f"{figures.edges:7.1f} {len(figures.failures):6d}")  # fmt: skip
    for voice, figures in rows.items():
        for line in figures.failures:
            print(f"  {voice}: {line}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--engine", help="default: that of lipwright animate")
    parser.add_argument("--model", help="name or folder of a model, for the engine window")
    parser.add_argument(
        "--split", default="test", choices=["all", "test", "validation", "train", "unseen"]
    )
    parser.add_argument("--half", action="store_true", help="the held-out half of the train split")
    parser.add_argument("--half-names", action="store_true", help="print the names of that half")
    parser.add_argument("--first", type=int, help="only the first N sentences")
    parser.add_argument("--voices", nargs="*", default=list(VOICES), choices=list(VOICES))
    parser.add_argument("--corpora", type=Path, default=CORPORA)
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    options = parser.parse_args()
    if options.half_names:
        print("\n".join(sentence.name for sentence in half(options.corpora)))
        return
    found = half(options.corpora) if options.half else sentences(options.split, options.corpora)
    chosen = found[: options.first]
    animate, heads = ours(options.engine, options.model), rulers(options.corpora)
    rows = {"as recorded": measure(chosen, None, animate, heads)}
    for voice in options.voices:
        rows[voice] = measure(chosen, voice, animate, heads)
    print(f"{len(chosen)} sentences ({'half' if options.half else options.split})")
    print_table(rows)
    if options.json:
        with write_whole(options.json) as part:
            figures = {v: {"edges_ms": f.edges, "failures": f.failures, **f.pooled}
                       for v, f in rows.items()}  # fmt: skip
            part.write_text(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main()
