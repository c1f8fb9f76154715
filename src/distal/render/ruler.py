"""A ruler over a picture: the place on the surface under a pointer, and where places are seen.

Input: a place in the picture, and the functions of a scene; or two places in space and its camera.
Output: numbers, which windows and pages read as the bits of a row of pixels (``guide.bytes_of``).

A place near a sharp edge or corner is moved onto it. Samples around the place are moved onto the
surface; each gives a plane there. The place's own plane and one that differs from it meet in an
edge; a third plane makes it a corner. This is repeated around what was found, with a shorter reach:
what is rounded is flat at the last one, and the place stays where it is.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import UNBOUNDED, Bounds
from distal.lang import (
    Field3,
    abs,
    clamp,
    cos,
    cross,
    dot,
    floor,
    func,
    length,
    max,
    min,
    mix,
    normalize,
    select,
    sin,
    sqrt,
    struct,
    value_and_gradient,
    vec2,
    vec3,
    vec4,
)
from distal.render.camera import Ray
from distal.render.footprint import pixel_cone
from distal.render.guide import FiniteParts, bytes_of, joined
from distal.render.march import Hit, March
from distal.render.normals import tangent, unit_or_up
from distal.render.trace import point_before, refined

# What a place is on, in the order of ``SurfacePlace.kind``.
KINDS = ("nothing", "surface", "edge", "corner")
NOTHING, SURFACE, EDGE, CORNER = range(len(KINDS))
# The numbers of a place that hosts get, in the order of ``place_number``.
PLACE_NUMBERS = ("x", "y", "z", "kind", "pixel")
# The points of a ruler whose places in the picture hosts get: some cameras bend straight lines.
POINTS = 17
# The numbers of a ruler, in the order of ``ruler_number``; then x and y of each point's place.
RULER_NUMBERS = ("distance", "x", "y", "z")
# The planes that cut along these: the normal of each, and its least and greatest offset;
# then the diagonal of the box.
CUT_AXES = ("x", "y", "z", "view")
CUT_NUMBERS = (
    *(
        f"{axis}_{n}"
        for axis in CUT_AXES
        for n in ("normal_x", "normal_y", "normal_z", "low", "high")
    ),
    "diagonal",
)
# The place in the picture of a point that the camera does not see.
UNSEEN = 1e30

# How far a place may be from an edge or a corner that it is moved to, in pixels of a picture that
# is 480 pixels high.
_REACH_PX = 9.0
_HEIGHT_PX = 480.0
# Each round looks so many times nearer than the one before it. At the last one .25 pixels away:
# roundings with a radius above a pixel and a half are smooth.
_ROUNDS = 3
_NEARER = 6.0
_SAMPLES = 24
# The ray of the pointer, and rays around it: the nearest that hits counts.
_RAYS = 16
# The least cosine between a surface and a ray for which edges are searched as far as they are seen.
_LEAST_FACING = 0.2
_GOLDEN_ANGLE = 2.39996323
_NEWTON_STEPS = 3
# A sample's plane is taken so far off the surface, as a part of the reach: many exact fields have
# no gradient on it.
_OFF = 0.02
# The least sine of the angle between planes that meet in an edge, of a third one with their edge.
_SHARP = 0.34
# Steps of the search for a point's place in the picture; it has converged in 8 for lenses below 100
# degrees, in 20 for a panorama.
_SEARCH = 24
_STEP = 1e-3
_ARRIVED = 1e-4
_NONE = vec3(0.0)
# How far a scene without a finite part is cut, as ``scene/looks/boxes.py`` has it.
_REACH = 2.0


@struct
class SurfacePlace:
    """A place on a surface.

    Attributes:
        point: The place.
        kind: NOTHING, SURFACE, EDGE or CORNER.
        pixel: The size of a pixel there, in scene units.
    """

    point: vec3
    kind: int
    pixel: float


@struct
class SharpPlace:
    """What planes around a point meet in.

    Attributes:
        point: The place of the edge or corner.
        normal: The unit normal of the place's own plane.
        along: Unit direction of the edge.
        kind: SURFACE, EDGE or CORNER.
    """

    point: vec3
    normal: vec3
    along: vec3
    kind: int


@func
def direction_of(i: int) -> vec3:
    """Return one of ``_SAMPLES`` directions, spread evenly by a spiral."""
    z = 1.0 - 2.0 * (float(i) + 0.5) / float(_SAMPLES)
    ring = sqrt(max(1.0 - z * z, 0.0))
    angle = _GOLDEN_ANGLE * float(i)
    return vec3(ring * cos(angle), z, ring * sin(angle))


@func
def on_surface(field: Field3, start: vec3) -> vec3:
    """Return a point of the surface near another one, by Newton's method along the gradient."""
    p = start
    for _ in range(_NEWTON_STEPS):
        value, slope = value_and_gradient(field, p)
        p -= slope * (value / max(dot(slope, slope), 1e-6))
    return p


