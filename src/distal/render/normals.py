"""Normals of a field: exact, or by finite differences.

Input: a field and a point. Output: a unit vector, never NaN.
"""

from __future__ import annotations

from distal.ir.limits import ORDINARY
from distal.lang import (
    Field3,
    abs,
    clamp,
    dot,
    func,
    gradient,
    inversesqrt,
    max,
    select,
    vec2,
    vec3,
)

# The methods; the choice is a constant at compile time.
EXACT = 0  # the field's own derivative
SIX_TAPS = 1  # central differences: six evaluations
TETRAHEDRON = 2  # four evaluations, almost as precise
FORWARD = 3  # forward differences, for water and for speed: three evaluations and one at the point


@func
def unit_or_up(v: vec3) -> vec3:
    """Return the vector scaled to length 1; the unit vector up if it has no direction."""
    held = clamp(v, -ORDINARY, ORDINARY)  # larger slopes have no squares in 32 bits
    squared = dot(held, held)
    return select(squared > 1e-30, held * inversesqrt(max(squared, 1e-30)), vec3(0.0, 1.0, 0.0))


@func
def tangent(n: vec3) -> vec3:
    """Return a unit vector at right angles to a unit vector, continuous but for straight down.

    Source: Jeppe Revall Frisvad, "Building an Orthonormal Basis from a 3D Unit Vector Without
        Normalization" (2012).
    """
    # 1 / (1 + n.y), without the cancellation next to straight down.
    flat = max(n.x * n.x + n.z * n.z, 1e-20)
    a = select(n.y < 0.0, (1.0 - n.y) / flat, 1.0 / (1.0 + abs(n.y)))
    return vec3(1.0 - n.x * n.x * a, -n.x, -n.x * n.z * a)


@func
def exact_normal(distance: Field3, p: vec3) -> vec3:
    """Return the normal by the field's derivative."""
    return unit_or_up(gradient(distance, p))


@func
def six_tap_normal(distance: Field3, p: vec3, step: float = 1e-3) -> vec3:
    """Return the normal by central differences."""
    total = vec3(0.0)
    for axis in range(3):
        way = vec3(0.0)
        way[axis] = step
        total[axis] = distance(p + way) - distance(p - way)
    return unit_or_up(total)


@func
def tetrahedron_normal(distance: Field3, p: vec3, step: float = 1e-3) -> vec3:
    """Return the normal by evaluating the field at the four corners of a tetrahedron.

    Source: Paul Malin's and Inigo Quilez's, "Normals for an SDF"
        (https://iquilezles.org/articles/normalsSDF/).
    """
    corners = [
        vec3(1.0, -1.0, -1.0),
        vec3(-1.0, -1.0, 1.0),
        vec3(-1.0, 1.0, -1.0),
        vec3(1.0, 1.0, 1.0),
    ]
    total = vec3(0.0)
    for corner in corners:
        total += corner * distance(p + corner * step)
    return unit_or_up(total)


@func
def forward_normal(distance: Field3, p: vec3, step: float = 1e-3) -> vec3:
    """Return the normal by forward differences."""
    e = vec2(step, 0.0)
    beyond = vec3(distance(p + e.xyy), distance(p + e.yxy), distance(p + e.yyx))
    return unit_or_up(beyond - distance(p))


@func
def normal(distance: Field3, p: vec3, kind: int, step: float) -> vec3:
    """Return the unit normal at a point.

    Args:
        distance: Field.
        p: Point.
        kind: EXACT, SIX_TAPS, TETRAHEDRON or FORWARD.
        step: Step of the differences, in scene units.
    """
    if kind == SIX_TAPS:
        return six_tap_normal(distance, p, step)
    if kind == TETRAHEDRON:
        return tetrahedron_normal(distance, p, step)
    if kind == FORWARD:
        return forward_normal(distance, p, step)
    return exact_normal(distance, p)
