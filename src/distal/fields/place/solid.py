"""Placement of solids: translation, rotation, scaling, shear.

Input: a point, and the numbers of the placement. Output: the point at which the shape is evaluated
(the inverse placement of the given point), and the box of the placed shape. Rotation matrices
depend on numbers alone, so they are computed once per frame. Does not depend on copies
(``mirrors``, ``repeat``).
"""

from __future__ import annotations

from distal.fields.extents import at_least_one, box_distance, smallest, turned
from distal.fields.guarantees import EXACT, LOWER_BOUND, NOTHING, Bounds, Growth, Limit, operator
from distal.fields.widths import deformed_width, scaled_width, stretched_width
from distal.lang import (
    abs,
    cos,
    cross,
    dot,
    func,
    mat3,
    max,
    normalize,
    pow,
    select,
    sin,
    sqrt,
    transpose,
    vec3,
    vec4,
)

# Translation and rotation


@func
def translated(p: vec3, offset: vec3) -> vec3:
    """Return the point before a translation by ``offset``."""
    return p - offset


@func
def same_direction(p: vec3) -> vec3:
    """Return a direction before an operator that keeps all directions."""
    return p


@func
def translated_bounds(bounds: Bounds, offset: vec3) -> Bounds:
    """Return the box, translated."""
    return Bounds(bounds.low + offset, bounds.high + offset)


@func
def turned_back(p: vec3, m: mat3) -> vec3:
    """Return the point before a rotation, whose inverse is its transpose."""
    return vec3(dot(m[0], p), dot(m[1], p), dot(m[2], p))


@func
def axis_matrix(axis: vec3, angle: float) -> mat3:
    """Return the rotation matrix for a unit axis (Rodrigues).

    The rotation is counterclockwise if seen from the end of the axis.
    """
    c, s = cos(angle), sin(angle)
    t = axis * (1.0 - c)
    return mat3(
        t.x * axis + vec3(c, s * axis.z, -s * axis.y),
        t.y * axis + vec3(-s * axis.z, c, s * axis.x),
        t.z * axis + vec3(s * axis.y, -s * axis.x, c),
    )


@func
def euler_matrix(angles: vec3) -> mat3:
    """Return the rotation about the fixed x axis, then the y axis, then the z axis."""
    about_x = axis_matrix(vec3(1.0, 0.0, 0.0), angles.x)
    about_y = axis_matrix(vec3(0.0, 1.0, 0.0), angles.y)
    about_z = axis_matrix(vec3(0.0, 0.0, 1.0), angles.z)
    return about_z @ about_y @ about_x


@func
def quaternion_matrix(quaternion: vec4) -> mat3:
    """Return the rotation matrix of a unit quaternion (x, y, z, w)."""
    v, w = quaternion.xyz, quaternion.w
    doubled = v + v
    return mat3(
        doubled.x * v + vec3(1.0 - dot(doubled, v), doubled.z * w, -doubled.y * w),
        doubled.y * v + vec3(-doubled.z * w, 1.0 - dot(doubled, v), doubled.x * w),
        doubled.z * v + vec3(doubled.y * w, -doubled.x * w, 1.0 - dot(doubled, v)),
    )


@func
def orient_matrix(source: vec3, target: vec3) -> mat3:
    """Return the smallest rotation that maps direction ``source`` to direction ``target``.

    It is the product of two reflections: in the plane perpendicular to ``source``, then in the
    plane perpendicular to the bisector. If the directions are opposite, the bisector is any
    direction perpendicular to them.
    """
    s, t = normalize(source), normalize(target)
    other = select(abs(s.x) < 0.7, vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0))
    opposite = dot(s, t) < -0.999999
    bisector = normalize(select(opposite, cross(s, other), s + t))
    # H(bisector) H(s) = I - 2 s s' - 2 b b' + 4 (b.s) b s'
    b4 = 4.0 * dot(bisector, s)
    columns = mat3(1.0)
    return mat3(
        columns[0] - 2.0 * s.x * s - 2.0 * bisector.x * bisector + b4 * s.x * bisector,
        columns[1] - 2.0 * s.y * s - 2.0 * bisector.y * bisector + b4 * s.y * bisector,
        columns[2] - 2.0 * s.z * s - 2.0 * bisector.z * bisector + b4 * s.z * bisector,
    )


@func
def rotated(p: vec3, axis: vec3, angle: float) -> vec3:
    """Return the point before a rotation about an axis through the origin."""
    return turned_back(p, axis_matrix(axis, angle))


@func
def rotated_bounds(bounds: Bounds, axis: vec3, angle: float) -> Bounds:
    """Return the box around the rotated box."""
    return turned(bounds, axis_matrix(axis, angle))


@func
def rotated_x(p: vec3, angle: float) -> vec3:
    """Return the point before a rotation about the x axis (y towards z)."""
    c, s = cos(angle), sin(angle)
    return vec3(p.x, c * p.y + s * p.z, c * p.z - s * p.y)


