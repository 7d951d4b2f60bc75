"""Everybody beside the speaker himself, over the first words that his recordings share."""

from __future__ import annotations

from collections.abc import Mapping

from lipwright.benchmark.scoring import Performance, Stage
from lipwright.benchmark.values import Ceiling
from lipwright.dataset.folder import Dataset
from lipwright.evaluate.ceiling import Recorded, himself, load_recorded, span_scores
from lipwright.evaluate.lips import Aperture
from lipwright.evaluate.measures import Scores
from lipwright.evaluate.shared_words import partners, words_of


def measure_ceiling(
    dataset: Dataset, stage: Stage, found: Mapping[str, Performance], face_hash: str
) -> Ceiling | None:
    """The speaker against himself, and everybody over the same words of the same recordings.

    Returns:
        None where no recording of the stage has a partner.

    Raises:
        LipwrightError: a recording has no parameters of this face.
    """
    names = [recording.name for recording in stage.recordings]
    alike = partners(words_of(dataset), names)
    needed = dict.fromkeys(name for one, others in alike.items() for name in (one, *others))
    loaded = {name: load_recorded(dataset.recording(name), face_hash) for name in needed}
    recorded = {name: one for name, one in loaded.items() if one is not None}
    own = himself(stage.face, recorded, alike)
    if own is None:
        return None
    return Ceiling(
        words=own.words, recordings=own.recordings, partners=len(own.pairs), own=own.own,
        own_median_r=own.median_r, mean_of_takes=own.mean_of_takes,
        entries={
            name: _span_scores(stage, one, own.recordings, recorded)
            for name, one in found.items()
        },
    )  # fmt: skip


def _span_scores(
    stage: Stage, one: Performance, names: tuple[str, ...], recorded: Mapping[str, Recorded]
) -> Scores:
    """An entrant over the shared words."""
    places = {recording.name: number for number, recording in enumerate(stage.recordings)}
    chosen = [one.moves[places[name]] for name in names]
    clips = [moves.animated for moves in chosen if moves.animated is not None]
    by_head = {
        head: [Aperture(clip.times, ruler(clip)) for clip in clips]
        for head, ruler in stage.heads.items()
    }
    return span_scores(
        stage.face, [recorded[name] for name in names], [moves.modes for moves in chosen],
        by_head if len(clips) == len(chosen) else {},
    )  # fmt: skip
