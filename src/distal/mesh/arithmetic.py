"""The arithmetic of meshing, as scene code: roots on edges, points of cells and of faces.

Input: a field, and numbers of one edge, cell, face or triangle. Output: its numbers. Compiled as
vector code of the CPU, in 64 bits; one row for each edge, cell, face or triangle. Does not depend
on topology: which rows belong together is decided by the caller.

Source: Tao Ju, Frank Losasso, Scott Schaefer, Joe Warren, "Dual Contouring of Hermite Data" (2002),
    for points at creases by a quadric.
"""

from __future__ import annotations

from distal.lang import (
    Field3,
    abs,
    array,
    clamp,
    cross,
    dot,
    func,
    gradient,
    length,
    max,
    value_and_gradient,
    vec3,
    vec4,
)

# The most steps along an edge. Illinois steps have the order 1.44 for a smooth field; beside a
# crease they are slow (12 of them left an error of 1 %): each third step halves the interval.
ROOT_STEPS = 48
# Gradients are taken this far off the surface, as a share of the edge: there many exact fields are
# roots of 0, whose gradient is 0 or noise.
OFF_SURFACE = 1e-5
# Steps of the iteration that solves a quadric; the part that belongs to an eigenvalue of 1 % of the
# sum shrinks by a half in each.
QUADRIC_STEPS = 16
# How often the solution of a quadric is clamped to its cell and solved again.
CLAMPS = 4
# Below this cosine between a normal and the mean normal of its cell, the cell has a crease.
CREASE_COSINE = 0.95


@func
def samples_along_x(
    field: Field3, corner: vec3, first: float, origin: float, step: float
) -> array[float, 9]:  # type: ignore[valid-type]
    """Return the field's values at nine points of the lattice along x.

    A point on the face of two bricks has the same coordinates in both: they depend on its number
    in the lattice alone. Otherwise rounding could give it two signs.

    Args:
        field: The shape.
        corner: The first point; its x is not used.
        first: The number of the first point along x.
        origin: The x of the point 0.
        step: The length of a cell.
    """
    found = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    for i in range(9):
        found[i] = field(vec3(origin + (first + float(i)) * step, corner.y, corner.z))
    return found


@func
def distance_value(field: Field3, p: vec3) -> float:
    """Return the field's value."""
    return field(p)


@func
def root_on_edge(
    field: Field3, start: vec3, way: vec3, first: float, second: float
) -> tuple[float, vec3]:
    """Return where the field is 0 on an edge, as a share of the edge, and the gradient there.

    By the Illinois variant of false position, which keeps the sign change between its two ends,
    and by bisection.

    Args:
        field: The field.
        start: The first end of the edge.
        way: From the first end to the second.
        first: The value at the first end.
        second: The value at the second end; its sign differs.
    """
    a = 0.0
    b = 1.0
    at_a = first
    at_b = second
    side = 0
    t = 0.5
    close = 1e-15 * (abs(first) + abs(second))
    for step in range(ROOT_STEPS):
        t = clamp((a * at_b - b * at_a) / (at_b - at_a), a, b)
        t = 0.5 * (a + b) if step % 3 == 2 else t
        value = field(start + way * t)
        if abs(value) <= close or b - a < 1e-14:
            break
        if (value < 0.0) == (first < 0.0):
            at_b = at_b * 0.5 if side == 1 else at_b
            a = t
            at_a = value
            side = 1
        else:
            at_a = at_a * 0.5 if side == -1 else at_a
            b = t
            at_b = value
            side = -1
    outside = OFF_SURFACE if first < 0.0 else -OFF_SURFACE
    slope = gradient(field, start + way * (t + outside))
    return t, slope


@func
def unit_or_zero(v: vec3) -> vec3:
    """Return the vector scaled to length 1; 0 if it has no direction."""
    return v / max(length(v), 1e-12)


@func
def cosine(normal: vec3, average: vec3) -> float:
    """Return the cosine between two unit vectors."""
    return dot(normal, average)


@func
def first_order_distance(value: float, slope: vec3) -> float:
    """Return the distance to the surface, to first order."""
    return abs(value) / max(length(slope), 1e-9)


