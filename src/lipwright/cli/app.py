"""The commands and their options."""

from __future__ import annotations

import typer

from lipwright.cli import animating, heads, listing

app = typer.Typer(
    name="lipwright",
    help="Speech in, natural facial animation out.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)


@app.callback(invoke_without_command=True)
def options(
    version: bool = typer.Option(False, "--version", help="Print the version and end."),
) -> None:
    """Speech in, natural facial animation out."""
    if version:
        from lipwright.version import VERSION

        typer.echo(f"lipwright {VERSION}")
        raise typer.Exit


app.command("animate", epilog=animating.ANIMATE_EXAMPLES)(animating.animate)
app.command("align", epilog=animating.ALIGN_EXAMPLES)(animating.align)
app.command("phones", epilog=listing.PHONES_EXAMPLES)(listing.phones)
app.add_typer(heads.app, name="head")
app.command("formats", epilog=listing.FORMATS_EXAMPLES)(listing.formats)
app.command("doctor", epilog=listing.DOCTOR_EXAMPLES)(listing.doctor)
