"""Maps of space: around a cylinder, sphere inversion, scaled copies, displacement by noise.

Input: a point, the numbers of the map, the child's box. Output: the point at which the child is
evaluated, a value without jumps, the slope, the box. As in ``solid``, the slope is the child's
times the largest stretch of the map, and the value is at least the distance to the result's box.
"""

from __future__ import annotations

from distal.fields.constants import PI
from distal.fields.extents import box_distance, reach
from distal.fields.guarantees import (
    ENDLESS,
    INSIDE_AND_BOUND,
    UNBOUNDED,
    Bounds,
    Growth,
    Limit,
    Site,
    operator,
)
from distal.fields.noise.space import GRADIENT_SLOPE, gradient_noise
from distal.fields.repeat.cells import ROOM
from distal.fields.widths import deformed_width
from distal.lang import (
    abs,
    atan2,
    clamp,
    dot,
    exp2,
    floor,
    func,
    length,
    log2,
    max,
    min,
    select,
    sin,
    sqrt,
    vec3,
)

# Wrapping around the y axis


@func
def wrapped(p: vec3, radius: float) -> vec3:
    """Return the point before x was wrapped around a cylinder about the y axis.

    z is the distance from the axis. The middle of the shape is where z is ``radius``; an x of pi
    times the radius is behind.
    """
    return vec3(atan2(p.x, p.z) * radius, p.y, length(p.xz) - radius)


@func
def wrapped_inner(bounds: Bounds, radius: float) -> float:
    """Return the least distance of the wrapped shape from the axis."""
    return radius + bounds.low.z


@func
def wrapped_half(bounds: Bounds, radius: float) -> float:
    """Return the angle that the shape covers on either side."""
    return reach(bounds).x / radius


@func
def wrapped_value(d: float, p: vec3, radius: float, bounds: Bounds) -> float:
    """Return the value without the jump behind and the infinite stretch at the axis.

    The shape lies in a sector of an annulus. At the half plane behind and near the axis the value
    is clamped to the distance to this sector, from both sides; away from there the tolerance grows
    with the distance.
    """
    rho = length(p.xz)
    inner = wrapped_inner(bounds, radius)
    half = wrapped_half(bounds, radius)
    turn = clamp(abs(atan2(p.x, p.z)) - half, -0.5 * PI, 0.5 * PI)
    sector = max(inner - rho, rho * sin(turn))
    behind = select(p.z > 0.0, rho, abs(p.x))
    free = min(behind, max(rho - 0.75 * inner, 0.0))
    held = min(max(d, sector), sector + free)
    return max(held, box_distance(p, wrapped_bounds(bounds, radius)))


@func
def wrapped_slope(slope: float, bounds: Bounds, radius: float) -> float:
    """Return the slope.

    The factor is the radius divided by the least distance from the axis at which the child is
    evaluated.
    """
    inner = wrapped_inner(bounds, radius)
    crowded = inner <= 1e-3 * radius or wrapped_half(bounds, radius) > 0.98 * PI
    stretch = radius / max(0.75 * inner, 1e-12)
    return select(crowded, UNBOUNDED, max(slope * max(stretch, 1.0), 2.0))


@func
def wrapped_bounds(bounds: Bounds, radius: float) -> Bounds:
    """Return the box of the sector that the shape covers."""
    r = radius + bounds.high.z
    return Bounds(vec3(-r, bounds.low.y, -r), vec3(r, bounds.high.y, r))


# Sphere fold


@func
def sphere_folded(p: vec3, inner: float, outer: float) -> vec3:
    """Return the point before the sphere fold.

    It inverts space within ``outer`` and enlarges it within ``inner``.

    Source: the sphere fold of the Mandelbox (Tom Lowe, 2010).
    """
    square = clamp(dot(p, p), inner * inner, outer * outer)
    return p * (outer * outer / square)


@func
def sphere_folded_bounds(bounds: Bounds, outer: float) -> Bounds:
    """Return the box around the box and the sphere, which the outside is also mapped into."""
    return Bounds(min(bounds.low, vec3(-outer)), max(bounds.high, vec3(outer)))


@func
def sphere_folded_value(d: float, p: vec3, outer: float, bounds: Bounds) -> float:
    """Return the value, but at least the distance to the box."""
    return max(d, box_distance(p, sphere_folded_bounds(bounds, outer)))


@func
def sphere_folded_slope(slope: float, inner: float, outer: float) -> float:
    """Return the slope: the map is conformal and has its largest factor in the middle."""
    return max(slope * (outer * outer) / (inner * inner), 1.0)


# Copies of growing size


@func
def nearest_of(bounds: Bounds) -> float:
    """Return the least distance of a box from the origin."""
    return length(max(max(bounds.low, -bounds.high), vec3(0.0)))


