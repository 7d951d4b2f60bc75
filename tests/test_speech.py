"""Forced alignment: planted answers, noise, words that do not fit, and each of its parts."""

import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lipwright.audio import Audio, level_db, open_audio
from lipwright.errors import LipwrightError
from lipwright.language import SpokenWord, get_language
from lipwright.speech import ALIGNERS, Alignment, align, get_aligner
from lipwright.speech.acoustic import load_model
from lipwright.speech.features import HOP, WINDOW, NoiseRemoval, cepstra, spectra_of
from lipwright.speech.fit import confidence, noise_allowance
from lipwright.speech.graph import ANY_SPEECH, HUB, build_graph
from lipwright.speech.held import over_held
from lipwright.speech.scores import Scores
from lipwright.speech.search import STRICT, Search
from lipwright.speech.silence import speech_frames

RATE = 16000
CORPORA = Path(__file__).parents[2] / "shared" / "corpora"
SPOKEN = CORPORA / "aligned-phones"
GRID = CORPORA / "grid-s1"

needs_corpora = pytest.mark.skipif(not SPOKEN.is_dir(), reason="the recordings are not there")
EXTRA = "mountain people because hello"


def words_of(text: str) -> tuple[SpokenWord, ...]:
    return get_language("en").normalize(text)


def sentence(name: str) -> tuple[Audio, str]:
    with open_audio(SPOKEN / f"{name}.flac", rate=RATE) as file:
        return file.read(0, file.duration), (SPOKEN / f"{name}.txt").read_text(encoding="utf-8")


def spans(alignment: Alignment) -> dict[str, tuple[float, float]]:
    return {word.text: alignment.track.word_span(word) for word in alignment.track.words}


def mixed(sound: Audio, noise: np.ndarray, snr: float) -> Audio:
    power = np.mean(np.square(sound.samples)) / np.mean(np.square(noise)) / 10 ** (snr / 10)
    return Audio(sound.samples + (noise * np.sqrt(power)).astype(np.float32), RATE)


def joined(*parts: np.ndarray) -> Audio:
    return Audio(np.concatenate(parts).astype(np.float32), RATE)


# --- the registry -----------------------------------------------------------------------------


def test_every_aligner_answers_for_itself():
    for name in ALIGNERS:
        aligner = get_aligner(name)
        assert aligner.name == name
        assert aligner.is_available()
        assert aligner.languages()


def test_unknown_aligner_and_language_name_the_choices():
    sound = Audio(np.ones(RATE), RATE)
    with pytest.raises(LipwrightError, match="use one of: sphinx"):
        align(sound, words_of("hello"), aligner="nobody")
    with pytest.raises(LipwrightError, match="it knows: en"):
        align(sound, words_of("hello"), language="xx")
    with pytest.raises(LipwrightError, match="no words"):
        align(sound, ())


# --- parts ------------------------------------------------------------------------------------


def test_features_are_those_of_pocketsphinx(tmp_path):
    from pocketsphinx import Decoder, get_model_path

    rng = np.random.default_rng(1)
    samples = (rng.standard_normal(RATE) * np.linspace(0, 3000, RATE)).astype("<i2")
    lexicon = tmp_path / "words.dict"
    lexicon.write_text("a AH\n", encoding="ascii")
    decoder = Decoder(hmm=get_model_path("en-us/en-us"), lm=None, dict=str(lexicon),
                      mfclogdir=str(tmp_path), loglevel="FATAL")  # fmt: skip
    decoder.set_align_text("a")
    decoder.start_utt()
    decoder.process_raw(samples.tobytes(), full_utt=True)
    decoder.end_utt()
    (dump,) = tmp_path.glob("*.mfc")
    theirs = np.frombuffer(dump.read_bytes(), ">f4", offset=4).reshape(-1, 13)
    sound = Audio(samples / np.float32(32768), RATE)
    ours = cepstra(NoiseRemoval()(np.concatenate(list(spectra_of(sound)))))
    whole = (RATE - WINDOW) // HOP
    np.testing.assert_allclose(ours[:whole], theirs[:whole], atol=2e-3)


