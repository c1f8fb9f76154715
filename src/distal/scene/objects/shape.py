"""Shapes and their methods: placing, repeating, deforming, thickening.

Input: the author's numbers. Output: new shapes; none changes. Every method applies an operator of
the field library.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final, Self, cast

from distal.fields import library  # first: shapes and operators are declared in its order
from distal.fields.combine import blends, joins, transitions
from distal.fields.deform import folds, offsets
from distal.fields.deform import solid as deform
from distal.fields.ease import EASES
from distal.fields.guarantees import Operator
from distal.fields.lift import extrude, path
from distal.fields.lift import round as lift
from distal.fields.place import flat as flat_placing
from distal.fields.place import mirrors
from distal.fields.place import solid as placing
from distal.fields.repeat import along, grid, polar
from distal.fields.solids import heightfield
from distal.frontend.problems import did_you_mean
from distal.ir.types import VEC2, VEC3
from distal.scene.objects.field import PLAIN, Field
from distal.scene.objects.in_plane import IN_PLANE
from distal.scene.objects.turns import warn_of_degrees
from distal.scene.tree.conversion import is_scalar
from distal.scene.tree.errors import refuse
from distal.scene.tree.source_places import author_place

_ROTATIONS: Final[Mapping[str, Operator]] = {
    "x": placing.ROTATE_X,
    "y": placing.ROTATE_Y,
    "z": placing.ROTATE_Z,
}
_SHELLS: Final[Mapping[str, Operator]] = {
    "inner": offsets.SHELL_INNER,
    "centre": offsets.SHELL_CENTRE,
    "outer": offsets.SHELL_OUTER,
}


class _Placed(Field):
    """What solid and flat shapes can do alike."""

    def _with(self, operator: Operator, *args: Any, **kwargs: Any) -> Self:
        """This shape under an operator, or under its counterpart in the plane."""
        if self.flat:
            operator = IN_PLANE.get(operator, operator)
        made: Self = self._under(operator, args, kwargs, author_place())
        return made

    def _joined(self, operator: Operator, other: Any, **numbers: Any) -> Self:
        place = author_place()
        if not isinstance(other, Field) or other.flat != self.flat:
            kind = "flat" if self.flat else "solid"
            refuse(f"'{operator.name}' takes another {kind} shape, not {other!r:.60}", None, place)
        made: Self = self._under(operator, (), numbers, place, others=(other,))
        return made

    def apply(self, operator: str, *args: Any, others: Sequence[Field] = (), **kwargs: Any) -> Any:
        """The shape under an operator of the library by its name, as the catalogue lists it.

        What it gives lies in space where the operator's own point does.
        """
        place = author_place()
        known = library.OPERATORS
        if operator not in known:
            refuse(f"there is no operator '{operator}'", did_you_mean(operator, known), place)
        return self._under(known[operator], args, kwargs, place, others=tuple(others))

    def translate(self, *offset: Any, **parts: Any) -> Self:
        """The shape moved: ``translate(1, 0, 0)``, ``translate((1, 0, 0))``, ``translate(x=1)``."""
        return self._with(placing.TRANSLATE, *offset, **parts)

    def scale(self, *factors: Any, **parts: Any) -> Self:
        """The shape larger by a factor, or by one for each axis (no longer exact then)."""
        if len(factors) == 1 and not parts and is_scalar(factors[0]):
            return self._with(placing.SCALE, *factors)
        return self._with(placing.STRETCH, *factors, **parts)

    def mirror(self, normal: Any, offset: Any = 0.0) -> Self:
        """The half that ``normal`` points to, and its image on the other side of the plane.

        Args:
            normal: Length 1.
            offset: How far the plane lies along the normal from the origin.
        """
        return self._with(mirrors.MIRROR, normal, offset)

    def symmetry(self, axes: str) -> Self:
        """The positive side of the axes named, mirrored to the negative one: ``symmetry("xz")``."""
        known = "xy" if self.flat else "xyz"
        if not isinstance(axes, str) or not axes or not set(axes) <= set(known):
            refuse(f"symmetry takes letters of '{known}', not {axes!r}", None, author_place())
        return self._with(mirrors.SYMMETRY, **{axis: axis in axes for axis in known})

    def kaleidoscope(self, count: int) -> Self:
        """The shape's wedge repeated ``count`` times about the y axis, every other one mirrored."""
        return self._with(mirrors.KALEIDOSCOPE, count)

    def repeat(
        self,
        *spacing: Any,
        count: Sequence[int] | None = None,
        neighbours: int = 0,
        mirrored: bool = False,
    ) -> Self:
        """The shape again and again, in cells of a grid; its middle cell is where the shape is.

        Args:
            spacing: From cell to cell, for each axis; 0 for an axis along which it is not repeated.
                One number is meant for all three.
            count: How many along each axis; without it there is no end. Cells are then counted from
                0, at the lower corner.
            neighbours: How many cells around are asked too: 0 where the shape keeps within its
                cell, 1 or 2 where it reaches into others.
            mirrored: Whether every other cell is mirrored, so that neighbours meet.
        """
        if mirrored:
            return self._with(grid.REPEAT_MIRRORED, *spacing)
        if count is None:
            if neighbours:
                return self._with(grid.REPEAT_NEIGHBOURS, *spacing, neighbours=neighbours)
            return self._with(grid.REPEAT, *spacing)
        axes = "xy" if self.flat else "xyz"
        try:
            counts = {f"count_{axis}": n for axis, n in zip(axes, count, strict=True)}
        except (TypeError, ValueError):
            refuse(
                f"count is {len(axes)} whole numbers, not {count!r:.40}",
                "count=(3, 2)" if self.flat else "count=(3, 1, 3)",
                author_place(),
            )
        if neighbours:
            counts["neighbours"] = neighbours
            return self._with(grid.REPEAT_LIMITED_NEIGHBOURS, *spacing, **counts)
        return self._with(grid.REPEAT_LIMITED, *spacing, **counts)

    def repeat_polar(self, count: int, *, neighbours: int = 0) -> Self:
        """The shape ``count`` times about the y axis (flat: the origin), itself towards x."""
        if neighbours:
            return self._with(polar.REPEAT_POLAR_NEIGHBOURS, count=count, neighbours=neighbours)
        return self._with(polar.REPEAT_POLAR, count=count)

    def split(self, normal: Any, offset: Any = 0.0) -> tuple[Self, Self]:
        """Both parts that a plane cuts it into: what lies below, and what lies above."""
        below = self._with(offsets.SPLIT_BELOW, normal, offset)
        return below, self._with(offsets.SPLIT_ABOVE, normal, offset)

    def round(self, radius: Any) -> Self:
        """The shape grown by ``radius``, its edges round."""
        return self._with(offsets.ROUND, radius)

    def offset(self, distance: Any) -> Self:
        """The shape grown by a distance, or shrunk by a negative one."""
        return self._with(offsets.OFFSET, distance)

    def shell(self, thickness: Any, where: str = "centre") -> Self:
        """The shape hollow; its wall lies "inner", "centre" or "outer" of the old surface."""
        if where not in _SHELLS:
            refuse(f"a shell lies inner, centre or outer, not {where!r}", None, author_place())
        return self._with(_SHELLS[where], thickness)


