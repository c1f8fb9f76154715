"""Camera movement by a person: orbit around the target, zoom, pan.

Input: the rays of any camera, and five numbers: how far a person orbited, dragged and zoomed.
Output: the rays of the moved camera. Windows and pages keep the five numbers and do not depend on
cameras; ``guide`` keeps the numbers where the camera sees something.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import ENDLESS, Bounds
from distal.fields.place.solid import axis_matrix
from distal.lang import (
    asin,
    atan2,
    clamp,
    cross,
    dot,
    func,
    length,
    mat3,
    max,
    normalize,
    select,
    struct,
    vec2,
    vec3,
)
from distal.render.camera import Ray

# Distance from the middle of the picture at which right and up are measured.
_ASIDE = 0.05
# A pivot is at least so far ahead: as a part of its distance from the eye; of a camera without a
# target, as a part of the view's scale.
_LEAST = 1e-3
_LEAST_OF_VIEW = 0.1
USUAL = 5.0


@struct
class Rig:
    """The motion of a camera: a rotation and scaling about a pivot, then a translation.

    Attributes:
        pivot: The point that the camera turns around.
        moved: The pivot after the translation.
        turn: The rotation.
        zoom: Factor on distances from the pivot.
    """

    pivot: vec3
    moved: vec3
    turn: mat3
    zoom: float


@struct
class Steer:
    """The five numbers by which a person moved a camera, as ``scene/steering.py`` declares them."""

    yaw: float
    pitch: float
    zoom: float
    pan: vec2


@struct
class Lens:
    """What a movement has to know of the author's camera.

    Attributes:
        eye: Where the ray in the middle of the picture starts.
        ahead: Its direction.
        pivot: The point that the camera turns around.
        depth: Distance of the pivot along ``ahead``.
        across: How far the right edge of a square picture is from its middle, at that depth.
        upward: How far the upper edge is from the middle, at that depth.
        axis: The unit axis of horizontal turns.
        side: -1 if the camera swaps right and left, else 1.
        spread: How far the starts of rays are apart, per unit of the picture; 0 in perspective.
        tangent: How far apart rays are at distance 1, per unit of the picture, less ``spread``;
            0 without perspective.
        opening: The angle from the picture's bottom to its top, in radians.
    """

    eye: vec3
    ahead: vec3
    pivot: vec3
    depth: float
    across: vec3
    upward: vec3
    axis: vec3
    side: float
    spread: float
    tangent: float
    opening: float


@func
def in_depth(ray: Ray, eye: Ray, depth: float) -> vec3:
    """Return where a ray meets the plane that faces the camera, ``depth`` ahead of it."""
    ahead = eye.origin + eye.direction * depth - ray.origin
    share = dot(ahead, eye.direction) / dot(ray.direction, eye.direction)
    return ray.origin + ray.direction * share


@func
def middle_of(bounds: Bounds) -> vec3:
    """Return the middle of a box; 0 along an axis on which it is infinite."""
    return select(bounds.high - bounds.low < ENDLESS, 0.5 * (bounds.low + bounds.high), 0.0)


@func
def scale_of(bounds: Bounds, eye: vec3) -> float:
    """Return the length by which a view is measured: the eye's distance from a box, or its size.

    The larger of both, where the box is finite; if neither says anything, ``USUAL``.
    """
    sides = bounds.high - bounds.low
    size = length(select(sides < ENDLESS, max(sides, 0.0), 0.0))
    scale = max(size, length(middle_of(bounds) - eye))
    return select(scale > 0.0, scale, USUAL)


@func
def pivot_within(bounds: Bounds, camera: Callable[[vec2], Ray]) -> vec3:
    """Return the pivot of a camera without a target: on its axis, nearest to the box's middle."""
    eye = camera(vec2(0.0))
    ahead = dot(middle_of(bounds) - eye.origin, eye.direction)
    return eye.origin + eye.direction * max(ahead, _LEAST_OF_VIEW * scale_of(bounds, eye.origin))


@func
def lens(camera: Callable[[vec2], Ray], pivot: vec3, up: vec3) -> Lens:
    """Return what a movement has to know of a camera.

    Args:
        camera: The ray of a place in the picture.
        pivot: The point that it turns around.
        up: The axis of horizontal turns.
    """
    eye = camera(vec2(0.0))
    aside = camera(vec2(0.0, _ASIDE))
    away = length(pivot - eye.origin)
    depth = max(dot(pivot - eye.origin, eye.direction), select(away > 0.0, _LEAST * away, 1.0))
    middle = eye.origin + eye.direction * depth
    across = (in_depth(camera(vec2(_ASIDE, 0.0)), eye, depth) - middle) / _ASIDE
    upward = (in_depth(aside, eye, depth) - middle) / _ASIDE
    axis = normalize(up)
    # A mirrored camera swaps right and left; the eye still follows the hand.
    side = select(dot(cross(eye.direction, axis), across) < 0.0, -1.0, 1.0)
    spread = length(aside.origin - eye.origin) / _ASIDE
    opened = aside.direction / dot(aside.direction, eye.direction) - eye.direction
    top = camera(vec2(0.0, 1.0)).direction
    half_opening = atan2(length(cross(top, eye.direction)), dot(top, eye.direction))
    return Lens(
        eye.origin,
        eye.direction,
        pivot,
        depth,
        across,
        upward,
        axis,
        side,
        spread,
        length(opened) / _ASIDE,
        2.0 * half_opening,
    )


@func
def rotation(lens: Lens, yaw: float, pitch: float) -> mat3:
    """Return the rotation of a camera that was turned by two angles."""
    raised = axis_matrix(normalize(lens.across) * lens.side, -pitch)
    return axis_matrix(lens.axis, yaw * lens.side) @ raised


@func
def rig(lens: Lens, steer: Steer) -> Rig:
    """Return the motion of a camera that was moved by five numbers."""
    turn = rotation(lens, steer.yaw, steer.pitch)
    dragged = lens.across * steer.pan.x + lens.upward * steer.pan.y
    return Rig(lens.pivot, lens.pivot - turn @ dragged * steer.zoom, turn, steer.zoom)


@func
def moved_eye(lens: Lens, steer: Steer) -> vec3:
    """Return where the eye is after the camera has moved."""
    motion = rig(lens, steer)
    return motion.moved + motion.turn @ ((lens.eye - motion.pivot) * motion.zoom)


@func
def steered_ray(uv: vec2, camera: Callable[[vec2], Ray], rig: Rig) -> Ray:
    """Return the ray of a place in the picture after the camera has moved."""
    ray = camera(uv)
    origin = rig.moved + rig.turn @ ((ray.origin - rig.pivot) * rig.zoom)
    return Ray(origin, rig.turn @ ray.direction)


@func
def elevation(camera: Callable[[vec2], Ray], up: vec3) -> float:
    """Return the angle of a camera above its target, in radians."""
    return -asin(clamp(dot(camera(vec2(0.0)).direction, normalize(up)), -1.0, 1.0))
