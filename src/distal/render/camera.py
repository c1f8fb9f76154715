"""Cameras: the ray through a place in the picture.

Input: ``uv``, where y is -1 to 1 from the bottom to the top of the picture and x has the same unit
from left to right, and the numbers of a camera. Output: a ``Ray``. Right-handed, y up; a camera
that is not turned looks along -z. ``mirrored`` swaps left and right, as in left-handed systems.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from distal.fields.guarantees import UNBOUNDED
from distal.lang import (
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
from distal.render.declarations import ExtraParameter, camera
from distal.render.sampling.warps import axes_about, on_disc

PI = 3.14159265358979
ORIGIN = vec3(0.0)
UP = vec3(0.0, 1.0, 0.0)
START = vec3(0.0, 0.0, 5.0)
AHEAD = vec3(0.0, 0.0, -1.0)
HALF_TURN = math.pi
OPENING = 40.0 * (math.pi / 180.0)
# If the sine of the angle between two directions is smaller, they span no plane in 32 bits.
PARALLEL = 1e-5
APERTURE = ExtraParameter(
    "aperture",
    0.0,
    "Number",
    "Diameter of the lens, in scene units; 0 for a pinhole, which shows everything sharp. What is "
    'in front of or behind the distance of focus is blurred; in mode "path" only.',
    keyword_only=True,
)
FOCUS_DISTANCE = ExtraParameter(
    "focus_distance",
    None,
    "Number | None",
    "The distance along the viewing direction at which everything is sharp, in scene units. None: "
    "that of the target.",
    keyword_only=True,
)
LENS = (APERTURE, FOCUS_DISTANCE)
IN_DEGREES = ExtraParameter(
    "fov_deg", None, "Number | None", "The same in degrees.", keyword_only=True
)


@struct
class Ray:
    """A half-line; the direction has length 1."""

    origin: vec3
    direction: vec3


@struct
class Basis:
    """Three orthogonal unit vectors: right, up and ahead of a camera."""

    right: vec3
    up: vec3
    ahead: vec3


@func
def sided(uv: vec2, mirrored: bool) -> vec2:
    """Swap left and right of a place in the picture if ``mirrored`` is true."""
    return select(mirrored, vec2(-uv.x, uv.y), uv)


@func
def basis_ahead(ahead: vec3, up: vec3) -> Basis:
    """Return the basis that looks along ``ahead``, with ``up`` upright in the picture."""
    unit = normalize(ahead)
    right = normalize(cross(unit, up))
    return Basis(right, cross(right, unit), unit)


@func
def basis_turned(yaw: float, pitch: float, roll: float) -> Basis:
    """Return a basis looking along -z, rolled, then pitched up, then turned left by ``yaw``."""
    ahead = vec3(-sin(yaw) * cos(pitch), sin(pitch), -cos(yaw) * cos(pitch))
    level = vec3(cos(yaw), 0.0, -sin(yaw))
    upright = cross(level, ahead)
    right = cos(roll) * level + sin(roll) * upright
    return Basis(right, cross(right, ahead), ahead)


@func
def through_screen(uv: vec2, position: vec3, basis: Basis, focal: float) -> Ray:
    """Return the perspective ray through a screen of half height 1 at distance ``focal``.

    Args:
        uv: Place in the picture.
        position: Position of the camera.
        basis: Its directions.
        focal: Distance of the screen.
    """
    direction = basis.right * uv.x + basis.up * uv.y + basis.ahead * focal
    return Ray(position, normalize(direction))


def _has_a_view(
    position: tuple[float, ...], target: tuple[float, ...], up: tuple[float, ...]
) -> str | None:
    """Return why the camera's directions are not defined; None if they are."""
    ahead = [t - p for t, p in zip(target, position, strict=True)]
    length = math.hypot(*ahead)
    if length == 0.0:
        return "position and target are the same place"
    if math.hypot(*up) == 0.0:
        return "up is a vector of zeros, which has no direction"
    (ax, ay, az), (ux, uy, uz) = ahead, up
    across = math.hypot(ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux)
    if across <= PARALLEL * length * math.hypot(*up):
        return "up points along the view; for a view straight down, give up=(0, 0, -1)"
    return None