@func
def farthest_of(bounds: Bounds) -> float:
    """Return the largest distance of a box from the origin."""
    r = reach(bounds)
    return select(max(max(r.x, r.y), r.z) > ENDLESS, UNBOUNDED, length(r))


@func
def scale_index(p: vec3, ratio: float, bounds: Bounds) -> float:
    """Return the index of the evaluated copy; borders are halfway between the copies' annuli."""
    border = 0.5 * (nearest_of(bounds) + farthest_of(bounds) / ratio)
    return floor(log2(max(length(p), 1e-12) / border) / log2(ratio))


@func
def rescaled(p: vec3, ratio: float, bounds: Bounds) -> Site:
    """Return the point in the nearest copy; each copy is ``ratio`` times as large as the last.

    This repeats the logarithm of the distance from the origin (log-polar space).
    """
    index = scale_index(p, ratio, bounds)
    return Site(p * exp2(-index * log2(ratio)), vec3(index, 0.0, 0.0))


@func
def rescaled_value(d: float, p: vec3, ratio: float, bounds: Bounds) -> float:
    """Return the value, limited by the annuli of the copies inside and outside (``repeat``)."""
    scale = exp2(scale_index(p, ratio, bounds) * log2(ratio))
    rho = length(p) / scale
    near, far = nearest_of(bounds), farthest_of(bounds)
    own = max(near - rho, rho - far)
    others = min(rho - far / ratio, near * ratio - rho)
    return scale * min(max(d, own), others)


@func
def rescaled_slope(slope: float, bounds: Bounds, ratio: float) -> float:
    """Return the child's slope if its annulus leaves a gap to the next."""
    near, far = nearest_of(bounds), farthest_of(bounds)
    crowded = far * (1.0 + 2.0 * ROOM) >= near * ratio
    return select(crowded, UNBOUNDED, max(slope, 1.0))


@func
def rescaled_bounds(bounds: Bounds) -> Bounds:
    """Return an infinite box."""
    return Bounds(vec3(-UNBOUNDED), vec3(UNBOUNDED))


# Displacement by noise


@func
def warped(p: vec3, amount: float, frequency: float, seed: int = 0) -> vec3:
    """Return the point before each coordinate was moved by up to ``amount``, by gradient noise."""
    q = p * frequency
    x = gradient_noise(q, 3 * seed)
    y = gradient_noise(q, 3 * seed + 1)
    z = gradient_noise(q, 3 * seed + 2)
    return p - amount * vec3(x, y, z)


@func
def warped_bounds(bounds: Bounds, amount: float) -> Bounds:
    """Return the box, enlarged by the amount."""
    return Bounds(bounds.low - abs(amount), bounds.high + abs(amount))


@func
def warped_value(d: float, p: vec3, amount: float, bounds: Bounds) -> float:
    """Return the value, but at least the distance to the box."""
    return max(d, box_distance(p, warped_bounds(bounds, amount)))


@func
def warped_slope(slope: float, amount: float, frequency: float) -> float:
    """Return the slope times (1 + the largest stretch of three noises together)."""
    return max(slope, 1.0) * (1.0 + sqrt(3.0) * GRADIENT_SLOPE * abs(amount * frequency))


def fold_requirement(inner: float, outer: float) -> str | None:
    """Return why the two radii are invalid, or None."""
    return None if inner < outer else "outer must be above inner"


def ratio_requirement(ratio: float) -> str | None:
    """Return why the ratio is invalid, or None."""
    return None if ratio > 1.0 else "ratio must be above 1"


WRAP = operator(
    "wrap",
    point=wrapped,
    finish=wrapped_value,
    slope=wrapped_slope,
    bounds=wrapped_bounds,
    limits={"radius": Limit.POSITIVE},
    needs="a shape that ends along x before it meets itself behind, and along z before the axis",
    growth=Growth.HELD,
    width=deformed_width,
)
SPHERE_FOLD = operator(
    "sphere fold",
    point=sphere_folded,
    finish=sphere_folded_value,
    slope=sphere_folded_slope,
    bounds=sphere_folded_bounds,
    limits={"inner": Limit.POSITIVE, "outer": Limit.POSITIVE},
    requires=fold_requirement,
    growth=Growth.HELD,
    width=deformed_width,
)
REPEAT_SCALED = operator(
    "repeat scaled",
    point=rescaled,
    finish=rescaled_value,
    keeps=INSIDE_AND_BOUND,
    slope=rescaled_slope,
    bounds=rescaled_bounds,
    limits={"ratio": Limit.POSITIVE},
    requires=ratio_requirement,
    needs="a shape beside the origin whose farthest point is less than ratio times as far as its "
    "nearest",
    growth=Growth.HELD,
)
WARP = operator(
    "warp",
    point=warped,
    finish=warped_value,
    slope=warped_slope,
    bounds=warped_bounds,
    growth=Growth.HELD,
    width=deformed_width,
)
