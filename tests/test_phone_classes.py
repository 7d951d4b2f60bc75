"""Classes of phones: each phone is of one, each frame is of one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from lipwright.clip import Clip
from lipwright.dataset.folder import open_dataset, sha256_of
from lipwright.evaluate.classes import (
    AROUND,
    CLASS_OF,
    CLASSES,
    PAUSE,
    class_at,
    class_rows,
    classes_of,
)
from lipwright.evaluate.errors import error_rows, load_truth
from lipwright.face.faceclip import control_names
from lipwright.face.reference_file import load_reference_face
from lipwright.phones import ARPABET, BILABIALS, MANNERS, PHONES, PLACES, SILENCE
from lipwright.track import PhoneTrack


@pytest.mark.parametrize("symbol", [symbol for symbol in PHONES if symbol != SILENCE])
def test_every_phone_is_of_one_class_and_silence_of_none(symbol: str) -> None:
    holding = [name for name, row in CLASSES.items() if row.holds(PHONES[symbol])]
    assert holding == [CLASS_OF[symbol]]


def test_silence_is_of_no_class_of_phones() -> None:
    assert not any(row.holds(PHONES[SILENCE]) for row in CLASSES.values())
    assert SILENCE not in CLASS_OF


def test_every_class_has_its_examples_and_names_what_the_table_has() -> None:
    for name, row in CLASSES.items():
        examples = row.example.split()
        if row in (AROUND, PAUSE):
            assert examples == [SILENCE]
            continue
        assert examples[0] in ARPABET
        assert [CLASS_OF[phone] for phone in examples] == [name] * len(examples)
        assert set(row.places) <= set(PLACES)
        assert set(row.manners) <= set(MANNERS)
    assert len({row.title for row in CLASSES.values()}) == len(CLASSES)


def test_classes_are_those_that_the_field_knows() -> None:
    assert {phone for phone, name in CLASS_OF.items() if name == "bilabial"} == BILABIALS
    assert {phone for phone, name in CLASS_OF.items() if name == "velar"} == {"K", "G", "NG", "ENG"}
    assert CLASS_OF["R"] != CLASS_OF["SH"]
    assert {PHONES[phone].is_vowel for phone, name in CLASS_OF.items() if name == "rounded"} == {
        True
    }


TRACK = PhoneTrack(
    (SILENCE, "K", SILENCE, SILENCE, "UW", SILENCE), np.array([0.0, 0.2, 0.4, 0.5, 0.6, 0.8, 1.0])
)


def test_silence_between_phones_is_a_pause() -> None:
    assert classes_of(TRACK) == ("silence", "velar", "pause", "pause", "rounded", "silence")
    silent = PhoneTrack((SILENCE, SILENCE), np.array([0.0, 0.5, 1.0]))
    assert classes_of(silent) == ("silence", "silence")
    spoken = PhoneTrack(("K",), np.array([0.0, 0.5]))
    assert classes_of(spoken) == ("velar",)


def test_a_frame_is_of_the_phone_that_is_said_then() -> None:
    times = [-0.1, 0.0, 0.19, 0.2, 0.39, 0.45, 0.55, 0.7, 0.8, 1.0, 7.0]
    expected = ["silence", "silence", "silence", "velar", "velar", "pause", "pause", "rounded",
                "silence", "silence", "silence"]  # fmt: skip
    assert class_at(TRACK, times).tolist() == expected
    assert len(class_at(TRACK, [])) == 0
    wordless = PhoneTrack(("K",), np.array([0.0, 0.5]))
    assert class_at(wordless, [0.4, 0.5]).tolist() == ["velar", "silence"]


def test_classes_share_out_every_frame_and_a_planted_error_falls_on_its_class(
    speakers: Path,
) -> None:
    path = speakers / "anna-face.npz"
    face, dataset = load_reference_face(path), open_dataset(speakers / "anna")
    recordings = [dataset.recording(name) for name in ("anna1", "anna2")]
    truths = [load_truth(one, sha256_of(path)) for one in recordings]
    clips = []
    for recording, truth in zip(recordings, truths, strict=True):
        values = np.zeros((len(truth.valid), len(face.joint_sd)), np.float32)
        values[truth.valid] = face.join(truth.parameters) / face.joint_sd
        values[class_at(truth.track, recording.times) == "bilabial"] += 2  # deviations
        clips.append(Clip(control_names(face, "joint"), recording.motion.fps, values))
    whole = error_rows(face, truths, clips)
    for measure in ("joint_sd", "inner", "vertices"):
        found = class_rows(face, truths, clips, measure)
        assert list(found) == [name for name in CLASSES if name in found]
        assert sum(rows.sums for rows in found.values()) == pytest.approx(whole[measure].sums)
        assert sum(rows.counts for rows in found.values()) == pytest.approx(whole[measure].counts)
    found = class_rows(face, truths, clips)
    assert found.pop("bilabial").value == pytest.approx(4, rel=1e-3)
    assert max(rows.value for rows in found.values()) < 1e-6
    shapes = [
        Clip(("shape1",), 25, np.zeros((len(truth.valid), 1), np.float32)) for truth in truths
    ]
    assert class_rows(face, truths, shapes) == {}
    assert class_rows(face, truths, shapes, "shape")
    with pytest.raises(KeyError, match="frames have no 'r'"):
        class_rows(face, truths, clips, "r")
