"""The pass that scales single controls, parts of the face, and the motion of kinds of phones."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Final

import numpy as np

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, GROUPS
from lipwright.errors import LipwrightError
from lipwright.passes.kinds import Floats, Pass, ease, sides_of
from lipwright.passes.shaping import CEILING_KNEE, MAX_INTENSITY, soft_ceiling
from lipwright.phones import COMMON, MANNERS, PHONES, PLACES, Phone
from lipwright.track import PhoneTrack

EDGE: Final = 0.04  # s before and after an edge between phones in which amounts change


def _kinds(phone: Phone) -> tuple[str, ...]:
    """The classes of a phone."""
    if phone.is_silence:
        return ()
    sort = "vowels" if phone.is_vowel else "consonants"
    rounded = ("rounded",) if phone.rounded else ()
    return (sort, *rounded, *filter(None, (phone.place, phone.manner, phone.common)))


CLASSES: Final = ("vowels", "consonants", "rounded", *PLACES, *MANNERS, *COMMON)
"""the kinds of phones that have an intensity: places and manners, and the 21 common classes"""

PHONE_CLASSES: Final = MappingProxyType({name: _kinds(phone) for name, phone in PHONES.items()})
"""symbol to its classes"""


def controls_of(name: str) -> tuple[str, ...]:
    """The controls of a canonical control's name, with or without side, or of a part of the face.

    None where the name is neither.
    """
    return GROUPS[name] if name in GROUPS else sides_of(name)


def intensities(amounts: Mapping[str, float]) -> Pass:
    """Scale the motion of some controls, and of jaw and lips while some phones sound.

    Where several names say something of one control at one time, their amounts multiply, up to 3.
    Those of phones change smoothly, within 40 ms of the edges. The ceiling is that of `intensity`.

    Args:
        amounts: name to amount, 0 to 3. A name is a canonical control with or without its side,
            a group of `controls.GROUPS`, or one of `CLASSES`.

    Raises:
        LipwrightError: a name is unknown, or an amount is not from 0 to 3.
    """
    for name, amount in amounts.items():
        check_amount(name, amount)
    of_phones = {name: amount for name, amount in amounts.items() if name in CLASSES}
    of_controls = dict.fromkeys(CANONICAL, 1.0)
    for name in amounts.keys() - of_phones.keys():
        for control in controls_of(name):
            of_controls[control] *= amounts[name]
    spoken = set(GROUPS["jaw"] + GROUPS["lips"]) if of_phones else set()

    def scale(clip: Clip, track: PhoneTrack) -> Clip:
        names = [n for n in clip.names if n in spoken or of_controls.get(n, 1.0) != 1]
        if not names:
            return clip
        over_time = phone_amounts(track, clip.times, of_phones)
        columns = [clip.column(name) for name in names]
        amount = np.array([of_controls[name] for name in names])[None] * np.where(
            [name in spoken for name in names], over_time[:, None], 1.0
        )
        amount = np.minimum(amount, MAX_INTENSITY)
        values = clip.values.copy()
        moved = values[:, columns]
        knee = np.where(amount > 1, np.clip(moved, CEILING_KNEE, 1), 1.0)
        values[:, columns] = soft_ceiling((amount * moved).astype(np.float32), knee)
        return clip.with_values(values)

    return scale


def phone_amounts(track: PhoneTrack, times: Floats, amounts: Mapping[str, float]) -> Floats:
    """(T,), the amount at each time: each phone's is the product of those of its classes.

    It changes over `EDGE` s on either side of an edge, or over half of a phone that is shorter.
    """
    each = np.array(
        [np.prod([amounts.get(kind, 1.0) for kind in PHONE_CLASSES[p]]) for p in track.phones]
    )
    phone = np.searchsorted(track.edges, times, "right") - 1
    phone = phone.clip(0, len(track) - 1)
    # Of the two edges of the phone that sounds, only the nearer one is in reach.
    middle = (track.edges[:-1] + track.edges[1:])[phone] / 2
    edge = np.where(times < middle, phone, phone + 1)
    inner = edge.clip(1, max(len(track) - 1, 1))
    at_edge = (edge > 0) & (edge < len(track))
    if len(track) == 1 or not at_edge.any():
        return each[phone]
    lengths = track.durations
    reach = np.minimum(EDGE, np.minimum(lengths[inner - 1], lengths[inner]) / 2)
    share = ease(0.5 + (times - track.edges[inner]) / (2 * reach))
    return np.where(at_edge, each[inner - 1] + share * (each[inner] - each[inner - 1]), each[phone])


def check_amount(name: str, amount: float) -> None:
    """Refuse a name that has no intensity, and an amount out of range.

    Raises:
        LipwrightError: lists what there is.
    """
    if name not in CLASSES and not controls_of(name):
        raise LipwrightError(
            f"nothing called {name[:40]!r} has an intensity; name a control such as mouthPucker, "
            f"a part of the face ({', '.join(GROUPS)}) or a class of phones ({', '.join(CLASSES)})"
        )
    if not 0 <= amount <= MAX_INTENSITY:
        raise LipwrightError(
            f"the intensity of {name} is {amount:g}; give a number from 0 to {MAX_INTENSITY:.0f}"
        )


def parse_intensities(texts: Iterable[str]) -> tuple[float, dict[str, float]]:
    """The amount for everything and those by name, of texts like `1.2`, `jaw=0.8`, `vowels=1.3`.

    Where one stands twice, the later counts.

    Raises:
        LipwrightError: a text is neither an amount nor NAME=AMOUNT, a name is unknown, or an
            amount is not from 0 to 3.
    """
    whole, named = 1.0, dict[str, float]()
    for text in texts:
        name, equals, number = text.rpartition("=")
        try:
            amount = float(number)
        except ValueError:
            raise LipwrightError(
                f"--intensity {text[:40]!r} is neither an amount, such as 1.2, nor NAME=AMOUNT, "
                "such as jaw=0.8"
            ) from None
        if not equals:
            if not 0 <= amount <= MAX_INTENSITY:
                raise LipwrightError(
                    f"intensity is {amount:g}; give a number from 0 to {MAX_INTENSITY:.0f}"
                )
            whole = amount
        else:
            check_amount(name, amount)
            named[name] = amount
    return whole, named
