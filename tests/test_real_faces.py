"""The whole way on real recordings, measured against real lips.

Six sentences of GRID are tracked, aligned and animated; bench/lips.py does the same for all.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lipwright.face.head import Head
from lipwright.track import PhoneTrack

ROOT = Path(__file__).resolve().parents[1]
CORPORA = ROOT.parent / "shared" / "corpora"

pytestmark = pytest.mark.skipif(
    not (CORPORA / "grid-s1").is_dir(), reason="the GRID recordings are not beside the checkout"
)


@pytest.fixture(scope="module")
def bench(head: Head, monkeypatch_module: pytest.MonkeyPatch) -> dict[str, Any]:
    """The benchmark's modules and its two rulers."""
    pytest.importorskip("mediapipe", reason="the face tracker is not installed")
    monkeypatch_module.syspath_prepend(str(ROOT / "bench"))
    import grid
    import heads
    import lips

    del head  # installed by the fixture; the ruler loads it
    return {"grid": grid, "lips": lips, "rulers": heads.rulers(CORPORA)}


@pytest.fixture(scope="module")
def monkeypatch_module() -> Iterator[pytest.MonkeyPatch]:
    """`monkeypatch` for a module."""
    with pytest.MonkeyPatch.context() as patch:
        yield patch


@pytest.fixture(scope="module")
def aligned(
    bench: dict[str, Any], tmp_path_factory: pytest.TempPathFactory
) -> list[tuple[Any, PhoneTrack]]:
    """Six test sentences, tracked and aligned anew."""
    bench["grid"].CACHE = tmp_path_factory.mktemp("cache")
    sentences = bench["grid"].sentences("test", CORPORA)[:6]
    return [(sentence, sentence.align()) for sentence in sentences]


def measure(
    bench: dict[str, Any], aligned: list[tuple[Any, PhoneTrack]], *engine: str
) -> dict[str, Any]:
    """Head to pooled figures of the sentences."""
    from lipwright.evaluate.lips import pool

    lips, rulers = bench["lips"], bench["rulers"]
    animate = lips.ours(*engine)
    scores: dict[str, list[Any]] = {name: [] for name in rulers}
    for sentence, track in aligned:
        for name, score in lips.score(sentence, track, animate(track), rulers).items():
            scores[name].append(score)
    return {name: pool(values) for name, values in scores.items()}


@pytest.fixture(scope="module")
def figures(bench: dict[str, Any], aligned: list[tuple[Any, PhoneTrack]]) -> dict[str, Any]:
    """Of the engine `dominance`."""
    return measure(bench, aligned, "dominance")


def test_the_animated_lips_follow_the_real_ones_on_both_heads(figures: dict[str, Any]) -> None:
    for pooled in figures.values():
        assert pooled["r"] > 0.65
        assert pooled["silence"] < 0.05


def test_real_closures_are_made_and_few_are_false(figures: dict[str, Any]) -> None:
    for pooled in figures.values():
        assert pooled["closures"] >= 0.97
        assert pooled["false_closures_per_s"] < 0.2  # one in the six sentences at most


def test_the_english_bigrams_follow_the_real_lips_and_shut_them_whenever_they_do(
    bench: dict[str, Any], aligned: list[tuple[Any, PhoneTrack]]
) -> None:
    for pooled in measure(bench, aligned, "bigram", "english").values():
        assert pooled["r"] > 0.7
        assert pooled["silence"] < 0.05
        assert pooled["closures"] == 1
        assert pooled["false_closures_per_s"] < 0.2


def test_the_tracker_finds_the_face_in_every_frame(bench: dict[str, Any]) -> None:
    sentence = bench["grid"].sentences("test", CORPORA)[0]
    assert sentence.landmarks.shape[1:] == (478, 3)
    assert not np.isnan(sentence.landmarks).any()
    assert 0 < np.nanmin(sentence.aperture.values) < 0.02 < sentence.aperture.loud < 0.5


def test_every_kind_of_sentence_aligns_without_losing_a_word(bench: dict[str, Any]) -> None:
    from lipwright.pipeline import align_speech

    lost = 0
    chosen = bench["grid"].sentences("validation", CORPORA)[:20]
    for sentence in chosen:
        alignment = align_speech(sentence.audio, sentence.text)
        assert alignment.track.end == pytest.approx(3, abs=0.1)
        lost += 6 - len(alignment.track.words)
    assert lost <= 1
