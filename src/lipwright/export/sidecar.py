"""The sound beside a file that cannot hold sound: `NAME.wav` for `NAME.glb`."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.export.performance import Output, Performance

MAKER: Final = "Lipwright"


def sound_outputs(path: Path, performance: Performance) -> list[Output]:
    """The sidecar of `path`; none where there is no sound, or where it is the recording itself.

    Raises:
        LipwrightError: a WAV file of that name is there that we did not make.
    """
    target = path.with_suffix(".wav")
    if performance.audio is None:
        return []
    if target.exists():
        source = performance.audio_path
        if source is not None and source.exists() and target.samefile(source):
            return []
        if target.is_file() and not _is_ours(target):
            raise LipwrightError(
                f"{target}: is another recording, which the sound beside {path.name} would "
                f"replace; move it, or give {path.name} another name"
            )
    return [Output(target, lambda part: _write(part, performance))]


def _is_ours(path: Path) -> bool:
    import soundfile

    try:
        with soundfile.SoundFile(path) as file:
            return str(file.software).startswith(MAKER)
    except soundfile.LibsndfileError:
        return False


def _write(part: Path, performance: Performance) -> None:
    """16-bit PCM, with our name in it."""
    import soundfile

    with performance.open_sound() as sound:
        assert sound is not None  # without one there is no output
        with soundfile.SoundFile(part, "w", sound.rate, 1, "PCM_16", format="WAV") as wav:
            wav.software = MAKER
            for block in sound.blocks():
                wav.write(block.samples)
