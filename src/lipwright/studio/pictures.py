"""What the curves look like on our head."""

from __future__ import annotations

import math
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Final, cast, get_args

import numpy as np

from lipwright.bigrams.values import MAX_VALUE, BigramSet
from lipwright.errors import LipwrightError
from lipwright.face.head import load_head
from lipwright.face.png import encode_png
from lipwright.face.render import Renderer
from lipwright.face.shading import View
from lipwright.rig import load_rig

SIZE: Final = 360  # pixels
VIEWS: Final = get_args(View)


class Pictures:
    """Draws the head, one picture after the other: a graphics context belongs to one thread.

    Attributes:
        trouble: why there are no pictures; empty where there are.
    """

    def __init__(self, rig: str) -> None:
        """Prepare for poses of a rig; what is missing is no error here."""
        self._thread = ThreadPoolExecutor(1, "pictures")
        self._renderers: dict[str, Renderer] = {}
        self.trouble = ""
        try:
            self._head = load_head()
            self._rig = load_rig(rig)
        except LipwrightError as error:
            self.trouble = str(error)
        else:
            if not self._rig.looks:
                self.trouble = f"the rig {rig} does not say how its poses look on our head"

    def png(self, bigrams: BigramSet, poses: Mapping[str, float], view: str = "face") -> bytes:
        """The head with these poses on.

        Raises:
            LipwrightError: there is no picture, an unknown pose or view, or a weight out of range.
        """
        if self.trouble:
            raise LipwrightError(self.trouble)
        if view not in VIEWS:
            raise LipwrightError(f"no view {view[:40]!r}; the views are: {', '.join(VIEWS)}")
        for pose, weight in poses.items():
            if pose not in bigrams.poses:
                raise LipwrightError(f"the set has no pose {pose[:40]!r}")
            if not (math.isfinite(weight) and abs(weight) <= MAX_VALUE):
                raise LipwrightError(f"{pose!r} is {weight:g}; give at most {MAX_VALUE:g}")
        return self._thread.submit(self._draw, dict(poses), cast(View, view)).result()

    def _draw(self, poses: Mapping[str, float], view: View) -> bytes:
        if view not in self._renderers:
            self._renderers[view] = Renderer(self._head, SIZE, SIZE, view=view)
        weights = np.array(list(poses.values()), np.float32) @ self._rig.look_of(poses)
        return encode_png(self._renderers[view].render(np.clip(weights, 0, 1)))

    def close(self) -> None:
        """Give back the graphics contexts, in the thread that they belong to."""
        for renderer in self._renderers.values():
            self._thread.submit(renderer.close).result()
        self._thread.shutdown()
