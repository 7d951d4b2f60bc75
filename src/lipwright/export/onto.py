"""`--onto`: the curves on a GLB, VRM or `.gltf` of a character that is there already.

What the curves move are the file's expressions (VRM), its morph targets by `extras.targetNames`,
and its bones by the names of their nodes, exactly or without case, underscores and usual prefixes;
see `gltf_names.loose_name`. One animation is added, the last one, with data of its own at the end
of the binary chunk. All else stays as it was, what we know nothing of too: documents are plain JSON
here, since readers of glTF drop what they do not know. Buffers and pictures that lay beside a
`.gltf` come into the GLB.

Bones: translations in m and rotations in degrees are added to the node's rest in the axes of its
parent; a node with a matrix gets the same as translation, rotation and scale, since glTF animates
only these. Turns of the head are about the axes of the scene, so that they turn any skeleton.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.export.gltf_buffers import data_type, read_buffer
from lipwright.export.gltf_chunks import MAX_BYTES
from lipwright.export.gltf_curves import Animation, continuous, multiply
from lipwright.export.gltf_file import GltfFile, read_gltf
from lipwright.export.gltf_names import Character
from lipwright.export.gltf_rest import Rests
from lipwright.export.gltf_store import Store
from lipwright.export.performance import ExportOptions, Performance
from lipwright.export.vrm import Bind, faces_back
from lipwright.face.turning import head_quaternions, head_turns
from lipwright.retarget import is_retargetable, retarget
from lipwright.rig import LinearMapping, Rig, load_rig
from lipwright.rig.file import RIGS

Floats = npt.NDArray[np.float64]

CM: Final = 0.01  # m; the unit of few keys of places of bones, as in `lipwright.keys`
DEGREE: Final = np.pi / 180  # the unit of turns of bones
NAMED: Final = 12  # names that an error lists
OWN_RIG: Final = "arkit"  # whose controls are the canonical ones
PICTURES: Final = {b"\x89PNG": "image/png", b"\xff\xd8\xff": "image/jpeg", b"RIFF": "image/webp"}
MAX_VALUES: Final = 2**28  # weights of one node, a gigabyte


def rig_for(character: Path) -> str | None:
    """The rig that ships of which a character's file has most controls; None if it has none.

    Raises:
        LipwrightError: the file cannot be used.
    """
    return _rig_of(Character(read_gltf(character)))


def _rig_of(character: Character) -> str | None:
    scores = {}
    for name in RIGS:
        names = load_rig(name).names
        known = sum(map(character.knows, names))
        if known:
            scores[name] = (known, known / len(names))
    return max(scores, key=lambda name: scores[name], default=None)


def animated(
    path: Path, performance: Performance, options: ExportOptions, sound: str | None = None
) -> Callable[[], bytes]:
    """The character `options.onto` with the performance, as a function that makes the GLB.

    Canonical curves go to the rig that the file knows best; where it has a jaw and nothing like
    `mouthClose`, the jaw shuts the lips.

    Args:
        path: what will be written; names the animation.
        performance: the curves.
        options: `onto` and `keys`.
        sound: the file of the sound, named in the animation's `extras`.

    Raises:
        LipwrightError: the file cannot be used, or has none of the controls; lists what it has.
    """
    assert options.onto is not None  # who calls asks for it
    source = Path(options.onto)
    if path.exists() and source.exists() and path.samefile(source):
        raise LipwrightError(f"{path}: is the character itself; name another output")
    file = read_gltf(source)
    character = Character(file)
    clip = _in_its_controls(performance, character)
    moved = [name for name in clip.names if character.knows(name)]
    if not moved:
        has = character.names()
        more = f" and {len(has) - NAMED} more" if len(has) > NAMED else ""
        listed = ", ".join(name[:40] for name in has[:NAMED]) or "no names at all"
        raise LipwrightError(
            f"{source}: has none of the controls ({', '.join(clip.names[:3])}, ...); it has "
            f"{listed}{more}; retarget to a rig with those names"
        )
    clip = clip.select(moved)
    Rests(character)  # refuses broken nodes before the work
    file.tables("animations")
    return lambda: _make(character, clip, path.stem, options.keys, sound)


def left_out(character: Path, performance: Performance) -> tuple[str, ...]:
    """The controls that move in the curves, as they go onto a character, and that it lacks.

    Raises:
        LipwrightError: the character's file cannot be used.
    """
    known = Character(read_gltf(character))
    clip = _in_its_controls(performance, known)
    moving = np.ptp(clip.values, axis=0) > 0
    pairs = zip(clip.names, moving, strict=True)
    return tuple(name for name, moves in pairs if moves and not known.knows(name))


def _in_its_controls(performance: Performance, character: Character) -> Clip:
    clip, rig = performance.clip, performance.rig
    if not is_retargetable(clip) or (rig is not None and rig.mapping is not None):
        return clip
    if rig is not None:  # of canonical controls
        return _with_lips_shut(clip, rig, character)
    name = _rig_of(character)
    if name is None:
        return clip
    rig = load_rig(name)
    if name == OWN_RIG:
        own = clip if set(clip.names) & set(CANONICAL) else retarget(clip, rig, performance.track)
        return _with_lips_shut(own, rig, character)
    return retarget(_with_lips_shut(clip, rig, character), rig, performance.track)


def _with_lips_shut(clip: Clip, rig: Rig, character: Character) -> Clip:
    """Canonical curves of which the jaw shuts the lips, where nothing else of a character does.

    `mouthClose` undoes `jawOpen` about one to one, as `rig_guess` says.
    """
    heard = _heard(rig, character)
    if rig.discrete or "jawOpen" not in heard or "mouthClose" in heard:
        return clip
    if not {"jawOpen", "mouthClose"} <= set(clip.names):
        return clip
    close = clip.curve("mouthClose")
    jaw = np.maximum(0.0, clip.curve("jawOpen") - close)
    return clip.with_curves({"jawOpen": jaw, "mouthClose": np.zeros_like(close)})


def _heard(rig: Rig, character: Character) -> set[str]:
    """The canonical controls that move those of a rig's controls that a character has."""
    known = {name for name in rig.names if character.knows(name)}
    if not isinstance(rig.mapping, LinearMapping):
        return known
    rows = {name: row for name, row in rig.mapping.rows.items() if name in known}
    also = tuple(c for c in rig.mapping.correctives if c.control in known)
    return LinearMapping(rows, also).sources


