"""Passes are functions from clip to clip: reorder them, leave some out, add your own."""

from pathlib import Path

import lipwright
from lipwright.clip import Clip
from lipwright.passes import consonants, intensity, limit, silence, smooth, speed_limit
from lipwright.track import PhoneTrack

here = Path(__file__).parent
text = (here / "hello.txt").read_text("utf-8")
track = lipwright.align_speech(here / "hello.flac", text).track


def slight_smile(clip: Clip, track: PhoneTrack) -> Clip:
    """A pass of your own: the corners of the mouth a little up, all the time."""
    del track
    sides = ("mouthSmileLeft", "mouthSmileRight")
    return clip.with_curves({name: clip.curve(name) + 0.15 for name in sides})


passes = (intensity(0.7), smooth(), silence(), slight_smile, consonants(), speed_limit(), limit())
options = lipwright.AnimateOptions(fps=30, passes=passes)
result = lipwright.animate(here / "hello.flac", phones=track, options=options)
print(f"least smile: {result.clip.curve('mouthSmileLeft').min():.2f}")
