"""The models of a benchmark: trained once, and kept while what they learn from stays the same."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from lipwright.benchmark.entrants import Entrant
from lipwright.benchmark.options import BenchmarkOptions
from lipwright.benchmark.variants import Variant
from lipwright.dataset.folder import sha256_of
from lipwright.dataset.recording import to_json
from lipwright.engines.golden import check_model
from lipwright.errors import LipwrightError
from lipwright.files import write_whole
from lipwright.network.folder import read_meta
from lipwright.version import VERSION

TARGETS: Final = "both"  # modes answer figure 10, weights move heads


@dataclass(frozen=True)
class Model:
    """A trained model."""

    folder: Path
    seconds: float
    """that its training took"""


def train_model(
    entrant: Entrant, variant: Variant, face: Path, options: BenchmarkOptions, folder: Path,
    report: Any, tell: Any,
) -> Model:  # fmt: skip
    """The model of an entrant for a variant: the kept one where it still fits, or a new one.

    A training that was stopped goes on.

    Args:
        entrant: with a configuration.
        variant: what to learn from.
        face: the reference face.
        options: quick or not, and the seed.
        folder: of all models of the benchmark.
        report: told how far it is.
        tell: told of each epoch of a network.

    Raises:
        LipwrightError: the training cannot be done.
    """
    from lipwright.train.config_file import load_config, override
    from lipwright.train.place import TrainOptions
    from lipwright.train.run import train

    assert entrant.config is not None
    changes: dict[str, Any] = {"targets": TARGETS, "seed": options.seed, **entrant.full}
    changes |= dict(entrant.quick) if options.quick else {}
    config = override(load_config(entrant.config), changes, entrant.config)
    digest = _digest(config.to_json(), variant, face)
    out = folder / f"{entrant.name}-{variant.name}"
    note = out.with_name(f"{out.name}.json")
    kept = _kept(note, out, digest)
    if kept is not None:
        return kept
    trained = train(
        variant.dataset, config, out,
        TrainOptions(face=face, licence=options.licence, force=True), report, tell,
    )  # fmt: skip
    with write_whole(note) as part:
        part.write_text(to_json({"digest": digest, "seconds": trained.seconds}), "utf-8")
    return Model(out, trained.seconds)


def _digest(config: Mapping[str, Any], variant: Variant, face: Path) -> str:
    shaped = json.dumps([VERSION, config, variant.digest(), sha256_of(face)], sort_keys=True)
    return hashlib.sha256(shaped.encode()).hexdigest()


def _kept(note: Path, out: Path, digest: str) -> Model | None:
    """The model that is there, if it was made of the same and is whole."""
    try:
        found = json.loads(note.read_text("utf-8"))
        seconds = float(found["seconds"])
        if found["digest"] != digest or not 0 <= seconds < math.inf:
            return None
        check_model(out)
    except (OSError, ValueError, KeyError, TypeError, ArithmeticError, RecursionError):
        return None
    except LipwrightError:  # damaged: it is trained again
        return None
    return Model(out, seconds)


def model_bytes(folder: Path) -> int:
    """The size of what was learnt, as its file lies on the disk."""
    meta = read_meta(folder)
    return (folder / meta.model_file).stat().st_size
