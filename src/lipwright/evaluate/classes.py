"""Classes of phones by which errors are told apart.

Taylor et al. 2016 find velars harder than fricatives, as the tongue makes them and the lips are
free to go with the neighbours, and short pauses hardest (reviewed in the Swedish thesis of 2018,
section 3.2.3); so pauses have a class of their own, beside the silence around speech. The others
are the places of the phone table, where needed parted by manner, and vowels by what the lips do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.evaluate.errors import OF_FRAMES, Truth, frame_errors
from lipwright.evaluate.measures import Floats, Rows
from lipwright.face.reference import ReferenceFace
from lipwright.phones import PHONES, SILENCE, Phone
from lipwright.track import PhoneTrack


@dataclass(frozen=True)
class PhoneClass:
    """One class, and what phones of it have; empty and None stand for anything."""

    name: str
    title: str
    """for people"""
    example: str
    """phones of it, as the table spells them; the first is in English"""
    manners: tuple[str, ...] = ()
    places: tuple[str, ...] = ()
    heights: tuple[str, ...] = ()
    rounded: bool | None = None
    diphthong: bool | None = None

    def holds(self, phone: Phone) -> bool:
        """Whether a phone is of this class; silence is of none."""
        wanted = (
            (self.manners, phone.manner), (self.places, phone.place), (self.heights, phone.height)
        )  # fmt: skip
        return (
            any(allowed for allowed, _ in wanted)
            and all(not allowed or value in allowed for allowed, value in wanted)
            and self.rounded in (None, phone.rounded)
            and self.diphthong in (None, phone.is_diphthong)
        )


AROUND: Final = PhoneClass("silence", "silence before and after", SILENCE)
PAUSE: Final = PhoneClass("pause", "pauses in speech", SILENCE)

_LOW: Final = ("low", "near-low")
_MID: Final = ("low-mid", "mid", "high-mid")
_HIGH: Final = ("near-high", "high")
_HISSING: Final = ("fricative", "affricate")
_TOUCHING: Final = ("stop", "nasal", "flap")

CLASSES: Final = MappingProxyType({
    row.name: row for row in (
        AROUND,
        PAUSE,
        PhoneClass("open", "vowels, open", "AA AE", heights=_LOW, rounded=False, diphthong=False),
        PhoneClass("mid", "vowels, mid", "EH AH AX ER", heights=_MID, rounded=False,
                   diphthong=False),
        PhoneClass("close", "vowels, close", "IY IH", heights=_HIGH, rounded=False,
                   diphthong=False),
        PhoneClass("rounded", "vowels, rounded", "UW UH AO", heights=(*_LOW, *_MID, *_HIGH),
                   rounded=True, diphthong=False),
        PhoneClass("diphthong", "diphthongs", "AY EY OW", heights=(*_LOW, *_MID, *_HIGH),
                   diphthong=True),
        PhoneClass("bilabial", "bilabials", "P B M", places=("bilabial",)),
        PhoneClass("labiodental", "labiodentals", "F V", places=("labiodental",)),
        PhoneClass("dental", "dentals", "TH DH", places=("dental",)),
        PhoneClass("alveolar", "alveolar stops and nasals", "T D N", manners=_TOUCHING,
                   places=("alveolar",)),
        PhoneClass("sibilant", "alveolar fricatives", "S Z", manners=_HISSING,
                   places=("alveolar",)),
        PhoneClass("lateral", "laterals", "L", manners=("lateral",), places=("alveolar",)),
        PhoneClass("postalveolar", "postalveolar fricatives", "SH CH JH", manners=_HISSING,
                   places=("postalveolar",)),
        PhoneClass("rhotic", "r", "R", manners=("approximant",), places=("postalveolar",)),
        PhoneClass("palatal", "palatals", "Y", places=("palatal",)),
        PhoneClass("velar", "velars", "K G NG", places=("velar",)),
        PhoneClass("labiovelar", "labiovelars", "W", places=("labiovelar",)),
        PhoneClass("glottal", "glottals", "HH", places=("glottal",)),
    )
})  # fmt: skip
"""name to class, in the order of tables"""

CLASS_OF: Final = MappingProxyType({
    symbol: next(name for name, row in CLASSES.items() if row.holds(phone))
    for symbol, phone in PHONES.items() if symbol != SILENCE
})  # fmt: skip
"""phone to the name of its class; of silence, `classes_of` knows which"""


def classes_of(track: PhoneTrack) -> tuple[str, ...]:
    """(P,) the class of each phone; silence between phones is a pause."""
    spoken = [index for index, phone in enumerate(track.phones) if phone != SILENCE]
    first, last = (spoken[0], spoken[-1]) if spoken else (len(track), -1)
    return tuple(
        CLASS_OF[phone] if phone != SILENCE
        else PAUSE.name if first < index < last else AROUND.name
        for index, phone in enumerate(track.phones)
    )  # fmt: skip


def class_at(track: PhoneTrack, times: npt.ArrayLike) -> npt.NDArray[np.str_]:
    """(F,) the class of the phone that is said at each of (F,) `times` in s.

    At an edge, of the phone that begins; before and after the track is silence.
    """
    times = np.asarray(times, float)
    inside = (times >= track.start) & (times < track.end)
    places = np.searchsorted(track.edges, times, side="right") - 1
    names = np.array([*classes_of(track), AROUND.name])
    return np.asarray(names[np.where(inside, places, len(track))], np.str_)


def class_rows(
    face: ReferenceFace, truths: Sequence[Truth], clips: Sequence[Clip], measure: str = "joint_sd"
) -> dict[str, Rows]:
    """Class to its rows over S recordings; the counts are frames.

    Every frame that the error counts belongs to the class of the phone that is said at its time.
    Classes of which there is no frame are not there; none is where the curves have no such error.

    Args:
        face: the model.
        truths: S recordings.
        clips: of each recording, as `errors.frame_errors` takes them.
        measure: an error that frames have.

    Raises:
        KeyError: frames have no such error.
        LipwrightError: as `errors.frame_errors`.
        ValueError: as `errors.frame_errors`.
    """
    if measure not in OF_FRAMES:
        raise KeyError(f"frames have no {measure!r}; they have {', '.join(OF_FRAMES)}")
    shape = (len(CLASSES), len(truths))
    sums, counts = np.zeros(shape), np.zeros(shape)
    places = {name: index for index, name in enumerate(CLASSES)}
    for column, (truth, clip) in enumerate(zip(truths, clips, strict=True)):
        values = frame_errors(face, truth, clip, (measure,)).get(measure)
        if values is None:
            return {}
        _add(sums[:, column], counts[:, column], values,
             [places[name] for name in class_at(truth.track, truth.counted(measure))])  # fmt: skip
    return {name: Rows(sums[index], counts[index])
            for index, name in enumerate(CLASSES) if counts[index].any()}  # fmt: skip


def _add(sums: Floats, counts: Floats, values: Floats, places: Sequence[int]) -> None:
    np.add.at(sums, places, values)
    np.add.at(counts, places, 1)
