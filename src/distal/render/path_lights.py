"""The lights of a path: a random direction to one of them, and the light from there.

Input: a vertex of a path, and the lights of a scene. Output: light, weighted by how well this way
finds it and the scattered ray would (multiple importance sampling).
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import UNBOUNDED, Bounds
from distal.lang import (
    abs,
    exp,
    func,
    max,
    select,
    struct,
    vec3,
)
from distal.render.camera import Ray
from distal.render.emitters import power_share, sample_light
from distal.render.footprint import (
    Footprint,
    point_footprint,
)
from distal.render.lamps import Lamp, aim_at_lamp, lamps_density
from distal.render.lights import LightSample
from distal.render.march import PASSED, Hit
from distal.render.material import Surface, brightest
from distal.render.photon_aim import is_followed, is_followed_from_afar
from distal.render.scatter import Meeting, Response, emitted
from distal.render.shade import Lit, Shading
from distal.render.surroundings import DirectionSample
from distal.render.trace import hit_point
from distal.render.vertices import Vertex, start_from


@struct
class AimedLight:
    """A direction in which a path looks for light.

    Attributes:
        direction: Unit direction.
        distance: Distance to the light; what is nearer hides it.
        weight: The light's radiance divided by ``density``. Of a shape: 1 divided by it; the
            radiance is that of the surface which the direction meets.
        density: Density by solid angle; 0 for a point, which no ray meets by chance.
        is_shape: Whether the light is a shape.
        is_followed: Whether photons follow the light in this direction.
    """

    direction: vec3
    distance: float
    weight: vec3
    density: float
    is_shape: bool
    is_followed: bool = False


@func
def aim_at_light(
    vertex: Vertex,
    lights: Callable[[int, vec3], LightSample],
    light_count: int,
    lamps: Callable[[int], Lamp],
    lamp_count: int,
    around: Callable[[vec3], vec3],
    directions: Callable[[vec3], DirectionSample],
    has_directions: bool,
    chance: float,
    u: vec3,
    which: float,
    target: Bounds,
) -> AimedLight:
    """Return a random direction to one of the lights, chosen at random.

    Args:
        vertex: The surface.
        lights: The light with a given index, from 0, at a point.
        light_count: How many lights there are.
        lamps: The shape that emits light, by index.
        lamp_count: How many there are.
        around: Ambient light from a direction.
        directions: Random directions for ambient light, by three random numbers.
        has_directions: Whether there are such directions; a constant.
        chance: The probability with which each light is chosen.
        u: Random numbers for the place on the light.
        which: A random number that chooses the light.
        target: The box that photons cross.
    """
    index = int(which / chance)
    if index < light_count:
        known = lights(index, vertex.p)
        light = sample_light(known, u.xy)
        density = light.density * chance
        followed = is_followed(target, Ray(vertex.p, light.direction), light.distance, known)
        weight = light.weight / chance
        return AimedLight(light.direction, light.distance, weight, density, False, followed)
    if index < light_count + lamp_count:
        direction = aim_at_lamp(lamps(index - light_count), vertex.p, u)
        density = chance * lamps_density(vertex.p, direction, lamps, lamp_count)
        share = select(density > 0.0, 1.0 / max(density, 1e-30), 0.0)
        return AimedLight(direction, UNBOUNDED, vec3(share), density, True)
    if has_directions:
        far = directions(u)
        density = far.density * chance
        weight = around(far.direction) / max(density, 1e-30)
        followed = is_followed_from_afar(target, Ray(vertex.p, far.direction), far.density)
        return AimedLight(far.direction, UNBOUNDED, weight, density, False, followed)
    return AimedLight(vertex.n, UNBOUNDED, vec3(0.0), 0.0, False)


@func
def light_from(
    aim: AimedLight,
    vertex: Vertex,
    meeting: Meeting,
    respond: Callable[[Meeting, vec3], Response],
    next_hit: Callable[[Ray, int, float, int], Hit],
    surface: Callable[[vec3, Footprint, int], Surface],
    look: Shading,
    has_shapes: bool,
) -> Lit:
    """Return the light from a direction that a surface sends to the eye.

    Args:
        aim: The direction.
        vertex: The surface.
        meeting: The surface and the direction to the eye, for its response.
        respond: The response; as for ``paths.path_light``.
        next_hit: The next surface along a ray from a surface.
        surface: The material at a point of a part, averaged over a footprint.
        look: The density of fog.
        has_shapes: Whether shapes emit light; a constant.
    """
    found = respond(meeting, aim.direction)
    color = found.value * aim.weight
    start = start_from(vertex, aim.direction)
    if brightest(abs(color)) <= 0.0 or start.within != 0:
        return Lit(vec3(0.0), False)
    hit = next_hit(start.ray, start.within, start.slope, start.part)
    is_open = not hit.found or hit.t >= aim.distance
    shared = select(is_open, power_share(aim.density, found.density), 0.0)
    if has_shapes and aim.is_shape:
        shared = 0.0
        if hit.found:
            met = surface(hit_point(start.ray, hit), point_footprint(), hit.part)
            color = color * emitted(met, False) * exp(-look.fog_density * hit.t)
            shared = power_share(aim.density, found.density)
    return Lit(color * shared, hit.lost != PASSED)
