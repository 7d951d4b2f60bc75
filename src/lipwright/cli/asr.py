"""`lipwright asr`: models that recognise words."""

from __future__ import annotations

from pathlib import Path

import click

from lipwright.cli.progress import say

ASR_EXAMPLES = """\b
Examples:
  lipwright asr list
  lipwright asr fetch small
  lipwright animate talk.mp3 -o talk.glb                     # now hears words
  lipwright animate talk.mp3 --asr-model whisper-folder -o talk.glb
"""
LIST_EXAMPLES = """\b
Example:
  lipwright asr list
    no model is on this machine; fetch one with: lipwright asr fetch small
"""
FETCH_EXAMPLES = """\b
Example:
  lipwright asr fetch small
    small: is in models--Systran--faster-whisper-small
"""


@click.group(epilog=ASR_EXAMPLES)
def asr() -> None:
    """Models that recognise words in recordings that come without (extra asr)."""


@asr.command(name="list", epilog=LIST_EXAMPLES)
def list_models() -> None:
    """List the models on this machine."""
    from lipwright.speech.transcriber import fetched_models

    found = fetched_models()
    for name, folder in found.items():
        click.echo(f"{name}: {folder}")
    if not found:
        click.echo("no model is on this machine; fetch one with: lipwright asr fetch small")


@asr.command(epilog=FETCH_EXAMPLES)
@click.argument("name")
def fetch(name: str) -> None:
    """Download a model by its name: tiny, base, small, medium, large-v3, ..."""
    from lipwright.speech.transcriber import fetch_model

    say(f"{name}: is in {Path(fetch_model(name)).parents[1].name}")
