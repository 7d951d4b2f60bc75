"""Fit the visemes of the engines overlay and static to a captured dataset, and write their tables.

Both engines are linear in their visemes: a weight of the face is a sum of visemes, each times a
share that follows from the phones' times alone. So the visemes of the least squared error, which
the 2018 thesis sought by trial and error, are found at once, on the recordings for training, each
drawn a little towards the mean of the frames in which it has a share. Closures are set by rule, as
a mean never shuts the lips; so are the tongue, which no camera sees, and phones that the dataset
lacks. Writes `overlay_visemes.csv` and `static_poses.csv` in `src/lipwright/engines`.

    python bench/fit_visemes.py DATASET            # fit, write both tables, print the errors
    python bench/fit_visemes.py DATASET --dry-run  # fit and print only
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType

import numpy as np
import numpy.typing as npt
from scipy.optimize import lsq_linear

from lipwright.controls import ARKIT, both_sides
from lipwright.dataset.folder import open_dataset
from lipwright.engines import overlay, static
from lipwright.engines.visemes import POSED
from lipwright.files import write_whole
from lipwright.passes import SHUT
from lipwright.phones import ARPABET, BILABIALS, COMMON, PHONES, SILENCE
from lipwright.track import PhoneTrack

Floats = npt.NDArray[np.float64]
Shares = Callable[[PhoneTrack, Floats, str], dict[str, Floats]]
"""track, (T,) times and control to label to its share (T,) of the control"""

TABLES = Path(__file__).parents[1] / "src" / "lipwright" / "engines"
SEEN = tuple(c for c in POSED if set(both_sides(c)) <= set(ARKIT) and c != "tongueOut")
RIDGE = 10.0  # frames that the mean of a label's own frames counts as
LIP = "upper lip"  # the label of the overlay engine's lift

# Phones that look alike share a viseme where the dataset may have few of one, or none.
TIES = {
    "V": "F", "DH": "TH", "Z": "S", "D": "T", "DX": "T", "EN": "N", "NX": "N", "EL": "L",
    "WH": "W", "CH": "JH", "SH": "JH", "ZH": "JH", "G": "K", "NG": "K", "ENG": "K", "HV": "HH",
    "Q": "HH", "AX": "AH", "IX": "IH", "UX": "UW", "EM": "M",
}  # fmt: skip
# Means of others, for what the dataset lacks: Ladefoged and Johnson, "A Course in Phonetics".
MIXED = {
    "ER": ("AH", "R"), "AXR": ("AH", "R"), "UH": ("UW", "AH"), "OY1": ("AO",), "OY2": ("IH",),
    "er": ("ah", "r"), "oy": ("ao", "ih"),
}  # fmt: skip

JAW = ("jawOpen", "mouthClose", "mouthLowerDown", "mouthUpperUp")
LIPS = ("mouthLowerDown", "mouthUpperUp")
ROUND = ("mouthFunnel", "mouthPucker", "mouthSmile", "mouthStretch")
OWNED: Mapping[str, tuple[str, ...]] = {
    "bilabial": tuple(SHUT),
    "labiodental": (*JAW, "mouthRollLower", "mouthFunnel"),
    "dental": JAW, "alveolar": LIPS, "alveolar fricative": JAW, "palatal": JAW,
    "postalveolar": (*JAW, *ROUND), "velar": (), "labiovelar": (*JAW, *ROUND),
    "glottal": (),
}  # fmt: skip
"""place, or place and manner, to the controls that a consonant there makes its own; all others it
leaves to the vowels, as the thesis's visemes override necessary bones only. The tongue is each
consonant's own, but of those that are made without it."""
TONGUE = ("tongueRaise", "tonguePress", "tongueBack", "tongueOut")
NO_TONGUE = ("bilabial", "labiodental", "glottal")

# hold and fade out in phone lengths; the thesis begins to fade out at once, over 1.5 of them, and
# set some by trial and error.
TIMING = (0.0, 1.5)
TIMINGS: dict[str, tuple[float, float]] = {}

LIPS_TO_TEETH = MappingProxyType({"mouthRollLower": 0.4})  # F and V; hidden behind the teeth
FORWARD = MappingProxyType({phone: {"jawForward": 0.25} for phone in ("SH", "ZH", "CH", "JH")})


def label_of(phone: str, part: int = 0) -> str:
    """What is fitted for a phone, or the half of a diphthong."""
    return f"{TIES.get(phone, phone)}{part or ''}"


def owned(phone: str) -> tuple[str, ...]:
    """The controls of a consonant's viseme."""
    row = PHONES[phone]
    tongue = () if row.place in NO_TONGUE else TONGUE
    forward = tuple(FORWARD.get(phone, ()))
    own = OWNED.get(f"{row.place} {row.manner}", OWNED[row.place])
    return tuple(dict.fromkeys((*own, *forward, *tongue)))


