"""From speech to motion: the column of verbs.

audio, words -> align -> track -> engine -> clip -> passes -> rig -> performance
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Final

from lipwright.audio import AudioFile, open_audio
from lipwright.clip import Clip
from lipwright.controls import CANONICAL, HEAD_ANGLES
from lipwright.engines import (
    OF_BIGRAMS,
    choose_engine,
    engine_controls,
    engine_learnt,
    get_engine,
)
from lipwright.errors import LipwrightError
from lipwright.export.performance import Performance, check_rate
from lipwright.export.rigged import for_rig
from lipwright.formats import read_track
from lipwright.formats.intervals import fit_track
from lipwright.language import get_language, read_dictionary
from lipwright.passes import (
    Pass,
    apply_passes,
    bigram_passes,
    default_passes,
    expression,
    finishing_passes,
    learnt_passes,
)
from lipwright.rig import Rig, canonical_rig, load_rig
from lipwright.speech import Alignment, align
from lipwright.track import PhoneTrack

if TYPE_CHECKING:
    from lipwright.bigrams.values import BigramSet

PathLike = str | os.PathLike[str]
Report = Callable[[str, float], None]
"""called with the stage's name and the share of it that is done, 0 to 1"""

ALIGNMENT_RATE = 16000  # Hz, what the aligner hears
MOST_WORDS = 20.0  # a second of sound; the fastest speakers reach 11
SPARE_WORDS = 100  # for notes and marks that are not said
_FOR_BIGRAMS: Final = (None, OF_BIGRAMS)


@dataclass(frozen=True)
class AlignOptions:
    """How words are put on the sound."""

    language: str = "en"
    dictionary: PathLike | None = None
    """a file of pronunciations that override the lexicon"""
    aligner: str = "sphinx"


@dataclass(frozen=True)
class AnimateOptions:
    """How phones become motion.

    Raises:
        LipwrightError: fps or intensity out of range, no such engine, or a model or bigram set
            for one that runs none.
    """

    engine: str | None = None
    """a name; by default `window` where a model is given, or else the default engine"""
    model: str | Path | None = None
    """of the engine `window`: the name of one that ships, or a model's folder"""
    bigrams: str | Path | BigramSet | None = None
    """of the engine `bigram`: the name of a set that ships, a set's file, or a set"""
    fps: float = 60.0
    """frames a second, 0.1 to 1000"""
    intensity: float = 1.0
    """0.5 mumbles, 1.5 over-articulates"""
    intensities: Mapping[str, float] = field(default_factory=dict)
    """amount by control, part of the face or class of phones; see `passes.intensities`"""
    expressions: tuple[tuple[Clip | Mapping[str, float], float], ...] = ()
    """poses or clips that lie over the speech, each with its amount; see `passes.expression`"""
    life: float = 0.0
    """blinks, glances, brows and head motion, 0 (none) to 2; 1 is usual"""
    seed: int = 0
    """which of many lives, from 0 on"""
    rig: str | Path | Rig | None = None
    """whom the curves move: the name of a rig that ships, a rig's file, or a rig; by default
    canonical controls stay"""
    passes: tuple[Pass, ...] | None = None
    """instead of the default passes; then intensities are not used"""

    def __post_init__(self) -> None:
        """Check."""
        if self.bigrams is not None and (self.model is not None or self.engine not in _FOR_BIGRAMS):
            other = "--model" if self.model is not None else f"the engine {self.engine}"
            raise LipwrightError(
                f"--bigrams is for the engine {OF_BIGRAMS}, not for {other}; leave one of them out"
            )
        choose_engine(*self.runs)
        check_rate(self.fps)
        if self.passes is None:
            default_passes(self.intensity, self.intensities)  # refuses what it cannot use
        if self.life or self.seed:
            from lipwright.life import check_life

            check_life(self.life, self.seed)

    @property
    def runs(self) -> tuple[str | None, str | Path | BigramSet | None]:
        """The engine, and the model or the bigram set that it runs; None for the default."""
        if self.bigrams is not None:
            return OF_BIGRAMS, self.bigrams
        return self.engine, self.model

    @cached_property
    def bigram_set(self) -> BigramSet | None:
        """The bigram set that is animated with; None with another engine.

        Raises:
            LipwrightError: the set cannot be used.
        """
        name, model = self.runs
        if choose_engine(name, model) != OF_BIGRAMS:
            return None
        from lipwright.engines.bigram import open_set

        return open_set(model)

    @cached_property
    def target(self) -> Rig | None:
        """The rig that the curves are retargeted to; None for none.

        Raises:
            LipwrightError: it cannot be used.
        """
        return self.rig if self.rig is None or isinstance(self.rig, Rig) else load_rig(self.rig)

    def controls(self) -> tuple[str, ...]:
        """The controls of the clips that `animate_track` makes.

        Canonical ones, or modes of a reference face, or poses of a creature.

        Raises:
            LipwrightError: the model or set cannot be used.
        """
        bigrams = self.bigram_set
        if bigrams is None:
            return engine_controls(*self.runs)
        rig = rig_of(bigrams)
        return CANONICAL if rig.looks else rig.names

    def refuse_layers(self, names: tuple[str, ...]) -> None:
        """Refuse expressions and life over curves that move no human head.

        Raises:
            LipwrightError: there are some.
        """
        if self.expressions or self.life:
            raise LipwrightError(
                f"expressions and life move canonical controls, and these curves are {names[0]} to "
                f"{names[-1]}; leave --expression and --life out"
            )

    def chosen_passes(self) -> tuple[Pass, ...]:
        """The passes to apply to what the engine gives, in order.

        Raises:
            LipwrightError: the model or set cannot be used.
        """
        if self.passes is not None:
            return self.passes
        bigrams = self.bigram_set
        if bigrams is not None:
            return tuple(bigram_passes(bigrams))
        phones, controls = engine_learnt(*self.runs)
        if not phones:
            return tuple(default_passes(self.intensity, self.intensities))
        return tuple(learnt_passes(self.intensity, phones, controls, self.intensities))


