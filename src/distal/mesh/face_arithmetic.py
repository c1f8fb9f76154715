"""The arithmetic of faces and triangles, as scene code: points on faces, diagonals, misses.

Input: a field, and numbers of one face or triangle. Output: its numbers. Compiled as vector code of
the CPU, in 64 bits; one row for each face or triangle. Does not depend on topology.
"""

from __future__ import annotations

from distal.lang import (
    Field3,
    abs,
    asin,
    clamp,
    cross,
    dot,
    func,
    gradient,
    length,
    max,
    min,
    sign,
    value_and_gradient,
    vec3,
)
from distal.mesh.arithmetic import (
    OFF_SURFACE,
    first_order_distance,
    step_to_surface,
    unit_or_zero,
)

# A diagonal that passes an edge at a flatter angle has no certain place in 32 bits: it is off by
# 1e-7 for each unit of the angle. Points that are closer to the edge than a share of the cell count
# as so far away.
LEAST_TURN = 2e-3
LEAST_ARM = 0.01
# Of two places that are as close to the surface but for this share of a cell, the first is taken.
CLEARLY = 1e-4
# Where a value and its gradient say that the surface is, the sign is another a little beyond: after
# so many times the distance.
BEYOND = 1.5
# Signs beside a point of the surface are taken at so many times the distance within which it is on
# the surface.
ACROSS = 4.0
# Below this cosine between a triangle's normal and that of the surface, this is another face.
SAME_FACE = 0.5


@func
def way_out(p: vec3, low: vec3, high: vec3) -> float:
    """Return the direction in which a point is outside of a box, as a code.

    Codes are 1, 2 and 3 for x, y and z, negative towards low ends; 0 for points that are inside, or
    outside in several directions.

    Args:
        p: The point.
        low: The lowest corner of the box.
        high: The highest.
    """
    count = 0.0
    code = 0.0
    for axis in range(3):
        if p[axis] < low[axis] or p[axis] > high[axis]:
            count += 1.0
            code = float(axis + 1) if p[axis] > high[axis] else -float(axis + 1)
    return code if count == 1.0 else 0.0


@func
def way_of(code: float) -> vec3:
    """Return the direction of a code of ``way_out``; 0 for 0."""
    way = vec3(0.0)
    for axis in range(3):
        if abs(code) == float(axis + 1):
            way[axis] = sign(code)
    return way


@func
def passes_face(p: vec3, q: vec3, low: vec3, high: vec3) -> bool:
    """Return whether a line from the cell below a face to the one above passes through the face.

    Args:
        p: The point below, in units of the cell, relative to the face's lowest corner; the first
            coordinate is that along the face's normal.
        q: The point above.
        low: The lowest place at which it may pass; the first coordinate is not used.
        high: The highest.
    """
    t = -p.x / max(q.x - p.x, 1e-30)
    y = p.y + (q.y - p.y) * t
    z = p.z + (q.z - p.z) * t
    return y > low.y and y < high.y and z > low.z and z < high.z


@func
def middle_distance(field: Field3, p: vec3, q: vec3) -> float:
    """Return how far the middle of a line is from the surface, to first order."""
    value, slope = value_and_gradient(field, (p + q) * 0.5)
    return first_order_distance(value, slope)


