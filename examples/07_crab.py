"""A crab talks: a character of your own, with poses, bigrams and a model of its own.

python examples/07_crab.py [RECORDING WORDS.txt]
"""

import sys
from pathlib import Path

import numpy as np
from crab.model import CAMERA, crab

import lipwright
from lipwright.bigrams.coverage import cover
from lipwright.bigrams.families import load_bigrams
from lipwright.bigrams.missing import needed_pairs
from lipwright.export import ExportOptions
from lipwright.face.png import write_png
from lipwright.face.render import Renderer

here = Path(__file__).parent
recording, words = map(Path, sys.argv[1:3] or (here / "hello.flac", here / "hello.txt"))
out = Path("demo")
out.mkdir(exist_ok=True)

drawn = load_bigrams(here / "crab" / "crab.bigrams.json")
options = lipwright.AnimateOptions(bigrams=drawn, fps=30)
result = lipwright.animate(recording, text=words.read_text("utf-8"), options=options)

report = cover(drawn, needed_pairs(drawn, [result.track]))
for row in report.rows[:8]:
    print(f"{' '.join(row.pair):10}{row.count:4}{row.share:7.1%}  {row.source or 'missing'}")
print(f"{len(report.rows)} pairs are needed, {len(report.missing)} of them are not in the set")

character = crab()
shown = ExportOptions(size=(640, 480), title="A crab talks", character=character, view=CAMERA)
lipwright.export_all([out / "crab.glb", out / "crab.mp4"], result.performance, options=shown)

# A contact sheet: the frame in the middle of every sixth phone.
middles = (result.track.edges[:-1] + result.track.edges[1:]) / 2
frames = np.rint(middles * result.clip.fps).astype(int)[2::6][:12]
with Renderer(character, 320, 240, view=CAMERA) as renderer:
    poses = result.clip.select(character.shape_names).values[frames]
    pictures = [renderer.render(pose) for pose in poses]
write_png(out / "crab.png", np.vstack([np.hstack(pictures[i : i + 4]) for i in (0, 4, 8)]))
print("crab.glb, crab.mp4, crab.png:", " ".join(result.track.phones[2::6][:12]))
