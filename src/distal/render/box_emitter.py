"""A box that emits light: random directions to its visible faces, and their density.

Input: a point in the box's own coordinates (the middle is 0), half of its sizes. Output: directions
in those coordinates. Does not depend on what the box emits.
"""

from __future__ import annotations

from distal.lang import abs, dot, func, max, min, select, sqrt, struct, vec3


@struct
class Aim:
    """A random direction to a shape.

    Attributes:
        direction: Unit direction.
        distance: Distance to the shape along it.
        density: Its density by solid angle; 0 if nothing can be aimed at.
    """

    direction: vec3
    distance: float
    density: float


@func
def face_shares(p: vec3, half: vec3) -> vec3:
    """Return the probabilities of the visible faces across x, y and z; 0 from inside.

    About the solid angle of each: its area, seen from its middle.
    """
    above = max(abs(p) - half, vec3(0.0))
    areas = half.yzx * half.zxy
    side = select(p < vec3(0.0), -half, half)
    to_x = vec3(p.x - side.x, p.y, p.z)
    to_y = vec3(p.x, p.y - side.y, p.z)
    to_z = vec3(p.x, p.y, p.z - side.z)
    squared = max(vec3(dot(to_x, to_x), dot(to_y, to_y), dot(to_z, to_z)), vec3(1e-20))
    weights = areas * above / (squared * sqrt(squared))
    return weights / max(weights.x + weights.y + weights.z, 1e-30)


@func
def aim_density(p: vec3, half: vec3, axis: int, distance: float) -> float:
    """Return the density of a direction that meets the visible face across an axis.

    Args:
        p: Point outside of the box.
        half: Half of its sizes.
        axis: 0, 1 or 2.
        distance: Distance to the place on the face.
    """
    areas = 4.0 * half.yzx * half.zxy
    above = abs(p[axis]) - half[axis]
    cubed = distance * distance * distance
    shares = face_shares(p, half)
    return select(above > 0.0, shares[axis] * cubed / max(areas[axis] * above, 1e-30), 0.0)


@func
def aim_at_box(p: vec3, half: vec3, u: vec3) -> Aim:
    """Return a random direction to a box, uniform by area on each visible face.

    Args:
        p: Point outside of the box, in its coordinates.
        half: Half of its sizes.
        u: Three random numbers in [0, 1); the third chooses the face.
    """
    shares = face_shares(p, half)
    axis = 0 if u.z < shares.x else (1 if u.z < shares.x + shares.y else 2)
    # Rounding errors of the sum must not choose a face that is not visible.
    axis = select(shares[axis] > 0.0, axis, select(shares.x > 0.0, 0, 1))
    flat = vec3(2.0 * u.x - 1.0, 2.0 * u.y - 1.0, 1.0)
    turned = flat.zxy if axis == 0 else (flat.yzx if axis == 1 else flat)
    place = turned * half
    place[axis] = select(p[axis] < 0.0, -half[axis], half[axis])
    offset = place - p
    distance = sqrt(max(dot(offset, offset), 1e-30))
    return Aim(offset / distance, distance, aim_density(p, half, axis, distance))


@func
def box_density(p: vec3, half: vec3, direction: vec3) -> Aim:
    """Return the density with which ``aim_at_box`` chooses a direction; 0 if it misses.

    Args:
        p: Point outside of the box, in its coordinates.
        half: Half of its sizes.
        direction: Unit direction.
    """
    slope = 1.0 / select(abs(direction) < vec3(1e-20), vec3(1e-20), direction)
    middle = -p * slope
    reach = half * abs(slope)
    entries = middle - reach
    exits = middle + reach
    entry = max(entries.x, entries.y, entries.z)
    leaves = min(exits.x, exits.y, exits.z)
    axis = 0 if entries.x >= entry else (1 if entries.y >= entry else 2)
    met = entry > 0.0 and entry <= leaves
    density = select(met, aim_density(p, half, axis, entry), 0.0)
    return Aim(direction, entry, density)
