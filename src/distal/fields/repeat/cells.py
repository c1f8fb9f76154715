"""Repetition of a shape on a grid, for any set of copies.

Input: a point, the copies (spacing, origin, first and last index), the child's box. Output: the
point in the local space of a copy, the cell's index, and a value that is safe to march. Each kind
of repetition (infinite, limited, interval, half, ring) is a function from its numbers to
``Copies``.

How a repetition stays safe: the child is evaluated in one cell (``neighbors=0``) or in a few. A
plain modulo is discontinuous at a cell's border unless the child is symmetric, and its value does
not bound the distance to the next copy: a step may pass through that copy. Therefore the box of
each copy stands for a copy that is not evaluated: the value never exceeds the distance to the
nearest of these boxes, and the value of an evaluated copy is at least the distance to its own box.
Where the set of evaluated copies changes, the box that leaves the set is as far away as the box
that enters it, so both sides have that distance: the result is continuous for every child. Its
slope is the child's, or 1 (of the boxes) if that is larger.

There must be a gap between the boxes, otherwise their faces would look like surfaces: a child that
does not fit has no slope (``UNBOUNDED``) and is refused. Cells are centred on the child's box,
wherever it lies. A child that is symmetric in its cell does not need any of this: ``repeat
mirrored``.

Source: the cells, and the need to ask neighbors: Inigo Quilez, "Domain repetition"
(https://iquilezles.org/articles/sdfrepetition/); names of the kinds: hg_sdf
(https://mercury.sexy/hg_sdf/). The bound by boxes is derived here.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.extents import largest, smallest
from distal.fields.guarantees import ENDLESS, UNBOUNDED, Bounds, Site
from distal.fields.widths import SHEET
from distal.lang import (
    Vectors,
    abs,
    all,
    clamp,
    dot,
    func,
    length,
    max,
    min,
    round,
    select,
    sqrt,
    struct,
    vec3,
)

# The fraction of the spacing that must be free on each side of a copy's box.
ROOM = 0.01
# If copies may overlap: the fraction of the spacing by which the evaluated copies must be nearer.
LEAD = 0.1


@struct
class Copies:
    """The copies of a repetition: at ``origin + index * spacing``, index from first to last."""

    spacing: vec3
    origin: vec3
    first: vec3
    last: vec3


@struct
class Nearest:
    """The nearest of the evaluated copies: its distance, and the place of evaluation."""

    distance: float
    site: Site


@func
def repeated_axes(spacing: Vectors) -> Vectors:
    """Return 1 along the axes that are repeated, 0 along the others."""
    return select(spacing == 0.0, spacing * 0.0, spacing * 0.0 + 1.0)


@func
def endless(spacing: vec3) -> Copies:
    """Return copies that are infinite to both sides."""
    far = vec3(UNBOUNDED)
    return Copies(spacing, vec3(0.0), -far, far)


@func
def counted(spacing: vec3, count_x: int = 1, count_y: int = 1, count_z: int = 1) -> Copies:
    """Return a block of copies around the origin; indices start at 0."""
    last = vec3(float(count_x), float(count_y), float(count_z)) - 1.0
    return Copies(spacing, -0.5 * last * spacing, vec3(0.0), last)


@func
def interval(
    spacing: vec3,
    first_x: int = 0,
    first_y: int = 0,
    first_z: int = 0,
    last_x: int = 0,
    last_y: int = 0,
    last_z: int = 0,
) -> Copies:
    """Return the copies from one index to another, both included; copy 0 is the child itself."""
    first = vec3(float(first_x), float(first_y), float(first_z))
    return Copies(spacing, vec3(0.0), first, vec3(float(last_x), float(last_y), float(last_z)))


@func
def onward(spacing: vec3) -> Copies:
    """Return the copies from index 0 on, infinite."""
    return Copies(spacing, vec3(0.0), vec3(0.0), vec3(UNBOUNDED) * repeated_axes(spacing))


@func
def width_of_copies(child_width: float, copies: Copies, bounds: Bounds) -> float:
    """Return the width of a repetition: of the shape, or of the gap between the boxes of copies."""
    sides = bounds.high - bounds.low
    gap = child_width
    for axis in range(3):
        room = abs(copies.spacing[axis]) - sides[axis]
        if room > 0.0 and copies.last[axis] > copies.first[axis]:
            gap = min(gap, SHEET * room)
    return gap


@func
def middle_of(bounds: Bounds) -> vec3:
    """Return the middle of a box; 0 along an infinite axis."""
    return 0.5 * bounds.low + 0.5 * bounds.high


@func
def nearest_index(p: vec3, copies: Copies, bounds: Bounds) -> vec3:
    """Return the index of the copy whose box's middle is nearest."""
    axes = repeated_axes(copies.spacing)
    steps = (p - copies.origin - middle_of(bounds)) / (copies.spacing + 1.0 - axes)
    return clamp(round(steps), copies.first, copies.last) * axes


@func
def beside(p: vec3, copies: Copies, index: vec3) -> vec3:
    """Return the point in the local space of a copy."""
    return p - copies.origin - index * copies.spacing


@func
def at_end(away: vec3, copies: Copies, index: vec3) -> vec3:
    """Return 1 along the axes where no copy follows on the side of the point."""
    beyond_high = select(index >= copies.last, vec3(1.0), vec3(0.0))
    beyond_low = select(index <= copies.first, vec3(1.0), vec3(0.0))
    return select(away < 0.0, beyond_low, beyond_high)


