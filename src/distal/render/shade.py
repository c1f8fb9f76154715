"""Direct light: what a place on a surface sends to the eye.

Lights are asked one after the other in a loop with one shadow march; a surface facing away from a
light casts none. Glass casts shadows like anything else here: caustics are for path tracing.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.claims import Bounds
from distal.lang import (
    Field3,
    abs,
    clamp,
    dot,
    exp,
    func,
    gradient,
    max,
    min,
    mix,
    normalize,
    vec3,
)
from distal.render.camera import Ray
from distal.render.lights import LightSample
from distal.render.march import March, crossing
from distal.render.material import Surface

PI = 3.141592653589793
SHARPEST = 0.003  # tangent of the smallest half angle a light fills: sharper is noise
OCCLUSION_TAPS = 5


@func
def surface_normal(field: Field3, p: vec3) -> vec3:
    """The exact normal: which way the distance grows."""
    return normalize(gradient(field, p))


@func
def normal_by_six_taps(field: Field3, p: vec3, step: float) -> vec3:
    """The normal by central differences."""
    x = vec3(step, 0.0, 0.0)
    y = vec3(0.0, step, 0.0)
    z = vec3(0.0, 0.0, step)
    return normalize(
        vec3(
            field(p + x) - field(p - x),
            field(p + y) - field(p - y),
            field(p + z) - field(p - z),
        )
    )


@func
def soft_shadow(
    field: Field3, origin: vec3, light: LightSample, bounds: Bounds, numbers: March, steps: int
) -> float:
    """1 where all of a light arrives, 0 where none; rays that pass nearby are dimmed.

    The share of the light's disc that a straight edge hides, judged by the closest approach to the
    ray on both sides of it (Inigo Quilez, "Soft shadows in raymarched SDFs").
    """
    span = crossing(Ray(origin, light.direction), bounds)
    end = min(light.distance, min(span.y, numbers.far))
    width = max(light.radius, SHARPEST)
    open_share = 1.0
    t = max(span.x, 0.0) + numbers.threshold
    for _ in range(steps):
        if t > end or open_share < -1.0:
            break
        d = field(origin + t * light.direction) / numbers.divisor
        open_share = min(open_share, d / (width * t))
        t += clamp(abs(d), 0.1 * width * t + numbers.threshold, max(0.5, 0.25 * t))
    open_share = max(open_share, -1.0)
    return 0.25 * (1.0 + open_share) * (1.0 + open_share) * (2.0 - open_share)


@func
def ambient_occlusion(field: Field3, p: vec3, n: vec3, reach: float, divisor: float) -> float:
    """How much of what is around reaches a place: a few distances along the normal."""
    hidden = 0.0
    share = 1.0
    for i in range(OCCLUSION_TAPS):
        height = reach * (0.05 + 0.95 * float(i) / float(OCCLUSION_TAPS - 1))
        d = field(p + height * n) / divisor
        hidden += share * max(height - d, 0.0)
        share *= 0.6
    return clamp(1.0 - 1.2 * hidden / reach, 0.0, 1.0)


@func
def fresnel_dielectric(cosine: float, eta: float) -> float:
    """The share of unpolarised light that a clear surface mirrors.

    ``cosine`` is that of the angle to the normal, ``eta`` the index outside over that inside; 1
    beyond the critical angle.
    """
    c = clamp(abs(cosine), 0.0, 1.0)
    sine2 = eta * eta * (1.0 - c * c)
    if sine2 >= 1.0:
        return 1.0
    inner = (1.0 - sine2) ** 0.5
    parallel = (c - eta * inner) / (c + eta * inner)
    crossed = (eta * c - inner) / (eta * c + inner)
    return 0.5 * (parallel * parallel + crossed * crossed)


@func
def highlight(surface: Surface, n: vec3, view: vec3, light: vec3) -> float:
    """The mirrored shape of a light: GGX with Smith's shadowing, times the cosine.

    In units where a white scattering surface shows 1 (Walter et al., "Microfacet models for
    refraction through rough surfaces", 2007).
    """
    half = normalize(view + light)
    alpha = max(surface.roughness * surface.roughness, 0.002)
    a2 = alpha * alpha
    nh = clamp(dot(n, half), 0.0, 1.0)
    nl = clamp(dot(n, light), 0.0, 1.0)
    nv = clamp(dot(n, view), 1e-3, 1.0)
    base = nh * nh * (a2 - 1.0) + 1.0
    spread = a2 / max(base * base, 1e-9)
    smith = nl * (nv * nv * (1.0 - a2) + a2) ** 0.5 + nv * (nl * nl * (1.0 - a2) + a2) ** 0.5
    return min(spread * 0.5 * nl / max(smith, 1e-5), 64.0)


@func
def mirrored(surface: Surface, cosine: float, side: float) -> vec3:
    """The share of light that a surface mirrors, by color."""
    if surface.fresnel < 0.5:
        return mix(vec3(1.0), surface.color, surface.metal) * surface.specular
    eta = surface.ior if side < 0.0 else 1.0 / surface.ior
    clear = fresnel_dielectric(cosine, eta)
    grazing = (1.0 - clamp(abs(cosine), 0.0, 1.0)) ** 5.0
    metallic = surface.color + (1.0 - surface.color) * grazing
    return mix(vec3(clear), metallic * surface.specular, surface.metal)


@func
def scattered(surface: Surface, mirror: vec3) -> vec3:
    """The share of light that a surface scatters, by color; what a coat mirrors is missing."""
    left = 1.0 - surface.fresnel * max(mirror.x, max(mirror.y, mirror.z))
    return surface.color * (surface.diffuse * left)


@func
def direct_light(
    field: Field3,
    lights: Callable[[int, vec3], LightSample],
    ambient: Callable[[vec3], vec3],
    surface: Surface,
    p: vec3,
    n: vec3,
    view: vec3,
    side: float,
    bounds: Bounds,
    numbers: March,
    light_count: int,
    shadow_steps: int,
    occlusion: float,
) -> vec3:
    """What a place sends to the eye by itself and from the lights, without reflections."""
    mirror = mirrored(surface, dot(n, view), side)
    scatter = scattered(surface, mirror)
    around = ambient(n)
    if occlusion > 0.0:
        around = around * ambient_occlusion(field, p, n, occlusion, numbers.divisor)
    color = surface.emission + scatter * around
    for i in range(light_count):
        light = lights(i, p)
        facing = dot(n, light.direction)
        if facing > 0.0:
            shadow = 1.0
            if shadow_steps > 0:
                shadow = soft_shadow(field, p, light, bounds, numbers, shadow_steps)
            shine = highlight(surface, n, view, light.direction)
            color += light.radiance * shadow * (scatter * facing + mirror * shine)
    return color


@func
def fogged(color: vec3, t: float, fog_color: vec3, fog_density: float) -> vec3:
    """A color seen through fog."""
    return mix(fog_color, color, exp(-fog_density * t))