@camera("Camera", requires=_has_a_view, extras=(IN_DEGREES, *LENS))
@func
def look_at(
    uv: vec2,
    position: vec3 = START,
    target: vec3 = ORIGIN,
    up: vec3 = UP,
    fov: float = OPENING,
    mirrored: bool = False,
) -> Ray:
    """A perspective camera at one point that looks at another.

    Args:
        uv: Place in the picture.
        position: Position of the camera.
        target: The point that it looks at.
        up: The direction that is up in the picture.
        fov: The angle from the picture's bottom to its top, in radians; below pi
            (default: 40 degrees).
        mirrored: Swap left and right, as in left-handed systems.
    """
    focal = 1.0 / tan(0.5 * fov)
    return through_screen(sided(uv, mirrored), position, basis_ahead(target - position, up), focal)


@func
def turned(
    uv: vec2,
    position: vec3 = START,
    yaw: float = 0.0,
    pitch: float = 0.0,
    roll: float = 0.0,
    screen_height: float = 1.0,
    screen_distance: float = 1.0,
    mirrored: bool = False,
) -> Ray:
    """A perspective camera turned by angles, whose screen has a physical size.

    Args:
        uv: Place in the picture.
        position: Position of the eye.
        yaw: Turn to the left about the upright axis, in radians.
        pitch: Turn upwards, in radians.
        roll: Turn about the viewing direction, counterclockwise as the camera sees it, in radians.
        screen_height: Height of the screen.
        screen_distance: Distance from the eye to the screen.
        mirrored: Swap left and right.
    """
    focal = 2.0 * screen_distance / screen_height
    return through_screen(sided(uv, mirrored), position, basis_turned(yaw, pitch, roll), focal)


def orbit_pose(
    camera: Any, distance: Any, azimuth: Any, elevation: Any, target: Any, **same: Any
) -> Any:
    """Return an orbit camera as a camera at a position.

    Args:
        camera: The class ``Camera``.
        distance: As of ``orbit``; the other angles and the target likewise.
        azimuth: Around the y axis.
        elevation: Up.
        target: The point that it looks at.
        same: The arguments that both have.
    """
    level = camera((0.0, 0.0, distance), **same).rotate(x=-elevation)
    return level.rotate(y=azimuth).translate(target)


@camera("OrbitCamera", pose=orbit_pose, extras=(IN_DEGREES, *LENS))
@func
def orbit(
    uv: vec2,
    distance: float = 5.0,
    azimuth: float = 0.0,
    elevation: float = 0.0,
    target: vec3 = ORIGIN,
    fov: float = OPENING,
    mirrored: bool = False,
) -> Ray:
    """A camera on a sphere around its target.

    Args:
        uv: Place in the picture.
        distance: From the target.
        azimuth: Around the y axis, in radians; 0 is on the side of +z, pi/2 on that of +x.
        elevation: Up, in radians; pi/2 is straight above.
        target: The point that it looks at.
        fov: The angle from the picture's bottom to its top, in radians; below pi
            (default: 40 degrees).
        mirrored: Swap left and right, as in left-handed systems.
    """
    basis = basis_turned(azimuth, -elevation, 0.0)
    focal = 1.0 / tan(0.5 * fov)
    return through_screen(sided(uv, mirrored), target - basis.ahead * distance, basis, focal)


@camera("OrthographicCamera", requires=_has_a_view)
@func
def orthographic(
    uv: vec2,
    position: vec3 = START,
    target: vec3 = ORIGIN,
    up: vec3 = UP,
    height: float = 4.0,
    mirrored: bool = False,
) -> Ray:
    """A camera without perspective: far objects appear as large as near ones.

    Args:
        uv: Place in the picture.
        position: The point in the middle of the picture; what lies behind it is not seen.
        target: The point that it looks at.
        up: The direction that is up in the picture.
        height: Height of the visible area, in scene units.
        mirrored: Swap left and right, as in left-handed systems.
    """
    basis = basis_ahead(target - position, up)
    place = sided(uv, mirrored) * (0.5 * height)
    return Ray(position + basis.right * place.x + basis.up * place.y, basis.ahead)


