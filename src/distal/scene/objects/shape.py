"""Solid and flat shapes, and the methods that only one of the two has.

Input: the author's numbers. Output: new shapes; none changes. Every method applies an operator of
the field library.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final, Self, cast

from distal.fields.combine import blends, joins, transitions
from distal.fields.deform import folds
from distal.fields.deform import solid as deform
from distal.fields.ease import EASES
from distal.fields.guarantees import Operator
from distal.fields.lift import extrude, path
from distal.fields.lift import round as lift
from distal.fields.place import flat as flat_placing
from distal.fields.place import solid as placing
from distal.fields.repeat import along, grid
from distal.fields.solids import heightfield
from distal.ir.types import VEC2, VEC3
from distal.scene.objects.field import PLAIN, BaseShape
from distal.scene.objects.placed import Placed
from distal.scene.objects.turns import warn_of_degrees
from distal.scene.tree.errors import refuse
from distal.scene.tree.source_places import author_place

_ROTATIONS: Final[Mapping[str, Operator]] = {
    "x": placing.ROTATE_X,
    "y": placing.ROTATE_Y,
    "z": placing.ROTATE_Z,
}


class Shape(Placed):
    """A solid: a signed distance in space. Shapes never change; methods return new ones."""

    flat = False
    point_type = VEC3

    def rotate(
        self,
        angle: Any = None,
        axis: Any = None,
        *,
        x: Any = None,
        y: Any = None,
        z: Any = None,
        quaternion: Any = None,
        matrix: Any = None,
    ) -> Self:
        """Rotate about the origin, in one of four ways; angles in radians.

        Args:
            angle: About ``axis``.
            axis: Of length 1.
            x: About the fixed x axis, first.
            y: About the fixed y axis, then.
            z: About the fixed z axis, last.
            quaternion: (x, y, z, w), of length 1.
            matrix: Three rows, orthonormal.

        Raises:
            SceneValueError: No way is given, or more than one.
        """
        euler = {name: value for name, value in (("x", x), ("y", y), ("z", z)) if value is not None}
        warn_of_degrees(author_place(), angle, *euler.values())
        ways = [angle is not None or axis is not None, bool(euler)]
        ways += [quaternion is not None, matrix is not None]
        if sum(ways) != 1:
            hint = "rotate(y=0.5), rotate(0.5, axis=(0, 1, 0)), quaternion=… or matrix=…"
            refuse("a rotation is given in exactly one way", hint, author_place())
        if euler:
            if len(euler) == 1:
                ((name, value),) = euler.items()
                return self._with(_ROTATIONS[name], value)
            return self._with(placing.ROTATE_EULER, tuple(euler.get(n, 0.0) for n in "xyz"))
        if quaternion is not None:
            return self._with(placing.ROTATE_QUATERNION, quaternion)
        if matrix is not None:
            return self._with(placing.ROTATE_MATRIX, *_columns(matrix))
        if axis is None or angle is None:
            refuse(
                "a rotation needs an angle and an axis",
                "rotate(0.5, axis=(0, 1, 0))",
                author_place(),
            )
        return self._with(placing.ROTATE, axis=axis, angle=angle)

    def orient(self, source: Any, target: Any) -> Self:
        """Rotate by the smallest angle that takes direction ``source`` to ``target``."""
        return self._with(placing.ORIENT, source, target)

    def shear(self, xy: Any = 0.0, xz: Any = 0.0, yz: Any = 0.0) -> Self:
        """Shear: x moves by ``xy`` times y and ``xz`` times z, y by ``yz`` times z.

        Args:
            xy: Shift of x for each unit of y.
            xz: Shift of x for each unit of z.
            yz: Shift of y for each unit of z.
        """
        return self._with(placing.SHEAR, xy, xz, yz)

    def repeat_half(self, *spacing: Any) -> Self:
        """Repeat infinitely along +x, +y and +z."""
        return self._with(grid.REPEAT_HALF, *spacing)

    def repeat_ring(self, *spacing: Any, count: Sequence[int]) -> Self:
        """Repeat along the sides of a rectangle in the xz plane; ``count`` for x and for z."""
        try:
            count_x, count_z = count
        except (TypeError, ValueError):
            refuse(f"count is two whole numbers, not {count!r:.40}", "count=(5, 3)", author_place())
        return self._with(along.REPEAT_RING, *spacing, count_x=count_x, count_z=count_z)

    def array(
        self,
        positions: Any = None,
        *,
        start: Any = None,
        end: Any = None,
        count: int | None = None,
    ) -> Self:
        """Repeat at given positions, or ``count`` times evenly along a line.

        Args:
            positions: An (n, 3) array.
            start: Where the line begins.
            end: Where it ends.
            count: Number of copies on the line.

        Raises:
            SceneValueError: Neither positions alone nor start, end and count are given.
        """
        if positions is not None and start is None and end is None and count is None:
            return self._with(along.REPEAT_AT, positions)
        if positions is None and start is not None and end is not None and count is not None:
            return self._with(along.REPEAT_LINE, start=start, end=end, count=count)
        hint = "array(positions) or array(start=…, end=…, count=…)"
        refuse("an array takes positions, or a line and a count", hint, author_place())

    def elongate(self, *lengths: Any) -> Self:
        """Cut at the origin and pull apart by ``lengths`` along each axis."""
        return self._with(deform.ELONGATE, *lengths)

    def twist(self, rate: Any) -> Self:
        """Twist about the y axis by ``rate`` radians for each unit of height."""
        return self._with(deform.TWIST, rate)

    def bend(self, rate: Any) -> Self:
        """Bend in the xy plane by ``rate`` radians for each unit along x."""
        return self._with(deform.BEND, rate)

    def bend_linear(self, start: Any, end: Any, shift: Any, ease: str = "linear") -> Self:
        """Move gradually from ``start`` on, by ``shift`` at ``end``.

        Args:
            start: A point; before it nothing moves.
            end: A point; beyond it all moves by ``shift``.
            shift: A vector in scene units.
            ease: How the shift begins and ends, one of ``EASES``.
        """
        return self._with(deform.BEND_LINEAR, start, end, shift, ease=ease_number(ease))

    def bend_radial(self, inner: Any, outer: Any, rise: Any, ease: str = "linear") -> Self:
        """Raise gradually from radius ``inner`` about the y axis, by ``rise`` at ``outer``.

        Args:
            inner: Radius in scene units.
            outer: A larger radius.
            rise: Shift along y.
            ease: How the shift begins and ends, one of ``EASES``.
        """
        return self._with(deform.BEND_RADIAL, inner, outer, rise, ease=ease_number(ease))

    def taper(self, bottom: Any, top: Any, factor: Any) -> Self:
        """Scale x and z gradually with height.

        Args:
            bottom: Height up to which the shape keeps its size.
            top: Height from which it is scaled fully.
            factor: The scale there.
        """
        return self._with(deform.TAPER, bottom, top, factor)

    def wrap(self, radius: Any) -> Self:
        """Wrap the x axis around a cylinder about the y axis."""
        return self._with(folds.WRAP, radius)

    def attract(self, center: Any, radius: Any, strength: Any) -> Self:
        """Pull towards a point, within a radius of it.

        Args:
            center: The point.
            radius: Beyond it nothing moves.
            strength: How far the shape is pulled.
        """
        return self._with(deform.ATTRACT, center, radius, strength)

    def repel(self, center: Any, radius: Any, strength: Any) -> Self:
        """Push away from a point, within a radius of it; arguments as for ``attract``."""
        return self._with(deform.REPEL, center, radius, strength)

    def warp(self, amount: Any, frequency: Any = 1.0, seed: int = 0) -> Self:
        """Displace by noise: every point moves by up to about ``amount``.

        Args:
            amount: Largest shift, in scene units.
            frequency: Cells of the noise for each unit.
            seed: Selects one of many noises.
        """
        return self._with(folds.WARP, amount, frequency, seed)

    def transition_linear(
        self, other: BaseShape, start: Any, end: Any, ease: str = "linear"
    ) -> Self:
        """Change from this shape at ``start`` to another at ``end``.

        Args:
            other: The other shape.
            start: A point.
            end: A point.
            ease: How the change begins and ends, one of ``EASES``.
        """
        return self._joined(
            transitions.TRANSITION_LINEAR, other, start=start, end=end, ease=ease_number(ease)
        )

    def transition_radial(
        self, other: BaseShape, inner: Any, outer: Any, ease: str = "linear"
    ) -> Self:
        """Change from this shape within a radius about the y axis to another beyond a larger one.

        Args:
            other: The other shape.
            inner: Radius in scene units.
            outer: A larger radius.
            ease: How the change begins and ends, one of ``EASES``.
        """
        numbers = {"inner": inner, "outer": outer, "ease": ease_number(ease)}
        return self._joined(transitions.TRANSITION_RADIAL, other, **numbers)

    def clearance(self, other: BaseShape, gap: Any) -> Self:
        """Cut away all that is nearer than ``gap`` to another shape."""
        return self._joined(joins.CLEARANCE, other, gap=gap)

    def carve(self, other: BaseShape, depth: Any) -> Self:
        """Cut the other shape into this one's surface, ``depth`` deep."""
        return self._joined(joins.CARVE, other, depth=depth)

    def emboss(self, other: BaseShape, height: Any) -> Self:
        """Raise the other shape from this one's surface, ``height`` high."""
        return self._joined(joins.EMBOSS, other, height=height)

    def morph(self, other: BaseShape, t: Any) -> Self:
        """Interpolate between this shape at t = 0 and another at t = 1."""
        return self._joined(joins.MORPH, other, t=t)

    def displace(self, field: Any, height: Any = 1.0) -> Self:
        """Move the surface out by the value of a field, times ``height``.

        Args:
            field: A shape, or a ``@func`` of a point (its slope is then taken for 1).
            height: A factor.
        """
        other = field if isinstance(field, BaseShape) else self.from_function(field)
        return self._joined(joins.DISPLACE, other, height=height)

    def engrave(self, other: BaseShape, depth: Any) -> Self:
        """Cut a groove of a depth where the other shape's surface crosses this one."""
        return self._joined(blends.ENGRAVE, other, k=depth)

    def pipe(self, other: BaseShape, radius: Any) -> Self:
        """Keep only a round pipe along the curve where the two surfaces cross."""
        return self._joined(blends.PIPE, other, k=radius)

    def groove(self, other: BaseShape, depth: Any, width: Any) -> Self:
        """Cut a groove of rectangular profile where the surfaces cross.

        Args:
            other: The shape whose surface the groove follows.
            depth: Depth of the groove, in scene units.
            width: Half of its width, in scene units.
        """
        return self._joined(blends.GROOVE, other, depth=depth, width=width)

    def tongue(self, other: BaseShape, depth: Any, width: Any) -> Self:
        """Add a ridge of rectangular profile where the surfaces cross.

        Args:
            other: The shape whose surface the ridge follows.
            depth: Height of the ridge, in scene units.
            width: Half of its width, in scene units.
        """
        return self._joined(blends.TONGUE, other, depth=depth, width=width)

    def _flat(self, operator: Operator, *args: Any, **kwargs: Any) -> Shape2D:
        made: Shape2D = self._under(operator, args, kwargs, author_place())
        return made

    def slice(self, origin: Any = (0.0, 0.0, 0.0), normal: Any = (0.0, 0.0, 1.0)) -> Shape2D:
        """Cut by a plane: the flat shape in it.

        Args:
            origin: A point of the plane; the flat shape's origin.
            normal: The plane's, of length 1.
        """
        return self._flat(lift.SLICE, origin, normal)

    def project(self, count: int = 32) -> Shape2D:
        """Project onto the xy plane, by evaluating ``count`` depths."""
        return self._flat(lift.PROJECT, count=count)


