"""Fit the dominance engine's targets and pulls to a real speaker, and write its table.

On the training sentences of GRID s1, two measures of the real mouth are explained as dominance
mixtures of one target a phone: the aperture (which the jaw and the lips open) and the width
(which the lips round and spread). Pulls are fitted by least squares, the targets inside by ridge
regression towards the mean of vowels or consonants. Measured targets are then split over the
controls by articulation: `RULES` says how much of an opening is the jaw's, and gives the phones
that GRID lacks and the tongue, which no camera sees. Writes
`src/lipwright/engines/dominance_targets.csv` and prints the pulls for `PULLS`.

    python bench/fit_dominance.py            # fit, write the table, print r on the test sentences
    python bench/fit_dominance.py --dry-run  # fit and print only
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

from grid import Sentence, sentences
from lipwright.engines.dominance import TARGET_COLUMNS
from lipwright.evaluate.lips import speech_span
from lipwright.files import write_whole
from lipwright.phones import ARPABET, PHONES

TABLE = Path(__file__).parents[1] / "src" / "lipwright" / "engines" / "dominance_targets.csv"

# Phones that look alike share one fitted target: GRID has too few of some to fit each alone.
TIES = {
    "M": "B", "P": "B", "EM": "B", "V": "F", "DH": "TH", "Z": "S", "JH": "CH", "T": "D",
    "G": "K", "AX": "AH", "IX": "IH", "EN": "N", "DX": "D", "NX": "N", "EL": "L", "WH": "W",
}  # fmt: skip
DIPHTHONGS = tuple(p.symbol for p in PHONES.values() if p.is_diphthong)

# Aperture that one unit of a control adds on the head, and width that it takes or gives: means of
# our head and of the ruler head, both over the distance between the eyes.
APERTURE = {"jawOpen": 0.54, "mouthLowerDown": 0.08, "mouthUpperUp": 0.095}
WIDTH = {
    "jawOpen": -0.087, "mouthPucker": -0.142, "mouthFunnel": -0.105,
    "mouthSmile": 0.217, "mouthStretch": 0.202,
}  # fmt: skip


@dataclass(frozen=True)
class Rule:
    """How a measured opening and width become controls, and what the camera does not see."""

    jaw: float = 0.7
    """share of the opening that is the jaw's; the rest parts the lips over the teeth"""
    funnel: float = 0.3
    """share of the rounding that is funnel; the rest is pucker"""
    tongue: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """raise, press, back; Ladefoged and Johnson, "A Course in Phonetics", chapters 1 and 7"""
    pull_tongue: float = 1.0
    forward: float = 0.0
    """jawForward"""
    measures: tuple[float, float, float, float] | None = None
    """opening (1 is wide open), pull of it, width (1 is a tenth of the eyes' distance), pull of
    it: for phones that GRID lacks or where it is too poor; none takes the fitted ones"""