def _make(
    character: Character, clip: Clip, name: str, keys: float | None, sound: str | None
) -> bytes:
    from copy import deepcopy

    file = character.file
    document = deepcopy(file.document)  # the file stays as it was read
    character = Character(replace(file, document=document, _lists={}))
    store = Store(document, _own_buffer(character.file))
    _take_pictures(character.file, store)
    animation = Animation(store, name, clip.fps, keys)
    if sound is not None:
        animation.mark["sound"] = sound
    for node, weights in _weights(character, clip):
        animation.animate(node, "weights", weights)
    rests = Rests(character)
    _move_bones(character, clip, animation, rests)
    return store.to_glb(file.other_chunks)


def _weights(character: Character, clip: Clip) -> list[tuple[int, npt.NDArray[np.float32]]]:
    """Each node whose morph targets move, and all its weights (T, n); others stay at rest."""
    binds: dict[int, list[tuple[str, Bind]]] = {}
    for name in clip.names:
        for bind in character.binds(name)[0]:
            binds.setdefault(bind.node, []).append((name, bind))
    found = []
    for node, own in binds.items():
        rest = _rest_weights(character, node)
        if len(clip) * len(rest) > MAX_VALUES:
            character.file.fail(f"node {node} has too many morph targets for so long a clip")
        values = np.tile(rest, (len(clip), 1))
        values[:, [bind.target for _, bind in own]] = 0.0
        for name, bind in own:
            curve = clip.curve(name)
            values[:, bind.target] += bind.share * (curve > 0.5 if bind.binary else curve)
        found.append((node, values))
    return found


def _rest_weights(character: Character, node: int) -> npt.NDArray[np.float32]:
    body = character.nodes[node]
    mesh = character.file.tables("meshes")[body["mesh"]]
    zeros = [0.0] * character.target_count(node)
    weights = character.file.numbers(
        body if "weights" in body else mesh, "weights", zeros, f"node {node}"
    )
    return np.array(weights, np.float32)


def _move_bones(character: Character, clip: Clip, animation: Animation, rests: Rests) -> None:
    places: dict[int, Floats] = {}
    angles: dict[int, Floats] = {}
    for name in clip.names:
        bone = character.bone(name)
        if bone is not None and not character.binds(name)[0]:
            node, channel = bone
            of_kind = places if channel < 3 else angles
            values = of_kind.setdefault(node, np.zeros((len(clip), 3)))
            values[:, channel % 3] = clip.curve(name)
    for node, values in places.items():
        moved = rests.translation(node) + values / rests.parent_scale(node)
        animation.animate(node, "translation", moved, CM / rests.parent_scale(node))
    turned: dict[int, Floats] = {}
    for node, values in angles.items():
        from scipy.spatial.transform import Rotation

        turn = Rotation.from_euler("xyz", values, degrees=True).as_quat()
        turned[node] = multiply(turn, rests.rotation(node))
    turns, head = head_turns(clip), character.head
    if turns is not None and head is not None:
        about = _in_parent(head_quaternions(turns), rests.parent_turn(head), character.file)
        turned[head] = multiply(about, turned.get(head, rests.rotation(head)))
        animation.mark["head"] = head
    for node, quaternions in turned.items():
        unit = DEGREE if node in angles else 1.0
        animation.animate(node, "rotation", continuous(quaternions), unit)


def _in_parent(turn: Floats, parent: Floats, file: GltfFile) -> Floats:
    """Turns about the axes of the character's scene in those of a parent (4,)."""
    if faces_back(file):
        turn = turn * [-1, 1, -1, 1]  # half a turn about y
    back = parent * [-1, -1, -1, 1]
    return multiply(multiply(back, turn), parent)


def _own_buffer(file: GltfFile) -> bytes | memoryview:
    """What the binary chunk starts with: buffer 0. Other files' buffers become data of the JSON."""
    import base64

    for number, item in enumerate(file.tables("buffers")):
        content = file.buffers[number]
        if number == 0:
            if content is None:
                file.fail("its first buffer has no data")
            item.pop("uri", None)
        elif content is not None and not str(item["uri"]).startswith("data:"):
            coded = base64.b64encode(content).decode()
            item["uri"] = f"data:application/octet-stream;base64,{coded}"
    return (file.buffers[0] or b"") if file.buffers else b""


def _take_pictures(file: GltfFile, store: Store) -> None:
    """Pictures that lie beside the file come into the binary chunk."""
    for number, image in enumerate(file.tables("images")):
        uri = image.get("uri")
        if uri is None or (isinstance(uri, str) and data_type(uri)):
            continue
        content = read_buffer(file.path, f"image {number}", uri, MAX_BYTES)
        kind = next((k for start, k in PICTURES.items() if content.startswith(start)), None)
        if kind is None:
            file.fail(f"image {number} is neither PNG, JPEG nor WebP")
        del image["uri"]
        image |= {"mimeType": kind, "bufferView": store.view(content)}
