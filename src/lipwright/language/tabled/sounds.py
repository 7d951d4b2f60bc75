"""Sounds of a language, spelt in IPA and parted by spaces, to pronunciations."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache, lru_cache
from typing import Final

from lipwright.language.base import Pronunciation
from lipwright.language.ipa import Sound, read_ipa
from lipwright.language.tabled.values import Mends, Tables, Way
from lipwright.phones import PHONES

_MARKS: Final = "ˈˌ"
_STRESS: Final = {"ˈ": 1, "ˌ": 2}
_SYLLABIC: Final = "\N{COMBINING VERTICAL LINE BELOW}"
_KEPT: Final = 50_000  # ways; the words of a long text


def plain(sound: str) -> str:
    """The sound without its stress mark."""
    return sound.lstrip(_MARKS)


def mended(spelt: str, mends: Mends) -> tuple[str, ...]:
    """The sounds of a lexicon's spelling after its mends."""
    for old, new in mends:
        spelt = old.sub(new, spelt)
    return tuple(spelt.split())


def with_marks_on_vowels(sounds: Iterable[str], vowels: str) -> tuple[str, ...]:
    """The sounds with each stress mark moved to the vowel behind it."""
    done, mark = [], ""
    for sound in sounds:
        if sound[0] in _MARKS:
            mark = sound[0]
        bare = plain(sound)
        if not bare:
            continue
        if bare[0] in vowels:
            done.append(mark + bare)
            mark = ""
        else:
            done.append(bare)
    return tuple(done)


def finished(word: str, sounds: tuple[str, ...], tables: Tables) -> tuple[str, ...]:
    """The sounds with one stress at least, and what the language does to them then."""
    sounds = with_marks_on_vowels(sounds, tables.vowels)
    vowels = tuple(at for at, sound in enumerate(sounds) if plain(sound)[0] in tables.vowels)
    if vowels and not any(sound[0] == "ˈ" for sound in sounds):
        marked = [at for at in vowels if sounds[at][0] == "ˌ"]
        if tables.stress is not None:
            at = tables.stress(word, sounds, vowels)
        else:
            at = (marked or vowels)[0]
        sounds = (*sounds[:at], "ˈ" + plain(sounds[at]), *sounds[at + 1 :])
    main = [at for at, sound in enumerate(sounds) if sound[0] == "ˈ"]
    kept = main[:1] if tables.links else main[-1:]  # the first part of a compound bears it
    sounds = tuple(
        "ˌ" + plain(sound) if at in main and at not in kept else sound
        for at, sound in enumerate(sounds)
    )
    return tables.finish(word, sounds) if tables.finish else sounds


@lru_cache(maxsize=_KEPT)
def pronunciation(way: Way) -> Pronunciation:
    """A way to say a word, in phones."""
    phones: list[str] = []
    ipa: list[str] = []
    stress: list[int | None] = []
    for sound in way.sounds:
        made, vowel = _made(plain(sound))
        phones += (part.phone for part in made)
        ipa += (part.ipa for part in made)
        mark = _STRESS.get(sound[0], 0)
        stress += ((mark if at == vowel else None) for at in range(len(made)))
    return Pronunciation(tuple(phones), way.source, tuple(ipa), tuple(stress))


def phones_of(sound: str) -> tuple[str, ...]:
    """The phones that show a sound."""
    return tuple(part.phone for part in _made(sound)[0])


@cache
def _made(sound: str) -> tuple[tuple[Sound, ...], int]:
    """What a sound is in the phone table, and which of it is a vowel; -1 for none."""
    made = read_ipa(sound)
    vowels = [at for at, part in enumerate(made) if PHONES[part.phone].is_vowel]
    syllabic = [at for at, part in enumerate(made) if _SYLLABIC in part.ipa]
    return made, (vowels or syllabic or [-1])[0]