class Shape2D(Placed):
    """A flat shape: a signed distance in the plane."""

    flat = True
    point_type = VEC2

    def rotate(self, angle: Any) -> Self:
        """Rotate about the origin, counterclockwise; radians."""
        warn_of_degrees(author_place(), angle)
        return self._with(flat_placing.ROTATE_FLAT, angle)

    def _solid(self, operator: Operator, *args: Any, **kwargs: Any) -> Shape:
        made: Shape = self._under(operator, args, kwargs, author_place())
        return made

    def extrude(self, height: Any = 1.0, *, rounding: Any = None, chamfer: Any = None) -> Shape:
        """Extrude along z to a solid centred at z = 0.

        Args:
            height: From end to end.
            rounding: Radius of the edges.
            chamfer: Size of the edges' bevels.
        """
        if rounding is not None:
            return self._solid(extrude.EXTRUDE_ROUNDED, height, rounding)
        if chamfer is not None:
            return self._solid(extrude.EXTRUDE_CHAMFERED, height, chamfer)
        return self._solid(extrude.EXTRUDE, height)

    def revolve(self, offset: Any = 0.0, angle: Any = None) -> Shape:
        """Revolve about the y axis; x > 0 is outwards.

        Args:
            offset: Distance by which the outline is moved outwards first.
            angle: Angle of the revolution in radians; None for a full turn.
        """
        if angle is None:
            return self._solid(lift.REVOLVE, offset)
        return self._solid(lift.REVOLVE_PARTLY, offset, angle)

    def loft(self, other: BaseShape, height: Any = 1.0, ease: str = "linear") -> Shape:
        """Connect this outline at z = -height / 2 to another at z = height / 2.

        Args:
            other: The other outline.
            height: Length along z.
            ease: How the change begins and ends, one of ``EASES``.
        """
        numbers = {"height": height, "ease": ease_number(ease)}
        return cast("Shape", self._joined(extrude.LOFT, other, **numbers))

    def twist_extrude(self, height: Any, angle: Any) -> Shape:
        """Extrude along z, rotated by ``angle`` from end to end."""
        return self._solid(extrude.EXTRUDE_TWISTED, height, angle)

    def taper_extrude(self, height: Any, top: Any) -> Shape:
        """Extrude along z, scaled by ``top`` at the upper end."""
        return self._solid(extrude.EXTRUDE_TAPERED, height, top)

    def sweep(self, points: Any, up: Any = (0.0, 1.0, 0.0)) -> Shape:
        """Sweep along a polyline through (n, 3) points."""
        return self._solid(path.SWEEP, points, up)

    def sweep_bezier(
        self, start: Any, control: Any, end: Any, up: Any = (0.0, 1.0, 0.0), pieces: int = 16
    ) -> Shape:
        """Sweep along a quadratic Bézier curve.

        Args:
            start: First point.
            control: Control point.
            end: Last point.
            up: Direction of the outline's y axis.
            pieces: Number of straight pieces that approximate the curve.
        """
        return self._solid(
            path.SWEEP_BEZIER, start=start, control=control, end=end, up=up, pieces=pieces
        )

    def wrap_cylinder(self, radius: Any, height: Any) -> Shape:
        """Wrap around a cylinder about the y axis, to a solid."""
        return self._solid(lift.WRAP_CYLINDER, radius, height)

    def relief(self, *numbers: Any) -> Shape:
        """Raise the ground to the height that this flat field gives at each point (x, z)."""
        return self._solid(heightfield.RELIEF, *numbers)


def ease_number(name: str) -> int:
    """The number of an easing by its name.

    Raises:
        SceneValueError: There is no such easing.
    """
    if name not in EASES:
        refuse(f"there is no easing {name!r:.40}", ", ".join(EASES), author_place())
    return EASES.index(name)


def _columns(matrix: Any) -> tuple[Any, ...]:
    try:
        rows = [tuple(row) for row in matrix]
        return tuple(zip(*rows, strict=True))
    except (TypeError, ValueError):
        refuse("a rotation's matrix has three rows of three numbers", None, author_place())


PLAIN.update({False: Shape, True: Shape2D})
