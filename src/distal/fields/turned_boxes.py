"""Boxes along axes of their own, which rigid moves and uniform scales of a shape carry exactly.

Input: boxes of shapes, and what an operator does to the origin and to directions. Output: the box
of the moved shape, boxes of two shapes along the axes of one of them, the distance to such a box.
Does not depend on operators.
"""

from __future__ import annotations

from distal.fields.extents import box_distance, hull_of, overlap, turned
from distal.fields.guarantees import UNBOUNDED, Bounds, Bounds2
from distal.lang import dot, func, mat3, max, struct, vec2, vec3


@struct
class TurnedBox:
    """A box along three axes.

    ``right``, ``up`` and ``back`` are its x, y and z axis: ``box`` contains the points whose
    coordinates are the dot products with them.
    """

    right: vec3
    up: vec3
    back: vec3
    box: Bounds


@func
def upright_box(bounds: Bounds) -> TurnedBox:
    """Return a box along the axes of space."""
    return TurnedBox(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0), bounds)


@func
def upright_rectangle(bounds: Bounds2) -> TurnedBox:
    """Return a rectangle along the axes of the plane, as a box without an end along z."""
    low, high = vec3(bounds.low, -UNBOUNDED), vec3(bounds.high, UNBOUNDED)
    return upright_box(Bounds(low, high))


@func
def along_axes(p: vec3, axes: TurnedBox) -> vec3:
    """Return the coordinates of a point or a direction along the axes of a box."""
    return vec3(dot(axes.right, p), dot(axes.up, p), dot(axes.back, p))


@func
def carried_box(
    inner: TurnedBox, origin: vec3, turned_x: vec3, turned_y: vec3, turned_z: vec3, factor: float
) -> TurnedBox:
    """Return the box of a shape that was moved, turned and scaled.

    Args:
        inner: The box of the shape before.
        origin: The point before, of the origin after.
        turned_x: The direction before, of the x axis after.
        turned_y: That of the y axis.
        turned_z: That of the z axis.
        factor: The scale.
    """
    away = along_axes(origin, inner)
    x, y, z = along_axes(turned_x, inner), along_axes(turned_y, inner), along_axes(turned_z, inner)
    box = Bounds(factor * (inner.box.low - away), factor * (inner.box.high - away))
    return TurnedBox(vec3(x.x, y.x, z.x), vec3(x.y, y.y, z.y), vec3(x.z, y.z, z.z), box)


@func
def along_the_first(a: TurnedBox, b: TurnedBox) -> Bounds:
    """Return the box around a second box, along the axes of the first."""
    across = mat3(along_axes(b.right, a), along_axes(b.up, a), along_axes(b.back, a))
    return turned(b.box, across)


@func
def turned_hull(a: TurnedBox, b: TurnedBox) -> TurnedBox:
    """Return the box around two boxes, along the axes of the first."""
    return TurnedBox(a.right, a.up, a.back, hull_of(a.box, along_the_first(a, b)))


@func
def turned_overlap(a: TurnedBox, b: TurnedBox) -> TurnedBox:
    """Return a box around what is in two boxes, along the axes of the first."""
    return TurnedBox(a.right, a.up, a.back, overlap(a.box, along_the_first(a, b)))


@func
def within_axes(d: float, p: vec3, axes: TurnedBox) -> float:
    """Return a distance that is at least that to a box along axes of its own."""
    return max(d, box_distance(along_axes(p, axes), axes.box))


@func
def within_flat_axes(d: float, p: vec2, axes: TurnedBox) -> float:
    """Return a distance that is at least that to a rectangle along axes of its own."""
    return within_axes(d, vec3(p, 0.0), axes)
