"""How well the aligner finds the phones of each language, on voices that know their phone times.

    python bench/language_timing.py                     # every language
    python bench/language_timing.py --languages sv,cmn --sounds
    python bench/language_timing.py --json figures.json --markdown table.md

The voices are espeak-ng's (extra `espeak`), each language said by three of them at three speeds.
The text's phones come from our own front end; where a language has none yet, or with `--own`, from
the voice itself. Phones of text and voice are matched by edit distance, and the error of a match
is the aligned start minus the true one.

espeak-ng calls the burst the start of a stop and leaves the closure to the sound before it. Its
closures are digital silence, so the truth here starts a sound where the silence before it starts,
as people label speech. Starts after a longer silence, a pause, are not measured: nobody can hear
where a closure begins in it.
"""

from __future__ import annotations

import argparse
import json
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from alignment import CORPORA, Labelled, match_phones, read_reference, summarize
from lipwright import espeak
from lipwright.audio import Audio, open_audio
from lipwright.errors import LipwrightError
from lipwright.language import LANGUAGES, SpokenWord, get_language
from lipwright.language.codes import is_english
from lipwright.language.espeak_ipa import read_espeak
from lipwright.language.ipa import read_ipa
from lipwright.speech import Alignment, align
from lipwright.speech.features import FRAME_RATE
from lipwright.speech.fit import SpokenRow
from lipwright.speech.recording import spectra, static_features
from lipwright.speech.sphinx import align_rows
from lipwright.speech.units import all_units
from warping import move_times, warp

VARIANTS = (("", 175), ("+f2", 195), ("+m3", 150))  # of timbre, and words a minute
SILENT = 1e-3  # full scale is 1; espeak-ng's closures are zeros
PAUSE = 0.15  # s of silence from which on it is no closure

_ENGLISH = (
    "Please call your brother before the boat leaves the harbour.",
    "The young judge was measuring a huge blue vase with both hands.",
    "We should choose a better path through the thick green forest.",
    "My mother bought five fresh apples and a loaf of bread.",
    "Nobody knows how the noisy boys found their way home.",
    "A quick brown fox jumps over the lazy dog.",
)
TEXTS = {
    "en": _ENGLISH,
    "en-gb": _ENGLISH,
    "sv": (
        "Min mamma köpte sju bullar och en påse äpplen i affären.",
        "Barnen har kört till sjön för att bada i det kalla vattnet.",
        "Jag tycker om att läsa böcker när det regnar ute.",
        "Kan du hjälpa mig att bära bordet upp för trappan?",
        "Tjugo små fåglar sjunger i det höga trädet varje morgon.",
        "Hon skrev ett långt brev till sin farbror i Göteborg.",
        "Vi ska åka skidor och dricka varm choklad i vinter.",
    ),
    "cmn": (
        "我的妈妈今天早上去市场买苹果。",
        "请你告诉我图书馆在哪里。",
        "他们昨天晚上在北京看了一场电影。",
        "春天来了，花园里的花都开了。",
        "这个孩子很喜欢吃日本菜。",
        "我们下个星期要去旅行，你想去吗？",
        "老师说学习中文需要很多时间。",
    ),
    "de": (
        "Meine Mutter kauft heute frisches Brot und zwei Äpfel.",
        "Der kleine Junge spielt gern mit seinem Hund im Garten.",
        "Können Sie mir bitte sagen, wo der Bahnhof ist?",
        "Ich möchte im Frühling nach München und Köln fahren.",
        "Das schöne Mädchen singt ein fröhliches Lied vor der Kirche.",
        "Wir haben gestern Abend lange über Bücher gesprochen.",
    ),
    "es": (
        "Mi madre compra pan fresco y dos manzanas en el mercado.",
        "El niño pequeño juega con su perro en el jardín.",
        "¿Puede usted decirme dónde está la estación de tren?",
        "Mañana por la noche vamos a cenar en un restaurante chino.",
        "La guitarra vieja de mi abuelo suena muy bien.",
        "Hace mucho calor en la ciudad durante el verano.",
    ),
    "fr": (
        "Ma mère achète du pain frais et deux pommes au marché.",
        "Le petit garçon joue avec son chien dans le jardin.",
        "Pouvez-vous me dire où se trouve la gare, s'il vous plaît ?",
        "Nous avons mangé un bon gâteau chez ma grand-mère dimanche.",
        "La vieille maison blanche est près de la montagne.",
        "Il pleut beaucoup en automne dans le nord du pays.",
    ),
    "it": (
        "Mia madre compra il pane fresco e due mele al mercato.",
        "Il bambino piccolo gioca con il cane nel giardino.",
        "Può dirmi dove si trova la stazione, per favore?",
        "Domani sera andiamo a mangiare una pizza con gli amici.",
        "La ragazza legge un bel libro sulla spiaggia.",
        "In estate fa molto caldo e andiamo spesso al mare.",
    ),
    "nl": (
        "Mijn moeder koopt vers brood en twee appels op de markt.",
        "De kleine jongen speelt graag met zijn hond in de tuin.",
        "Kunt u mij zeggen waar het station is, alstublieft?",
        "Wij gaan morgen met de trein naar Utrecht en Groningen.",
        "Het meisje leest een mooi boek bij het vuur.",
        "Gisteren hebben we lang over het weer gepraat.",
    ),
    "pt": (
        "Minha mãe compra pão fresco e duas maçãs no mercado.",
        "O menino pequeno brinca com o cachorro no jardim.",
        "Você pode me dizer onde fica a estação de trem?",
        "Amanhã vamos jantar com os amigos na cidade velha.",
        "O coração da floresta guarda muitos segredos antigos.",
        "Faz muito calor no verão e vamos sempre à praia.",
    ),
    "ja": (
        "わたしのははは、あさ、いちばで、りんごをかいました。",
        "ちいさなこどもが、いぬとにわであそんでいます。",
        "えきはどこにあるか、おしえてください。",
        "きょうはとてもあついので、うみへいきます。",
        "にほんのふゆは、ゆきがたくさんふります。",
        "せんせいは、ふるいほんをまいばんよんでいます。",
    ),
}
"""ISO code to sentences of ours"""
VOICES = {"en": "en-us", "pt": "pt-br"}
"""where the voice's name is not the ISO code"""


