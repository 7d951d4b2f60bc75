"""`lipwright say` and `lipwright voices`."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from lipwright.cli.aligning import dictionary_option, say_done
from lipwright.cli.inputs import STDIN, read_text
from lipwright.cli.layering import Layers, layer_options
from lipwright.cli.motion import Motion, motion_options, no_head, report_missing
from lipwright.cli.outputs import (
    Wanted,
    character_options,
    check_files,
    export_targets,
    exporters_of,
    format_option,
    out_option,
    outputs_known,
    suffix_of,
    targets_of,
    tracks_apart,
    warn_left_out,
    write_tracks,
)
from lipwright.cli.progress import progress_option, progress_report, warn
from lipwright.cli.progress import say as tell
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.audio import Audio
    from lipwright.speech.voices import Utterance

SAY_EXAMPLES = """\b
Examples:
  lipwright say "Hello there, how are you?" -o hello.csv
    hello.csv: 1.9 s, 15 phones, 5 words
    hello.wav: 1.9 s, said by hibari:heart
\b
  lipwright say "Hello there." --voice hibari --rate 0.9 -o hello.mp4
  lipwright say "Det är en av de märkligaste motsättningarna hos honom." -l sv -o sv.mp4
  lipwright say "你好，我是中国人。" --language cmn -o ni-hao.glb
  lipwright say story.ssml --voice espeak:en-gb --sound story.wav -o story.csv
  lipwright say "Guten Tag." --voice piper:voices/thorsten.onnx -o tag.mp4
  lipwright say "Hello." --voice http://127.0.0.1:8123/speak -o hello.glb
  echo "Hello." | lipwright say - -o hello.vrma
"""
VOICES_EXAMPLES = """\b
Example:
  lipwright voices
    hibari:heart  en  American English, female
"""


@click.command(epilog=SAY_EXAMPLES)
@click.argument("text")
@click.option("--voice", help="Who speaks; see lipwright voices.  [default: that of the language]")
@click.option(
    "--language", "-l", help="Language of the text, or auto.  [default: the voice's, or en]"
)
@click.option("--rate", type=float, default=1.0, show_default=True, help="Speed of the speech.")
@click.option(
    "--sound", type=Path, help="Where the sound goes, as .wav or .flac.  [default: beside the "
    "first output]",
)  # fmt: skip
@out_option
@format_option
@motion_options
@layer_options
@dictionary_option
@character_options
@progress_option
def say(
    text: str, voice: str | None, language: str | None, rate: float, sound: Path | None,
    out: tuple[str, ...],
    format: str | None,  # noqa: A002  # as the option is called
    motion: Motion, layers: Layers, dictionary: Path | None, wanted: Wanted, progress: str,
) -> None:  # fmt: skip
    """Say a text with a voice, and make a face speak it.

    TEXT is the words, a file of them, or - for a pipe; SSML begins with <speak.
    """
    from lipwright.pipeline import SayOptions
    from lipwright.pipeline import say as make

    targets = targets_of(out, outputs_known(), format)
    curves, tracks = tracks_apart(targets, suffix_of(format))
    words, source = read_text(text, "the text")
    options = motion.options(layers, wanted)
    beside = _sound_path(sound, targets)
    exporters_of(curves, suffix_of(format), wanted, options.controls(), no_head(options))
    given = None if text == STDIN or source == "the text" else text
    kept = targets if beside is None else (*targets, str(beside))
    check_files(kept, STDIN, given, dictionary, motion.bigrams, *wanted.inputs)
    export_options = wanted.options(Path(targets[0]).stem)
    with progress_report(progress) as report:
        result = make(
            words, options=options, text_source=source, report=report,
            voice=SayOptions(voice, language, rate, dictionary),
        )  # fmt: skip
        show = replace(export_options, progress=lambda done, all_: report("video", done / all_))
        assert result.utterance is not None  # say always sets it
        if beside is not None:
            _write_sound(beside, result.utterance.audio)
        export_targets(result.performance, curves, suffix_of(format), wanted, show)
    write_tracks(tracks, result.track, suffix_of(format))
    report_missing(options, result.track, progress)
    warn_left_out(result.performance, wanted, progress)
    for note in result.notes:
        warn(note, progress)
    say_done(targets, result.track, progress)
    _tell_sound(beside, result.utterance, progress)


def _sound_path(sound: Path | None, targets: tuple[str, ...]) -> Path | None:
    """Where the sound goes; None where all goes through a pipe.

    Raises:
        LipwrightError: it has no suffix of sound, or would replace a recording of the user's.
    """
    from lipwright.audio import written_by
    from lipwright.export.sidecar import MAKER

    if sound is not None:
        if sound.suffix.casefold() not in (".wav", ".flac"):
            raise LipwrightError(f"--sound {sound}: the sound is written as .wav or .flac")
        return sound
    files = [Path(target) for target in targets if target != STDIN]
    if not files:
        return None
    beside = files[0].with_name(f"{_stem(files[0])}.wav")
    if os.path.exists(beside) and written_by(beside) != MAKER:  # noqa: PTH110  # of any length
        raise LipwrightError(
            f"{beside}: this sound was not made by Lipwright, and is kept; name another place for "
            "the voice's with --sound"
        )
    return beside


def _stem(path: Path) -> str:
    """The name without its suffix, of which some have two parts: hello.livelink.csv."""
    known = sorted(outputs_known(), key=len, reverse=True)
    ending = next((s for s in known if path.name.casefold().endswith(s)), path.suffix)
    return path.name[: len(path.name) - len(ending)]


def _write_sound(path: Path, audio: Audio) -> None:
    from lipwright.audio import write_flac, write_wav
    from lipwright.export.sidecar import MAKER

    write = write_flac if path.suffix.casefold() == ".flac" else write_wav
    write(path, audio, software=MAKER)


def _tell_sound(path: Path | None, said: Utterance, progress: str) -> None:
    if path is None or progress == "json":
        return
    how = "" if said.timing == "voice" else ", its words aligned"
    tell(f"{path}: {said.audio.duration:.1f} s, said by {said.voice}{how}")


@click.command(epilog=VOICES_EXAMPLES)
@click.option("--language", "-l", help="Only those of this language.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON, for programs.")
def voices(language: str | None, as_json: bool) -> None:
    """List the voices of this machine, and what more can be installed."""
    from lipwright.cli.listing import columns
    from lipwright.language.codes import resolve_code
    from lipwright.speech.voices import BACK_ENDS, get_back_end

    wanted = None if language is None else resolve_code(language).partition("-")[0]
    back_ends = [get_back_end(name) for name in BACK_ENDS]
    found = [
        info
        for back_end in back_ends
        if back_end.is_available()
        for info in back_end.voices()
        if wanted is None or info.language.partition("-")[0] == wanted
    ]
    missing = {b.name: b.remedy() for b in back_ends if not b.is_available()}
    if as_json:
        rows = [{"name": v.name, "language": v.language, "about": v.about} for v in found]
        click.echo(json.dumps({"voices": rows, "missing": missing}, ensure_ascii=False, indent=1))
        return
    columns([(v.name, v.language, v.about) for v in found])
    for name, remedy in missing.items():
        click.echo(f"{name} is not installed; run: {remedy}")
