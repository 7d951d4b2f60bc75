"""Frames of a clip side by side in one picture; needs `lipwright head install`.

python examples/04_contact_sheet.py [PICTURE.png]
"""

import sys
from pathlib import Path

import lipwright
from lipwright.face.head import load_head
from lipwright.face.render import render_contact_sheet

here = Path(__file__).parent
picture = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("demo/sheet.png")
picture.parent.mkdir(exist_ok=True)

result = lipwright.animate(here / "hello.flac", text=(here / "hello.txt").read_text("utf-8"))
shown = ["OW", "AY", "M", "F", "EY", "V"]
middles = (result.track.edges[:-1] + result.track.edges[1:]) / 2
frames = result.clip.at([middles[result.track.phones.index(phone)] for phone in shown])
poses = [dict(zip(result.clip.names, frame, strict=True)) for frame in frames]
render_contact_sheet(load_head(), poses, picture, columns=6, size=240)
print(f"{picture}: {', '.join(shown)}")
