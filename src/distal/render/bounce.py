"""What a ray brings back: one surface, a chain of mirrors, or a tree of mirrors and glass.

Three renderers, of which a scene takes the cheapest that shows all its materials. The last follows
both the mirrored and the refracted ray, by an explicit stack.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import Bounds
from distal.lang import Field3, dot, exp, func, max, reflect, refract, struct, vec3, vec4
from distal.render.camera import Ray
from distal.render.heightfield_march import ENOUGH, STRIDE, Stride
from distal.render.lights import LightSample
from distal.render.march import Hit, March, march
from distal.render.material import Surface, brightest, shares
from distal.render.normals import EXACT, normal
from distal.render.shade import direct_light, fogged
from distal.render.trace import first_surface

# Alpha of a ray that begins inside a solid and finds no way out of it.
ALL_INSIDE = -1.0
STACK = 12
DIMMEST = 0.004  # rays that would add less than a display's step are not followed


@struct
class Look:
    """The numbers of shading: how far occlusion looks (0: none), and fog."""

    occlusion: float
    fog_color: vec3
    fog_density: float


@func
def place_on(ray: Ray, hit: Hit) -> vec3:
    """Where a ray ended."""
    return ray.origin + hit.t * ray.direction


@func
def just_before(ray: Ray, hit: Hit, numbers: March) -> vec3:
    """Where normals are asked: on the surface itself many fields have no direction in 32 bits.

    (The length of a vector to the nearest edge, with a sign, say.)
    """
    return ray.origin + hit.t * (1.0 - 0.5 * numbers.threshold) * ray.direction


@func
def differences_step(hit: Hit, normal_step: float) -> float:
    """How far away normals' differences are taken: like pixels, and what 32 bits tell, with t."""
    return normal_step * max(hit.t, 1.0)


@func
def lift_above(numbers: March, hit: Hit, hybrid: bool) -> float:
    """How far above a surface its rays begin: beyond what a march may be off, above or below."""
    off = 1.0 + ENOUGH if hybrid else 1.0
    return (1.0 + off) * numbers.threshold * hit.t + 1e-4


@func
def seen_plain(
    ray: Ray,
    field: Field3,
    surface: Callable[[vec3], Surface],
    lights: Callable[[int, vec3], LightSample],
    ambient: Callable[[vec3], vec3],
    background: Callable[[vec3], vec3],
    bounds: Bounds,
    numbers: March,
    look: Look,
    steps: int,
    light_count: int,
    shadow_steps: int,
    normals: int = EXACT,
    normal_step: float = 1e-3,
    hybrid: bool = False,
    stride: Stride = STRIDE,
) -> vec4:
    """Direct light on the first surface; alpha is 0 where there is none."""
    hit = first_surface(field, ray, bounds, numbers, steps, hybrid, stride)
    if not hit.found:
        return vec4(background(ray.direction), ALL_INSIDE if hit.side < 0.0 else 0.0)
    p = place_on(ray, hit)
    n = hit.side * normal(
        field, just_before(ray, hit, numbers), normals, differences_step(hit, normal_step)
    )
    lift = lift_above(numbers, hit, hybrid)
    material = surface(p)
    color = direct_light(
        field,
        lights,
        ambient,
        material,
        shares(material, -dot(n, ray.direction), hit.side < 0.0),
        p,
        lift,
        n,
        -ray.direction,
        bounds,
        numbers,
        light_count,
        shadow_steps,
        look.occlusion,
    )
    return vec4(fogged(color, hit.t, look.fog_color, look.fog_density), 1.0)


