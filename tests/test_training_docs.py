"""The pages on training are true: keys and defaults, commands, sentences to record."""

from __future__ import annotations

import dataclasses
import json
import re
import shlex
from collections import Counter
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any, get_args, get_type_hints

import click
import pytest

from lipwright.cli.app import app
from lipwright.language import get_language
from lipwright.train.config import Config
from lipwright.train.config_file import config_from, load_config

ROOT = Path(__file__).resolve().parents[1]
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").glob("*.md")])
TRAINING = (ROOT / "docs" / "training.md").read_text("utf-8")
SENTENCES = ROOT / "examples" / "sentences.txt"
REQUIRED = "required"

ENGLISH = (
    "AA AE AH AO AW AY EH ER EY IH IY OW OY UH UW "
    "P B T D K G CH JH F V TH DH S Z SH ZH HH M N NG L R W Y"
)
"""the phones of the lexicon"""


def keys(kind: type[Any], before: str = "") -> Iterator[tuple[str, str]]:
    """Dotted key to default, as JSON, of a configuration."""
    hints = get_type_hints(kind)
    for field in dataclasses.fields(kind):
        hint, name = hints[field.name], before + field.name
        if dataclasses.is_dataclass(hint):
            assert isinstance(hint, type)
            yield from keys(hint, f"{name}.")
        elif field.default is dataclasses.MISSING:
            yield name, REQUIRED
        else:
            yield name, f"`{json.dumps(field.default)}`"


def choices(kind: type[Any]) -> Iterator[str]:
    """The words that keys may have as values."""
    for hint in get_type_hints(kind).values():
        if dataclasses.is_dataclass(hint):
            assert isinstance(hint, type)
            yield from choices(hint)
        else:
            yield from (word for word in get_args(hint) if isinstance(word, str))


def test_the_page_has_each_key_of_a_configuration_with_its_default() -> None:
    section = TRAINING.partition("\n## Every key\n")[2].partition("\n## ")[0]
    rows = [row.split(" | ") for row in section.splitlines() if row.startswith("| `")]
    listed = [(row[0].strip("| `"), row[1]) for row in rows]
    assert sorted(listed) == sorted(keys(Config))


def test_the_page_names_each_word_that_a_key_may_have() -> None:
    section = TRAINING.partition("\n## Every key\n")[2].partition("\n## ")[0]
    for word in choices(Config):
        assert f"`{word}`" in section or f'`"{word}"`' in section, word


def test_configurations_on_the_page_are_configurations() -> None:
    blocks = re.findall(r"```json\n(.*?)```", TRAINING, re.DOTALL)
    assert blocks
    for block in blocks:
        assert config_from(json.loads(block), "training.md").name


def test_the_table_of_configurations_agrees_with_their_files() -> None:
    table = TRAINING.partition("\n## Configurations\n")[2].partition("\n## ")[0]
    rows = {
        row.split(" | ")[0].strip("| "): row.strip("|").split(" | ") for row in table.split("\n")
    }
    for column, name in enumerate(("window", "thesis", "lipwright"), start=1):
        config = load_config(name)
        features = rows["features"][column]
        assert re.findall(r"`(\w+)`", features) == list(config.features)
        windows = rows["windows Kx, Ky"][column].strip()
        assert windows.startswith(f"{config.input_window}, {config.output_window}")


def command_lines(page: Path) -> Iterator[list[str]]:
    """The lines in blocks of a page that start `lipwright`, as words."""
    for block in re.findall(r"```\n(.*?)```", page.read_text("utf-8"), re.DOTALL):
        for line in block.splitlines():
            if line.startswith("lipwright "):
                command = re.split(r"\s{2,}", line)[0]  # what follows says what it does
                yield shlex.split(command, comments=True)[1:]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_commands_of_the_pages_have_such_arguments(page: Path) -> None:
    for words in command_lines(page):
        command: click.Command = app
        context = click.Context(app, info_name="lipwright")
        path = []
        while isinstance(command, click.Group):
            path.append(words.pop(0))
            found = command.get_command(context, path[-1])
            assert found is not None, " ".join(path)
            command = found
        command.make_context(" ".join(path), words)


def sentences() -> dict[str, str]:
    rows = SENTENCES.read_text("utf-8").splitlines()
    return dict(row.split("\t") for row in rows)


def test_the_sentences_to_record_are_40_short_ones_with_numbers() -> None:
    assert list(sentences()) == [f"{number:02d}" for number in range(1, 41)]
    for text in sentences().values():
        assert 6 <= len(text.split()) <= 12
        assert text.endswith((".", "?"))


def test_the_sentences_have_each_sound_of_english_six_times() -> None:
    english = get_language("en")
    words = chain.from_iterable(english.normalize(text) for text in sentences().values())
    said = [english.pronounce(word.text)[0] for word in words]
    assert {word.source for word in said} <= {"lexicon", "rule"}
    count = Counter(chain.from_iterable(word.phones for word in said))
    assert set(count) == set(ENGLISH.split())
    assert min(count.values()) >= 6


def test_the_tutorial_quotes_sentences_as_they_are() -> None:
    page = (ROOT / "docs" / "your-own-face.md").read_text("utf-8")
    quoted = set(re.findall(r'--text "(.*?)"', page))
    assert quoted
    assert quoted <= set(sentences().values())
