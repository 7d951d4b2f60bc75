"""The settings of a Piper voice, from the JSON file beside its model."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, Literal

from lipwright.decode import MAX_RATE, MIN_RATE
from lipwright.errors import LipwrightError

REMEDY: Final = "get the voice's two files, .onnx and .onnx.json, again"
MAX_BYTES: Final = 4 << 20  # a voice of 904 speakers has 20 kB of settings
BEGIN, END, PAD, SPACE = "^", "$", "_", " "
_PHONEME_TYPES: Final = ("espeak", "text")
_MOST_IDS: Final = 10_000


@dataclass(frozen=True)
class PiperConfig:
    """What a voice says of itself."""

    rate: int
    """Hz"""
    phoneme_type: Literal["espeak", "text"]
    """whether it reads IPA of espeak-ng, or letters"""
    espeak_voice: str
    """of espeak-ng; "" where none is needed"""
    language: str
    """code as the voice has it, such as "sv_SE" """
    ids: Mapping[str, tuple[int, ...]]
    """letter or phoneme to the model's numbers for it"""
    speakers: int
    """1 or more"""
    speaker_ids: Mapping[str, int]
    """name to number, of voices with several speakers"""
    noise_scale: float
    length_scale: float
    noise_w: float
    clusters: frozenset[str]
    """letters that are one phoneme together"""


def read_config(path: Path) -> PiperConfig:
    """The settings in a file.

    Raises:
        LipwrightError: it is missing, too large, not JSON, or a field is missing or wrong.
    """
    content = _read_json(path)
    try:
        return _config(content)
    except _WrongError as wrong:
        raise LipwrightError(f"{path}: {wrong}; {REMEDY}") from wrong


class _WrongError(Exception):
    """A field that cannot be used."""


def _read_json(path: Path) -> dict[str, Any]:
    try:
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)  # a device tells no size
        if len(data) > MAX_BYTES:
            raise LipwrightError(f"{path}: is larger than the settings of any voice; {REMEDY}")
        content = json.loads(data)
    except FileNotFoundError:
        raise LipwrightError(f"{path}: is missing beside the voice's model; {REMEDY}") from None
    except OSError as error:
        raise LipwrightError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (ValueError, RecursionError) as error:
        reason = " ".join(str(error).split())[:100]
        raise LipwrightError(f"{path}: not JSON ({reason}); {REMEDY}") from error
    if not isinstance(content, dict):
        raise LipwrightError(f"{path}: not the settings of a voice; {REMEDY}")
    return content


def _config(content: dict[str, Any]) -> PiperConfig:
    kind = content.get("phoneme_type", "espeak")
    if kind not in _PHONEME_TYPES:
        raise _WrongError(f"'phoneme_type' is {str(kind)[:40]!r}, which only Piper itself reads")
    inference = _object(content, "inference") if "inference" in content else {}
    language = _object(content, "language") if "language" in content else {}
    voice = str(_object(content, "espeak").get("voice", ""))[:80] if kind == "espeak" else ""
    if kind == "espeak" and not voice:
        raise _WrongError("'espeak' has no 'voice'")
    return PiperConfig(
        rate=_whole(_object(content, "audio"), "sample_rate", MIN_RATE, MAX_RATE),
        phoneme_type="espeak" if kind == "espeak" else "text",
        espeak_voice=voice,
        language=str(language.get("code") or voice)[:80],
        ids=_ids(_object(content, "phoneme_id_map")),
        speakers=_whole(content, "num_speakers", 1, 1_000_000) if "num_speakers" in content else 1,
        speaker_ids=_speakers(content.get("speaker_id_map") or {}),
        noise_scale=_number(inference, "noise_scale", 0.667),
        length_scale=_number(inference, "length_scale", 1.0),
        noise_w=_number(inference, "noise_w", 0.8),
        clusters=_clusters(content.get("vowel_clusters") or ()),
    )


def _object(content: dict[str, Any], name: str) -> dict[str, Any]:
    value = content.get(name)
    if not isinstance(value, dict):
        raise _WrongError(f"{name!r} is missing or no object")
    return value


def _whole(content: dict[str, Any], name: str, least: int, most: int) -> int:
    value = content.get(name)
    if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= most:
        raise _WrongError(f"{name!r} is {str(value)[:40]}, not a whole number {least} to {most}")
    return value


def _number(content: dict[str, Any], name: str, default: float) -> float:
    value = content.get(name, default)
    if not isinstance(value, int | float) or isinstance(value, bool) or not 0 <= value <= 10:
        raise _WrongError(f"{name!r} is {str(value)[:40]}, not a number from 0 to 10")
    return float(value)


def _ids(table: dict[str, Any]) -> Mapping[str, tuple[int, ...]]:
    found: dict[str, tuple[int, ...]] = {}
    for phoneme, ids in table.items():
        is_row = isinstance(ids, list) and 0 < len(ids) <= 100
        if not is_row or not all(type(one) is int and 0 <= one < _MOST_IDS for one in ids):
            raise _WrongError(f"'phoneme_id_map' has no numbers for {phoneme[:20]!r}")
        found[phoneme] = tuple(ids)
    for needed in (BEGIN, END, PAD):
        if needed not in found:
            raise _WrongError(f"'phoneme_id_map' has no {needed!r}")
    return MappingProxyType(found)


def _speakers(table: Any) -> Mapping[str, int]:
    if not isinstance(table, dict) or not all(type(one) is int for one in table.values()):
        raise _WrongError("'speaker_id_map' is not names and numbers")
    return MappingProxyType(dict(table))


def _clusters(rows: Any) -> frozenset[str]:
    if not isinstance(rows, list | tuple) or not all(isinstance(row, list) for row in rows):
        raise _WrongError("'vowel_clusters' is not a list of lists")
    return frozenset("".join(map(str, row)) for row in rows)
