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
    cos,
    cross,
    dot,
    exp,
    func,
    gradient,
    inversesqrt,
    length,
    max,
    min,
    mix,
    normalize,
    reflect,
    select,
    sin,
    sqrt,
    struct,
    vec3,
)
from distal.render.camera import Ray
from distal.render.lights import LightSample
from distal.render.march import MOST_STEPS, March, crossing
from distal.render.material import highlight
from distal.render.trace import SurfacePoint, ray_offset

SHARPEST = 0.003  # smallest tangent of a light's half angle: sharper shadows would be noisy
NEARLY = 0.0003  # a ray that is nearer to a surface than this fraction of its length is in it
NARROW = 0.01  # the largest radius of a light that one ray is enough for
ENOUGH_SAMPLES = 4  # from so many samples of a pixel on, each has one ray to a wide light
MOST_RAYS = 16
GOLDEN_ANGLE = 2.399963
LONGEST_SHARE = 1e9
CROSSED = -4.0
FLATTEST = 0.3
RELAXED = 0.8
OUTSIDE = 0
INSIDE = 1
MIDDLE = 2
FLAT = 0.8
HURRY = 0.02
OCCLUSION_DIRECTIONS = 5
OCCLUSION_GAIN = 0.6


@struct
class Look:
    """The parameters of shading besides the lights.

    Attributes:
        occlusion: Reach of ambient occlusion, in scene units; 0 for none.
        fog_density: Fraction of the light that fog takes, per scene unit.
    """

    occlusion: float
    fog_density: float


@struct
class Opening:
    """What a shadow ray finds.

    Attributes:
        share: How far a light's disc is from the shadow; or how much of it is visible, 0 to 1.
        lost: Whether the steps of a ray ran out.
    """

    share: float
    lost: bool = False


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
def open_share(
    field: Field3,
    ray: Ray,
    width: float,
    end: float,
    bounds: Bounds,
    numbers: March,
    steps: int,
    steep: bool,
) -> Opening:
    """Return how far the disc of a light is from the shadow, as one ray to its middle finds it.

    Args:
        field: Signed distance.
        ray: The ray to the middle of the disc.
        width: Radius of the disc at distance 1.
        end: Distance along the ray where it ends.
        bounds: Box around the surface.
        numbers: The parameters of the march.
        steps: Maximum number of steps.
        steep: Whether values may be less than distances; a constant.

    Returns:
        The distance of the closest surface from the ray, in radii of the disc there: 1 or more if
        the whole disc is open, 0 if a straight edge is in the middle, -1 or less if the whole disc
        is hidden; ``CROSSED`` if the ray goes through both sides of something.
    """
    span = crossing(ray, bounds)
    last = min(end, span.y)
    t = max(span.x, 0.0) + numbers.threshold
    share = LONGEST_SHARE
    closest = t
    free = 0.0  # the distance at the previous point
    step = 0.0  # from the previous point to this one
    slope = 1.0
    entry = 0.0  # the slope along the ray where it went in, and the place
    entered = 0.0
    left = 0.0  # where it came out; the next point is the middle of the chord
    count = 0  # points inside
    state = OUTSIDE
    for i in range(min(steps, MOST_STEPS)):
        if t > last or share <= -1.0:
            break
        p = ray.origin + t * ray.direction
        value = field(p) / numbers.divisor
        if value < share * width * t:
            share = value / (width * t)
            closest = t
        if state == MIDDLE:
            # Two flat faces: half the chord is as deep as the entry predicts. Round: half as deep.
            if value < -FLAT * entry * (t - entered):
                share = CROSSED
            t = left
            free = 0.0
            step = 0.0
            state = OUTSIDE
        elif (
            state == OUTSIDE
            and step > free
            and value + free < step
            and not (abs(value) < NEARLY * t and abs((value - free) / step - slope) < 0.02)
        ):
            # The two free balls do not touch, and it is not the surface that was predicted: go back
            # to the edge of the first.
            t += free - step
            step = free
        else:
            before = slope
            slope = select(
                step > 0.0, (value - free) / max(step, 1e-9), select(value < 0.0, -1.0, 1.0)
            )
            free = value
            if state == OUTSIDE and value < NEARLY * t and slope < 0.0:
                state = INSIDE
                count = 0
                entry = clamp(-slope, 1e-3, 1.0)
                entered = t + value / entry
            if state == INSIDE and value > 0.0 and slope > 0.0:
                left = t
                chord = t - value / entry - entered
                if chord > 4.0 * NEARLY * t:
                    state = MIDDLE
                    step = 0.5 * chord - (t - entered)
                else:
                    state = OUTSIDE
                    if entry * numbers.steepest > 0.08:
                        share = CROSSED
            if state == INSIDE:
                count += 1
                step = max(abs(value), max(NEARLY, 0.1 * width * float(count)) * t)
                step = min(step, 0.15 * t + 2.0 * numbers.threshold)
            elif state == OUTSIDE:
                least = (HURRY if 3 * i > 2 * steps else NEARLY) * t
                if slope > 0.0:
                    step = value * (1.0 + RELAXED * min((1.0 + slope) / max(1.0 - slope, 0.1), 4.0))
                elif slope < -0.005 and abs(slope - before) < 0.02:
                    step = value / -slope
                elif value > 3.0 * width * t:
                    step = value * (1.0 + RELAXED * (1.0 + slope) / (1.0 - slope))
                else:
                    step = value
                step = max(step, least)
                if t + step > last and t + value < last:
                    # The free ball ends before the ray does: try the longer step at the ray's end.
                    step = last - t
            t += step
    lost = t <= last and share > -1.0
    if steep and share < 1.0 and share > -1.0:
        # The local gradient makes a distance of a value that is too small.
        p = ray.origin + closest * ray.direction
        share = share / true_slope(length(gradient(field, p)) / numbers.divisor, numbers)
    return Opening(share, lost)


