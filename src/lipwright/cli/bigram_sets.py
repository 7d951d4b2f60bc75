"""`lipwright bigrams new`, `info`, `import` and `export`: whole sets."""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lipwright.cli.listing import json_option
from lipwright.cli.progress import say, warn
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.bigrams.families import Member
    from lipwright.bigrams.values import BigramSet

NEW_EXAMPLES = """\b
Examples:
  lipwright bigrams new mine -o mine.json
    mine.json: mine, 22 classes, 9 poses of the rig facefx, no pairs yet
\b
  lipwright bigrams new hero --parent mine.json -o hero.json    # changes a few pairs of another
    hero.json: hero, a child of mine
"""
INFO_EXAMPLES = """\b
Examples:
  lipwright bigrams info english
    name         english
    language     en
\b
  lipwright bigrams info mine.json --json
"""
IMPORT_EXAMPLES = """\b
Examples:
  lipwright bigrams import examples/diphones.txt -o mine.json
    mine.json: example, 2 pairs of 2 classes
"""
EXPORT_EXAMPLES = """\b
Examples:
  lipwright bigrams export english -o pairs.csv
    pairs.csv: 483 pairs
\b
  lipwright bigrams export english -o english.py     # createDiphone and addKey, for SmartBody
"""

set_argument = click.argument("name", metavar="SET")


@click.command(epilog=NEW_EXAMPLES)
@click.argument("name")
@click.option("-o", "--output", required=True, type=Path, metavar="FILE", help="The set to make.")
@click.option("--parent", metavar="SET", help="Inherit all of this set.")
@click.option("--rig", metavar="RIG", help="Whose controls are the poses; by default facefx.")
@click.option("--language", metavar="CODE", help="ISO 639 code; by default en.")
@click.option("--licence", metavar="TERMS", help="Terms of use, in a few words.")
def new(
    name: str, output: Path, parent: str | None, rig: str | None, language: str | None,
    licence: str | None,
) -> None:  # fmt: skip
    """Make a set without pairs, or a child of another set that changes nothing yet.

    Without --parent it has the Common Phoneme Set as classes, silence, and a pose for each control
    of the rig; the FaceFX poses have the priorities and constraints of Xu et al. 2013.
    """
    from lipwright.bigrams.fields import SetFile
    from lipwright.bigrams.file import save_set
    from lipwright.bigrams.fresh import fresh_set
    from lipwright.bigrams.jsonvalues import word_at
    from lipwright.bigrams.places import Fault
    from lipwright.rig import load_rig

    try:
        word_at(name, ("NAME",))
    except Fault as fault:
        raise LipwrightError(str(fault)) from None
    if output.exists():
        raise LipwrightError(f"{output}: is there already; name another file, or delete it")
    controls = load_rig(rig or "facefx").names if rig or not parent else ()
    beside = None if rig is None else _beside(rig, output)
    if parent:
        said = SetFile(name, language, licence, None, parent_name(parent, output), beside)
        save_set(output, said)
        say(f"{output}: {name}, a child of {parent}")
        return
    fresh = fresh_set(name, language or "en", licence or "", beside or "facefx", controls)
    save_set(output, fresh)
    say(
        f"{output}: {name}, {len(fresh.classes)} classes, {len(fresh.poses)} poses of the rig "
        f"{rig or 'facefx'}, no pairs yet"
    )


def parent_name(parent: str, output: Path) -> str:
    """How the file `output` names a set that is there."""
    from lipwright.bigrams.families import load_bigrams, shipped_sets

    load_bigrams(parent)
    return parent if parent in shipped_sets() else _relative(parent, output)


def _beside(rig: str, output: Path) -> str:
    return _relative(rig, output) if rig.endswith(".json") else rig


def _relative(path: str, output: Path) -> str:
    folder = os.path.realpath(output.parent)
    try:
        return Path(os.path.relpath(os.path.realpath(path), folder)).as_posix()
    except ValueError:  # on another drive
        return Path(path).absolute().as_posix()


