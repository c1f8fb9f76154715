"""Methods that solid and flat shapes share: placement, anchors, repetition, thickness, edges.

Input: the author's numbers. Output: new shapes; shapes never change. Every method applies an
operator of the field library; on a flat shape, it applies the operator's counterpart in the plane.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final, Self

from distal.fields.deform import offsets
from distal.fields.guarantees import Operator
from distal.fields.library import OPERATORS
from distal.fields.lift import extrude
from distal.fields.place import mirrors
from distal.fields.place import solid as placing
from distal.fields.repeat import grid, polar
from distal.frontend.problems import did_you_mean
from distal.scene.objects.anchors import measured_extents, offset_aligned, offset_on
from distal.scene.objects.field import BaseShape
from distal.scene.objects.in_plane import IN_PLANE
from distal.scene.objects.shaped_edges import shaped_edge
from distal.scene.tree.conversion import is_scalar
from distal.scene.tree.errors import refuse
from distal.scene.tree.source_places import author_place

_SHELLS: Final[Mapping[str, Operator]] = {
    "inner": offsets.SHELL_INNER,
    "centre": offsets.SHELL_CENTRE,
    "outer": offsets.SHELL_OUTER,
}


class Placed(BaseShape):
    """A shape with the methods that solid and flat shapes share."""

    def _with(self, operator: Operator, *args: Any, **kwargs: Any) -> Self:
        """Apply an operator; on a flat shape, its counterpart in the plane."""
        if self.flat:
            operator = IN_PLANE.get(operator, operator)
        made: Self = self._under(operator, args, kwargs, author_place())
        return made

    def _joined(self, operator: Operator, other: Any, **numbers: Any) -> Self:
        place = author_place()
        if not isinstance(other, BaseShape) or other.flat != self.flat:
            kind = "flat" if self.flat else "solid"
            refuse(f"'{operator.name}' takes another {kind} shape, not {other!r:.60}", None, place)
        made: Self = self._under(operator, (), numbers, place, others=(other,))
        return made

    def apply(
        self, operator: str, *args: Any, others: Sequence[BaseShape] = (), **kwargs: Any
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
        if operator not in OPERATORS:
            refuse(f"there is no operator '{operator}'", did_you_mean(operator, OPERATORS), place)
        return self._under(OPERATORS[operator], args, kwargs, place, others=tuple(others))

    def translate(self, *offset: Any, **parts: Any) -> Self:
        """Move: ``translate(1, 0, 0)``, ``translate((1, 0, 0))`` or ``translate(x=1)``."""
        return self._with(placing.TRANSLATE, *offset, **parts)

    def scale(self, *factors: Any, **parts: Any) -> Self:
        """Scale by one factor, or by one factor for each axis (which loses exactness)."""
        if len(factors) == 1 and not parts and is_scalar(factors[0]):
            return self._with(placing.SCALE, *factors)
        return self._with(placing.STRETCH, *factors, **parts)

    def mirror(self, normal: Any, offset: Any = 0.0) -> Self:
        """Replace the half behind a plane by the mirror image of the half in front of it.

        On a flat shape, the plane is a line. The normal points to the half that is kept.

        Args:
            normal: Normal of the plane, of length 1.
            offset: Distance of the plane from the origin along the normal.
        """
        return self._with(mirrors.MIRROR, normal, offset)

    def symmetry(self, axes: str) -> Self:
        """Mirror the positive side of each named axis to the negative side: ``symmetry("xz")``."""
        known = "xy" if self.flat else "xyz"
        if not isinstance(axes, str) or not axes or not set(axes) <= set(known):
            refuse(f"symmetry takes letters of '{known}', not {axes!r}", None, author_place())
        return self._with(mirrors.SYMMETRY, **{axis: axis in axes for axis in known})

    def kaleidoscope(self, count: int) -> Self:
        """Repeat a wedge ``count`` times about the y axis, mirroring every other copy."""
        return self._with(mirrors.KALEIDOSCOPE, count)

    def repeat(
        self,
        *spacing: Any,
        count: Sequence[int] | None = None,
        neighbours: int = 0,
        mirrored: bool = False,
    ) -> Self:
        """Repeat on a grid that is centred on the shape itself.

        Args:
            spacing: Distance from cell to cell along each axis, in scene units; 0 for no repetition
                along an axis. One number is used for all axes.
            count: Number of copies along each axis, two or three whole numbers; the indices of
                cells then start with 0 at the lower corner. None repeats infinitely.
            neighbours: How many cells around the nearest are also evaluated: 0 for a shape that
                stays within its cell, 1 or 2 for one that reaches into others.
            mirrored: Whether every other copy is mirrored, so that adjacent copies match.

        Raises:
            SceneValueError: ``count`` is not one whole number for each axis, or the shape does not
                fit into its cell.
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
        """Repeat ``count`` times about the y axis (a flat shape: about the origin).

        With ``neighbours`` of 1 or more, a copy may extend into adjacent sectors.
        """
        if neighbours:
            return self._with(polar.REPEAT_POLAR_NEIGHBOURS, count=count, neighbours=neighbours)
        return self._with(polar.REPEAT_POLAR, count=count)

    def split(self, normal: Any, offset: Any = 0.0) -> tuple[Self, Self]:
        """Cut by a plane into two shapes: the part behind the plane and the part in front of it.

        The normal points to the second part.
        """
        below = self._with(offsets.SPLIT_BELOW, normal, offset)
        return below, self._with(offsets.SPLIT_ABOVE, normal, offset)

    def round(self, radius: Any) -> Self:
        """Move the surface outwards by ``radius``, which rounds the edges."""
        return self._with(offsets.ROUND, radius)

    def offset(self, distance: Any) -> Self:
        """Move the surface outwards by a distance, or inwards by a negative one."""
        return self._with(offsets.OFFSET, distance)

    def shell(self, thickness: Any, where: str = "centre") -> Self:
        """Make the shape hollow; ``where`` places the wall: "inner", "centre" or "outer"."""
        if where not in _SHELLS:
            refuse(f"a shell lies inner, centre or outer, not {where!r}", None, author_place())
        return self._with(_SHELLS[where], thickness)

    def infill(self, lattice: BaseShape, wall: Any) -> Any:
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

    def fillet(self, radius: Any) -> Self:
        """Round the edge where the shapes of the last operator meet, by a quarter of a circle.

        After ``|`` it fills the corner, after ``-`` and ``&`` it rounds the edge off; after
        ``extrude`` it rounds the ends. The radius is exact where the surfaces meet at a right angle
        and the distances are true.

        Raises:
            SceneValueError: The last operator makes no edge that can be rounded.
        """
        place = author_place()
        made: Self = self._of(shaped_edge(self.node, "fillet", radius, place))
        return made

    def chamfer(self, size: Any) -> Self:
        """Bevel the edge where the shapes of the last operator meet; as ``fillet``.

        ``size`` is how far the flat face extends along both surfaces.
        """
        place = author_place()
        made: Self = self._of(shaped_edge(self.node, "chamfer", size, place))
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

    def on(self, other: BaseShape, side: str = "top", *, gap: Any = 0.0) -> Self:
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

    def align(self, other: BaseShape, *, x: Any = None, y: Any = None, z: Any = None) -> Self:
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
