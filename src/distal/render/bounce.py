"""The light along a ray: at one surface, in a chain of mirrors, or in a tree of mirrors and glass.

Input: a ray, the functions of a scene and its numbers. Output: linear light and alpha. A scene
uses the cheapest of the three renderers that supports all its materials. The last one follows both
the mirrored and the refracted ray, with an explicit stack.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.lang import dot, exp, func, reflect, refract, select, vec3, vec4
from distal.render.camera import Ray
from distal.render.footprint import THIN, Cone, Footprint, continued, footprint_at
from distal.render.lights import LightSample
from distal.render.lost_rays import INSIDE, SHADOWS, marked, merged, reason
from distal.render.march import Hit, March
from distal.render.material import Surface, brightest, shares
from distal.render.media import interface_at
from distal.render.normals import EXACT
from distal.render.segment import Landing, landing, leaving_slope
from distal.render.shade import Shading, direct_light, fogged
from distal.render.shadows import Opening
from distal.render.trace import ray_offset, surface_point

# Alpha of a ray that starts inside a solid and does not leave it.
ALL_INSIDE = -1.0
STACK = 12
DIMMEST = 0.004  # rays that would add less than one step of an 8-bit display are not followed


@func
def seen_plain(
    ray: Ray,
    first_hit: Callable[[Ray], Hit],
    field_of: Callable[[vec3, int], float],
    surface: Callable[[vec3, Footprint, int], Surface],
    occlusion: Callable[[vec3, vec3, float], float],
    lights: Callable[[int, vec3], LightSample],
    ambient: Callable[[vec3], vec3],
    background: Callable[[vec3], vec3],
    fog: Callable[[vec3], vec3],
    shadow: Callable[[vec3, LightSample, int, int], Opening],
    numbers: March,
    look: Shading,
    light_count: int,
    normals: int = EXACT,
    normal_step: float = 1e-3,
    hybrid: bool = False,
    cone: Cone = THIN,
    counted: bool = False,
) -> vec4:
    """Return the direct light at the first surface.

    Args:
        ray: Ray.
        first_hit: The first surface along a ray.
        field_of: Signed distance near a surface of a part (``Hit.part``).
        surface: The material at a point of a part, averaged over a footprint.
        occlusion: The fraction of ambient light that reaches a point, by its normal and |gradient|.
        lights: The light with a given index, from 0, at a point.
        ambient: Light from all directions on a white surface, by its normal.
        background: Light from a direction without a surface.
        fog: Color of the fog in a direction.
        shadow: The visible fraction of a light at a point, for a pixel's sample of several.
        numbers: The parameters of the march.
        look: Ambient occlusion and fog.
        light_count: How many lights there are.
        normals: The method for normals; a constant of ``normals``.
        normal_step: Step of the normals' differences, in scene units at distance 1.
        hybrid: Whether the march for terrain and water finds the hits; a constant.
        cone: The cone of the ray.
        counted: Whether alpha is marked with why rays were lost (``lost_rays``); a constant.

    Returns:
        Linear light; alpha is 1 on a surface, 0 if there is none, ``ALL_INSIDE`` if the ray does
        not leave a solid.
    """
    hit = first_hit(ray)
    lost = merged(reason(hit.lost), select(hit.side < 0.0, INSIDE, 0))
    if not hit.found:
        alpha = ALL_INSIDE if hit.side < 0.0 else 0.0
        return vec4(background(ray.direction), marked(alpha, lost, counted))
    point = surface_point(ray, hit, field_of, surface, cone, numbers, normals, normal_step)
    light = direct_light(
        ray, point, occlusion, lights, ambient, shadow, numbers, look, light_count, hybrid,
        cone.sample, cone.samples,
    )  # fmt: skip
    lost = merged(lost, select(light.lost, SHADOWS, 0))
    color = fogged(light.color, point.t, fog(ray.direction), look.fog_density)
    return vec4(color, marked(1.0, lost, counted))


@func
def seen_mirrored(
    ray: Ray,
    first_hit: Callable[[Ray], Hit],
    field_of: Callable[[vec3, int], float],
    surface: Callable[[vec3, Footprint, int], Surface],
    occlusion: Callable[[vec3, vec3, float], float],
    lights: Callable[[int, vec3], LightSample],
    ambient: Callable[[vec3], vec3],
    background: Callable[[vec3], vec3],
    fog: Callable[[vec3], vec3],
    shadow: Callable[[vec3, LightSample, int, int], Opening],
    numbers: March,
    look: Shading,
    light_count: int,
    bounces: int,
    normals: int = EXACT,
    normal_step: float = 1e-3,
    hybrid: bool = False,
    cone: Cone = THIN,
    counted: bool = False,
) -> vec4:
    """As ``seen_plain``, with mirrors: one ray continues, at most ``bounces`` times."""
    color = vec3(0.0)
    throughput = vec3(1.0)
    alpha = 0.0
    lost = 0
    origin = ray.origin
    direction = ray.direction
    width = cone
    for _ in range(bounces + 1):
        here = Ray(origin, direction)
        hit = first_hit(here)
        began_inside = hit.side < 0.0 and alpha == 0.0
        lost = merged(lost, merged(reason(hit.lost), select(began_inside, INSIDE, 0)))
        if hit.side < 0.0 and alpha > 0.0:
            break  # mirrored into a crevice: the surface in front hides everything behind it
        if not hit.found:
            color += throughput * background(direction)
            if hit.side < 0.0:
                alpha = ALL_INSIDE
            break
        alpha = 1.0
        point = surface_point(here, hit, field_of, surface, width, numbers, normals, normal_step)
        light = direct_light(
            here, point, occlusion, lights, ambient, shadow, numbers, look, light_count, hybrid,
            cone.sample, cone.samples,
        )  # fmt: skip
        lost = merged(lost, select(light.lost, SHADOWS, 0))
        color += throughput * fogged(light.color, point.t, fog(direction), look.fog_density)
        clear = exp(-look.fog_density * point.t)
        throughput = throughput * point.shares.mirrored * ((1.0 - point.surface.roughness) * clear)
        if brightest(throughput) < DIMMEST:
            break
        # Mirrored rays start nearer to the surface than shadow rays: a grazing ray that starts
        # higher would hit another wave.
        origin = point.p + ray_offset(numbers, hit.t, False) * point.n
        direction = reflect(direction, point.n)
        width = continued(width, point.t)
    return vec4(color, marked(alpha, lost, counted))


@func
def landing_of(field_of: Callable[[vec3, int], float], ray: Ray, hit: Hit) -> Landing:
    """Return the place on the surface of a part at the end of a ray (``landing``)."""

    def field(q: vec3) -> float:
        return field_of(q, hit.part)

    return landing(field, ray, hit)


@func
def seen_refracted(
    ray: Ray,
    first_hit: Callable[[Ray], Hit],
    first_within: Callable[[Ray, Hit], int],
    next_hit: Callable[[Ray, int, float, int], Hit],
    field_of: Callable[[vec3, int], float],
    surface: Callable[[vec3, Footprint, int], Surface],
    occlusion: Callable[[vec3, vec3, float], float],
    lights: Callable[[int, vec3], LightSample],
    ambient: Callable[[vec3], vec3],
    background: Callable[[vec3], vec3],
    fog: Callable[[vec3], vec3],
    shadow: Callable[[vec3, LightSample, int, int], Opening],
    numbers: March,
    look: Shading,
    light_count: int,
    bounces: int,
    bodies: int = 1,
    common: int = 0,
    normals: int = EXACT,
    normal_step: float = 1e-3,
    cone: Cone = THIN,
    counted: bool = False,
) -> vec4:
    """As ``seen_mirrored``, with glass: both the mirrored and the refracted ray continue.

    Both start on the surface itself and know in which bodies they run (``media``, ``segment``), so
    that a pane may be as thin as a few rounding errors of its distance. ``first_within``,
    ``next_hit``, ``bodies`` and ``common`` are those of ``paths.path_light``; the other arguments
    are those of ``seen_mirrored``.
    """
    origins = [ray.origin] * STACK
    directions = [ray.direction] * STACK
    throughputs = [vec3(1.0)] * STACK
    widths = [cone.width] * STACK
    depths = [0] * STACK
    withins = [0] * STACK  # in which bodies a ray runs, and the slope and the part where it starts
    slopes = [0.0] * STACK
    parts = [-1] * STACK
    waiting = 1
    color = vec3(0.0)
    alpha = 0.0
    lost = 0
    for _ in range(4 * bounces + 4):
        if waiting == 0:
            break
        waiting -= 1
        direction = directions[waiting]
        throughput = throughputs[waiting]
        width = Cone(widths[waiting], cone.spread, cone.sample, cone.samples)
        depth = depths[waiting]
        here = Ray(origins[waiting], direction)
        within = withins[waiting]
        slope = slopes[waiting]
        part = parts[waiting]
        hit = first_hit(here) if depth == 0 else next_hit(here, within, slope, part)
        if depth == 0:
            within = first_within(here, hit)
        lost = merged(lost, reason(hit.lost))
        if not hit.found:
            color += throughput * background(direction)
            if within != 0 and depth == 0:
                alpha = ALL_INSIDE
            continue
        alpha = 1.0
        point = surface_point(here, hit, field_of, surface, width, numbers, normals, normal_step)
        place_seen = footprint_at(width, direction, hit.t, point.n)
        met = interface_at(point.surface, point.p, place_seen, hit, within, surface, bodies, common)
        if bodies > 1:
            point.surface = met.surface
            point.inside = met.inside
            point.shares = shares(met.surface, -dot(point.n, direction), met.inside)
        continues = brightest(throughput * (point.shares.mirrored + point.shares.transmitted))
        place = Landing(point.p, point.n, point.slope, point.t)
        if within != 0 or continues >= DIMMEST:
            place = landing_of(field_of, here, hit)
        if within != 0:
            throughput = throughput * exp(-met.absorption * place.t)
        if not met.is_boundary:
            origins[waiting] = place.p
            withins[waiting] = met.within
            slopes[waiting] = leaving_slope(place.slope, place.n, direction)
            parts[waiting] = hit.part
            throughputs[waiting] = throughput
            widths[waiting] = continued(width, point.t).width
            waiting += 1
            continue
        if not point.inside:
            light = direct_light(
                here, point, occlusion, lights, ambient, shadow, numbers, look, light_count,
                False, cone.sample, cone.samples,
            )  # fmt: skip
            lost = merged(lost, select(light.lost, SHADOWS, 0))
            density = select(within != 0, 0.0, look.fog_density)
            color += throughput * fogged(light.color, point.t, fog(direction), density)
            throughput = throughput * exp(-density * point.t)
        if depth >= bounces:
            continue
        eta = point.surface.ior if point.inside else 1.0 / point.surface.ior
        # Beyond the critical angle there is no refracted ray, and its throughput is 0.
        bent = refract(direction, point.n, eta)
        mirror_share = throughput * point.shares.mirrored * (1.0 - point.surface.roughness)
        through_share = throughput * point.shares.transmitted
        for kind in range(2):
            through = kind == 1
            share = through_share if through else mirror_share
            onward = bent if through else reflect(direction, point.n)
            if brightest(share) >= DIMMEST and waiting < STACK:
                origins[waiting] = place.p
                withins[waiting] = met.within if through else within
                slopes[waiting] = leaving_slope(place.slope, place.n, onward)
                parts[waiting] = hit.part
                directions[waiting] = onward
                throughputs[waiting] = share
                widths[waiting] = continued(width, point.t).width
                depths[waiting] = depth + 1
                waiting += 1
    return vec4(color, marked(alpha, lost, counted))
