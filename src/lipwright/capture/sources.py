"""What there is to capture: faces with their sound, words and phones, matched by stem."""

from __future__ import annotations

import os
import unicodedata
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from lipwright.dataset.recording import safe_name
from lipwright.errors import LipwrightError
from lipwright.formats import TRACK_FORMATS

VIDEOS: Final = (
    ".mp4", ".mov", ".m4v", ".mkv", ".webm", ".avi", ".mpg", ".mpeg", ".wmv", ".flv", ".mts",
    ".m2ts", ".ts", ".3gp", ".3g2", ".ogv", ".mxf",
)  # fmt: skip
ARKIT_FILES: Final = (".csv", ".json")
SOUNDS: Final = (".flac", ".wav", ".mp3", ".m4a", ".aac", ".ogg", ".opus", ".aif", ".aiff", ".wma")
WORDS: Final = (".txt", ".lab", ".trn")
SEPARATORS: Final = "\t|"  # between name and words in a table of transcripts
MAX_TRANSCRIPTS: Final = 64 << 20  # bytes of a file of transcripts


@dataclass(frozen=True)
class Source:
    """One recording to capture."""

    name: str
    """stem of the face's file, with `_` for what no file's name may have"""
    face: Path
    """a video, or ARKit weights as .csv or .json"""
    audio: Path | None = None
    """the sound where it is not in the video"""
    text: str | None = None
    """the words"""
    text_source: str = "transcript"
    """where they come from, for errors"""
    phones: Path | None = None
    """a phone track to use instead of words"""
    problem: str | None = None
    """why it cannot be captured, as one line"""

    @property
    def is_video(self) -> bool:
        """Whether the face is still to be tracked."""
        return self.face.suffix.lower() not in ARKIT_FILES


def find_sources(
    faces: Sequence[Path],
    audio: Path | None = None,
    transcripts: Path | None = None,
    phones: Path | None = None,
) -> list[Source]:
    """The recordings that the user means, in the order of their names.

    Args:
        faces: videos and ARKit recordings, or folders of them.
        audio: a sound file for one recording, or a folder of them.
        transcripts: a text file for one recording, a table of names and words, or a folder.
        phones: a phone track for one recording, or a folder of them.

    Raises:
        LipwrightError: nothing to capture, two recordings of one name, or an option that names
            nothing.
    """
    named = {file.absolute(): file for face in faces for file in _faces_in(face)}
    files = list(named.values())
    if not files:
        raise LipwrightError("nothing to capture; name videos, or folders with videos")
    _check_names(files)
    for option, path in (("--audio", audio), ("--transcripts", transcripts), ("--phones", phones)):
        if path is None:
            continue
        if not _exists(path):
            raise LipwrightError(f"{path}: no such file or folder; {option} names nothing")
        if option != "--transcripts" and not _is_folder(path) and len(files) > 1:
            raise LipwrightError(
                f"{path}: one file cannot serve {len(files)} recordings; {option} takes a folder"
            )
    sounds = _Matches(audio, (*SOUNDS, *VIDEOS))
    tracks = _Matches(phones, tuple(TRACK_FORMATS))
    texts = _Transcripts(transcripts, files)
    found = [_source(file, sounds, texts, tracks) for file in files]
    return sorted(found, key=lambda source: source.name)


def _check_names(files: Sequence[Path]) -> None:
    by_name: dict[str, list[Path]] = defaultdict(list)
    for file in files:
        by_name[_folded(_name(file))].append(file)
    for alike in by_name.values():
        if len(alike) > 1:
            name, twice = _name(alike[0]), ", ".join(map(str, alike))
            raise LipwrightError(f"two recordings are named {name!r}: {twice}; rename one")


def _folded(stem: str) -> str:
    """Alike for names that some systems do not tell apart: by capitals, or accents on their own."""
    return unicodedata.normalize("NFC", stem).casefold()


def _faces_in(path: Path) -> list[Path]:
    if not _is_folder(path):
        return [path]
    there = _visible_in(path)
    files = [file for file in there if _is_file(file)]
    lost = [file for file in there if not _exists(file)]  # links to nothing are told
    faces = [file for file in (*files, *lost) if file.suffix.lower() in VIDEOS]
    return _with_takes(files, faces)


def _visible_in(folder: Path) -> list[Path]:
    try:
        return sorted(file for file in folder.iterdir() if not file.name.startswith("."))
    except OSError as error:
        raise LipwrightError(f"{folder}: cannot be read: {error.strerror}") from error


# Unlike those of pathlib these answer too where a name is too long or a folder is shut.
def _exists(path: Path) -> bool:
    return os.path.exists(path)  # noqa: PTH110


def _is_file(path: Path) -> bool:
    return os.path.isfile(path)  # noqa: PTH113


def _is_folder(path: Path) -> bool:
    return os.path.isdir(path)  # noqa: PTH112


def _with_takes(files: list[Path], videos: list[Path]) -> list[Path]:
    """The videos of a folder, but a Live Link recording instead of the movie beside it."""
    from lipwright.capture.arkit_import import find_takes, sounds_beside

    takes = list(find_takes(files))
    movies = {movie.resolve() for take in takes for movie in sounds_beside(take)}
    return [video for video in videos if video.resolve() not in movies] + takes


def _stems(face: Path) -> tuple[str, ...]:
    """The stems that files of a face may have, the most exact first."""
    if face.suffix.lower() not in ARKIT_FILES:
        return (face.stem,)
    from lipwright.capture.arkit_import import take_names

    return take_names(face)


