"""Forced alignment by pocketsphinx (first version: one pass, short recordings)."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lipwright.errors import LipwrightError
from lipwright.phones import SILENCE
from lipwright.speech.aligner import Alignment, Progress
from lipwright.track import PhoneTrack, Word

if TYPE_CHECKING:
    from lipwright.audio import AudioFile
    from lipwright.language import Dictionary, SpokenWord

_PAD = 4800  # samples of silence at both ends, 0.3 s


def _pronunciations(words: Sequence[str], language: str, dictionary: Any) -> dict[str, list[str]]:
    try:
        from lipwright.language import get_language

        voice = get_language(language)
        found = {}
        for word in words:
            rows = voice.pronounce(word, dictionary)
            found[word] = [" ".join(getattr(row, "phones", row)) for row in rows]
        return found
    except ImportError:
        pass
    import pocketsphinx

    wanted, found = set(words), {}
    with open(pocketsphinx.get_model_path("en-us/cmudict-en-us.dict"), encoding="utf-8") as lines:
        for line in lines:
            word, _, phones = line.strip().partition(" ")
            word = word.partition("(")[0]
            if word in wanted:
                found.setdefault(word, []).append(phones)
    missing = wanted - found.keys()
    if missing:
        raise LipwrightError(f"no pronunciation of {', '.join(sorted(missing))}")
    return found


class SphinxAligner:
    """Forced alignment with pocketsphinx's English model."""

    name = "sphinx"

    def is_available(self) -> bool:
        """Whether pocketsphinx is installed."""
        from importlib.util import find_spec

        return find_spec("pocketsphinx") is not None

    def languages(self) -> tuple[str, ...]:
        """English."""
        return ("en",)

    def align(
        self,
        audio: AudioFile,
        words: Sequence[SpokenWord],
        language: str,
        dictionary: Dictionary | None = None,
        progress: Progress | None = None,
    ) -> Alignment:
        """Phones and words with times."""
        from pocketsphinx import Decoder, get_model_path

        samples = audio.read(0.0, audio.duration).samples
        pcm = (np.clip(samples, -1, 1) * 32767).astype("<i2")
        data = np.pad(pcm, _PAD).tobytes()
        keys = [f"w{index}" for index in range(len(words))]
        table = _pronunciations([word.text for word in words], language, dictionary)
        with tempfile.TemporaryDirectory(prefix="lipwright-") as folder:
            lexicon = Path(folder, "words.dict")
            with lexicon.open("w", encoding="utf-8") as lines:
                for key, word in zip(keys, words, strict=True):
                    for number, phones in enumerate(table[word.text], 1):
                        lines.write(f"{key if number == 1 else f'{key}({number})'} {phones}\n")
            decoder = Decoder(
                hmm=get_model_path("en-us/en-us"), lm=None, dict=str(lexicon), bestpath=False,
                beam=1e-80, pbeam=1e-80, wbeam=1e-60, loglevel="FATAL", logfn=os.devnull,
            )  # fmt: skip
        decoder.set_align_text(" ".join(keys))
        for _ in range(2):
            decoder.start_utt()
            decoder.process_raw(data, full_utt=True)
            decoder.end_utt()
            if _ == 0 and decoder.hyp() is None:
                raise LipwrightError("the text does not fit the sound")
            if _ == 0:
                decoder.set_alignment()
        phones: list[str] = []
        starts: list[float] = []
        rows: list[Word] = []
        alignment = decoder.get_alignment()
        for entry in alignment:
            is_word = entry.name.partition("(")[0] in keys
            first = len(phones)
            for part in entry:
                phones.append(part.name if is_word else SILENCE)
                starts.append(max((part.start / 100) - 0.3, 0.0))
            if is_word:
                rows.append(Word(words[len(rows)].text, first, len(phones), None))
        return Alignment(_track(phones, starts, rows, audio.duration))


def _track(phones: list[str], starts: list[float], rows: list[Word], end: float) -> PhoneTrack:
    edges = [*starts, end]
    for index in range(1, len(edges)):
        edges[index] = max(edges[index], edges[index - 1] + 1e-3)
    edges = [edge * end / edges[-1] if edges[-1] > end else edge for edge in edges]
    track = PhoneTrack(tuple(phones), np.asarray(edges), tuple(rows))
    return track.padded(0.0, end)
