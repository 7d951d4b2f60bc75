"""How far each canonical control opens the lips of the head: the table of passes/openings.py.

    python bench/lip_openings.py

prints the rows, in eye distances at full weight, for the inner lips' centre, left and right.
"""

from __future__ import annotations

import numpy as np

from lipwright.controls import CANONICAL
from lipwright.face.head import Head, load_head

LEAST = 0.00005  # eye distances; smaller motion is none
DECIMALS = 4


def openings(head: Head) -> dict[str, tuple[float, float, float]]:
    """Control to how far it opens the centre, left and right of the inner lips, eye distances."""
    rows = {}
    for name in CANONICAL:
        moved, by = head.shape(name)
        heights = np.zeros(len(head.vertices))
        heights[moved] = by[:, 1]
        gaps = heights[head.lip_pairs]
        row = (gaps[:, 0] - gaps[:, 1]) / head.eye_distance
        if np.abs(row).max() > LEAST:
            rows[name] = tuple(round(float(gap), DECIMALS) for gap in row)
    return rows


if __name__ == "__main__":
    for control, row in openings(load_head()).items():
        print(f'    "{control}": {row},')
