"""Letters to sounds by a conditional random field, for words that no lexicon has.

The field was trained by bench/swedish_g2p.py on the lexicon as `lexicon.mend` leaves it: a label
for each letter, its sounds before r and dentals meet. The one that comes with gruut has learnt the
lexicon's own spelling, without retroflexes, and sees one letter at a time.
"""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Final

from lipwright.language.swedish.lexicon import stressed

if TYPE_CHECKING:
    from pycrfsuite import Tagger

MODEL: Final = Path(__file__).with_name("g2p.crf")
SILENT: Final = "_"
"""label of a letter without a sound"""
_EDGE: Final = "###"


def features(word: str) -> list[list[str]]:
    """What the field sees of each letter: up to three letters before and behind it."""
    text = _EDGE + word + _EDGE
    rows = []
    for place in range(len(_EDGE), len(word) + len(_EDGE)):
        row = ["b", "c=" + text[place]]
        for reach in (1, 2, 3):
            before, behind = text[place - reach : place], text[place + 1 : place + reach + 1]
            row += [f"l{reach}={before}", f"r{reach}={behind}"]
            row += [f"L{reach}={before}{text[place]}", f"R{reach}={text[place]}{behind}"]
        row += ["m=" + text[place - 1 : place + 2], "n=" + text[place - 2 : place + 3]]
        row += ["o=" + text[place - 2 : place + 2], "q=" + text[place - 1 : place + 3]]
        rows.append(row)
    return rows


class Field:
    """The trained field."""

    def __init__(self, model: Path = MODEL) -> None:
        """The file, which is read when the first word is asked for."""
        self._model = model

    @cached_property
    def _tagger(self) -> Tagger:
        from pycrfsuite import Tagger

        tagger = Tagger()
        tagger.open(str(self._model))
        return tagger

    def guess(self, word: str) -> tuple[tuple[str, ...], float]:
        """The sounds of a word in lower case, and how sure they are, from 0 to 1."""
        labels = self._tagger.tag(features(word))
        sounds = [sound for label in labels if label != SILENT for sound in label.split()]
        return stressed(sounds), self._tagger.probability(labels)
