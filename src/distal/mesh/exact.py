"""Whether two triangles intersect, exactly.

Input: corners as floats, which are fractions with a power of 2 below. Output: yes or no, by
integers of any length: nothing is rounded. Slow; for the pairs that vector code cannot decide.

Source: Olivier Devillers, Philippe Guigue, "Faster Triangle-Triangle Intersection Tests" (2002),
    for the use of orientations only.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

Point: TypeAlias = tuple[int, int, int]


def intersect(
    one: Sequence[Sequence[float]], other: Sequence[Sequence[float]], shared: int
) -> bool:
    """Return whether two triangles meet elsewhere than in the corners that they share.

    Args:
        one: The corners of the first triangle, the shared ones first.
        other: Those of the other, the shared ones first and in the same order.
        shared: How many corners they share.
    """
    a, b = whole_numbers([*one, *other])
    if shared >= 3:
        return True
    if shared == 2:
        return _is_folded(a[0], a[1], a[2], b[2])
    if shared == 1:
        return meets(a[1], a[2], b) or meets(b[1], b[2], a)
    sides = ((0, 1), (1, 2), (2, 0))
    return any(meets(a[i], a[j], b) for i, j in sides) or any(
        meets(b[i], b[j], a) for i, j in sides
    )


def whole_numbers(points: Sequence[Sequence[float]]) -> tuple[list[Point], list[Point]]:
    """Return the corners of two triangles, multiplied by a power of 2 that makes them whole."""
    parts = [number.as_integer_ratio() for point in points for number in map(float, point)]
    scale = max(denominator for _, denominator in parts)
    numbers = [numerator * (scale // denominator) for numerator, denominator in parts]
    found = [(numbers[i], numbers[i + 1], numbers[i + 2]) for i in range(0, 18, 3)]
    return found[:3], found[3:]


def minus(a: Point, b: Point) -> Point:
    """Return the difference of two points."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def cross(a: Point, b: Point) -> Point:
    """Return the cross product of two vectors."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a: Point, b: Point) -> int:
    """Return the scalar product of two vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def side(a: Point, b: Point, c: Point, p: Point) -> int:
    """Return six times the volume of a tetrahedron: its sign is the side of the plane."""
    return dot(cross(minus(b, a), minus(c, a)), minus(p, a))


def meets(p: Point, q: Point, triangle: Sequence[Point]) -> bool:
    """Return whether a line between two points meets a triangle; touching counts."""
    a, b, c = triangle
    at_p, at_q = side(a, b, c, p), side(a, b, c, q)
    if at_p * at_q > 0:
        return False
    if at_p == 0 and at_q == 0:
        return _meets_in_plane(p, q, triangle)
    ways = [side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)]
    return all(way >= 0 for way in ways) or all(way <= 0 for way in ways)


def _meets_in_plane(p: Point, q: Point, triangle: Sequence[Point]) -> bool:
    """Return whether a line meets a triangle of the same plane."""
    normal = cross(minus(triangle[1], triangle[0]), minus(triangle[2], triangle[0]))
    if normal == (0, 0, 0):
        return False  # a triangle without area: its sides are sides of others
    drop = max(range(3), key=lambda axis: abs(normal[axis]))
    u, v = (axis for axis in range(3) if axis != drop)

    def turn(a: Point, b: Point, c: Point) -> int:
        return (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u])

    def inside(x: Point) -> bool:
        a, b, c = triangle
        turns = (turn(a, b, x), turn(b, c, x), turn(c, a, x))
        return all(t >= 0 for t in turns) or all(t <= 0 for t in turns)

    def cross_lines(a: Point, b: Point) -> bool:
        first, second = turn(a, b, p), turn(a, b, q)
        third, fourth = turn(p, q, a), turn(p, q, b)
        return first * second <= 0 and third * fourth <= 0 and (first != 0 or second != 0)

    sides = ((0, 1), (1, 2), (2, 0))
    return inside(p) or inside(q) or any(cross_lines(triangle[i], triangle[j]) for i, j in sides)


def _is_folded(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Return whether the triangle (a, b, d) lies on the triangle (a, b, c)."""
    if side(a, b, c, d) != 0:
        return False
    way = minus(b, a)
    normal = cross(way, minus(c, a))
    return dot(normal, cross(way, minus(d, a))) > 0
