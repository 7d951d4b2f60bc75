"""From sound to phones: words put on it, or what is heard without any."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal, get_args

from lipwright.audio import AudioFile, open_audio
from lipwright.errors import LipwrightError
from lipwright.language import LANGUAGES, get_language, read_dictionary
from lipwright.pipeline.options import PathLike, Report, quiet
from lipwright.speech import Alignment, align

if TYPE_CHECKING:
    from lipwright.speech.listening import Heard

RecogniserName = Literal["auto", "words", "phones"]
AUTO: Final = "auto"
DEFAULT: Final = "en"
ALIGNMENT_RATE: Final = 16000  # Hz, what the aligner hears
MOST_WORDS: Final = 20.0  # a second of sound; the fastest speakers reach 11
SPARE_WORDS: Final = 100  # for notes and marks that are not said


@dataclass(frozen=True)
class AlignOptions:
    """How words are put on the sound."""

    language: str | None = None
    """ISO 639 code or name of the words' language, or "auto" to tell it from the words; by default
    English, or where words are recognised, what is heard"""
    dictionary: PathLike | None = None
    """a file of pronunciations that override the lexicon"""
    aligner: str = "sphinx"
    recogniser: RecogniserName = "auto"
    """what hears sound without words: "words" (extra `asr` and its model), "phones", or "auto",
    words where they can be heard, else phones"""
    asr_model: PathLike | None = None
    """of "words": a model's folder, or the name of one that this machine has"""

    def __post_init__(self) -> None:
        """Check."""
        if self.recogniser not in get_args(RecogniserName):
            raise LipwrightError(
                f"unknown recogniser {self.recogniser!r}; use one of: "
                f"{', '.join(get_args(RecogniserName))}"
            )


def language_of(code: str, text: str, source: str) -> str:
    """The code of the language that `code` means; `auto` is told from the text.

    Raises:
        LipwrightError: there is no such language, or the text does not tell.
    """
    if code in LANGUAGES:
        return code
    if code != AUTO:
        from lipwright.language.codes import resolve_code

        return resolve_code(code)
    from lipwright.language.detect import detect_language

    return detect_language(text, source=source)[0]


def align_sound(
    sound: AudioFile, text: str, options: AlignOptions | None = None,
    source: str = "text", report: Report = quiet,
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
    code = language_of(options.language or DEFAULT, text, source)
    dictionary = None if options.dictionary is None else read_dictionary(Path(options.dictionary))
    most = SPARE_WORDS + MOST_WORDS * sound.duration
    if (count := len(text.split())) > most:
        raise LipwrightError(
            f"{source}: {count} words cannot be said in {sound.duration:.1f} s, which {sound.name} "
            "lasts; give the words of this recording"
        )
    words = get_language(code).normalize(text, source, dictionary)
    return align(
        sound, words, code, dictionary, options.aligner,
        progress=lambda share: report("align", share),
    )  # fmt: skip


def align_speech(
    speech: PathLike, text: str, options: AlignOptions | None = None,
    source: str = "text", report: Report = quiet,
) -> Alignment:  # fmt: skip
    """Words on the sound of a file; see `align_sound`."""
    with open_audio(speech, ALIGNMENT_RATE) as sound:
        return align_sound(sound, text, options, source, report)


def hear_sound(
    sound: AudioFile, options: AlignOptions | None = None, report: Report = quiet
) -> Heard:
    """What is said in an open sound of 16 kHz whose words nobody has given.

    Words where the extra `asr` and a model of it are there and hear some, which are then aligned;
    else phones.

    Raises:
        LipwrightError: nothing that sounds like speech is found, or words were asked for and
            cannot be recognised.
    """
    from lipwright.speech.listening import listen

    options = options or AlignOptions()
    if options.dictionary is not None:
        read_dictionary(Path(options.dictionary))  # refused before the work is done
    notes: tuple[str, ...] = ()
    if options.recogniser != "phones":
        heard, notes = _hear_words(sound, options, report)
        if heard is not None:
            return heard
    own = options.language
    language = DEFAULT if own is None or own == AUTO else language_of(own, "", "")
    heard = listen(sound, language, progress=lambda share: report("listen", share))
    return replace(heard, notes=(*notes, *heard.notes))


def _hear_words(
    sound: AudioFile, options: AlignOptions, report: Report
) -> tuple[Heard | None, tuple[str, ...]]:
    """Words and their alignment; None, and why, where phones are the better way."""
    from lipwright.speech.listening import Heard
    from lipwright.speech.transcriber import find_model, transcribe

    asked = options.recogniser == "words"
    model = find_model(options.asr_model, needed=asked or options.asr_model is not None)
    if model is None:
        return None, ()
    own = options.language
    language = None if own is None or own == AUTO else language_of(own, "", "")
    found = transcribe(sound, model, language, progress=lambda share: report("listen", share))
    if not found.text:
        return None, ("no words were recognised; the mouth follows the phones that were heard",)
    try:
        aligned = align_sound(
            sound, found.text, replace(options, language=found.language), "the words heard", report
        )
    except LipwrightError as error:
        if asked:
            raise
        return None, (f"the words that were recognised were dropped: {error}",)
    heard = Heard(aligned, "words", found.confidence, found.text, found.language, found.notes)
    return heard, ()


def hear_speech(
    speech: PathLike, options: AlignOptions | None = None, report: Report = quiet
) -> Heard:
    """What is said in the sound of a file; see `hear_sound`."""
    with open_audio(speech, ALIGNMENT_RATE) as sound:
        return hear_sound(sound, options, report)
