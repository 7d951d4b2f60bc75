"""`ModelMeta`: what a model's meta.json says."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import date
from types import MappingProxyType
from typing import Any, Final, Literal, cast

from lipwright.clip import MAX_FPS
from lipwright.controls import ARKIT
from lipwright.features import FeatureSet
from lipwright.version import VERSION as LIPWRIGHT

FORMAT: Final = "lipwright-model"
VERSION: Final = 1  # raise when the layout of the folder changes

MODEL_FILE: Final = "model.onnx"
ARRAYS_FILE: Final = "model.npz"
META_FILE: Final = "meta.json"
GOLDEN_FILE: Final = "golden.npz"

Kind = Literal["windows", "sequence", "recurrent", "trees", "hmm", "dynamic"]
Target = Literal["arkit", "shape", "joint", "both"]
ENGINE_OF: Final[Mapping[Kind, str]] = MappingProxyType({
    "windows": "window", "sequence": "window", "recurrent": "lstm", "trees": "trees",
    "hmm": "hmm", "dynamic": "dynamic",
})  # fmt: skip
"""kind of model to the engine that runs it"""
NETWORKS: Final[tuple[Kind, ...]] = ("windows", "sequence", "recurrent")
"""kinds that are ONNX files; the others are arrays"""
KINDS: Final[tuple[Kind, ...]] = tuple(ENGINE_OF)
TARGETS: Final[Mapping[Target, str]] = MappingProxyType({
    "arkit": "ARKit weights",
    "shape": "shape modes of a reference face",
    "joint": "joint modes of a reference face",
    "both": "ARKit weights, and joint modes of a reference face",
})  # fmt: skip
"""what a model predicts, and its name for people"""

MAX_OUTPUT_WINDOW: Final = 101  # frames; the papers go to 15
MAX_WINDOW: Final = 1001  # frames; a network is tried with one, and a wider one fills the memory
_SHA256: Final = re.compile(r"[0-9a-f]{64}")
_TEXTS: Final = ("lipwright", "name", "kind", "target", "licence", "data", "date")
_OBJECTS: Final = ("features", "files", "metrics")


@dataclass(frozen=True)
class ModelMeta:
    """What a model takes and gives, and where it comes from.

    Raises:
        ValueError: a field is out of range, or two do not fit each other; the message names it.
    """

    name: str
    """of the architecture or configuration"""
    kind: Kind
    """`windows`: each row is the window of one frame; `sequence`: a convolution over frames;
    `recurrent`: all frames at once; the others are arrays, which their engines read"""
    features: FeatureSet
    output_window: int
    """Ky, odd, frames that one window predicts, around its middle; 1 for a sequence"""
    controls: tuple[str, ...]
    """C names, each once"""
    target: Target
    files: Mapping[str, str]
    """file name to its SHA-256 in hexadecimal"""
    licence: str
    """terms of use of the weights"""
    data: str
    """what it was trained on, with the licence of that"""
    metrics: Mapping[str, Any]
    """figures on held-out recordings"""
    date: str
    """of the training, YYYY-MM-DD"""
    lipwright: str = LIPWRIGHT
    """the version that wrote it"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        object.__setattr__(self, "controls", tuple(self.controls))
        if not self.name:
            raise ValueError("'name' is empty")
        if self.kind not in KINDS:
            raise ValueError(f"'kind' is {self.kind[:24]!r}, not one of {', '.join(KINDS)}")
        if self.target not in TARGETS:
            raise ValueError(f"'target' is {self.target[:24]!r}, not one of {', '.join(TARGETS)}")
        self._check_windows()
        self._check_controls()
        for name in self.hashed:
            if not _SHA256.fullmatch(self.files.get(name, "")):
                raise ValueError(f"'files' lacks the SHA-256 of {name}")
        try:
            date.fromisoformat(self.date)
        except ValueError:
            raise ValueError(f"'date' is {self.date[:24]!r}, not YYYY-MM-DD") from None
        for field in ("files", "metrics"):
            object.__setattr__(self, field, MappingProxyType(dict(getattr(self, field))))

    def _check_windows(self) -> None:
        if not 1 <= self.output_window <= MAX_OUTPUT_WINDOW or self.output_window % 2 == 0:
            raise ValueError(
                f"'output_window' is {self.output_window}, not odd and from 1 to "
                f"{MAX_OUTPUT_WINDOW} frames"
            )
        if self.features.window > MAX_WINDOW:
            raise ValueError(f"'features' have a window of more than {MAX_WINDOW} frames")
        if self.features.fps > MAX_FPS:
            raise ValueError(f"'features' are of {self.features.fps:g} fps, over {MAX_FPS:g}")
        if self.kind in {"sequence", "recurrent"}:
            if self.output_window != 1:
                raise ValueError(f"'output_window' of a sequence is {self.output_window}, not 1")
            if "spans" in self.features.kinds:
                raise ValueError("'features' of a sequence has spans, which only windows have")
        if self.kind == "recurrent" and self.features.window != 1:
            raise ValueError(f"'features' of a recurrent network see {self.features.window} frames")

    def _check_controls(self) -> None:
        if not self.controls or not all(isinstance(n, str) and n for n in self.controls):
            raise ValueError("'controls' is not a list of names")
        if repeated := [n for i, n in enumerate(self.controls) if n in self.controls[:i]]:
            raise ValueError(f"'controls' has {repeated[0][:40]!r} twice")
        modes = {"arkit": "", "both": "joint"}.get(self.target, self.target)
        pattern = re.compile(rf"{modes}[1-9][0-9]*")
        for name in self.controls:
            fits = name in ARKIT and self.moves_heads
            if not fits and not (modes and pattern.fullmatch(name)):
                raise ValueError(f"'controls' has {name[:40]!r}, which is none of {self.target}")

    @property
    def moves_heads(self) -> bool:
        """Whether it has controls of heads, not only modes of one speaker's reference face."""
        return self.target in {"arkit", "both"}

    @property
    def engine(self) -> str:
        """The engine that runs it."""
        return ENGINE_OF[self.kind]

    @property
    def model_file(self) -> str:
        """The file that was learnt."""
        return MODEL_FILE if self.kind in NETWORKS else ARRAYS_FILE

    @property
    def hashed(self) -> tuple[str, str]:
        """The files whose SHA-256 is here."""
        return self.model_file, GOLDEN_FILE

    def to_json(self) -> dict[str, Any]:
        """The content of meta.json."""
        return {
            "format": FORMAT, "version": VERSION, "lipwright": self.lipwright, "name": self.name,
            "kind": self.kind, "features": self.features.to_json(),
            "output_window": self.output_window, "controls": list(self.controls),
            "target": self.target, "files": dict(self.files), "licence": self.licence,
            "data": self.data, "metrics": dict(self.metrics), "date": self.date,
        }  # fmt: skip

    @classmethod
    def from_json(cls, content: Mapping[str, Any]) -> ModelMeta:
        """The value of a meta.json whose format and version are ours.

        Raises:
            ValueError: a field is missing, of the wrong kind, or out of range; names it.
        """
        kinds: dict[str, tuple[type, str]] = {
            **dict.fromkeys(_TEXTS, (str, "text")), **dict.fromkeys(_OBJECTS, (dict, "an object")),
            "controls": (list, "a list"), "output_window": (int, "a whole number"),
        }  # fmt: skip
        for field, (kind, article) in kinds.items():
            if field not in content:
                raise ValueError(f"{field!r} is missing")
            if type(content[field]) is not kind:
                raise ValueError(f"{field!r} is {str(content[field])[:24]!r}, not {article}")
        if not all(isinstance(digest, str) for digest in content["files"].values()):
            raise ValueError("'files' has other values than text")
        try:
            features = FeatureSet.from_json(content["features"])
        except ValueError as error:
            raise ValueError(f"'features': {error}") from error
        return cls(
            content["name"], cast("Kind", content["kind"]), features, content["output_window"],
            tuple(content["controls"]), cast("Target", content["target"]), content["files"],
            content["licence"], content["data"], content["metrics"], content["date"],
            content["lipwright"],
        )  # fmt: skip