@func
def face_point(
    field: Field3,
    a: vec3,
    b: vec3,
    slope_a: vec3,
    slope_b: vec3,
    normal: vec3,
    low: vec3,
    high: vec3,
    off: float = OFF_SURFACE,
) -> vec3:
    """Return the point of a face at which the surface crosses it, at its crease if it has one.

    Args:
        field: The field.
        a: The root on one edge of the face.
        b: The root on the other edge that the surface crosses.
        slope_a: The gradient at the first root.
        slope_b: The gradient at the second root.
        normal: The unit vector perpendicular to the face.
        low: The lowest corner that the point may have.
        high: The highest.
        off: How far off the surface gradients are taken, as a share of the way from a root.
    """
    middle = (a + b) * 0.5
    normal_a = unit_or_zero(slope_a - normal * dot(slope_a, normal))
    normal_b = unit_or_zero(slope_b - normal * dot(slope_b, normal))
    found = meeting_in_face(a, b, normal_a, normal_b, normal, middle, low, high)
    share = 0.15
    for _step in range(2):
        way = (a - found) * share
        near_a = found + way + normal_a * (off * length(way))
        value, slope = value_and_gradient(field, near_a)
        side = slope - normal * dot(slope, normal)
        near_a += step_to_surface(value, side)
        near_normal_a = unit_or_zero(side)
        way = (b - found) * share
        near_b = found + way + normal_b * (off * length(way))
        value, slope = value_and_gradient(field, near_b)
        side = slope - normal * dot(slope, normal)
        near_b += step_to_surface(value, side)
        near_normal_b = unit_or_zero(side)
        if dot(near_normal_a, normal_a) > 0.7 and dot(near_normal_b, normal_b) > 0.7:
            found = meeting_in_face(
                near_a, near_b, near_normal_a, near_normal_b, normal, found, low, high
            )
        share = share * 0.2
    value, slope = value_and_gradient(field, found)
    at_found = first_order_distance(value, slope)
    value, slope = value_and_gradient(field, middle)
    at_middle = first_order_distance(value, slope)
    # Where the sides meet far away, as on a smooth surface, a Newton step in the face is better.
    side = slope - normal * dot(slope, normal)
    stepped = clamp(middle + step_to_surface(value, side), low, high)
    value, slope = value_and_gradient(field, stepped)
    at_stepped = first_order_distance(value, slope)
    # Often both are on the surface, one of them at the crease: rounding must not decide.
    if at_stepped < at_found - CLEARLY * length(b - a):
        found = stepped
        at_found = at_stepped
    return found if at_found < at_middle else middle


@func
def meeting_in_face(
    a: vec3,
    b: vec3,
    normal_a: vec3,
    normal_b: vec3,
    normal: vec3,
    otherwise: vec3,
    low: vec3,
    high: vec3,
) -> vec3:
    """Return where two lines of a face meet; ``otherwise`` if they are nearly parallel.

    Args:
        a: A point of the first line.
        b: A point of the second line.
        normal_a: The first line's normal within the face.
        normal_b: The second line's normal within the face.
        normal: The face's normal.
        otherwise: The result for lines that are nearly parallel.
        low: The lowest corner that the point may have.
        high: The highest.
    """
    turn = dot(normal, cross(normal_a, normal_b))
    if abs(turn) < 0.05:
        return otherwise
    along_a = dot(normal_a, a - otherwise)
    along_b = dot(normal_b, b - otherwise)
    way = cross(normal_b, normal) * along_a + cross(normal, normal_a) * along_b
    return clamp(otherwise + way / turn, low, high)


@func
def meets_triangle(p: vec3, q: vec3, third: vec3, margin: float) -> bool:
    """Return whether a diagonal of four points around an edge meets the triangle of edge and point.

    Args:
        p: The first end of the diagonal, in units of the cell; the edge goes from (0, 0, 0) to
            (1, 0, 0).
        q: The second end.
        third: One of the other two points.
        margin: How far points are from the sides of their cells; half of it is how far from the
            triangle's sides it must pass.
    """
    way = q - p
    turn = way.y * third.z - way.z * third.y
    if abs(turn) < LEAST_TURN * length(way.yz) * max(length(third.yz), LEAST_ARM):
        return False
    t = -(p.y * third.z - p.z * third.y) / turn
    x = p + way * t
    s = (x.y * third.y + x.z * third.z) / max(third.y * third.y + third.z * third.z, 1e-30)
    low = third.x * s
    high = 1.0 + (third.x - 1.0) * s
    # Points are often kept at the margin, and the diagonal of a flat face often passes the edge
    # itself, where s is 0: rounding must not decide.
    half = 0.5 * margin
    inside = x.x > low + half and x.x < high - half
    return t > 0.0 and t < 1.0 and s > -half and s < 1.0 and inside


