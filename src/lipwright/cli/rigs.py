"""`lipwright rigs`: what characters let us move."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from lipwright.cli.listing import json_option
from lipwright.cli.progress import say, warn
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.export.rig_guess import Guess
    from lipwright.rig import Rig

SHOWN = 10  # names in one line
LIST_EXAMPLES = """\b
Examples:
  lipwright rigs list
    rig            controls  follows  what it is
    arkit                55  itself   ARKit's 52 blendshapes and three tongue controls
\b
  lipwright rigs list --json
"""
SHOW_EXAMPLES = """\b
Examples:
  lipwright rigs show vrm1
    vrm1: VRM 1.0, the preset expressions
    source: VRMC_vrm 1.0, expressions: the names of the presets; how they look in ARKit's controls, and the mapping, are ours
\b
  lipwright rigs show mine.json --json > copy.json
"""  # noqa: E501  # a line as it is printed
CHECK_EXAMPLES = """\b
Examples:
  lipwright rigs check vrm1
    vrm1: 18 controls, 12 follow, nothing to complain of
\b
  lipwright rigs check mine.json hero.json
"""
NEW_EXAMPLES = """\b
Examples:
  lipwright rigs new hero --controls jaw_open,Smile_L,mouthSmile_R,blink -o hero.json
    hero.json: hero, 4 controls, 4 follow: 3 as in arkit, 1 as in vrm1
    hero.json: no mouthClose, so the jaw shuts the lips: jaw_open = jawOpen - mouthClose
\b
  lipwright rigs new hero --from hero.glb -o hero.json     # its morph targets
  lipwright rigs new hero --like vrm1 -o hero.json         # a copy to change
"""


@click.group(epilog="Each command has examples: lipwright rigs COMMAND --help")
def rigs() -> None:
    """What characters let us move, and how that follows speech."""


def follows(rig: Rig) -> str:
    """In a word how a rig follows canonical controls."""
    from lipwright.rig import LinearMapping

    if rig.discrete:
        return "drawn"
    if rig.mapping is None:
        return "itself" if rig.name == "arkit" else "not yet"
    return "rows" if isinstance(rig.mapping, LinearMapping) else "poses"


@rigs.command("list", epilog=LIST_EXAMPLES)
@json_option
def list_rigs(as_json: bool) -> None:
    """List the rigs that ship."""
    import json

    from lipwright.rig import RIGS, load_rig

    known = [load_rig(name) for name in RIGS]
    if as_json:
        table = {
            rig.name: {
                "title": rig.title, "controls": len(rig.controls), "follows": follows(rig),
                "discrete": rig.discrete, "source": rig.source, "license": rig.license,
            }
            for rig in known
        }  # fmt: skip
        click.echo(json.dumps(table, ensure_ascii=False, indent=1))
        return
    click.echo(f"{'rig':13}  controls  {'follows':7}  what it is")
    for rig in known:
        click.echo(f"{rig.name:13}  {len(rig.controls):8}  {follows(rig):7}  {rig.title}")


@rigs.command(epilog=SHOW_EXAMPLES)
@click.argument("name", metavar="RIG")
@json_option
def show(name: str, as_json: bool) -> None:
    """Say what a rig, by name or file, has and lacks, and what each control follows."""
    from lipwright.rig import load_rig, rig_to_text

    rig = load_rig(name)
    if as_json:
        click.echo(rig_to_text(rig), nl=False)
        return
    from lipwright.rig.describe import describe

    for line in describe(rig):
        click.echo(line)


@rigs.command(epilog=CHECK_EXAMPLES)
@click.argument("names", metavar="RIG...", nargs=-1, required=True)
def check(names: tuple[str, ...]) -> int:
    """Find out whether rigs can be used, and what they do not say.

    What can be moved all the same is a warning; exit status 2 means that a rig cannot be used.
    """
    from lipwright.rig import load_rig
    from lipwright.rig.describe import complaints, following

    worst = 0
    for name in names:
        try:
            rig = load_rig(name)
        except LipwrightError as error:
            say(f"lipwright: {error}")
            worst = 2
            continue
        lines = list(complaints(rig))
        for line in lines:
            warn(f"{name}: {line}", "auto")
        quiet = "" if lines else ", nothing to complain of"
        say(f"{name}: {len(rig.controls)} controls, {len(following(rig))} follow{quiet}")
    return worst


@rigs.command(epilog=NEW_EXAMPLES)
@click.argument("name")
@click.option("-o", "--output", required=True, type=Path, metavar="FILE",
              help="The rig to make, .json.")  # fmt: skip
@click.option("--like", metavar="RIG", help="Follow as the controls of this rig of these names do; "
              "without controls, a copy of it.")  # fmt: skip
@click.option("--controls", metavar="NAME,...", help="The names of the controls.")
@click.option("--from", "source", type=Path, metavar="GLB",
              help="The controls are the morph targets of this character.")  # fmt: skip
def new(
    name: str, output: Path, like: str | None, controls: str | None, source: Path | None
) -> None:
    """Make a rig that you can change, guessing by their names what its controls follow.

    The guesses are those of canonical controls and of the rigs that ship; what is not guessed
    rests. The file is JSON; docs/rigs.md explains each field.
    """
    from dataclasses import replace

    from lipwright.controls import is_text
    from lipwright.export import check_targets
    from lipwright.export.rig_guess import character_controls, guess_rig
    from lipwright.rig import load_rig, save_rig

    if (controls is None) == (source is None) and (controls is not None or like is None):
        raise LipwrightError(
            "say what the controls are: --controls a,b,c or --from character.glb, or --like RIG"
        )
    if output.suffix.lower() != ".json":
        raise LipwrightError(f"{output}: a rig is a JSON file; name one that ends in .json")
    if output.exists():
        raise LipwrightError(f"{output}: is there already; name another file, or delete it")
    check_targets([output])
    known = load_rig(like) if like is not None else None
    if known is not None and controls is None and source is None:
        if not name or not is_text(name):
            raise LipwrightError(f"a rig cannot be called {name[:40]!a}; name it")
        save_rig(replace(known, name=name), output)
        say(f"{output}: {name}, {len(known.controls)} controls, as in {known.name}")
        return
    names = character_controls(source) if source is not None else _split(controls or "")
    guess = guess_rig(name, names, known)
    save_rig(guess.rig, output)
    for line in _guessed(guess):
        say(f"{output}: {line}")


def _split(controls: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in controls.split(","))


def _guessed(guess: Guess) -> list[str]:
    from collections import Counter

    rig = guess.rig
    count = Counter(known for known, _ in guess.known.values())
    ways = ", ".join(f"{number} as in {known}" for known, number in count.most_common())
    lines = [
        f"{rig.name}, {len(rig.controls)} controls, {len(guess.known)} follow"
        + (f": {ways}" if ways else "")
    ]
    resting = [name for name in rig.names if name not in guess.known]
    if resting:
        more = f" and {len(resting) - SHOWN} more" if len(resting) > SHOWN else ""
        lines.append(f"resting until you say what they follow: {', '.join(resting[:SHOWN])}{more}")
    if guess.shutting:
        lines.append(
            "no mouthClose, so the jaw shuts the lips: "
            f"{', '.join(guess.shutting)} = jawOpen - mouthClose"
        )
    return lines