@dataclass(frozen=True)
class Heard:
    """A sound of a voice."""

    ipa: str
    phone: str
    start: float
    """s; not a number where the voice does not tell"""
    word: int
    """position of its word in the text"""


@dataclass(frozen=True, eq=False)
class Said:
    """A sentence as a voice said it."""

    audio: Audio
    sounds: tuple[Heard, ...]


def say(text: str, voice: str, words_per_minute: int = 175) -> Said:
    """The sentence with its true times."""
    speech = espeak.speak(text, voice, words_per_minute=words_per_minute)
    language = voice.partition("+")[0]
    sounds: list[Heard] = []
    for event in speech.phones:
        start = _start(speech.samples, speech.rate, event.start)
        for sound in read_espeak(event.label, language):
            sounds.append(Heard(sound.ipa, sound.phone, start, event.position))
            start = np.nan
    return Said(Audio(speech.samples, speech.rate), tuple(sounds))


def _start(samples: npt.NDArray[np.float32], rate: int, time: float) -> float:
    """Where the silence before `time` begins, if it is as short as a closure."""
    stop = round(time * rate)
    slack = round(0.003 * rate)  # the burst may begin a little before its event
    loud = np.flatnonzero(np.abs(samples[: max(stop - slack, 0)]) > SILENT)
    silence = (stop - loud[-1]) / rate if len(loud) else np.inf
    if silence < 0.006:
        return time
    return time - silence if silence <= PAUSE else np.nan


def words_of_voice(said: Said, language: str) -> list[SpokenRow]:
    """The words of the sentence as the voice itself has said them."""
    words: dict[int, list[Heard]] = defaultdict(list)
    for sound in said.sounds:
        words[sound.word].append(sound)
    rows = []
    for position, sounds in words.items():
        phones = tuple(sound.phone for sound in sounds)
        ipa = tuple(sound.ipa for sound in sounds)
        word = SpokenWord(str(position), str(position), 1, position + 1)
        rows.append(SpokenRow(word, (phones,), (all_units(phones, ipa, language),)))
    return rows


def align_said(said: Said, text: str, language: str, own: bool) -> Alignment:
    """The alignment of the text, or of the voice's own phones."""
    if own or language not in LANGUAGES:
        rows = words_of_voice(said, language)
        return align_rows(said.audio, rows, english=is_english(language))
    return align(said.audio, get_language(language).normalize(text), language)


