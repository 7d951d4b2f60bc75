"""What sounds do to their neighbours: r and a dental make a retroflex, r opens ä and ö.

See Riad, "The Phonology of Swedish" (2014), on retroflexion: r before t d n s l is lost
and the dental curled back; the curl goes on over all dentals that follow, within a word, in
compounds and over word edges. A long r, as in "torrt", does neither. ä and ö before r, or
before what r has become, are open.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from types import MappingProxyType
from typing import Final

from lipwright.language.swedish.sounds import LONG_R, is_vowel, plain

RETROFLEX: Final = MappingProxyType({"t": "ʈ", "d": "ɖ", "n": "ɳ", "s": "ʂ", "l": "ɭ"})
"""dental to the retroflex that r makes of it"""

_CURLED: Final = frozenset(RETROFLEX.values())
# l neither spreads it nor, but for r itself, takes it: "Karlstad", "barnslig".
_SPREADING: Final = _CURLED - {"ɭ"}
_OPENED: Final = MappingProxyType({"øː": "œː", "ɛː": "æː", "ˈɛ": "æ", "ˌɛ": "æ"})


def assimilate(sounds: Iterable[str], before: str = "") -> tuple[str, ...]:
    """The sounds with r merged into dentals behind it; `before` is the sound in front of them."""
    done: list[str] = [before]
    for sound in sounds:
        last = done[-1]
        if sound in RETROFLEX and (last == "r" or (last in _SPREADING and sound != "l")):
            if last == "r" and len(done) > 1:
                done.pop()
            done.append(RETROFLEX[sound])
        else:
            done.append(sound)
    return tuple(done[1:])


def open_before_r(sounds: Sequence[str]) -> tuple[str, ...]:
    """The sounds with ä and ö open before r and retroflexes; ä only where stressed or long."""
    done = list(sounds)
    for index, sound in enumerate(sounds[:-1]):
        if sounds[index + 1] in _CURLED or sounds[index + 1] in ("r", LONG_R):
            mark = sound[: len(sound) - len(plain(sound))]
            done[index] = mark + _OPENED.get(plain(sound), _OPENED.get(sound, plain(sound)))
    return tuple(done)


def join(parts: Iterable[Sequence[str]]) -> tuple[str, ...]:
    """The sounds of the parts of a compound; a consonant said twice is said once."""
    done: list[str] = []
    for part in parts:
        start = 1 if done and part and done[-1] == part[0] and not is_vowel(part[0]) else 0
        done += part[start:]
    return tuple(done)
