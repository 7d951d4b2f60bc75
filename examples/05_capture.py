"""A video of a face to a dataset, and its motion back as curves.

The speaker is our own head, so that this runs anywhere; put your videos in its place.
Needs the extra: pip install 'lipwright[capture]'
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import lipwright
from lipwright.capture.job import CaptureOptions
from lipwright.capture.run import capture
from lipwright.capture.sources import find_sources
from lipwright.controls import ARKIT

EXAMPLES = Path(__file__).parent


def main() -> None:
    """Draw a speaker, capture the video, compare."""
    words = (EXAMPLES / "hello.txt").read_text()
    with TemporaryDirectory() as name:
        place = Path(name)
        options = lipwright.AnimateOptions(fps=25)
        spoken = lipwright.animate(EXAMPLES / "hello.flac", text=words, options=options)
        lipwright.export_all([place / "hello.mp4"], spoken.performance)

        sources = find_sources([place / "hello.mp4"], transcripts=EXAMPLES / "hello.txt")
        dataset = capture(sources, place / "me", CaptureOptions()).dataset
        recording = dataset.recording("hello")
        quality = recording.info["quality"]
        print(f"{len(recording.motion)} frames, {100 * quality['tracked']:.0f} % tracked")
        print(f"closed at {quality['bilabials_closed']} of {quality['bilabials']} p, b, m")
        jaw = recording.motion.arkit[:, ARKIT.index("jawOpen")]
        print(f"jawOpen: {jaw.max():.2f} captured, {spoken.clip.curve('jawOpen').max():.2f} played")


if __name__ == "__main__":
    main()
