"""Media: what is inside of the bodies that a ray goes through, and what it meets at their surfaces.

Input: in which bodies a ray runs, the body whose surface it met, the material there. Output: an
``Interface``: whether there is a boundary of two media, its material with the index relative to the
medium on its other side, and what the ray's way absorbed.

The solids of a scene with one priority are one body: where they overlap they merge. For paths,
those of glass and opaque ones are two. Bodies are numbered from the lowest priority up; where they
overlap, the higher displaces the lower, whose surfaces are not there. A set of bodies is a sum of
powers of two, 0 in the air.

Source: Charles M. Schmidt and Brian Budge, "Simple Nested Dielectrics in Ray Traced Images" (2002).
"""

from __future__ import annotations

from collections.abc import Callable

from distal.lang import exp2, func, max, select, struct, vec3
from distal.render.camera import Ray
from distal.render.dispersion import YELLOW_LINE, index_at
from distal.render.footprint import Footprint
from distal.render.lost_rays import has
from distal.render.march import PASSED, Hit
from distal.render.material import Surface

NONE = -1
# The numbers of a body's own parts are above minus this.
SPAN = 32


@struct
class Interface:
    """What a ray meets at the surface of a body.

    Attributes:
        within: The bodies on the other side.
        is_boundary: Whether two media meet; if not, the ray goes straight on.
        inside: Whether the ray comes from the inside of what has the surface.
        surface: The material, with the index relative to what is around it.
        absorption: The absorption coefficient of the ray's way to the surface, per scene unit.
        index: The index of refraction of the medium through which the ray came.
    """

    within: int
    is_boundary: bool
    inside: bool
    surface: Surface
    absorption: vec3
    index: float


@func
def bit_of(body: int) -> int:
    """Return the power of two of a body."""
    return int(exp2(float(body)) + 0.5)


@func
def highest(within: int, bodies: int) -> int:
    """Return the body of a set with the highest priority; ``NONE`` in the air.

    Args:
        within: The set.
        bodies: How many bodies the scene has; a constant.
    """
    found = NONE
    for body in range(bodies):
        found = select(has(within, bit_of(body)), body, found)
    return found


@func
def offset_of(body: int, common: int) -> int:
    """Return how far the parts (``Hit.part``) of a body are below its own numbers.

    Args:
        body: The body.
        common: The body that may have a table, whose parts are its own numbers.
    """
    return select(body == common, 0, SPAN * (body + select(body > common, 0, 1)))


@func
def body_of(part: int, common: int) -> int:
    """Return the body that a surface belongs to.

    Args:
        part: ``Hit.part``.
        common: The body that may have a table.
    """
    other = -part // SPAN - 1
    return select(part > -SPAN, common, other + select(other >= common, 1, 0))


@func
def part_of(body: int, common: int) -> int:
    """Return a part (``Hit.part``) that belongs to a body.

    Args:
        body: The body.
        common: The body that may have a table.
    """
    return -1 - offset_of(body, common)


@func
def at_wavelength(surface: Surface, wavelength: float) -> Surface:
    """Return a material with the index of refraction of a wavelength."""
    surface.ior = index_at(surface.ior, surface.dispersion, wavelength)
    return surface


@func
def interface_at(
    own: Surface,
    p: vec3,
    footprint: Footprint,
    hit: Hit,
    within: int,
    surface: Callable[[vec3, Footprint, int], Surface],
    bodies: int,
    common: int,
    wavelength: float = YELLOW_LINE,
) -> Interface:
    """Return what a ray meets at a surface.

    Args:
        own: The material of the surface.
        p: The place.
        footprint: The footprint of the pixel there.
        hit: The end of the ray.
        within: The bodies in which the ray runs.
        surface: The material at a point of a part, averaged over a footprint.
        bodies: How many bodies the scene has; a constant.
        common: The body that may have a table; a constant.
        wavelength: The wavelength of the ray's light, in nanometers.
    """
    own = at_wavelength(own, wavelength)
    leaves = hit.side < 0.0
    absorption = select(leaves, own.absorption, vec3(0.0))
    index = select(leaves, own.ior, 1.0)
    if bodies == 1:
        return Interface(select(leaves, 0, 1), True, leaves, own, absorption, index)
    body = body_of(hit.part, common)
    bit = bit_of(body)
    others = within - select(leaves, bit, 0)
    beyond = select(leaves, others, others + bit)
    around = highest(others, bodies)
    if around == NONE:
        return Interface(beyond, True, leaves, own, absorption, index)
    medium = at_wavelength(surface(p, footprint, part_of(around, common)), wavelength)
    is_boundary = body > around
    taken = select(leaves and is_boundary, own.absorption, medium.absorption)
    index = select(leaves and is_boundary, own.ior, medium.ior)
    if leaves and medium.transmission <= 0.0:
        # What is around is opaque: the ray meets its surface.
        medium.ior = medium.ior / own.ior
        return Interface(beyond, is_boundary, False, medium, taken, index)
    own.ior = own.ior / medium.ior
    return Interface(beyond, is_boundary, leaves, own, taken, index)


@func
def in_air_or_body(ray: Ray, hit: Hit) -> int:
    """Return in which bodies a camera's ray starts, in a scene of one body."""
    return select(hit.side < 0.0, 1, 0)


@func
def first_of_body(own: Callable[[Ray], Hit], ray: Ray, body: int, bodies: int, common: int) -> Hit:
    """Return where a camera's ray meets one body.

    Args:
        own: The first surface of the body along a ray.
        ray: The ray.
        body: The body; a constant.
        bodies: How many bodies the scene has; a constant.
        common: The body that may have a table; a constant.
    """
    hit = own(ray)
    part = hit.part - offset_of(body, common)
    return Hit(hit.t, hit.found, hit.steps, hit.side, hit.lost, part)


@func
def next_of_body(
    own: Callable[[Ray, float, float, int], Hit],
    ray: Ray,
    within: int,
    slope: float,
    part: int,
    body: int,
    bodies: int,
    common: int,
) -> Hit:
    """Return where a ray from a surface crosses the surface of one body.

    Args:
        own: The next surface of the body along a ray, by the side on which the ray runs, the slope
            with which it leaves a surface of this body, and the part of a table that has it.
        ray: The ray.
        within: The bodies in which it runs.
        slope: How fast the field grows along it, of the surface on which it starts.
        part: The part that has this surface.
        body: The body; a constant.
        bodies: How many bodies the scene has; a constant.
        common: The body that may have a table; a constant.
    """
    if bodies == 1:
        return own(ray, select(within == 0, 1.0, -1.0), slope, part)
    starts = body_of(part, common) == body
    side = select(has(within, bit_of(body)), -1.0, 1.0)
    below = offset_of(body, common)
    hit = own(ray, side, select(starts, slope, 0.0), select(starts, part + below, -1))
    return Hit(hit.t, hit.found, hit.steps, hit.side, hit.lost, hit.part - below)


@func
def nearer(first: Hit, second: Hit) -> Hit:
    """Return the nearer of two ends of a ray, with the steps of both."""
    steps = first.steps + second.steps
    if second.found and (not first.found or second.t < first.t):
        return Hit(second.t, True, steps, second.side, PASSED, second.part)
    lost = select(first.found, PASSED, max(first.lost, second.lost))
    return Hit(first.t, first.found, steps, first.side, lost, first.part)
