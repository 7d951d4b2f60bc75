"""Voices say a sentence in three languages, and the face follows the voices' own times.

    python examples/09_say.py [FOLDER]

English is in the package; Swedish and Mandarin need the extra `espeak`.
"""

from __future__ import annotations

import sys
from pathlib import Path

import lipwright
from lipwright.audio import write_wav
from lipwright.espeak import is_available

SENTENCES = {
    "en": "Hello! Please bring my blue map.",
    "sv": "Just därför kan det ju dra ut på tiden i flera år.",
    "cmn": "你好，我的女朋友买了五本绿色的书。",
}


def main() -> None:
    """Write curves and sound of each sentence, and print its phones."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    for code, sentence in SENTENCES.items():
        if code != "en" and not is_available():
            print(f"{code}: needs espeak-ng; run: pip install 'lipwright[espeak]'")
            continue
        result = lipwright.say(sentence, voice=lipwright.SayOptions(language=code))
        lipwright.export_all([folder / f"say-{code}.csv"], result.performance)
        assert result.utterance is not None
        write_wav(folder / f"say-{code}.wav", result.utterance.audio)
        print(f"{code}: {' '.join(phone for phone in result.track.phones if phone != 'sil')}")


if __name__ == "__main__":
    main()