@func
def meeting_of_two(first: vec3, second: vec3, d: vec2) -> vec3:
    """Return the point nearest to the origin on the line in which two planes meet.

    Args:
        first: Unit normal of the first plane.
        second: Unit normal of the second plane.
        d: Distances of the planes from the origin along their normals.
    """
    cosine = dot(first, second)
    scale = 1.0 / max(1.0 - cosine * cosine, 1e-6)
    return scale * ((d.x - cosine * d.y) * first + (d.y - cosine * d.x) * second)


@func
def meeting_of_three(first: vec3, second: vec3, third: vec3, d: vec3) -> vec3:
    """Return the point in which three planes meet.

    Args:
        first: Unit normal of the first plane; no two are parallel.
        second: Unit normal of the second plane.
        third: Unit normal of the third plane.
        d: Distances of the planes from the origin along their normals.
    """
    across = cross(second, third)
    rest = d.y * cross(third, first) + d.z * cross(first, second)
    return (d.x * across + rest) / dot(first, across)


@func
def sharp_place(field: Field3, middle: vec3, normal: vec3, reach: float) -> SharpPlace:
    """Return the edge or corner that planes around a point meet in.

    Args:
        field: Signed distance.
        middle: The point, on the surface or next to it.
        normal: Unit normal of the place's own plane.
        reach: Distance of the samples.
    """
    o = vec4(0.0)
    planes = [o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, o]
    own = normal
    own_offset = 0.0
    nearest = -UNBOUNDED
    for i in range(_SAMPLES):
        start = middle + reach * direction_of(i)
        _, away = value_and_gradient(field, start)
        q = on_surface(field, start)
        _, steepest = value_and_gradient(field, q + _OFF * reach * unit_or_up(away))
        n = unit_or_up(steepest)
        offset = dot(n, q - middle)
        # A sample that did not arrive nearby tells nothing: it gets the own plane.
        is_near = length(q - middle) < 2.0 * reach
        planes[i] = vec4(select(is_near, n, normal), select(is_near, offset, 0.0))
        likeness = dot(n, normal) - abs(dot(q - middle, normal)) / reach
        is_own = is_near and likeness > nearest
        nearest = select(is_own, likeness, nearest)
        own = select(is_own, n, own)
        own_offset = select(is_own, offset, own_offset)
    second = own
    second_offset = own_offset
    most = 0.0
    for i in range(_SAMPLES):
        plane = planes[i]
        found = meeting_of_two(own, plane.xyz, vec2(own_offset, plane.w))
        sine = length(cross(own, plane.xyz))
        score = select(sine > _SHARP, sine * (1.0 - 0.5 * min(length(found) / reach, 1.0)), 0.0)
        is_best = score > most
        most = select(is_best, score, most)
        second = select(is_best, plane.xyz, second)
        second_offset = select(is_best, plane.w, second_offset)
    edge = meeting_of_two(own, second, vec2(own_offset, second_offset))
    along = unit_or_up(cross(own, second))
    third = along
    third_offset = 0.0
    steepest_third = _SHARP
    for i in range(_SAMPLES):
        lean = abs(dot(planes[i].xyz, along))
        is_steeper = lean > steepest_third
        steepest_third = select(is_steeper, lean, steepest_third)
        third = select(is_steeper, planes[i].xyz, third)
        third_offset = select(is_steeper, planes[i].w, third_offset)
    offsets_of_three = vec3(own_offset, second_offset, third_offset)
    corner = meeting_of_three(own, second, third, offsets_of_three)
    is_edge = most > 0.0 and length(edge) < 1.5 * reach
    is_corner = is_edge and steepest_third > _SHARP and length(corner) < 1.5 * reach
    kind = select(is_corner, CORNER, select(is_edge, EDGE, SURFACE))
    moved = select(is_corner, corner, select(is_edge, edge, _NONE))
    return SharpPlace(middle + moved, own, along, kind)


