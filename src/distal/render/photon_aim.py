"""Where photons start: rays from the lights through the box around what bundles light.

Input: the lights, the box ("target") around the surfaces that bundle light (``bundles``), random
numbers. Output: the ray of a photon with its power. A photon's ray is a random one of all rays of a
light that cross the box; the rays of a lamp that is in the box all count. ``is_followed`` tells of
any ray that meets a light whether it is one of these, so that paths leave exactly their light to
photons. Does not depend on the scene's shapes.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import ENDLESS, Bounds
from distal.lang import all, dot, func, length, max, min, select, struct, vec2, vec3
from distal.render.camera import Ray
from distal.render.emitters import Emission, sample_light
from distal.render.lights import FAR_AWAY, LightSample
from distal.render.march import crossing
from distal.render.material import Surface, brightest
from distal.render.sampling.points import Stream, single, triple
from distal.render.sampling.warps import on_sphere
from distal.render.surroundings import DirectionSample

PI = 3.14159265358979
# Facets of this width or less (``Surface.roughness`` squared) bundle light: narrower lobes are
# hardly met by a path from a matte surface.
WIDEST = 0.07
# Directions of an environment that are so many times as dense as even ones count as lamps.
BRIGHT = 30.0
# What is added to the cosine of a light to a face, so that rounding errors hide no face.
GRAZING = 1e-3
# The sphere about a lamp in the box, on which its photons are chosen, in radii of the lamp; of a
# lamp without a radius it is this part of the box.
ABOUT = 2.0
SMALL = 0.01
# The decisions of a photon before its first segment.
WHICH_LIGHT = 0
PLACE_ON_TARGET = 1
PLACE_ON_LIGHT = 2
WAVELENGTH = 3
TARGET_DECISIONS = 4


@struct
class Departure:
    """The start of a photon.

    Attributes:
        ray: Its ray, from the light on.
        power: The power of all photons of this light, if all were like this one; 0 if there is
            none.
    """

    ray: Ray
    power: vec3


@struct
class Crossing:
    """A random place on a surface that the rays of a light cross.

    Attributes:
        p: The place.
        n: The unit normal on the side of the light.
        density: The density of the place by area.
    """

    p: vec3
    n: vec3
    density: float


@func
def bundles(surface: Surface) -> bool:
    """Return whether a surface passes light on in narrow bundles only: mirrors, glass, metals.

    Photons are followed over such surfaces; they end at others, unless these mirror perfectly.
    """
    narrow = surface.roughness * surface.roughness <= WIDEST
    even = max(brightest(surface.color) * surface.diffuse, surface.bsdf_share)
    return narrow and even <= 0.0


@func
def no_target() -> Bounds:
    """Return a box around nothing."""
    return Bounds(vec3(ENDLESS), vec3(-ENDLESS))


@func
def target_with(target: Bounds, bounds: Bounds) -> Bounds:
    """Return the box around two boxes; an infinite or empty one is left out."""
    sides = bounds.high - bounds.low
    least = min(sides.x, sides.y, sides.z)
    finite = least >= 0.0 and max(sides.x, sides.y, sides.z) < ENDLESS
    low = select(finite, min(target.low, bounds.low), target.low)
    high = select(finite, max(target.high, bounds.high), target.high)
    return Bounds(low, high)


@func
def is_in_target(target: Bounds, p: vec3, light: LightSample) -> bool:
    """Return whether a lamp, seen from a point, touches the box."""
    middle = p + light.distance * light.direction
    gap = length(max(max(target.low - middle, middle - target.high), vec3(0.0)))
    room = 1.01 * light.radius * light.distance + 1e-4 * length(target.high - target.low)
    return light.distance < FAR_AWAY and gap <= room


@func
def is_followed(target: Bounds, ray: Ray, distance: float, light: LightSample) -> bool:
    """Return whether photons follow a ray backwards, from the light that it meets.

    Args:
        target: The box that photons cross.
        ray: Ray.
        distance: Where it meets the light.
        light: The light at the ray's origin.
    """
    span = crossing(ray, target)
    crosses = target.low.x < target.high.x and span.x <= span.y and span.x < distance
    return crosses or is_in_target(target, ray.origin, light)


@func
def is_bright(density: float) -> bool:
    """Return whether an environment's direction of this density counts as that of a lamp."""
    return density * (4.0 * PI) > BRIGHT


@func
def is_followed_from_afar(target: Bounds, ray: Ray, density: float) -> bool:
    """Return whether photons follow a ray backwards, from the environment that it meets.

    Args:
        target: The box that photons cross.
        ray: Ray.
        density: The density with which its direction is chosen.
    """
    span = crossing(ray, target)
    return target.low.x < target.high.x and span.x <= span.y and is_bright(density)


