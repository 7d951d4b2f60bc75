"""Capturing one recording: a column of verbs from its files to a folder of the dataset."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

from lipwright.audio import open_audio, write_flac
from lipwright.capture.filling import filled
from lipwright.capture.observe import (
    Observation,
    contact_picture,
    head_aperture,
    observe_arkit,
    observe_video,
    with_own_sound,
)
from lipwright.capture.offset import Offset, estimate_offset
from lipwright.capture.quality import measure_quality
from lipwright.capture.rejection import reject_reasons
from lipwright.capture.resume import edited_phones, files_of, finished, key_of
from lipwright.capture.sources import Source
from lipwright.capture.tracker import Progress
from lipwright.dataset.folder import RECORDINGS, recording_files, sha256_of
from lipwright.dataset.recording import (
    AUDIO_FILE,
    MOTION_FILE,
    PHONES_FILE,
    PICTURE_FILE,
    save_motion,
    write_info,
)
from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.face.head import load_head
from lipwright.formats import read_track, write_track
from lipwright.pipeline import ALIGNMENT_RATE, AlignOptions, align_sound
from lipwright.speech import Alignment
from lipwright.track import PhoneTrack
from lipwright.version import VERSION

MAX_SOUND_RATE: Final = 48000  # Hz, of the sound that is kept
LEAST_OVERLAP: Final = 0.5  # of the longer of picture and sound, in the shorter
MOST_APART: Final = 1.0  # s between the ends of picture and sound that nobody is told of
LEAST_ROOM: Final = 16 << 20  # bytes that must be free before a recording is tracked


@dataclass(frozen=True)
class CaptureOptions:
    """How recordings are captured, and what the manifest says of them."""

    language: str = "en"
    dictionary: Path | None = None
    """a file of pronunciations that override the lexicon"""
    tracker: str = "mediapipe"
    fps: float | None = 30.0
    """frames a second of ARKit recordings, as in the thesis (4.2.1); None keeps theirs"""
    tied: bool = True
    """left and right ARKit weights move alike"""
    reject: bool = False
    """leave out what the report advises to leave out"""
    name: str = ""
    """of the dataset"""
    licence: str = ""
    """of the recordings"""

    def shaping(self) -> dict[str, Any]:
        """The options on which the captured files depend."""
        dictionary = None if self.dictionary is None else sha256_of(self.dictionary)
        return {
            "language": self.language, "dictionary": dictionary, "tracker": self.tracker,
            "fps": self.fps, "tied": self.tied,
        }  # fmt: skip


@dataclass(frozen=True)
class Outcome:
    """What became of one source."""

    name: str
    error: str | None = None
    """why it was not captured, as one line"""
    warnings: tuple[str, ...] = ()
    reasons: tuple[str, ...] = ()
    """why the recording should be left out"""
    fresh: bool = field(default=True, compare=False)
    """False where an earlier run had captured it"""


def prepare(sources: Sequence[Source], options: CaptureOptions) -> None:
    """Find out now, rather than in every recording, what all of them lack.

    Raises:
        MissingExtraError: the extra `capture` is not installed.
        LipwrightError: the head, the tracker's model, the language or the dictionary is missing.
    """
    from lipwright.capture.tracker import get_tracker
    from lipwright.language import get_language, read_dictionary

    load_head()
    get_language(options.language)
    if options.dictionary is not None:
        read_dictionary(options.dictionary)
    for package in ("jinja2", "PIL", "cv2"):
        if find_spec(package) is None:
            raise MissingExtraError("the quality report", "capture")
    if any(source.is_video and source.problem is None for source in sources):
        get_tracker(options.tracker)


def capture_recording(
    source: Source, path: Path, options: CaptureOptions, progress: Progress = lambda share: None
) -> Outcome:
    """Capture one source into the dataset at `path`; what goes wrong is in the outcome.

    A recording that was captured from the same files in the same way is left as it is.
    """
    folder = path / RECORDINGS / source.name
    try:
        hashes = {role: sha256_of(file) for role, file in files_of(source).items()}
        key = key_of(source, options, hashes)
        if (info := finished(folder, key)) is None:
            origin = _origin(source, options, key, hashes)
            info = _capture(source, folder, options, origin, progress)
            fresh = True
        else:
            fresh = False
    except LipwrightError as error:
        return _failure(source, str(error))
    except OSError as error:
        reason = error.strerror or str(error)
        return _failure(source, f"{error.filename or folder}: {reason}; check the disk")
    except ImportError:  # the installation's fault, and no recording's
        raise
    except Exception as error:  # the other recordings go on
        if os.environ.get("LIPWRIGHT_DEBUG"):
            raise
        return _failure(
            source,
            f"failed inside ({type(error).__name__}: {error}); this is a bug: run again with "
            "LIPWRIGHT_DEBUG=1 and report what it prints",
        )
    return Outcome(
        source.name, warnings=tuple(info["warnings"]), reasons=tuple(info["reject"]), fresh=fresh
    )


def _failure(source: Source, message: str) -> Outcome:
    places = (source.face, source.audio, source.phones, source.text_source)
    if not any(str(place) in message for place in places if place):
        message = f"{source.face}: {message}"
    return Outcome(source.name, error=" ".join(message.split()))


def _capture(
    source: Source, folder: Path, options: CaptureOptions, origin: dict[str, Any],
    progress: Progress,
) -> dict[str, Any]:  # fmt: skip
    _check_room(folder.parent)
    edited = edited_phones(folder)
    seen, alignment = _observe(source, edited, options, progress)
    track = alignment.track
    offset = _offset(seen, track)
    lag = (offset.seconds if offset.trusted else 0.0) - seen.start
    motion = seen.to_motion(track, lag, tied=options.tied)
    quality = measure_quality(
        motion, track, lag, misfits=len(alignment.misfits), landmarks_raw=seen.landmarks_raw,
        arkit_aperture=head_aperture(motion.arkit),
    )  # fmt: skip
    info = {
        **origin,
        "tracker": seen.tracker,
        "fps": seen.fps,
        "frames": len(seen.flags),
        "start": round(seen.start, 6),
        **_said(source, seen, alignment),
        "offset": offset.to_info(),
        "quality": quality,
        "reject": reject_reasons(quality, offset=offset.to_info()),
    }
    if edited is not None:
        info["edited_phones"] = True
    with filled(folder) as part:
        save_motion(part / MOTION_FILE, motion)
        if edited is None:
            write_track(part / PHONES_FILE, track)
        else:
            shutil.copyfile(folder / PHONES_FILE, part / PHONES_FILE)
        _save_sound(part / AUDIO_FILE, source.audio or source.face)
        if picture := contact_picture(seen, motion, track, lag):
            (part / PICTURE_FILE).write_bytes(picture)
        info["files"] = recording_files(part)
        write_info(part, info)
    return info


def _observe(
    source: Source, edited: PhoneTrack | None, options: CaptureOptions, progress: Progress
) -> tuple[Observation, Alignment]:
    """What is seen, and what is said when; the cheap questions come first."""
    with open_audio(source.audio or source.face, ALIGNMENT_RATE) as sound:
        if edited is not None:
            alignment = Alignment(edited)
        elif source.phones is not None:
            alignment = Alignment(read_track(source.phones, duration=sound.duration))
        else:
            assert source.text is not None  # sources without words have a problem
            words = AlignOptions(options.language, options.dictionary)
            alignment = align_sound(sound, source.text, words, source.text_source)
        if source.is_video:
            seen = observe_video(source.face, options.tracker, progress)
        else:
            seen = observe_arkit(source.face, options.fps)
        if source.audio is not None:
            seen = with_own_sound(seen)
        seen = _check_lengths(source, seen, sound.duration)
    if edited is not None:
        kept = f"{source.name}: the edited {PHONES_FILE} is kept; delete it to align again"
        seen = replace(seen, warnings=(*seen.warnings, kept))
    return seen, alignment


def _save_sound(path: Path, source: Path) -> None:
    with open_audio(source) as sound:
        if sound.rate <= MAX_SOUND_RATE:
            write_flac(path, sound)
            return
    with open_audio(source, MAX_SOUND_RATE) as sound:
        write_flac(path, sound)


def _check_room(place: Path) -> None:
    """A full disk is noticed before minutes of tracking."""
    if shutil.disk_usage(place).free < LEAST_ROOM:
        raise LipwrightError(f"{place.parent}: no space left on the disk; make room and run again")


def _check_lengths(source: Source, seen: Observation, sound: float) -> Observation:
    """Refuse what is not of one recording, and warn where much of one is without the other."""
    picture = seen.start + seen.duration
    lengths = f"{source.face}: the picture lasts {picture:.1f} s and the sound {sound:.1f} s"
    if min(picture, sound) < LEAST_OVERLAP * max(picture, sound):
        raise LipwrightError(f"{lengths}; they are not of one recording")
    if abs(picture - sound) <= MOST_APART:
        return seen
    return replace(seen, warnings=(*seen.warnings, f"{lengths}; cut them alike"))


def _offset(seen: Observation, track: PhoneTrack) -> Offset:
    lips = seen.lips()
    if lips is None:
        return Offset(0.0, float("nan"), float("nan"), trusted=False)
    return estimate_offset(lips, track)


def _origin(
    source: Source, options: CaptureOptions, key: str, hashes: Mapping[str, str]
) -> dict[str, Any]:
    """Where the recording comes from and how it is captured."""
    files = {
        role: {"path": str(file.resolve()), "sha256": hashes[role]}
        for role, file in files_of(source).items()
    }
    return {
        "name": source.name, "key": key, "lipwright": VERSION, "source": files,
        "options": options.shaping(),
    }  # fmt: skip


def _said(source: Source, seen: Observation, alignment: Alignment) -> dict[str, Any]:
    """The words, and what was odd on the way."""
    return {
        "text": source.text,
        "words": _words(alignment.track),
        "misfits": [asdict(misfit) for misfit in alignment.misfits],
        "unwritten": [list(span) for span in alignment.unwritten],
        "warnings": [*seen.warnings, *_alignment_warnings(source, alignment)],
    }


def _words(track: PhoneTrack) -> list[dict[str, Any]]:
    rows = []
    for word in track.words:
        start, end = track.word_span(word)
        sure = None if word.confidence is None else round(word.confidence, 4)
        rows.append(
            {"text": word.text, "start": round(start, 4), "end": round(end, 4), "confidence": sure}
        )
    return rows


def _alignment_warnings(source: Source, alignment: Alignment) -> Iterator[str]:
    for misfit in alignment.misfits:
        yield (
            f"{source.face}: {(misfit.written or misfit.text)[:40]!r} does not fit the sound at "
            f"{misfit.start:.2f} to {misfit.end:.2f} s"
        )
    for start, end in alignment.unwritten:
        yield f"{source.face}: speech at {start:.2f} to {end:.2f} s has no words"