@func
def slid(point: vec3, along: vec3, ray: Ray, farthest: float) -> vec3:
    """Return the place of an edge that is nearest to a ray.

    Args:
        point: A place of the edge.
        along: Unit direction of the edge there.
        ray: The ray.
        farthest: The largest distance to go.
    """
    cosine = dot(along, ray.direction)
    way = point - ray.origin
    s = (cosine * dot(ray.direction, way) - dot(along, way)) / max(1.0 - cosine * cosine, 1e-3)
    return point + clamp(s, -farthest, farthest) * along


@func
def off_ray(point: vec3, ray: Ray) -> float:
    """Return the distance of a point from a ray."""
    return length(cross(point - ray.origin, ray.direction))


@func
def snapped(
    field: Field3, p: vec3, normal: vec3, ray: Ray, reach: float, pixel: float
) -> SurfacePlace:
    """Return the sharp edge or corner near a point of a surface; else the point itself.

    Args:
        field: Signed distance.
        p: The point.
        normal: The unit normal there.
        ray: The ray of the pointer.
        reach: How far the edge or corner may be from the ray.
        pixel: The size of a pixel there.
    """
    # What is near in the picture is far on a surface that is seen from the side.
    radius = reach / clamp(-dot(normal, ray.direction), _LEAST_FACING, 1.0)
    found = SharpPlace(p, normal, normal, EDGE)
    for i in range(_ROUNDS):
        if found.kind != SURFACE:
            found = sharp_place(field, found.point, found.normal, radius)
        if i == 0 and found.kind == EDGE:
            found.point = slid(found.point, found.along, ray, radius)
        radius = radius / _NEARER
    value, slope = value_and_gradient(field, found.point + 0.02 * pixel * normal)
    is_on = abs(value) < 0.25 * pixel * max(length(slope), 1e-3)
    is_sharp = found.kind != SURFACE and is_on and off_ray(found.point, ray) < reach
    return SurfacePlace(
        select(is_sharp, found.point, p), select(is_sharp, found.kind, SURFACE), pixel
    )


@func
def pointed(coord: vec2, pointer: vec2, resolution: vec2) -> vec2:
    """Return the pointer's place in the picture, as a value of the pixel (``guide.asked``).

    Args:
        coord: Middle of the pixel of the row.
        pointer: The pointer's place in pixels, from the picture's lower left.
        resolution: Size of the picture in pixels.
    """
    uv = (2.0 * pointer - resolution) / resolution.y
    return select(coord.x < 0.0, vec2(0.0), uv)


@func
def place_under(
    uv: vec2,
    resolution: vec2,
    camera: Callable[[vec2], Ray],
    first_hit: Callable[[Ray], Hit],
    field: Field3,
    numbers: March,
) -> SurfacePlace:
    """Return the place on the surface that is seen at a place in the picture.

    Args:
        uv: The place in the picture.
        resolution: Size of the picture in pixels.
        camera: Ray of a place in the picture.
        first_hit: First surface along a ray.
        field: Signed distance.
        numbers: The parameters of the march.
    """
    px = 2.0 / resolution.y
    reach_px = _REACH_PX * max(resolution.y / _HEIGHT_PX, 1.0)
    ray = Ray(vec3(0.0), vec3(0.0, 0.0, 1.0))
    hit = Hit(0.0, False, 0, 1.0)
    beside = False
    # A pointer beside an outline is at its edge: rays around the pointer find it.
    for i in range(_RAYS):
        angle = _GOLDEN_ANGLE * float(i)
        out = 0.7 * reach_px * px * sqrt(float(i) / float(_RAYS - 1))
        ray = camera(uv + out * vec2(cos(angle), sin(angle)))
        hit = first_hit(ray)
        beside = i > 0
        if hit.found:
            break
    if not hit.found:
        return SurfacePlace(vec3(0.0), NOTHING, 1.0)
    cone = pixel_cone(camera, uv, px)
    pixel = cone.width + cone.spread * hit.t
    _, steepest = value_and_gradient(field, point_before(ray, hit, numbers))
    t = refined(field, ray, hit, numbers, hit.t)
    p = ray.origin + t * ray.direction
    n = hit.side * unit_or_up(steepest)
    found = snapped(field, p, n, camera(uv), reach_px * pixel, pixel)
    kind = select(beside and found.kind == SURFACE, NOTHING, found.kind)
    return SurfacePlace(found.point, kind, pixel)


@func
def place_number(place: SurfacePlace, index: int) -> float:
    """Return one of the numbers in the order of ``PLACE_NUMBERS``."""
    p = place.point
    other = select(index == 3, float(place.kind), place.pixel)
    return select(index < 3, select(index == 0, p.x, select(index == 1, p.y, p.z)), other)


