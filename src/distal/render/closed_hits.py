"""Surfaces of solids whose chords are known, without a march.

Input: a function of a ray that knows where the solids are, and planes. Output: a ``Hit``. A solid
is met where its chord begins: exactly, at any distance, also by rays that graze it. A ray that
starts inside of a solid goes on to where no solid goes on.

Paths know the solid on which a ray starts (``Hit.part``). A ray that leaves a convex solid does not
meet it again, and one that enters it ends where its chord does: neither depends on the rounding of
the start.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.chords import missed
from distal.fields.guarantees import UNBOUNDED
from distal.lang import Field3, abs, func, max, min, select, struct, vec2
from distal.render.camera import Ray
from distal.render.march import PASSED, TOO_FAR, Hit, March

# Solids that are closer to one another than this part of the place's coordinates touch.
TOUCHING = 4e-7


@struct
class Met:
    """Where a ray meets solids.

    Attributes:
        t: Distance to the first surface; ``UNBOUNDED`` if there is none.
        inside: Whether the ray starts inside of a solid: then the surface is the end of it.
    """

    t: float
    inside: bool


@struct
class Passed:
    """What is known of some of the solids along a ray, from a place on.

    Attributes:
        entry: Distance to the first solid that begins behind the place.
        cover: Distance to the end of the solids around the place; that of the place if none is.
    """

    entry: float
    cover: float


@func
def pass_chord(passed: Passed, chord: vec2, ray: Ray) -> Passed:
    """Return what is known of the solids with one more.

    Args:
        passed: What is known without it.
        chord: Where the ray enters and leaves the solid; x > y if it misses it.
        ray: The ray.
    """
    place = abs(ray.origin)
    gap = TOUCHING * (place.x + place.y + place.z + passed.cover)
    goes_on = chord.y > passed.cover + gap and chord.x <= chord.y
    covers = goes_on and chord.x <= passed.cover + gap
    begins = goes_on and not covers
    return Passed(
        select(begins, min(passed.entry, chord.x), passed.entry),
        select(covers, chord.y, passed.cover),
    )


@func
def pass_plane(passed: Passed, chord: vec2, ray: Ray, below: bool) -> Passed:
    """As ``pass_chord``, of a half space that counts only for rays from below a plane."""
    return pass_chord(passed, select(below, chord, missed()), ray)


@func
def meet_solids(
    solids: Callable[[Ray, float, bool], Passed], ray: Ray, near: float, count: int, below: bool
) -> Met:
    """Return the first surface of solids along a ray.

    Args:
        solids: What is along a ray from a place on; takes the place, and whether planes count.
        ray: The ray.
        near: Distance along the ray where it begins.
        count: The number of solids and planes.
        below: Whether the ray starts below a plane, so that planes are solids to leave.
    """
    t = near
    entry = UNBOUNDED
    for _ in range(count + 1):
        found = solids(ray, t, below)
        entry = found.entry
        if found.cover <= t:
            break
        t = found.cover
    inside = t > near
    return Met(select(inside, t, entry), inside)


@func
def first_surface_of_solids(
    planes: Field3,
    nearest_plane: Callable[[Ray], float],
    solids: Callable[[Ray, float, bool], Passed],
    ray: Ray,
    numbers: March,
    farthest_plane: float,
    count: int,
    has_planes: bool,
) -> Hit:
    """Return the first surface along a ray of solids with chords, and of planes.

    Args:
        planes: Signed distance of the planes' union.
        nearest_plane: Distance along a ray that starts above all planes to the first of them.
        solids: As for ``meet_solids``.
        ray: Ray.
        numbers: The parameters of a march; its limits hold here too.
        farthest_plane: Planes farther along the ray are not seen.
        count: The number of solids and planes; a constant.
        has_planes: Whether there are planes; a constant.
    """
    below = False
    plane = UNBOUNDED
    if has_planes:
        below = planes(ray.origin) <= 0.0
        if not below:
            plane = nearest_plane(ray)
    met = meet_solids(solids, ray, numbers.near, count, below)
    if has_planes and plane < met.t and plane < farthest_plane:
        return Hit(plane, True, 1, 1.0)
    found = met.t < numbers.far
    lost = select(found or met.t >= UNBOUNDED, PASSED, TOO_FAR)
    return Hit(min(met.t, numbers.far), found, 1, select(met.inside, -1.0, 1.0), lost)


@struct
class Reached:
    """A place along a ray, at the surface of a solid.

    Attributes:
        t: Distance along the ray.
        part: The number of the solid; -1 if there is none.
    """

    t: float
    part: int


@func
def rounding_gap(ray: Ray, t: float) -> float:
    """Return the distance below which solids touch, at a place of a ray."""
    place = abs(ray.origin)
    return TOUCHING * (place.x + place.y + place.z + t)


@func
def entered(reached: Reached, chord: vec2, of: int, part: int, near: float, ray: Ray) -> Reached:
    """Return the first solid that a ray from outside enters, given one more of them.

    Args:
        reached: The first of the others.
        chord: Where the ray enters and leaves the solid; x > y if it misses it.
        of: The number of the solid.
        part: The number of the solid on which the ray starts, which it does not enter again; -1 if
            that is not known.
        near: Distance along the ray where it begins.
        ray: The ray.
    """
    t = max(chord.x, near)
    is_ahead = chord.x <= chord.y and chord.y > near + rounding_gap(ray, near)
    meets = is_ahead and of != part and t < reached.t
    return Reached(select(meets, t, reached.t), select(meets, of, reached.part))


@func
def covered(reached: Reached, chord: vec2, of: int, part: int, ray: Ray) -> Reached:
    """Return how far solids go on along a ray from inside of them, given one more of them.

    Args:
        reached: How far the others go on.
        chord: As for ``entered``.
        of: The number of the solid.
        part: The number of the solid on which the ray starts: it is inside of it, also if it starts
            beside it by rounding; -1 if that is not known.
        ray: The ray.
    """
    end = reached.t + rounding_gap(ray, reached.t)
    goes_on = chord.y > select(of == part, reached.t, end) and chord.x <= chord.y
    goes_on = goes_on and (chord.x <= end or of == part)
    return Reached(select(goes_on, chord.y, reached.t), select(goes_on, of, reached.part))


@func
def segment_of_solids(
    entry: Reached,
    covers: Callable[[Reached], Reached],
    side: float,
    part: int,
    near: float,
    farthest_plane: float,
    count: int,
) -> Hit:
    """Return the next surface along a ray of solids with chords.

    Args:
        entry: The first solid that the ray enters if it runs outside of all of them.
        covers: ``covered`` by each of the solids.
        side: 1 if the ray runs outside, -1 inside; 0 if that is not known.
        part: As for ``covered``.
        near: Distance along the ray where it begins.
        farthest_plane: The author's limit of rays: what is farther along the ray is not seen.
        count: The number of solids; a constant.
    """
    end = Reached(near, part)
    if side <= 0.0:
        for _ in range(count):
            further = covers(end)
            if further.t <= end.t:
                break
            end = further
    inside = side < 0.0 or end.t > near
    t = select(inside, end.t, entry.t)
    of = select(inside, end.part, entry.part)
    found = t < farthest_plane
    lost = select(found or t >= UNBOUNDED, PASSED, TOO_FAR)
    length = min(t, farthest_plane)
    return Hit(length, found, 1, select(inside, -1.0, 1.0), lost, select(found, of, -1))