def test_spectra_do_not_depend_on_the_blocks():
    samples = np.random.default_rng(2).standard_normal(RATE * 23)
    blocks = np.concatenate(list(spectra_of(Audio(samples, RATE))))
    from lipwright.speech.features import power_spectra

    whole = power_spectra(np.append(samples, np.zeros(WINDOW)).astype(np.float32))
    np.testing.assert_allclose(blocks, whole[: len(blocks)])
    assert len(blocks) == len(whole)


def test_transition_probabilities_and_mixtures_sum_to_one():
    model = load_model()
    np.testing.assert_allclose(np.exp(model.transitions).sum(-1), 1, atol=1e-5)
    mixtures = np.exp(-1024 * np.log(1.0001) * model.weights[:, ::50].astype(float)).sum(-1)
    np.testing.assert_allclose(mixtures, 1, atol=0.1)  # as far as 8 bits carry


def test_scores_agree_with_a_plain_mixture_density():
    model = load_model()
    features = np.random.default_rng(3).standard_normal((70, 39)).astype(np.float32)
    senones = np.array([700, 3, 2000, 4100])
    scores = model.score(features, senones)
    weights = np.exp(-1024 * np.log(1.0001) * model.weights.astype(float))
    for column, senone in enumerate(senones):
        total = np.zeros(len(features))
        for stream in range(3):
            x = features[:, 13 * stream : 13 * stream + 13].astype(float)
            table = model.gaussians[stream][model.senone_base[senone]].astype(float)
            density = np.exp(np.c_[x, x**2, np.ones(len(x))] @ table.T)
            total += np.log(density @ weights[stream, senone])
        np.testing.assert_allclose(scores[:, column], total, rtol=1e-3, atol=1e-2)


class Planted(Scores):
    """Scores that favour the senones of one row of nodes, frame by frame."""

    def __init__(self, model, plan):
        changing = 100 * np.random.default_rng(0).standard_normal((len(plan), 13))
        super().__init__(model, changing.astype(np.float32))  # no sound is held
        self.plan = plan

    def ratios(self, start, stop, senones):
        return np.where(senones[None] == np.array(self.plan[start:stop])[:, None], 2.0, -8.0)


@settings(max_examples=25, deadline=None)
@given(st.lists(st.integers(3, 30), min_size=8, max_size=8), st.integers(0, 20))
def test_search_finds_a_planted_path(lengths, pause):
    model = load_model()
    graph = build_graph(model, [[("B", "IH", "N")], [("S", "EH", "T"), ("T", "UW")]])
    pause_node = next(i for i in range(len(graph.base)) if graph.hub[i] == 1
                      and graph.base[i] == model.base("SIL"))  # fmt: skip
    ends = [n for n in graph.exits[1] if graph.pronunciation[n] == 0]
    starts = [n for n in range(len(graph.base)) if graph.hub[n] == 1 and HUB - 1 in
              graph.predecessors[n] and graph.pronunciation[n] == 0]  # fmt: skip
    inner = [n for n in range(len(graph.base)) if graph.position[n] == 1
             and graph.pronunciation[n] == 0]  # fmt: skip
    first = next(n for n in range(len(graph.base)) if graph.hub[n] == 0
                 and HUB in graph.predecessors[n] and graph.pronunciation[n] == 0)  # fmt: skip
    last = next(n for n in graph.exits[2] if graph.pronunciation[n] == 0)
    nodes = [first, inner[0], ends[0], pause_node, starts[0], inner[1], last]
    durations = [*lengths[:3], pause + 3, *lengths[3:6]]
    plan = [int(s) for node, frames in zip(nodes, durations, strict=True)
            for s in np.repeat(graph.senones[node], [1, frames - 2, 1])]  # fmt: skip
    path = Search(graph, Planted(model, plan), STRICT).run(0, len(plan), 0, to_end=True)
    assert [s.stop - s.start for s in path] == durations
    assert [int(graph.base[s.node]) for s in path] == [int(graph.base[n]) for n in nodes]