@func
def place_on_box(target: Bounds, light: LightSample, u: vec3) -> Crossing:
    """Return a random place on the box, on a face that a light shines on from outside.

    Args:
        target: The box.
        light: The light at the middle of the box.
        u: Three random numbers; the third chooses the face.
    """
    middle = 0.5 * (target.low + target.high)
    half = 0.5 * (target.high - target.low)
    half = max(half, vec3(1e-6 * max(half.x, half.y, half.z)))
    area = 4.0 * vec3(half.y * half.z, half.z * half.x, half.x * half.y)
    # A face gets light from what stands above its plane: the cosine of the highest place of the
    # lamp, less the height of the plane over the middle.
    near = select(light.distance < FAR_AWAY, half / light.distance, vec3(0.0))
    above = vec3(light.radius + GRAZING) - near
    up = area * max(light.direction + above, vec3(0.0))
    down = area * max(above - light.direction, vec3(0.0))
    both = up + down
    total = both.x + both.y + both.z
    at = u.z * total
    is_x = at < both.x
    is_y = not is_x and at < both.x + both.y
    axis = select(is_x, vec3(1.0, 0.0, 0.0), select(is_y, vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0)))
    left = at - select(is_x, 0.0, select(is_y, both.x, both.x + both.y))
    is_up = left < dot(up, axis)
    n = select(is_up, axis, -axis)
    across = 2.0 * u.xy - 1.0
    on_face = vec3(
        select(is_x, 0.0, across.x), select(is_y, 0.0, select(is_x, across.x, across.y)), across.y
    )
    flat = vec3(on_face.x, on_face.y, select(is_x or is_y, on_face.z, 0.0))
    density = dot(select(is_up, up, down), axis) / (total * dot(area, axis))
    return Crossing(middle + half * (n + flat), n, density)


@func
def place_about_lamp(target: Bounds, light: LightSample, u: vec2) -> Crossing:
    """Return a random place on a sphere around a lamp.

    Args:
        target: The box in which the lamp is.
        light: The light at the middle of the box.
        u: Two random numbers.
    """
    lamp = 0.5 * (target.low + target.high) + light.distance * light.direction
    radius = ABOUT * light.radius * light.distance
    if radius <= 0.0:
        radius = SMALL * length(target.high - target.low)
    outward = on_sphere(u)
    return Crossing(lamp + radius * outward, -outward, 1.0 / (4.0 * PI * radius * radius))


@func
def departure(
    target: Bounds,
    lights: Callable[[int, vec3], LightSample],
    light_count: int,
    around: Callable[[vec3], vec3],
    directions: Callable[[vec3], DirectionSample],
    has_directions: bool,
    bounds: Bounds,
    far: float,
    stream: Stream,
) -> Departure:
    """Return the start of a random photon.

    Args:
        target: The box that photons cross.
        lights: The light with a given index, from 0, at a point.
        light_count: How many lights there are.
        around: Ambient light from a direction.
        directions: Random directions for ambient light, by three random numbers.
        has_directions: Whether there are such directions; a constant.
        bounds: The box of the scene: photons of distant lights start at its sides.
        far: The distance at which rays end; photons start half as far away at most.
        stream: The random numbers of the photon.
    """
    middle = 0.5 * (target.low + target.high)
    total = 0.0
    for i in range(light_count):
        total += brightest(lights(i, middle).radiance)
    beside = select(has_directions, max(total, 1e-6), 0.0)
    # Lights are chosen by how much they send to the middle of the box.
    left = single(stream, WHICH_LIGHT) * (total + beside)
    chosen = -1
    share = beside
    for i in range(light_count):
        bright = brightest(lights(i, middle).radiance)
        if chosen < 0 and bright > 0.0:
            if left < bright:
                chosen = i
                share = bright
            left -= bright
    u = triple(stream, PLACE_ON_LIGHT)
    emission = Emission(vec3(0.0, 1.0, 0.0), FAR_AWAY, vec3(0.0), 0.0)
    place = Crossing(middle, vec3(0.0, 1.0, 0.0), 1.0)
    spot = triple(stream, PLACE_ON_TARGET)
    if chosen >= 0:
        light = lights(chosen, middle)
        place = place_on_box(target, light, spot)
        if is_in_target(target, middle, light):
            place = place_about_lamp(target, light, spot.xy)
        emission = sample_light(lights(chosen, place.p), u.xy)
    elif has_directions:
        way = directions(u)
        sky = LightSample(way.direction, FAR_AWAY, vec3(0.0), 0.0)
        place = place_on_box(target, sky, spot)
        weight = around(way.direction) / max(way.density, 1e-30)
        weight = select(is_bright(way.density), weight, vec3(0.0))
        emission = Emission(way.direction, FAR_AWAY, weight, way.density)
    chance = share / max(total + beside, 1e-30)
    cosine = max(dot(emission.direction, place.n), 0.0)
    power = emission.weight * (cosine / max(place.density * chance, 1e-30))
    out = 1e-4 * length(target.high - target.low)
    way_out = crossing(Ray(place.p, emission.direction), bounds).y + out
    t = select(emission.distance >= FAR_AWAY, min(way_out, 0.5 * far), emission.distance)
    start = place.p + t * emission.direction
    whole = total + beside > 0.0 and t > 0.0 and all(target.low < target.high)
    return Departure(Ray(start, -emission.direction), select(whole, power, vec3(0.0)))
