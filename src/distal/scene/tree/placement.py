"""What operators of placement do to points, directions and lengths, forwards.

Input: an operator of the field library and its numbers, plain or expressions. Output: an
``AffinePlacement``, which moves what is no shape, such as a light, and replaces chains of operators
(``scene.lowering.nesting``).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, TypeAlias

from distal.fields.guarantees import Operator
from distal.fields.place import flat as in_plane
from distal.fields.place import mirrors, solid
from distal.lang import cos, inversesqrt, pow, sin
from distal.render.declarations import Move
from distal.scene.tree.conversion import Number

# Floats, or expressions.
Vector: TypeAlias = tuple[Any, ...]
Numbers: TypeAlias = Mapping[str, Number]
Constants: TypeAlias = Mapping[str, Any]

# Sizes beyond these are not combined: their products would leave the range of 32 bits.
_SMALLEST: Final = 1e-30
_LARGEST: Final = 1e30
# Below this share of its length, a sum of two opposite directions has no direction.
_OPPOSITE: Final = 1e-6

AXES: Final[tuple[Vector, ...]] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True, slots=True)
class AffinePlacement:
    """A point is scaled, turned and translated; then planes of symmetry repeat it.

    Attributes:
        right: The image of the x axis under the rotation, which may also reflect.
        up: That of the y axis.
        back: That of the z axis.
        offset: The translation.
        factors: The scale along each axis, before the rotation.
        planes: Normal and offset of each plane of symmetry, the outermost first.
        reflects: Whether the rotation also reflects.
    """

    right: Vector = AXES[0]
    up: Vector = AXES[1]
    back: Vector = AXES[2]
    offset: Vector = (0.0, 0.0, 0.0)
    factors: Vector = (1.0, 1.0, 1.0)
    planes: tuple[Any, ...] = ()
    reflects: bool = False

    @property
    def is_uniform(self) -> bool:
        """Whether the scale is the same along all axes."""
        a, b, c = self.factors
        return (a is b and b is c) or (_is_plain(self.factors) and a == b == c)

    def turned(self, v: Vector) -> Vector:
        """Return a vector, rotated."""
        r, u, b = self.right, self.up, self.back
        return (
            dot(v, (r[0], u[0], b[0])),
            dot(v, (r[1], u[1], b[1])),
            dot(v, (r[2], u[2], b[2])),
        )

    def argument(self, move: Move, value: Any) -> Any:
        """Return an argument of an object that is placed.

        Args:
            move: How arguments of this kind move.
            value: The argument: a number, a vector, a bool, or an expression.
        """
        match move:
            case Move.POSITION:
                there = self.turned(_products(self.factors, value))
                return _sums(there, self.offset)
            case Move.DIRECTION:
                return self.turned(value if self.is_uniform else _products(self.factors, value))
            case Move.LENGTH:
                x, y, z = self.factors
                return _product(x if self.is_uniform else pow(x * y * z, 1.0 / 3.0), value)
            case Move.SIDE:
                return value != self.reflects

    def moved(self, offset: Vector) -> AffinePlacement:
        """Return the placement of what is first translated."""
        away = self.turned(_products(self.factors, offset))
        return replace(self, offset=_sums(self.offset, away))

    def rotated(self, columns: Sequence[Vector]) -> AffinePlacement | None:
        """Return the placement of what is first rotated; None if it is stretched after that."""
        if not self.is_uniform:
            return None
        right, up, back = map(self.turned, columns)
        return replace(self, right=right, up=up, back=back)

    def scaled(self, factors: Vector) -> AffinePlacement | None:
        """Return the placement of what is first scaled; None if the product is out of range."""
        scales = _products(self.factors, factors)
        if _is_plain(scales) and not _SMALLEST < min(scales) <= max(scales) < _LARGEST:
            return None
        return replace(self, factors=scales)

    def reflected(self, normal: Vector, offset: Any) -> AffinePlacement | None:
        """Return the placement of what is first reflected; None if it is stretched after that."""
        share = 2.0 / dot(normal, normal)
        columns = [
            tuple(a - share * normal[i] * n for a, n in zip(axis, normal, strict=True))
            for i, axis in enumerate(AXES)
        ]
        image = self.moved(tuple(share * offset * n for n in normal)).rotated(columns)
        return image and replace(image, reflects=not self.reflects)

    def symmetric(self, normal: Vector, offset: float) -> AffinePlacement | None:
        """Return the placement of what is first folded; None if it is stretched after that."""
        if not self.is_uniform:
            return None
        way = self.turned(normal)
        away = self.factors[0] * offset + dot(way, self.offset)
        return replace(self, planes=(self.planes, (*way, away)))


def is_placement(rule: Any) -> bool:
    """Return whether an operator places its shape: what it does to a union it does to each part."""
    return rule in _STEPS


def placement_of(
    operator: Operator,
    numbers: Numbers,
    constants: Constants,
    before: AffinePlacement = AffinePlacement(),
) -> AffinePlacement | None:
    """Return the placement of what an operator places, and then another placement.

    Args:
        operator: The operator.
        numbers: Its numbers.
        constants: Its other arguments.
        before: The placement of the operator's result.

    Returns:
        The placement; None if it is none: the operator is another one, or a scale and a rotation
        of ``before`` do not go together with it.
    """
    step = _STEPS.get(operator)
    return step(before, _Arguments(numbers, constants)) if step else None


# Arithmetic of floats and expressions. Terms with a plain 0 and factors of a plain 1 are left out,
# so that expressions stay short.


def dot(a: Vector, b: Vector) -> Any:
    """Return the sum of the products of components."""
    x, y, z = a
    u, v, w = b
    total = x * u + y * v + z * w
    if type(total) is float:
        return total
    return _sum(_sum(_product(u, x), _product(v, y)), _product(w, z))


def _products(a: Vector, b: Any) -> Vector:
    x, y, z = a
    u, v, w = b
    plain = x * u, y * v, z * w
    return plain if _is_plain(plain) else (_product(x, u), _product(y, v), _product(z, w))


def _sums(a: Vector, b: Vector) -> Vector:
    x, y, z = a
    u, v, w = b
    plain = x + u, y + v, z + w
    return plain if _is_plain(plain) else (_sum(x, u), _sum(y, v), _sum(z, w))


def _product(a: Any, b: Any) -> Any:
    if type(a) is float and type(b) is not float:
        a, b = b, a
    if type(b) is float and type(a) is not float and b in (0.0, 1.0):
        return a if b else 0.0
    return a * b


def _sum(a: Any, b: Any) -> Any:
    if type(a) is float and type(b) is not float:
        a, b = b, a
    return a if type(b) is float and type(a) is not float and b == 0.0 else a + b


def _is_plain(vector: Vector) -> bool:
    x, y, z = vector
    return type(x) is type(y) is type(z) is float


# What each operator does to a placement.


class _Arguments:
    """The arguments of an operator as floats and expressions."""

    def __init__(self, numbers: Numbers, constants: Constants) -> None:
        self.numbers, self.constants = numbers, constants

    def vector(self, name: str, third: int | None = None) -> Vector:
        """Return the components of a vector.

        Args:
            name: Its name.
            third: Which component of a flat vector is also its third; None: it is 0.
        """
        values: Any = self.numbers[name].value
        x, y, *others = values
        return (x, y, *(others or [0.0 if third is None else (x, y)[third]]))

    def number(self, name: str) -> Any:
        """Return a number."""
        return self.numbers[name].value

    @property
    def axes(self) -> list[Vector]:
        """The axes that the operator names by a choice for each."""
        named = zip("xyz", AXES, strict=True)
        return [axis for name, axis in named if self.constants.get(name, False)]


def _about(axis: Vector, angle: Any) -> tuple[Vector, ...]:
    """Return the columns of a rotation (Rodrigues)."""
    is_plain = type(angle) is float
    c, s = (math.cos(angle), math.sin(angle)) if is_plain else (cos(angle), sin(angle))
    t = 1.0 - c
    across = [[_product(t, a * b) for b in axis] for a in axis]
    sx, sy, sz = (_product(s, component) for component in axis)
    return (
        (_sum(across[0][0], c), _sum(across[0][1], sz), _sum(across[0][2], -sy)),
        (_sum(across[1][0], -sz), _sum(across[1][1], c), _sum(across[1][2], sx)),
        (_sum(across[2][0], sy), _sum(across[2][1], -sx), _sum(across[2][2], c)),
    )


def _turn(axis: Vector) -> Callable[[AffinePlacement, _Arguments], AffinePlacement | None]:
    return lambda placed, given: placed.rotated(_about(axis, given.number("angle")))


def _turn_axis(placed: AffinePlacement, given: _Arguments) -> AffinePlacement | None:
    return placed.rotated(_about(given.vector("axis"), given.number("angle")))


def _turn_euler(placed: AffinePlacement, given: _Arguments) -> AffinePlacement | None:
    angles = given.vector("angles")
    made: AffinePlacement | None = placed
    for axis in (2, 1, 0):  # the rotation about x is applied first
        made = made and made.rotated(_about(AXES[axis], angles[axis]))
    return made


def _turn_quaternion(placed: AffinePlacement, given: _Arguments) -> AffinePlacement | None:
    x, y, z, w = given.vector("quaternion")
    columns = (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
        (2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)),
        (2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)),
    )
    return placed.rotated(columns)


def _turn_matrix(placed: AffinePlacement, given: _Arguments) -> AffinePlacement | None:
    right, up, back = (given.vector(name) for name in ("right", "up", "back"))
    image = placed.rotated([right, up, back])
    if image is None or not all(map(_is_plain, (right, up, back))):
        return image  # ``rotate`` refuses mirror images, and ``transform`` expressions
    across = (
        right[1] * up[2] - right[2] * up[1],
        right[2] * up[0] - right[0] * up[2],
        right[0] * up[1] - right[1] * up[0],
    )
    return replace(image, reflects=placed.reflects != (dot(across, back) < 0.0))


def _orient(placed: AffinePlacement, given: _Arguments) -> AffinePlacement | None:
    """Reflect a direction to its opposite, then that to the other direction."""
    source, target = (_unit(given.vector(name)) for name in ("source", "target"))
    between = _sums(source, target)
    if _is_plain(between) and math.hypot(*between) < _OPPOSITE:
        x, y, z = source
        between = (-y, x, 0.0) if abs(z) < 0.7 else (0.0, -z, y)
    image = placed.reflected(between, 0.0)
    return image and image.reflected(source, 0.0)


def _unit(v: Vector) -> Vector:
    share = inversesqrt(dot(v, v))
    return tuple(share * component for component in v)


def _scale(placed: AffinePlacement, given: _Arguments) -> AffinePlacement | None:
    return placed.scaled((given.number("factor"),) * 3)


def _stretch(placed: AffinePlacement, given: _Arguments) -> AffinePlacement | None:
    factors = given.vector("factors", third=0)
    return placed.scaled(factors)


def _reflect_across(placed: AffinePlacement, given: _Arguments) -> AffinePlacement | None:
    return placed.reflected(given.vector("across"), given.number("offset"))


def _reflect(placed: AffinePlacement, given: _Arguments) -> AffinePlacement | None:
    made: AffinePlacement | None = placed
    for axis in given.axes:
        made = made and made.reflected(axis, 0.0)
    return made


def _symmetry_across(placed: AffinePlacement, given: _Arguments) -> AffinePlacement | None:
    return placed.symmetric(given.vector("across"), given.number("offset"))


def _symmetry_planes(placed: AffinePlacement, given: _Arguments) -> AffinePlacement | None:
    made: AffinePlacement | None = placed
    for x, y, z, offset in given.constants["planes"].data:
        made = made and made.symmetric((x, y, z), offset)
    return made


def _symmetry(placed: AffinePlacement, given: _Arguments) -> AffinePlacement | None:
    made: AffinePlacement | None = placed
    for axis in given.axes:
        made = made and made.symmetric(axis, 0.0)
    return made


def _move(placed: AffinePlacement, given: _Arguments) -> AffinePlacement:
    return placed.moved(given.vector("offset"))


_STEPS: Final[Mapping[Any, Callable[[AffinePlacement, _Arguments], AffinePlacement | None]]] = {
    solid.TRANSLATE: _move,
    solid.ROTATE: _turn_axis,
    solid.ROTATE_X: _turn(AXES[0]),
    solid.ROTATE_Y: _turn(AXES[1]),
    solid.ROTATE_Z: _turn(AXES[2]),
    solid.ROTATE_EULER: _turn_euler,
    solid.ROTATE_QUATERNION: _turn_quaternion,
    solid.ROTATE_MATRIX: _turn_matrix,
    solid.ORIENT: _orient,
    solid.SCALE: _scale,
    solid.STRETCH: _stretch,
    mirrors.REFLECT: _reflect,
    mirrors.REFLECT_ACROSS: _reflect_across,
    mirrors.SYMMETRY: _symmetry,
    mirrors.SYMMETRY_ACROSS: _symmetry_across,
    mirrors.SYMMETRY_PLANES: _symmetry_planes,
    in_plane.TRANSLATE_FLAT: _move,
    in_plane.ROTATE_FLAT: _turn(AXES[2]),
    in_plane.SCALE_FLAT: _scale,
    in_plane.STRETCH_FLAT: _stretch,
    in_plane.REFLECT_FLAT: _reflect,
    in_plane.REFLECT_ACROSS_FLAT: _reflect_across,
    in_plane.SYMMETRY_FLAT: _symmetry,
    in_plane.SYMMETRY_ACROSS_FLAT: _symmetry_across,
    mirrors.SYMMETRY_PLANES_FLAT: _symmetry_planes,
}
