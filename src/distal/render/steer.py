"""A camera moved by hand: around its target, nearer, sideways.

Input: the rays of any camera, and five numbers: how far a person orbited, dragged and zoomed.
Output: the rays of the moved camera. Windows and pages keep the five numbers and know no camera.
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
    """The motion of a camera: turned and scaled about a pivot, which is then moved.

    Attributes:
        pivot: What it turns around.
        moved: Where the pivot is afterwards.
        turn: The rotation.
        zoom: Factor on distances from the pivot.
    """

    pivot: vec3
    moved: vec3
    turn: mat3
    zoom: float


@func
def in_depth(ray: Ray, eye: Ray, depth: float) -> vec3:
    """Where a ray meets the plane that faces the camera, ``depth`` ahead of it."""
    ahead = eye.origin + eye.direction * depth - ray.origin
    share = dot(ahead, eye.direction) / dot(ray.direction, eye.direction)
    return ray.origin + ray.direction * share


@func
def pivot_within(bounds: Bounds, camera: Callable[[vec2], Ray]) -> vec3:
    """What a camera without a target turns around: the place in its view nearest to the middle.

    An axis along which the shapes have no end has its middle at 0.
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
    """How a camera moves.

    Args:
        camera: The ray of a place in the picture.
        pivot: What it turns around.
        up: The axis of its turns.
        yaw: How far the eye goes around the pivot, to the right as it sees it, in radians.
        pitch: How far it rises.
        zoom: Factor on its distance.
        pan: How far what is seen has been dragged in the picture; 1 is half the picture's height.
    """
    eye = camera(vec2(0.0))
    depth = max(dot(pivot - eye.origin, eye.direction), _LEAST)
    middle = eye.origin + eye.direction * depth
    across = (in_depth(camera(vec2(_ASIDE, 0.0)), eye, depth) - middle) / _ASIDE
    upward = (in_depth(camera(vec2(0.0, _ASIDE)), eye, depth) - middle) / _ASIDE
    axis = normalize(up)
    # Seen in a mirror, right is left: the eye still goes where the hand goes.
    side = select(dot(cross(eye.direction, axis), across) < 0.0, -1.0, 1.0)
    turn = axis_matrix(axis, yaw * side) @ axis_matrix(normalize(across) * side, -pitch)
    moved = pivot - turn @ (across * pan.x + upward * pan.y) * zoom
    return Rig(pivot, moved, turn, zoom)


@func
def steered_ray(uv: vec2, camera: Callable[[vec2], Ray], rig: Rig) -> Ray:
    """The ray of a place in the picture after the camera has moved."""
    ray = camera(uv)
    origin = rig.moved + rig.turn @ ((ray.origin - rig.pivot) * rig.zoom)
    return Ray(origin, rig.turn @ ray.direction)


@func
def elevation(camera: Callable[[vec2], Ray], up: vec3) -> float:
    """The angle by which a camera stands above what it looks at, in radians."""
    return -asin(clamp(dot(camera(vec2(0.0)).direction, normalize(up)), -1.0, 1.0))
