"""Methods that solid and flat shapes share: placement, anchors, repetition, thickness, edges.

Input: the author's numbers. Output: new shapes; shapes never change. Every method applies an
operator of the field library; on a flat shape, it applies the operator's counterpart in the plane.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final, TypeVar

from distal.fields.deform import offsets
from distal.fields.guarantees import Operator
from distal.fields.library import OPERATORS
from distal.fields.lift import extrude
from distal.fields.place import mirrors
from distal.fields.place import solid as placing
from distal.fields.repeat import grid, polar
from distal.frontend.problems import did_you_mean
from distal.ir.types import INT
from distal.lang.names import select
from distal.lang.source_places import author_place
from distal.scene.objects.anchors import measured_extents, offset_aligned, offset_on
from distal.scene.objects.field import BaseShape
from distal.scene.objects.in_plane import IN_PLANE
from distal.scene.objects.masked import masked
from distal.scene.objects.movable import Movable
from distal.scene.objects.shaped_edges import shaped_edge
from distal.scene.tree.conversion import Asked, is_scalar, plain_choice
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.former_names import FORMER_WORDS
from distal.scene.tree.value import refuses_unknown

if TYPE_CHECKING:
    from distal.scene.objects.argument_types import Argument, Number, Vector

_SHELLS: Final[Mapping[str, Operator]] = {
    "inner": offsets.SHELL_INNER,
    "center": offsets.SHELL_CENTER,
    "outer": offsets.SHELL_OUTER,
}


def _fixed(name: str, what: str, value: Any) -> int:
    """Return a whole number that decides which code there is."""
    return int(plain_choice(value, Asked(name, what, INT, place=author_place())))


# The class of the receiver. jedi takes Self for the class that defines the method.
S = TypeVar("S", bound="Placed")


class Placed(Movable, BaseShape):
    """A shape with the methods that solid and flat shapes share."""

    def _with(self: S, operator: Operator, *args: Any, **kwargs: Any) -> S:
        """Apply an operator; on a flat shape, its counterpart in the plane."""
        if self.flat:
            operator = IN_PLANE.get(operator, operator)
        made: S = self._under(operator, args, kwargs, author_place())
        return made

    def _joined(self: S, operator: Operator, other: Any, **numbers: Any) -> S:
        place = author_place()
        if not isinstance(other, BaseShape) or other.flat != self.flat:
            kind = "flat" if self.flat else "solid"
            refuse(f"'{operator.name}' takes another {kind} shape, not {other!r:.60}", None, place)
        made: S = self._under(operator, (), numbers, place, others=(other,))
        return made

    def apply(
        self, operator: str, *args: Argument, others: Sequence[BaseShape] = (), **kwargs: Argument
    ) -> Any:
        """Apply an operator of the library by its name in the catalogue.

        Args:
            operator: The operator's name, such as "twist" or "flat repeat".
            args: The operator's numbers by position.
            others: The shapes to combine this one with.
            kwargs: The operator's numbers by name.

        Raises:
            SceneValueError: There is no such operator, or it does not work on this shape.
        """
        place = author_place()
        if not isinstance(operator, str):
            refuse_kind(f"an operator is a name, not {operator!r:.60}", '"shell"', place)
        if operator not in OPERATORS:
            refuse(f"there is no operator '{operator}'", did_you_mean(operator, OPERATORS), place)
        return self._under(OPERATORS[operator], args, kwargs, place, others=tuple(others))

    def shown(self: S, condition: Number) -> S:
        """Show the shape only where a condition holds, else nothing.

        ``shown(toggle("Lid", True))``, ``shown(count > 3)``: it follows without a compilation.
        Nothing adds nothing to a union, and takes nothing away from what it is subtracted from.

        Args:
            condition: A bool, a toggle, or a comparison of parameters or time.

        Raises:
            SceneTypeError: The condition is none.
        """
        made: S = select(condition, self, None)
        return made

    @refuses_unknown
    def symmetry(
        self: S, axes: str | None = None, offset: Number = 0.0, *, across: Vector | None = None
    ) -> S:
        """Keep one half and copy its mirror image over: ``symmetry("xz")``.

        The half that the axis or the normal points to stays; what was in the other half is gone.
        Several axes are folded one after the other. On a flat shape, planes are lines.

        Args:
            axes: Letters of axes.
            offset: Distance of the plane from the origin, along the one axis or the normal.
            across: The normal of any other plane, of length 1, instead of axes.

        Raises:
            SceneValueError: The arguments name neither an axis nor a plane, or both.
        """
        return self._at_plane("symmetry", axes, offset, across)

    def kaleidoscope(self: S, count: Number) -> S:
        """Repeat a wedge ``count`` times about the y axis, mirroring every other copy."""
        return self._with(mirrors.KALEIDOSCOPE, count)

    @refuses_unknown
    def repeat(
        self: S,
        *spacing: Vector | Number,
        count: Sequence[Number] | Number | None = None,
        neighbors: int = 0,
        mirrored: bool = False,
    ) -> S:
        """Repeat on a grid that is centred on the shape itself.

        Args:
            spacing: Distance from cell to cell along each axis, in scene units; 0 for no repetition
                along an axis. One number is used for all axes.
            count: Number of copies along each axis, two or three whole numbers, or one for all
                axes; each may be an integer parameter. The indices of cells then start with 0 at
                the lower corner. None repeats infinitely.
            neighbors: How many cells around the nearest are also evaluated: 0 for a shape that
                stays within its cell, 1 or 2 for one that reaches into others.
            mirrored: Whether every other copy is mirrored, so that adjacent copies match.

        Raises:
            SceneValueError: ``count`` is not one whole number for each axis, or the shape does not
                fit into its cell.
        """
        if mirrored:
            return self._with(grid.REPEAT_MIRRORED, *spacing)
        neighbors = _fixed("neighbors", "repeat", neighbors)
        if count is None:
            if neighbors:
                return self._with(grid.REPEAT_NEIGHBORS, *spacing, neighbors=neighbors)
            return self._with(grid.REPEAT, *spacing)
        axes = "xy" if self.flat else "xyz"
        try:
            each: Any = (count,) * len(axes) if is_scalar(count) else count
            counts = {f"count_{axis}": n for axis, n in zip(axes, each, strict=True)}
        except (TypeError, ValueError):
            refuse(
                f"count is {len(axes)} whole numbers, not {count!r:.40}",
                "count=(3, 2)" if self.flat else "count=(3, 1, 3)",
                author_place(),
            )
        if neighbors:
            counts["neighbors"] = neighbors
            return self._with(grid.REPEAT_LIMITED_NEIGHBORS, *spacing, **counts)
        return self._with(grid.REPEAT_LIMITED, *spacing, **counts)

    @refuses_unknown
    def repeat_polar(self: S, count: Number, *, neighbors: int | str = 0) -> S:
        """Repeat ``count`` times about the y axis (a flat shape: about the origin).

        Args:
            count: A whole number, or an integer parameter.
            neighbors: How many sectors beside the nearest are also evaluated: 0 for a shape that
                fits into its sector, 1 or 2 for a wider one. "all": every copy is, for shapes that
                reach the axis or overlap; it takes ``count`` times as long.

        Raises:
            SceneValueError: The shape does not fit, or ``count`` is too small.
        """
        if neighbors == "all":
            return self._with(polar.REPEAT_POLAR_ALL, count=count)
        whole = _fixed("neighbors", "repeat_polar", neighbors)
        if whole:
            return self._with(polar.REPEAT_POLAR_NEIGHBORS, count=count, neighbors=whole)
        return self._with(polar.REPEAT_POLAR, count=count)

    def split(self: S, normal: Vector, offset: Number = 0.0) -> tuple[S, S]:
        """Cut by a plane into two shapes: the part behind the plane and the part in front of it.

        The normal points to the second part.
        """
        below = self._with(offsets.SPLIT_BELOW, normal, offset)
        return below, self._with(offsets.SPLIT_ABOVE, normal, offset)

    def round(self: S, radius: Number) -> S:
        """Move the surface outwards by ``radius``, which rounds the edges."""
        return self._with(offsets.ROUND, radius)

    def offset(self: S, distance: Number) -> S:
        """Move the surface outwards by a distance, or inwards by a negative one."""
        return self._with(offsets.OFFSET, distance)

    def shell(self: S, thickness: Number, where: str = "inner") -> S:
        """Make the shape hollow.

        Args:
            thickness: Thickness of the wall, in scene units.
            where: Where the wall lies: "inner", so that the outside keeps its size; "outer", so
                that the inside does; or "center", half on each side of the surface.

        Raises:
            SceneValueError: There is no such place.
        """
        if where not in _SHELLS:
            former = FORMER_WORDS.get(str(where))
            hint = f'where="{former}"' if former else did_you_mean(str(where), _SHELLS)
            refuse(f"a shell lies inner, center or outer, not {where!r:.40}", hint, author_place())
        return self._with(_SHELLS[where], thickness)

    def where(
        self: S,
        region: BaseShape,
        changed: BaseShape | Callable[[S], BaseShape],
        *,
        blend: Number = 0.0,
    ) -> S:
        """Show a changed shape inside a region, and this one outside.

        Any operator is limited to a region so: ``shape.where(Box(1.0), lambda s: s.bend(0.5))``.
        Where the surfaces of both meet at the border, nothing is seen of it; where they do not,
        there is a step along it.

        Args:
            region: A shape, whose inside is the region.
            changed: The shape inside the region, or a function that makes it from this one.
            blend: The size of the fillets at such a step, in scene units, as ``smooth`` of
                ``union``. 0 leaves its edges sharp.

        Raises:
            SceneTypeError: The region, or what is shown there, is no shape.
            SceneValueError: They do not all lie in the plane, or ``blend`` is below 0.
        """
        made: S = masked(self, region, changed, blend, author_place())
        return made

    def infill(self: S, lattice: BaseShape, wall: Number) -> S:
        """Make a skin of this shape and fill it with a lattice, as for printing.

        Args:
            lattice: What fills the skin: ``Gyroid(0.4)``, ``OctetLattice(0.5, 0.04)``. In a solid,
                a flat one such as ``Honeycomb(0.3, 0.04)`` stands upright: its walls run along y.
            wall: Thickness of the skin, inside the surface.
        """
        place = author_place()
        if isinstance(lattice, BaseShape) and lattice.flat and not self.flat:
            upright = lattice._under(extrude.EXTRUDE_ENDLESS, (), {}, place)
            lattice = upright._under(placing.ROTATE_X, (0.5 * math.pi,), {}, place)
        if not isinstance(lattice, BaseShape) or lattice.flat != self.flat:
            hint = "Gyroid(0.4), OctetLattice(0.5, 0.04) or Honeycomb(0.3, 0.04)"
            refuse(f"an infill is a lattice, not {lattice!r:.60}", hint, place)
        skin = self.shell(wall, "inner")
        return skin.union(lattice.intersection(self))

    def fillet(self: S, radius: Number) -> S:
        """Round the edge where the shapes of the last operator meet, by a quarter of a circle.

        After ``|`` it fills the corner, after ``-`` and ``&`` it rounds the edge off; after
        ``extrude`` it rounds the ends. The radius is exact where the surfaces meet at a right angle
        and the distances are true. Faces that both shapes have in a side of the box around them do
        not move.

        Raises:
            SceneValueError: The last operator makes no edge that can be rounded.
        """
        place = author_place()
        made: S = self._of(shaped_edge(self.node, "fillet", radius, place))
        return made

    def chamfer(self: S, size: Number) -> S:
        """Bevel the edge where the shapes of the last operator meet; as ``fillet``.

        ``size`` is how far the flat face extends along both surfaces.
        """
        place = author_place()
        made: S = self._of(shaped_edge(self.node, "chamfer", size, place))
        return made

    def extents(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return the measured box (low, high): where the surface really ends along each axis.

        ``bounds()`` may be larger. Measured for the defaults of parameters and time 0: to about a
        millionth of the size for shapes that are exact outside; for others, by a search that may
        miss parts thinner than a hundredth of the size.

        Raises:
            SceneValueError: The shape is infinite, or nothing of it was found.
        """
        return measured_extents(self, author_place())

    def on(self: S, other: BaseShape, side: str = "top", *, gap: Number = 0.0) -> S:
        """Move onto a side of another shape, over its middle, so that the two touch.

        The extents of both are measured, once, as by ``extents``.

        Args:
            other: The shape that is touched.
            side: "top" (+y), "bottom", "right" (+x), "left", and for solids "front" (+z), "back".
            gap: Distance to keep; negative to overlap. May be a parameter.

        Raises:
            SceneValueError: There is no such side, or the extents change with a parameter or time.
        """
        return self._with(placing.TRANSLATE, offset_on(self, other, side, gap, author_place()))

    def align(
        self: S,
        other: BaseShape,
        *,
        x: str | None = None,
        y: str | None = None,
        z: str | None = None,
    ) -> S:
        """Move along the given axes so that a side, or the middle, is flush with another shape's.

        The extents of both shapes are measured, as by ``on``.

        Args:
            other: The shape that stays.
            x: "low", "center" or "high": which ends, or the middle; None does not move along x.
            y: The same along y.
            z: The same along z; only for solids.

        Raises:
            SceneValueError: A word is none of these, or the extents follow a parameter or time.
        """
        words = {"x": x, "y": y, "z": z}
        return self._with(placing.TRANSLATE, offset_aligned(self, other, words, author_place()))
