"""Solid shapes, flat shapes, and the methods that only one of these classes has.

Input: the author's numbers. Output: new shapes; shapes never change. Every method applies an
operator of the field library.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Self, cast

from distal.fields.combine import blends, joins, transitions
from distal.fields.deform import folds, wrapping
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
from distal.lang.functions import Func
from distal.lang.render_options import Cancel, Progress, RenderOptions
from distal.lang.source_places import author_place
from distal.scene.objects.copies import CopyColumns, copied
from distal.scene.objects.field import BaseShape
from distal.scene.objects.filling import filled
from distal.scene.objects.from_data import FromData
from distal.scene.objects.heights import seen_heights
from distal.scene.objects.meshable import Meshable
from distal.scene.objects.movable import MovableSolid
from distal.scene.objects.outlined import Outlined
from distal.scene.objects.path_corners import path_corners
from distal.scene.objects.shape_values import PLAIN
from distal.scene.objects.shaped_edges import PLAN
from distal.scene.objects.turns import warn_of_degrees
from distal.scene.tree.errors import refuse
from distal.scene.tree.value import CallRecord

if TYPE_CHECKING:
    from distal.images.height_map import HeightMap
    from distal.images.picture import Picture
    from distal.scene.objects.argument_types import (
        Amount,
        Color,
        Columns,
        Corners,
        Number,
        ParameterValues,
        Points,
        Vector,
    )


class Shape(MovableSolid, Meshable, FromData):
    """A solid: a signed distance function of a point in space.

    Shapes never change; methods return new shapes.
    """

    flat = False
    point_type = VEC3

    def shear(self, xy: Number = 0.0, xz: Number = 0.0, yz: Number = 0.0) -> Self:
        """Shear: move x by ``xy`` times y plus ``xz`` times z, and y by ``yz`` times z.

        Args:
            xy: Shift of x for each unit of y.
            xz: Shift of x for each unit of z.
            yz: Shift of y for each unit of z.
        """
        return self._with(placing.SHEAR, xy, xz, yz)

    def repeat_half(self, *spacing: Vector | Number) -> Self:
        """Repeat infinitely along +x, +y and +z; ``spacing`` as for ``repeat``."""
        return self._with(grid.REPEAT_HALF, *spacing)

    def repeat_ring(self, *spacing: Vector | Number, count: Sequence[int]) -> Self:
        """Repeat along the sides of a rectangle in the xz plane.

        ``spacing`` is the distance from copy to copy along x and z, ``count`` the number of copies
        along each.
        """
        try:
            count_x, count_z = count
        except (TypeError, ValueError):
            refuse(f"count is two whole numbers, not {count!r:.40}", "count=(5, 3)", author_place())
        return self._with(along.REPEAT_RING, *spacing, count_x=count_x, count_z=count_z)

    def array(
        self,
        positions: Points | None = None,
        *,
        start: Vector | None = None,
        end: Vector | None = None,
        count: int | None = None,
        colors: Columns | None = None,
        scale: Columns | Number | None = None,
        rotation: Columns | Number | None = None,
        align: Columns | None = None,
        axis: Vector = (0.0, 1.0, 0.0),
    ) -> Self:
        """Repeat at given positions, or ``count`` times evenly along a line.

        With positions alone, or on a line, the index of a copy is its ``cell``. With colors, scale,
        rotation or directions, the result is the union of the copies; ``copies`` does this for
        several shapes.

        Args:
            positions: Positions of the copies, an (n, 3) array.
            start: Position of the first copy.
            end: Position of the last copy.
            count: Number of copies on the line.
            colors: Color of each copy: linear (n, 3), or a list of "#rrggbb" and names. The other
                numbers of the material are kept.
            scale: Size of each copy: one factor for all, (n,), or (n, 3) factors along the axes.
            rotation: Rotation of each copy: one angle about y for all, (n,) angles about y, (n, 3)
                angles about x, y, z as for ``rotate``, or (n, 4) unit quaternions.
            align: Direction to which ``axis`` is turned after that, (n, 3), such as normals.
            axis: The direction of the shape that ``align`` turns.

        Raises:
            SceneTypeError: A row has the wrong type.
            SceneValueError: The arguments are neither ``positions`` nor start, end and count;
                columns have different lengths; or a number is beyond its limit.
        """
        on_line = start is not None and end is not None and count is not None
        given = (colors, scale, rotation, align)
        columns = any(column is not None for column in given)
        if positions is not None and start is None and end is None and count is None:
            if not columns:
                return self._with(along.REPEAT_AT, positions)
            made: Self = copied(
                "array", (self,), CopyColumns(positions, None, *given, axis), author_place()
            )
            return made
        if positions is None and on_line and not columns:
            return self._with(along.REPEAT_LINE, start=start, end=end, count=count)
        if positions is None and on_line:
            hint = "points, _ = points_along([start, end], count), then array(points, …)"
            refuse("colors, scale, rotation and align need positions", hint, author_place())
        hint = "array(positions) or array(start=…, end=…, count=…)"
        refuse("an array takes positions, or a line and a count", hint, author_place())

    def elongate(self, *lengths: Vector | Number) -> Self:
        """Cut in the middle and move the halves apart by ``lengths`` along each axis."""
        return self._with(deform.ELONGATE, *lengths)

    def twist(self, rate: Number) -> Self:
        """Twist about the y axis by ``rate`` radians for each unit of height."""
        return self._with(deform.TWIST, rate)

    def bend(self, rate: Number) -> Self:
        """Bend in the xy plane by ``rate`` radians for each unit along x."""
        return self._with(deform.BEND, rate)

    def bend_linear(self, start: Vector, end: Vector, shift: Vector, ease: str = "linear") -> Self:
        """Move the part beyond ``end`` by ``shift``, with a gradual transition from ``start``.

        Args:
            start: A point; the part before it does not move.
            end: A point; the part beyond it moves by the whole ``shift``.
            shift: Displacement vector in scene units.
            ease: How the shift begins and ends, one of ``EASES``.
        """
        return self._with(deform.BEND_LINEAR, start, end, shift, ease=ease_number(ease))

    def bend_radial(self, inner: Number, outer: Number, rise: Number, ease: str = "linear") -> Self:
        """Raise the part beyond radius ``outer``, with a gradual transition from ``inner``.

        Both radii are distances from the y axis.

        Args:
            inner: Radius within which nothing moves.
            outer: Radius beyond which everything moves by ``rise``, larger than ``inner``.
            rise: Displacement along y.
            ease: How the shift begins and ends, one of ``EASES``.
        """
        return self._with(deform.BEND_RADIAL, inner, outer, rise, ease=ease_number(ease))

    def taper(self, bottom: Number, top: Number, factor: Number) -> Self:
        """Scale x and z gradually with height.

        Args:
            bottom: Height up to which the shape keeps its size.
            top: Height from which the shape is scaled by ``factor``.
            factor: The scale at ``top`` and above.
        """
        return self._with(deform.TAPER, bottom, top, factor)

    def wrap(self, radius: Number) -> Self:
        """Wrap the x axis around a cylinder about the y axis; +z points outwards."""
        return self._with(folds.WRAP, radius)

    def attract(self, center: Vector, radius: Number, strength: Number) -> Self:
        """Pull the part within a radius of a point towards this point.

        Args:
            center: The point.
            radius: Distance from the point beyond which nothing moves.
            strength: Strength of the pull: near the point, the displacement as a fraction of the
                distance.
        """
        return self._with(deform.ATTRACT, center, radius, strength)

    def repel(self, center: Vector, radius: Number, strength: Number) -> Self:
        """Push the part within a radius of a point away from this point.

        Arguments as for ``attract``.
        """
        return self._with(deform.REPEL, center, radius, strength)

    def warp(self, amount: Number, frequency: Number = 1.0, seed: int = 0) -> Self:
        """Displace every point by noise, by up to about ``amount`` along each axis.

        Args:
            amount: Largest displacement, in scene units.
            frequency: Cells of the noise per scene unit.
            seed: Selects one of many noise functions.
        """
        return self._with(folds.WARP, amount, frequency, seed)

    def transition_linear(
        self, other: BaseShape, start: Vector, end: Vector, ease: str = "linear"
    ) -> Self:
        """Change gradually from this shape to another along the line from ``start`` to ``end``.

        Of infinite shapes, what is farther from a surface than ``end`` from ``start`` changes
        like what is that far: surfaces farther apart are joined by a steep wall.

        Args:
            other: The other shape.
            start: A point; before it, only this shape is seen.
            end: A point; beyond it, only the other shape is seen.
            ease: How the change begins and ends, one of ``EASES``.
        """
        return self._joined(
            transitions.TRANSITION_LINEAR, other, start=start, end=end, ease=ease_number(ease)
        )

    def transition_radial(
        self, other: BaseShape, inner: Number, outer: Number, ease: str = "linear"
    ) -> Self:
        """Change gradually from this shape near the y axis to another farther out.

        Of infinite shapes, what is farther from a surface than the ring is wide changes like what
        is that far.

        Args:
            other: The other shape.
            inner: Radius about the y axis within which only this shape is seen.
            outer: Radius beyond which only the other shape is seen.
            ease: How the change begins and ends, one of ``EASES``.
        """
        numbers = {"inner": inner, "outer": outer, "ease": ease_number(ease)}
        return self._joined(transitions.TRANSITION_RADIAL, other, **numbers)

    def clearance(self, other: BaseShape, gap: Number) -> Self:
        """Cut away everything that is nearer than ``gap`` to the other shape."""
        return self._joined(joins.CLEARANCE, other, gap=gap)

    def carve(self, other: BaseShape, depth: Number) -> Self:
        """Cut the form of the other shape into the surface of this one, ``depth`` deep."""
        return self._joined(joins.CARVE, other, depth=depth)

    def emboss(self, other: BaseShape, height: Number) -> Self:
        """Raise the form of the other shape on the surface of this one, ``height`` high."""
        return self._joined(joins.EMBOSS, other, height=height)

    def morph(self, other: BaseShape, t: Number) -> Self:
        """Interpolate between this shape (t = 0) and another (t = 1)."""
        return self._joined(joins.MORPH, other, t=t)

    def displace(self, field: BaseShape | Func, height: Number = 1.0) -> Self:
        """Move the surface outwards by the value of a field times ``height``.

        Args:
            field: A shape, or a ``@func`` of a point, whose slope is assumed to be at most 1.
            height: Factor on the field's value, which is limited to -1 to 1.
        """
        other = field if isinstance(field, BaseShape) else self.from_function(field)
        return self._joined(joins.DISPLACE, other, height=height)

    def engrave(self, other: BaseShape, depth: Number) -> Self:
        """Cut a V-shaped groove, ``depth`` deep, where the other shape's surface crosses this."""
        return self._joined(blends.ENGRAVE, other, depth=depth)

    def pipe(self, other: BaseShape, radius: Number) -> Self:
        """Keep only a pipe of this radius along the curve where the two surfaces cross."""
        return self._joined(blends.PIPE, other, radius=radius)

    def groove(self, other: BaseShape, depth: Number, width: Number) -> Self:
        """Cut a groove with a rectangular profile where the surfaces cross.

        Args:
            other: The shape whose surface the groove follows.
            depth: Depth of the groove, in scene units.
            width: Half of its width, in scene units.
        """
        return self._joined(blends.GROOVE, other, depth=depth, width=width)

    def tongue(self, other: BaseShape, depth: Number, width: Number) -> Self:
        """Add a ridge with a rectangular profile where the surfaces cross.

        Args:
            other: The shape whose surface the ridge follows.
            depth: Height of the ridge, in scene units.
            width: Half of its width, in scene units.
        """
        return self._joined(blends.TONGUE, other, depth=depth, width=width)

    def _flat(self, operator: Operator, *args: Any, **kwargs: Any) -> Shape2D:
        made: Shape2D = self._under(operator, args, kwargs, author_place())
        return made

    def slice(self, origin: Vector = (0.0, 0.0, 0.0), normal: Vector = (0.0, 0.0, 1.0)) -> Shape2D:
        """Return the cross-section in a plane, as a flat shape.

        Args:
            origin: A point of the plane; it becomes the flat shape's origin.
            normal: Normal of the plane, of length 1.
        """
        return self._flat(lift.SLICE, origin, normal)

    def project(self, count: int = 32) -> Shape2D:
        """Project onto the xy plane: the union of ``count`` cross-sections along z."""
        return self._flat(lift.PROJECT, count=count)

    def heights(
        self,
        size: tuple[int, int] = (640, 480),
        time: float = 0.0,
        params: ParameterValues | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
        *,
        side: str = "+z",
        box: Corners | None = None,
    ) -> HeightMap:
        """Return the heights and normals of the shape, seen along an axis without perspective.

        Heights are coordinates of the surface along the axis ``side``, in scene units, larger
        toward the viewer; NaN where there is no surface. ``picture()`` of the result shows the
        normals. Samples along a ray are as far apart as pixels (at most 4096 of them); the surface
        is where the first of them is inside, corrected by the slope there. A part that is thinner
        may be missed. Nothing is compiled, unless the shape's function has loops of varying length,
        textures or noise; always on the CPU.

        Args:
            size: Width and height in pixels.
            time: Time in seconds; ``frame.time`` of an ``@image``.
            params: Values of parameters by name; the others have their defaults.
            threads: Number of CPU threads; None uses all that the process may use.
            progress: Called with the finished share, from 0 to 1.
            cancel: An event, or a function without arguments, that ends the work early.
            side: The side that the shape is seen from: "+x", "-x", "+y", "-y", "+z" or "-z". Up is
                +y; seen from "+y" it is -z, from "-y" +z.
            box: Corners (low, high) of the part of space to show, which is centered; None: the box
                of the shape with a margin, or from -1 to 1 if it is infinite.

        Raises:
            CompileError: The shape's scene code has mistakes.
            TypeError: A value has the wrong type.
            ValueError: A value is out of range, or there is no such parameter.
        """
        options = RenderOptions(
            size=size,
            time=time,
            params=params or {},
            threads=threads,
            progress=progress,
            cancel=cancel,
        )
        return seen_heights(self, options, side, box)


