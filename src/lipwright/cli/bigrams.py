"""`lipwright bigrams`: the sets of phone bigrams that the engine bigram speaks with."""

from __future__ import annotations

import click


@click.group(epilog="Each command has examples: lipwright bigrams COMMAND --help")
def bigrams() -> None:
    """Make, check and change the curves that an animator draws for pairs of phones."""
