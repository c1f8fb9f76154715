"""Direct light: what a place on a surface sends to the eye.

Lights are asked one after the other in a loop with one shadow march; a surface facing away from a
light casts none. Glass casts shadows like anything else here: caustics are for path tracing.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import Bounds
from distal.lang import Field3, abs, clamp, dot, exp, func, max, min, mix, reflect, vec3
from distal.render.camera import Ray
from distal.render.lights import LightSample
from distal.render.march import March, crossing
from distal.render.material import Shares, Surface, highlight

SHARPEST = 0.003  # tangent of the smallest half angle a light fills: sharper is noise
HURRY = 0.04  # the least stride of a shadow ray late on its way, as a share of the way
OCCLUSION_TAPS = 5


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
    for i in range(steps):
        if t > end or open_share < -1.0:
            break
        d = field(origin + t * light.direction) / numbers.divisor
        open_share = min(open_share, d / (width * t))
        # A ray that grazes a surface for half of its steps strides on with the others, or what
        # hides the light farther on would be missed: bright lines within shadows.
        least = (HURRY if 2 * i > steps else 0.1 * width) * t + numbers.threshold
        t += clamp(abs(d), least, max(0.5, 0.25 * t))
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
def direct_light(
    field: Field3,
    lights: Callable[[int, vec3], LightSample],
    ambient: Callable[[vec3], vec3],
    surface: Surface,
    parts: Shares,
    p: vec3,
    lift: float,
    n: vec3,
    view: vec3,
    bounds: Bounds,
    numbers: March,
    light_count: int,
    shadow_steps: int,
    occlusion: float,
) -> vec3:
    """What a place sends to the eye by itself and from the lights, without mirrored surroundings.

    What a rough surface mirrors of its surroundings is blurred: that share is taken from the
    ambient light. Shadows are looked for from ``lift`` above the surface, lights at it.
    """
    lifted = p + lift * n
    around = parts.diffuse * ambient(n)
    if surface.roughness > 0.0:
        around += parts.mirrored * surface.roughness * ambient(reflect(-view, n))
    if occlusion > 0.0:
        around = around * ambient_occlusion(field, lifted, n, occlusion, numbers.divisor)
    color = surface.emission + around
    for i in range(light_count):
        light = lights(i, p)
        facing = dot(n, light.direction)
        if facing > 0.0:
            shadow = 1.0
            if shadow_steps > 0:
                shadow = soft_shadow(field, lifted, light, bounds, numbers, shadow_steps)
            shine = highlight(surface, n, view, light.direction, light.radius)
            color += light.radiance * shadow * (parts.diffuse * facing + parts.mirrored * shine)
    return color


@func
def fogged(color: vec3, t: float, fog_color: vec3, fog_density: float) -> vec3:
    """A color seen through fog."""
    return mix(fog_color, color, exp(-fog_density * t))