@func
def distance_and_normal(field: Field3, p: vec3, step: float) -> tuple[float, vec3]:
    """Return the distance from a point to the surface, to first order, and the normal there.

    Args:
        field: The field.
        p: The point.
        step: The length of a cell.
    """
    value, slope = value_and_gradient(field, p)
    # On the surface the gradient may be 0 or noise; beside it, it is not.
    beside = gradient(field, p + vec3(0.31, 0.59, 0.74) * (OFF_SURFACE * step))
    return first_order_distance(value, slope), unit_or_zero(beside)


@func
def distance_to_field(field: Field3, p: vec3) -> float:
    """Return the distance from a point to the surface, to first order."""
    value, slope = value_and_gradient(field, p)
    return first_order_distance(value, slope)


@func
def step_to_surface(value: float, slope: vec3) -> vec3:
    """Return the Newton step from a point to the surface."""
    return slope * (-value / max(dot(slope, slope), 1e-12))


@func
def smooth_point(field: Field3, mean: vec3, low: vec3, high: vec3) -> vec3:
    """Return a point on the surface near the mean of a cell's roots, within the cell.

    Args:
        field: The field.
        mean: The mean of the roots.
        low: The lowest corner that the point may have.
        high: The highest.
    """
    p = mean
    for _step in range(2):
        value, slope = value_and_gradient(field, p)
        p = clamp(p + step_to_surface(value, slope), low, high)
    return p


@func
def inverse_of_symmetric(x: vec3, y: vec3, z: vec3) -> array[vec3, 3]:  # type: ignore[valid-type]
    """Return the columns of the inverse of a symmetric matrix with these columns."""
    yz = cross(y, z)
    scale = 1.0 / dot(x, yz)
    return [yz * scale, cross(z, x) * scale, cross(x, y) * scale]


@func
def nearest_to_planes(
    points: array[vec3, 12],  # type: ignore[valid-type]
    normals: array[vec3, 12],  # type: ignore[valid-type]
    weights: array[float, 12],  # type: ignore[valid-type]
    middle: vec3,
    low: vec3,
    high: vec3,
) -> vec3:
    """Return the point of a box nearest to planes in the sense of least squares.

    Where the planes leave it free, it stays as close to ``middle`` as it can.

    Args:
        points: A point of each plane.
        normals: Its normal.
        weights: Its weight, 0 or 1.
        middle: The point to stay close to.
        low: The lowest corner of the box.
        high: The highest.
    """
    x = vec3(0.0)
    y = vec3(0.0)
    z = vec3(0.0)
    right = vec3(0.0)
    for i in range(12):
        n = normals[i] * weights[i]
        x += n * n.x
        y += n * n.y
        z += n * n.z
        right += n * dot(n, points[i] - middle)
    damping = 0.01 * (x.x + y.y + z.z) + 1e-12
    inverse = inverse_of_symmetric(
        x + vec3(damping, 0.0, 0.0), y + vec3(0.0, damping, 0.0), z + vec3(0.0, 0.0, damping)
    )
    found = vec3(0.0)
    # Each step moves to the planes only, so a point that was clamped goes on along a crease.
    for _turn in range(CLAMPS):
        for _step in range(QUADRIC_STEPS):
            rest = right - (x * found.x + y * found.y + z * found.z)
            found += inverse[0] * rest.x + inverse[1] * rest.y + inverse[2] * rest.z
        found = clamp(found, low - middle, high - middle)
    return middle + found


@func
def crease_point(
    field: Field3,
    points: array[vec3, 12],  # type: ignore[valid-type]
    slopes: array[vec3, 12],  # type: ignore[valid-type]
    weights: array[float, 12],  # type: ignore[valid-type]
    middle: vec3,
    low: vec3,
    high: vec3,
) -> vec3:
    """Return the point of a cell at a crease, a corner or a tip of the surface.

    The tangent planes at the roots give a first place. The field is then looked at nearer to it, on
    the way to each root, and the tangent planes there give a better one.

    Args:
        field: The field.
        points: The roots of the cell.
        slopes: The gradients at the roots.
        weights: 1 for each root, 0 for entries that are not used.
        middle: The mean of the roots.
        low: The lowest corner that the point may have.
        high: The highest.
    """
    normals = slopes
    for i in range(12):
        normals[i] = unit_or_zero(slopes[i])
    found = nearest_to_planes(points, normals, weights, middle, low, high)
    near = points
    near_normals = normals
    near_weights = weights
    share = 0.15
    for _step in range(2):
        seen = 0.0
        for i in range(12):
            near_weights[i] = 0.0
            if weights[i] > 0.0:
                way = (points[i] - found) * share
                q = found + way + normals[i] * (OFF_SURFACE * length(way))
                value, slope = value_and_gradient(field, q)
                near[i] = q + step_to_surface(value, slope)
                near_normals[i] = unit_or_zero(slope)
                # A place that looks at another side of the crease than its root says nothing new.
                if dot(near_normals[i], normals[i]) > 0.7:
                    near_weights[i] = 1.0
                    seen += 1.0
        if seen >= 2.0:
            found = nearest_to_planes(near, near_normals, near_weights, found, low, high)
        share = share * 0.2
    return found