def test_graph_offers_skips_pauses_and_other_speech_at_every_hub():
    graph = build_graph(load_model(), [[("B", "IH", "N")], [("AH",), ("EY",)], [("N", "AW")]])
    assert graph.n_hubs == 4
    for hub in range(4):
        nodes = range(graph.starts[hub], graph.starts[hub + 1])
        fillers = [n for n in nodes if graph.predecessors[n] == (HUB - hub,)][:3]
        assert set(fillers) <= set(graph.exits[hub])
        assert any(graph.senones[n, 0] == ANY_SPEECH for n in fillers)
    for node, sources in enumerate(graph.predecessors):
        assert sources
        assert all(source < node for source in sources)


@given(st.floats(-30, 30), st.floats(0.001, 5))
def test_confidence_rises_with_the_score(score, more):
    assert 0 <= confidence(score) <= confidence(score + more) <= 1


@given(st.lists(st.floats(-20, 5), max_size=9))
def test_noise_allowance_is_bounded_and_never_a_penalty(scores):
    assert 0 <= noise_allowance(scores) <= 2


@given(st.integers(-60, -10), st.floats(0.3, 2.0))
def test_speech_is_what_rises_over_the_noise_floor(floor, length):
    rng = np.random.default_rng(4)
    quiet = rng.standard_normal(4 * RATE) * 10 ** (floor / 20) * 0.01
    start, stop = RATE, RATE + int(length * RATE)
    quiet[start:stop] += rng.standard_normal(stop - start) * 10 ** (floor / 20)
    active = speech_frames(level_db(Audio(quiet, RATE)))
    changes = np.flatnonzero(np.diff(active)) + 1
    assert len(changes) == 2
    np.testing.assert_allclose(changes / 100, (1 - 0.25, 1 + length + 0.25), atol=0.02)


# --- alignment --------------------------------------------------------------------------------


@needs_corpora
@pytest.mark.parametrize("name", ["msajc003", "msajc012", "msajc022", "msajc057"])
def test_phone_starts_agree_with_the_hand_labels(name):
    sys.path.insert(0, str(Path(__file__).parents[1] / "bench"))
    try:
        import alignment as bench
    finally:
        sys.path.pop(0)
    sound, text = sentence(name)
    found = align(sound, words_of(text))
    assert not found.misfits
    assert [word.text for word in found.track.words] == text.split()
    assert found.track.start == 0
    assert found.track.end == pytest.approx(sound.duration)
    estimated = [bench.Labelled(p, start) for p, start, _ in found.track if p != "sil"]
    match = bench.match_phones(bench.read_reference(SPOKEN / f"{name}.tsv"), estimated)
    figures = bench.summarize(match.errors)
    assert figures["median_ms"] <= 15
    assert figures["within_50ms"] >= 0.9
    assert len(match.reference_unmatched) <= 2


@needs_corpora
@pytest.mark.parametrize("gain", [0.01, 30.0])
def test_loudness_and_clipping_change_little(gain):
    sound, text = sentence("msajc012")
    other = Audio(np.clip(sound.samples * gain, -1, 1), RATE)
    before, after = (spans(align(s, words_of(text))) for s in (sound, other))
    assert np.abs(np.subtract(list(before.values()), list(after.values()))).max() < 0.1


@needs_corpora
def test_silence_around_and_digital_zeros_do_not_matter():
    sound, text = sentence("msajc057")
    before = spans(align(sound, words_of(text)))
    padded = joined(np.zeros(RATE * 7), sound.samples, np.zeros(RATE * 25))
    after = spans(align(padded, words_of(text)))
    shift = np.subtract(list(after.values()), list(before.values())) - 7
    assert np.quantile(np.abs(shift), 0.8) < 0.05
    assert after.keys() == before.keys()


