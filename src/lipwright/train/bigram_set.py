"""A bigram set out of a captured dataset: what was heard is fitted, the rest is by rule."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

from lipwright.bigrams.families import flatten, load_bigrams, to_bigrams
from lipwright.bigrams.fields import SetFile
from lipwright.bigrams.fresh import fresh_set
from lipwright.bigrams.rules import rule_bigram
from lipwright.bigrams.values import BigramSet, constraint_key
from lipwright.dataset.folder import Dataset
from lipwright.dataset.splits import TRAIN
from lipwright.errors import LipwrightError
from lipwright.face.head import load_head
from lipwright.phones import SILENCE
from lipwright.rig import load_rig
from lipwright.train.bigram_fit import FITTED, SHOWN, Fit, FitOptions, fit
from lipwright.train.bigram_heard import Heard

Report = Callable[[str, float], None]

RIG: Final = "facefx"
"""whose poses the rules know, and whose looks a face is compared with"""


@dataclass(frozen=True)
class Naming:
    """What a set is called, and on which terms it is given away."""

    name: str
    language: str = "en"
    licence: str = ""
    parent: str = ""
    """name or file of the set whose classes, numbers and unheard pairs are kept; the fitted set
    becomes its child. Empty for the Common Phoneme Set and rules"""
    parent_here: str = ""
    """the same, as the file of the new set names it"""


@dataclass(frozen=True)
class FittedSet:
    """A set, and how it came about."""

    said: SetFile
    fit: Fit
    recordings: int
    """that had a face in them"""


def fit_set(
    dataset: Dataset, naming: Naming,
    options: FitOptions | None = None, report: Report | None = None,
) -> FittedSet:  # fmt: skip
    """The set that a dataset's recordings for training give.

    Raises:
        LipwrightError: no recording for training shows a face, no pair is heard often enough, or
            the parent has other poses than those that can be fitted.
    """
    options = options or FitOptions()
    base = load_bigrams(naming.parent) if naming.parent else ruled_set(naming)
    rig = load_rig(base.rig)
    for pose in (*FITTED, *SHOWN):
        if pose not in base.poses or pose not in rig.looks:
            lacks = f"pose {pose!r}" if pose not in base.poses else f"look of {pose!r} on a face"
            raise LipwrightError(
                f"{naming.parent}: has no {lacks}; captures are fitted to the poses "
                f"{', '.join((*FITTED, *SHOWN))} of the rig {RIG!r}"
            )
    names = dataset.names(TRAIN)
    takes = [take for name in names if (take := Heard.of(dataset.recording(name))) is not None]
    if not takes:
        raise LipwrightError(
            f"{dataset.path}: no recording for training shows a face; capture some, or run: "
            "lipwright dataset split"
        )
    learnt = fit(takes, base, rig, load_head(), options, report)
    if not learnt.bigrams:
        raise LipwrightError(
            f"{dataset.path}: no pair of phones is heard {options.least} times in "
            f"{len(takes)} recordings; capture more, or lower --least"
        )
    return FittedSet(_said(base, learnt, naming, dataset), learnt, len(takes))


def ruled_set(naming: Naming) -> BigramSet:
    """All pairs of the Common Phoneme Set, and of each with silence, by rule."""
    said = fresh_set(naming.name, naming.language, naming.licence, RIG, load_rig(RIG).names)
    names = list(said.classes)
    pairs = [(one, other) for one in names for other in names if {one, other} != {SILENCE}]
    made = replace(
        said,
        source="by rule from articulation",
        constraints={constraint_key(*pair): most for pair, most in said.constraints.items()},
        bigrams={pair: rule_bigram(*pair) for pair in pairs},
    )
    return to_bigrams(made, RIG)


def _said(base: BigramSet, learnt: Fit, naming: Naming, dataset: Dataset) -> SetFile:
    captured = str(dataset.manifest.get("name", "")) or dataset.path.name
    terms = str(dataset.manifest.get("licence", ""))
    source = f"fitted to the dataset {captured!r}" + (f", {terms}" if terms else "")
    if naming.parent:
        return SetFile(
            name=naming.name, language=naming.language, licence=naming.licence or None,
            source=source, parent=naming.parent_here or naming.parent, bigrams=learnt.bigrams,
        )  # fmt: skip
    return replace(
        flatten(base),
        source=f"{source}; pairs that were not heard, the tongue and closures by rule",
        bigrams={**base.bigrams, **learnt.bigrams},
    )