def rig_of(bigrams: BigramSet) -> Rig:
    """The rig whose controls are the poses of a bigram set.

    Raises:
        LipwrightError: the rig cannot be used, or lacks a pose of the set; names it.
    """
    who = f"the bigram set {bigrams.name!r}"
    try:
        rig = load_rig(bigrams.rig)
    except LipwrightError as error:
        raise LipwrightError(f"the rig of {who}: {error}") from error
    rig.check_controls(bigrams.poses, who)
    return rig


@dataclass(frozen=True, eq=False)
class Result:
    """What `animate` gives: the performance, and what was odd on the way."""

    performance: Performance
    alignment: Alignment | None = field(default=None)
    """None where a phone track was given"""

    @property
    def clip(self) -> Clip:
        """The curves."""
        return self.performance.clip

    @property
    def track(self) -> PhoneTrack:
        """The phones that they follow."""
        assert self.performance.track is not None  # animate always sets it
        return self.performance.track


def _quiet(stage: str, share: float) -> None:
    del stage, share


def align_sound(
    sound: AudioFile, text: str, options: AlignOptions | None = None,
    source: str = "text", report: Report = _quiet,
) -> Alignment:  # fmt: skip
    """Words on an open sound of 16 kHz.

    Args:
        sound: what is heard.
        text: what is said.
        options: language, dictionary and aligner.
        source: the text's name in errors.
        report: told how far it is.

    Raises:
        LipwrightError: text, dictionary or sound cannot be used, or they do not fit each other.
    """
    options = options or AlignOptions()
    language = get_language(options.language)
    dictionary = None if options.dictionary is None else read_dictionary(Path(options.dictionary))
    most = SPARE_WORDS + MOST_WORDS * sound.duration
    if (count := len(text.split())) > most:
        raise LipwrightError(
            f"{source}: {count} words cannot be said in {sound.duration:.1f} s, which {sound.name} "
            "lasts; give the words of this recording"
        )
    words = language.normalize(text, source, dictionary)
    return align(
        sound, words, options.language, dictionary, options.aligner,
        progress=lambda share: report("align", share),
    )  # fmt: skip