VOWEL = Rule(0.85, pull_tongue=0.35)
FRONT = Rule(0.7, pull_tongue=0.35)
TIP = Rule(0.5, tongue=(1.0, 0.0, 0.0), pull_tongue=3.0)
RULES: dict[str, Rule] = {
    "sil": Rule(1.0, pull_tongue=0.5),
    "AA": VOWEL, "AH": VOWEL, "AX": Rule(0.8, pull_tongue=0.3, measures=(0.65, 0.45, -0.1, 0.4)),
    "AE": Rule(0.85, pull_tongue=0.35), "AO": Rule(0.85, 0.6, (0, 0, 0.2), 0.35),
    "EH": FRONT, "IH": FRONT, "IX": Rule(0.65, pull_tongue=0.35, measures=(0.75, 0.5, 0.1, 0.7)),
    "IY": Rule(0.6, tongue=(0.15, 0, 0), pull_tongue=0.35),
    "ER": Rule(0.75, 0.5, (0.35, 0, 0.3), 0.6, measures=(0.55, 1.0, -0.8, 0.9)),
    "AXR": Rule(0.75, 0.5, (0.35, 0, 0.3), 0.5, measures=(0.5, 0.6, -0.6, 0.7)),
    "UH": Rule(0.8, 0.4, (0, 0, 0.3), 0.35, measures=(0.5, 1.0, -0.8, 0.8)),
    "UW": Rule(0.8, 0.3, (0, 0, 0.4), 0.35),
    "UX": Rule(0.8, 0.3, (0.1, 0, 0.2), 0.35, measures=(0.4, 1.5, -1.1, 0.8)),
    "AW": VOWEL, "AY": Rule(0.8, pull_tongue=0.35), "EY": FRONT,
    "OW": Rule(0.8, 0.5, (0, 0, 0.2), 0.35),
    "OY": Rule(0.8, 0.5, (0, 0, 0.1), 0.35, measures=(0.8, 1.3, -1.3, 1.2)),
    "P": Rule(1.0), "B": Rule(1.0), "M": Rule(1.0), "EM": Rule(1.0),
    "F": Rule(0.8), "V": Rule(0.8),
    "TH": Rule(0.6, tongue=(0, 1.0, 0), pull_tongue=4.0),
    "DH": Rule(0.6, tongue=(0, 0.9, 0), pull_tongue=4.0),
    "T": TIP, "D": TIP, "N": TIP, "EN": TIP, "DX": Rule(0.5, tongue=(0.8, 0, 0), pull_tongue=2.0),
    "NX": Rule(0.5, tongue=(0.8, 0, 0), pull_tongue=2.0),
    "L": Rule(0.6, tongue=(0.95, 0, 0.1), pull_tongue=3.0),
    "EL": Rule(0.6, tongue=(0.9, 0, 0.2), pull_tongue=3.0),
    "S": Rule(0.4, tongue=(0.55, 0, 0), pull_tongue=2.5),
    "Z": Rule(0.4, tongue=(0.55, 0, 0), pull_tongue=2.5),
    "SH": Rule(0.35, 0.8, (0.4, 0, 0.1), 2.5, 0.25, (0.45, 1.0, -0.9, 1.6)),
    "ZH": Rule(0.35, 0.8, (0.4, 0, 0.1), 2.5, 0.25, (0.45, 1.0, -0.9, 1.6)),
    "CH": Rule(0.35, 0.8, (0.6, 0, 0), 2.5, 0.25, (0.45, 0.9, -0.8, 1.5)),
    "JH": Rule(0.35, 0.8, (0.6, 0, 0), 2.5, 0.25, (0.45, 0.9, -0.8, 1.5)),
    "K": Rule(0.7, tongue=(0, 0, 1.0), pull_tongue=3.0),
    "G": Rule(0.7, tongue=(0, 0, 1.0), pull_tongue=3.0),
    "NG": Rule(0.7, tongue=(0, 0, 1.0), pull_tongue=3.0, measures=(0.7, 0.35, 0.0, 0.5)),
    "ENG": Rule(0.7, tongue=(0, 0, 1.0), pull_tongue=3.0, measures=(0.6, 0.4, 0.0, 0.5)),
    "HH": Rule(0.8, pull_tongue=0.2, measures=(0.6, 0.2, 0.0, 0.2)),
    "HV": Rule(0.8, pull_tongue=0.2, measures=(0.6, 0.2, 0.0, 0.2)),
    "Q": Rule(0.8, pull_tongue=0.2, measures=(0.5, 0.15, 0.0, 0.2)),
    "R": Rule(0.7, 0.6, (0.45, 0, 0.25), 2.0),
    "Y": Rule(0.6, tongue=(0.2, 0, 0), pull_tongue=1.0),
    "W": Rule(0.9, 0.25, (0, 0, 0.5), 1.0), "WH": Rule(0.9, 0.25, (0, 0, 0.5), 1.0),
}  # fmt: skip

# Consonants made here leave the lips to the vowels.
SPREAD_PLACES = ("bilabial", "labiodental", "dental", "alveolar", "palatal", "velar", "glottal")

# Consonants whose lips nearly shut; a tongue alone does not close the mouth, whatever a fit to
# neighbours that do suggests.
NARROW_PLACES = ("bilabial", "labiodental", "dental", "labiovelar")
LEAST_OPENING = 0.25  # 1 is wide open

GLIDES = {"OY": (1.0, 0.9, 0.2, 1.2)}  # second half of a diphthong that GRID lacks, as `measures`


def labels(sentence: Sentence) -> list[tuple[str, float, float]]:
    """Tied labels with times; a diphthong is two halves, as in the engine."""
    rows = []
    for phone, start, end in sentence.track:
        if phone in DIPHTHONGS:
            middle = (start + end) / 2
            rows += [(phone + "1", start, middle), (phone + "2", middle, end)]
        else:
            rows.append((TIES.get(phone, phone), start, end))
    return rows


class Measured:
    """What the fit needs of one sentence."""

    def __init__(self, sentence: Sentence, index: dict[str, int]) -> None:
        """Measure a sentence; `index` numbers the labels."""
        rows = labels(sentence)
        self.index = np.array([index[label] for label, _, _ in rows])
        self.start = np.array([start for _, start, _ in rows])
        self.end = np.array([end for _, _, end in rows])
        aperture, width = sentence.aperture, sentence.mouth_width
        self.times = aperture.times
        first, last = speech_span(sentence.track)
        self.inside = (self.times >= first) & (self.times <= last)
        near = (self.times >= first - 0.2) & (self.times <= last + 0.2)
        known = ~np.isnan(aperture.values)
        self.inside &= known
        self.weight = np.sqrt(self.inside * 1.0 + 0.3 * near) * known
        shut = aperture.values < 0.012
        rest = np.median(width[shut]) if shut.sum() > 8 else 0.8665
        self.measures = {"opening": aperture.values / 0.2, "width": (width - rest) * 10}


