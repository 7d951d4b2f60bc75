"""The commands."""

from __future__ import annotations

import click

from lipwright.cli import (
    aligning,
    animating,
    asr,
    bigram_fitting,
    bigram_tools,
    bigrams,
    capturing,
    converting,
    datasets,
    evaluating,
    faces,
    heads,
    listing,
    modelling,
    phones,
    rig_bones,
    rig_fitting,
    rig_poses,
    rig_transfer,
    rigs,
    saying,
    training,
)
from lipwright.version import VERSION


@click.group(
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="Each command has examples: lipwright COMMAND --help",
)
@click.version_option(VERSION, message="lipwright %(version)s")
def app() -> None:
    """Speech in, natural facial animation out."""


app.add_command(animating.animate)
app.add_command(saying.say)
app.add_command(aligning.align)
app.add_command(converting.convert)
app.add_command(capturing.capture)
app.add_command(datasets.dataset)
app.add_command(faces.face)
app.add_command(training.train)
app.add_command(training.tune)
app.add_command(evaluating.evaluate)
app.add_command(modelling.models)
app.add_command(bigrams.bigrams)
bigrams.bigrams.add_command(bigram_fitting.fit)
bigrams.bigrams.add_command(bigram_tools.plot)
bigrams.bigrams.add_command(bigram_tools.editor)
app.add_command(rigs.rigs)
rigs.rigs.add_command(rig_fitting.fit)
rigs.rigs.add_command(rig_poses.poses)
rigs.rigs.add_command(rig_transfer.transfer)
rigs.rigs.add_command(rig_bones.bones)
app.add_command(phones.phones)
app.add_command(saying.voices)
app.add_command(asr.asr)
app.add_command(heads.head)
app.add_command(listing.formats)
app.add_command(listing.doctor)