@func
def place_pixel(place: SurfacePlace, coord: vec2) -> vec4:
    """Return the pixel of a number in the row of a place."""
    return bytes_of(place_number(place, int(floor(coord.x))))


# A ruler in the picture


@func
def miss(ray: Ray, point: vec3) -> vec3:
    """Return how a ray's direction differs from that to a point, of length 1."""
    return normalize(point - ray.origin) - ray.direction


@func
def seen_at(point: vec3, camera: Callable[[vec2], Ray]) -> vec2:
    """Return the place in the picture at which a point is seen; ``UNSEEN`` if it is not.

    By Newton's method in the plane across the ray, for any camera.

    Args:
        point: The point, in scene units.
        camera: Ray of a place in the picture.
    """
    uv = vec2(0.0)
    off = UNBOUNDED
    for _ in range(_SEARCH):
        ray = camera(uv)
        right = tangent(ray.direction)
        upward = cross(ray.direction, right)
        here = miss(ray, point)
        aside = miss(camera(uv + vec2(_STEP, 0.0)), point) - here
        above = miss(camera(uv + vec2(0.0, _STEP)), point) - here
        off = length(here)
        x = vec2(dot(aside, right), dot(aside, upward)) / _STEP
        y = vec2(dot(above, right), dot(above, upward)) / _STEP
        e = vec2(dot(here, right), dot(here, upward))
        area = x.x * y.y - x.y * y.x
        scale = 1.0 / select(abs(area) > 1e-20, area, 1e-20)
        way = -scale * vec2(e.x * y.y - e.y * y.x, x.x * e.y - x.y * e.x)
        uv += way * min(1.0, 0.7 / max(length(way), 1e-20))
        uv = clamp(uv, vec2(-1e3), vec2(1e3))
    return select(off < _ARRIVED, uv, vec2(UNSEEN))


@func
def ruler_number(
    start: vec3, end: vec3, camera: Callable[[vec2], Ray], resolution: vec2, index: int
) -> float:
    """Return one of the numbers in the order of ``RULER_NUMBERS``, then of the points' places.

    Args:
        start: The first place.
        end: The second place.
        camera: Ray of a place in the picture.
        resolution: Size of the picture in pixels.
        index: The number.
    """
    way = end - start
    number = max(index - 4, 0)
    uv = seen_at(mix(start, end, float(number // 2) / float(POINTS - 1)), camera)
    place = select(uv.x < UNSEEN, 0.5 * (uv * resolution.y + resolution), uv)
    seen = select(number % 2 == 0, place.x, place.y)
    along = select(index == 1, way.x, select(index == 2, way.y, way.z))
    return select(index >= 4, seen, select(index == 0, length(way), along))


@func
def ruler_pixel(
    start: vec3, end: vec3, camera: Callable[[vec2], Ray], resolution: vec2, coord: vec2
) -> vec4:
    """Return the pixel of a number in the row of a ruler."""
    return bytes_of(ruler_number(start, end, camera, resolution, int(floor(coord.x))))


# Planes that cut a scene open


@func
def box_of_all(parts: FiniteParts) -> Bounds:
    """Return the box of all finite parts, the ground among them."""
    return joined(parts.others, parts.largest)


@func
def cut_number(box: Bounds, towards: vec3, index: int) -> float:
    """Return one of the numbers in the order of ``CUT_NUMBERS``.

    Args:
        box: The box of what can be cut.
        towards: Unit vector from the scene to the camera.
        index: The number.
    """
    # Without a finite part, the box around the origin is cut.
    is_empty = box.high.x < box.low.x
    low = select(is_empty, vec3(-_REACH), box.low)
    high = select(is_empty, vec3(_REACH), box.high)
    axis = index // 5
    normal = select(axis == 0, vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0))
    normal = select(axis == 2, vec3(0.0, 0.0, 1.0), select(axis == 3, towards, normal))
    middle = dot(0.5 * (low + high), normal)
    half = dot(0.5 * (high - low), abs(normal))
    number = index % 5
    end = select(number == 3, middle - half, middle + half)
    along = select(number == 0, normal.x, select(number == 1, normal.y, normal.z))
    return select(axis == 4, length(high - low), select(number < 3, along, end))


@func
def cut_pixel(box: Bounds, towards: vec3, coord: vec2) -> vec4:
    """Return the pixel of a number in the row of cuts."""
    return bytes_of(cut_number(box, towards, int(floor(coord.x))))


@func
def towards_eye(camera: Callable[[vec2], Ray]) -> vec3:
    """Return the unit vector against the ray in the middle of the picture."""
    return -camera(vec2(0.0)).direction
