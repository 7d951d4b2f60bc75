"""What a network hears of a recording."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from lipwright.audio import Audio, read_audio
from lipwright.features.sound import (
    SOUND_NAMES,
    SOUNDS,
    SoundScale,
    hear,
    scale_of,
    sound_features,
    to_features,
    warped,
)
from lipwright.speech.acoustic import load_model
from lipwright.speech.recording import spectra

HELLO = Path(__file__).parents[1] / "examples" / "hello.flac"
TIMES = np.arange(0, 9, 0.02)


@pytest.fixture(scope="module")
def hello() -> Audio:
    return read_audio(HELLO, 16000)


def columns(start: str) -> list[int]:
    return [index for index, name in enumerate(SOUND_NAMES) if name.startswith(start)]


def test_the_sounds_are_those_of_the_acoustic_model() -> None:
    assert load_model().base_phones == SOUNDS


def test_names_are_unique_and_one_a_column(hello: Audio) -> None:
    assert len(set(SOUND_NAMES)) == len(SOUND_NAMES)
    rows = sound_features(hello, TIMES)
    assert rows.shape == (len(TIMES), len(SOUND_NAMES))
    assert rows.dtype == np.float32
    assert np.isfinite(rows).all()


def test_shares_of_sounds_sum_to_one(hello: Audio) -> None:
    shares = sound_features(hello, TIMES)[:, columns("sounds like")]
    assert shares.min() >= 0
    np.testing.assert_allclose(shares.sum(axis=1), 1, atol=1e-4)


def test_loudness_of_the_recording_does_not_count(hello: Audio) -> None:
    quiet = Audio(hello.samples * np.float32(0.1), hello.rate)
    here, there = sound_features(hello, TIMES), sound_features(quiet, TIMES)
    loud = here[:, 0] > -1  # within 20 dB of loud speech, where no noise floor counts
    np.testing.assert_allclose(here[loud, 0], there[loud, 0], atol=0.01)
    assert np.abs(here[loud] - there[loud]).mean() < 0.02


def test_a_louder_part_has_a_higher_level(hello: Audio) -> None:
    samples = hello.samples.copy()
    half = len(samples) // 2
    samples[:half] *= np.float32(0.25)  # 12 dB
    scale = scale_of(hear(hello))
    before = sound_features(hello, TIMES, scale)[:, 0]
    after = sound_features(Audio(samples, hello.rate), TIMES, scale)[:, 0]
    first = (TIMES < 4) & (before > -1)
    last = (TIMES > 5) & (before > -1)
    np.testing.assert_allclose(before[first] - after[first], 12.04 / 20, atol=0.02)
    np.testing.assert_allclose(before[last], after[last], atol=0.01)


def test_the_scale_of_a_recording_is_the_default(hello: Audio) -> None:
    heard = hear(hello)
    np.testing.assert_array_equal(
        to_features(heard, TIMES), to_features(heard, TIMES, scale_of(heard))
    )


def test_another_scale_moves_what_it_measures(hello: Audio) -> None:
    heard = hear(hello)
    scale = scale_of(heard)
    louder = SoundScale(scale.loud + 20, scale.mean, scale.spread)
    here, there = (to_features(heard, TIMES, by)[:, 0] for by in (scale, louder))
    inside = (here > -1) & (here < 0.5)
    assert inside.sum() > 100
    assert np.median(here[inside] - there[inside]) == pytest.approx(1, abs=1e-4)


def test_cepstra_of_speech_have_no_mean_and_one_spread(hello: Audio) -> None:
    heard = hear(hello)
    scale = scale_of(heard)
    speech = heard.level > scale.loud - 25
    spoken = (heard.cepstra[speech] - scale.mean) / scale.spread
    np.testing.assert_allclose(spoken.mean(axis=0), 0, atol=1e-4)
    np.testing.assert_allclose(spoken.std(axis=0), 1, atol=1e-4)


@pytest.mark.parametrize("count", [0, 1, 100, 3000])
def test_silence_and_nothing_are_heard_without_a_fault(count: int) -> None:
    rows = sound_features(Audio(np.zeros(count, np.float32), 16000), TIMES[:10])
    assert rows.shape == (10, len(SOUND_NAMES))
    assert np.isfinite(rows).all()


def test_times_outside_of_the_sound_have_its_end_frames(hello: Audio) -> None:
    rows = sound_features(hello, [-1.0, 0.0, hello.duration + 1, hello.duration + 9])
    np.testing.assert_array_equal(rows[0], rows[1])
    np.testing.assert_array_equal(rows[2], rows[3])


def test_another_throat_moves_every_formant() -> None:
    rate, power = 16000, []
    time = np.arange(rate) / rate
    for hz in (1000, 1250):
        tone = 0.3 * np.sin(2 * np.pi * hz * time).astype(np.float32)
        power.append(spectra(Audio(tone, rate))[20:60])
    moved = warped(power[0], 1.25).mean(axis=0)
    assert abs(int(moved.argmax()) - int(power[1].mean(axis=0).argmax())) <= 1
    assert moved.argmax() > power[0].mean(axis=0).argmax()


def test_the_same_throat_changes_nothing(hello: Audio) -> None:
    power = spectra(hello)
    np.testing.assert_allclose(warped(power, 1.0), np.maximum(power, 1e-4), rtol=1e-4)


def test_a_throat_of_another_creature_is_refused() -> None:
    with pytest.raises(ValueError, match=r"factor is 3"):
        warped(np.ones((4, 25), np.float32), 3.0)