@func
def meets_edge(p: vec3, q: vec3, third: vec3, margin: float) -> bool:
    """Return whether a triangle meets the edge from (0, 0, 0) to (1, 0, 0).

    Args:
        p: The first corner.
        q: The second corner.
        third: The third corner.
        margin: How far from the edge's ends it must meet it.
    """
    # Areas seen along the edge: the shares of the corners in the place where they meet.
    of_p = q.y * third.z - q.z * third.y
    of_q = third.y * p.z - third.z * p.y
    of_third = p.y * q.z - p.z * q.y
    total = of_p + of_q + of_third
    least = min(of_p * total, min(of_q * total, of_third * total))
    beside = total == 0.0 or least < -margin * total * total
    x = (of_p * p.x + of_q * q.x + of_third * third.x) / (1.0 if beside else total)
    half = 0.5 * margin
    return not beside and x > half and x < 1.0 - half


@func
def diagonal_fits(p: vec3, q: vec3, third: vec3, fourth: vec3, margin: float) -> bool:
    """Return whether a diagonal meets one of the triangles of the edge and a third point.

    The other triangle, of the diagonal and the fourth point, must meet the edge itself: it may pass
    its end where a point is beyond the end, which is so for cells of unequal size and for those
    that reach out.
    """
    return (meets_triangle(p, q, third, margin) and meets_edge(p, q, fourth, margin)) or (
        meets_triangle(p, q, fourth, margin) and meets_edge(p, q, third, margin)
    )


@func
def largest_miss(field: Field3, a: vec3, b: vec3, c: vec3, off: float = OFF_SURFACE) -> vec3:
    """Return the largest and the mean distance of seven points of a triangle from the surface.

    The points are the middle, the middles of the sides, and those between the middle and the
    corners. The third number is 1 if one of the values is not a number, else 0. Where faces
    coincide inside of a solid, the distance of the middle is that to the surface beyond.

    Args:
        field: The field.
        a: The first corner of the triangle.
        b: The second, counter-clockwise seen from outside.
        c: The third.
        off: How far beyond a surface its sign is taken, as a share of the longest side.
    """
    largest = 0.0
    total = 0.0
    invalid = 0.0
    middle = (a + b + c) / 3.0
    points = [
        middle,
        (a + b) * 0.5,
        (b + c) * 0.5,
        (c + a) * 0.5,
        (a + middle) * 0.5,
        (b + middle) * 0.5,
        (c + middle) * 0.5,
    ]
    at_middle = 0.0
    step = vec3(0.0)
    for i in range(7):
        value, slope = value_and_gradient(field, points[i])
        miss = first_order_distance(value, slope)
        if not miss >= 0.0:
            invalid = 1.0
        if i == 0:
            at_middle = value
            step = step_to_surface(value, slope)
        largest = max(largest, miss)
        total += miss
    side = max(length(b - a), max(length(c - b), length(a - c)))
    normal = unit_or_zero(cross(b - a, c - a) / max(side * side, 1e-300))
    outwards = normal if at_middle < 0.0 else -normal
    least = BEYOND * length(step) + off * side
    if (field(middle + outwards * least) < 0.0) == (at_middle < 0.0):
        # At a crease, the nearest face has another normal than the triangle.
        beyond = middle + step * BEYOND + unit_or_zero(step) * (off * side)
        if (field(beyond) < 0.0) == (at_middle < 0.0):
            depth = depth_along(field, middle, outwards, at_middle < 0.0, least, side)
            largest = max(largest, depth)
    return vec3(largest, total / 7.0, invalid)