class Shape2D(Outlined):
    """A flat shape: a signed distance function of a point in the plane."""

    flat = True
    point_type = VEC2
    signature = (("p", VEC2),)

    def rotate(self, angle: Number) -> Self:
        """Rotate counterclockwise about the origin by an angle in radians."""
        warn_of_degrees(author_place(), angle)
        return self._with(flat_placing.ROTATE_FLAT, angle)

    def _solid(self, operator: Operator, *args: Any, **kwargs: Any) -> Shape:
        made: Shape = self._under(operator, args, kwargs, author_place())
        return made

    def fill(
        self,
        size: tuple[int, int] = (640, 480),
        time: float = 0.0,
        params: ParameterValues | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
        *,
        box: Corners | None = None,
        inside: Color = "white",
        outside: Color = "black",
        samples: int = 4,
    ) -> Picture:
        """Return a picture of the shape, filled with one color, without a camera or lights.

        A shape of thousands of parts is drawn in milliseconds, and nothing is compiled for it,
        unless its function has loops of varying length, textures or noise. Always on the CPU.

        Args:
            size: Width and height in pixels.
            time: Time in seconds; ``frame.time`` of an ``@image``.
            params: Values of parameters by name; the others have their defaults.
            threads: Number of CPU threads; None uses all that the process may use.
            progress: Called with the finished share, from 0 to 1.
            cancel: An event, or a function without arguments, that ends the work early.
            box: Corners (low, high) of the part of the plane to show, which is centered; None: the
                box of the shape with a margin, or from -1 to 1 if it is infinite.
            inside: The color inside.
            outside: The color outside.
            samples: Samples in each pixel, which are averaged: 1, 4, 9, 16 ... up to 256.

        Raises:
            CompileError: The shape's scene code has mistakes.
            TypeError: A value has the wrong type.
            ValueError: A value is out of range, or there is no such parameter.
        """
        options = RenderOptions(
            size=size,
            time=time,
            params=params or {},
            threads=threads,
            progress=progress,
            cancel=cancel,
        )
        return filled(self, options, box, inside, outside, samples)

    def extrude(
        self,
        height: Number | None = 1.0,
        *,
        along: str = "z",
        rounding: Number | None = None,
        chamfer: Number | None = None,
    ) -> Shape:
        """Extrude to a solid whose middle is at 0.

        Args:
            height: Full length; None extrudes without end.
            along: "z": the outline stands as it is drawn. "y": it is a plan that lies in the floor;
                seen from above, x points to the right and its y, which is -z then, up.
            rounding: Radius of the rounded edges; None for sharp edges.
            chamfer: Size of the chamfered edges; None for sharp edges. Ignored with ``rounding``.
        """
        if along not in ("y", "z"):
            hint = 'along="y" for a plan; then rotate(…) for others'
            refuse(f'extrude goes along "z" or "y", not {along!r:.40}', hint, author_place())
        if along == "y":
            standing = self.extrude(height, rounding=rounding, chamfer=chamfer)
            lying = standing._with(placing.ROTATE_MATRIX, **PLAN)
            edges = {"rounding": rounding, "chamfer": chamfer}
            given = {"outline": self, "height": height, "along": along}
            given |= {name: size for name, size in edges.items() if size is not None}
            lying._record(CallRecord(_extruded, (), given, Shape))
            return lying
        if height is None:
            if rounding is not None or chamfer is not None:
                hint = "extrude(height, rounding=…), or leave out rounding and chamfer"
                refuse("what is extruded without end has no edges to shape", hint, author_place())
            return self._solid(extrude.EXTRUDE_ENDLESS)
        if rounding is not None:
            return self._solid(extrude.EXTRUDE_ROUNDED, height, rounding)
        if chamfer is not None:
            return self._solid(extrude.EXTRUDE_CHAMFERED, height, chamfer)
        return self._solid(extrude.EXTRUDE, height)

    def revolve(self, offset: Number = 0.0, angle: Number | None = None) -> Shape:
        """Revolve about the y axis; x > 0 is outwards.

        Args:
            offset: Distance by which the outline is first moved away from the axis.
            angle: Angle of the revolution in radians; None for a full turn.
        """
        if angle is None:
            return self._solid(lift.REVOLVE, offset)
        return self._solid(lift.REVOLVE_PARTLY, offset, angle)

    def loft(self, other: BaseShape, height: Number = 1.0, ease: str = "linear") -> Shape:
        """Connect this outline at z = -height / 2 to another at z = height / 2.

        Args:
            other: The other outline.
            height: Length along z.
            ease: How the change begins and ends, one of ``EASES``.
        """
        numbers = {"height": height, "ease": ease_number(ease)}
        return cast("Shape", self._joined(extrude.LOFT, other, **numbers))

    def twist_extrude(self, height: Number, angle: Number) -> Shape:
        """Extrude along z and rotate by ``angle`` radians in total from end to end."""
        return self._solid(extrude.EXTRUDE_TWISTED, height, angle)

    def taper_extrude(self, height: Number, top: Number) -> Shape:
        """Extrude along z and scale gradually, by the factor ``top`` at the upper end."""
        return self._solid(extrude.EXTRUDE_TAPERED, height, top)

    def sweep(self, points: Points, up: Vector = (0.0, 1.0, 0.0)) -> Shape:
        """Sweep along the polyline through (n, 3) points.

        Points that repeat the one before count once. A path whose last point is its first is
        closed: it has a joint there, and no ends.

        Args:
            points: The points, in order.
            up: The direction of the outline's y axis at the start, as far as possible.

        Raises:
            SceneValueError: The path has no length or turns back on itself, or the outline comes
                back turned along a closed path.
        """
        place = author_place()
        corners, closed = path_corners(points, place)
        made: Shape = self._under(path.SWEEP, (corners,), {"up": up, "closed": closed}, place)
        return made

    def sweep_bezier(
        self,
        start: Vector,
        control: Vector,
        end: Vector,
        up: Vector = (0.0, 1.0, 0.0),
        pieces: int = 16,
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

    def wrap_cylinder(
        self, radius: Number, height: Number, *, count: Number | None = None
    ) -> Shape:
        """Wrap around a cylinder about the y axis, as a relief.

        Args:
            radius: Radius of the cylinder, in the middle of the relief.
            height: Thickness of the relief.
            count: Number of copies all around, at equal angles, without a seam: 1 for a shape as
                wide as the circumference, which meets itself. The index of a copy is its ``cell``.
                None wraps the shape once, with a gap at the back.

        Raises:
            SceneValueError: The shape is too wide.
        """
        if count is None:
            return self._solid(lift.WRAP_CYLINDER, radius, height)
        return self._solid(wrapping.WRAP_AROUND, radius, height, count=count)

    def wrap_around(self, radius: Amount, height: Amount, *, depth: Amount | None = None) -> Shape:
        """Put the outline on a cylinder about the y axis, raised: text on a bottle, for instance.

        It is ``wrap_cylinder`` with the sizes of what is seen. Its front faces +z. Unite it with
        the cylinder, or subtract it for an engraving.

        Args:
            radius: Radius of the cylinder.
            height: How far it stands out of the cylinder's surface.
            depth: How far it extends below the surface; None for as far as ``height``.
        """
        if depth is None:
            return self._solid(lift.WRAP_CYLINDER, radius, 2.0 * height)
        middle = radius + 0.5 * (height - depth)
        return self._solid(lift.WRAP_CYLINDER, middle, height + depth)

    def relief(self, *numbers: Number) -> Shape:
        """Return terrain whose height at (x, z) is the value of this flat field."""
        return self._solid(heightfield.RELIEF, *numbers)


def ease_number(name: str) -> int:
    """Return the number of an easing, from its name.

    Raises:
        SceneValueError: There is no such easing.
    """
    if name not in EASES:
        refuse(f"there is no easing {name!r:.40}", ", ".join(EASES), author_place())
    return EASES.index(name)


PLAIN.update({False: Shape, True: Shape2D})


def _extruded(
    outline: Shape2D,
    height: Number | None,
    along: str,
    rounding: Number | None = None,
    chamfer: Number | None = None,
) -> Shape:
    """Return ``outline.extrude(…)``."""
    return outline.extrude(height, along=along, rounding=rounding, chamfer=chamfer)


cast("Any", _extruded).written_as, cast("Any", _extruded).by_name = ".extrude", True
