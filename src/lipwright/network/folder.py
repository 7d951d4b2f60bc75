"""Where models are, and the bytes of their files."""

from __future__ import annotations

import hashlib
import os
from importlib.resources import files
from pathlib import Path
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.formats.jsontrack import parse_json
from lipwright.network.meta import FORMAT, META_FILE, VERSION, ModelMeta

PathLike = str | os.PathLike[str]

REMEDY: Final = "get the whole folder again, or train anew with: lipwright train"
MAX_BYTES: Final = 2**31 - 1  # the most that an ONNX file can have, being one protobuf message


def shipped_models() -> dict[str, Path]:
    """Name to folder of the models that come with the package, in order."""
    home = Path(str(files("lipwright"))) / "models"
    if not home.is_dir():
        return {}
    return {
        folder.name: folder for folder in sorted(home.iterdir()) if (folder / META_FILE).is_file()
    }


def find_model(model: PathLike) -> Path:
    """The folder of a model, by the name of one that ships or by its path.

    Raises:
        LipwrightError: there is neither; lists the names.
    """
    shipped = shipped_models()
    if isinstance(model, str) and model in shipped:
        return shipped[model]
    folder = Path(model)
    try:
        if folder.is_dir():
            return folder
        is_there = folder.exists()
    except (OSError, ValueError):  # too long for a path, or not one
        is_there = False
    if is_there:
        raise LipwrightError(f"{model}: a model is a folder; name the folder with its {META_FILE}")
    known = f"ships: {', '.join(shipped)}" if shipped else "ships none"
    raise LipwrightError(
        f"no model {str(model)[:200]!r}: no such folder, and this version {known}; name a model"
    )


def read_file(folder: Path, name: str) -> bytes:
    """The bytes of a file of a model; links that lead out of the folder are not followed.

    Raises:
        LipwrightError: it is missing, a link out of the folder, no file, or cannot be read.
    """
    path = folder / name
    try:
        if not path.resolve(strict=True).is_relative_to(folder.resolve()):
            raise LipwrightError(
                f"{path}: is a link out of the model's folder; put the file itself there"
            )
        if not path.is_file():
            raise LipwrightError(f"{path}: is not a file; {REMEDY}")
        if path.stat().st_size > MAX_BYTES:
            raise LipwrightError(f"{path}: is larger than 2 GB, which no model is; {REMEDY}")
        return path.read_bytes()
    except FileNotFoundError:
        raise LipwrightError(f"{path}: is missing; {REMEDY}") from None
    except (OSError, RuntimeError) as error:  # RuntimeError: links in a circle
        reason = getattr(error, "strerror", None) or str(error)
        raise LipwrightError(f"{path}: cannot be read: {reason}") from error


def read_meta(folder: Path) -> ModelMeta:
    """What a model says of itself; its other files are not looked at.

    Raises:
        LipwrightError: meta.json is missing, not ours, or of another version, or a field is wrong.
    """
    path = folder / META_FILE
    read_file(folder, META_FILE)
    content = parse_json(path, FORMAT, VERSION)
    try:
        return ModelMeta.from_json(content)
    except ValueError as error:
        raise LipwrightError(f"{path}: {error}; {REMEDY}") from error


def read_hashed(folder: Path, meta: ModelMeta, name: str) -> bytes:
    """The bytes of a file whose SHA-256 meta.json has.

    Raises:
        LipwrightError: it cannot be read, or is not the file that was exported.
    """
    content = read_file(folder, name)
    if hashlib.sha256(content).hexdigest() != meta.files[name]:
        raise LipwrightError(
            f"{folder / name}: is not the file that {META_FILE} was written with, but cut off, "
            f"changed or of another model; {REMEDY}"
        )
    return content
