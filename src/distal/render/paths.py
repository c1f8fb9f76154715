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

from distal.fields.guarantees import UNBOUNDED, Bounds
from distal.lang import (
    abs,
    dot,
    exp,
    func,
    max,
    min,
    mix,
    select,
    struct,
    vec3,
    vec4,
)
from distal.lang.functions import apart
from distal.render.bounce import ALL_INSIDE
from distal.render.camera import Ray
from distal.render.dispersion import color_of, wavelength_of
from distal.render.emitters import power_share, sample_light, seen_light
from distal.render.footprint import (
    THIN,
    Cone,
    Footprint,
    continued,
    footprint_at,
    point_footprint,
)
from distal.render.lamps import Lamp, aim_at_lamp, lamps_density
from distal.render.lights import LightSample
from distal.render.lost_rays import INSIDE, SHADOWS, marked, merged, reason
from distal.render.march import PASSED, Hit, March
from distal.render.material import Surface, brightest
from distal.render.media import Interface, interface_at
from distal.render.normals import EXACT
from distal.render.photon_aim import bundles, is_followed, is_followed_from_afar
from distal.render.sampling.points import Stream, single, triple
from distal.render.scatter import Meeting, all_specular, emitted, meet, respond_to, sample_from
from distal.render.segment import landing, leaving_slope
from distal.render.shade import Lit, Shading
from distal.render.surroundings import DirectionSample
from distal.render.trace import facing_normal, hit_point

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
# The decisions of the camera.
WAVELENGTH = 3


@func
def met_lights(
    ray: Ray,
    length: float,
    sampled: float,
    lights: Callable[[int, vec3], LightSample],
    light_count: int,
    chance: float,
    target: Bounds,
    bundled: bool,
) -> vec3:
    """Return the light of all discs that a ray meets before a surface, weighted.

    Args:
        ray: Ray.
        length: Distance to the surface; ``UNBOUNDED`` if there is none.
        sampled: The density per solid angle with which the direction was chosen; 0 if it was the
            only possible one, so that the discs cannot be sampled.
        lights: The light with a given index at a point.
        light_count: How many lights there are.
        chance: The probability with which a surface chooses each of them.
        target: The box that photons cross.
        bundled: Whether the light that photons follow is left out.
    """
    total = vec3(0.0)
    for i in range(light_count):
        light = lights(i, ray.origin)
        seen = seen_light(light, ray.direction)
        followed = bundled and is_followed(target, ray, seen.distance, light)
        if seen.density > 0.0 and seen.distance < length and not followed:
            total += seen.radiance * power_share(sampled, seen.density * chance)
    return total


@struct
class Vertex:
    """A place on a surface where a path turns.

    Attributes:
        t: How far the path came on its last ray.
        p: The place.
        n: The unit normal on the side that the path came from.
        slope: |gradient| of the field.
        part: The part that has the surface (``Hit.part``).
        within: The bodies in which the path came.
        interface: What it met: the material, the bodies on the other side.
    """

    t: float
    p: vec3
    n: vec3
    slope: float
    part: int
    within: int
    interface: Interface


@func
def vertex_at(
    ray: Ray,
    hit: Hit,
    within: int,
    field_of: Callable[[vec3, int], float],
    surface: Callable[[vec3, Footprint, int], Surface],
    cone: Cone,
    numbers: March,
    normals: int,
    normal_step: float,
    bodies: int,
    common: int,
    wavelength: float,
) -> Vertex:
    """Return the place where a ray met a surface.

    Args:
        ray: Ray.
        hit: Where it ended, at a surface.
        within: The bodies in which it ran.
        field_of: Signed distance near a surface of a part (``Hit.part``).
        surface: The material at a point of a part, averaged over a footprint.
        cone: The cone of the ray.
        numbers: The parameters of the march.
        normals: The method for normals; a constant of ``normals``.
        normal_step: As for ``facing_normal``.
        bodies: How many bodies the scene has; a constant.
        common: The body of shapes without a priority; a constant.
        wavelength: The wavelength of the path, in nanometers.
    """

    def field(q: vec3) -> float:
        return field_of(q, hit.part)

    place = landing(field, ray, hit)
    n = hit.side * place.n
    if normals != EXACT:
        n = facing_normal(field, ray, hit, numbers, normals, normal_step)
    footprint = footprint_at(cone, ray.direction, place.t, n)
    own = surface(place.p, footprint, hit.part)
    met = interface_at(own, place.p, footprint, hit, within, surface, bodies, common, wavelength)
    return Vertex(place.t, place.p, n, place.slope, hit.part, within, met)