class Fit:
    """Pulls and targets of one measure.

    Parameters: log strengths (L), log rises and falls of silence, vowels and consonants (6), log
    power, lead, plateau.
    """

    def __init__(self, names: list[str], data: list[Measured], measure: str) -> None:
        """Start from equal strengths for the labels `names`."""
        self.names, self.data, self.measure = names, data, measure
        self.count = len(names)
        self.silence = names.index("sil")
        self.kind = np.array(
            [0 if n == "sil" else 1 if PHONES[n.rstrip("12")].is_vowel else 2 for n in names]
        )
        self.prior = np.where(self.kind == 1, 0.6, 0.3) * (measure == "opening")
        self.first = np.concatenate(
            [np.zeros(self.count), np.full(6, np.log(25)), [np.log(1.3), 0.0, 0.4]]
        )
        self.first[self.silence] = -1.0
        self.stiffness = np.full(len(self.first), 1.5)
        self.stiffness[self.count :] = 0.5

    def share(self, item: Measured, parameters: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """(T, S) shares; the formula of `lipwright.engines.dominance.pulls`."""
        n, kinds = self.count, self.kind[item.index]
        rise, fall = np.exp(parameters[n : n + 3])[kinds], np.exp(parameters[n + 3 : n + 6])[kinds]
        power, lead, plateau = np.exp(parameters[n + 6]), parameters[n + 7], parameters[n + 8]
        middle, half = (item.start + item.end) / 2, plateau * (item.end - item.start) / 2
        now = item.times[:, None] + lead
        before = np.maximum(middle - half - now, 0) * rise
        after = np.maximum(now - middle - half, 0) * fall
        exponent = parameters[:n][item.index] - before**power - after**power
        share = np.exp(exponent - exponent.max(axis=1, keepdims=True))
        return share / share.sum(axis=1, keepdims=True)

    def solve(self, parameters: npt.NDArray[np.float64], ridge: float = 3.0) -> tuple[
        npt.NDArray[np.float64], npt.NDArray[np.float64]
    ]:  # fmt: skip
        """The best targets (L,) for these pulls, and the weighted residuals; silence is at rest."""
        rows, wanted = [], []
        for item in self.data:
            used = item.weight > 0
            matrix = np.zeros((self.count, used.sum()))
            np.add.at(matrix, item.index, self.share(item, parameters)[used].T)
            rows.append(matrix.T * item.weight[used, None])
            wanted.append(item.measures[self.measure][used] * item.weight[used])
        matrix, target = np.concatenate(rows), np.concatenate(wanted)
        matrix[:, self.silence] = 0
        targets = np.linalg.solve(
            matrix.T @ matrix + ridge * np.eye(self.count), matrix.T @ target + ridge * self.prior
        )
        targets[self.silence] = 0
        return targets, matrix @ targets - target

    def run(self, rounds: int) -> npt.NDArray[np.float64]:
        """The fitted parameters."""

        def residuals(parameters: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
            return np.concatenate(
                [self.solve(parameters)[1], self.stiffness * (parameters - self.first)]
            )

        low = np.full(len(self.first), -np.inf)
        high = np.full(len(self.first), np.inf)
        low[-2:], high[-2:] = (-0.03, 0.0), (0.03, 1.0)
        n = self.count
        low[n : n + 6], high[n : n + 6] = np.log(6), np.log(80)
        return np.asarray(
            least_squares(residuals, self.first, bounds=(low, high), max_nfev=rounds).x
        )

    def correlation(self, data: list[Measured], parameters: npt.NDArray[np.float64]) -> float:
        """Mean r inside speech."""
        targets, _ = self.solve(parameters)
        values = []
        for item in data:
            guess = self.share(item, parameters) @ targets[item.index]
            pair = np.corrcoef(guess[item.inside], item.measures[self.measure][item.inside])
            values.append(pair[0, 1])
        return float(np.mean(values))


def controls(rule: Rule, opening: float, width: float, rounds: bool) -> dict[str, float]:
    """Target controls of a measured opening (1 = 0.2 eye distances) and width (1 = 0.1).

    Only phones that round the lips get rounded ones.
    """
    values = dict.fromkeys(TARGET_COLUMNS, 0.0)
    aperture, wide = 0.2 * opening, 0.1 * width
    share = 1.0 if aperture < 0 else rule.jaw
    values["jawOpen"] = share * aperture / APERTURE["jawOpen"]
    for lip in ("mouthLowerDown", "mouthUpperUp"):
        values[lip] = (1 - share) / 2 * aperture / APERTURE[lip]
    wide -= WIDTH["jawOpen"] * max(values["jawOpen"], 0)  # an open jaw narrows the mouth by itself
    if not rounds:
        wide = max(wide, 0)  # what narrows it then is a rounded neighbour, which pulls for itself
    if wide < 0:
        values["mouthFunnel"] = rule.funnel * wide / WIDTH["mouthFunnel"]
        values["mouthPucker"] = (1 - rule.funnel) * wide / WIDTH["mouthPucker"]
    else:
        values["mouthSmile"] = 0.4 * wide / WIDTH["mouthSmile"]
        values["mouthStretch"] = 0.6 * wide / WIDTH["mouthStretch"]
    values["jawForward"] = rule.forward
    values["tongueRaise"], values["tonguePress"], values["tongueBack"] = rule.tongue
    values["tongueOut"] = 0.1 * rule.tongue[1]
    return values


def table(opening: Fit, width: Fit, open_fit: npt.NDArray[np.float64],
          wide_fit: npt.NDArray[np.float64]) -> list[dict[str, str]]:  # fmt: skip
    """The rows of the engine's table."""
    open_targets, wide_targets = opening.solve(open_fit)[0], width.solve(wide_fit)[0]
    rows = []
    for phone in (row for row in PHONES.values() if row.symbol in ARPABET):
        rule = RULES[phone.symbol]
        for part in (1, 2) if phone.is_diphthong else (0,):
            label = f"{phone.symbol}{part}" if part else TIES.get(phone.symbol, phone.symbol)
            given = GLIDES.get(phone.symbol, rule.measures) if part == 2 else rule.measures
            if given is None:
                at = opening.names.index(label)
                given = (
                    open_targets[at],
                    np.exp(open_fit[at]),
                    wide_targets[at],
                    np.exp(wide_fit[at]),
                )
                source = "fitted"
            else:
                source = "rule"
            rounds = phone.rounded if phone.is_vowel else phone.place not in SPREAD_PLACES
            narrow = phone.is_silence or phone.rounded or phone.place in NARROW_PLACES
            open_at = given[0] if narrow else max(given[0], LEAST_OPENING)
            values = controls(rule, open_at, given[2], rounds)
            rows.append(
                {"phone": phone.symbol, "part": str(part), "example": phone.example,
                 "source": source}
                | {name: f"{value:.3f}" for name, value in values.items()}
                | {"pull_jaw": f"{given[1]:.2f}", "pull_lips": f"{given[3]:.2f}",
                   "pull_tongue": f"{rule.pull_tongue:.2f}"}
            )  # fmt: skip
    return rows


HEADER = """\
# Targets of the dominance engine, written by bench/fit_dominance.py; two rows a diphthong.
# source: fitted = opening and width measured on GRID speaker 1 (Cooke et al. 2006, CC BY 4.0),
# training sentences only; rule = set from articulation. Tongue columns are always by rule.
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sentences", type=int, default=780, help="training sentences used")
    parser.add_argument("--rounds", type=int, default=8, help="iterations of the fit")
    parser.add_argument("--dry-run", action="store_true", help="print, do not write the table")
    options = parser.parse_args()
    train, test = sentences("train")[: options.sentences], sentences("test")
    names = sorted({label for s in train + test for label, _, _ in labels(s)})
    index = {name: at for at, name in enumerate(names)}
    data, held_out = [Measured(s, index) for s in train], [Measured(s, index) for s in test]
    opening, width = Fit(names, data, "opening"), Fit(names, data, "width")
    fits = []
    for fit in (opening, width):
        parameters = fit.run(options.rounds)
        n = fit.count
        print(f"{fit.measure}: r on train {fit.correlation(data, parameters):.3f}, "
              f"on test {fit.correlation(held_out, parameters):.3f}")  # fmt: skip
        rise, fall = np.exp(parameters[n : n + 3]), np.exp(parameters[n + 3 : n + 6])
        power, lead, plateau = np.exp(parameters[n + 6]), parameters[n + 7], parameters[n + 8]
        print(f"  rise {rise.round(2)} fall {fall.round(2)} power {power:.3f} "
              f"plateau {plateau:.3f} lead {lead:.4f}")  # fmt: skip
        fits.append(parameters)
    rows = table(opening, width, *fits)
    for row in rows:
        numbers = {k: v for k, v in row.items() if k not in ("phone", "part", "example", "source")}
        moved = (f"{k}={v}" for k, v in numbers.items() if float(v) != 0)
        print(row["phone"] + row["part"].replace("0", ""), row["source"], *moved)
    if not options.dry_run:
        text = HEADER + ",".join(rows[0]) + "\n"
        text += "".join(",".join(row.values()) + "\n" for row in rows)
        with write_whole(TABLE) as part:
            part.write_text(text, "utf-8")


if __name__ == "__main__":
    main()