@func
def kept_in_region(
    inner: vec3,
    target: vec3,
    low: vec3,
    step: float,
    planes: array[vec4, 8],  # type: ignore[valid-type]
    margin: float,
) -> vec3:
    """Return the target, or a point towards it that lies within a region of its cell.

    Args:
        inner: A point inside the region.
        target: The point that is wanted.
        low: The lowest corner of the cell.
        step: The length of its edges.
        planes: The planes around the region, in the unit cell; rows of 0 are ignored.
        margin: The share of the way that is kept free in front of a plane.
    """
    share = 1.0
    a = (inner - low) / step
    way = (target - inner) / step
    for i in range(8):
        room = planes[i].w - dot(planes[i].xyz, a)
        speed = dot(planes[i].xyz, way)
        if speed > 0.0 and speed * share > room * (1.0 - margin):
            share = max(room, 0.0) * (1.0 - margin) / speed
    return inner + (target - inner) * share


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
    """
    middle = (a + b) * 0.5
    normal_a = unit_or_zero(slope_a - normal * dot(slope_a, normal))
    normal_b = unit_or_zero(slope_b - normal * dot(slope_b, normal))
    found = meeting_in_face(a, b, normal_a, normal_b, normal, middle, low, high)
    share = 0.15
    for _step in range(2):
        way = (a - found) * share
        near_a = found + way + normal_a * (OFF_SURFACE * length(way))
        value, slope = value_and_gradient(field, near_a)
        side = slope - normal * dot(slope, normal)
        near_a += step_to_surface(value, side)
        near_normal_a = unit_or_zero(side)
        way = (b - found) * share
        near_b = found + way + normal_b * (OFF_SURFACE * length(way))
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
    if at_stepped < at_found:
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
        margin: How far from the triangle's sides it must pass.
    """
    way = q - p
    turn = way.y * third.z - way.z * third.y
    if abs(turn) < 1e-12:
        return False
    t = -(p.y * third.z - p.z * third.y) / turn
    x = p + way * t
    s = (x.y * third.y + x.z * third.z) / max(third.y * third.y + third.z * third.z, 1e-30)
    low = third.x * s
    high = 1.0 + (third.x - 1.0) * s
    inside = x.x > low + margin and x.x < high - margin
    return t > 0.0 and t < 1.0 and s > 0.0 and s < 1.0 and inside


@func
def diagonal_fits(p: vec3, q: vec3, third: vec3, fourth: vec3, margin: float) -> bool:
    """Return whether a diagonal meets one of the two triangles of the edge and a third point."""
    return meets_triangle(p, q, third, margin) or meets_triangle(p, q, fourth, margin)


@func
def largest_miss(field: Field3, a: vec3, b: vec3, c: vec3) -> vec3:
    """Return the largest and the mean distance of seven points of a triangle from the surface.

    The points are the middle, the middles of the sides, and those between the middle and the
    corners. The third number is 1 if one of the values is not a number, else 0.
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
    for i in range(7):
        value, slope = value_and_gradient(field, points[i])
        miss = first_order_distance(value, slope)
        if not miss >= 0.0:
            invalid = 1.0
        largest = max(largest, miss)
        total += miss
    return vec3(largest, total / 7.0, invalid)


@func
def lost_surface(field: Field3, p: vec3, reach: float) -> tuple[bool, vec3]:
    """Return whether there is a surface closer to a point than ``reach``, and a point of it.

    Args:
        field: The field.
        p: The point.
        reach: How far the surface may be.
    """
    q = p
    value = 0.0
    for _step in range(6):
        value, slope = value_and_gradient(field, q)
        q = clamp(q + step_to_surface(value, slope), p - reach, p + reach)
    value, slope = value_and_gradient(field, q)
    return first_order_distance(value, slope) < 1e-6 * reach, q