@func
def depth_along(
    field: Field3, p: vec3, way: vec3, inside: bool, least: float, most: float
) -> float:
    """Return how far the surface is along a direction, at most, to a thirtieth.

    Args:
        field: The field.
        p: The point.
        way: The direction, of length 1.
        inside: Whether the point is inside.
        least: A distance that is not behind it.
        most: How far it may be.
    """
    distance = least
    for _step in range(40):
        distance = distance * 2.0
        if (field(p + way * distance) < 0.0) != inside or distance > most:
            break
    low = 0.5 * distance
    for _step in range(4):
        half = 0.5 * (low + distance)
        behind = (field(p + way * half) < 0.0) != inside
        distance = half if behind else distance
        low = low if behind else half
    return distance


@func
def turn_in_triangle(
    field: Field3,
    a: vec3,
    b: vec3,
    c: vec3,
    pieces: float,
    angle: float,
    least_radius: float,
) -> float:
    """Return how much the surface turns within a triangle, as a share of what it may, squared.

    Normals are compared at three points inside, half as far apart as the corners: those at corners
    are of both sides where a crease is. What faces another way than the triangle is another face
    of the solid, beside a crease.

    Args:
        field: The field.
        a: The first corner.
        b: The second corner.
        c: The third corner.
        pieces: Of how many such triangles a side of the whole triangle is.
        angle: How much the surface may turn within the whole triangle, in radians.
        least_radius: Where the radius is below this, it may turn by any angle.
    """
    middle = (a + b + c) / 3.0
    points = [(a + middle) * 0.5, (b + middle) * 0.5, (c + middle) * 0.5]
    face = unit_or_zero(cross(b - a, c - a))
    normals = [vec3(0.0), vec3(0.0), vec3(0.0)]
    for i in range(3):
        normal = unit_or_zero(gradient(field, points[i]))
        normals[i] = normal if dot(normal, face) > SAME_FACE else vec3(0.0)
    turn = 0.0
    rate = 1e-30
    for i in range(3):
        n, m = normals[i], normals[(i + 1) % 3]
        if dot(n, n) > 0.0 and dot(m, m) > 0.0:
            between = 2.0 * asin(min(0.5 * length(n - m), 1.0))
            turn = max(turn, between)
            rate = max(rate, between / max(length(points[i] - points[(i + 1) % 3]), 1e-30))
    share = 2.0 * turn * pieces / angle
    return 0.0 if rate * least_radius > 1.0 else share * share


@func
def lost_surface(
    field: Field3, p: vec3, reach: float, narrow: float, close: float = 1e-6
) -> tuple[bool, vec3]:
    """Return whether there is a surface closer to a point than ``reach``, and a point of it.

    Args:
        field: The field.
        p: The point.
        reach: How far the surface may be.
        narrow: A gap that is not wider is none.
        close: How close to the surface a point of it is, as a share of ``reach``.
    """
    q = p
    value = 0.0
    for _step in range(6):
        value, slope = value_and_gradient(field, q)
        q = clamp(q + step_to_surface(value, slope), p - reach, p + reach)
    value, slope = value_and_gradient(field, q)
    near = first_order_distance(value, slope) < close * reach
    beside = ACROSS * close * reach
    # On the surface the gradient may be 0 or noise; beside it, it is not. At an edge of the shape
    # it may lie in a face.
    across = unit_or_zero(gradient(field, q + vec3(0.31, 0.59, 0.74) * (0.5 * beside)))
    along = unit_or_zero(q - p)
    inside = sides_inside(field, q, across * beside, along * beside)
    # Where two solids touch, the value is 0 with the inside on both sides; where a cutter ends on
    # a face, with the outside on both.
    crosses = inside > 0 and inside < 4
    gap = max(narrow, beside)
    apart = sides_inside(field, q, across * gap, along * gap) < 4
    return near and crosses and apart, q


@func
def sides_inside(field: Field3, p: vec3, across: vec3, along: vec3) -> int:
    """Return how many of the four places beside a point, in two directions, are inside."""
    count = 1 if field(p + across) < 0.0 else 0
    count += 1 if field(p - across) < 0.0 else 0
    count += 1 if field(p + along) < 0.0 else 0
    return count + (1 if field(p - along) < 0.0 else 0)
