"""What all marches along rays have in common: their parameters, their result, and boxes.

Input: a ray and a box. Output: the part of the ray within it. ``segment`` finds surfaces of signed
fields (a hit is decided in its ``moved``), ``heightfield_march`` those of terrain, ``closed_hits``
those of solids with chords.
"""

from __future__ import annotations

from distal.fields.guarantees import Bounds
from distal.lang import abs, func, max, min, select, struct, vec2
from distal.render.camera import Ray

# A limit of loops for targets that need a constant one.
MOST_STEPS = 65536

# Why a ray has found no surface.
PASSED = 0  # it left the box, or moved away from the surfaces
OUT_OF_STEPS = 1
TOO_FAR = 2  # the far limit ended it on its way towards a surface


@struct
class March:
    """The parameters of a march.

    Attributes:
        divisor: Distances are divided by it to get a safe step.
        near: Distance along the ray where rays begin.
        far: Distance along the ray where rays end.
        threshold: How exactly a surface has to be known, as a part of the distance along the ray;
            0: to a rounding error.
        steepest: The largest number by which the field already divides one of its parts (a safe
            field); 1 for other fields.
    """

    divisor: float
    near: float
    far: float
    threshold: float
    steepest: float = 1.0


@struct
class Hit:
    """The end of a ray.

    Attributes:
        t: Distance along the ray, in scene units.
        found: Whether there is a surface.
        steps: Number of evaluations of the field.
        side: -1 if the ray began inside a solid, else 1.
        lost: PASSED, OUT_OF_STEPS or TOO_FAR; PASSED if a surface was found.
        part: The part of a table (``part_tree``) that has the surface; -1 for other surfaces.
    """

    t: float
    found: bool
    steps: int
    side: float
    lost: int = PASSED
    part: int = -1


@func
def crossing(ray: Ray, bounds: Bounds) -> vec2:
    """Return where a ray enters and leaves a box, which may be infinite; x > y if it misses it."""
    tiny = 1e-9
    direction = select(abs(ray.direction) < tiny, ray.direction * 0.0 + tiny, ray.direction)
    near = (bounds.low - ray.origin) / direction
    far = (bounds.high - ray.origin) / direction
    first = min(near, far)
    last = max(near, far)
    return vec2(
        max(first.x, max(first.y, first.z)),
        min(last.x, min(last.y, last.z)),
    )
