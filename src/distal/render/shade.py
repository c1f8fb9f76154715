"""Direct light: the light that a point on a surface sends to the eye.

Input: a ray, the ``SurfacePoint`` that it hit, lights and ambient light. Output: linear light. A
loop evaluates the lights and contains one shadow march, which is skipped for a light behind the
surface. Glass colors the light that passes straight through it (``glass_shadows``); caustics need
path tracing.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.lang import (
    Field3,
    clamp,
    cos,
    cross,
    dot,
    exp,
    func,
    gradient,
    length,
    max,
    mix,
    normalize,
    reflect,
    sin,
    sqrt,
    struct,
    vec3,
)
from distal.render.camera import Ray
from distal.render.lights import LightSample
from distal.render.march import March
from distal.render.material import highlight
from distal.render.normals import tangent
from distal.render.shadow_ray import true_slope
from distal.render.shadows import GOLDEN_ANGLE, Opening
from distal.render.trace import SurfacePoint, ray_offset

OCCLUSION_DIRECTIONS = 5
OCCLUSION_GAIN = 0.6


@struct
class Shading:
    """The parameters of shading besides the lights.

    Attributes:
        occlusion: Reach of ambient occlusion, in scene units; 0 for none.
        fog_density: Fraction of the light that fog takes, per scene unit.
    """

    occlusion: float
    fog_density: float


@struct
class Lit:
    """The light that a surface sends to the eye.

    Attributes:
        color: Linear light.
        lost: Whether the steps of a shadow ray ran out.
    """

    color: vec3
    lost: bool = False


@func
def ambient_occlusion(
    field: Field3,
    p: vec3,
    n: vec3,
    reach: float,
    slope: float,
    flattest: float = 1.0,
    steep: bool = False,
) -> float:
    """Return the fraction of ambient light that reaches a point.

    Five directions, spread over the hemisphere by the cosine, have two points each. A point where
    the field is less than a flat surface would give hides light, a near point more than a far one.
    Above a plane the result is 1.

    Args:
        field: Signed distance.
        p: Point on a surface or just above it.
        n: Unit normal.
        reach: How far to search for surfaces, in scene units.
        slope: |gradient| of the field at the point; values are divided by it.
        flattest: The least |gradient| by which values are divided elsewhere.
        steep: Whether values may be less than distances; a constant.
    """
    right = tangent(n)
    ahead = cross(n, right)
    hidden = 0.0
    for i in range(OCCLUSION_DIRECTIONS):
        across = (float(i) + 0.5) / float(OCCLUSION_DIRECTIONS)
        rise = sqrt(1.0 - across)
        angle = GOLDEN_ANGLE * float(i)
        flat = cos(angle) * right + sin(angle) * ahead
        direction = sqrt(across) * flat + rise * n
        most = 0.0
        for tap in range(2):
            way = reach * (0.15 + 0.35 * float(tap))
            q = p + way * direction
            share = field(q) / (slope * way * rise)
            if steep and share < 1.0:
                # The nearest surface may be another one, whose field grows at another rate.
                share = field(q) / (max(length(gradient(field, q)), flattest) * way * rise)
            lost = clamp(OCCLUSION_GAIN * (1.0 - share), 0.0, 1.0)
            most = max(most, lost * (1.0 - 0.8 * way / reach))
        hidden += most
    return 1.0 - hidden / float(OCCLUSION_DIRECTIONS)


@func
def occlusion_in(
    field: Field3,
    p: vec3,
    n: vec3,
    slope: float,
    look: Shading,
    numbers: March,
    steep: bool,
) -> float:
    """Return the fraction of ambient light that reaches a point of a scene.

    Args:
        field: Signed distance.
        p: Point on a surface or just above it.
        n: Unit normal.
        slope: |gradient| of the field at the point.
        look: How far to search for surfaces.
        numbers: The parameters of the march.
        steep: Whether values may be less than distances; a constant.
    """
    flattest = true_slope(0.0, numbers)
    return ambient_occlusion(field, p, n, look.occlusion, slope, flattest, steep)


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
    occlusion: Callable[[vec3, vec3, float], float],
    lights: Callable[[int, vec3], LightSample],
    ambient: Callable[[vec3], vec3],
    shadow: Callable[[vec3, LightSample, int, int], Opening],
    numbers: March,
    look: Shading,
    light_count: int,
    hybrid: bool,
    sample: int = 0,
    samples: int = 1,
) -> Lit:
    """Return the light that a surface emits and scatters from the lights, before fog.

    Reflections are not included, except blurred ones: a rough surface mirrors a blurred picture of
    its surroundings, which is approximated by the ambient light.

    Args:
        ray: The ray that hit the surface.
        point: The surface at the hit.
        occlusion: The fraction of ambient light that reaches a point; takes the normal there, and
            |gradient| of the field.
        lights: The light with a given index, from 0, at a point.
        ambient: Light from all directions on a white surface, by its normal.
        shadow: The visible fraction of a light at a point, for a pixel's sample of several.
        numbers: The parameters of the march.
        look: Ambient occlusion and fog.
        light_count: Number of lights.
        hybrid: Whether the hybrid march found the surface; a constant.
        sample: The number of the pixel's sample, from 0.
        samples: How many samples the pixel has.
    """
    n = point.n
    view = -ray.direction
    # Shadow rays start above the surface, but the direction to the light is that at the surface.
    lifted = point.p + ray_offset(numbers, point.t, hybrid) * n
    around = point.shares.diffuse * ambient(n)
    if point.surface.roughness > 0.0:
        around += point.shares.mirrored * point.surface.roughness * ambient(reflect(-view, n))
    if look.occlusion > 0.0:
        around = around * occlusion(lifted, n, true_slope(point.slope, numbers))
    color = point.surface.emission + around
    lost = False
    for i in range(light_count):
        light = lights(i, point.p)
        facing = dot(n, light.direction)
        if facing > 0.0:
            seen = shadow(lifted, light, sample, samples)
            lost = lost or seen.lost
            shine = highlight(point.surface, n, view, light.direction, light.radius)
            scattered = point.shares.diffuse * facing + point.shares.mirrored * shine
            color += light.radiance * seen.tint * seen.share * scattered
    return Lit(color, lost)