@func
def to_others(
    away: vec3, half: vec3, copies: Copies, index: vec3, neighbors: int, limited: bool
) -> vec3:
    """Return the distance to the nearest box that is not evaluated, along each axis.

    Args:
        away: The vector from the middle of the nearest copy's box to the point.
        half: Half of the box's size.
        copies: All copies.
        index: The index of the nearest copy.
        neighbors: 0: only the nearest copy is evaluated; 1: also the next towards the point; 2: on
            both sides.
        limited: Whether the set of copies is finite on any side.
    """
    distance = abs(away)
    side = distance if neighbors == 1 else -distance
    if limited:
        side = select(at_end(away, copies, index) > 0.5, distance, side)
    steps = 2.0 if neighbors == 2 else 1.0
    gap = steps * copies.spacing + side - half
    alone = select(copies.first == copies.last, vec3(UNBOUNDED), gap)
    return select(copies.spacing == 0.0, vec3(UNBOUNDED), alone)


@func
def distance_to_box(away: vec3, half: vec3) -> float:
    """Return the distance to a box around the origin, negative inside."""
    beyond = abs(away) - half
    return length(max(beyond, vec3(0.0))) + min(largest(beyond), 0.0)


@func
def distance_to_others(away: vec3, half: vec3, gap: vec3) -> float:
    """Return the distance to the boxes of the copies that are not evaluated.

    Such a copy is at the distance ``gap`` along at least one axis; along the others it may be as
    near as the evaluated ones.
    """
    beside = max(abs(away) - half, vec3(0.0))
    across = max(gap, beside)
    return sqrt(dot(beside, beside) + smallest(across * across - beside * beside))


@func
def half_of(bounds: Bounds) -> vec3:
    """Return half of a box's size."""
    return 0.5 * bounds.high - 0.5 * bounds.low


# One cell


@func
def site_in(p: vec3, copies: Copies, bounds: Bounds) -> Site:
    """Return the point in the local space of the nearest copy, and that copy's index."""
    index = nearest_index(p, copies, bounds)
    return Site(beside(p, copies, index), index)


@func
def value_in(d: float, p: vec3, copies: Copies, bounds: Bounds, limited: bool) -> float:
    """Return the value of the nearest copy, limited by the others."""
    index = nearest_index(p, copies, bounds)
    away = beside(p, copies, index) - middle_of(bounds)
    half = half_of(bounds)
    gap = to_others(away, half, copies, index, 0, limited)
    return min(max(d, distance_to_box(away, half)), distance_to_others(away, half, gap))


@func
def slope_in(slope: float, bounds: Bounds, copies: Copies, neighbors: int) -> float:
    """Return the child's slope, or 1 if larger; no bound if there is no gap between the boxes."""
    half = half_of(bounds)
    room = 0.5 * copies.spacing - half
    share = ROOM
    if neighbors > 0:
        room = (0.5 * float(neighbors) + 0.5) * copies.spacing - half
        share = LEAD
    alone = copies.first == copies.last
    fits = select(alone, vec3(0.0), share * copies.spacing - room)
    fits = select(copies.spacing == 0.0, vec3(0.0), fits)
    return select(largest(fits) > 0.0, UNBOUNDED, max(slope, 1.0))


@func
def bounds_in(bounds: Bounds, copies: Copies) -> Bounds:
    """Return the box around all copies."""
    low = bounds.low + copies.origin + copies.first * copies.spacing
    high = bounds.high + copies.origin + copies.last * copies.spacing
    far = vec3(UNBOUNDED)
    onward = copies.spacing > 0.0
    low = select(copies.first < -ENDLESS, select(onward, -far, bounds.low), low)
    high = select(copies.last > ENDLESS, select(onward, far, bounds.high), high)
    return Bounds(low, high)


# Several cells


@func
def nearest_copy(
    field: Callable[[vec3, vec3], float],
    p: vec3,
    copies: Copies,
    bounds: Bounds,
    neighbors: int,
    limited: bool,
) -> Nearest:
    """Return the nearest of the copies around the point, limited by those not evaluated."""
    index = nearest_index(p, copies, bounds)
    middle = middle_of(bounds)
    q = beside(p, copies, index)
    away = q - middle
    half = half_of(bounds)
    toward = select(away < 0.0, vec3(-1.0), vec3(1.0))
    gap = to_others(away, half, copies, index, neighbors, limited)
    distance = distance_to_others(away, half, gap)
    nearest = UNBOUNDED
    site = Site(q, index)
    start = 0 if neighbors == 1 else -1
    for z in range(start, 2):
        if z != 0 and copies.spacing.z == 0.0:
            continue
        for y in range(start, 2):
            if y != 0 and copies.spacing.y == 0.0:
                continue
            for x in range(start, 2):
                if x != 0 and copies.spacing.x == 0.0:
                    continue
                step = vec3(float(x), float(y), float(z)) * toward
                place = q - step * copies.spacing
                there = index + step
                if limited and not all(clamp(there, copies.first, copies.last) == there):
                    continue
                d = max(field(place, there), distance_to_box(place - middle, half))
                if d < nearest:
                    nearest = d
                    site = Site(place, there)
    return Nearest(min(nearest, distance), site)


@func
def nearest_copy_distance(
    field: Callable[[vec3, vec3], float],
    p: vec3,
    copies: Copies,
    bounds: Bounds,
    neighbors: int,
    limited: bool,
) -> float:
    """Return the distance to the nearest of the copies around the point."""
    return nearest_copy(field, p, copies, bounds, neighbors, limited).distance


@func
def nearest_copy_site(
    field: Callable[[vec3, vec3], float],
    p: vec3,
    copies: Copies,
    bounds: Bounds,
    neighbors: int,
    limited: bool,
) -> Site:
    """Return the place in the cell of the nearest copy."""
    return nearest_copy(field, p, copies, bounds, neighbors, limited).site
