"""Phone times are the first place where people edit: align, move an edge, animate again."""

from pathlib import Path

import lipwright

here = Path(__file__).parent
text = (here / "hello.txt").read_text("utf-8")

track = lipwright.align_speech(here / "hello.flac", text).track
edges = track.edges.copy()
index = track.phones.index("OW")
edges[index + 1] = (edges[index + 1] + edges[index + 2]) / 2  # hold the vowel of "hello" longer
longer = track.with_edges(edges)

result = lipwright.animate(here / "hello.flac", phones=longer)
print(f"OW lasts {longer.durations[index]:.2f} s instead of {track.durations[index]:.2f} s")
print(f"{len(result.clip)} frames of {len(result.clip.names)} controls")