def rules(label: str) -> dict[str, float]:
    """What is not fitted of a label: silence is rest, closures are shut."""
    if label == SILENCE:
        return dict.fromkeys(POSED, 0.0)
    if label in BILABIALS or label == "bmp":
        return {name: value for name, (_, value) in SHUT.items()}
    return dict(LIPS_TO_TEETH) if label in ("F", "f") else {}


@dataclass(frozen=True, eq=False)
class Seen:
    """What a recording shows."""

    track: PhoneTrack
    times: Floats
    """(T,) s"""
    weights: Floats
    """(T, K) of POSED, both sides' mean; 0 for those that are not SEEN"""


def read_seen(dataset: Path, split: str) -> list[Seen]:
    """The recordings of a split, in frames that show a face."""
    opened = open_dataset(dataset)
    found = []
    for name in opened.names(split):
        recording = opened.recording(name)
        values = recording.motion.arkit[recording.valid]
        weights = np.zeros((len(values), len(POSED)))
        for control in SEEN:
            sides = [ARKIT.index(side) for side in both_sides(control)]
            weights[:, POSED.index(control)] = values[:, sides].mean(axis=1)
        found.append(Seen(recording.track, recording.times[recording.valid], weights))
    return found


def overlay_shares(track: PhoneTrack, times: Floats, control: str) -> dict[str, Floats]:
    """The shares of vowels, of the lifted lip and of the consonants that own the control."""
    shares: dict[str, Floats] = {}
    apexes = overlay.apexes(track)
    before, share = overlay.eased(apexes, times)
    for index, apex in enumerate(apexes):
        part = np.where(before == index, 1 - share, 0) + np.where(before == index - 1, share, 0)
        label = label_of(apex.viseme.name, apex.viseme.part)
        shares[label] = shares.get(label, 0) + part
    if control == "mouthUpperUp":
        shares[LIP] = overlay.upper_lip(track, times)
    for laid in overlay.laid_over(track):
        if control in owned(laid.viseme.name):
            strength = laid.strength(times)
            shares = {label: part * (1 - strength) for label, part in shares.items()}
            label = label_of(laid.viseme.name)
            shares[label] = shares.get(label, 0) + strength
    return shares


def static_shares(track: PhoneTrack, times: Floats, control: str) -> dict[str, Floats]:
    """The shares of classes."""
    del control
    reached, classes = static.keys(track)
    parts = static.between(reached, np.eye(len(reached)), times)  # (T, N)
    return {name: parts[:, [c == name for c in classes]].sum(axis=1) for name in set(classes)}


def fit(recordings: list[Seen], shares: Shares) -> dict[str, dict[str, float]]:
    """Label to control to the weight of the least squared error, 0 to 1."""
    found: dict[str, dict[str, float]] = {}
    for control in SEEN:
        rows = [shares(seen.track, seen.times, control) for seen in recordings]
        labels = sorted({label for row in rows for label in row})
        matrix = np.concatenate([
            np.stack([row.get(label, np.zeros(len(seen.times))) for label in labels], axis=1)
            for row, seen in zip(rows, recordings, strict=True)
        ])  # fmt: skip
        wanted = np.concatenate([seen.weights[:, POSED.index(control)] for seen in recordings])
        for label, value in zip(labels, _solve(matrix, wanted, labels, control), strict=True):
            found.setdefault(label, {})[control] = value
    return found


def _solve(matrix: Floats, wanted: Floats, labels: list[str], control: str) -> list[float]:
    """Least squares within 0 and 1, each label drawn to the mean of its frames."""
    fixed = {at: rules(label)[control] for at, label in enumerate(labels)
             if control in rules(label)}  # fmt: skip
    values = np.array([fixed.get(at, 0.0) for at in range(len(labels))])
    free = [at for at in range(len(labels)) if at not in fixed]
    weight = np.maximum(matrix.sum(axis=0), 1e-9)
    prior = np.where([label == LIP for label in labels], 0, matrix.T @ wanted / weight)
    square = matrix.T @ matrix + RIDGE * np.eye(len(labels))
    right = matrix.T @ wanted + RIDGE * prior - square @ values
    root = np.linalg.cholesky(square[np.ix_(free, free)])
    solved = lsq_linear(root.T, np.linalg.solve(root, right[free]), (0, 1)).x
    values[free] = solved
    return [float(value) for value in values]


def tongues() -> dict[str, dict[str, float]]:
    """Phone and part to its tongue: the rules of the dominance engine's table."""
    text = files("lipwright.engines").joinpath("dominance_targets.csv").read_text("utf-8")
    rows = csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))
    return {
        row["phone"] + row["part"].replace("0", ""): {name: float(row[name]) for name in TONGUE}
        for row in rows
    }


def pose_of(label: str, found: Mapping[str, Mapping[str, float]]) -> tuple[dict[str, float], str]:
    """The weights of a label, and where they come from."""
    if label in found:
        source = "rule" if label in BILABIALS or label in (SILENCE, "bmp") else "fitted"
        return dict(found[label]), source
    parts = [pose_of(other, found)[0] for other in MIXED[label]]
    return {name: float(np.mean([part.get(name, 0.0) for part in parts])) for name in SEEN}, "rule"


