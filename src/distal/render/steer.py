"""Camera movement by a person: orbit around the target, zoom, pan.

Input: the rays of any camera, and five numbers: how far a person orbited, dragged and zoomed.
Output: the rays of the moved camera. Windows and pages keep the five numbers and do not depend on
cameras.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import Bounds
from distal.fields.place.solid import axis_matrix
from distal.lang import (
    abs,
    asin,
    clamp,
    cross,
    dot,
    func,
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
_LEAST = 1e-3
_FAR = 1e6


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


@func
def in_depth(ray: Ray, eye: Ray, depth: float) -> vec3:
    """Return where a ray meets the plane that faces the camera, ``depth`` ahead of it."""
    ahead = eye.origin + eye.direction * depth - ray.origin
    share = dot(ahead, eye.direction) / dot(ray.direction, eye.direction)
    return ray.origin + ray.direction * share


@func
def pivot_within(bounds: Bounds, camera: Callable[[vec2], Ray]) -> vec3:
    """Return the pivot of a camera without a target: on its axis, nearest to the box's middle.

    For an axis along which the box is infinite, the middle is 0.
    """
    low = bounds.low
    high = bounds.high
    middle = vec3(
        select(max(abs(low.x), abs(high.x)) < _FAR, 0.5 * (low.x + high.x), 0.0),
        select(max(abs(low.y), abs(high.y)) < _FAR, 0.5 * (low.y + high.y), 0.0),
        select(max(abs(low.z), abs(high.z)) < _FAR, 0.5 * (low.z + high.z), 0.0),
    )
    eye = camera(vec2(0.0))
    return eye.origin + eye.direction * max(dot(middle - eye.origin, eye.direction), 1.0)


@func
def rig(
    camera: Callable[[vec2], Ray],
    pivot: vec3,
    up: vec3,
    yaw: float,
    pitch: float,
    zoom: float,
    pan: vec2,
) -> Rig:
    """Return the motion of a camera.

    Args:
        camera: The ray of a place in the picture.
        pivot: The point that it turns around.
        up: The axis of horizontal turns.
        yaw: Angle of the orbit to the right, as the camera sees it, in radians.
        pitch: Angle of the orbit upwards, in radians.
        zoom: Factor on the distance from the pivot.
        pan: How far the picture was dragged; 1 is half the picture's height.
    """
    eye = camera(vec2(0.0))
    depth = max(dot(pivot - eye.origin, eye.direction), _LEAST)
    middle = eye.origin + eye.direction * depth
    across = (in_depth(camera(vec2(_ASIDE, 0.0)), eye, depth) - middle) / _ASIDE
    upward = (in_depth(camera(vec2(0.0, _ASIDE)), eye, depth) - middle) / _ASIDE
    axis = normalize(up)
    # A mirrored camera swaps right and left; the eye still follows the hand.
    side = select(dot(cross(eye.direction, axis), across) < 0.0, -1.0, 1.0)
    turn = axis_matrix(axis, yaw * side) @ axis_matrix(normalize(across) * side, -pitch)
    moved = pivot - turn @ (across * pan.x + upward * pan.y) * zoom
    return Rig(pivot, moved, turn, zoom)


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
