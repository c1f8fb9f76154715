"""Path tracing: the light along a ray, by random paths through the scene.

Input: a ray, the functions of a scene and its numbers, random numbers. Output: linear light and
alpha, whose mean over many samples is the exact solution (an unbiased estimate). Each point on a
surface gathers light in two ways, which are weighted by how well each samples it (multiple
importance sampling): from one of the lights, along a shadow ray, and from where the scattered ray
goes on to. Paths end at random, less often the more light they carry (Russian roulette).

The camera, and mirrors and clear glass in front of it, see the background. Surfaces are lit by the
scene's lights and, from all other directions, by its ambient light: no light counts twice.

Source: Eric Veach, "Robust Monte Carlo Methods for Light Transport Simulation" (1997); Pharr,
    Jakob and Humphreys, "Physically Based Rendering" (4th edition, 2023), chapter 13.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from distal.fields.guarantees import UNBOUNDED
from distal.lang import (
    Field3,
    abs,
    dot,
    exp,
    func,
    min,
    select,
    struct,
    vec3,
    vec4,
)
from distal.render.bounce import ALL_INSIDE
from distal.render.camera import Ray
from distal.render.emitters import power_share, sample_light, seen_light
from distal.render.footprint import THIN, Cone, Footprint, continued
from distal.render.lights import LightSample
from distal.render.lost_rays import INSIDE, SHADOWS, marked, merged, reason
from distal.render.march import PASSED, Hit, March
from distal.render.material import Surface, brightest
from distal.render.normals import EXACT
from distal.render.sampling.points import Stream, pair, single, triple
from distal.render.scatter import all_specular, emitted, respond, sample
from distal.render.shade import Lit, Shading
from distal.render.trace import SurfacePoint, at_surface, surface_point, way_off

# The first segments of a path are always followed; later ones with this probability at most.
SURE: Final = 4
LIKELIEST = 0.95
# Segments of a path; with roulette a path reaches this many with a chance below 1e-5, unless it is
# caught in a lossless solid.
MOST_SEGMENTS: Final = 128
# The decisions of a path: those of the camera, then so many of each segment.
CAMERA_DECISIONS = 4
DECISIONS = 4
WHICH_LIGHT = 0
PLACE_ON_LIGHT = 1
DIRECTION = 2
ENDING = 3


@func
def met_lights(
    ray: Ray,
    length: float,
    sampled: float,
    lights: Callable[[int, vec3], LightSample],
    light_count: int,
) -> vec3:
    """Return the light of all discs that a ray meets before a surface, weighted.

    Args:
        ray: Ray.
        length: Distance to the surface; ``UNBOUNDED`` if there is none.
        sampled: The density per solid angle with which the direction was chosen; 0 if it was the
            only possible one, so that the discs cannot be sampled.
        lights: The light with a given index at a point.
        light_count: How many lights there are.
    """
    total = vec3(0.0)
    for i in range(light_count):
        seen = seen_light(lights(i, ray.origin), ray.direction)
        if seen.density > 0.0 and seen.distance < length:
            total += seen.radiance * power_share(sampled, seen.density / float(light_count))
    return total


@struct
class Start:
    """A ray from a surface.

    Attributes:
        ray: The ray.
        way: How far from the surface it starts.
    """

    ray: Ray
    way: float


@func
def start_from(field: Field3, point: SurfacePoint, direction: vec3) -> Start:
    """Return the ray from a surface in a direction, on either side.

    Args:
        field: Signed distance.
        point: The surface; ``t`` is the length of the ray that hit it.
        direction: Unit direction.
    """
    rise = dot(direction, point.n)
    goes = select((rise > 0.0) == point.inside, -1.0, 1.0)
    way = way_off(field, Ray(point.p, direction), goes, point.slope * abs(rise), point.t)
    return Start(Ray(point.p + way * direction, direction), way)


@func
def light_on(
    point: SurfacePoint,
    view: vec3,
    next_hit: Callable[[Ray], Hit],
    field: Field3,
    lights: Callable[[int, vec3], LightSample],
    light_count: int,
    stream: Stream,
    decision: int,
) -> Lit:
    """Return the light of one of the lights, chosen at random, that a surface sends to the eye.

    Args:
        point: The surface.
        view: Unit direction to the eye.
        next_hit: The first surface along a ray that starts on a surface.
        field: Signed distance.
        lights: The light with a given index, from 0, at a point.
        light_count: How many lights there are, at least one.
        stream: The random numbers of the path.
        decision: The number of the first decision of this segment.
    """
    count = float(light_count)
    which = min(int(single(stream, decision + WHICH_LIGHT) * count), light_count - 1)
    light = sample_light(lights(which, point.p), pair(stream, decision + PLACE_ON_LIGHT))
    found = respond(point.surface, view, light.direction, point.n, point.inside)
    color = found.value * light.weight * count
    lost = False
    if brightest(color) > 0.0:
        start = start_from(field, point, light.direction)
        hit = next_hit(start.ray)
        lost = hit.lost != PASSED
        is_open = not hit.found or hit.t + start.way > light.distance
        shared = power_share(light.density / count, found.density)
        color = color * select(is_open and hit.side > 0.0, shared, 0.0)
    return Lit(color, lost)


@func
def path_light(
    ray: Ray,
    first_hit: Callable[[Ray], Hit],
    next_hit: Callable[[Ray], Hit],
    field: Field3,
    field_of: Callable[[vec3, int], float],
    surface: Callable[[vec3, Footprint, int], Surface],
    lights: Callable[[int, vec3], LightSample],
    around: Callable[[vec3], vec3],
    background: Callable[[vec3], vec3],
    fog: Callable[[vec3], vec3],
    numbers: March,
    look: Shading,
    light_count: int,
    stream: Stream,
    normals: int = EXACT,
    normal_step: float = 1e-3,
    cone: Cone = THIN,
    counted: bool = False,
) -> vec4:
    """Return the light along a ray, by one random path.

    Args:
        ray: Ray.
        first_hit: The first surface along a ray of the camera.
        next_hit: The first surface along a ray that starts on a surface.
        field: Signed distance.
        field_of: Signed distance near a surface of a part (``Hit.part``).
        surface: The material at a point of a part, averaged over a footprint.
        lights: The light with a given index, from 0, at a point.
        around: Ambient light from a direction.
        background: Light from a direction without a surface, as the camera sees it.
        fog: Color of the fog in a direction.
        numbers: The parameters of the march.
        look: The density of fog.
        light_count: How many lights there are.
        stream: The random numbers of the path.
        normals: The method for normals; a constant of ``normals``.
        normal_step: Step of the normals' differences, in scene units at distance 1.
        cone: The cone of the ray.
        counted: Whether alpha is marked with why rays were lost (``lost_rays``); a constant.

    Returns:
        Linear light; alpha is 1 on a surface, 0 if there is none, ``ALL_INSIDE`` if the ray does
        not leave a solid.
    """
    color = vec3(0.0)
    throughput = vec3(1.0)
    alpha = 0.0
    lost = 0
    start = Start(ray, 0.0)
    width = cone
    seen = True  # only mirrors and clear glass are between the camera and the ray
    chosen = 0.0  # the density of the ray's direction; 0 if it was the only possible one
    for i in range(MOST_SEGMENTS):
        decision = CAMERA_DECISIONS + DECISIONS * i
        here = start.ray
        hit = first_hit(here) if i == 0 else next_hit(here)
        lost = merged(lost, merged(reason(hit.lost), select(i == 0 and hit.side < 0.0, INSIDE, 0)))
        met = UNBOUNDED
        if hit.found:
            met = at_surface(field, here, hit, numbers)
        if not seen and hit.side > 0.0:
            color += throughput * met_lights(here, met, chosen, lights, light_count)
        if not hit.found:
            if hit.side < 0.0:
                alpha = ALL_INSIDE if i == 0 else alpha
            else:
                color += throughput * (
                    background(here.direction) if seen else around(here.direction)
                )
            break
        alpha = 1.0
        found = surface_point(here, hit, field_of, surface, width, numbers, normals, normal_step)
        point = SurfacePoint(
            met, found.inside, here.origin + met * here.direction, found.n, found.surface,
            found.shares, found.slope,
        )  # fmt: skip
        if point.inside:
            throughput = throughput * exp(-point.surface.absorption * (met + start.way))
        else:
            clear = exp(-look.fog_density * met)
            lit = (1.0 - clear) * fog(here.direction) + clear * emitted(point.surface, point.inside)
            color += throughput * lit
            throughput = throughput * clear
        view = -here.direction
        if light_count > 0 and not all_specular(point.surface):
            direct = light_on(point, view, next_hit, field, lights, light_count, stream, decision)
            color += throughput * direct.color
            lost = merged(lost, select(direct.lost, SHADOWS, 0))
        u = triple(stream, decision + DIRECTION)
        onward = sample(point.surface, view, point.n, point.inside, u)
        throughput = throughput * onward.weight
        likely = 1.0
        if i >= SURE:
            likely = min(brightest(throughput), LIKELIEST)
        if single(stream, decision + ENDING) >= likely:
            break
        throughput = throughput / likely
        chosen = onward.density
        seen = seen and onward.specular
        start = start_from(field, point, onward.direction)
        width = continued(width, met)
    return vec4(color, marked(alpha, lost, counted))
