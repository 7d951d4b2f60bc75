"""From phones to curves: engine, passes, layers."""

from __future__ import annotations

from lipwright.audio import Sound
from lipwright.clip import Clip
from lipwright.engines import OF_BIGRAMS, get_engine
from lipwright.passes import apply_passes, expression, finishing_passes
from lipwright.pipeline.options import AnimateOptions, moves_heads, rig_of
from lipwright.rig import canonical_rig
from lipwright.track import PhoneTrack


def animate_track(
    track: PhoneTrack, options: AnimateOptions | None = None, audio: Sound | None = None
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
    clip: Clip, track: PhoneTrack, options: AnimateOptions, audio: Sound | None
) -> Clip:
    """Expressions over speech, and life over both."""
    layers = [expression(layer, amount) for layer, amount in options.expressions]
    clip = apply_passes(clip, track, layers)
    if options.life == 0:
        return clip
    from lipwright.life import add_life

    return add_life(clip, track, audio, options.seed, options.life)