def overlay_rows(found: Mapping[str, Mapping[str, float]]) -> Iterator[list[str]]:
    """Cells of the engine's table; consonants in the order in which they are laid on."""
    tongue = tongues()
    last = ("labiodental", "bilabial")
    for phone in sorted(ARPABET, key=lambda p: (last.index(PHONES[p].place) + 1
                                                if PHONES[p].place in last else 0,
                                                list(PHONES).index(p))):  # fmt: skip
        row = PHONES[phone]
        for part in (1, 2) if row.is_diphthong else (0,):
            pose: dict[str, float] = {}
            source = "rule"
            if label_of(phone, part) in found or not row.is_consonant:
                pose, source = pose_of(label_of(phone, part), found)
            pose |= tongue[f"{phone}{part or ''}"] | FORWARD.get(phone, {})
            if TIES.get(phone, phone) == "F":
                pose |= LIPS_TO_TEETH
            if row.is_consonant and PHONES[phone].place == "bilabial":
                pose |= rules(phone)
            names = owned(phone) if row.is_consonant else POSED
            timing = TIMINGS.get(phone, TIMING)
            yield [phone, str(part), row.example, source, *(f"{value:g}" for value in timing),
                   *(f"{pose.get(name, 0.0):.3f}" if name in names else ""
                     for name in POSED)]  # fmt: skip


def static_rows(found: Mapping[str, Mapping[str, float]]) -> Iterator[list[str]]:
    """Cells of the engine's table."""
    tongue = tongues()
    for name in (SILENCE, *COMMON):
        pose, source = pose_of(name, found)
        members = [p for p in ARPABET if static.class_of(p) == name]
        kinds = [tongue[label] for p in members for label in (p, f"{p}1", f"{p}2")
                 if label in tongue]  # fmt: skip
        pose |= {part: float(np.mean([kind[part] for kind in kinds])) for part in TONGUE}
        pose |= rules(name)
        example = PHONES[min(members, key=list(PHONES).index)].example
        yield [name, "0", example, source, *(f"{pose.get(control, 0.0):.3f}" for control in POSED)]


HEADER = """\
# {what}, written by bench/fit_visemes.py.
# source: fitted = least squared error on GRID speaker 1 (Cooke et al. 2006, CC BY 4.0), recordings
# for training only; rule = set from articulation. Tongue columns are always by rule.{more}
"""
OWN = "\n# An empty cell leaves the control to the vowels around. hold, fade_out: phone lengths."


def write_table(path: Path, header: str, names: list[str], rows: Iterator[list[str]]) -> None:
    """A table of visemes."""
    with write_whole(path) as part, part.open("w", encoding="utf-8", newline="") as file:
        file.write(header)
        table = csv.writer(file, lineterminator="\n")
        table.writerow(names)
        table.writerows(rows)


def error(recordings: list[Seen], shares: Shares,
          found: Mapping[str, Mapping[str, float]]) -> dict[str, float]:  # fmt: skip
    """Control to mean squared error."""
    sums = dict.fromkeys(SEEN, 0.0)
    for seen in recordings:
        for control in SEEN:
            parts = shares(seen.track, seen.times, control)
            made = sum(part * pose_of(label, found)[0].get(control, 0.0)
                       for label, part in parts.items())  # fmt: skip
            sums[control] += float(np.square(made - seen.weights[:, POSED.index(control)]).sum())
    frames = sum(len(seen.times) for seen in recordings)
    return {control: total / frames for control, total in sums.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dataset", type=Path)
    parser.add_argument("--first", type=int, help="only the first N recordings for training")
    parser.add_argument("--dry-run", action="store_true", help="print, do not write the tables")
    options = parser.parse_args()
    train = read_seen(options.dataset, "train")[: options.first]
    validation = read_seen(options.dataset, "validation")
    names = ["name", "part", "example", "source"]
    for engine, shares, rows, timing, what, more in (
        ("overlay", overlay_shares, overlay_rows, overlay.TIMING,
         "Visemes of the overlay engine; two rows a diphthong", OWN),
        ("static", static_shares, static_rows, (), "Poses of the static engine", ""),
    ):  # fmt: skip
        found = fit(train, shares)
        errors = error(validation, shares, found)
        mean = np.mean(list(errors.values()))
        print(f"{engine}: mean squared error {mean:.5f} on {len(validation)} for validation")
        print(" ", *(f"{control} {value:.4f}" for control, value in errors.items()))
        if LIP in found:
            print(f"  UPPER_LIP = {found[LIP]['mouthUpperUp']:.3f}")
        if not options.dry_run:
            path = TABLES / (overlay.TABLE if engine == "overlay" else static.TABLE)
            header = HEADER.format(what=what, more=more)
            write_table(path, header, [*names, *timing, *POSED], rows(found))


if __name__ == "__main__":
    main()