@struct
class Start:
    """A ray from a surface, as ``RayFunctions.next_hit`` takes it.

    Attributes:
        ray: The ray.
        within: The bodies in which it runs.
        slope: How fast the field grows along it.
        part: The part that has the surface (``Hit.part``).
    """

    ray: Ray
    within: int
    slope: float
    part: int


@func
def start_from(vertex: Vertex, direction: vec3) -> Start:
    """Return the ray from a surface in a direction, on either side."""
    rise = dot(direction, vertex.n)
    within = select(rise > 0.0, vertex.within, vertex.interface.within)
    slope = leaving_slope(vertex.slope, vertex.n, direction)
    return Start(Ray(vertex.p, direction), within, slope, vertex.part)


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
        next_hit: The next surface along a ray from a surface.
        surface: The material at a point of a part, averaged over a footprint.
        look: The density of fog.
        has_shapes: Whether shapes emit light; a constant.
    """
    found = respond_to(meeting, aim.direction)
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


@apart
@func
def path_light(
    ray: Ray,
    first_hit: Callable[[Ray], Hit],
    first_within: Callable[[Ray, Hit], int],
    next_hit: Callable[[Ray, int, float, int], Hit],
    field_of: Callable[[vec3, int], float],
    surface: Callable[[vec3, Footprint, int], Surface],
    lights: Callable[[int, vec3], LightSample],
    around: Callable[[vec3], vec3],
    directions: Callable[[vec3], DirectionSample],
    directions_density: Callable[[vec3], float],
    has_directions: bool,
    lamps: Callable[[int], Lamp],
    background: Callable[[vec3], vec3],
    fog: Callable[[vec3], vec3],
    numbers: March,
    look: Shading,
    light_count: int,
    lamp_count: int,
    bodies: int,
    common: int,
    stream: Stream,
    caustics: Callable[[Vertex, Meeting, Stream], vec3],
    target: Bounds,
    has_photons: bool,
    normals: int = EXACT,
    normal_step: float = 1e-3,
    cone: Cone = THIN,
    counted: bool = False,
) -> vec4:
    """Return the light along a ray, by one random path.

    Args:
        ray: Ray.
        first_hit: The first surface along a ray of the camera.
        first_within: The bodies in which such a ray starts.
        next_hit: The next surface along a ray from a surface, by the bodies in which it runs, the
            slope with which it leaves the surface, and the part that has this surface.
        field_of: Signed distance near a surface of a part (``Hit.part``).
        surface: The material at a point of a part, averaged over a footprint.
        lights: The light with a given index, from 0, at a point.
        around: Ambient light from a direction.
        directions: Random directions for ambient light, by three random numbers.
        directions_density: The density of such a direction.
        has_directions: Whether there are such directions; a constant.
        lamps: Where the shape is that emits light, by index.
        background: Light from a direction without a surface, as the camera sees it.
        fog: Color of the fog in a direction.
        numbers: The parameters of the march.
        look: The density of fog.
        light_count: How many lights there are.
        lamp_count: How many shapes emit light; a constant.
        bodies: How many bodies the scene has (``media``); a constant.
        common: The body of shapes without a priority; a constant.
        stream: The random numbers of the path.
        caustics: The light of photons that a surface sends to the eye (``photons.gathered``).
        target: The box that photons cross (``photon_aim``).
        has_photons: Whether there are photons; a constant.
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
    choices = light_count + lamp_count + (1 if has_directions else 0)
    chance = 1.0 / float(max(choices, 1))
    start = Start(ray, 0, 0.0, -1)
    wavelength = wavelength_of(single(stream, WAVELENGTH))
    is_tinted = False  # whether the throughput has the color of the wavelength
    width = cone
    seen = True  # only mirrors and clear glass are between the camera and the ray
    chosen = 0.0  # the density of the ray's direction; 0 if it was the only possible one
    scattered = False  # a surface that photons light lies behind
    bundled = False  # and after it surfaces alone that photons follow
    for i in range(MOST_SEGMENTS):
        decision = CAMERA_DECISIONS + DECISIONS * i
        here = start.ray
        hit = first_hit(here) if i == 0 else next_hit(here, start.within, start.slope, start.part)
        within = first_within(here, hit) if i == 0 else start.within
        inside = within != 0
        lost = merged(lost, merged(reason(hit.lost), select(i == 0 and inside, INSIDE, 0)))
        if not seen and not inside:
            length = hit.t if hit.found else UNBOUNDED
            color += throughput * met_lights(
                here, length, chosen, lights, light_count, chance, target, bundled
            )
        if not hit.found:
            if not inside:
                far = background(here.direction) if seen else around(here.direction)
                if has_directions and not seen:
                    density = directions_density(here.direction)
                    far = far * power_share(chosen, density * chance)
                    if bundled and is_followed_from_afar(target, here, density):
                        far = vec3(0.0)
                color += throughput * far
            elif i == 0:
                alpha = ALL_INSIDE
            break
        alpha = 1.0
        vertex = vertex_at(
            here, hit, within, field_of, surface, width, numbers, normals, normal_step, bodies,
            common, wavelength,
        )  # fmt: skip
        met = vertex.interface
        material = met.surface
        emission = emitted(material, met.inside)
        if inside:
            throughput = throughput * exp(-met.absorption * vertex.t)
            if bodies > 1:
                color += throughput * select(met.is_boundary, emission, vec3(0.0))
        else:
            clear = exp(-look.fog_density * vertex.t)
            if lamp_count > 0 and chosen > 0.0 and brightest(emission) > 0.0:
                density = lamps_density(here.origin, here.direction, lamps, lamp_count)
                emission = emission * power_share(chosen, density * chance)
            color += throughput * mix(fog(here.direction), emission, clear)
            throughput = throughput * clear
        if bodies > 1 and not met.is_boundary:
            slope = leaving_slope(vertex.slope, vertex.n, here.direction)
            start = Start(Ray(vertex.p, here.direction), met.within, slope, vertex.part)
            continue
        meeting = meet(material, -here.direction, vertex.n, met.inside)
        # From where a path meets glass with dispersion its light has one wavelength.
        if material.dispersion > 0.0 and not is_tinted:
            throughput = throughput * color_of(wavelength)
            is_tinted = True
        bundling = has_photons and bundles(material)
        if has_photons and not bundling:
            color += throughput * caustics(vertex, meeting, stream)
        if choices > 0 and not all_specular(material):
            u = triple(stream, decision + PLACE_ON_LIGHT)
            which = single(stream, decision + WHICH_LIGHT)
            aim = aim_at_light(
                vertex, lights, light_count, lamps, lamp_count, around, directions,
                has_directions, chance, u, which, target,
            )  # fmt: skip
            direct = light_from(aim, vertex, meeting, next_hit, surface, look, lamp_count > 0)
            left = scattered and bundling and aim.is_followed
            color += throughput * select(left, vec3(0.0), direct.color)
            lost = merged(lost, select(direct.lost, SHADOWS, 0))
        onward = sample_from(meeting, triple(stream, decision + DIRECTION))
        throughput = throughput * onward.weight
        likely = 1.0
        if i >= SURE:
            likely = min(brightest(abs(throughput)), LIKELIEST)
        if single(stream, decision + ENDING) >= likely:
            break
        throughput = throughput / likely
        chosen = onward.density
        seen = seen and onward.specular
        if has_photons:
            bundled = scattered and (onward.specular or bundling)
            scattered = scattered or not (onward.specular or bundling)
        start = start_from(vertex, onward.direction)
        width = continued(width, vertex.t)
    return vec4(color, marked(alpha, lost, counted))
