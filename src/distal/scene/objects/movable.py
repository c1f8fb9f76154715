"""The methods that place: of shapes, and of lights, cameras and groups.

Input: the author's numbers. Output: the same object elsewhere, by operators of the field library.
Does not depend on how an operator is applied.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Final, TypeVar, overload

from distal.fields.guarantees import Operator
from distal.fields.place import solid as placing
from distal.lang.source_places import author_place
from distal.scene.objects.affine import affine_parts, refuse_mirrored
from distal.scene.objects.reflecting import PlaneArguments, without_signs
from distal.scene.objects.turns import warn_of_degrees
from distal.scene.tree.conversion import is_scalar
from distal.scene.tree.errors import refuse
from distal.scene.tree.value import refuses_unknown

if TYPE_CHECKING:
    from distal.scene.objects.argument_types import ArrayLike, Number, Vector

_ROTATIONS: Final[Mapping[str, Operator]] = {
    "x": placing.ROTATE_X,
    "y": placing.ROTATE_Y,
    "z": placing.ROTATE_Z,
}

# The class of the receiver. jedi takes Self for the class that defines the method.
M = TypeVar("M", bound="Movable")


class Movable:
    """An object with the methods that place solids and flat shapes."""

    __slots__ = ()

    flat: ClassVar[bool] = False

    def _with(self: M, operator: Operator, *args: Any, **kwargs: Any) -> M:
        """Apply an operator of placement.

        Args:
            operator: The operator for solids.
            args: Its numbers by position.
            kwargs: Its numbers by name.
        """
        raise NotImplementedError

    def _at_plane(self: M, method: str, axes: Any, offset: Any, across: Any) -> M:
        """Apply ``mirror`` or ``symmetry``, at axes or at a plane."""
        plane = PlaneArguments(method, axes, offset, across, self.flat, author_place())
        operator, numbers = plane.operator()
        return self._with(operator, **numbers)

    @overload
    def translate(self: M, offset: Vector) -> M: ...
    @overload
    def translate(self: M, x: Number, y: Number, z: Number = ..., /) -> M: ...
    @overload
    def translate(self: M, *, x: Number = ..., y: Number = ..., z: Number = ...) -> M: ...
    def translate(self: M, *offset: Any, **parts: Any) -> M:
        """Move: ``translate(1, 0, 0)``, ``translate((1, 0, 0))`` or ``translate(x=1)``."""
        return self._with(placing.TRANSLATE, *offset, **parts)

    @overload
    def scale(self: M, factor: Number | Vector, /) -> M: ...
    @overload
    def scale(self: M, x: Number, y: Number, z: Number = ..., /) -> M: ...
    @overload
    def scale(self: M, *, x: Number = ..., y: Number = ..., z: Number = ...) -> M: ...
    def scale(self: M, *factors: Any, **parts: Any) -> M:
        """Scale by one factor, or by one factor for each axis (which loses exactness).

        Plain factors below 0 also reflect: ``scale(-1, 1, 1)`` is ``mirror("x")``.
        """
        unsigned = without_signs(factors, parts, flat=self.flat)
        if unsigned.reflected:
            image = self.mirror(unsigned.reflected)
            if unsigned.uniform is None:
                return image._with(placing.STRETCH, unsigned.values)
            is_image = unsigned.uniform == 1.0
            return image if is_image else image._with(placing.SCALE, unsigned.uniform)
        if len(factors) == 1 and not parts and is_scalar(factors[0]):
            return self._with(placing.SCALE, *factors)
        return self._with(placing.STRETCH, *factors, **parts)

    @refuses_unknown
    def mirror(
        self: M, axes: str | None = None, offset: Number = 0.0, *, across: Vector | None = None
    ) -> M:
        """Reflect: ``mirror("x")`` swaps left and right; ``mirror(across=normal, offset=0.5)``.

        It is the mirror image alone; ``symmetry`` keeps one half and copies it over. Exact. On a
        flat shape, planes are lines.

        Args:
            axes: The axis that is reversed, "x", "y" or "z"; of several, each is.
            offset: Distance of the plane from the origin, along the axis or the normal.
            across: The normal of any other plane, of length 1.

        Raises:
            SceneValueError: The arguments name neither an axis nor a plane, or both.
        """
        return self._at_plane("mirror", axes, offset, across)


class MovableSolid(Movable):
    """An object with the methods that place solids."""

    __slots__ = ()

    def rotate(
        self: M,
        angle: Number | None = None,
        axis: Vector | None = None,
        *,
        x: Number | None = None,
        y: Number | None = None,
        z: Number | None = None,
        quaternion: Vector | None = None,
        matrix: Sequence[Vector] | ArrayLike | None = None,
    ) -> M:
        """Rotate about the origin, given in exactly one of four ways; angles in radians.

        Args:
            angle: Angle about ``axis``.
            axis: Axis of the rotation, of length 1.
            x: Angle about the fixed x axis, applied first.
            y: Angle about the fixed y axis, applied second.
            z: Angle about the fixed z axis, applied last.
            quaternion: (x, y, z, w), of length 1.
            matrix: Rotation matrix: three rows, orthonormal.

        Raises:
            SceneValueError: No rotation is given, or more than one.
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
            columns = _columns(matrix)
            refuse_mirrored(columns, author_place())
            return self._with(placing.ROTATE_MATRIX, *columns)
        if axis is None or angle is None:
            refuse(
                "a rotation needs an angle and an axis",
                "rotate(y=0.5), or rotate(0.5, axis=(0, 1, 0))",
                author_place(),
            )
        return self._with(placing.ROTATE, axis=axis, angle=angle)

    def transform(self: M, matrix: Sequence[Sequence[float]] | ArrayLike) -> M:
        """Place by an affine matrix: rotate, scale, shear, mirror and move in one step.

        Exact if the matrix keeps all angles, mirrored or not. Else distances are lower bounds: they
        are multiplied by the smallest factor by which the matrix stretches.

        Args:
            matrix: Three rows of four numbers, or four with (0, 0, 0, 1) as the last: the first
                three columns are the images of the axes, the last one that of the origin.

        Raises:
            SceneValueError: The matrix has another shape or last row, a number is not finite, or it
                flattens the shape.
            SceneTypeError: A number is none, or a parameter.
        """
        place = author_place()
        parts = affine_parts(matrix, place)
        there = self
        for operator, numbers in parts:
            there = there._with(operator, *numbers)
        return there

    def orient(self: M, source: Vector, target: Vector | None = None) -> M:
        """Rotate by the smallest angle that maps direction ``source`` to direction ``target``.

        One direction alone is the target of the y axis: ``Cylinder().orient((1, 0, 0))``.
        """
        if target is None:
            source, target = (0.0, 1.0, 0.0), source
        return self._with(placing.ORIENT, source, target)


def _columns(matrix: Any) -> tuple[Any, ...]:
    try:
        rows = [tuple(row) for row in matrix]
        return tuple(zip(*rows, strict=True))
    except (TypeError, ValueError):
        refuse("a rotation's matrix has three rows of three numbers", None, author_place())