@func
def true_slope(steepness: float, numbers: March) -> float:
    """Return |gradient| of a field at a point, within the bounds by which values are divided.

    Dividing by it makes a distance of a value near the surface.

    Args:
        steepness: |gradient|.
        numbers: The parameters of the march.
    """
    return max(steepness, FLATTEST / numbers.steepest)


@func
def toward_light(light: LightSample, k: int, count: int, spread: float) -> vec3:
    """Return the unit direction to a point of a light's disc, the points in a sunflower's order.

    Args:
        light: The light.
        k: The number of the point, from 0.
        count: How many points there are.
        spread: Distance of the outermost point from the middle, in radii of the disc.
    """
    ahead = light.direction
    right = tangent(ahead)
    above = cross(ahead, right)
    pairs = (count + 1) // 2
    pair = k // 2
    radius = spread * light.radius * sqrt((float(pair) + 0.5) / float(pairs))
    angle = GOLDEN_ANGLE * float(pair) + select(k % 2 == 1, 3.14159265, 0.0)
    return normalize(ahead + radius * (cos(angle) * right + sin(angle) * above))


@func
def soft_shadow(
    field: Field3,
    origin: vec3,
    light: LightSample,
    bounds: Bounds,
    numbers: March,
    steps: int,
    steep: bool = False,
    sample: int = 0,
    samples: int = 1,
) -> Opening:
    """Return the visible fraction of a light: 1 in full light, 0 in full shadow.

    Args:
        field: Signed distance.
        origin: Start of the shadow ray.
        light: The light at the point.
        bounds: Box around the surface.
        numbers: The parameters of the march.
        steps: Maximum number of steps of one ray.
        steep: Whether values may be less than distances; a constant.
        sample: The number of the pixel's sample, from 0.
        samples: How many samples the pixel has.
    """
    end = min(light.distance, numbers.far)
    whole = max(light.radius, SHARPEST)
    middle = Ray(origin, light.direction)
    if light.radius < NARROW:
        only = open_share(field, middle, whole, end, bounds, numbers, steps, steep)
        return Opening(share_of_disc(only.share), only.lost)
    by_sample = samples >= ENOUGH_SAMPLES
    count = samples if by_sample else rays_to(light.radius)
    part = inversesqrt(float(count))
    total = 0.0
    lost = False
    # Ray 0 goes to the middle of the whole disc. Only if it crosses something, which hides a part
    # of the disc that one ray does not tell, the others share the disc.
    for k in range(MOST_RAYS + 1):
        if k > 0 and (by_sample or k > count):
            break
        number = sample if by_sample else k - 1
        spread = select(number < 0, 0.0, 1.0 - 0.5 * part)
        ray = Ray(origin, toward_light(light, max(number, 0), count, spread))
        width = select(number < 0, whole, whole * part)
        found = open_share(field, ray, width, end, bounds, numbers, steps, steep)
        lost = lost or found.lost
        if number < 0 and found.share > CROSSED:
            return Opening(share_of_disc(found.share), lost)
        total += select(number < 0, 0.0, share_of_disc(found.share))
    return Opening(total / (1.0 if by_sample else float(count)), lost)


@func
def rays_to(radius: float) -> int:
    """Return the number of rays to a light with a disc of this radius, seen by one sample."""
    return 4 if radius <= 0.2 else (8 if radius <= 0.4 else MOST_RAYS)


@func
def share_of_disc(s: float) -> float:
    """Return how much of a disc an edge leaves open that is ``s`` radii from its middle."""
    c = clamp(s, -1.0, 1.0)
    return 0.25 * (1.0 + c) * (1.0 + c) * (2.0 - c)


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
def tangent(n: vec3) -> vec3:
    """Return a unit vector at right angles to a unit vector, continuous but for straight down.

    Source: Jeppe Revall Frisvad, "Building an Orthonormal Basis from a 3D Unit Vector Without
        Normalization" (2012).
    """
    a = 1.0 / max(1.0 + n.y, 1e-6)
    return vec3(1.0 - n.x * n.x * a, -n.x, -n.x * n.z * a)


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
    steep: bool = False,
    sample: int = 0,
    samples: int = 1,
) -> Lit:
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
        steep: Whether values of the field may be less than distances; a constant.
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
        flattest = true_slope(0.0, numbers)
        slope = true_slope(point.slope, numbers)
        around = around * ambient_occlusion(
            field, lifted, n, look.occlusion, slope, flattest, steep
        )
    color = point.surface.emission + around
    lost = False
    for i in range(light_count):
        light = lights(i, point.p)
        facing = dot(n, light.direction)
        if facing > 0.0:
            shadow = 1.0
            if shadow_steps > 0:
                seen = soft_shadow(
                    field, lifted, light, bounds, numbers, shadow_steps, steep, sample, samples
                )
                shadow = seen.share
                lost = lost or seen.lost
            shine = highlight(point.surface, n, view, light.direction, light.radius)
            scattered = point.shares.diffuse * facing + point.shares.mirrored * shine
            color += light.radiance * shadow * scattered
    return Lit(color, lost)
