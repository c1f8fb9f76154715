"""Deep trees made shallow: chains of placements become one placement, nested unions one union.

Input: a tree, such as a turtle's, that moves and turns all that it has drawn so far with each step.
Output: a tree of the same shape, whose depth does not grow with the number of steps. Translations,
rotations, scales, mirror images and symmetries of constant numbers are folded to one row of planes
of symmetry, one translation, one rotation and one scale; those of a union become those of its
members. Values agree within rounding, so trees that are not deep remain as the author wrote them.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, TypeAlias

from distal.diagnostics import Span
from distal.fields.combine.blends import UNION_BLENDS
from distal.fields.combine.joins import UNION
from distal.fields.place import flat as in_plane
from distal.fields.place import mirrors, solid
from distal.ir.types import FLOAT, VEC2, VEC3
from distal.lang.resources import Buffer
from distal.scene.tree.conversion import Number
from distal.scene.tree.errors import refuse
from distal.scene.tree.node import Node

Vector: TypeAlias = tuple[float, ...]

# Trees are folded when they become this deep, and again each time they have grown by _STEP.
FOLDED_FROM: Final = 64
_STEP: Final = 32
# One call of a method may add several operators: a tree is looked at this often in each step.
_LOOKS: Final = 3
# The largest depth of a tree that cannot be folded. Lowering takes some of Python's frames for each
# operator, and some of them lie on the thread's stack: 1 MB is enough for twice as many.
MOST_NESTED: Final = 300
_FRAMES: Final = 16
# The most members to which a placement is moved down: below, a tree may share its branches.
_MOST_MEMBERS: Final = 20_000
# Sizes beyond these are not folded: their products would leave the range of 32 bits.
_SMALLEST: Final = 1e-30
_LARGEST: Final = 1e30

_AXES: Final[tuple[Vector, ...]] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True, slots=True)
class FoldedPlacement:
    """A point is folded at each plane in turn, then moved back, turned back and scaled back.

    Attributes:
        right: The image of the x axis under the rotation, which may also reflect.
        up: That of the y axis.
        back: That of the z axis.
        offset: The translation.
        factors: The scale along each axis, before the rotation.
        planes: Normal and offset of each plane of symmetry, the outermost first.
    """

    right: Vector = _AXES[0]
    up: Vector = _AXES[1]
    back: Vector = _AXES[2]
    offset: Vector = (0.0, 0.0, 0.0)
    factors: Vector = (1.0, 1.0, 1.0)
    planes: tuple[Any, ...] = ()

    @property
    def is_uniform(self) -> bool:
        """Whether the scale is the same along all axes."""
        return self.factors[0] == self.factors[1] == self.factors[2]

    def turned(self, v: Vector) -> Vector:
        """Return a vector, rotated."""
        x, y, z = v
        axes = zip(self.right, self.up, self.back, strict=True)
        return tuple(x * r + y * u + z * b for r, u, b in axes)

    def moved(self, offset: Vector) -> FoldedPlacement:
        """Return the placement of what is first translated."""
        scaled = tuple(f * c for f, c in zip(self.factors, offset, strict=True))
        away = self.turned(scaled)
        return replace(self, offset=tuple(a + b for a, b in zip(self.offset, away, strict=True)))

    def rotated(self, columns: Sequence[Vector]) -> FoldedPlacement | None:
        """Return the placement of what is first rotated; None if it is stretched after that."""
        if not self.is_uniform:
            return None
        right, up, back = map(self.turned, columns)
        return replace(self, right=right, up=up, back=back)

    def scaled(self, factors: Vector) -> FoldedPlacement | None:
        """Return the placement of what is first scaled; None if the product is out of range."""
        made = tuple(f * g for f, g in zip(self.factors, factors, strict=True))
        if not _SMALLEST < min(made) <= max(made) < _LARGEST:
            return None
        return replace(self, factors=made)

    def reflected(self, normal: Vector, offset: float) -> FoldedPlacement | None:
        """Return the placement of what is first reflected; None if it is stretched after that."""
        share = 2.0 / sum(c * c for c in normal)
        columns = [
            tuple(a - share * normal[i] * n for a, n in zip(axis, normal, strict=True))
            for i, axis in enumerate(_AXES)
        ]
        away = tuple(share * offset * n for n in normal)
        return self.moved(away).rotated(columns)

    def symmetric(self, normal: Vector, offset: float) -> FoldedPlacement | None:
        """Return the placement of what is first folded; None if it is stretched after that."""
        if not self.is_uniform:
            return None
        way = self.turned(normal)
        away = self.factors[0] * offset + sum(a * b for a, b in zip(way, self.offset, strict=True))
        return replace(self, planes=(self.planes, (*way, away)))

    def of(self, node: Node, place: Span | None) -> Node:
        """Return a shape with this placement."""
        flat = node.flat
        size = 2 if flat else 3
        vector = VEC2 if flat else VEC3

        def under(rule: Any, numbers: Mapping[str, Number]) -> Node:
            return Node(rule, flat, (node,), numbers, place=place)

        if not self.is_uniform:
            factors = Number(vector, self.factors[:size])
            node = under(in_plane.STRETCH_FLAT if flat else solid.STRETCH, {"factors": factors})
        elif self.factors[0] != 1.0:
            factor = Number(FLOAT, self.factors[0])
            node = under(in_plane.SCALE_FLAT if flat else solid.SCALE, {"factor": factor})
        if (self.right, self.up, self.back) != _AXES:
            if flat:
                if self.right[0] * self.up[1] < self.right[1] * self.up[0]:
                    axes = {"x": False, "y": True}
                    node = Node(in_plane.REFLECT_FLAT, flat, (node,), constants=axes, place=place)
                angle = Number(FLOAT, math.atan2(self.right[1], self.right[0]))
                node = under(in_plane.ROTATE_FLAT, {"angle": angle})
            else:
                columns = {"right": self.right, "up": self.up, "back": self.back}
                numbers = {name: Number(VEC3, axis) for name, axis in columns.items()}
                node = under(solid.ROTATE_MATRIX, numbers)
        if any(self.offset):
            offset = Number(vector, self.offset[:size])
            node = under(in_plane.TRANSLATE_FLAT if flat else solid.TRANSLATE, {"offset": offset})
        if self.planes:
            rule = mirrors.SYMMETRY_PLANES_FLAT if flat else mirrors.SYMMETRY_PLANES
            planes = Buffer(_unlinked(self.planes))
            node = Node(rule, flat, (node,), constants={"planes": planes}, place=place)
        return node


def _unlinked(planes: tuple[Any, ...]) -> list[Vector]:
    """Return the planes of a linked list, the outermost first."""
    found = []
    while planes:
        planes, plane = planes
        found.append(plane)
    return found[::-1]


def shallow(node: Node) -> Node:
    """Return a tree whose depth is limited: the given one, unless it is deep.

    Raises:
        SceneValueError: It is too deep, and its operators cannot be folded.
    """
    if node.nesting < FOLDED_FROM:
        return node
    # Lowering descends by recursion. A limit that is too high only delays an error.
    frames = 1000 + _FRAMES * min(node.nesting, MOST_NESTED)
    if sys.getrecursionlimit() < frames:
        sys.setrecursionlimit(frames)
    if node.nesting % _STEP < _LOOKS:
        node = _folded(node, {})
    deep = _operators(node) if node.nesting > MOST_NESTED else 0
    if deep > MOST_NESTED:
        refuse(
            f"this {node.name} is the last of {deep} operators, each on the result of the one "
            f"before; at most {MOST_NESTED} are possible",
            "unite shapes that are placed each by itself; moves, rotations, scales, mirror images "
            "and symmetries by constant numbers, and unions, are not counted",
            node.place,
        )
    return node


def _operators(node: Node) -> int:
    """Return how many operators are below each other, without unions: chains of them are flat."""
    count = 0
    while node.children:
        count += not (node.rule is UNION or node.rule in UNION_BLENDS)
        node = max(node.children, key=lambda child: child.nesting)
    return count


def _folded(root: Node, known: dict[int, Node]) -> Node:
    """Return a tree with its placements and unions folded.

    Args:
        root: The tree.
        known: What is folded already, by the id of its root.
    """
    if root.nesting < _STEP:
        return root
    found = known.get(id(root))
    if found is not None:
        return found
    spreads = root.parts <= _MOST_MEMBERS
    members: list[Node] = []
    stack: list[tuple[Node, FoldedPlacement, Span | None]] = [(root, FoldedPlacement(), root.place)]
    while stack:
        node, placement, place = stack.pop()
        is_bare = node is root or not (node.material or node.cut_material or node.label)
        if is_bare and node.rule is UNION and (spreads or len(node.children) == 1):
            stack.extend((child, placement, place) for child in reversed(node.children))
            continue
        step = _STEPS.get(node.rule) if is_bare and _is_constant(node) else None
        inner = step(placement, node) if step else None
        if inner is not None:
            stack.append((node.children[0], inner, node.place))
            continue
        if node.children and node.nesting >= _STEP:
            children = tuple(_folded(child, known) for child in node.children)
            if any(new is not old for new, old in zip(children, node.children, strict=True)):
                node = replace(node, children=children)
        members.append(placement.of(node, place))
    made = members[0]
    if len(members) > 1:
        made = Node(UNION, root.flat, tuple(members), place=root.place)
    if root.material or root.cut_material or root.label:
        made = replace(
            made,
            material=root.material or made.material,
            cut_material=root.cut_material or made.cut_material,
            label=root.label or made.label,
        )
    known[id(root)] = made
    return made


def _is_constant(node: Node) -> bool:
    return all(number.plain is not None for number in node.numbers.values()) and all(
        isinstance(value, bool | Buffer) for value in node.constants.values()
    )


# What each operator does to a placement.


def _vector(node: Node, name: str) -> Vector:
    plain = node.numbers[name].plain
    assert isinstance(plain, tuple)
    return (*plain, 0.0) if len(plain) == 2 else plain


def _number(node: Node, name: str) -> float:
    plain = node.numbers[name].plain
    assert isinstance(plain, float | int)
    return float(plain)


def _about(axis: Vector, angle: float) -> tuple[Vector, ...]:
    """Return the columns of a rotation (Rodrigues)."""
    c, s = math.cos(angle), math.sin(angle)
    x, y, z = axis
    t = 1.0 - c
    return (
        (t * x * x + c, t * x * y + s * z, t * x * z - s * y),
        (t * x * y - s * z, t * y * y + c, t * y * z + s * x),
        (t * x * z + s * y, t * y * z - s * x, t * z * z + c),
    )


def _turn(axis: Vector) -> Callable[[FoldedPlacement, Node], FoldedPlacement | None]:
    return lambda placed, node: placed.rotated(_about(axis, _number(node, "angle")))


def _turn_axis(placed: FoldedPlacement, node: Node) -> FoldedPlacement | None:
    return placed.rotated(_about(_vector(node, "axis"), _number(node, "angle")))


def _turn_euler(placed: FoldedPlacement, node: Node) -> FoldedPlacement | None:
    angles = _vector(node, "angles")
    made: FoldedPlacement | None = placed
    for axis in (2, 1, 0):  # the rotation about x is applied first
        made = made and made.rotated(_about(_AXES[axis], angles[axis]))
    return made


def _turn_quaternion(placed: FoldedPlacement, node: Node) -> FoldedPlacement | None:
    x, y, z, w = _vector(node, "quaternion")
    size = math.hypot(x, y, z)
    axis = (x / size, y / size, z / size) if size else _AXES[0]
    return placed.rotated(_about(axis, 2.0 * math.atan2(size, w)))


def _turn_matrix(placed: FoldedPlacement, node: Node) -> FoldedPlacement | None:
    return placed.rotated([_vector(node, name) for name in ("right", "up", "back")])


def _scale(placed: FoldedPlacement, node: Node) -> FoldedPlacement | None:
    return placed.scaled((_number(node, "factor"),) * 3)


def _stretch(placed: FoldedPlacement, node: Node) -> FoldedPlacement | None:
    factors = _vector(node, "factors")
    return placed.scaled((*factors[:2], factors[0]) if node.flat else factors)


def _reflect_across(placed: FoldedPlacement, node: Node) -> FoldedPlacement | None:
    return placed.reflected(_vector(node, "across"), _number(node, "offset"))


def _reflect(placed: FoldedPlacement, node: Node) -> FoldedPlacement | None:
    made: FoldedPlacement | None = placed
    for axis in _chosen(node):
        made = made and made.reflected(axis, 0.0)
    return made


def _symmetry_across(placed: FoldedPlacement, node: Node) -> FoldedPlacement | None:
    return placed.symmetric(_vector(node, "across"), _number(node, "offset"))


def _symmetry_planes(placed: FoldedPlacement, node: Node) -> FoldedPlacement | None:
    made: FoldedPlacement | None = placed
    for x, y, z, offset in node.constants["planes"].data:
        made = made and made.symmetric((x, y, z), offset)
    return made


def _symmetry(placed: FoldedPlacement, node: Node) -> FoldedPlacement | None:
    made: FoldedPlacement | None = placed
    for axis in _chosen(node):
        made = made and made.symmetric(axis, 0.0)
    return made


def _chosen(node: Node) -> list[Vector]:
    """Return the axes that an operator names by a choice for each."""
    named = zip("xyz", _AXES, strict=True)
    return [axis for name, axis in named if node.constants.get(name, False)]


def _move(placed: FoldedPlacement, node: Node) -> FoldedPlacement:
    return placed.moved(_vector(node, "offset"))


_STEPS: Final[Mapping[Any, Callable[[FoldedPlacement, Node], FoldedPlacement | None]]] = {
    solid.TRANSLATE: _move,
    solid.ROTATE: _turn_axis,
    solid.ROTATE_X: _turn(_AXES[0]),
    solid.ROTATE_Y: _turn(_AXES[1]),
    solid.ROTATE_Z: _turn(_AXES[2]),
    solid.ROTATE_EULER: _turn_euler,
    solid.ROTATE_QUATERNION: _turn_quaternion,
    solid.ROTATE_MATRIX: _turn_matrix,
    solid.SCALE: _scale,
    solid.STRETCH: _stretch,
    mirrors.REFLECT: _reflect,
    mirrors.REFLECT_ACROSS: _reflect_across,
    mirrors.SYMMETRY: _symmetry,
    mirrors.SYMMETRY_ACROSS: _symmetry_across,
    mirrors.SYMMETRY_PLANES: _symmetry_planes,
    in_plane.TRANSLATE_FLAT: _move,
    in_plane.ROTATE_FLAT: _turn(_AXES[2]),
    in_plane.SCALE_FLAT: _scale,
    in_plane.STRETCH_FLAT: _stretch,
    in_plane.REFLECT_FLAT: _reflect,
    in_plane.REFLECT_ACROSS_FLAT: _reflect_across,
    in_plane.SYMMETRY_FLAT: _symmetry,
    in_plane.SYMMETRY_ACROSS_FLAT: _symmetry_across,
    mirrors.SYMMETRY_PLANES_FLAT: _symmetry_planes,
}