@dataclass
class Figures:
    """What was found in one language."""

    errors: list[float]
    by_sound: dict[str, list[float]]
    phones: int = 0
    unmatched: int = 0
    words: int = 0
    misfits: int = 0
    refused: int = 0

    def row(self) -> dict[str, float]:
        """The row of the table."""
        errors = np.array(self.errors)
        lag = float(np.median(errors))
        return {
            **summarize(errors),
            "median_without_lag_ms": 1000 * float(np.median(np.abs(errors - lag))),
            "phones": self.phones,
            "unmatched": self.unmatched,
            "words": self.words,
            "misfits": self.misfits,
            "refused": self.refused,
        }


def sentences(language: str) -> Iterator[tuple[str, Said]]:
    """Each text of a language by each voice."""
    for text in TEXTS[language]:
        for variant, words_per_minute in VARIANTS:
            voice = VOICES.get(language, language) + variant
            yield text, say(text, voice, words_per_minute)


def bench_language(language: str, own: bool, others: bool = False) -> Figures:
    """Every sentence by every voice, or by those that warping is measured with."""
    figures = Figures([], defaultdict(list))
    for number, (text, said) in enumerate(sentences(language)):
        if others and number % len(VARIANTS) == 0:
            continue
        try:
            alignment = align_said(said, text, language, own)
        except LipwrightError as error:
            figures.refused += 1
            print(f"{language}: {error}")
            continue
        figures.words += len(alignment.track.words) + len(alignment.misfits)
        figures.misfits += len(alignment.misfits)
        for misfit in alignment.misfits:
            print(f"{language}: {misfit.text!r} does not fit, score {misfit.score:.1f}: {text}")
        add_errors(figures, said.sounds, alignment)
    return figures


def bench_warping(language: str) -> Figures:
    """Each sentence of the other voices, with the times of the first voice warped to it."""
    figures = Figures([], defaultdict(list))
    for text in TEXTS[language]:
        name = VOICES.get(language, language)
        reference = say(text, name + VARIANTS[0][0], VARIANTS[0][1])
        rows = _features(reference.audio)
        for variant, words_per_minute in VARIANTS[1:]:
            said = say(text, name + variant, words_per_minute)
            starts = [sound.start for sound in reference.sounds]
            moved = move_times(starts, warp(rows, _features(said.audio)), FRAME_RATE)
            match = match_phones(
                [Labelled(sound.phone, sound.start) for sound in said.sounds],
                [Labelled(s.phone, t) for s, t in zip(reference.sounds, moved, strict=True)],
            )
            figures.phones += len(said.sounds)
            figures.unmatched += len(match.reference_unmatched)
            figures.errors += match.errors[~np.isnan(match.errors)].tolist()
    return figures


def bench_people(folder: Path, voice: str = "en-gb") -> Figures:
    """The hand-labelled English sentences, with the times of a voice warped to them."""
    figures = Figures([], defaultdict(list))
    for path in sorted(folder.glob("*.flac")):
        said = say(path.with_suffix(".txt").read_text(encoding="utf-8"), voice)
        with open_audio(path, rate=16000) as file:
            rows = _features(file.read(0, file.duration))
        starts = [sound.start for sound in said.sounds]
        moved = move_times(starts, warp(_features(said.audio), rows), FRAME_RATE)
        match = match_phones(
            read_reference(path.with_suffix(".tsv")),
            [Labelled(s.phone, t) for s, t in zip(said.sounds, moved, strict=True)],
        )
        figures.phones += len(match.errors) + len(match.reference_unmatched)
        figures.unmatched += len(match.reference_unmatched)
        figures.errors += match.errors[~np.isnan(match.errors)].tolist()
    return figures


def bench_hibari() -> tuple[Figures, Figures]:
    """The English sentences by hibari, whose times are its own: aligned, and warped to."""
    from lipwright.speech.voices.hibari import HibariBackEnd
    from lipwright.speech.voices.values import Piece

    voice = HibariBackEnd().open("", None)
    aligned, warped = Figures([], defaultdict(list)), Figures([], defaultdict(list))
    for text in TEXTS["en"]:
        said = voice.speak((Piece(text),))
        assert said.track is not None
        truth = [Heard(p, p, start, 0) for p, start, _ in said.track if p != "sil"]
        add_errors(aligned, truth, align(said.audio, get_language("en").normalize(text)))
        other = say(text, VOICES["en"])
        beside = warp(_features(other.audio), _features(said.audio))
        moved = move_times([sound.start for sound in other.sounds], beside, FRAME_RATE)
        match = match_phones(
            [Labelled(sound.phone, sound.start) for sound in truth],
            [Labelled(s.phone, t) for s, t in zip(other.sounds, moved, strict=True)],
        )
        warped.phones += len(truth)
        warped.unmatched += len(match.reference_unmatched)
        warped.errors += match.errors[~np.isnan(match.errors)].tolist()
    return aligned, warped


