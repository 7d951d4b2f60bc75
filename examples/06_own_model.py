"""A model of your own: a whole recording, and phones as they come.

python examples/06_own_model.py [MODEL]

MODEL is a folder that `lipwright train` wrote, or the name of a model that ships.
"""

import sys
from pathlib import Path

import numpy as np

import lipwright
from lipwright.engines.window import animate
from lipwright.engines.window_stream import Stream
from lipwright.network import load_network

here = Path(__file__).parent
model = sys.argv[1] if len(sys.argv) > 1 else "lipwright"
out = Path("demo")
out.mkdir(exist_ok=True)

options = lipwright.AnimateOptions(model=model)
words = (here / "hello.txt").read_text("utf-8")
result = lipwright.animate(here / "hello.flac", text=words, options=options)
lipwright.export_all([out / "own.csv"], result.performance)
print(f"own.csv: {len(result.clip)} frames of {len(result.clip.names)} controls")

# The same phones one by one, as a speech synthesiser would give them; this time nobody listens.
network = load_network(model)
stream = Stream(network, fps=60)
print(f"a frame comes when the next {stream.look_ahead:.2f} s are known")
parts = []
for phone, start, end in zip(
    result.track.phones, result.track.edges[:-1], result.track.edges[1:], strict=True
):
    stream.push(phone, float(start), float(end))
    parts.append(stream.frames())
    if len(parts) % 20 == 0:
        print(f"said until {end:5.2f} s, moved until {sum(map(len, parts)) / 60:5.2f} s")
parts.append(stream.finish())

streamed = np.concatenate(parts)
whole = animate(result.track, 60, model=network).values
print(f"stream and whole differ by {np.abs(streamed - whole).max():.0e} at most")
