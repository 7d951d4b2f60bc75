"""GLB: the head, or another character, with its blendshapes as morph targets, animated.

The sound is `NAME.wav`.

Morph targets are sparse accessors: most blendshapes move a small part of the mesh. The names
stand in the mesh's `extras.targetNames`, where Blender, three.js and Unreal look for them.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.export.performance import (
    ExportOptions,
    Output,
    Performance,
    prepare_head,
    shown_character,
)
from lipwright.export.sidecar import sound_outputs
from lipwright.face.png import encode_png

if TYPE_CHECKING:
    from lipwright.face.mesh import Mesh, Part

# glTF 2.0, section 5: component types and buffer view targets.
FLOAT: Final = 5126
UINT16: Final = 5123
UINT32: Final = 5125
VERTICES: Final = 34962
INDICES: Final = 34963

TURNS: Final = 1e-3  # smaller changes of a unit normal are not seen and not stored


def prepare() -> None:
    """Find out before long work whether the head and pygltflib are there."""
    prepare_head("pygltflib")


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The GLB, and the sound beside it.

    Raises:
        LipwrightError: no head is installed, or the clip moves none of the character.
    """
    mesh = shown_character(path, performance.clip, options)
    sound = sound_outputs(path, performance)
    wav = path.with_suffix(".wav").name if performance.audio is not None else None

    def write(part: Path) -> None:
        part.write_bytes(mesh_to_glb(mesh, performance.clip, name=path.stem, sound=wav))

    return [Output(path, write), *sound]


def mesh_to_glb(mesh: Mesh, clip: Clip, *, name: str = "speech", sound: str | None = None) -> bytes:
    """The bytes of a GLB file.

    Args:
        mesh: the head, or another character.
        clip: curves; one key a frame. Controls that the mesh lacks are left out.
        name: of the animation.
        sound: the file of the sound, named in the asset's `extras`.
    """
    import pygltflib as gltf

    # The nodes, once written, never change: one document out of finished parts.
    store = _Store()
    image = store.view(encode_png(mesh.texture))
    turned = _turned_normals(mesh)
    primitives = [
        _primitive(store, mesh, part, index, turned) for index, part in enumerate(mesh.parts)
    ]
    animation = _animation(store, clip.select(mesh.shape_names), name)
    document = gltf.GLTF2(
        asset=_asset(mesh, clip, sound),
        scene=0,
        scenes=[gltf.Scene(nodes=[0], name="scene")],
        nodes=[gltf.Node(mesh=0, name=mesh.name)],
        meshes=[
            gltf.Mesh(
                name=mesh.name,
                primitives=primitives,
                weights=[0.0] * len(mesh.shape_names),
                extras={"targetNames": list(mesh.shape_names)},
            )
        ],
        materials=[_material(part) for part in mesh.parts],
        textures=[gltf.Texture(sampler=0, source=0)],
        samplers=[gltf.Sampler(magFilter=9729, minFilter=9987, wrapS=33071, wrapT=33071)],
        images=[gltf.Image(bufferView=image, mimeType="image/png", name="skin")],
        animations=[animation],
        accessors=store.accessors,
        bufferViews=store.views,
        buffers=[gltf.Buffer(byteLength=len(store.data))],
    )
    document.set_binary_blob(bytes(store.data))
    return b"".join(document.save_to_bytes())


