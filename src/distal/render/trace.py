"""Trace a ray to a surface: segments among planes, and the normal and the material at their end.

Input: a ray, a field, the material at each point, and the parameters of the march. Output: a
``Hit`` (how far the ray went) or a ``SurfacePoint`` (the surface there, ready for shading). Direct
light, mirrors, glass, views, layers and the probe all start here. Does not depend on lights or
cameras.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.boxes import everywhere
from distal.fields.guarantees import UNBOUNDED, Bounds
from distal.lang import (
    Field3,
    abs,
    clamp,
    dot,
    func,
    gradient,
    length,
    max,
    min,
    select,
    struct,
    vec3,
)
from distal.render.bump import bumped_normal
from distal.render.camera import Ray
from distal.render.footprint import Cone, Footprint, footprint_at
from distal.render.march import PASSED, TOO_FAR, Hit, March
from distal.render.material import Shares, Surface, shares
from distal.render.normals import EXACT, normal, unit_or_up
from distal.render.segment import FORGIVING, rounding_of, segment

# Steps of Newton's method. The largest error of a depth of 4 (a sphere, 160x120, without grazing
# rays) after 0, 1 and 2 steps: 4e-3, 6e-7, 6e-7; where a ray hits it at 6 degrees 2e-2, 1e-3, 5e-6.
NEWTON_STEPS = 2


@struct
class SurfacePoint:
    """The surface at the end of a ray.

    Attributes:
        t: Distance along the ray, in scene units.
        inside: Whether the ray started inside a solid.
        p: The point on the surface.
        n: The unit normal there, on the side that the ray came from.
        surface: The material there.
        shares: The weights of scattered, mirrored and transmitted light.
        slope: |gradient| of the field there.
    """

    t: float
    inside: bool
    p: vec3
    n: vec3
    surface: Surface
    shares: Shares
    slope: float = 1.0


@func
def plane_crossing(plane: Field3, ray: Ray) -> float:
    """Return the distance along a ray to a plane; ``UNBOUNDED`` if it is not ahead.

    Args:
        plane: A field that is linear in the point; positive at the ray's origin.
        ray: Ray.
    """
    height = plane(ray.origin)
    fall = -dot(gradient(plane, ray.origin), ray.direction)
    return select(fall > 0.0, min(height / max(fall, 1e-30), UNBOUNDED), UNBOUNDED)


@func
def segment_or_plane(
    field: Field3,
    planes: Field3,
    nearest_plane: Callable[[Ray], float],
    ray: Ray,
    side: float,
    slope: float,
    bounds: Bounds,
    numbers: March,
    farthest_plane: float,
    steps: int,
) -> Hit:
    """Return the next surface along a ray; planes are met in closed form.

    A plane is met at any distance, so that it ends at the true horizon, and rays that pass close to
    it take no more steps than others.

    Args:
        field: Signed distance without the planes.
        planes: Signed distance of the planes' union.
        nearest_plane: Distance along a ray that starts above all planes to the first of them.
        ray: Ray.
        side: 1 if the ray runs outside, -1 inside; 0 if that is not known.
        slope: As for ``segment``, of the field of all.
        bounds: Box around the surface without the planes.
        numbers: The parameters of the march.
        farthest_plane: Planes farther along the ray are not seen.
        steps: Maximum number of evaluations of the field.
    """
    # A ray from below a plane starts inside a solid, and is followed through all surfaces.
    inside = side < 0.0 or (side == 0.0 and planes(ray.origin) <= 0.0)
    met = UNBOUNDED
    if not inside:
        met = max(nearest_plane(ray), 0.0)

    def nearest(p: vec3) -> float:
        d = field(p)
        return select(inside, min(d, planes(p)), d)

    # A ray from a plane is off the other surfaces.
    from_plane = planes(ray.origin) < 4.0 * rounding_of(ray.origin)
    leaving = select(from_plane and not inside, 0.0, slope)
    box = everywhere() if inside else bounds
    far = min(numbers.far, met)
    limited = March(numbers.divisor, numbers.near, far, numbers.threshold, numbers.steepest)
    hit = segment(nearest, ray, side, leaving, box, limited, steps)
    if hit.found or met >= farthest_plane:
        return hit
    lost = select(hit.lost == TOO_FAR, PASSED, hit.lost)  # the plane ended it, not the far limit
    # The eye sees what is behind the place where steps ran out; a path ends there.
    is_first = side == 0.0
    return Hit(met, is_first or lost == PASSED, hit.steps, select(is_first, 1.0, side), lost)


@func
def hit_point(ray: Ray, hit: Hit) -> vec3:
    """Return the point where a ray ended."""
    return ray.origin + hit.t * ray.direction


@func
def point_before(ray: Ray, hit: Hit, numbers: March) -> vec3:
    """Return the point just before the end of a ray, where normals are evaluated.

    Many fields have no gradient on the surface itself in 32 bits (a signed length of the vector to
    the nearest edge, for example).
    """
    return ray.origin + hit.t * (1.0 - 0.5 * numbers.threshold) * ray.direction


@func
def facing_normal(
    field: Field3, ray: Ray, hit: Hit, numbers: March, normals: int, normal_step: float
) -> vec3:
    """Return the unit normal where a ray ended, on the side that the ray came from.

    Args:
        field: Signed distance.
        ray: Ray.
        hit: Where it ended.
        numbers: The parameters of the march.
        normals: EXACT, SIX_TAPS, TETRAHEDRON or FORWARD of ``normals``; a constant.
        normal_step: Step of the differences, as a part of the distance.
    """
    step = normal_step * hit.t
    return hit.side * normal(field, point_before(ray, hit, numbers), normals, step)


@func
def ray_offset(numbers: March, t: float, hybrid: bool) -> float:
    """Return the height above a surface at which new rays start, beyond the error of a march."""
    return (3.0 if hybrid else 2.0) * numbers.threshold * t


@func
def refined(field: Field3, ray: Ray, hit: Hit, numbers: March, start: float) -> float:
    """Return the distance to the surface, more precise than that of the march.

    Newton's method along the ray, limited to the error of a hit. The distance of a ray that only
    passes the surface within the threshold is not changed.

    Args:
        field: Signed distance.
        ray: Ray.
        hit: The hit of the march.
        numbers: The parameters of the march.
        start: Distance along the ray at which the method starts.
    """
    t = start
    margin = FORGIVING * numbers.threshold * hit.t
    for _ in range(NEWTON_STEPS):
        p = ray.origin + t * ray.direction
        slope = dot(gradient(field, p), ray.direction)
        step = -field(p) / slope if abs(slope) > 1e-3 else 0.0
        t = clamp(t + step, hit.t - margin, hit.t + margin)
    return t


@func
def surface_point(
    ray: Ray,
    hit: Hit,
    field_of: Callable[[vec3, int], float],
    surface: Callable[[vec3, Footprint, int], Surface],
    cone: Cone,
    numbers: March,
    normals: int,
    normal_step: float,
) -> SurfacePoint:
    """Return the surface at the end of a ray, with its normal and material.

    This is a separate function, so that rays that hit nothing compute neither.

    Args:
        ray: Ray.
        hit: Where it ended, at a surface.
        field_of: Signed distance near a surface of a part (``Hit.part``).
        surface: The material at a point of a part, averaged over a footprint.
        cone: The cone of the ray.
        numbers: The parameters of the march.
        normals: The method for normals; a constant of ``normals``.
        normal_step: As for ``facing_normal``.
    """

    def field(q: vec3) -> float:
        return field_of(q, hit.part)

    inside = hit.side < 0.0
    p = hit_point(ray, hit)
    step = normal_step * hit.t
    n = vec3(0.0)
    slope = 1.0
    if normals == EXACT:
        steepest = gradient(field, point_before(ray, hit, numbers))
        n = hit.side * unit_or_up(steepest)
        slope = length(steepest)
    else:
        n = facing_normal(field, ray, hit, numbers, normals, normal_step)
        slope = abs(field(p + step * n) - field(p - step * n)) / (2.0 * step)
    material = surface(p, footprint_at(cone, ray.direction, hit.t, n), hit.part)
    n = bumped_normal(n, hit.side * material.tilt, -ray.direction)
    return SurfacePoint(
        hit.t, inside, p, n, material, shares(material, -dot(n, ray.direction), inside), slope
    )
