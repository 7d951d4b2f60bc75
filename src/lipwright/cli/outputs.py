"""What commands write: outputs by suffix or through a pipe, and for whom."""

from __future__ import annotations

import functools
import itertools
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lipwright.cli.inputs import STDIN, piped_out
from lipwright.cli.progress import say, warn
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.export import Exporter, ExportOptions, Performance
    from lipwright.rig import Rig
    from lipwright.track import PhoneTrack

out_option = click.option(
    "-o", "--output", "out", multiple=True, help="File to write, or -. Repeat for several."
)
format_option = click.option("--format", "-f", help="Format, where a suffix does not say it.")


@dataclass(frozen=True)
class Wanted:
    """For whom curves are written, and how."""

    rig: str | None
    """a rig that ships, or a rig's file"""
    onto: Path | None
    """the GLB or VRM that a GLB is to animate"""
    keys: float | None
    """the bound of few keys, in units of the controls"""
    node: str
    """of the scene, that has the blendshapes; see `ExportOptions.node`"""
    edits: Path | None
    """the file that keeps what people change in the output"""
    size: str
    """of a video, WIDTHxHEIGHT"""

    @property
    def inputs(self) -> tuple[str | Path, ...]:
        """The files that are read, and that no output may replace."""
        named = (self.rig, self.onto, self.edits)
        return tuple(name for name in named if name is not None)

    @functools.cached_property
    def target(self) -> Rig | None:
        """The rig.

        Raises:
            LipwrightError: it cannot be used.
        """
        from lipwright.rig import load_rig

        return None if self.rig is None else load_rig(self.rig)

    def options(self, title: str) -> ExportOptions:
        """The exporters' options.

        Raises:
            LipwrightError: the size is none.
        """
        from lipwright.export import ExportOptions

        width, _, height = self.size.partition("x")
        if not (width.isdecimal() and height.isdecimal()):
            raise LipwrightError(
                f"--size {self.size!r} is not WIDTHxHEIGHT in pixels, such as 512x512"
            )
        return ExportOptions(
            size=(int(width), int(height)),
            title=title.encode("utf-8", "replace").decode(),  # a file's name may be any bytes
            keys=self.keys,
            onto=self.onto,
            node=self.node,
        )

    def check(self, targets: tuple[str, ...], suffix: str | None) -> None:
        """Refuse options that no output of this run heeds.

        Raises:
            LipwrightError: there is one.
        """
        names = [f"out{suffix}" if suffix else target for target in targets]
        if self.onto is not None and not any(name.endswith(".glb") for name in names):
            raise LipwrightError(f"--onto {self.onto}: only a GLB has a character; add -o NAME.glb")
        if self.edits is not None:
            from lipwright.edits.keeping import edited_output

            files = [target for target in targets if target != STDIN]
            edited_output(files, self.target, self.onto, suffix)


def character_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Options of commands that export curves; they arrive as `wanted`."""

    @click.option("--rig", help="Rig to move: one that ships, or a .json file; see lipwright rigs.")
    @click.option(
        "--onto", type=Path, help="GLB or VRM of a character, which the .glb output animates."
    )
    @click.option(
        "--keys", type=float, help="Few keys with tangents, within this of every frame, as 0.01."
    )
    @click.option(
        "--node", default="", help="Node with the blendshapes, in .anim, .tres and .maya.anim."
    )
    @click.option(
        "--edits", type=Path, help="File that keeps what you change in the output, for later runs."
    )
    @click.option(
        "--size", default="512x512", show_default=True, help="Width x height of a video in pixels."
    )
    @functools.wraps(command)
    def inner(
        *arguments: Any, rig: str | None, onto: Path | None, keys: float | None,
        node: str, edits: Path | None, size: str, **more: Any,
    ) -> Any:  # fmt: skip
        return command(*arguments, wanted=Wanted(rig, onto, keys, node, edits, size), **more)

    return inner


def suffix_of(format: str | None) -> str | None:  # noqa: A002  # as the option is called
    """The suffix that `--format` means."""
    return format if format is None or format.startswith(".") else f".{format}"


def targets_of(out: tuple[str, ...], known: Iterable[str], suffix: str | None) -> tuple[str, ...]:
    """The outputs.

    Raises:
        LipwrightError: none is named, or the pipe twice, or without a format, or bytes that no
            text is.
    """
    if not out:
        raise LipwrightError(
            f"no output; name one with -o: {', '.join(f'-o NAME{s}' for s in known)}"
        )
    for name in out:
        shown = name.encode("utf-8", "replace").decode()
        if shown != name:  # some files have their own name inside, as text
            raise LipwrightError(f"{shown}: its name is not UTF-8; name another file")
    if out.count(STDIN) > 1:
        raise LipwrightError("standard output is named twice; give each output its own place")
    if STDIN in out and suffix is None:
        raise LipwrightError("standard output has no suffix; choose the format with --format")
    if STDIN in out:
        piped_out()
    return out


def outputs_known() -> tuple[str, ...]:
    """The suffixes that commands which animate can write."""
    from lipwright.export import EXPORTERS
    from lipwright.formats import TRACK_FORMATS

    return (*EXPORTERS, *(suffix for suffix in TRACK_FORMATS if suffix not in EXPORTERS))


def tracks_apart(
    targets: tuple[str, ...], suffix: str | None
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The outputs that hold curves, and those that hold a phone track.

    Raises:
        LipwrightError: one is neither.
    """
    from lipwright.export import EXPORTERS
    from lipwright.formats.suffixes import by_suffix

    known = {name: name in EXPORTERS for name in outputs_known()}
    curves = [by_suffix(known, Path(target), suffix, "output") for target in targets]
    return tuple(itertools.compress(targets, curves)), tuple(
        target for target, is_curves in zip(targets, curves, strict=True) if not is_curves
    )