def _name(face: Path) -> str:
    if face.suffix.lower() not in ARKIT_FILES:
        return safe_name(face.stem)
    from lipwright.capture.arkit_import import take_stem

    return safe_name(take_stem(face))


class _Matches:
    """The files of a folder by stem, or the one file that was named."""

    def __init__(self, path: Path | None, suffixes: tuple[str, ...]) -> None:
        self.path = path
        self._exact: dict[str, Path] = {}
        self._folded: dict[str, Path] = {}
        if path is not None and _is_folder(path):
            there = [file for file in _visible_in(path) if _is_file(file)]
            # The first suffix of the list wins where several files have one stem.
            for suffix in reversed(suffixes):
                for file in there:
                    if file.name.lower().endswith(suffix):
                        stem = file.name[: -len(suffix)]
                        self._exact[stem] = self._folded[_folded(stem)] = file

    def get(self, face: Path) -> Path | None:
        if self.path is not None and not _is_folder(self.path):
            return self.path
        found = (self._exact.get(stem) or self._folded.get(_folded(stem)) for stem in _stems(face))
        return next(filter(None, found), None)


class _Transcripts:
    """Words by stem: from a folder, a table, or the one file."""

    def __init__(self, path: Path | None, faces: Sequence[Path]) -> None:
        self.path = path
        self._files = _Matches(path, WORDS)
        self._lines: dict[str, tuple[str, str]] = {}
        if path is not None and _is_file(path):
            self._read_table(path, {_folded(stem) for face in faces for stem in _stems(face)})
            if not self._lines and len(faces) > 1:
                raise LipwrightError(
                    f"{path}: no line starts with a recording's name and a tab; give a folder of "
                    "NAME.txt, or a line `NAME<tab>words` for each"
                )

    def _read_table(self, path: Path, stems: set[str]) -> None:
        for number, line in enumerate(_read(path).splitlines(), 1):
            for separator in SEPARATORS:
                name, found, words = line.partition(separator)
                keys = (_folded(name.strip()), _folded(Path(name.strip()).stem))
                stem = next((key for key in keys if key in stems), None)
                if found and stem is not None:
                    # LJSpeech has the words as written and then as spoken.
                    spoken = words.rsplit(separator, 1)[-1].strip()
                    self._add_line(stem, spoken, f"{path}: line {number}")
                    break

    def _add_line(self, stem: str, words: str, place: str) -> None:
        before, where = self._lines.setdefault(stem, (words, place))
        if before != words:
            raise LipwrightError(f"{place}: {stem!r} has other words at {where}; keep one of them")

    def get(self, face: Path) -> tuple[str, str] | None:
        """Words and where they are from; None without any.

        Raises:
            LipwrightError: the file cannot be read.
        """
        if self._lines:
            found = (self._lines.get(_folded(stem)) for stem in _stems(face))
            return next(filter(None, found), None)
        file = self._files.get(face)
        return None if file is None else (_read(file), str(file))

    def missing(self, stem: str) -> str:
        if self.path is None:
            return "has no words; give them with --transcripts, or its phones with --phones"
        if self._lines:
            return f"{self.path} has no line for {stem!r}; add `{stem}<tab>words`"
        return f"{self.path} has no {stem}.txt; add it"


def _read(path: Path) -> str:
    try:
        with path.open("rb") as file:
            text = file.read(MAX_TRANSCRIPTS + 1)
        if len(text) > MAX_TRANSCRIPTS:
            raise LipwrightError(f"{path}: too long for a transcript; name a text file")
        return text.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise LipwrightError(f"{path}: line {line}: not UTF-8 text; save it as UTF-8") from error
    except OSError as error:
        raise LipwrightError(f"{path}: cannot be read: {error.strerror}") from error


def _source(face: Path, sounds: _Matches, texts: _Transcripts, tracks: _Matches) -> Source:
    name = _name(face)
    phones = tracks.get(face)
    try:
        audio = _sound(face, sounds)
        _check_files(face, audio, phones)
        text, text_source = (None, "") if phones is not None else _words(face, texts, tracks)
    except LipwrightError as error:
        problem = str(error)
        return Source(
            name, face, problem=problem if f"{name}." in problem else f"{face}: {problem}"
        )
    return Source(name, face, audio, text, text_source, phones)


def _check_files(*files: Path | None) -> None:
    for file in files:
        if file is not None and not _is_file(file):
            raise LipwrightError(f"{file}: is a device or pipe; save it to a file")


def _sound(face: Path, sounds: _Matches) -> Path | None:
    """The sound of a face; None where it is in the video."""
    if not _exists(face):
        raise LipwrightError(f"{face}: no such file; check the path")
    audio = sounds.get(face)
    if sounds.path is not None and audio is None:
        raise LipwrightError(f"{face}: {sounds.path} has no sound named {face.stem}; add it")
    if audio is not None and audio.resolve() == face.resolve():
        return None  # the video's own sound, whose start the video knows
    if audio is None and face.suffix.lower() in ARKIT_FILES:
        return _sound_beside(face)
    return audio


def _words(face: Path, texts: _Transcripts, tracks: _Matches) -> tuple[str, str]:
    found = texts.get(face)
    if texts.path is None and tracks.path is not None:
        raise LipwrightError(f"{face}: {tracks.path} has no {face.stem}.TextGrid; add it")
    if found is None:
        raise LipwrightError(f"{face}: {texts.missing(face.stem)}")
    return found


def _sound_beside(face: Path) -> Path:
    from lipwright.capture.arkit_import import find_sound

    sound = find_sound(face)
    if sound is None:
        raise LipwrightError(
            f"{face}: no movie or sound of that name beside it; name its folder with --audio"
        )
    return sound