def align_speech(
    speech: PathLike, text: str, options: AlignOptions | None = None,
    source: str = "text", report: Report = _quiet,
) -> Alignment:  # fmt: skip
    """Words on the sound of a file; see `align_sound`."""
    with open_audio(speech, ALIGNMENT_RATE) as sound:
        return align_sound(sound, text, options, source, report)


def moves_heads(names: Iterable[str]) -> bool:
    """Whether controls are canonical ones, which heads have, rather than modes of one speaker."""
    return set(names) <= {*CANONICAL, *HEAD_ANGLES}


def animate_track(
    track: PhoneTrack, options: AnimateOptions | None = None, audio: AudioFile | None = None
) -> Clip:
    """The motion of a phone track, in the canonical controls.

    A model that predicts modes of a reference face gives those, as they are: passes know nothing of
    them. A bigram set of a creature, whose rig has no looks on a human face, gives
    the creature's poses.

    Raises:
        LipwrightError: the model or bigram set cannot be used.
    """
    options = options or AnimateOptions()
    bigrams = options.bigram_set
    rig = rig_of(bigrams) if bigrams is not None else None  # before the work is done
    engine = get_engine(*options.runs) if bigrams is None else get_engine(OF_BIGRAMS, bigrams)
    clip = engine(track, options.fps, audio)
    if rig is None and not moves_heads(clip.names):
        options.refuse_layers(clip.names)
        return clip
    clip = apply_passes(clip, track, options.chosen_passes())
    if rig is not None and not rig.looks:
        options.refuse_layers(rig.names)
        return rig.fit(clip)
    if rig is not None:
        clip = rig.to_canonical(clip)
        own = options.passes is None
        amounts = (options.intensity, options.intensities) if own else ()
        clip = apply_passes(clip, track, finishing_passes(*amounts))
    return _with_layers(canonical_rig().fit(clip), track, options, audio)


def _with_layers(
    clip: Clip, track: PhoneTrack, options: AnimateOptions, audio: AudioFile | None
) -> Clip:
    """Expressions over speech, and life over both."""
    layers = [expression(layer, amount) for layer, amount in options.expressions]
    clip = apply_passes(clip, track, layers)
    if options.life == 0:
        return clip
    from lipwright.life import add_life

    return add_life(clip, track, audio, options.seed, options.life)


def animate(
    speech: PathLike,
    text: str | None = None,
    *,
    phones: PathLike | PhoneTrack | None = None,
    options: AnimateOptions | None = None,
    alignment: AlignOptions | None = None,
    text_source: str = "text",
    report: Report = _quiet,
) -> Result:
    """A recording and its words, or its phones, as motion.

    Args:
        speech: the recording; any common sound or video file.
        text: the words that are said in it. Give `text` or `phones`.
        phones: a phone track, or a file of one: then nothing is aligned.
        options: engine, model, frame rate, intensity and passes.
        alignment: language, dictionary and aligner.
        text_source: the text's name in errors.
        report: told how far it is.

    Raises:
        LipwrightError: an input cannot be used; the message names it, the place and the remedy.
    """
    if (text is None) == (phones is None):
        raise LipwrightError("give either the words (text) or the phones of the recording")
    options = options or AnimateOptions()
    rig = options.target  # before the work is done
    report("read", 0.0)
    with open_audio(speech, ALIGNMENT_RATE) as sound:
        report("read", 1.0)
        found = None
        if text is not None:
            found = align_sound(sound, text, alignment, text_source, report)
            track = found.track
        elif isinstance(phones, PhoneTrack):
            places = [f"phone {number}" for number in range(1, len(phones) + 1)]
            track = fit_track("phones", phones, places, sound.duration)
        else:
            assert phones is not None  # checked above
            track = read_track(phones, duration=sound.duration)
        report("animate", 0.0)
        clip = animate_track(track, options, sound)
        performance = for_rig(Performance(clip, track, speech), rig)
        report("animate", 1.0)
    return Result(performance, found)
