"""Blinks, glances, brows and head motion: seeded, driven by speech, never on the mouth."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lipwright.audio import Audio, read_audio
from lipwright.clip import Clip
from lipwright.controls import CANONICAL, GROUPS, HEAD_ANGLES
from lipwright.engines.dominance import animate as by_rules
from lipwright.errors import LipwrightError
from lipwright.face.head import Head
from lipwright.life import (
    Phrase,
    Voice,
    add_life,
    find_accents,
    find_phrases,
    hear_voice,
    life,
)
from lipwright.life.accents import APART
from lipwright.life.curves import smooth_noise
from lipwright.life.eyes import (
    CLOSING,
    FARTHEST,
    FULL_TURNS,
    GLANCE,
    OPENING,
    RESTING,
    TALKING,
    gaze_degrees,
    plan_blinks,
)
from lipwright.life.motion import FASTEST, LIMITS
from lipwright.life.voice import STEP
from lipwright.passes import apply_passes, default_passes, expression
from lipwright.phones import SILENCE
from lipwright.track import PhoneTrack, Word

HELLO = Path(__file__).resolve().parents[1] / "examples" / "hello.flac"
RATE = 16000
quick = settings(deadline=None, max_examples=25)
Floats = npt.NDArray[np.float64]


def talk(seconds: float, seed: int = 0) -> PhoneTrack:
    """Words of three phones in phrases of six words, with pauses of half a second."""
    random = np.random.default_rng(seed)
    phones, lengths, words, so_far = [SILENCE], [0.5], list[Word](), 0.5
    while so_far < seconds:
        for _ in range(6):
            words.append(Word("bad", len(phones), len(phones) + 3))
            phones += ["B", str(random.choice(["AE", "IY", "UW"])), "D"]
            lengths += list(random.uniform(0.06, 0.16, 3))
        phones.append(SILENCE)
        lengths.append(0.5)
        so_far += sum(lengths[-19:])
    return PhoneTrack(tuple(phones), np.cumsum([0.0, *lengths]), tuple(words))


TALK = talk(20)
SPEECH = apply_passes(by_rules(TALK, 60.0), TALK, default_passes())


def hum(track: PhoneTrack, hertz: Floats, level: Floats) -> Audio:
    """A voice of the pitch and level, linear, that each phone of a track has."""
    times = np.arange(round(track.end * RATE)) / RATE
    phone = np.searchsorted(track.edges, times, "right") - 1
    phase = 2 * np.pi * np.cumsum(hertz[phone]) / RATE
    buzz = sum(np.sin(k * phase) / k for k in range(1, 6))
    return Audio((0.1 * level[phone] * buzz).astype(np.float32), RATE)


def blinks_of(clip: Clip) -> Floats:
    """s, when the lids begin to be more than half shut."""
    lids = clip.curve("eyeBlinkLeft")
    return np.flatnonzero((lids[1:] > 0.5) & (lids[:-1] <= 0.5)) / clip.fps


# --- what is heard ---


@quick
@given(st.floats(80, 350), st.sampled_from([8000, 16000, 44100, 48000]))
def test_the_pitch_of_a_hum_is_heard(hertz: float, rate: int) -> None:
    times = np.arange(rate // 2) / rate
    buzz = sum(np.sin(2 * np.pi * k * hertz * times) / k for k in range(1, 6))
    voice = hear_voice(Audio((0.1 * np.asarray(buzz)).astype(np.float32), rate))
    heard = voice.pitch[np.isfinite(voice.pitch)]
    assert len(heard) > 15
    assert np.abs(heard - 12 * np.log2(hertz)).max() < 0.5, "semitones"


def test_noise_and_silence_have_no_pitch() -> None:
    noise = np.random.default_rng(0).normal(0, 0.1, RATE).astype(np.float32)
    assert np.isfinite(hear_voice(Audio(noise, RATE)).pitch).mean() < 0.1
    assert not np.isfinite(hear_voice(Audio(np.zeros(RATE, np.float32), RATE)).pitch).any()
    assert len(hear_voice(Audio(np.zeros(0, np.float32), RATE)).level) == 0


def test_long_sound_is_heard_as_short_sound_is() -> None:
    sound = read_audio(HELLO, RATE)
    long = Audio(np.tile(sound.samples, 8), RATE)  # more than a block
    parts = hear_voice(long), hear_voice(sound)
    size = len(parts[1].pitch) - 3
    assert np.array_equal(parts[0].pitch[:size], parts[1].pitch[:size], equal_nan=True)
    assert np.isfinite(parts[0].pitch).mean() == pytest.approx(
        np.isfinite(parts[1].pitch).mean(), abs=0.01
    )


def test_phrases_lie_between_pauses() -> None:
    track = PhoneTrack(
        ("sil", "AE", "sil", "T", "AE", "sil", "sil", "M", "sil"),
        np.cumsum([0, 1, 0.2, 0.1, 0.1, 0.2, 0.3, 0.3, 0.2, 1.0]),
    )
    spans = [(round(p.start, 3), round(p.end, 3)) for p in find_phrases(track)]
    assert spans == [(1.0, 1.6), (2.2, 2.4)], "a silence of 0.1 s is a stop, not a pause"
    assert find_phrases(PhoneTrack(("sil",), np.array([0.0, 5.0]))) == []


def planted(stand_out: int, how: str) -> tuple[PhoneTrack, Audio | None]:
    """Six words, one of which stands out by one means only."""
    vowels = [1 + 3 * number + 1 for number in range(6)]
    phones = (SILENCE, *("B", "AE", "D") * 6, SILENCE)
    lengths = np.array([0.5, *[0.12] * 18, 0.5])
    stress: tuple[int | None, ...] = ()
    hertz, level = np.full(20, 120.0), np.array([0.0, *[1.0] * 18, 0.0])
    chosen = vowels[stand_out]
    if how == "stress":
        stress = tuple(
            (1 if i == chosen else 0) if i in vowels else None for i in range(len(phones))
        )
    elif how == "length":
        lengths[chosen] *= 1.8
    elif how == "pitch":
        hertz[chosen] *= 2 ** (4 / 12)
    else:
        level[chosen] *= 2.0
    words = tuple(Word("bad", 1 + 3 * n, 4 + 3 * n) for n in range(6))
    track = PhoneTrack(phones, np.cumsum([0.0, *lengths]), words, stress)
    return track, hum(track, hertz, level) if how in ("pitch", "loudness") else None


@pytest.mark.parametrize("how", ["stress", "length", "pitch", "loudness"])
@pytest.mark.parametrize("word", [0, 2, 5])
def test_the_word_that_stands_out_is_found(how: str, word: int) -> None:
    track, sound = planted(word, how)
    voice = None if sound is None else hear_voice(sound)
    accents = find_accents(track, voice)
    strongest = max(accents, key=lambda accent: accent.strength)
    assert strongest.time == pytest.approx(track.edges[1 + 3 * word + 1])
    assert strongest.strength > 0.6
    others = [a.strength for a in accents if a is not strongest]
    assert max(others) < strongest.strength - 0.1
    assert (np.diff([a.time for a in accents]) >= APART - 1e-9).all()


def test_a_rising_end_is_heard_as_a_question() -> None:
    track = PhoneTrack((SILENCE, "AA", "AE", SILENCE), np.array([0, 0.5, 1.0, 1.3, 2.0]))
    for last, rises in ((120.0, False), (180.0, True), (90.0, False)):
        sound = hum(track, np.array([120.0, 120.0, last, 120.0]), np.array([0.0, 1, 1, 0]))
        phrases = find_phrases(track, hear_voice(sound))
        assert [phrase.rises for phrase in phrases] == [rises]
        brow = life(track, sound, seed=3).curve("browInnerUp")
        near = brow[int(1.0 * 60) : int(1.4 * 60)].max()
        assert (near > 0.3) == rises


# --- the curves ---


def test_the_same_seed_gives_the_same_life_and_another_seed_another() -> None:
    sound = read_audio(HELLO, RATE)
    one, same, other = (life(TALK, sound, seed=seed) for seed in (7, 7, 8))
    assert (one.values == same.values).all()
    assert not np.array_equal(one.values, other.values)
    for name in ("eyeBlinkLeft", *HEAD_ANGLES):
        assert np.abs(one.curve(name) - other.curve(name)).max() > 1e-3, name


def test_what_is_said_later_does_not_change_what_came_before() -> None:
    end = int(np.searchsorted(TALK.edges, 10.0))
    while TALK.phones[end - 1] != SILENCE:
        end += 1
    start = PhoneTrack(
        TALK.phones[:end], TALK.edges[: end + 1], tuple(w for w in TALK.words if w.stop <= end)
    )
    part, whole = life(start, seed=4), life(TALK, seed=4)
    frames = int((start.end - 1.5) * 60)  # the head goes to rest in the last half second
    assert np.allclose(part.values[:frames], whole.values[:frames], atol=1e-6)


def test_the_mouth_is_never_touched(head: Head) -> None:
    living = life(TALK, seed=1)
    mouth = GROUPS["jaw"] + GROUPS["lips"] + GROUPS["tongue"] + GROUPS["cheeks"]
    assert not set(living.names) & set(mouth)
    added = add_life(SPEECH, TALK, seed=1)
    assert (added.select(mouth).values == SPEECH.select(mouth).values).all()
    before, after = (head.aperture_curve(c.select(CANONICAL).values) for c in (SPEECH, added))
    assert (before == after).all()


def test_no_amount_is_no_change_and_double_is_larger() -> None:
    assert add_life(SPEECH, TALK, amount=0.0) is SPEECH
    assert not life(TALK, amount=0.0).values.any()
    once, twice = (life(TALK, seed=2, amount=amount) for amount in (1.0, 2.0))
    double = 2 * once.select(HEAD_ANGLES).values - twice.select(HEAD_ANGLES).values
    assert np.abs(double).max() < 1e-3, "but for the fastest turns"
    assert (blinks_of(once) == blinks_of(twice)).all(), "blinks stay as they are"


def test_blinks_come_at_published_rates_and_mostly_where_phrases_end() -> None:
    track = talk(600)
    phrases = find_phrases(track)
    rate = 60 / track.end
    counts, near = [], []
    for seed in range(3):
        times = np.array([b.start for b in plan_blinks(
            phrases, track.end, 60, np.random.default_rng(seed))])  # fmt: skip
        counts.append(len(times) * rate)
        ends = np.array([phrase.end for phrase in phrases])
        near.append(np.mean([(np.abs(ends + 0.1 - time) < 0.3).any() for time in times]))
    # Doughty 2001: 10.5 to 32.5 a minute in conversation.
    assert 15 < min(counts) <= max(counts) < 30
    chance = 0.6 * len(phrases) / track.end
    assert min(near) > 1.5 * chance
    alone = plan_blinks([], 600, 60, np.random.default_rng(0))
    assert len(alone) / 10 == pytest.approx(60 / RESTING, rel=0.2)
    talking = plan_blinks([Phrase(0, 600, False)], 600, 60, np.random.default_rng(0))
    assert len(talking) / 10 == pytest.approx(60 / TALKING, rel=0.2)


def test_blinks_shut_the_eyes_close_fast_and_open_slowly() -> None:
    living = life(TALK, fps=240, seed=5)
    lids = living.curve("eyeBlinkLeft")
    assert (lids == living.curve("eyeBlinkRight")).all()
    times = blinks_of(living)
    assert len(times) > 3
    for time in times:
        first = round(time * 240)
        near = lids[first - 24 : first + 96]
        assert near.max() == 1
        shut = np.flatnonzero(near == 1)
        begin = np.flatnonzero(near[: shut[0]] == 0)[-1]
        end = shut[-1] + np.flatnonzero(near[shut[-1] :] == 0)[0]
        closing, opening = (shut[0] - begin) / 240, (end - shut[-1]) / 240
        assert CLOSING[0] - 0.01 < closing < CLOSING[1] + 0.01
        assert OPENING[0] - 0.01 < opening < OPENING[1] + 0.01
        assert 0.1 < (end - begin) / 240 < 0.4


@pytest.mark.parametrize("fps", [24, 25, 29.97, 30, 60])
def test_every_blink_is_shut_in_some_frame(fps: float) -> None:
    living = life(talk(60), fps=fps, seed=6)
    lids = living.curve("eyeBlinkLeft")
    for time in blinks_of(living):
        frame = round(time * fps)
        assert lids[frame : frame + round(0.2 * fps) + 1].max() > 0.98


def test_wide_eyes_shut_for_a_blink_and_return() -> None:
    wide = expression({"eyeWide": 0.8, "browInnerUp": 0.5})(SPEECH, TALK)
    added = add_life(wide, TALK, seed=5)
    lids, eyes = added.curve("eyeBlinkLeft"), added.curve("eyeWideLeft")
    assert eyes[lids == 1].max(initial=0) == 0
    assert (eyes[lids == 0] == np.float32(0.8)).all()
    assert added.curve("browInnerUp").min() >= np.float32(0.5)
    assert added.select(CANONICAL).values.max() <= 1


def test_eyes_stay_on_the_viewer_while_the_head_turns(head: Head) -> None:
    living = life(TALK, seed=2)
    open_eyes = living.curve("eyeBlinkLeft") == 0
    yaw, pitch, _ = np.degrees(living.select(HEAD_ANGLES).values.astype(float)).T
    gaze = sum(np.outer(living.curve(name), turn) for name, turn in FULL_TURNS.items())
    looks = np.asarray(gaze) + np.stack([yaw, pitch], axis=1)
    assert np.abs(looks[open_eyes]).max() <= FARTHEST * max(GLANCE) + 0.01, "degrees"
    for name, expected in FULL_TURNS.items():
        part = next(part for part in head.parts if part.name == "eyeLeft")
        moved, by = head.shape(name)
        ball = head.vertices[part.vertices].astype(float)
        posed = ball.copy()
        mine = (moved >= part.vertices.start) & (moved < part.vertices.stop)
        posed[moved[mine] - part.vertices.start] += by[mine]
        left, _, right = np.linalg.svd((ball - ball.mean(axis=0)).T @ (posed - posed.mean(axis=0)))
        x, y, z = right.T @ left.T @ [0, 0, 1]
        found = np.degrees([np.arctan2(x, z), np.arcsin(y)])
        assert np.allclose(found, expected, atol=0.01), name


def test_no_head_turns_too_fast_at_any_amount() -> None:
    for amount in (1.0, 2.0):
        living = life(talk(120), fps=30, seed=3, amount=amount)
        degrees = np.degrees(living.select(HEAD_ANGLES).values.astype(np.float64))
        assert np.abs(np.diff(degrees, axis=0)).max() * 30 <= FASTEST + 1e-3


@pytest.mark.parametrize("seed", range(4))
def test_heads_stay_near_rest_slow_and_within_limits(seed: int) -> None:
    living = life(talk(120), seed=seed)
    degrees = np.degrees(living.select(HEAD_ANGLES).values)
    assert (np.abs(degrees).max(axis=0) < LIMITS).all()
    assert (np.abs(degrees.mean(axis=0)) < 1.0).all()
    assert 0.5 < degrees.std() < 4
    assert (degrees[[0, -1]] == 0).all(), "from rest, and back to it"
    assert np.abs(np.diff(degrees, axis=0)).max() * 60 < 60, "degrees a second"
    assert np.abs(np.diff(degrees, 2, axis=0)).max() * 60**2 < 900, "no jerk"


def test_most_of_the_heads_motion_is_slow_and_it_settles_in_pauses() -> None:
    track = PhoneTrack((*TALK.phones, SILENCE), np.append(TALK.edges, TALK.end + 20), TALK.words)
    moved = []
    for seed in range(5):
        degrees = np.degrees(life(track, seed=seed).select(HEAD_ANGLES).values)
        speech, rest = degrees[60 : int(TALK.end * 60)], degrees[int(TALK.end * 60) + 60 : -60]
        moved.append((speech.std(axis=0).mean(), rest.std(axis=0).mean()))
        power = np.abs(np.fft.rfft(speech - speech.mean(axis=0), axis=0)) ** 2
        hertz = np.fft.rfftfreq(len(speech), 1 / 60)
        assert power[hertz < 3].sum() > 0.97 * power.sum()
    talking, resting = np.mean(moved, axis=0)
    assert 0.05 < resting < 0.5 * talking, "still, but not frozen"


def test_the_head_nods_and_the_brows_rise_with_the_accent() -> None:
    track, sound = planted(3, "loudness")
    accent = float(track.edges[1 + 3 * 3 + 1])
    nods, brows = [], []
    for seed in range(24):
        living = life(track, sound, seed=seed)
        pitch = np.degrees(living.curve("headPitch"))
        before, deepest = (pitch[round((accent + after) * 60)] for after in (0.0, 0.24))
        nods.append(deepest - before)
        near = np.abs(living.times - accent) < 0.05
        brows.append(living.curve("browInnerUp")[near].max())
    assert np.mean(nods) < -1, "degrees down"
    assert 0.3 < np.mean(np.array(brows) > 0.2) < 0.95, "often, not always"


def test_the_head_follows_the_melody_of_the_voice() -> None:
    track, _ = planted(0, "length")
    rising = np.array([120.0, *np.linspace(90, 180, 18), 120.0])
    found = []
    for hertz in (rising, rising[::-1]):
        sound = hum(track, hertz, np.array([0.0, *[1.0] * 18, 0.0]))
        found.append(np.degrees(life(track, sound, seed=1).curve("headPitch")))
    start, end = (slice(round(t * 60) - 6, round(t * 60) + 6) for t in (1.1, 2.3))
    higher = found[0] - found[1]  # of the same life but for the melody and the nods
    assert higher[end].mean() > 1 > -1 > higher[start].mean()


@quick
@given(st.floats(0.2, 3), st.integers(0, 2**32))
def test_smooth_noise_has_no_corners_and_the_same_beginning(step: float, seed: int) -> None:
    times = np.arange(3000) / 100
    short, long = (smooth_noise(times[:n], step, np.random.default_rng(seed)) for n in (1500, 3000))
    assert (short == long[:1500]).all()
    assert np.abs(np.diff(long, 3)).max() < 60 * (0.01 / step) ** 3 + 1e-9


def test_glances_are_small_and_quick() -> None:
    times = np.arange(0, 300, 1 / 120)
    sideways, up = gaze_degrees(times, np.random.default_rng(1))
    for curve, size in zip((sideways, up), GLANCE, strict=True):
        assert np.abs(curve).max() <= FARTHEST * size
        moving = np.abs(np.diff(curve)) > 1e-9
        assert 0.01 < moving.mean() < 0.1, "eyes rest most of the time"


# --- lengths, and what is refused ---


@pytest.mark.parametrize("seconds", [0.01, 0.3, 1.0])
@pytest.mark.parametrize("phone", ["AA", SILENCE])
def test_a_moment_of_sound_has_a_quiet_life(seconds: float, phone: str) -> None:
    track = PhoneTrack((phone,), np.array([0.0, seconds]))
    sound = Audio(np.full(round(seconds * RATE), 0.1, np.float32), RATE)
    for audio in (None, sound):
        living = life(track, audio, seed=1)
        assert np.isfinite(living.values).all()
        assert not blinks_of(living).size or seconds >= 0.6
        assert np.degrees(np.abs(living.select(HEAD_ANGLES).values)).max() < 6


def test_an_hour_is_made_in_one_go() -> None:
    track = talk(3600)
    living = life(track, fps=30, seed=1)
    assert len(living) == int(np.ceil(track.end * 30 - 1e-6)) + 1
    assert 15 < len(blinks_of(living)) / 60 < 30


def test_sound_that_is_shorter_or_longer_than_the_track_is_heard_where_it_is() -> None:
    for seconds in (0.0, 1.0, 60.0):
        sound = Audio(np.random.default_rng(0).normal(0, 0.1, round(seconds * RATE)), RATE)
        assert np.isfinite(life(TALK, sound).values).all()


def test_a_clip_of_other_length_is_filled() -> None:
    half = SPEECH.with_values(SPEECH.values[:300])
    assert len(add_life(half, TALK)) == 300
    turned = SPEECH.select((*CANONICAL, *HEAD_ANGLES)).with_curves(
        {"headYaw": np.full(len(SPEECH), 0.2)}
    )
    plain, added = (add_life(c, TALK, seed=3).curve("headYaw") for c in (SPEECH, turned))
    assert np.allclose(added, plain + np.float32(0.2)), "angles add"


def test_wrong_choices_are_refused() -> None:
    for seed in (-1, 1.5, True):
        with pytest.raises(LipwrightError, match="whole number from 0 on"):
            life(TALK, seed=seed)  # type: ignore[arg-type]
    for amount in (-0.1, 2.1, float("nan")):
        with pytest.raises(LipwrightError, match="from 0 to 2"):
            life(TALK, amount=amount)
    with pytest.raises(LipwrightError, match="before retargeting"):
        add_life(Clip(("mode 1",), 60, np.zeros((9, 1), np.float32)), TALK)


def test_a_span_of_a_voice_has_a_frame() -> None:
    voice = Voice(np.zeros(10), np.zeros(10))
    assert len(voice.level[voice.span(0.05, 0.051)]) == 1
    assert len(voice.level[voice.span(0.0, 10 * STEP)]) == 10
