"""The measures of lips over recordings, as rows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from lipwright.evaluate.lips import LipScore
from lipwright.evaluate.measures import Rows, Scores


def lip_rows(scores: Sequence[LipScore]) -> Scores:
    """The rows of S recordings.

    Of r, of r at the best lag and of silence each recording counts once, if it has the figure; of
    the lag, in ms, if there is a best one; of closures each real one counts, of false closures each
    second of speech.
    """
    r_best = np.array([score.r_best_lag for score in scores])
    lags = np.array([1000 * score.lag for score in scores])
    return {
        "r": _finite([score.r for score in scores]),
        "r_best_lag": _finite(r_best),
        "lag": _finite(np.where(np.isfinite(r_best), lags, np.nan)),
        "closures": Rows(
            np.array([score.closures_hit for score in scores], float),
            np.array([score.closures_real for score in scores], float),
        ),
        "false_closures": Rows(
            np.array([score.false_closures for score in scores], float),
            np.array([score.speech for score in scores], float),
        ),
        "silence": _finite([score.silence for score in scores]),
    }


def _finite(values: npt.ArrayLike) -> Rows:
    each = np.asarray(values, float)
    known = np.isfinite(each)
    return Rows(np.where(known, each, 0), known.astype(float))


def lower(by_head: Mapping[str, Scores]) -> tuple[str, Scores]:
    """The head on which r is lower, and its rows; the first of equals, and where r is unknown.

    Raises:
        ValueError: there is no head.
    """
    if not by_head:
        raise ValueError("no head to choose from")
    values = {head: scores["r"].value for head, scores in by_head.items()}
    known = {head: value for head, value in values.items() if np.isfinite(value)} or values
    head = min(known, key=lambda name: known[name])
    return head, by_head[head]
