"""`lipwright bigrams plot` and `lipwright bigrams editor`: to look at a set, and to draw it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from lipwright.cli.progress import say
from lipwright.errors import LipwrightError, MissingExtraError

if TYPE_CHECKING:
    from lipwright.track import PhoneTrack

PLOT_EXAMPLES = """\b
Examples:
  lipwright bigrams plot "Oh no, we are late." --pose open --pose W -o late.png
    late.png: 13 phones, 1.9 s, open W
\b
  lipwright bigrams plot "Five papers." -o papers.png
  lipwright bigrams plot --phones talk.TextGrid --bigrams anna.json -o talk.png
"""
EDITOR_EXAMPLES = """\b
Examples:
  lipwright bigrams editor english --unsaved
    my-english.json: no unsaved edits
\b
  lipwright bigrams editor english -o anna.json
  lipwright bigrams editor anna.json --text "Five papers flew away."
"""

TYPICAL = "Phone times to use instead of a text: TextGrid, CTM, lab, JSON, pho."
phones_option = click.option("--phones", type=Path, help=TYPICAL)


@click.command(epilog=PLOT_EXAMPLES)
@click.argument("text", required=False)
@phones_option
@click.option("--bigrams", default="english", show_default=True,
              help="The set: the name of one that ships, or a file.")  # fmt: skip
@click.option("--pose", "poses", multiple=True,
              help="Pose to draw; repeat for several.  [default: four that move most]")  # fmt: skip
@click.option("-o", "--output", "out", type=Path, default=Path("bigrams.png"), show_default=True,
              help="The PNG to write.")  # fmt: skip
def plot(
    text: str | None, phones: Path | None, bigrams: str, poses: tuple[str, ...], out: Path
) -> None:
    """Draw what each step of the runtime does to the curves of a line.

    Five panels on one clock: the curves of each pair, stitched, without valleys, within the
    constraints, within the speed limit. Without a recording the phones of TEXT have times by a
    plain rule.
    """
    from lipwright.bigrams.families import load_bigrams
    from lipwright.export import check_targets
    from lipwright.studio.panels import write_panels

    if out.suffix.lower() != ".png":
        raise LipwrightError(f"{out}: a picture is written as .png; name such a file")
    if (text is None) == (phones is None):
        raise LipwrightError("give either a text or its phones with --phones")
    check_targets([out], None, [] if phones is None else [phones])
    chosen = load_bigrams(bigrams)
    track = _track(text, phones, chosen.language)
    drawn = write_panels(out, chosen, track, poses)
    say(f"{out}: {len(track)} phones, {track.end:.1f} s, {' '.join(drawn)}")


def _track(text: str | None, phones: Path | None, language: str) -> PhoneTrack:
    from lipwright.formats import read_track
    from lipwright.language.pace import spoken_track

    if phones is not None:
        return read_track(phones)
    return spoken_track(text or "", language, "the text")


@click.command(epilog=EDITOR_EXAMPLES)
@click.argument("name", metavar="SET")
@click.option("-o", "--output", "out", type=Path,
              help="The child set to edit, made at the first save; a set of your own is else "
              "edited itself, and of one that ships the child my-SET.json.")  # fmt: skip
@click.option("--text", "-t", help="The line to begin with.  [default: one of the set's language]")
@phones_option
@click.option("--host", default="127.0.0.1", show_default=True,
              help="Address to listen on; others than this let your network edit.")  # fmt: skip
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="0 takes a free one.")
@click.option("--open/--no-open", "opens", default=True, help="Open the page in the browser.")
@click.option("--unsaved", is_flag=True,
              help="Only say which edits a journal keeps that are not saved yet.")  # fmt: skip
def editor(
    name: str, out: Path | None, text: str | None, phones: Path | None, host: str, port: int,
    opens: bool, unsaved: bool,
) -> None:  # fmt: skip
    """Edit a set in the browser: draw curves, and see at once what becomes of a line.

    Ctrl-C ends it. Edits that were not saved are kept beside the set and offered next time.
    """
    from lipwright.studio.workspace import unsaved_edits

    if unsaved:
        path, pairs = unsaved_edits(name, out)
        say(f"{path}: not saved: {', '.join(pairs)}" if pairs else f"{path}: no unsaved edits")
        return
    try:
        import fastapi
        import uvicorn
    except ModuleNotFoundError as error:
        raise MissingExtraError(error.name or "fastapi", "studio") from error
    del fastapi, uvicorn
    _edit(name, out, text, phones, host, port, opens)


def _edit(
    name: str, out: Path | None, text: str | None, phones: Path | None, host: str, port: int,
    opens: bool,
) -> None:  # fmt: skip
    from lipwright.formats import read_track
    from lipwright.studio.desk import Desk
    from lipwright.studio.journal import journal_path, only_editor
    from lipwright.studio.origin import open_origin
    from lipwright.studio.serve import address, listen, serve
    from lipwright.studio.workspace import Workspace

    path = open_origin(name, out).path
    with only_editor(path):
        workspace = Workspace(name, out)
        given = None if phones is None else (str(phones), read_track(phones))
        desk = Desk(workspace, text, given)
        listening = listen(host, port)
        page = address(host, listening)

        def begun() -> None:
            say(f"{path}: {page} (Ctrl-C ends it)")
            if opens:
                click.launch(page)

        serve(desk, host, listening, begun)
        count = len(workspace.unsaved) or len(workspace.pending.edits if workspace.pending else ())
    if count:
        pairs = "pair is" if count == 1 else "pairs are"
        say(f"{path}: {count} unsaved {pairs} kept in {journal_path(path).name} for the next time")
