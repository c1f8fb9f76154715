"""Curves that an author gives by a formula: tubes and outlines along them, copies turned with them.

Input: a Python function of a number. Output: a ``Curve``, and shapes along it. The formula is
evaluated when the curve is made; parameters and time do not change it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import Span
from distal.fields.lift import path
from distal.ir.types import FLOAT, VEC3
from distal.lang.immutable import Immutable
from distal.lang.source_places import author_place
from distal.scene.objects.copies import CopyColumns, copied
from distal.scene.objects.field import BaseShape
from distal.scene.objects.path_corners import path_corners
from distal.scene.objects.shapes import CLASSES
from distal.scene.points.curves import points_along
from distal.scene.points.frames import across, quaternions, rolled, untwisted
from distal.scene.points.parabolas import Parabolas, parabolas_of
from distal.scene.points.requests import positive
from distal.scene.tree.conversion import Asked, number
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.value import AuthorObject, CallRecord, recorded

if TYPE_CHECKING:
    from distal.scene.objects.argument_types import Number, Vector
    from distal.scene.objects.shape import Shape, Shape2D
    from distal.scene.tree.texts import TextWriter

Floats = NDArray[np.float64]

# The tolerance as a fraction of the curve's size, if the author gives none.
_FRACTION: Final = 5e-4
# Straight pieces of each parabola, along which frames are carried and outlines are swept.
_STRAIGHT: Final = 4
# Frames are carried in steps by this many for each copy at least.
_STEPS: Final = 8
_LEAST_STEPS: Final = 512
_UP: Final = (0.0, 1.0, 0.0)


class Curve(AuthorObject, Immutable):
    """A curve in space, given by a formula; followed by parabolas within a tolerance.

    Attributes:
        closed: Whether its end is its start.
        error: The largest distance between the parabolas and the formula, measured at 16 places of
            each piece.
        pieces: The number of parabolas.
    """

    __slots__ = ("_kept_digest", "_origin", "_parabolas", "_place")

    def __init__(self, parabolas: Parabolas, place: Span | None) -> None:
        self._parabolas, self._place = parabolas, place

    @recorded
    @classmethod
    def from_function(
        cls,
        function: Callable[[float], Any],
        start: float = 0.0,
        end: float = 1.0,
        *,
        tolerance: float | None = None,
    ) -> Curve:
        """Return the curve of a Python function.

        ``Curve.from_function(lambda a: (cos(a), sin(2 * a), sin(a)), 0, tau)``, with the functions
        of ``math``. If its end is its start, it is closed.

        Args:
            function: Returns a point, three numbers, for a number from ``start`` to ``end``.
            start: The number at the start.
            end: The number at the end.
            tolerance: The largest allowed distance between the curve and the parabolas that follow
                it, in scene units; None is 0.0005 of the curve's size.

        Raises:
            SceneTypeError: The function returns something else than three numbers.
            SceneValueError: A point is not finite, the curve has no length, or it needs more than
                512 pieces.
        """
        place = author_place()
        if not callable(function):
            refuse_kind(
                f"a curve is made from a function, not from {function!r:.60}",
                "Curve.from_function(lambda t: (cos(t), 0.0, sin(t)), 0, tau)",
                place,
            )
        first, last = (
            _plain(value, name, place) for name, value in (("start", start), ("end", end))
        )
        if first == last:
            refuse(f"start and end of the curve are the same, {first:g}", "start=0, end=1", place)

        def allowed(size: float) -> float:
            if tolerance is None:
                return _FRACTION * size
            return positive(tolerance, "tolerance of Curve", place)

        return cls(parabolas_of(function, first, last, allowed, place), place)

    @property
    def arguments(self) -> Mapping[str, Any]:
        """The arguments by name; none of a curve that another process made."""
        origin: CallRecord | None = getattr(self, "_origin", None)
        return {} if origin is None else origin.arguments

    def _replaced(self, changes: dict[str, Any]) -> Curve:
        """Return the curve with other arguments of ``from_function``."""
        return Curve.from_function(**{**self.arguments, **changes})

    def _record(self, origin: CallRecord) -> None:
        self._origin = origin

    def _pickled(self) -> Any:
        # Without its formula, which may be any function of Python.
        return Curve, (self._parabolas, self._place)

    def _compared(self) -> tuple[Any, ...]:
        return "curve", self._parabolas.points, self.closed

    @property
    def closed(self) -> bool:
        """Whether its end is its start."""
        return self._parabolas.closed

    @property
    def error(self) -> float:
        """The largest measured distance between the parabolas and the formula."""
        return self._parabolas.error

    @property
    def pieces(self) -> int:
        """The number of parabolas."""
        return (len(self._parabolas.points) - 1) // 2

    def _written(self, writer: TextWriter) -> str:
        kind = "closed " if self.closed else ""
        return f"<{kind}curve of {self.pieces} parabolas, error {self.error:.2g}>"

    def __call__(self, t: float) -> tuple[float, float, float]:
        """Return a point; t is from 0 at the start to 1 at the end. For ``points_along``."""
        points = self._parabolas.points
        at = min(max(float(t), 0.0), 1.0) * self.pieces
        i = min(int(at), self.pieces - 1)
        u = at - i
        a, c, b = points[2 * i : 2 * i + 3]
        x, y, z = ((1.0 - u) ** 2 * a + 2.0 * u * (1.0 - u) * c + u * u * b).tolist()
        return x, y, z

    def tube(self, radius: Number = 0.1) -> Shape:
        """Return a round tube along the curve; its distance to the parabolas is exact outside.

        Args:
            radius: Radius of the tube; may be a parameter.
        """
        tube: Any = CLASSES["CurveTube"]
        made: Shape = tube(self._parabolas.points, radius=radius)
        return made

    def sweep(self, outline: Shape2D, up: Vector = _UP) -> Shape:
        """Return the solid of an outline that moves along the curve without a twist.

        The curve is divided into straight pieces, 4 of each parabola, whose joints are mitred. A
        closed curve is swept all the way round if the outline comes back as it began, as along
        every curve in a plane.

        Args:
            outline: A flat shape.
            up: The direction of the outline's y axis at the start, as far as possible.

        Raises:
            SceneValueError: The outline comes back turned, or the curve is too sharp for it.
        """
        place = author_place()
        if not isinstance(outline, BaseShape) or not outline.flat:
            refuse_kind(
                f"a curve sweeps a flat shape, not {outline!r:.60}", "Rectangle(0.2, 0.1)", place
            )
        corners = self._corners()
        if self.closed:
            corners[-1] = corners[0]
        corners, closed = path_corners(corners, place, "curve")
        made: Shape = outline._under(path.SWEEP, (corners,), {"up": up, "closed": closed}, place)
        return made

    def frames(
        self,
        count: int | None = None,
        *,
        spacing: float | None = None,
        axis: Vector = _UP,
        up: Vector | None = None,
        roll: float = 0.0,
    ) -> tuple[Floats, Floats]:
        """Return points at equal distances along the curve, and rotations of copies there.

        Args:
            count: Number of points.
            spacing: Distance along the curve, instead of ``count``; changed a little so that the
                curve is divided evenly.
            axis: The direction of the copies that follows the curve.
            up: None: frames that turn about the curve as little as possible. A direction: each
                frame is as upright as possible.
            roll: Angle in radians by which each copy is turned further about the curve than the one
                before: ``pi / 2`` for the links of a chain.

        Returns:
            The points (n, 3), and unit quaternions (n, 4) for ``copies`` and ``array``.

        Raises:
            SceneValueError: Not exactly one of count and spacing is given, or a direction is zero.
        """
        place = author_place()
        points, aheads = points_along(self, count, spacing=spacing)
        turned = _direction(axis, "axis", place)
        if up is None:
            sides = self._untwisted(points, aheads)
        else:
            upwards = _direction(up, "up", place)
            sides = np.array([across(ahead, upwards) for ahead in aheads])
        angle = _plain(roll, "roll", place)
        angles = np.array([angle * i for i in range(len(points))], np.float64)
        sides = rolled(sides, aheads, angles)
        return points, quaternions(aheads, sides, turned)

    def copies(
        self,
        shape: Shape,
        count: int | None = None,
        *,
        spacing: float | None = None,
        axis: Vector = _UP,
        up: Vector | None = None,
        roll: float = 0.0,
    ) -> Shape:
        """Return copies of a shape at equal distances along the curve, turned with it.

        ``knot.copies(link, spacing=0.4, roll=pi / 2)`` is a chain. Arguments as for ``frames``.

        Args:
            shape: The shape; its origin comes to lie on the curve.
            count: Number of copies.
            spacing: Distance along the curve, instead of ``count``.
            axis: The direction of the shape that follows the curve.
            up: None, or the direction in which all copies are upright.
            roll: Angle by which each copy is turned further than the one before.
        """
        place = author_place()
        points, rotation = self.frames(count, spacing=spacing, axis=axis, up=up, roll=roll)
        made: Shape = copied("copies", (shape,), CopyColumns(points, rotation=rotation), place)
        return made

    def _untwisted(self, points: Floats, aheads: Floats) -> Floats:
        """Return the directions across the curve, carried in steps smaller than the copies'."""
        count = len(points)
        pieces = count if self.closed else max(count - 1, 1)
        each = max(math.ceil(_LEAST_STEPS / pieces), _STEPS)
        steps = pieces * each if self.closed else pieces * each + 1
        dense, ways = points_along(self, steps)
        sides = untwisted(dense, ways, np.array(_UP), closed=self.closed)
        found = sides[::each][:count]
        return np.array([across(a, s) for a, s in zip(aheads, found, strict=True)])

    def _corners(self) -> Floats:
        count = _STRAIGHT * self.pieces
        return np.array([self(i / count) for i in range(count + 1)])


def _plain(value: Any, name: str, place: Span | None) -> float:
    made = number(value, Asked(name, "Curve", FLOAT, place=place)).plain
    if not isinstance(made, float):
        refuse_kind(f"'{name} of Curve' is a plain number, not an expression", place=place)
    return made


def _direction(value: Any, name: str, place: Span | None) -> Floats:
    made = number(value, Asked(name, "Curve", VEC3, place=place)).plain
    if made is None:
        refuse_kind(f"'{name} of Curve' is plain numbers, not an expression", place=place)
    found = np.array(made, np.float64)
    size = float(np.linalg.norm(found))
    if size == 0.0:
        refuse(f"'{name} of Curve' has no direction: it is zero", place=place)
    unit: Floats = found / size
    return unit
