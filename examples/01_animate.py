"""A recording and its words become curves, as JSON and as a table."""

from pathlib import Path

import lipwright

here = Path(__file__).parent
out = Path("demo")
out.mkdir(exist_ok=True)

result = lipwright.animate(here / "hello.flac", text=(here / "hello.txt").read_text("utf-8"))
for word in result.track.words[:4]:
    start, end = result.track.word_span(word)
    print(f"{start:5.2f} to {end:5.2f} s  {word.text}")
print(f"widest jaw: {result.clip.curve('jawOpen').max():.2f}")
lipwright.export_all([out / "hello.json", out / "hello.csv"], result.performance)
