"""Which units of the acoustic model stand best for each sound of other languages.

    python bench/acoustic_units.py                       # every sound of CANDIDATES
    python bench/acoustic_units.py --sounds y,ø,x
    python bench/acoustic_units.py --languages cmn --sounds p,t,k

Each sound is aligned with each of its candidates in turn, in all sentences of
`bench/language_timing.py` that have it, with the voice's own phones; all other sounds have the
units of `lipwright.speech.units`. The figures are those of the edges of the sound, its start and
the start of the next, in every language together and, with `--each`, in each alone: the median and
the mean of the errors, with those over 100 ms counted as 100 ms; and the mean score of the sound,
in nats a frame against any speech. The table of `units` has the best where the gain is more than
chance and not one voice's habit.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Sequence
from functools import cache

import numpy as np

from language_timing import TEXTS, Heard, Said, sentences
from lipwright.language import SpokenWord
from lipwright.speech.acoustic import load_model
from lipwright.speech.features import Floats
from lipwright.speech.fit import PlacedWord, SpokenRow, placed_words
from lipwright.speech.graph import build_graph
from lipwright.speech.path import find_path
from lipwright.speech.placing import edges_of
from lipwright.speech.recording import spectra, static_features
from lipwright.speech.scores import Scores
from lipwright.speech.search import STRICT, Search
from lipwright.speech.units import Units, letters_of, units_of

MOST = 0.1  # s, larger errors count as this

CANDIDATES = {
    "y": "UW IY IH UH Y+UW", "ʏ": "IH UH UW IY", "ø": "ER EY UH EH OW UW AH",
    "œ": "ER EH AH UH", "ɵ": "UH AH UW ER IH", "ʉ": "UW UH IY IH", "ɯ": "UW UH IH",
    "e": "EY IH EH IY", "o": "OW AO UH UW", "a": "AA AE AH AY", "ɑ": "AA AH AO",
    "ɐ": "AH AA ER AE", "ɔ": "AO OW AA AH", "ə": "AH IH UH EH ER", "ɤ": "AH UH OW ER",
    "ɪ": "IH IY EH", "ʊ": "UH UW OW AO", "ɛ": "EH AE EY", "i": "IY IH", "u": "UW UH OW",
    "ʅ": "IH ER UH R AH", "p": "P B", "t": "T D", "k": "K G", "b": "B P", "d": "D T DH", "ɡ": "G K",
    "r": "R D DH L T", "ɾ": "D R DH T L", "ɽ": "D R L T", "ʁ": "R HH G W L AA",
    "x": "HH K SH F TH", "χ": "HH K SH F TH", "ɣ": "G HH W Y V", "ç": "HH SH TH F S HH+Y",
    "ɕ": "SH S CH HH+Y TH", "ʂ": "SH S CH", "ɧ": "SH HH F TH S", "ʐ": "ZH R Z DH",
    "ts": "T+S S CH Z T", "tɕ": "CH JH T+S", "tɕʰ": "CH CH|JH T+SH|S T|CH+SH|S|HH T|CH+SH|S|HH|Y",
    "ʈʂ": "CH JH",
    "ʈʂʰ": "CH T+SH", "tsʰ": "T+S T+HH CH", "ʋ": "V W", "β": "V B W", "ð": "DH D V",
    "ɲ": "N+Y N NG", "ʎ": "L+Y Y L", "ɸ": "F HH", "j": "Y IY", "w": "W UW", "ʔ": "T HH K",
    "v": "V W B", "h": "HH HH|K|SH HH|K|F|TH HH|F|W|UW", "f": "F TH",
    "ɑ̃": "AA AA+N AO AO+N AA+NG", "ɛ̃": "AE EH AE+N EH+N AH", "ɔ̃": "AO OW AO+N OW+N OW+NG",
    "ɐ̃": "AH AH+N AA AE", "œ̃": "AH AE AH+N", "ɐ̃ʊ": "AW AH+W AH+N OW", "iɛ": "IY+EH Y+EH EH",
    "uo": "UW+OW W+AO W+OW AO OW", "ua": "UW+AA W+AA", "iɑ": "IY+AA Y+AA", "uə": "UW+AH W+AH",
    "yɛ": "UW+EH Y+EH W+EH", "yæ": "UW+AE Y+AE W+EH",
    "ɔø": "OY AO+IH", "œy": "AW AY OY", "ɛɪ": "EY AY EH+IH",
}  # fmt: skip


@cache
def heard(language: str) -> list[tuple[Said, Floats]]:
    """The sentences of a language as the acoustic model hears them."""
    return [(said, static_features(spectra(said.audio))) for _, said in sentences(language)]


def measure(
    said: Said, static: Floats, language: str, key: str, candidate: Units
) -> tuple[list[float], list[float]]:
    """Errors in s of the edges of the sounds `key` where they become `candidate`; their scores."""
    words: dict[int, list[int]] = defaultdict(list)
    for index, sound in enumerate(said.sounds):
        words[sound.word].append(index)
    indices = list(words.values())
    rows = [_row([said.sounds[i] for i in some], language, key, candidate) for some in indices]
    graph = build_graph(load_model(), [row.model_phones for row in rows])
    search = Search(graph, Scores(load_model(), static), STRICT)
    size = np.full(len(said.sounds), MOST)
    scores = np.full(len(said.sounds), np.nan)
    for word in placed_words(graph, find_path(search, lambda share: None)):
        row, some = rows[word.index], indices[word.index]
        edges = edges_of(word, row, said.audio.duration)[:-1]
        size[some] = np.abs(np.subtract(edges, [said.sounds[i].start for i in some]))
        scores[some] = phone_scores(word, row)
    own = [i for i, sound in enumerate(said.sounds) if letters_of(sound.ipa) == key]
    edged = sorted({i + after for i in own for after in (0, 1) if i + after < len(size)})
    errors = [min(size[i], MOST) for i in edged if not np.isnan(size[i])]
    return errors, [scores[i] for i in own if not np.isnan(scores[i])]


def phone_scores(word: PlacedWord, row: SpokenRow) -> list[float]:
    """Nats a frame by which each phone of a word beats any speech."""
    scores, first = [], 0
    for units in row.units[word.pronunciation]:
        some = word.segments[first : first + len(units)]
        scores.append(sum(s.score for s in some) / (some[-1].stop - some[0].start))
        first += len(units)
    return scores


def _row(sounds: Sequence[Heard], language: str, key: str, candidate: Units) -> SpokenRow:
    units = tuple(
        candidate if letters_of(s.ipa) == key else units_of(s.phone, s.ipa, language)
        for s in sounds
    )
    word = SpokenWord("word", "word", 1, 1)
    return SpokenRow(word, (tuple(s.phone for s in sounds),), (units,))


def main() -> None:
    """Run what the options ask for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--languages", default=",".join(TEXTS), help="ISO codes with commas")
    parser.add_argument("--sounds", default=",".join(CANDIDATES), help="IPA with commas")
    parser.add_argument("--each", action="store_true", help="each language alone too")
    options = parser.parse_args()
    for written in options.sounds.split(","):
        for candidate in CANDIDATES[written].split():
            line = figures(written, candidate, options.languages.split(","), options.each)
            if line:
                print(line, flush=True)


def figures(written: str, candidate: str, languages: Sequence[str], each: bool) -> str:
    """The line of one sound and candidate; empty where no sentence has the sound."""
    key, units = letters_of(written), tuple(candidate.split("+"))
    errors: list[float] = []
    scores: list[float] = []
    alone = []
    for language in languages:
        found: list[float] = []
        for said, static in heard(language):
            if any(letters_of(sound.ipa) == key for sound in said.sounds):
                more, some = measure(said, static, language, key, units)
                found += more
                scores += some
        if found:
            alone.append(f"{language} {1000 * np.mean(found):.1f}")
        errors += found
    if not errors:
        return ""
    line = (
        f"{written:4} {candidate:6} edges {len(errors):4}  median {1000 * np.median(errors):5.1f}"
    )
    line += f"  mean {1000 * np.mean(errors):5.1f}  score {np.mean(scores):6.2f}"
    return f"{line}  {' '.join(alone)}" if each else line


if __name__ == "__main__":
    main()
