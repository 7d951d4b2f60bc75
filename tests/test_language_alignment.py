"""Forced alignment in other languages, on espeak-ng voices whose phone times are known."""

import sys
from pathlib import Path

import numpy as np
import pytest

from lipwright import espeak
from lipwright.audio import Audio
from lipwright.errors import LipwrightError
from lipwright.language import LANGUAGES, get_language
from lipwright.phones import PHONES
from lipwright.speech import align, get_aligner
from lipwright.speech.held import frame_weights

sys.path.insert(0, str(Path(__file__).parents[1] / "bench"))
try:
    import language_timing as bench
finally:
    sys.path.pop(0)

needs_espeak = pytest.mark.skipif(
    not espeak.is_available(), reason="run: pip install 'lipwright[espeak]'"
)
MOST_MEDIAN = {"en": 0.020, "sv": 0.020, "cmn": 0.035}  # s


def errors_of(language, text, variant):
    said = bench.say(text, bench.VOICES.get(language, language) + variant)
    figures = bench.Figures([], bench.defaultdict(list))
    alignment = align(said.audio, get_language(language).normalize(text), language)
    bench.add_errors(figures, said.sounds, alignment)
    return figures.errors


def test_the_aligner_knows_every_language_of_the_front_end():
    assert set(get_aligner("sphinx").languages()) >= set(LANGUAGES)


@needs_espeak
@pytest.mark.parametrize("language", ["en", "sv", "cmn", "de", "fr"])
def test_phone_starts_agree_with_the_voice(language):
    errors = [e for text in bench.TEXTS[language][:2] for e in errors_of(language, text, "+f2")]
    assert np.median(np.abs(errors)) <= MOST_MEDIAN.get(language, 0.025)


@needs_espeak
@pytest.mark.parametrize("language", ["sv", "cmn", "de", "es"])
def test_the_text_of_other_sentences_is_refused_and_the_right_one_fits(language):
    first, *others = bench.TEXTS[language]
    said = bench.say(first, language)
    normalize = get_language(language).normalize
    right = align(said.audio, normalize(first), language)
    assert len(right.misfits) <= 1
    with pytest.raises(LipwrightError, match="the text does not fit the sound"):
        align(said.audio, normalize(" ".join(others[-3:])), language)


def held(said, start, stop, seconds):
    """The sound with the middle of `start` to `stop` held, from overlapping grains of it."""
    samples, rate = said.audio.samples, said.audio.rate
    middle, grain = round((start + stop) / 2 * rate), round(0.06 * rate)
    reach = round((stop - start) * rate * 0.15)
    out = np.zeros(round(seconds * rate) + grain)
    rng = np.random.default_rng(0)
    for at in range(0, len(out) - grain, grain // 2):
        first = middle - grain // 2 + int(rng.integers(-reach, reach + 1))
        out[at : at + grain] += np.hanning(grain) * samples[first : first + grain]
    parts = (samples[:middle], out[:-grain], samples[middle:])
    return Audio(np.concatenate(parts).astype(np.float32), rate)


@needs_espeak
@pytest.mark.parametrize("language", ["sv", "cmn"])
def test_a_vowel_of_five_seconds_stays_whole_and_no_word_is_lost(language):
    text = bench.TEXTS[language][0]
    said = bench.say(text, language)
    words = get_language(language).normalize(text)
    plain = align(said.audio, words, language).track
    start, stop = max(
        ((a, b) for phone, a, b in plain if PHONES[phone].is_vowel), key=lambda row: row[1] - row[0]
    )
    found = align(held(said, start, stop, 5.0), words, language)
    assert not found.misfits
    assert [word.text for word in found.track.words] == [word.text for word in plain.words]
    assert max(b - a for _, a, b in found.track) >= 4.5


def test_only_what_is_held_weighs_less():
    rng = np.random.default_rng(0)
    moving = np.repeat(rng.normal(0, 30, (40, 13)), 10, axis=0)
    same = np.repeat(rng.normal(0, 10, (1, 13)), 400, axis=0)
    static = np.concatenate([moving, same, moving]).astype(np.float32)
    static[:, 0] = 10
    weights = frame_weights(static)
    assert np.all(weights[:350] == 1)
    assert np.all(weights[-350:] == 1)
    assert weights[450:750].max() < 0.2
    static[:, 0] = -50  # a pause
    assert np.all(frame_weights(static) == 1)
