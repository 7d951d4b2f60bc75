"""From a recording to a performance."""

from __future__ import annotations

from lipwright.audio import AudioFile, open_audio
from lipwright.errors import LipwrightError
from lipwright.export.performance import Performance
from lipwright.export.rigged import for_rig
from lipwright.formats.intervals import fit_track
from lipwright.pipeline.motion import animate_track
from lipwright.pipeline.options import AnimateOptions, PathLike, Report, quiet
from lipwright.pipeline.values import Result
from lipwright.pipeline.words import (
    ALIGNMENT_RATE,
    DEFAULT,
    AlignOptions,
    align_sound,
    hear_sound,
    language_of,
)
from lipwright.streams import read_timings
from lipwright.track import PhoneTrack


def animate(
    speech: PathLike,
    text: str | None = None,
    *,
    phones: PathLike | PhoneTrack | None = None,
    options: AnimateOptions | None = None,
    alignment: AlignOptions | None = None,
    text_source: str = "text",
    report: Report = quiet,
) -> Result:
    """A recording as motion, with its words, its phones, or neither.

    Args:
        speech: the recording; any common sound or video file.
        text: the words that are said in it.
        phones: a phone track, or a file of one: then nothing is aligned. With neither words nor
            phones, what is said is recognised.
        options: engine, model, frame rate, intensity and passes.
        alignment: language, dictionary, aligner and recogniser.
        text_source: the text's name in errors.
        report: told how far it is.

    Raises:
        LipwrightError: an input cannot be used; the message names it, the place and the remedy.
    """
    if text is not None and phones is not None:
        raise LipwrightError(
            "give the words (text) or the phones of the recording, not both; leave one of them out"
        )
    options = options or AnimateOptions()
    rig = options.target  # before the work is done
    report("read", 0.0)
    with open_audio(speech, ALIGNMENT_RATE) as sound:
        report("read", 1.0)
        found, heard = None, None
        if phones is not None:
            track = _given(phones, sound, alignment or AlignOptions())
        elif text is not None:
            found = align_sound(sound, text, alignment, text_source, report)
            track = found.track
        else:
            heard = hear_sound(sound, alignment, report)
            found, track = heard.alignment, heard.alignment.track
        report("animate", 0.0)
        clip = animate_track(track, options, sound)
        performance = for_rig(Performance(clip, track, speech), rig)
        report("animate", 1.0)
    return Result(performance, found, heard)


def _given(phones: PathLike | PhoneTrack, sound: AudioFile, options: AlignOptions) -> PhoneTrack:
    """A phone track as long as the sound."""
    if isinstance(phones, PhoneTrack):
        places = [f"phone {number}" for number in range(1, len(phones) + 1)]
        return fit_track("phones", phones, places, sound.duration)
    return read_timings(
        phones,
        language=language_of(options.language or DEFAULT, "", str(phones)),
        duration=sound.duration,
    )