@func
def rotated_y(p: vec3, angle: float) -> vec3:
    """Return the point before a rotation about the y axis (z towards x)."""
    c, s = cos(angle), sin(angle)
    return vec3(c * p.x - s * p.z, p.y, c * p.z + s * p.x)


@func
def rotated_z(p: vec3, angle: float) -> vec3:
    """Return the point before a rotation about the z axis (x towards y)."""
    c, s = cos(angle), sin(angle)
    return vec3(c * p.x + s * p.y, c * p.y - s * p.x, p.z)


@func
def rotated_x_bounds(bounds: Bounds, angle: float) -> Bounds:
    """Return the box around the rotated box."""
    return turned(bounds, axis_matrix(vec3(1.0, 0.0, 0.0), angle))


@func
def rotated_y_bounds(bounds: Bounds, angle: float) -> Bounds:
    """Return the box around the rotated box."""
    return turned(bounds, axis_matrix(vec3(0.0, 1.0, 0.0), angle))


@func
def rotated_z_bounds(bounds: Bounds, angle: float) -> Bounds:
    """Return the box around the rotated box."""
    return turned(bounds, axis_matrix(vec3(0.0, 0.0, 1.0), angle))


@func
def rotated_euler(p: vec3, angles: vec3) -> vec3:
    """Return the point before rotations about the fixed x, then y, then z axis."""
    return turned_back(p, euler_matrix(angles))


@func
def rotated_euler_bounds(bounds: Bounds, angles: vec3) -> Bounds:
    """Return the box around the rotated box."""
    return turned(bounds, euler_matrix(angles))


@func
def rotated_quaternion(p: vec3, quaternion: vec4) -> vec3:
    """Return the point before the rotation of a quaternion (x, y, z, w)."""
    return turned_back(p, quaternion_matrix(quaternion))


@func
def rotated_quaternion_bounds(bounds: Bounds, quaternion: vec4) -> Bounds:
    """Return the box around the rotated box."""
    return turned(bounds, quaternion_matrix(quaternion))


@func
def rotated_matrix(p: vec3, right: vec3, up: vec3, back: vec3) -> vec3:
    """Return the point before a rotation, or a mirror image, of the x, y and z axes."""
    return vec3(dot(right, p), dot(up, p), dot(back, p))


@func
def rotated_matrix_bounds(bounds: Bounds, right: vec3, up: vec3, back: vec3) -> Bounds:
    """Return the box around the rotated box."""
    return turned(bounds, mat3(right, up, back))


@func
def oriented(p: vec3, source: vec3, target: vec3) -> vec3:
    """Return the point before the smallest rotation that maps ``source`` to ``target``."""
    return turned_back(p, orient_matrix(source, target))


@func
def oriented_bounds(bounds: Bounds, source: vec3, target: vec3) -> Bounds:
    """Return the box around the rotated box."""
    return turned(bounds, orient_matrix(source, target))


# Scaling and shear


@func
def scaled(p: vec3, factor: float) -> vec3:
    """Return the point before scaling about the origin."""
    return p / factor


@func
def scaled_value(d: float, factor: float) -> float:
    """Return the distance times the scale factor."""
    return d * factor


@func
def scaled_bounds(bounds: Bounds, factor: float) -> Bounds:
    """Return the box, scaled."""
    return Bounds(bounds.low * factor, bounds.high * factor)


@func
def stretched(p: vec3, factors: vec3) -> vec3:
    """Return the point before scaling each axis by its own factor."""
    return p / factors


@func
def stretched_value(d: float, p: vec3, factors: vec3, bounds: Bounds) -> float:
    """Return the distance times the smallest factor: a lower bound of the true distance.

    Far outside this is much too small, so the result is at least the distance to the box.
    """
    return max(d * smallest(factors), box_distance(p, stretched_bounds(bounds, factors)))


@func
def stretched_bounds(bounds: Bounds, factors: vec3) -> Bounds:
    """Return the box, scaled."""
    return Bounds(bounds.low * factors, bounds.high * factors)


@func
def sheared(p: vec3, xy: float, xz: float, yz: float) -> vec3:
    """Return the point before a shear.

    The shear moves x by xy times y and xz times z, and y by yz times z.
    """
    y = p.y - yz * p.z
    return vec3(p.x - xy * y - xz * p.z, y, p.z)


@func
def shear_matrix(xy: float, xz: float, yz: float) -> mat3:
    """Return the matrix of the shear (not of its inverse)."""
    return mat3(vec3(1.0, 0.0, 0.0), vec3(xy, 1.0, 0.0), vec3(xz, yz, 1.0))


@func
def sheared_bounds(bounds: Bounds, xy: float, xz: float, yz: float) -> Bounds:
    """Return the box around the sheared box."""
    return turned(bounds, shear_matrix(xy, xz, yz))


@func
def sheared_value(d: float, p: vec3, xy: float, xz: float, yz: float, bounds: Bounds) -> float:
    """Return the value, but at least the distance to the box."""
    return max(d, box_distance(p, sheared_bounds(bounds, xy, xz, yz)))


