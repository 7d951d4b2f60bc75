"""`lipwright phones`: the phone table, a language's sounds, and how a text is said."""

from __future__ import annotations

import json
from pathlib import Path

import click

from lipwright.cli.aligning import dictionary_option
from lipwright.cli.inputs import read_text
from lipwright.cli.listing import columns, json_option
from lipwright.cli.progress import warn
from lipwright.errors import LipwrightError
from lipwright.phones import PHONES, Phone, nearest_phones

PHONES_EXAMPLES = """\b
Examples:
  lipwright phones
    phone  IPA  X-SAMPA  example            common  made
    sil                  (silence)                  silence
    AA     ɑ    A        fAther             aa      vowel, low, back
\b
  lipwright phones --language sv
  lipwright phones --language sv "Barnen har kört hem."
  lipwright phones --language auto "你好"
"""


@click.command(epilog=PHONES_EXAMPLES)
@click.argument("text", required=False)
@click.option(
    "--language", "-l", help="List the sounds of a language, or say a text in it; or auto."
)
@dictionary_option
@json_option
def phones(text: str | None, language: str | None, dictionary: Path | None, as_json: bool) -> None:
    """List the phone table, the sounds of a language, or the words and phones of a text.

    TEXT is the words, a file of them, or - for a pipe.
    """
    if text is not None:
        _print_text(text, language or "en", dictionary, as_json)
    elif language is not None:
        _print_sounds(language, as_json)
    else:
        _print_table(as_json)


def _made(phone: Phone) -> str:
    if phone.is_silence:
        return "silence"
    if phone.is_vowel:
        kind = "diphthong" if phone.is_diphthong else "vowel"
        parts = [kind, phone.height, phone.backness]
    else:
        parts = ["voiced" if phone.voiced else "voiceless", phone.place, phone.manner]
    return ", ".join(parts + ["rounded"] * phone.rounded)


def _print_table(as_json: bool) -> None:
    if as_json:
        table = {
            p.symbol: {
                "ipa": p.ipa, "xsampa": p.xsampa, "example": p.example, "common": p.common,
                "manner": p.manner, "place": p.place, "voiced": p.voiced, "height": p.height,
                "backness": p.backness, "rounded": p.rounded, "parts": p.parts,
                "nearest": nearest_phones(p.symbol)[:5],
            }
            for p in PHONES.values()
        }  # fmt: skip
        click.echo(json.dumps(table, ensure_ascii=False, indent=1))
        return
    rows = [("phone", "IPA", "X-SAMPA", "example", "common", "made")]
    rows += [(p.symbol, p.ipa, p.xsampa, p.example, p.common, _made(p)) for p in PHONES.values()]
    columns(rows)


def _print_sounds(code: str, as_json: bool) -> None:
    """The sounds of a language and the phones that stand for them."""
    from lipwright.language import get_language
    from lipwright.language.codes import resolve_code

    language = get_language(resolve_code(code))
    sounds = language.inventory()
    if not sounds:
        raise LipwrightError(
            f"{language.name} is read by espeak-ng, which has no list of its sounds; give a text: "
            f"lipwright phones --language {language.code} TEXT"
        )
    if as_json:
        listed = [
            {"ipa": sound.ipa, "phones": sound.phones, "example": sound.example} for sound in sounds
        ]
        click.echo(json.dumps(listed, ensure_ascii=False, indent=1))
        return
    rows = [("IPA", "phones", "class", "example")]
    rows += [
        (s.ipa, " ".join(s.phones), " ".join(PHONES[p].common for p in s.phones), s.example)
        for s in sounds
    ]
    columns(rows)


def _print_text(text: str, code: str, dictionary: Path | None, as_json: bool) -> None:
    """Words, phones and classes, a word a line."""
    from lipwright.language import get_language, read_dictionary
    from lipwright.language.detect import check_language
    from lipwright.pipeline import language_of

    written, source = read_text(text, "the text")
    code = language_of(code, written, source)
    note = check_language(written, code, source)
    language = get_language(code)
    own = None if dictionary is None else read_dictionary(dictionary)
    words = language.normalize(written, source, own)
    said = language.pronounce_all(words, own)
    if as_json:
        listed = [
            {"word": word.text, "written": word.written, "phones": ways[0].phones,
             "ipa": ways[0].ipa, "source": ways[0].source,
             "classes": [PHONES[phone].common for phone in ways[0].phones]}
            for word, ways in zip(words, said, strict=True)
        ]  # fmt: skip
        click.echo(json.dumps({"language": code, "words": listed}, ensure_ascii=False, indent=1))
    else:
        rows = [("word", "phones", "IPA", "classes", "from")]
        for word, ways in zip(words, said, strict=True):
            way = ways[0]
            ipa = way.ipa or tuple(PHONES[phone].ipa for phone in way.phones)
            classes = " ".join(PHONES[phone].common for phone in way.phones)
            rows.append((word.text, " ".join(way.phones), " ".join(ipa), classes, way.source))
        columns(rows)
    if note:
        warn(note, "auto")
