"""`lipwright bigrams`: the sets of phone bigrams that the engine bigram speaks with."""

from __future__ import annotations

import click

from lipwright.cli import bigram_checking, bigram_editing, bigram_sets


@click.group(epilog="Each command has examples: lipwright bigrams COMMAND --help")
def bigrams() -> None:
    """Make, check and change the curves that an animator draws for pairs of phones."""


bigrams.add_command(bigram_sets.new)
bigrams.add_command(bigram_sets.info)
bigrams.add_command(bigram_checking.check)
bigrams.add_command(bigram_checking.coverage)
bigrams.add_command(bigram_sets.import_set)
bigrams.add_command(bigram_sets.export)
bigrams.add_command(bigram_editing.edit)
