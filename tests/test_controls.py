"""The canonical controls."""

from __future__ import annotations

from lipwright.controls import ARKIT, CANONICAL, GROUPS, MIRROR, TONGUE

# Apple's documentation of ARFaceAnchor.BlendShapeLocation, by its own headings.
APPLE_BOTH_SIDES = {
    "eyeBlink", "eyeLookDown", "eyeLookIn", "eyeLookOut", "eyeLookUp", "eyeSquint", "eyeWide",
    "mouthSmile", "mouthFrown", "mouthDimple", "mouthStretch", "mouthPress", "mouthLowerDown",
    "mouthUpperUp", "browDown", "browOuterUp", "cheekSquint", "noseSneer",
}  # fmt: skip
APPLE_SINGLE = {
    "jawForward", "jawLeft", "jawRight", "jawOpen", "mouthClose", "mouthFunnel", "mouthPucker",
    "mouthLeft", "mouthRight", "mouthRollLower", "mouthRollUpper", "mouthShrugLower",
    "mouthShrugUpper", "browInnerUp", "cheekPuff", "tongueOut",
}  # fmt: skip
APPLE = APPLE_SINGLE | {name + side for name in APPLE_BOTH_SIDES for side in ("Left", "Right")}


def test_the_52_names_are_apples() -> None:
    assert len(APPLE) == 52
    assert len(ARKIT) == 52
    assert set(ARKIT) == APPLE


def test_canonical_is_arkit_and_three_tongue_controls_that_arkit_lacks() -> None:
    assert CANONICAL == ARKIT + TONGUE
    assert set(TONGUE) == {"tongueRaise", "tonguePress", "tongueBack"}
    assert len(set(CANONICAL)) == 55


def test_mirroring_twice_changes_nothing_and_stays_among_the_controls() -> None:
    assert tuple(MIRROR) == CANONICAL
    assert all(MIRROR[MIRROR[name]] == name for name in CANONICAL)


def test_left_mirrors_to_right_and_the_middle_to_itself() -> None:
    for name, other in MIRROR.items():
        if name.endswith("Left"):
            assert other == name.removesuffix("Left") + "Right"
        elif not name.endswith("Right"):
            assert other == name
    assert sum(name != other for name, other in MIRROR.items()) == 2 * (len(APPLE_BOTH_SIDES) + 2)


def test_every_control_is_in_exactly_one_group() -> None:
    grouped = [name for names in GROUPS.values() for name in names]
    assert sorted(grouped) == sorted(CANONICAL)


def test_a_control_and_its_mirror_are_in_the_same_group() -> None:
    for names in GROUPS.values():
        assert {MIRROR[name] for name in names} == set(names)