class _Store:
    """The binary chunk as it grows, with its views and accessors."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[Any] = []
        self.accessors: list[Any] = []
        self._still: dict[int, int] = {}  # vertex count to the accessor of a shape that moves none

    def view(self, content: bytes, target: int | None = None) -> int:
        import pygltflib as gltf

        self.data += bytes(-len(self.data) % 4)
        self.views.append(
            gltf.BufferView(
                buffer=0, byteOffset=len(self.data), byteLength=len(content), target=target
            )
        )
        self.data += content
        self.data += bytes(-len(self.data) % 4)
        return len(self.views) - 1

    def accessor(
        self, values: npt.NDArray[Any], kind: str, target: int | None = None, bounds: bool = False
    ) -> int:
        """An accessor of all `values`; `bounds` where glTF asks for minimum and maximum."""
        import pygltflib as gltf

        component = {"f": FLOAT, "u": UINT32}[values.dtype.kind]
        return self._add(
            gltf.Accessor(
                bufferView=self.view(np.ascontiguousarray(values).tobytes(), target),
                componentType=component,
                count=len(values),
                type=kind,
                **(_bounds(values) if bounds else {"min": None, "max": None}),
            )
        )

    def sparse(self, vertices: npt.NDArray[Any], deltas: npt.NDArray[Any], count: int) -> int:
        """An accessor of `count` vectors that are 0 but for `deltas` (n, 3) at `vertices` (n,)."""
        import pygltflib as gltf

        if len(vertices) == 0:
            if count not in self._still:
                self._still[count] = self._add(self._zeros(count, np.zeros((1, 3), np.float32)))
            return self._still[count]
        small = count <= 65535
        indices = np.asarray(vertices, np.uint16 if small else np.uint32)
        deltas = np.asarray(deltas, np.float32)
        everything = deltas if len(deltas) == count else np.vstack([deltas, np.zeros((1, 3))])
        accessor = self._zeros(count, everything.astype(np.float32))
        accessor.sparse = gltf.Sparse(
            count=len(indices),
            indices=gltf.AccessorSparseIndices(
                bufferView=self.view(indices.tobytes()),
                componentType=UINT16 if small else UINT32,
            ),
            values=gltf.AccessorSparseValues(bufferView=self.view(deltas.tobytes())),
        )
        return self._add(accessor)

    def _zeros(self, count: int, values: npt.NDArray[Any]) -> Any:
        import pygltflib as gltf

        # Without a buffer view an accessor may have no offset, which pygltflib sets to 0.
        return gltf.Accessor(
            byteOffset=None, componentType=FLOAT, count=count, type="VEC3", **_bounds(values)
        )

    def _add(self, accessor: Any) -> int:
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def _bounds(values: npt.NDArray[Any]) -> dict[str, list[float]]:
    columns = values.reshape(len(values), -1)
    return {"min": columns.min(axis=0).tolist(), "max": columns.max(axis=0).tolist()}


def _asset(mesh: Mesh, clip: Clip, sound: str | None) -> Any:
    from importlib.metadata import version

    import pygltflib as gltf

    own = version("lipwright")
    extras = {
        "lipwright": own,
        mesh.name: f"{mesh.source}, {mesh.license}",
        "fps": clip.fps,
    }
    if sound is not None:
        extras["sound"] = sound
    return gltf.Asset(
        generator=f"Lipwright {own}",
        copyright=f"{mesh.name.capitalize()}: {mesh.license}",
        extras=extras,
    )


def _material(part: Part) -> Any:
    import pygltflib as gltf

    material = part.material
    return gltf.Material(
        name=part.name,
        doubleSided=material.double_sided,
        alphaCutoff=None,
        pbrMetallicRoughness=gltf.PbrMetallicRoughness(
            baseColorFactor=[*material.base_color, 1.0],
            metallicFactor=material.metallic,
            roughnessFactor=material.roughness,
            baseColorTexture=gltf.TextureInfo(index=0),
        ),
    )


def _turned_normals(mesh: Mesh) -> Sequence[npt.NDArray[np.float32]]:
    """For each blendshape, how it changes the normals: (V, 3)."""
    weights = np.eye(len(mesh.shape_names), dtype=np.float32)
    return [mesh.normals(mesh.pose(row)) - mesh.rest_normals for row in weights]


def _primitive(
    store: _Store, mesh: Mesh, part: Part, index: int, turned: Sequence[npt.NDArray[np.float32]]
) -> Any:
    """One part of the mesh with all blendshapes; glTF asks for the same number in each part."""
    import pygltflib as gltf

    run = part.vertices
    count = run.stop - run.start
    targets = []
    for name, turn in zip(mesh.shape_names, turned, strict=True):
        vertices, deltas = mesh.shape(name)
        inside = (vertices >= run.start) & (vertices < run.stop)
        own = turn[run]
        turning = np.flatnonzero(np.abs(own).max(axis=1) > TURNS)
        targets.append(
            gltf.Attributes(
                POSITION=store.sparse(vertices[inside] - run.start, deltas[inside], count),
                NORMAL=store.sparse(turning, own[turning], count),
            )
        )
    triangles = (mesh.triangles[part.triangles] - run.start).astype(np.uint32)
    return gltf.Primitive(
        attributes=gltf.Attributes(
            POSITION=store.accessor(mesh.vertices[run], "VEC3", VERTICES, bounds=True),
            NORMAL=store.accessor(mesh.rest_normals[run], "VEC3", VERTICES),
            TEXCOORD_0=store.accessor(mesh.uvs[run], "VEC2", VERTICES),
            COLOR_0=store.accessor(mesh.tints[run], "VEC3", VERTICES),
        ),
        indices=store.accessor(triangles.ravel(), "SCALAR", INDICES),
        material=index,
        targets=targets,
    )


def _animation(store: _Store, clip: Clip, name: str) -> Any:
    import pygltflib as gltf

    times = store.accessor(clip.times.astype(np.float32), "SCALAR", bounds=True)
    weights = store.accessor(clip.values.ravel(), "SCALAR")
    return gltf.Animation(
        name=name,
        channels=[
            gltf.AnimationChannel(
                sampler=0, target=gltf.AnimationChannelTarget(node=0, path="weights")
            )
        ],
        samplers=[gltf.AnimationSampler(input=times, output=weights, interpolation="LINEAR")],
    )