@camera("FisheyeCamera", requires=_has_a_view, extras=(IN_DEGREES,), widest=2.0 * math.pi)
@func
def fisheye(
    uv: vec2,
    position: vec3 = START,
    target: vec3 = ORIGIN,
    up: vec3 = UP,
    fov: float = HALF_TURN,
    mirrored: bool = False,
) -> Ray:
    """A camera that sees half of its surroundings, or more, in a circle.

    The angle from the viewing direction is proportional to the distance from the middle of the
    picture (equidistant).

    Args:
        uv: Place in the picture.
        position: Position of the camera.
        target: The point that it looks at.
        up: The direction that is up in the picture.
        fov: The angle from the picture's bottom to its top, in radians; up to 2 pi
            (default: 180 degrees).
        mirrored: Swap left and right, as in left-handed systems.
    """
    basis = basis_ahead(target - position, up)
    place = sided(uv, mirrored)
    squared = dot(place, place)
    angle = min(0.5 * fov * length(place), PI)
    sideways = (basis.right * place.x + basis.up * place.y) * inversesqrt(max(squared, 1e-20))
    return Ray(position, normalize(basis.ahead * cos(angle) + sideways * sin(angle)))


@camera("PanoramaCamera", requires=_has_a_view)
@func
def panorama(
    uv: vec2,
    position: vec3 = ORIGIN,
    target: vec3 = AHEAD,
    up: vec3 = UP,
    mirrored: bool = False,
) -> Ray:
    """A camera that sees all directions: longitude to the right, latitude up (equirectangular).

    A picture twice as wide as high shows everything.

    Args:
        uv: Place in the picture.
        position: Position of the camera.
        target: The point in the middle of the picture.
        up: The direction that is up in the picture.
        mirrored: Swap left and right, as in left-handed systems.
    """
    basis = basis_ahead(target - position, up)
    angles = sided(uv, mirrored) * (0.5 * PI)
    level = basis.right * sin(angles.x) + basis.ahead * cos(angles.x)
    return Ray(position, normalize(level * cos(angles.y) + basis.up * sin(angles.y)))


@func
def thin_lens(aperture: float = 0.0, focus_distance: float = UNBOUNDED) -> vec2:
    """Return the diameter of a lens and its distance of focus; unbounded for the target's."""
    return vec2(aperture, focus_distance)


@func
def through_lens(
    uv: vec2,
    camera: Callable[[vec2], Ray],
    still: Callable[[vec2], Ray],
    target: vec3,
    zoom: float,
    lens: vec2,
    u: vec2,
) -> Ray:
    """Return the ray of a place in the picture through a random place on the lens.

    The lens is a disc around the eye, across the viewing direction. Rays of one place in the
    picture meet in the plane of focus.

    Args:
        uv: Place in the picture.
        camera: The ray of a place in the picture, through the middle of the lens.
        still: The same before a person moved the camera.
        target: The point that it looks at.
        zoom: Factor by which a person moved away from what is in focus.
        lens: The value of ``thin_lens``.
        u: Two random numbers in [0, 1).

    Source: Robert Cook, Thomas Porter and Loren Carpenter, "Distributed Ray Tracing" (1984).
    """
    ray = camera(uv)
    axis = camera(vec2(0.0))
    eye = still(vec2(0.0))
    own = select(lens.y < UNBOUNDED, lens.y, dot(target - eye.origin, eye.direction))
    ahead = dot(ray.direction, axis.direction)
    sharp = ray.origin + ray.direction * (own * zoom / ahead)
    place = on_disc(u) * (0.5 * lens.x)
    axes = axes_about(axis.direction)
    origin = ray.origin + axes.s * place.x + axes.t * place.y
    return Ray(origin, normalize(sharp - origin))


@func
def equirectangular(direction: vec3) -> vec2:
    """Return the place of a unit direction on a panorama, (0, 0) to (1, 1); -z is in the middle."""
    across = atan2(direction.x, -direction.z) / (2.0 * PI) + 0.5
    level = length(direction.xz)
    return vec2(across, atan2(direction.y, level) / PI + 0.5)
