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
    vec3,
    vec4,
)
from distal.lang.functions import apart
from distal.render.bounce import ALL_INSIDE
from distal.render.camera import Ray
from distal.render.dispersion import color_of, wavelength_of
from distal.render.emitters import power_share, seen_light
from distal.render.footprint import (
    THIN,
    Cone,
    Footprint,
    continued,
)
from distal.render.lamps import Lamp, lamps_density
from distal.render.lights import LightSample
from distal.render.lost_rays import INSIDE, SHADOWS, marked, merged, reason
from distal.render.march import Hit, March
from distal.render.material import Surface, brightest
from distal.render.normals import EXACT
from distal.render.path_lights import aim_at_light, light_from
from distal.render.photon_aim import bundles, is_followed, is_followed_from_afar
from distal.render.sampling.points import Stream, single, triple
from distal.render.scatter import Meeting, Response, Scattering, all_specular, emitted, meet
from distal.render.shade import Shading
from distal.render.surroundings import DirectionSample
from distal.render.vertices import Start, Vertex, start_from, straight_on, vertex_at

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


@apart
@func
def path_light(
    ray: Ray,
    first_hit: Callable[[Ray], Hit],
    first_within: Callable[[Ray, Hit], int],
    next_hit: Callable[[Ray, int, float, int], Hit],
    field_of: Callable[[vec3, int], float],
    surface: Callable[[vec3, Footprint, int], Surface],
    respond: Callable[[Meeting, vec3], Response],
    scatter: Callable[[Meeting, vec3], Scattering],
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
        respond: How much of the light of a direction goes to the eye (``scatter.respond_to``).
        scatter: A random direction by three random numbers (``scatter.sample_from``).
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
            start = straight_on(vertex, here.direction)
            continue
        meeting = meet(material, -here.direction, vertex.shown, met.inside)
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
            direct = light_from(
                aim, vertex, meeting, respond, next_hit, surface, look, lamp_count > 0
            )  # fmt: skip
            left = scattered and bundling and aim.is_followed
            color += throughput * select(left, vec3(0.0), direct.color)
            lost = merged(lost, select(direct.lost, SHADOWS, 0))
        onward = scatter(meeting, triple(stream, decision + DIRECTION))
        # Light that a bump's normal mirrors into the surface is lost, and likewise.
        if dot(onward.direction, vertex.shown) * dot(onward.direction, vertex.n) < 0.0:
            break
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
