"""Pictures of a mesh by OpenGL, without a window."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from lipwright.face.mesh import Mesh
from lipwright.face.shading import (
    LIGHTS,
    SURFACES,
    Camera,
    Surface,
    VertexLight,
    View,
    background,
    camera_of,
    encode,
    unit,
)

if TYPE_CHECKING:
    import moderngl

MIP_LEVELS: Final = 2  # at the crown, where the texture's meridians meet, more would blur all of it
SAMPLES: Final = 4  # of a pixel's edge coverage

_VERTEX: Final = """
#version 330
uniform mat4 camera;
in vec3 position; in vec3 normal; in vec3 light; in vec3 shine; in vec2 uv;
out vec3 place; out vec3 facing; out vec3 lit; out vec3 shining; out vec2 spot;
void main() {
    gl_Position = camera * vec4(position, 1.0);
    place = position; facing = normal; lit = light; shining = shine; spot = uv;
}
"""

_ENCODE: Final = """
vec3 encode(vec3 light) {
    light = clamp(light, 0.0, 1.0);
    vec3 root = sqrt(light);
    vec3 fourth = sqrt(root);
    return mix(light * 12.92,
               0.662002687 * root + 0.684122060 * fourth - 0.323583601 * sqrt(fourth)
                   - 0.0225411470 * light,
               step(0.0031308, light));
}
"""

_DECODE: Final = """
vec3 decode(vec3 coded) {
    return coded * (coded * (coded * 0.305306 + 0.682171) + 0.012523);
}
"""

# Light comes from the vertices, which is cheap where OpenGL runs on the processor.
_FRAGMENT: Final = """
#version 330
uniform sampler2D skin;
in vec3 lit; in vec3 shining; in vec2 spot;
out vec4 pixel;
CODES
void main() { pixel = vec4(encode(decode(texture(skin, spot).rgb) * lit + shining), 1.0); }
""".replace("CODES", _ENCODE + _DECODE)

# The highlight of an eye is smaller than its triangles.
_EYE_FRAGMENT: Final = """
#version 330
uniform sampler2D skin; uniform vec3 eye; uniform vec3 color; uniform float gloss;
uniform float power; uniform vec3 highlight;
in vec3 place; in vec3 facing; in vec3 lit; in vec3 shining; in vec2 spot;
out vec4 pixel;
CODES
void main() {
    vec3 middle = normalize(normalize(eye - place) + highlight);
    float spread = pow(max(dot(normalize(facing), middle), 0.0), power);
    vec3 shine = shining + color * gloss * spread;
    pixel = vec4(encode(decode(texture(skin, spot).rgb) * lit + shine), 1.0);
}
""".replace("CODES", _ENCODE + _DECODE)

_BACKDROP_VERTEX: Final = """
#version 330
in vec2 corner;
void main() { gl_Position = vec4(corner, 0.999999, 1.0); }
"""

_BACKDROP_FRAGMENT: Final = """
#version 330
uniform sampler2D backdrop;
out vec4 pixel;
void main() { pixel = texelFetch(backdrop, ivec2(gl_FragCoord.xy), 0); }
"""


class GlPainter:
    """Draws a posed mesh with OpenGL 3.3 on EGL.

    Raises:
        ImportError: moderngl is not installed.
        Exception: there is no working EGL or OpenGL; the kind depends on the driver.
    """

    def __init__(self, mesh: Mesh, width: int, height: int, view: View | Camera) -> None:
        """Create the context and upload what does not change."""
        import moderngl

        self._mesh = mesh
        self._size = (width, height)
        # moderngl's stubs do not know its own option.
        options: dict[str, Any] = {"standalone": True, "backend": "egl", "require": 330}
        self._context = moderngl.create_context(**options)
        context = self._context
        samples = min(SAMPLES, context.max_samples)
        self._target = context.framebuffer(
            [context.renderbuffer(self._size, 4, samples=samples)],
            context.depth_renderbuffer(self._size, samples=samples),
        )
        self._resolved = context.framebuffer([context.renderbuffer(self._size, 4)])
        self._texture = self._upload_texture(mesh.texture)
        self._moving = context.buffer(reserve=mesh.vertices.size * 16, dynamic=True)
        self._uvs = context.buffer(mesh.uvs.tobytes())
        self._indices = context.buffer(mesh.triangles.tobytes())
        self._light = VertexLight(mesh, view)
        self._drawn = {
            material: self._make_array(SURFACES[material], view)
            for material in {part.material_name for part in mesh.parts}
        }
        self._backdrop = self._make_backdrop()

    def _make_array(self, surface: Surface, view: View | Camera) -> moderngl.VertexArray:
        """The mesh's buffers under the program for `surface`."""
        sharp = surface.highlight is not None
        program = self._context.program(
            vertex_shader=_VERTEX, fragment_shader=_EYE_FRAGMENT if sharp else _FRAGMENT
        )
        matrix = camera_of(view).matrix(self._size[0] / self._size[1])
        _set(program, camera=tuple(matrix.T.ravel().tolist()))
        moving = [self._moving, "3f 3f 3f 3f", "position", "normal", "light", "shine"]
        if surface.highlight is not None:
            _set(
                program,
                eye=camera_of(view).eye,
                color=LIGHTS[0].color,
                gloss=surface.gloss,
                power=surface.power,
                highlight=unit(surface.highlight),
            )
        else:
            moving[1:] = ["3f 12x 3f 3f", "position", "light", "shine"]
        return self._context.vertex_array(
            program, [tuple(moving), (self._uvs, "2f", "uv")], self._indices
        )

    def _upload_texture(self, pixels: NDArray[np.uint8]) -> moderngl.Texture:
        height, width = pixels.shape[:2]
        texture = self._context.texture((width, height), 3, pixels.tobytes(), alignment=1)
        texture.build_mipmaps(max_level=MIP_LEVELS)
        texture.filter = (self._context.LINEAR_MIPMAP_LINEAR, self._context.LINEAR)
        texture.repeat_x = texture.repeat_y = False
        return texture

    def _make_backdrop(self) -> moderngl.VertexArray:
        program = self._context.program(
            vertex_shader=_BACKDROP_VERTEX, fragment_shader=_BACKDROP_FRAGMENT
        )
        program["backdrop"] = 1  # the second texture
        pixels = np.rint(encode(background(*self._size)) * 255).astype(np.uint8)[::-1]
        self._scene = self._context.texture(self._size, 3, pixels.tobytes(), alignment=1)
        self._scene.use(1)
        corners = np.array([-1, -1, 3, -1, -1, 3], np.float32)
        return self._context.vertex_array(
            program, [(self._context.buffer(corners.tobytes()), "2f", "corner")]
        )

    def paint(self, vertices: NDArray[np.float32]) -> NDArray[np.uint8]:
        """The picture (H, W, 3) of the posed `vertices` (V, 3)."""
        with self._context:  # another painter's may be current
            return self._paint(vertices)

    def _paint(self, vertices: NDArray[np.float32]) -> NDArray[np.uint8]:
        normals = self._mesh.normals(vertices)
        light = self._light.fall(vertices, normals)
        self._moving.write(np.concatenate([vertices, normals, light], axis=1).tobytes())
        self._target.use()
        self._context.enable(self._context.DEPTH_TEST)
        self._target.clear(depth=1.0)
        self._texture.use()
        for part in self._mesh.parts:
            if part.material.double_sided:
                self._context.disable(self._context.CULL_FACE)
            else:
                self._context.enable(self._context.CULL_FACE)
            first, last = part.triangles.start, part.triangles.stop
            self._drawn[part.material_name].render(vertices=3 * (last - first), first=3 * first)
        self._context.disable(self._context.CULL_FACE)
        self._backdrop.render()
        self._context.copy_framebuffer(self._resolved, self._target)
        width, height = self._size
        data = np.frombuffer(self._resolved.read(components=3, alignment=1), np.uint8)
        return np.ascontiguousarray(data.reshape(height, width, 3)[::-1])

    def close(self) -> None:
        """Give the context back."""
        self._context.release()


def _set(program: moderngl.Program, **uniforms: object) -> None:
    """Set the uniforms by their names."""
    for name, value in uniforms.items():
        program[name] = value
