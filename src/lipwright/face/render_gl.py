"""Pictures of the head by OpenGL, without a window."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from lipwright.face.head import Head
from lipwright.face.shading import BACKGROUND, CAMERAS, GROUND, LIGHTS, SKY, SURFACES, View, unit

if TYPE_CHECKING:
    import moderngl

SAMPLES: Final = 4  # of a pixel's edge coverage

_VERTEX: Final = """
#version 330
uniform mat4 camera;
in vec3 position; in vec3 normal; in vec3 tint; in vec2 uv;
out vec3 place; out vec3 facing; out vec3 tone; out vec2 spot;
void main() {
    gl_Position = camera * vec4(position, 1.0);
    place = position; facing = normal; tone = tint; spot = uv;
}
"""

_ENCODE: Final = """
vec3 encode(vec3 light) {
    light = clamp(light, 0.0, 1.0);
    return mix(light * 12.92, 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055,
               step(0.0031308, light));
}
"""

_FRAGMENT: Final = """
#version 330
uniform sampler2D skin;
uniform vec3 eye; uniform vec3 towards[3]; uniform vec3 colors[3];
uniform vec3 sky; uniform vec3 ground;
uniform vec3 wrap; uniform float gloss; uniform float power; uniform vec3 highlight;
in vec3 place; in vec3 facing; in vec3 tone; in vec2 spot;
out vec4 pixel;
ENCODE
void main() {
    vec3 n = normalize(facing);
    vec3 v = normalize(eye - place);
    if (dot(n, v) < 0.0) n = n - 2.0 * dot(n, v) * v;
    vec3 light = mix(ground, sky, 0.5 + 0.5 * n.y);
    for (int i = 0; i < 3; i++)
        light += colors[i] * max((dot(n, towards[i]) + wrap) / (1.0 + wrap), 0.0);
    vec3 shine = colors[0] * gloss * pow(max(dot(n, normalize(v + highlight)), 0.0), power);
    vec3 coded = texture(skin, spot).rgb;
    vec3 albedo = coded * (coded * (coded * 0.3053 + 0.6822) + 0.0125) * tone;
    pixel = vec4(encode(albedo * light + shine * min(4.0 * tone.r, 1.0)), 1.0);
}
""".replace("ENCODE", _ENCODE)

_BACKDROP_VERTEX: Final = """
#version 330
in vec2 corner;
void main() { gl_Position = vec4(corner, 0.999999, 1.0); }
"""

_BACKDROP_FRAGMENT: Final = """
#version 330
uniform vec2 size; uniform vec3 middle; uniform vec3 corners;
out vec4 pixel;
ENCODE
void main() {
    vec2 at = vec2(gl_FragCoord.x, size.y - gl_FragCoord.y) / size - vec2(0.5, 0.45);
    pixel = vec4(encode(mix(middle, corners, smoothstep(0.0, 0.72, length(at)))), 1.0);
}
""".replace("ENCODE", _ENCODE)


class GlPainter:
    """Draws posed heads with OpenGL 3.3 on EGL.

    Raises:
        ImportError: moderngl is not installed.
        Exception: there is no working EGL or OpenGL; the kind depends on the driver.
    """

    def __init__(self, head: Head, width: int, height: int, view: View) -> None:
        """Create the context and upload what does not change."""
        import moderngl

        self._head = head
        self._size = (width, height)
        self._context = moderngl.create_context(standalone=True, backend="egl", require=330)
        context = self._context
        samples = min(SAMPLES, context.max_samples)
        self._target = context.framebuffer(
            [context.renderbuffer(self._size, 4, samples=samples)],
            context.depth_renderbuffer(self._size, samples=samples),
        )
        self._resolved = context.framebuffer([context.renderbuffer(self._size, 4)])
        self._program = context.program(vertex_shader=_VERTEX, fragment_shader=_FRAGMENT)
        self._texture = self._upload_texture(head.texture)
        self._moving = context.buffer(reserve=head.vertices.size * 8, dynamic=True)
        fixed = np.concatenate([head.tints, head.uvs], axis=1).astype(np.float32)
        self._mesh = context.vertex_array(
            self._program,
            [
                (self._moving, "3f 3f", "position", "normal"),
                (context.buffer(fixed.tobytes()), "3f 2f", "tint", "uv"),
            ],
            context.buffer(head.triangles.tobytes()),
        )
        self._backdrop = self._make_backdrop()
        self._light(view)

    def _upload_texture(self, pixels: NDArray[np.uint8]) -> moderngl.Texture:
        height, width = pixels.shape[:2]
        texture = self._context.texture((width, height), 3, pixels.tobytes(), alignment=1)
        texture.build_mipmaps()
        texture.filter = (self._context.LINEAR_MIPMAP_LINEAR, self._context.LINEAR)
        texture.repeat_x = texture.repeat_y = False
        return texture

    def _make_backdrop(self) -> moderngl.VertexArray:
        program = self._context.program(
            vertex_shader=_BACKDROP_VERTEX, fragment_shader=_BACKDROP_FRAGMENT
        )
        _set(program, size=self._size, middle=BACKGROUND[0], corners=BACKGROUND[1])
        corners = np.array([-1, -1, 3, -1, -1, 3], np.float32)
        return self._context.vertex_array(
            program, [(self._context.buffer(corners.tobytes()), "2f", "corner")]
        )

    def _light(self, view: View) -> None:
        camera = CAMERAS[view]
        matrix = camera.matrix(self._size[0] / self._size[1])
        self._program["camera"].write(matrix.T.astype(np.float32).tobytes())
        _set(
            self._program,
            eye=camera.eye,
            towards=[unit(light.direction) for light in LIGHTS],
            colors=[light.color for light in LIGHTS],
            sky=SKY,
            ground=GROUND,
        )

    def paint(self, vertices: NDArray[np.float32]) -> NDArray[np.uint8]:
        """The picture (H, W, 3) of the posed `vertices` (V, 3)."""
        normals = self._head.normals(vertices)
        self._moving.write(np.concatenate([vertices, normals], axis=1).tobytes())
        self._target.use()
        self._context.enable(self._context.DEPTH_TEST)
        self._target.clear(depth=1.0)
        self._texture.use()
        for part in self._head.parts:
            surface = SURFACES[part.material_name]
            _set(
                self._program,
                wrap=surface.wrap,
                gloss=surface.gloss,
                power=surface.power,
                highlight=unit(surface.highlight or LIGHTS[0].direction),
            )
            first, last = part.triangles.start, part.triangles.stop
            self._mesh.render(vertices=3 * (last - first), first=3 * first)
        self._backdrop.render()
        self._context.copy_framebuffer(self._resolved, self._target)
        width, height = self._size
        data = np.frombuffer(self._resolved.read(components=3, alignment=1), np.uint8)
        return np.ascontiguousarray(data.reshape(height, width, 3)[::-1])

    def close(self) -> None:
        """Give the context back."""
        self._context.release()


def _set(program: moderngl.Program, **uniforms: Any) -> None:  # noqa: ANN401
    """Set the uniforms by their names."""
    for name, value in uniforms.items():
        program[name].value = value  # type: ignore[union-attr]