@click.command(epilog=INFO_EXAMPLES)
@set_argument
@json_option
def info(name: str, as_json: bool) -> None:
    """Say what is in a set: classes, poses, pairs and where they come from, on which terms."""
    from lipwright.bigrams.families import load_family, merge

    family = load_family(name)
    rows = dict(_facts(merge(family), family))
    if as_json:
        click.echo(json.dumps(rows, ensure_ascii=False, indent=1))
        return
    for label, value in rows.items():
        text = value if isinstance(value, str) else _listed(value)
        line = f"{label:12} {text}"  # of a stranger's file: nothing in it may steer the terminal
        click.echo("".join(letter if letter.isprintable() else " " for letter in line))


def _facts(bigrams: BigramSet, family: Sequence[Member]) -> Iterator[tuple[str, Any]]:
    from lipwright.bigrams.checking import pairs_of_set
    from lipwright.bigrams.families import origins

    yield "name", bigrams.name
    yield "language", bigrams.language
    yield "licence", bigrams.licence or "none named"
    yield "source", bigrams.source
    yield "parents", [member.said.name for member in reversed(family[:-1])]
    yield "rig", bigrams.rig
    yield "classes", {name: len(phones) for name, phones in bigrams.classes.items()}
    yield "poses", {pose.name: pose.priority for pose in bigrams.poses.values()}
    together = {" + ".join(pair): most for pair, most in bigrams.constraints.items()}
    yield "constraints", {**together, "otherwise": bigrams.otherwise}
    yield "smoothing", f"{bigrams.smoothing:g} s"
    yield "speed limit", f"{bigrams.speed_limit:g} poses a second"
    yield "silence", f"{bigrams.silence:g} s"
    asked = pairs_of_set(bigrams)
    yield "pairs", f"{len(asked.rows) - len(asked.missing)} of {len(asked.rows)}"
    yield "made", dict(Counter(pair.source for pair in bigrams.bigrams.values()).most_common())
    yield "from", dict(Counter(origins(family).values()).most_common())


def _listed(values: dict[str, float] | list[str]) -> str:
    if isinstance(values, list):
        return ", ".join(values) or "none"
    return ", ".join(f"{name} {number:g}" for name, number in values.items()) or "none"


@click.command("import", epilog=IMPORT_EXAMPLES)
@click.argument("path", metavar="FILE", type=Path)
@click.option("-o", "--output", required=True, type=Path, metavar="SET", help="The set to write.")
@click.option("--name", metavar="NAME", help="The set that is wanted, where FILE has several.")
def import_set(path: Path, output: Path, name: str | None) -> None:
    """Make a set of SmartBody's: createDiphone and addKey as text, or JSON.

    The text is read, never executed.
    """
    from lipwright.bigrams.families import is_shipped
    from lipwright.bigrams.file import is_ours, load_any, read_set_text, save_set

    if is_shipped(output):
        raise LipwrightError(f"{output}: ships with Lipwright and is not changed; name another")
    _not_itself(output, path)
    if is_ours(path, read_set_text(path)):
        raise LipwrightError(
            f"{path}: is a set of ours; make a child of it with: "
            f"lipwright bigrams new NAME --parent {path} -o FILE"
        )
    found = load_any(path, name)
    for note in found.notes:
        warn(note, "auto")
    if unheard := [one for one, phones in found.said.classes.items() if not phones]:
        warn(f"no phone is in these classes: {', '.join(unheard)}; add some in {output}", "auto")
    save_set(output, found.said)
    classes = len(found.said.classes)
    say(f"{output}: {found.said.name}, {len(found.said.bigrams)} pairs of {classes} classes")


def _not_itself(output: Path, path: Path) -> None:
    """Refuse to write over what is read: the original would be lost."""
    if output.exists() and path.exists() and output.samefile(path):
        raise LipwrightError(f"{output}: would be written over what is read; name another file")


@click.command(epilog=EXPORT_EXAMPLES)
@set_argument
@click.option("-o", "--output", required=True, type=Path, metavar="FILE",
              help="By its suffix: .py or .txt for SmartBody, .json, .csv.")  # fmt: skip
def export(name: str, output: Path) -> None:
    """Write a set, with all that it inherits, for other programs."""
    from lipwright.bigrams.exporting import export_set
    from lipwright.bigrams.families import find_set, is_shipped, load_bigrams

    if is_shipped(output):
        raise LipwrightError(f"{output}: ships with Lipwright and is not changed; name another")
    _not_itself(output, find_set(name))
    bigrams = load_bigrams(name)
    export_set(output, bigrams)
    say(f"{output}: {len(bigrams.bigrams)} pairs")
