"""How triangles of a mesh are shown in a notebook, as scene code: their places and their light.

Input: corners of triangles in a box whose largest side is 1, and how a person moved the camera.
Output: places in the picture, display values. The camera and the lights are those of the look
"studio"; the lights turn with the camera about the vertical axis, so each side is lit alike. There
are no shadows. ``web/src/mesh/`` calls ``seen_corner`` and ``seen_color`` in WebGL.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

from distal.fields.place.solid import axis_matrix
from distal.lang import (
    dot,
    func,
    length,
    max,
    min,
    normalize,
    sin,
    struct,
    tan,
    vec2,
    vec3,
    vec4,
)
from distal.render.ambient import hemisphere_light
from distal.render.backdrops import towards
from distal.render.camera import basis_turned
from distal.render.lights import LightSample, distant_light
from distal.render.steer import Lens, Steer, moved_eye, rotation
from distal.render.tonemap import NAMES, decode_srgb, display
from distal.scene.looks.rows import ROWS

LOOK: Final = ROWS["studio"]
NUMBERS: Final[Mapping[str, Any]] = LOOK.numbers
UP = vec3(0.0, 1.0, 0.0)

AZIMUTH: Final = NUMBERS["azimuth"]
ELEVATION: Final = NUMBERS["elevation"]
OPENING: Final = math.radians(NUMBERS["fov_deg"])
EXPOSURE: Final = NUMBERS["exposure"]
TONE_MAP: Final = NAMES.index(LOOK.tone_map)
MAIN_AZIMUTH: Final = AZIMUTH + NUMBERS["light_azimuth"]
MAIN_ELEVATION: Final = NUMBERS["light_elevation"]
MAIN_INTENSITY: Final = NUMBERS["light_intensity"]
MAIN_COLOR: Final = NUMBERS["light_color"]
RIM_AZIMUTH: Final = AZIMUTH + NUMBERS["rim_azimuth"]
RIM_ELEVATION: Final = NUMBERS["rim_elevation"]
RIM_INTENSITY: Final = NUMBERS["rim_intensity"]
RIM_COLOR: Final = NUMBERS["rim_color"]
FILL: Final = NUMBERS["fill"]
SKY: Final = NUMBERS["sky"]
GROUND: Final = NUMBERS["ground"]
# A mesh without colors has the color of shapes without paint.
MATERIAL: Final = NUMBERS["material"]
# The nearest depth that is shown, as a share of the radius of the box.
NEAREST: Final = 0.01


@struct
class SeenCorner:
    """A corner of a triangle in the picture.

    Attributes:
        place: Its place and depth, homogeneous: -1 to 1 where it is seen.
        normal: Its normal, turned back by as much as the camera has turned about the y axis.
    """

    place: vec4
    normal: vec3


@func
def seen_corner(
    p: vec3, n: vec3, size: vec3, yaw: float, pitch: float, zoom: float, pan: vec2, aspect: float
) -> SeenCorner:
    """Return where a corner of a triangle is seen.

    Args:
        p: The corner, from the lowest corner of the box.
        n: Its normal.
        size: The size of the box; its largest side is 1.
        yaw: As for ``Steer``, like the three following ones.
        pitch: Upwards, in radians.
        zoom: Factor on the distance.
        pan: In half heights of the picture.
        aspect: Width of the picture divided by its height.
    """
    middle = 0.5 * size
    radius = length(middle)
    # A picture that is higher than wide shows as much as a square one.
    focal = min(aspect, 1.0) / tan(0.5 * OPENING)
    # The ball around the box fills the picture, so nothing leaves it while the mesh turns.
    still = basis_turned(AZIMUTH, -ELEVATION, 0.0)
    away = radius / sin(0.5 * OPENING)
    half = away / focal
    view = Lens(
        middle - still.ahead * away,
        still.ahead,
        middle,
        away,
        still.right * half,
        still.up * half,
        UP,
        1.0,
        0.0,
        1.0 / focal,
        OPENING,
    )
    turn = rotation(view, yaw, pitch)
    eye = moved_eye(view, Steer(yaw, pitch, zoom, pan))
    way = p - eye
    depth = dot(way, turn @ still.ahead)
    # The range of depths is that of the ball around the box.
    center = dot(middle - eye, turn @ still.ahead)
    near = max(center - 1.01 * radius, NEAREST * radius)
    far = max(center + 1.01 * radius, 2.0 * near)
    right = dot(way, turn @ still.right) * focal / aspect
    up = dot(way, turn @ still.up) * focal
    height = (depth * (far + near) - 2.0 * far * near) / (far - near)
    turned = axis_matrix(UP, -yaw) @ n
    return SeenCorner(vec4(right, up, height, depth), turned)


@func
def received(light: LightSample, n: vec3) -> vec3:
    """Return the light of a source on a white matte surface."""
    return light.radiance * max(dot(n, light.direction), 0.0)


@func
def seen_color(normal: vec3, code: vec3) -> vec4:
    """Return the display values of a matte surface.

    Args:
        normal: As in ``SeenCorner``, of any length.
        code: The color of the surface, encoded by sRGB's curve.
    """
    n = normalize(normal)
    main = distant_light(n, towards(MAIN_AZIMUTH, MAIN_ELEVATION), MAIN_INTENSITY, MAIN_COLOR)
    rim = distant_light(n, towards(RIM_AZIMUTH, RIM_ELEVATION), RIM_INTENSITY, RIM_COLOR)
    light = received(main, n) + received(rim, n) + hemisphere_light(n, SKY, GROUND, FILL)
    return display(vec4(decode_srgb(code) * light, 1.0), EXPOSURE, TONE_MAP)
