"""Cameras: the ray that a place in the picture looks along.

Input: ``uv``, -1 to 1 from the bottom to the top of the picture and by the same unit from
left to right, and the numbers of a camera. Output: a ``Ray``. Right-handed, y up; a camera
that is not turned looks along -z. ``mirror`` swaps left and right, as in left-handed systems.
"""

from __future__ import annotations

from distal.lang import (
    abs,
    atan2,
    cos,
    cross,
    dot,
    func,
    inversesqrt,
    length,
    max,
    min,
    normalize,
    select,
    sin,
    struct,
    tan,
    vec2,
    vec3,
)

PI = 3.14159265358979
ORIGIN = vec3(0.0)
UP = vec3(0.0, 1.0, 0.0)
START = vec3(0.0, 0.0, 5.0)


@struct
class Ray:
    """A half-line; the direction has length 1."""

    origin: vec3
    direction: vec3


@struct
class Basis:
    """Three unit vectors at right angles: where right, up and ahead are for a camera."""

    right: vec3
    up: vec3
    ahead: vec3


@func
def mirrored(uv: vec2, mirror: bool) -> vec2:
    """The place in the picture, left and right swapped where asked."""
    return select(mirror, vec2(-uv.x, uv.y), uv)


@func
def basis_ahead(ahead: vec3, up: vec3) -> Basis:
    """The basis that looks ``ahead`` with ``up`` upright in the picture."""
    unit = normalize(ahead)
    right = normalize(cross(unit, up))
    return Basis(right, cross(right, unit), unit)


@func
def basis_turned(yaw: float, pitch: float, roll: float) -> Basis:
    """The basis looking along -z, rolled, then pitched up, then turned left by ``yaw``."""
    ahead = vec3(-sin(yaw) * cos(pitch), sin(pitch), -cos(yaw) * cos(pitch))
    level = vec3(cos(yaw), 0.0, -sin(yaw))
    upright = cross(level, ahead)
    right = cos(roll) * level + sin(roll) * upright
    return Basis(right, cross(right, ahead), ahead)


@func
def through_screen(uv: vec2, position: vec3, basis: Basis, focal: float) -> Ray:
    """Perspective: through a screen of half height 1 that stands ``focal`` ahead."""
    direction = basis.right * uv.x + basis.up * uv.y + basis.ahead * focal
    return Ray(position, normalize(direction))


@func
def look_at(
    uv: vec2,
    position: vec3 = START,
    target: vec3 = ORIGIN,
    up: vec3 = UP,
    fov: float = 0.7,
    mirror: bool = False,
) -> Ray:
    """Perspective, from one place at another.

    Args:
        uv: Place in the picture.
        position: Where the camera is.
        target: What it looks at; not the position.
        up: Which way is up in the picture; not along the view.
        fov: Angle from the bottom to the top of the picture, below pi.
        mirror: Swap left and right.
    """
    focal = 1.0 / tan(0.5 * fov)
    return through_screen(mirrored(uv, mirror), position, basis_ahead(target - position, up), focal)


@func
def turned(
    uv: vec2,
    position: vec3 = START,
    yaw: float = 0.0,
    pitch: float = 0.0,
    roll: float = 0.0,
    screen_height: float = 1.0,
    screen_distance: float = 1.0,
    mirror: bool = False,
) -> Ray:
    """Perspective, turned by angles, the picture a screen of a physical size.

    Args:
        uv: Place in the picture.
        position: Where the eye is.
        yaw: Turn to the left about the upright axis.
        pitch: Turn upwards.
        roll: Turn of the camera about its view, counterclockwise as it sees it.
        screen_height: Height of the screen.
        screen_distance: From the eye to the screen.
        mirror: Swap left and right.
    """
    focal = 2.0 * screen_distance / screen_height
    return through_screen(mirrored(uv, mirror), position, basis_turned(yaw, pitch, roll), focal)


@func
def orbit(
    uv: vec2,
    distance: float = 5.0,
    azimuth: float = 0.0,
    elevation: float = 0.0,
    target: vec3 = ORIGIN,
    fov: float = 0.7,
    mirror: bool = False,
) -> Ray:
    """Perspective, on a ball around a target.

    Args:
        uv: Place in the picture.
        distance: From the target.
        azimuth: Around the upright axis; 0 stands on +z, a quarter turn on +x.
        elevation: Above the horizon; straight above is allowed.
        target: What it looks at.
        fov: Angle from the bottom to the top of the picture, below pi.
        mirror: Swap left and right.
    """
    basis = basis_turned(azimuth, -elevation, 0.0)
    focal = 1.0 / tan(0.5 * fov)
    return through_screen(mirrored(uv, mirror), target - basis.ahead * distance, basis, focal)


@func
def orthographic(
    uv: vec2,
    position: vec3 = START,
    target: vec3 = ORIGIN,
    up: vec3 = UP,
    height: float = 4.0,
    mirror: bool = False,
) -> Ray:
    """All rays side by side: no perspective.

    Args:
        uv: Place in the picture.
        position: Middle of the plane that the rays start on.
        target: What it looks at.
        up: Which way is up in the picture.
        height: How much of space the picture shows from bottom to top.
        mirror: Swap left and right.
    """
    basis = basis_ahead(target - position, up)
    place = mirrored(uv, mirror) * (0.5 * height)
    return Ray(position + basis.right * place.x + basis.up * place.y, basis.ahead)


@func
def fisheye(
    uv: vec2,
    position: vec3 = START,
    target: vec3 = ORIGIN,
    up: vec3 = UP,
    fov: float = PI,
    mirror: bool = False,
) -> Ray:
    """Equidistant fisheye: the angle from the view grows evenly from the middle outwards.

    Args:
        uv: Place in the picture.
        position: Where the camera is.
        target: What it looks at.
        up: Which way is up in the picture.
        fov: Angle from the bottom to the top of the picture, up to a full turn.
        mirror: Swap left and right.
    """
    basis = basis_ahead(target - position, up)
    place = mirrored(uv, mirror)
    squared = dot(place, place)
    angle = min(0.5 * fov * length(place), PI)
    sideways = (basis.right * place.x + basis.up * place.y) * inversesqrt(max(squared, 1e-20))
    return Ray(position, normalize(basis.ahead * cos(angle) + sideways * sin(angle)))


@func
def panorama(
    uv: vec2,
    position: vec3 = START,
    target: vec3 = ORIGIN,
    up: vec3 = UP,
    mirror: bool = False,
) -> Ray:
    """The whole surroundings, equirectangular: a picture twice as wide as high shows all.

    Args:
        uv: Place in the picture.
        position: Where the camera is.
        target: What the middle of the picture looks at.
        up: Which way is up in the picture.
        mirror: Swap left and right.
    """
    basis = basis_ahead(target - position, up)
    angles = mirrored(uv, mirror) * (0.5 * PI)
    level = basis.right * sin(angles.x) + basis.ahead * cos(angles.x)
    return Ray(position, normalize(level * cos(angles.y) + basis.up * sin(angles.y)))


@func
def equirectangular(direction: vec3) -> vec2:
    """Where a unit direction lies on a panorama, (0, 0) to (1, 1); -z is in the middle."""
    across = atan2(direction.x, -direction.z) / (2.0 * PI) + 0.5
    level = length(direction.xz)
    return vec2(across, atan2(direction.y, level) / PI + 0.5)


@func
def pixel_angle(fov: float, height: float) -> float:
    """How wide one of ``height`` pixels is, at distance 1 in the middle of the picture."""
    return 2.0 * abs(tan(0.5 * fov)) / height
