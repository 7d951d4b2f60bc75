"""Numbers and abbreviations of a script, written out for voices."""

from __future__ import annotations

import pytest

from lipwright.errors import LipwrightError
from lipwright.speech.voices.values import Piece
from lipwright.speech.voices.written_out import written_out


@pytest.mark.parametrize(
    ("code", "text", "said"),
    [
        ("sv", "Vi ses kl. 14.30, det kostar 250 kr.",
         "Vi ses klockan fjorton trettio, det kostar tvåhundrafemtio kronor."),
        ("de", "Dr. Müller wohnt ca. 5 km von hier.",
         "doktor Müller wohnt circa fünf kilometer von hier."),
        ("fr", "M. Dupont arrive à 14h30.", "monsieur Dupont arrive à quatorze heures trente."),
        ("it", "Sono le 20:15, costa 3,50 €.",
         "Sono le venti e quindici, costa tre euro e cinquanta ."),
        ("cmn", "2024年，50%。", "二零二四年，百分之 五十。"),
        ("en-us", "Don’t pay $5, Mr. Naïve!", "Don’t pay five dollars, mister Naïve!"),
        ("en", "Hello there.", "Hello there."),
        ("tlh", "nuqneH 5", "nuqneH 5"),
        ("sv", "Hej 🙂 du!", "Hej  du!"),
    ],
)  # fmt: skip
def test_what_is_said_otherwise_than_written_is_written_out(
    code: str, text: str, said: str
) -> None:
    (piece,) = written_out((Piece(text),), code)
    assert " ".join(piece.text.split()) == " ".join(said.split())


def test_phones_and_pauses_stay_as_they_are() -> None:
    script = (Piece("5", phones=("F", "AY")), Piece(pause=0.5))
    assert written_out(script, "en") == script


def test_characters_without_a_reading_are_refused_with_their_place() -> None:
    with pytest.raises(LipwrightError, match="page: line 1, column 1: '今' is no kana"):
        written_out((Piece("今日は。"),), "ja", "page")
