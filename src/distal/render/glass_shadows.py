"""Shadows of glass in direct light: colored by what the glass mirrors and absorbs.

Input: a glass solid, a point, a light. Output: the fraction of the light that comes through, by
color. The way through the glass is taken as straight, and light that is bent away is lost: an
approximation, without the light that glass gathers behind it (mode "path" computes that).
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import Bounds
from distal.lang import Field3, abs, dot, exp, func, gradient, max, min, refract, select, vec2, vec3
from distal.render.camera import Ray
from distal.render.footprint import Footprint, point_footprint
from distal.render.lights import LightSample
from distal.render.march import crossing
from distal.render.material import Surface, shares
from distal.render.normals import unit_or_up
from distal.render.shadows import Opening, toward_light

# Steps through solids whose chord is not known; the shortest is this part of the whole way.
STEPS = 48
LONGEST_WAY = 1e3
# Light that a solid bends away does not come straight through it: the power of the cosine of this
# angle, chosen by eye. Panes keep all of it, balls that of their middle.
STRAIGHT = 8


@func
def way_through(field: Field3, ray: Ray, bounds: Bounds, far: float) -> vec2:
    """Return where a ray enters a solid and where it left it, if the solid had no gaps.

    Args:
        field: Signed distance.
        ray: The ray.
        bounds: Box around the solid.
        far: The end of the ray.
    """
    span = crossing(ray, bounds)
    t = max(span.x, 0.0)
    end = min(min(span.y, far), t + LONGEST_WAY)
    least = (end - t) / float(STEPS)
    entry = end
    total = 0.0
    for _ in range(STEPS):
        if t >= end:
            break
        d = field(ray.origin + t * ray.direction)
        step = min(max(abs(d), least), end - t)
        entry = select(d < 0.0, min(entry, t), entry)
        total += select(d < 0.0, step, 0.0)
        t += step
    return vec2(entry, entry + total)


@func
def passing_light(
    chord: vec2,
    ray: Ray,
    far: float,
    field: Field3,
    surface: Callable[[vec3, Footprint, int], Surface],
) -> vec3:
    """Return the fraction of light that comes straight through a solid.

    Args:
        chord: Where the ray enters and leaves the solid.
        ray: The ray to the light.
        far: The distance to the light.
        field: Signed distance of the solid.
        surface: Its material.
    """
    entry = max(chord.x, 0.0)
    end = min(chord.y, far)
    if end <= entry:
        return vec3(1.0)
    last = ray.origin + end * ray.direction
    n = unit_or_up(gradient(field, last))
    glass = surface(last, point_footprint(), -1)
    kept = shares(glass, abs(dot(n, ray.direction)), False).transmitted
    if chord.x > 0.0:
        first = unit_or_up(gradient(field, ray.origin + entry * ray.direction))
        kept = kept * shares(glass, abs(dot(first, ray.direction)), False).transmitted
        bent = refract(ray.direction, first, 1.0 / glass.ior)
        bent = refract(bent, -n, glass.ior)
        kept = kept * max(dot(bent, ray.direction), 0.0) ** STRAIGHT
    return kept * exp(-glass.absorption * (end - entry))


@func
def shadow_with_glass(
    shadow: Callable[[vec3, LightSample, int, int], Opening],
    glass: Callable[[Ray, float], vec3],
    origin: vec3,
    light: LightSample,
    sample: int,
    samples: int,
) -> Opening:
    """Return the visible fraction of a light, colored by the glass in front of it.

    Args:
        shadow: The visible fraction as opaque solids have it.
        glass: The fraction of light that comes through all glass along a ray to a distance.
        origin: Start of the shadow ray.
        light: The light.
        sample: The number of the pixel's sample, from 0.
        samples: How many samples the pixel has.
    """
    found = shadow(origin, light, sample, samples)
    if found.share <= 0.0:
        return found
    direction = light.direction
    if samples > 1:
        direction = toward_light(light, sample, samples)
    tint = glass(Ray(origin, direction), light.distance)
    return Opening(found.share, found.lost, tint)