def _features(audio: Audio) -> npt.NDArray[np.float32]:
    """Cepstra (T, 13), each as wide as the others."""
    static = static_features(spectra(audio))
    return static / static.std(axis=0)


def add_errors(figures: Figures, sounds: Sequence[Heard], alignment: Alignment) -> None:
    """Match the phones of voice and track, and keep the errors of those whose times are known."""
    reference = [Labelled(sound.phone, sound.start) for sound in sounds]
    estimated = [Labelled(p, start) for p, start, _ in alignment.track if p != "sil"]
    match = match_phones(reference, estimated)
    figures.phones += len(reference)
    figures.unmatched += len(match.reference_unmatched)
    figures.errors += match.errors[~np.isnan(match.errors)].tolist()
    for index, error in zip(match.reference_indices, match.errors, strict=True):
        if not np.isnan(error):
            figures.by_sound[sounds[index].ipa].append(error)


def print_sounds(by_sound: dict[str, list[float]], language: str) -> None:
    """The sounds from the least to the most exact."""
    for ipa, errors in sorted(by_sound.items(), key=lambda row: -np.median(np.abs(row[1]))):
        size = 1000 * np.abs(errors)
        units = " ".join(all_units((read_ipa(ipa)[0].phone,), (ipa,), language)[0])
        print(
            f"   {ipa:4} {units:6} n {len(errors):3}  median {np.median(size):6.1f}  "
            f"lag {1000 * np.median(errors):6.1f}  90th {np.quantile(size, 0.9):6.1f}"
        )


COLUMNS = (
    ("median_ms", "median, ms"), ("median_without_lag_ms", "without the lag"),
    ("bias_ms", "lag, ms"), ("p90_ms", "90th percentile, ms"), ("within_20ms", "within 20 ms"),
    ("within_50ms", "within 50 ms"), ("matched", "edges"), ("unmatched", "phones unmatched"),
    ("misfits", "words that do not fit"), ("refused", "sentences refused"),
)  # fmt: skip


def markdown(rows: dict[str, dict[str, float]]) -> str:
    """The table of the page."""
    head = ["language", *(title for _, title in COLUMNS)]
    lines = [f"| {' | '.join(head)} |", f"|{' --- |' * len(head)}"]
    for language, row in rows.items():
        cells = [_cell(name, row) for name, _ in COLUMNS]
        lines.append(f"| {language} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _cell(name: str, row: dict[str, float]) -> str:
    if name.endswith("_ms"):
        return f"{row[name]:.1f}"
    if name.startswith("within"):
        return f"{100 * row[name]:.0f} %"
    if name == "misfits":
        return f"{row[name]:.0f} of {row['words']:.0f}"
    if name == "unmatched":
        return f"{row[name]:.0f} of {row['phones']:.0f}"
    return f"{row[name]:.0f}"


def main() -> None:
    """Run what the options ask for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--languages", default=",".join(TEXTS), help="ISO codes with commas")
    parser.add_argument("--own", action="store_true", help="phones of the voice, not of the text")
    parser.add_argument("--warping", action="store_true", help="compare time warping, own phones")
    parser.add_argument("--sounds", action="store_true", help="a line for each sound too")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the figures here as well")
    parser.add_argument("--markdown", type=Path, metavar="FILE", help="write the table here")
    options = parser.parse_args()
    rows = {}
    if options.warping:
        for name, figures in zip(("", ", warping"), bench_hibari(), strict=True):
            rows[f"hibari{name}"] = figures.row()
        rows["people, warping"] = bench_people(CORPORA / "aligned-phones").row()
    for language in options.languages.split(","):
        if options.warping:
            rows[f"{language}, warping"] = bench_warping(language).row()
        figures = bench_language(language, options.own or options.warping, options.warping)
        rows[language] = figures.row()
        if options.sounds:
            print_sounds(figures.by_sound, language)
    print(markdown(rows))
    if options.json:
        options.json.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    if options.markdown:
        options.markdown.write_text(markdown(rows), encoding="utf-8")


if __name__ == "__main__":
    main()
