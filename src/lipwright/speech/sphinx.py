"""Forced alignment with the English acoustic model of pocketsphinx, for any language.

The sounds of other languages become the units of the model that sound most like them (`units`).

The search is ours, since that of pocketsphinx gives up on a transcript with one wrong word, takes
1.2 GB for three minutes and cannot be stopped; the model and its front end are the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from lipwright.errors import LipwrightError
from lipwright.speech.acoustic import load_model, model_folder
from lipwright.speech.aligner import Alignment, Progress
from lipwright.speech.fit import FOREIGN_ALLOWANCE, SpokenRow
from lipwright.speech.graph import build_graph
from lipwright.speech.path import find_path
from lipwright.speech.placing import LEAST_SHARE, LEAST_SHARE_FOREIGN, to_alignment
from lipwright.speech.recording import SILENT_DB, dynamic_range, levels, spectra, static_features
from lipwright.speech.repair import Judge
from lipwright.speech.scores import Scores
from lipwright.speech.search import Search, costs_for
from lipwright.speech.units import all_units

if TYPE_CHECKING:
    from lipwright.audio import Sound
    from lipwright.language import Dictionary, SpokenWord

_HEARD: Final = 0.3  # share of the work that is done once the sound is read


class SphinxAligner:
    """Forced alignment with pocketsphinx's English model."""

    name = "sphinx"

    def is_available(self) -> bool:
        """Whether pocketsphinx and its model are installed."""
        return model_folder() is not None

    def languages(self) -> tuple[str, ...]:
        """Every language that text is read in: their sounds become the model's units."""
        from lipwright.language.codes import NAMES

        return tuple(NAMES)

    def align(
        self,
        audio: Sound,
        words: Sequence[SpokenWord],
        language: str,
        dictionary: Dictionary | None = None,
        progress: Progress | None = None,
    ) -> Alignment:
        """Phones and words with times and confidences; see `Aligner.align`.

        Raises:
            LipwrightError: nothing is heard, or the words do not fit the sound.
        """
        from lipwright.language.codes import is_english

        rows = spoken_rows(words, language, dictionary)
        return align_rows(audio, rows, progress, is_english(language))


def align_rows(
    audio: Sound, rows: Sequence[SpokenRow], progress: Progress | None = None,
    english: bool = True,
) -> Alignment:  # fmt: skip
    """Put words whose units are known on the time axis of `audio`; see `Aligner.align`.

    What is not `english` may fit the model less well.

    Raises:
        LipwrightError: nothing is heard, or the words do not fit the sound.
    """
    report = progress or (lambda share: None)
    power = spectra(audio)
    if not len(power) or levels(power).max() < SILENT_DB:
        name = getattr(audio, "name", "audio")
        raise LipwrightError(f"{name}: nothing is heard; record it louder, or name another file")
    static, costs = static_features(power), costs_for(dynamic_range(power))
    del power
    report(_HEARD)
    scores = Scores(load_model(), static)
    graph = build_graph(scores.model, [row.model_phones for row in rows])
    search = Search(graph, scores, costs)
    path = find_path(search, lambda share: report(_HEARD + (1 - _HEARD) * share))
    judged = Judge(search, path, rows, 0.0 if english else FOREIGN_ALLOWANCE).judge()
    return to_alignment(judged, rows, audio, LEAST_SHARE if english else LEAST_SHARE_FOREIGN)


def spoken_rows(
    words: Sequence[SpokenWord], language: str, dictionary: Dictionary | None
) -> list[SpokenRow]:
    """The words with every way to say them, as the acoustic model knows them."""
    from lipwright.language import get_language

    rows = []
    for word, ways in zip(
        words, get_language(language).pronounce_all(words, dictionary), strict=True
    ):
        units = tuple(all_units(way.phones, way.ipa, language) for way in ways)
        rows.append(SpokenRow(word, tuple(way.phones for way in ways), units))
    return rows