@needs_corpora
def test_a_word_that_is_not_said_is_reported_and_moves_nothing():
    sound, text = sentence("msajc012")
    before = spans(align(sound, words_of(text)))
    found = align(sound, words_of(text.replace("caused", "mountain caused")))
    assert [misfit.text for misfit in found.misfits] == ["mountain"]
    assert before["wind"][0] <= found.misfits[0].start <= before["caused"][1]
    after = spans(found)
    assert all(np.abs(np.subtract(after[w], before[w])).max() < 0.05 for w in before)


@needs_corpora
def test_a_word_that_is_said_but_not_written_moves_nothing():
    sound, text = sentence("msajc012")
    before = spans(align(sound, words_of(text)))
    after = spans(align(sound, words_of(text.replace("caused ", ""))))
    assert all(np.abs(np.subtract(after[w], before[w])).max() < 0.05 for w in after)


@needs_corpora
@pytest.mark.parametrize("name", ["msajc003", "msajc012", "msajc022", "msajc057"])
def test_speech_that_the_text_lacks_is_reported_and_only_that(name: str):
    sound, text = sentence(name)
    whole = align(sound, words_of(text))
    assert whole.unwritten == ()
    words = text.split()
    half = align(sound, words_of(" ".join(words[: len(words) // 2])))
    ((start, end),) = half.unwritten
    said = whole.track.word_span(whole.track.words[len(words) // 2])[0]
    assert start == pytest.approx(said, abs=0.15)
    assert end == pytest.approx(whole.track.word_span(whole.track.words[-1])[1], abs=0.3)


@needs_corpora
def test_words_after_the_end_are_reported_each():
    sound, text = sentence("msajc003")
    found = align(sound, words_of(f"{text} {EXTRA}"))
    assert [misfit.text for misfit in found.misfits] == EXTRA.split()
    assert all(word.text in text for word in found.track.words)
    assert all(misfit.start >= 2.4 for misfit in found.misfits)


@needs_corpora
def test_confidence_tells_right_words_from_wrong_ones():
    sound, text = sentence("msajc057")
    found = align(sound, words_of(text.replace("attracts", "through")))
    confidences = {word.text: word.confidence for word in found.track.words}
    wrong = confidences.pop("through", 0.0)
    assert wrong < min(confidences.values())


@needs_corpora
@pytest.mark.parametrize("kind", ["white", "pink"])
def test_noise_at_10_db_moves_few_edges(kind):
    sound, text = sentence("msajc022")
    noise = np.random.default_rng(5).standard_normal(len(sound))
    if kind == "pink":
        spectrum = np.fft.rfft(noise)
        noise = np.fft.irfft(spectrum / np.sqrt(np.arange(1, len(spectrum) + 1)), len(noise))
    before = spans(align(sound, words_of(text)))
    after = spans(align(mixed(sound, noise, 10), words_of(text)))
    assert after.keys() == before.keys()
    shift = np.abs(np.subtract(list(after.values()), list(before.values())))
    assert (shift <= 0.1).mean() >= 0.85


@needs_corpora
def test_a_long_recording_agrees_with_its_parts():
    names = ["msajc003", "msajc012", "msajc022", "msajc057"]
    parts = [sentence(name) for name in names]
    rng = np.random.default_rng(6)
    order = [parts[i] for i in rng.integers(0, 4, 20)]
    pieces, expected, now = [], [], 0.0
    for number, (sound, text) in enumerate(order):
        alone = align(sound, words_of(text))
        expected += [(s + now, e + now) for s, e in (alone.track.word_span(w)
                                                     for w in alone.track.words)]  # fmt: skip
        pause = 20.0 if number == 7 else 0.4
        pieces += [sound.samples, rng.standard_normal(int(pause * RATE)) * 1e-4]
        now += sound.duration + pause
    shares = []
    found = align(joined(*pieces), words_of(" ".join(text for _, text in order)),
                  progress=shares.append)  # fmt: skip
    assert len(found.track.words) == len(expected)
    times = [found.track.word_span(word) for word in found.track.words]
    assert (np.abs(np.subtract(times, expected)) <= 0.05).mean() >= 0.95
    assert shares == sorted(shares)
    assert shares[-1] == 1


@needs_corpora
def test_a_lone_letter_may_be_said_by_its_name():
    path = GRID / "audio" / "bbal6n.flac"
    with open_audio(path, rate=RATE) as file:
        found = align(file, words_of("bin blue at l six now"))
    word = found.track.words[3]
    assert found.track.phones[word.first : word.stop] == ("EH", "L")


@needs_corpora
def test_another_text_is_refused_with_the_first_place():
    sound, _ = sentence("msajc003")
    _, text = sentence("msajc057")
    with pytest.raises(LipwrightError, match=r"text does not fit .*line 1, column \d+.*give the"):
        align(sound, words_of(text))


@pytest.mark.parametrize("samples", [np.zeros(RATE), np.zeros(0), np.full(RATE, 1e-5)])
def test_silence_is_refused(samples):
    with pytest.raises(LipwrightError, match="nothing is heard"):
        align(Audio(samples, RATE), words_of("hello there"))


@settings(max_examples=20, deadline=None)
@given(st.integers(1, 20000), st.sampled_from([8000, 16000, 44100]), st.integers(0, 9))
def test_any_sound_gives_a_track_or_one_line(length, rate, seed):
    samples = np.random.default_rng(seed).uniform(-0.5, 0.5, length)
    try:
        found = align(Audio(samples, rate), words_of("no"))
    except LipwrightError:
        return
    assert found.track.end == pytest.approx(length / rate)


@needs_corpora
def test_interrupt_ends_promptly_and_leaves_nothing(tmp_path):
    program = (
        "import sys, numpy as np\n"
        "from lipwright.audio import Audio\n"
        "from lipwright.language import get_language\n"
        "from lipwright.speech import align\n"
        "sound = Audio(np.random.default_rng(0).standard_normal(16000 * 300) * .1, 16000)\n"
        "print('go', flush=True)\n"
        "align(sound, get_language('en').normalize('hello there ' * 500))\n"
    )
    run = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE,
                           stderr=subprocess.PIPE, env={"TMPDIR": str(tmp_path)},
                           text=True)  # fmt: skip
    assert run.stdout is not None
    assert run.stdout.readline() == "go\n"
    run.send_signal(signal.SIGINT)
    _, errors = run.communicate(timeout=20)
    assert "KeyboardInterrupt" in errors
    assert list(tmp_path.iterdir()) == []


def test_a_held_vowel_goes_on_to_the_end_of_its_sound_and_no_further():
    static = np.zeros((300, 13), np.float32)
    static[200:] = 100.0
    weights = np.ones(300, np.float32)
    weights[20:200] = 0.2
    spans = [(0, 30), (210, 240)]
    assert over_held(spans, [(True, True)] * 2, weights, static) == [(0, 200), (210, 240)]
    assert over_held(spans, [(False, False)] * 2, weights, static) == spans
    assert over_held([(190, 220)], [(True, True)], weights, static) == [(20, 220)]


@pytest.mark.parametrize("kind", ["tone", "saw", "noise"])
def test_sounds_that_do_not_change_are_no_words(kind: str) -> None:
    times = np.arange(3 * 16000) / 16000
    sounds = {
        "tone": 0.3 * np.sin(2 * np.pi * 220 * times),
        "saw": 0.3 * ((times * 130) % 1 - 0.5),
        "noise": 0.1 * np.random.default_rng(0).standard_normal(len(times)),
    }
    words = get_language("en").normalize("Hello there, and many more words than that.")
    with pytest.raises(LipwrightError, match="the text does not fit the sound"):
        align(Audio(sounds[kind].astype(np.float32), 16000), words)