class Shape(_Placed):
    """A solid: a signed distance in space. Shapes never change; methods give new ones."""

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
        """The shape turned about the origin; angles in radians.

        Args:
            angle: About ``axis``.
            axis: Of length 1.
            x: About the fixed x axis, first.
            y: About the fixed y axis, then.
            z: About the fixed z axis, last.
            quaternion: (x, y, z, w), of length 1.
            matrix: Three rows, orthonormal.
        """
        euler = {name: value for name, value in (("x", x), ("y", y), ("z", z)) if value is not None}
        warn_of_degrees(author_place(), angle, *euler.values())
        ways = [angle is not None or axis is not None, bool(euler)]
        ways += [quaternion is not None, matrix is not None]
        if sum(ways) != 1:
            hint = "rotate(y=0.5), rotate(0.5, axis=(0, 1, 0)), quaternion=… or matrix=…"
            refuse("a rotation is told in one way", hint, author_place())
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
        """The shape turned the shortest way, so that ``source`` points where ``target`` does."""
        return self._with(placing.ORIENT, source, target)

    def shear(self, xy: Any = 0.0, xz: Any = 0.0, yz: Any = 0.0) -> Self:
        """The shape leaning: x moved by ``xy`` times y and ``xz`` times z, y by ``yz`` times z."""
        return self._with(placing.SHEAR, xy, xz, yz)

    def repeat_half(self, *spacing: Any) -> Self:
        """The shape again and again towards the positive side of each axis only."""
        return self._with(grid.REPEAT_HALF, *spacing)

    def repeat_ring(self, *spacing: Any, count: Sequence[int]) -> Self:
        """The shape along the rim of a rectangle in the xz plane; ``count`` for x and for z."""
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
        """The shape at given places, or ``count`` times evenly along a line.

        Args:
            positions: An (n, 3) array.
            start: Where the line begins.
            end: Where it ends.
            count: How many on the line.
        """
        if positions is not None and start is None and end is None and count is None:
            return self._with(along.REPEAT_AT, positions)
        if positions is None and start is not None and end is not None and count is not None:
            return self._with(along.REPEAT_LINE, start=start, end=end, count=count)
        hint = "array(positions) or array(start=…, end=…, count=…)"
        refuse("an array is told by positions, or by a line and a count", hint, author_place())

    def elongate(self, *lengths: Any) -> Self:
        """The shape cut at the origin and pulled apart, ``lengths`` in all along each axis."""
        return self._with(deform.ELONGATE, *lengths)

    def twist(self, rate: Any) -> Self:
        """The shape turned about the y axis ever more: ``rate`` radians for each unit of height."""
        return self._with(deform.TWIST, rate)

    def bend(self, rate: Any) -> Self:
        """The shape bent in the xy plane: ``rate`` radians for each unit along x."""
        return self._with(deform.BEND, rate)

    def bend_linear(self, start: Any, end: Any, shift: Any, ease: str = "linear") -> Self:
        """The shape moved by ``shift`` more and more on the way from ``start`` to ``end``."""
        return self._with(deform.BEND_LINEAR, start, end, shift, ease=ease_number(ease))

    def bend_radial(self, inner: Any, outer: Any, rise: Any, ease: str = "linear") -> Self:
        """The shape lifted by ``rise`` more and more from a radius to another about the y axis."""
        return self._with(deform.BEND_RADIAL, inner, outer, rise, ease=ease_number(ease))

    def taper(self, bottom: Any, top: Any, factor: Any) -> Self:
        """The shape narrower upwards: full at height ``bottom``, times ``factor`` at ``top``."""
        return self._with(deform.TAPER, bottom, top, factor)

    def wrap(self, radius: Any) -> Self:
        """The shape's x axis wrapped around a cylinder about the y axis."""
        return self._with(folds.WRAP, radius)

    def attract(self, center: Any, radius: Any, strength: Any) -> Self:
        """The shape pulled towards a place, within a radius of it."""
        return self._with(deform.ATTRACT, center, radius, strength)

    def repel(self, center: Any, radius: Any, strength: Any) -> Self:
        """The shape pushed away from a place, within a radius of it."""
        return self._with(deform.REPEL, center, radius, strength)

    def warp(self, amount: Any, frequency: Any = 1.0, seed: int = 0) -> Self:
        """The shape shaken by noise: every place moved by up to about ``amount``."""
        return self._with(folds.WARP, amount, frequency, seed)

    def transition_linear(self, other: Field, start: Any, end: Any, ease: str = "linear") -> Self:
        """This shape at ``start``, another at ``end``, and between them in between."""
        return self._joined(
            transitions.TRANSITION_LINEAR, other, start=start, end=end, ease=ease_number(ease)
        )

    def transition_radial(self, other: Field, inner: Any, outer: Any, ease: str = "linear") -> Self:
        """This shape within a radius about the y axis, another beyond a larger one."""
        numbers = {"inner": inner, "outer": outer, "ease": ease_number(ease)}
        return self._joined(transitions.TRANSITION_RADIAL, other, **numbers)

    def clearance(self, other: Field, gap: Any) -> Self:
        """The shape with room for another: cut wherever that is nearer than ``gap``."""
        return self._joined(joins.CLEARANCE, other, gap=gap)

    def carve(self, other: Field, depth: Any) -> Self:
        """The other shape sunk into this one's surface, ``depth`` deep."""
        return self._joined(joins.CARVE, other, depth=depth)

    def emboss(self, other: Field, height: Any) -> Self:
        """The other shape raised from this one's surface, ``height`` high."""
        return self._joined(joins.EMBOSS, other, height=height)

    def morph(self, other: Field, t: Any) -> Self:
        """Between two shapes: this one at t = 0, the other at 1."""
        return self._joined(joins.MORPH, other, t=t)

    def displace(self, field: Any, height: Any = 1.0) -> Self:
        """The surface moved out by what a field gives, times ``height``.

        Args:
            field: A shape, or a ``@func`` of a point (its slope is then taken for 1).
            height: A factor.
        """
        other = field if isinstance(field, Field) else self.from_function(field)
        return self._joined(joins.DISPLACE, other, height=height)

    def engrave(self, other: Field, depth: Any) -> Self:
        """A groove of a depth where the other shape's surface meets this one."""
        return self._joined(blends.ENGRAVE, other, k=depth)

    def pipe(self, other: Field, radius: Any) -> Self:
        """A round pipe where the two surfaces meet, and nothing else."""
        return self._joined(blends.PIPE, other, k=radius)

    def groove(self, other: Field, depth: Any, width: Any) -> Self:
        """A groove of a rectangular profile where the surfaces meet."""
        return self._joined(blends.GROOVE, other, depth=depth, width=width)

    def tongue(self, other: Field, depth: Any, width: Any) -> Self:
        """A ridge of a rectangular profile where the surfaces meet."""
        return self._joined(blends.TONGUE, other, depth=depth, width=width)

    def _flat(self, operator: Operator, *args: Any, **kwargs: Any) -> Shape2D:
        made: Shape2D = self._under(operator, args, kwargs, author_place())
        return made

    def slice(self, origin: Any = (0.0, 0.0, 0.0), normal: Any = (0.0, 0.0, 1.0)) -> Shape2D:
        """The flat shape that a plane cuts out.

        Args:
            origin: A place on the plane; the flat shape's origin.
            normal: The plane's, of length 1.
        """
        return self._flat(lift.SLICE, origin, normal)

    def project(self, count: int = 32) -> Shape2D:
        """The shape's shadow on the xy plane, looked for at ``count`` depths."""
        return self._flat(lift.PROJECT, count=count)


