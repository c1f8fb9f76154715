"""The arithmetic of walls and gaps, as scene code: how far a line stays in a solid or a gap.

Input: a field and a place near its surface. Output: a place on the surface, the normal there and a
width. One row for each place; 64 bits.
"""

from __future__ import annotations

from distal.lang import Field3, dot, func, gradient, length, max, value_and_gradient, vec3
from distal.mesh.arithmetic import step_to_surface, unit_or_zero

# The most steps along a line. Each goes as far as the value allows; beside a surface that a line
# leaves at right angles, each step doubles the distance.
STEPS = 400
_BISECTIONS = 40
# Two faces are those of a wall or a gap if they are at most 30 degrees from parallel. Otherwise a
# corner of the shape would be a wall without thickness.
LEAST_COSINE = 0.866


@func
def width_at(
    field: Field3, p: vec3, side: float, slope: float, least: float, most: float
) -> tuple[float, vec3, vec3]:
    """Return how far a line along the normal goes until it meets the surface again.

    Args:
        field: The field.
        p: A point near the surface.
        side: -1 for the line into the solid, 1 for the line out of it.
        slope: A bound of the field's gradient.
        least: The first step and the shortest one; narrower places are not seen.
        most: Lines that go on for longer meet nothing.

    Returns:
        The width (``most`` if no surface is met that faces the first one; -1 if it cannot be
        measured here), the point on the surface, and the normal, which points outwards.
    """
    start = p
    for _step in range(4):
        value, slope_here = value_and_gradient(field, start)
        start = start + step_to_surface(value, slope_here)
    # On the surface the gradient of an exact field may be 0 or noise; beside it, it is not.
    normal = unit_or_zero(gradient(field, start + vec3(0.31, 0.59, 0.74) * least))
    way = normal * side
    inside = 0.0
    beyond = least
    value = side * field(start + way * beyond)
    # Where two solids touch, near their common edge, the start is inside.
    touches = side * field(start - way * least) > 0.0
    if not value > 0.0 or touches or length(normal) < 0.5:
        return -1.0, start, normal
    for _step in range(STEPS):
        inside = beyond
        beyond = beyond + max(value / slope, least)
        value = side * field(start + way * beyond)
        if not value > 0.0:
            # Faces that coincide are no surface: the line goes on behind them.
            behind = side * field(start + way * (beyond + least))
            value = behind if behind > 0.0 else value
            beyond = beyond + least if behind > 0.0 else beyond
        if not value > 0.0 or beyond > most:
            break
    if value > 0.0:
        return most if beyond > most else -1.0, start, normal
    for _step in range(_BISECTIONS):
        middle = 0.5 * (inside + beyond)
        if side * field(start + way * middle) > 0.0:
            inside = middle
        else:
            beyond = middle
    met = start + way * beyond
    facing = unit_or_zero(gradient(field, met + vec3(0.31, 0.59, 0.74) * least))
    opposite = -side * dot(facing, way) >= LEAST_COSINE
    return beyond if opposite else most, start, normal


@func
def across(normal: vec3, turn: vec3, size: float) -> vec3:
    """Return the part of a vector that is perpendicular to a normal, with a length."""
    return unit_or_zero(turn - normal * dot(turn, normal)) * size