def write_tracks(targets: tuple[str, ...], track: PhoneTrack, suffix: str | None) -> None:
    """Write a phone track to files, or through a pipe."""
    from lipwright.formats import write_track

    for target in targets:
        if target != STDIN:
            write_track(target, track, suffix)
        else:
            pipe(suffix, lambda path: write_track(path, track, suffix))


def check_files(targets: tuple[str, ...], speech: str, *inputs: str | Path | None) -> None:
    """Find out now, rather than after minutes of work, what cannot be written."""
    from lipwright.export import check_targets

    files = [target for target in targets if target != STDIN]
    read = [path for path in inputs if path is not None and path != STDIN]
    check_targets(files, None if speech == STDIN else speech, read)


def exporters_of(
    targets: tuple[str, ...], suffix: str | None, wanted: Wanted, names: tuple[str, ...], who: str
) -> None:
    """Find out before long work what the outputs' formats lack, or cannot hold.

    Args:
        targets: the outputs.
        suffix: what `--format` means.
        wanted: for whom they are.
        names: the controls of the curves.
        who: what moves those controls, and what can be done where no head has them.

    Raises:
        LipwrightError: a package or head is missing, or curves of no head are to be shown on one.
    """
    from lipwright.export import EXPORTERS
    from lipwright.formats.suffixes import by_suffix

    found = [by_suffix(EXPORTERS, Path(target), suffix, "export") for target in targets]
    wanted.check(targets, suffix)
    rig = wanted.target
    for target, exporter in zip(targets, found, strict=True):
        if wanted.onto is None or not exporter.shows:
            exporter.prepare()
        _check_shown(target, exporter, wanted, rig, names, who)


def _check_shown(
    target: str, exporter: Exporter, wanted: Wanted, rig: Rig | None, names: tuple[str, ...],
    who: str,
) -> None:  # fmt: skip
    """Refuse to put what moves no human head on one; our own tables hold any controls."""
    from lipwright.pipeline import moves_heads
    from lipwright.rig import LinearMapping

    if not exporter.rig and not exporter.shows:
        return
    if rig is None and not moves_heads(names):
        raise LipwrightError(f"{target}: {who}")
    if rig is None or not exporter.shows or wanted.onto is not None or rig.looks:
        return
    if rig.bones and isinstance(rig.mapping, LinearMapping):
        return  # our head can be put on them
    if not moves_heads(rig.names):
        raise LipwrightError(
            f"{target}: the rig {rig.name!r} does not say how it looks on a human face; write "
            "another format, or name its character with --onto"
        )


def export_targets(
    performance: Performance, targets: tuple[str, ...], suffix: str | None, wanted: Wanted,
    options: ExportOptions,
) -> None:  # fmt: skip
    """Write the outputs, whole or not at all; what goes through a pipe first."""
    from lipwright.export import export_all

    files = [target for target in targets if target != STDIN]
    if STDIN in targets:
        pipe(suffix, lambda path: export_all([path], performance, format=suffix, options=options))
    if files and wanted.edits is not None:
        from lipwright.edits import export_with_edits

        kept = export_with_edits(files, performance, wanted.edits, options, format=suffix)
        if kept.unrecorded:
            say(f"{kept.path}: no record of what was written there; its differences were taken")
        if kept.put_back:
            say(
                f"{kept.path}: held none of the edits of {wanted.edits}, which were put back; "
                "delete that file to drop them"
            )
        if kept.controls:
            controls = ", ".join(kept.controls[:3]) + (", ..." if len(kept.controls) > 3 else "")
            say(f"{kept.path}: kept edits of {kept.seconds:.1f} s in {controls}")
    elif files:
        export_all(files, performance, format=suffix, options=options)


MOST_LACKING = 6  # controls that are named


def warn_left_out(performance: Performance, wanted: Wanted, progress: str) -> None:
    """Say which of the moving controls the character of `--onto` lacks."""
    if wanted.onto is None:
        return
    from lipwright.export.onto import left_out

    lacking = left_out(wanted.onto, performance)
    if lacking:
        more = ", ..." if len(lacking) > MOST_LACKING else ""
        named = ", ".join(lacking[:MOST_LACKING]) + more
        warn(f"{wanted.onto} has no {named}; left out: {len(lacking)} of the curves", progress)


def pipe(suffix: str | None, write: Callable[[Path], None]) -> None:
    """Write a file that nobody keeps, and send it to standard output."""
    with tempfile.TemporaryDirectory(prefix="lipwright-") as folder:
        path = Path(folder) / f"out{suffix}"
        write(path)
        stream = piped_out()
        stream.write(path.read_bytes())
        stream.flush()