@func
def trace(m: mat3) -> float:
    """Return the sum of the diagonal."""
    return m[0].x + m[1].y + m[2].z


@func
def largest_stretch(m: mat3) -> float:
    """Return a bound on how much the linear map ``m`` stretches distances.

    It is at most 1 % too large. The largest eigenvalue of m'm is at most the 64th root of the trace
    of its 64th power, and that is at most 3^(1/64) times too large. Each squaring is scaled by the
    trace, so nothing overflows.
    """
    power = transpose(m) @ m
    bound = 1.0
    exponent = 1.0
    for _ in range(6):
        size = trace(power)
        bound *= pow(size, exponent)
        power = power * (1.0 / size)
        power = power @ power
        exponent *= 0.5
    return sqrt(bound * pow(trace(power), exponent))


@func
def sheared_slope(slope: float, xy: float, xz: float, yz: float) -> float:
    """Return the slope times the largest stretch of the inverse shear."""
    back = mat3(vec3(1.0, 0.0, 0.0), vec3(-xy, 1.0, 0.0), vec3(xy * yz - xz, -yz, 1.0))
    return max(slope * largest_stretch(back), 1.0)


def orthonormal_requirement(
    right: tuple[float, ...], up: tuple[float, ...], back: tuple[float, ...]
) -> str | None:
    """Return why three columns are not a rotation or a mirror image, or None."""
    columns = (tuple(right), tuple(up), tuple(back))
    for i, a in enumerate(columns):
        for j, b in enumerate(columns):
            product = sum(x * y for x, y in zip(a, b, strict=True))
            if not -1e-4 < product - float(i == j) < 1e-4:
                return "the columns of a rotation must have length 1 and stand at right angles"
    return None


def direction_requirement(source: tuple[float, ...], target: tuple[float, ...]) -> str | None:
    """Return why two vectors do not define a rotation, or None."""
    for name, v in (("from", source), ("to", target)):
        if not any(v):
            return f"'{name}' has no direction: it is zero"
    return None


TRANSLATE = operator(
    "translate",
    point=translated,
    keeps=EXACT,
    linear=True,
    turn=same_direction,
    bounds=translated_bounds,
    growth=Growth.KEPT,
)
ROTATE = operator(
    "rotate",
    point=rotated,
    keeps=EXACT,
    linear=True,
    turn=rotated,
    bounds=rotated_bounds,
    limits={"axis": Limit.UNIT},
    growth=Growth.TURNED,
)
ROTATE_X = operator(
    "rotate x",
    point=rotated_x,
    keeps=EXACT,
    linear=True,
    turn=rotated_x,
    bounds=rotated_x_bounds,
    growth=Growth.TURNED,
)
ROTATE_Y = operator(
    "rotate y",
    point=rotated_y,
    keeps=EXACT,
    linear=True,
    turn=rotated_y,
    bounds=rotated_y_bounds,
    growth=Growth.TURNED,
)
ROTATE_Z = operator(
    "rotate z",
    point=rotated_z,
    keeps=EXACT,
    linear=True,
    turn=rotated_z,
    bounds=rotated_z_bounds,
    growth=Growth.TURNED,
)
ROTATE_EULER = operator(
    "rotate euler",
    point=rotated_euler,
    keeps=EXACT,
    linear=True,
    turn=rotated_euler,
    bounds=rotated_euler_bounds,
    growth=Growth.TURNED,
)
ROTATE_QUATERNION = operator(
    "rotate quaternion",
    point=rotated_quaternion,
    keeps=EXACT,
    linear=True,
    turn=rotated_quaternion,
    bounds=rotated_quaternion_bounds,
    limits={"quaternion": Limit.UNIT},
    growth=Growth.TURNED,
)
ROTATE_MATRIX = operator(
    "rotate matrix",
    point=rotated_matrix,
    keeps=EXACT,
    linear=True,
    turn=rotated_matrix,
    bounds=rotated_matrix_bounds,
    requires=orthonormal_requirement,
    growth=Growth.TURNED,
)
ORIENT = operator(
    "orient",
    point=oriented,
    keeps=EXACT,
    linear=True,
    turn=oriented,
    bounds=oriented_bounds,
    requires=direction_requirement,
    growth=Growth.TURNED,
)
SCALE = operator(
    "scale",
    point=scaled,
    finish=scaled_value,
    keeps=EXACT,
    linear=True,
    turn=same_direction,
    bounds=scaled_bounds,
    limits={"factor": Limit.POSITIVE},
    growth=Growth.KEPT,
    width=scaled_width,
)
STRETCH = operator(
    "scale axes",
    point=stretched,
    finish=stretched_value,
    keeps=LOWER_BOUND,
    slope=at_least_one,
    bounds=stretched_bounds,
    limits={"factors": Limit.POSITIVE},
    growth=Growth.HELD,
    width=stretched_width,
)
SHEAR = operator(
    "shear",
    point=sheared,
    finish=sheared_value,
    keeps=NOTHING,
    slope=sheared_slope,
    bounds=sheared_bounds,
    growth=Growth.HELD,
    width=deformed_width,
)
