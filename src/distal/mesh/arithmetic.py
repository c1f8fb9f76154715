"""The arithmetic of meshing, as scene code: roots on edges, points of cells.

Input: a field, and numbers of one edge or cell. Output: its numbers. Compiled as vector code of the
CPU, in 64 bits; one row for each edge or cell. Does not depend on topology: which rows belong
together is decided by the caller.

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
from distal.mesh.root_arithmetic import share_of_root

# Gradients are taken this far off the surface, as a share of the edge: there many exact fields are
# roots of 0, whose gradient is 0 or noise.
OFF_SURFACE = 1e-5
# Steps of the iteration that solves a quadric; the part that belongs to an eigenvalue of 1 % of the
# sum shrinks by a half in each.
QUADRIC_STEPS = 16
# How often the solution of a quadric is clamped to its cell and solved again.
CLAMPS = 4
# Points on faces that are farther from the surface than this, in cells, may reach beyond the face.
OFF_FACE = 1e-3
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
    field: Field3,
    start: vec3,
    way: vec3,
    first: float,
    second: float,
    off: float = OFF_SURFACE,
) -> tuple[float, vec3]:
    """Return where the field is 0 on an edge, as a share of the edge, and the gradient there.

    Args:
        field: The field.
        start: The first end of the edge.
        way: From the first end to the second.
        first: The value at the first end.
        second: The value at the second end; its sign differs.
        off: How far off the surface the gradient is taken, as a share of the edge.
    """

    def along(t: float) -> float:
        return field(start + way * t)

    t = share_of_root(along, first, second)
    outside = off if first < 0.0 else -off
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
def step_along(away: float, normal: vec3, held: vec3, beyond: float) -> vec3:
    """Return the step to the surface of a shape along a plane.

    Args:
        away: The signed distance to the shape.
        normal: The shape's normal.
        held: The normal of the plane, of length 1.
        beyond: How far behind the surface the step ends.
    """
    way = normal - held * dot(normal, held)
    goal = away + (beyond if away > 0.0 else -beyond)
    return way * (-goal / max(dot(way, way), 0.01))


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
    off: float = OFF_SURFACE,
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
        off: How far off the surface gradients are taken, as a share of the way from a root.
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
                q = found + way + normals[i] * (off * length(way))
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
