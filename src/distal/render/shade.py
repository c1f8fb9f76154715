"""Direct light: the light that a point on a surface sends to the eye.

Input: a ray, the ``SurfacePoint`` that it hit, lights and ambient light. Output: linear light. A
loop evaluates the lights and contains one shadow march, which is skipped for a light behind the
surface. Glass casts the shadow of an opaque solid, because caustics need path tracing.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import Bounds
from distal.lang import (
    Field3,
    abs,
    clamp,
    dot,
    exp,
    func,
    max,
    min,
    mix,
    normalize,
    reflect,
    struct,
    vec3,
)
from distal.render.camera import Ray
from distal.render.lights import LightSample
from distal.render.march import MOST_STEPS, March, crossing
from distal.render.material import highlight
from distal.render.trace import SurfacePoint, ray_offset

SHARPEST = 0.003  # smallest tangent of a light's half angle: sharper shadows would be noisy
HURRY = 0.04  # smallest step of a shadow ray in its second half, as a fraction of the distance
OCCLUSION_TAPS = 5


@struct
class Look:
    """The parameters of shading besides the lights.

    Attributes:
        occlusion: Reach of ambient occlusion, in scene units; 0 for none.
        fog_density: Fraction of the light that fog takes, per scene unit.
    """

    occlusion: float
    fog_density: float


@func
def soft_shadow(
    field: Field3, origin: vec3, light: LightSample, bounds: Bounds, numbers: March, steps: int
) -> float:
    """Return the visible fraction of a light: 1 in full light, 0 in full shadow.

    It is the fraction of the light's disc that a straight edge leaves visible, estimated from the
    closest approach to the ray, outside or inside (Inigo Quilez, "Soft shadows in raymarched
    SDFs").

    Args:
        field: Signed distance.
        origin: Start of the shadow ray.
        light: The light at the point.
        bounds: Box around the surface.
        numbers: The parameters of the march.
        steps: Maximum number of steps.
    """
    span = crossing(Ray(origin, light.direction), bounds)
    end = min(light.distance, min(span.y, numbers.far))
    width = max(light.radius, SHARPEST)
    open_share = 1.0
    t = max(span.x, 0.0) + numbers.threshold
    for i in range(min(steps, MOST_STEPS)):
        if t > end or open_share < -1.0:
            break
        d = field(origin + t * light.direction) / numbers.divisor
        open_share = min(open_share, d / (width * t))
        # A ray that grazes a surface takes longer steps after half of its steps. Otherwise it would
        # end before it reaches an occluder farther away: bright lines in shadows.
        least = (HURRY if 2 * i > steps else 0.1 * width) * t + numbers.threshold
        t += clamp(abs(d), least, max(0.5, 0.25 * t))
    open_share = max(open_share, -1.0)
    return 0.25 * (1.0 + open_share) * (1.0 + open_share) * (2.0 - open_share)


@func
def ambient_occlusion(field: Field3, p: vec3, n: vec3, reach: float, divisor: float) -> float:
    """Return the fraction of ambient light that reaches a point, from samples along the normal."""
    hidden = 0.0
    share = 1.0
    for i in range(OCCLUSION_TAPS):
        height = reach * (0.05 + 0.95 * float(i) / float(OCCLUSION_TAPS - 1))
        d = field(p + height * n) / divisor
        hidden += share * max(height - d, 0.0)
        share *= 0.6
    return clamp(1.0 - 1.2 * hidden / reach, 0.0, 1.0)


@func
def fogged(color: vec3, t: float, fog_color: vec3, fog_density: float) -> vec3:
    """Return a color seen through fog of a given density per scene unit, ``t`` units away."""
    return mix(fog_color, color, exp(-fog_density * t))


@func
def at_horizon(direction: vec3) -> vec3:
    """Return the horizontal unit direction below or above a direction: where far fog ends.

    Straight up and down, where there is none, it is -z.
    """
    return normalize(vec3(direction.x, 0.0, direction.z - 1e-9))


@func
def direct_light(
    ray: Ray,
    point: SurfacePoint,
    field: Field3,
    lights: Callable[[int, vec3], LightSample],
    ambient: Callable[[vec3], vec3],
    bounds: Bounds,
    numbers: March,
    look: Look,
    light_count: int,
    shadow_steps: int,
    hybrid: bool,
) -> vec3:
    """Return the light that a surface emits and scatters from the lights, before fog.

    Reflections are not included, except blurred ones: a rough surface mirrors a blurred picture of
    its surroundings, which is approximated by the ambient light.

    Args:
        ray: The ray that hit the surface.
        point: The surface at the hit.
        field: Signed distance.
        lights: The light with a given index, from 0, at a point.
        ambient: Light from all directions on a white surface, by its normal.
        bounds: Box around the surface.
        numbers: The parameters of the march.
        look: Ambient occlusion and fog.
        light_count: Number of lights.
        shadow_steps: Maximum number of steps of a shadow ray; 0 for no shadows.
        hybrid: Whether the hybrid march found the surface; a constant.
    """
    n = point.n
    view = -ray.direction
    # Shadow rays start above the surface, but the direction to the light is that at the surface.
    lifted = point.p + ray_offset(numbers, point.t, hybrid) * n
    around = point.shares.diffuse * ambient(n)
    if point.surface.roughness > 0.0:
        around += point.shares.mirrored * point.surface.roughness * ambient(reflect(-view, n))
    if look.occlusion > 0.0:
        around = around * ambient_occlusion(field, lifted, n, look.occlusion, numbers.divisor)
    color = point.surface.emission + around
    for i in range(light_count):
        light = lights(i, point.p)
        facing = dot(n, light.direction)
        if facing > 0.0:
            shadow = 1.0
            if shadow_steps > 0:
                shadow = soft_shadow(field, lifted, light, bounds, numbers, shadow_steps)
            shine = highlight(point.surface, n, view, light.direction, light.radius)
            scattered = point.shares.diffuse * facing + point.shares.mirrored * shine
            color += light.radiance * shadow * scattered
    return color
