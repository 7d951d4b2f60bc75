"""Montreal Forced Aligner: tiers `words` and `phones`, as TextGrid or JSON.

The JSON has `start`, `end` and `tiers`, each with `entries` of begin, end and label, as MFA's
`export_textgrid` writes them with `--output_format json`; of several speakers the tiers are named
`speaker - phones`. Labels are ARPABET with stress (english_us_arpa) or the IPA of "MFA phone set"
in the documentation of its models: aj, tʃ, ʉː, d̪, tɕʰ, z̩˥˩, and spn for a word that it does not
know.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from lipwright.errors import LipwrightError
from lipwright.formats import textgrid
from lipwright.formats.intervals import Interval, Joint, intervals_to_track, unknown_labels
from lipwright.language.codes import is_english
from lipwright.phones import is_silence_label
from lipwright.streams.labels import ipa_sounds, is_arpabet, read_labels
from lipwright.streams.source import brief, fields_of, list_of, read_content, seconds_of
from lipwright.streams.times import Timed, mend
from lipwright.track import PhoneTrack

JOINT: Final = Joint(tolerance=0.001, gaps="silence")


def read(path: Path, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of a file; see `to_track`."""
    return to_track(path, read_content(path), language, duration)


def fits(content: Any) -> bool:
    """Whether the keys are those of this layout."""
    return isinstance(content, dict) and isinstance(content.get("tiers"), dict)


def to_track(path: Path, content: Any, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of JSON.

    Raises:
        LipwrightError: it has no phones, several speakers, or labels that are no phones.
    """
    fields = fields_of(path, content, "the file")
    tiers = fields_of(path, fields.get("tiers"), "'tiers'")
    found: dict[str, list[Timed]] = {}
    for name, value in tiers.items():
        kind = name.rpartition(" - ")[2].strip().casefold()
        if kind not in ("words", "phones"):
            continue
        if kind in found:
            raise several_speakers(path)
        tier = fields_of(path, value, f"tier {name[:24]!a}")
        rows = list_of(path, tier.get("entries"), f"'entries' of {name[:24]!a}")
        found[kind] = [
            _entry(path, row, f"tier {name[:24]!a}, entry {n}") for n, row in enumerate(rows, 1)
        ]
    return tiers_to_track(path, found.get("phones", []), found.get("words", []), language, duration)


def several_speakers(path: Path) -> LipwrightError:
    """What is wrong with the tiers of several speakers."""
    return LipwrightError(
        f"{path}: has the phones of several speakers; keep those of one of them, or align with "
        "--single_speaker"
    )


def _entry(path: Path, row: Any, place: str) -> Timed:
    values = list_of(path, row, place)
    if len(values) != 3 or not isinstance(values[2], str):
        raise LipwrightError(
            f"{path}: {place}: is {brief(row)}, not begin, end and label; export it again from MFA"
        )
    start = seconds_of(path, values[0], place, "begin")
    return Timed(values[2].strip(), start, seconds_of(path, values[1], place, "end"), place)


def tiers_to_track(
    path: Path, phones: Sequence[Timed], words: Sequence[Timed], language: str,
    duration: float | None,
) -> PhoneTrack:  # fmt: skip
    """The track of phones and words that MFA has aligned; gaps are silence.

    Raises:
        LipwrightError: there are no phones, their times are wrong, or a label is no phone.
    """
    if not phones:
        raise LipwrightError(
            f"{path}: has no phones; export the alignment again, with the tier 'phones'"
        )
    mended = mend(path, phones, duration)
    read = read_labels(mended, language, silent=True)
    if read is None:
        raise _unknown(path, mended, language)
    kept = [
        Interval(word.start, word.end or word.start, word.label, word.place)
        for word in (mend(path, words, duration) if words else [])
        if word.end is not None and word.end > word.start
    ]
    return intervals_to_track(path, read, JOINT, words=kept, alphabet="arpabet", duration=duration)


def _unknown(path: Path, phones: Sequence[Timed], language: str) -> LipwrightError:
    """What is wrong with the first label that no alphabet knows."""
    for phone in phones:
        try:
            known = is_silence_label(phone.label) or bool(ipa_sounds(phone.label, language))
        except LipwrightError:
            known = False
        if not known and not is_arpabet(phone.label):
            return LipwrightError(
                f"{path}: {phone.where}: is no phone of ARPABET or IPA; correct it, or align "
                "again with a dictionary that has such phones"
            )
    return LipwrightError(f"{path}: mixes ARPABET and IPA; align it again with one dictionary")


def read_textgrid(path: Path, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of a TextGrid, of MFA or not.

    Labels that `formats` spells are read by it; IPA of other languages than English, whose
    letters mean other sounds there, and what `formats` does not know as MFA writes it.

    Raises:
        LipwrightError: the file cannot be used; see `formats.read_track`.
    """
    phones, words = textgrid.read_intervals(path)
    labels = {phone.label for phone in phones}
    own = is_english(language) and not (
        unknown_labels(labels, "arpabet") and unknown_labels(labels, "ipa")
    )
    if own or not all(_is_ipa(label, language) for label in labels):
        return textgrid.read(path, duration)
    kept = [Timed(word.label, word.start, word.end, word.place) for word in words]
    rows = [Timed(phone.label, phone.start, phone.end, phone.place) for phone in phones]
    return tiers_to_track(path, rows, kept, language, duration)


def _is_ipa(label: str, language: str) -> bool:
    if is_silence_label(label):
        return True
    try:
        return bool(ipa_sounds(label, language))
    except LipwrightError:
        return False
