"""Montreal Forced Aligner: words and phones as CSV.

Columns Begin, End, Label, Type and Speaker, as MFA's `export_textgrid` writes them with
`--output_format csv`; Type is `words` or `phones`.
"""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.formats.source import read_text
from lipwright.streams.mfa import several_speakers, tiers_to_track
from lipwright.streams.source import seconds_of
from lipwright.streams.times import Timed
from lipwright.track import PhoneTrack

COLUMNS: Final = ("Begin", "End", "Label", "Type")


def read(path: Path, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of a file.

    Raises:
        LipwrightError: a column is missing, there are several speakers, or labels are no phones.
    """
    rows = csv.DictReader(io.StringIO(read_text(path), newline=""))
    tiers: dict[str, list[Timed]] = {"words": [], "phones": []}
    speakers: set[str] = set()
    try:
        missing = [column for column in COLUMNS if column not in (rows.fieldnames or ())]
        if missing:
            raise LipwrightError(
                f"{path}: line 1: has no column {missing[0]!r}; the columns of MFA are "
                f"{', '.join(COLUMNS)} and Speaker"
            )
        for row in rows:
            place = f"line {rows.line_num}"
            if any(row.get(column) is None for column in COLUMNS):
                raise LipwrightError(f"{path}: {place}: has too few columns; export it again")
            tier = tiers.get(row["Type"].strip())
            if tier is None:
                continue
            speakers.add(row.get("Speaker") or "")
            start = seconds_of(path, row["Begin"], place, "Begin")
            end = seconds_of(path, row["End"], place, "End")
            tier.append(Timed(row["Label"].strip(), start, end, place))
    except csv.Error as error:
        raise LipwrightError(f"{path}: line {rows.line_num}: not CSV: {error}") from None
    if len(speakers) > 1:
        raise several_speakers(path)
    return tiers_to_track(path, tiers["phones"], tiers["words"], language, duration)