@func
def seen_mirrored(
    ray: Ray,
    field: Field3,
    surface: Callable[[vec3], Surface],
    lights: Callable[[int, vec3], LightSample],
    ambient: Callable[[vec3], vec3],
    background: Callable[[vec3], vec3],
    bounds: Bounds,
    numbers: March,
    look: Look,
    steps: int,
    light_count: int,
    shadow_steps: int,
    bounces: int,
    normals: int = EXACT,
    normal_step: float = 1e-3,
    hybrid: bool = False,
    stride: Stride = STRIDE,
) -> vec4:
    """As ``seen_plain``, and what mirrors show: one ray goes on."""
    color = vec3(0.0)
    throughput = vec3(1.0)
    alpha = 0.0
    origin = ray.origin
    direction = ray.direction
    for _ in range(bounces + 1):
        here = Ray(origin, direction)
        hit = first_surface(field, here, bounds, numbers, steps, hybrid, stride)
        if hit.side < 0.0 and alpha > 0.0:
            break  # mirrored into a crevice: what is there hides the rest
        if not hit.found:
            color += throughput * background(direction)
            if hit.side < 0.0:
                alpha = ALL_INSIDE
            break
        alpha = 1.0
        p = place_on(here, hit)
        n = hit.side * normal(
            field, just_before(here, hit, numbers), normals, differences_step(hit, normal_step)
        )
        lift = lift_above(numbers, hit, hybrid)
        material = surface(p)
        parts = shares(material, -dot(n, direction), hit.side < 0.0)
        direct = direct_light(
            field,
            lights,
            ambient,
            material,
            parts,
            p,
            lift,
            n,
            -direction,
            bounds,
            numbers,
            light_count,
            shadow_steps,
            look.occlusion,
        )
        color += throughput * fogged(direct, hit.t, look.fog_color, look.fog_density)
        clear = exp(-look.fog_density * hit.t)
        throughput = throughput * parts.mirrored * ((1.0 - material.roughness) * clear)
        if brightest(throughput) < DIMMEST:
            break
        # Mirrored rays begin lower: grazing ones would see another wave.
        origin = p + lift_above(numbers, hit, False) * n
        direction = reflect(direction, n)
    return vec4(color, alpha)


@func
def seen_refracted(
    ray: Ray,
    field: Field3,
    surface: Callable[[vec3], Surface],
    lights: Callable[[int, vec3], LightSample],
    ambient: Callable[[vec3], vec3],
    background: Callable[[vec3], vec3],
    bounds: Bounds,
    numbers: March,
    look: Look,
    steps: int,
    light_count: int,
    shadow_steps: int,
    bounces: int,
    normals: int = EXACT,
    normal_step: float = 1e-3,
) -> vec4:
    """As ``seen_mirrored``, and what glass shows: mirrored and refracted rays both go on."""
    origins = [ray.origin] * STACK
    directions = [ray.direction] * STACK
    throughputs = [vec3(1.0)] * STACK
    depths = [0] * STACK
    insides = [True] * STACK  # whether a ray may begin inside; the eye may
    waiting = 1
    color = vec3(0.0)
    alpha = 0.0
    for _ in range(4 * bounces + 4):
        if waiting == 0:
            break
        waiting -= 1
        direction = directions[waiting]
        throughput = throughputs[waiting]
        depth = depths[waiting]
        here = Ray(origins[waiting], direction)
        hit = march(field, here, bounds, numbers, steps)
        if hit.side < 0.0 and not insides[waiting]:
            continue  # mirrored into a crevice: what is there hides the rest
        if not hit.found:
            color += throughput * background(direction)
            if hit.side < 0.0 and depth == 0:
                alpha = ALL_INSIDE
            continue
        alpha = 1.0
        p = place_on(here, hit)
        n = hit.side * normal(
            field, just_before(here, hit, numbers), normals, differences_step(hit, normal_step)
        )
        lift = lift_above(numbers, hit, False)
        material = surface(p)
        parts = shares(material, -dot(n, direction), hit.side < 0.0)
        if hit.side < 0.0:
            throughput = throughput * exp(-material.absorption * hit.t)
        else:
            direct = direct_light(
                field,
                lights,
                ambient,
                material,
                parts,
                p,
                lift,
                n,
                -direction,
                bounds,
                numbers,
                light_count,
                shadow_steps,
                look.occlusion,
            )
            color += throughput * fogged(direct, hit.t, look.fog_color, look.fog_density)
            throughput = throughput * exp(-look.fog_density * hit.t)
        if depth >= bounces:
            continue
        eta = material.ior if hit.side < 0.0 else 1.0 / material.ior
        # Where all is mirrored there is no bent ray, and nothing for it to carry.
        bent = refract(direction, n, eta)
        mirror_share = throughput * parts.mirrored * (1.0 - material.roughness)
        through_share = throughput * parts.transmitted
        if brightest(mirror_share) >= DIMMEST and waiting < STACK:
            origins[waiting] = p + lift * n
            directions[waiting] = reflect(direction, n)
            throughputs[waiting] = mirror_share
            depths[waiting] = depth + 1
            insides[waiting] = hit.side < 0.0
            waiting += 1
        if brightest(through_share) >= DIMMEST and waiting < STACK:
            origins[waiting] = p - lift * n
            directions[waiting] = bent
            throughputs[waiting] = through_share
            depths[waiting] = depth + 1
            insides[waiting] = hit.side > 0.0
            waiting += 1
    return vec4(color, alpha)