class Shape2D(_Placed):
    """A flat shape: a signed distance in the plane."""

    flat = True
    point_type = VEC2

    def rotate(self, angle: Any) -> Self:
        """The shape turned about the origin, counter-clockwise; radians."""
        warn_of_degrees(author_place(), angle)
        return self._with(flat_placing.ROTATE_FLAT, angle)

    def _solid(self, operator: Operator, *args: Any, **kwargs: Any) -> Shape:
        made: Shape = self._under(operator, args, kwargs, author_place())
        return made

    def extrude(self, height: Any = 1.0, *, rounding: Any = None, chamfer: Any = None) -> Shape:
        """The solid of this outline along z, ``height`` in all, its middle at 0.

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
        """The solid of this outline turned about the y axis; x > 0 is outwards.

        Args:
            offset: How far the outline is moved outwards first.
            angle: How far it is turned; all around without it.
        """
        if angle is None:
            return self._solid(lift.REVOLVE, offset)
        return self._solid(lift.REVOLVE_PARTLY, offset, angle)

    def loft(self, other: Field, height: Any = 1.0, ease: str = "linear") -> Shape:
        """The solid that goes from this outline at -height/2 along z to another at height/2."""
        numbers = {"height": height, "ease": ease_number(ease)}
        return cast("Shape", self._joined(extrude.LOFT, other, **numbers))

    def twist_extrude(self, height: Any, angle: Any) -> Shape:
        """The solid of this outline along z, turned by ``angle`` from end to end."""
        return self._solid(extrude.EXTRUDE_TWISTED, height, angle)

    def taper_extrude(self, height: Any, top: Any) -> Shape:
        """The solid of this outline along z, at the top end ``top`` times as large."""
        return self._solid(extrude.EXTRUDE_TAPERED, height, top)

    def sweep(self, points: Any, up: Any = (0.0, 1.0, 0.0)) -> Shape:
        """The solid of this outline along a polyline through (n, 3) points."""
        return self._solid(path.SWEEP, points, up)

    def sweep_bezier(
        self, start: Any, control: Any, end: Any, up: Any = (0.0, 1.0, 0.0), pieces: int = 16
    ) -> Shape:
        """The solid of this outline along a quadratic curve."""
        return self._solid(
            path.SWEEP_BEZIER, start=start, control=control, end=end, up=up, pieces=pieces
        )

    def wrap_cylinder(self, radius: Any, height: Any) -> Shape:
        """The solid of this outline wrapped around a cylinder about the y axis."""
        return self._solid(lift.WRAP_CYLINDER, radius, height)

    def relief(self, *numbers: Any) -> Shape:
        """The ground raised to the height that this flat field gives at each place (x, z)."""
        return self._solid(heightfield.RELIEF, *numbers)


def ease_number(name: str) -> int:
    """The number of an easing by its name."""
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
