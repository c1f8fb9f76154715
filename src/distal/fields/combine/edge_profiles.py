"""Shaped edges: material added where two shapes meet, and cuts along their intersection.

Input: two distances, ``smooth``, the size of the edge, and for some a ``count`` of parts. Output:
the distance of the union (``blends`` makes the intersections and differences from it), or of the
shape made by pipes, engraving, grooves and tongues. Does not depend on points.

The sizes are exact where the surfaces meet at a right angle. The formulas are derived in the plane
whose axes are the two distances: a union's corner is its origin, the outside is the quadrant where
both are positive, and ``u`` and ``v`` are the distance from the corner along the diagonal and
across it.

Source: the operators of the hg_sdf library by Mercury (https://mercury.sexy/hg_sdf/); the formulas
are worked out anew from their geometry. Where a piece uses both distances at once the slope is that
of a length in this plane, sqrt(slope_a^2 + slope_b^2), reached where the gradients are parallel.
"""

from __future__ import annotations

from distal.fields.combine.smooth import SHARP, nearness, quadratic, quadratic_mix, share_of_second
from distal.lang import abs, clamp, func, length, max, min, round, vec2

SQRT_HALF = 0.7071067811865476
SQRT_2 = 1.4142135623730951


@func
def edge_mix(a: float, b: float, smooth: float) -> float:
    """Return the share of ``b`` across an edge of size ``smooth``: linear, 1/2 in the middle."""
    return share_of_second(a, b, 0.5 * nearness(a, b, max(smooth, SHARP)))


@func
def counted_edge_mix(a: float, b: float, smooth: float, count: int) -> float:
    """Return ``edge_mix`` for the edges made of ``count`` parts."""
    return edge_mix(a, b, smooth)


@func
def no_deeper(shaped: float, a: float, b: float, smooth: float) -> float:
    """Limit an edge's value from below, because inside its parts are steeper than the shapes.

    The surface is above this limit. With ``smooth = 0`` the union is the hard minimum.
    """
    return max(shaped, min(a, b) - smooth)


@func
def chamfer(a: float, b: float, smooth: float) -> float:
    """Return the union with a flat face across the corner, ``smooth`` along both surfaces."""
    return no_deeper(min(min(a, b), (a + b - smooth) * SQRT_HALF), a, b, smooth)


@func
def soft(a: float, b: float, smooth: float) -> float:
    """Return ``quadratic``; it has an effect where |a - b| < ``smooth``."""
    return quadratic(a, b, 0.25 * smooth)


@func
def soft_mix(a: float, b: float, smooth: float) -> float:
    """Return the share of ``b`` in ``soft``."""
    return quadratic_mix(a, b, 0.25 * smooth)


@func
def row_of_circles(u: float, v: float, radius: float, count: int) -> float:
    """Return the distance to ``count`` adjacent circles on the line u = 0, centred."""
    middle = 0.5 * (float(count) - 1.0)
    diameter = 2.0 * radius
    index = clamp(round(v / max(diameter, SHARP) + middle), 0.0, float(count) - 1.0)
    return length(vec2(u, v - (index - middle) * diameter)) - radius


@func
def columns(a: float, b: float, smooth: float, count: int) -> float:
    """Return the union with ``count`` round columns in the corner.

    The outer ones are half inside the surfaces.
    """
    u = (a + b) * SQRT_HALF
    v = (b - a) * SQRT_HALF
    radius = smooth * SQRT_HALF / (float(count) - 1.0 + SQRT_HALF)
    wall = u - radius * (float(count) - 1.0 - SQRT_HALF)
    pieces = min(wall, row_of_circles(wall, v, radius, count))
    return no_deeper(min(min(a, b), pieces), a, b, smooth)


@func
def columns_intersection(a: float, b: float, smooth: float, count: int) -> float:
    """Return the intersection whose edge is cut flat, with ``count`` round columns left.

    The outer ones are at the faces.
    """
    u = (a + b) * SQRT_HALF
    v = (b - a) * SQRT_HALF
    radius = smooth * SQRT_HALF / (float(count) - 1.0 + SQRT_2)
    wall = u + smooth * SQRT_HALF
    hard = max(a, b)
    pieces = min(wall, row_of_circles(wall, v, radius, count))
    return min(max(hard, pieces), hard + smooth)


@func
def stairs(a: float, b: float, smooth: float, count: int) -> float:
    """Return the union with ``count`` steps from one surface down to the other.

    A triangle wave rotated by 45 degrees is a staircase. Each piece depends on one distance only,
    so the slope does not grow.
    """
    step = max(smooth / float(count), SHARP)
    across = (b - smooth) - a + step
    wave = abs(across % (2.0 * step) - step)
    return min(min(a, b), 0.5 * ((b - smooth) + a + wave))


@func
def pipe(a: float, b: float, radius: float) -> float:
    """Return only a tube of this radius along the line where the two surfaces cross."""
    return length(vec2(a, b)) - radius


@func
def engrave(a: float, b: float, depth: float) -> float:
    """Return the first shape with a V-shaped cut, ``depth`` deep, along the second surface."""
    return max(a, (a + depth - abs(b)) * SQRT_HALF)


@func
def groove(a: float, b: float, depth: float, width: float) -> float:
    """Return the first shape with a rectangular cut along the second shape's surface.

    Args:
        a: The shape that is cut.
        b: The shape whose surface the cut follows.
        depth: Depth of the cut.
        width: Half the width of the cut: its extent on each side of the second surface.
    """
    return max(a, min(a + depth, width - abs(b)))


@func
def tongue(a: float, b: float, depth: float, width: float) -> float:
    """Return the first shape with a rectangular ridge along the second shape's surface.

    The ridge fits into a ``groove`` of the same size.

    Args:
        a: The shape that the ridge is added to.
        b: The shape whose surface the ridge follows.
        depth: Height of the ridge.
        width: Half the width of the ridge.
    """
    return min(a, max(a - depth, abs(b) - width))
