"""A tree of shapes as leaves and a program that joins their values.

Input: a tree. Output: its leaves, with what is above them moved into them, and steps in postfix
order that compute the tree's value from those of the leaves; and the subtrees that are one leaf
although they join shapes, with the reason. ``joins`` says which operators become steps.

The program's value is that of the tree, up to rounding; below a deformation only its sign and its
surface are. Materials follow the same steps: each leaf has the material that it shows there, also
the ``cut_material`` of what is subtracted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, TypeAlias

from distal.fields.combine.alternatives import NOTHINGS
from distal.fields.combine.joins import CLEARANCE, COMPLEMENT, UNION
from distal.fields.guarantees import ENDLESS, PRIMITIVES
from distal.scene.lowering.known_bounds import known_bounds_of
from distal.scene.lowering.parts.flatten import UnionMember, _copies, copies_of
from distal.scene.lowering.parts.kinds import moves_itself
from distal.scene.lowering.pieces.joins import (
    DEFORMED,
    HARD_RULES,
    JOINING,
    SCALES,
    SPLITS,
    JoinCode,
    ValueJoin,
    change_of,
    deforms,
    gap_of,
    is_change,
    join_of,
    only_moves,
    varies,
    why_whole,
)
from distal.scene.tree.node import Node

# A member of a hard union of MANY is one leaf if it has at most SMALL_SUBTREE parts: programs would
# cost more than the leaf does.
MANY: Final = 8
SMALL_SUBTREE: Final = 24
# The look of leaves whose material is never shown.
HIDDEN: Final = 0
NORMAL: Final = "its material depends on the normal of the whole shape"
# Steps without a leaf, or without a join.
NONE: Final = -1

_Place: TypeAlias = Callable[[Node], Node]


@dataclass(frozen=True, slots=True)
class PieceStep:
    """A step of a program in postfix order.

    Attributes:
        leaf: The number of the leaf whose value it appends; -1 for other steps.
        join: The number of the join that it applies to the last value or the last two; -1 for
            leaves.
    """

    leaf: int
    join: int


@dataclass(frozen=True, slots=True)
class WholeSubtree:
    """A leaf that joins shapes and is not taken apart.

    Attributes:
        leaf: Its number.
        node: The node of the author's tree.
        reason: Why.
    """

    leaf: int
    node: Node
    reason: str


@dataclass(frozen=True, slots=True)
class PieceProgram:
    """Leaves and steps.

    Attributes:
        leaves: The leaves, in the order of the tree.
        looks: A number for each leaf: equal where leaves show equal materials at equal points.
        steps: The steps.
        joins: What the steps do, each once.
        whole: The leaves that stay whole, and why.
        mover: A node that moves joined shapes by parameters or time; None if there is none.
    """

    leaves: Sequence[UnionMember]
    looks: Sequence[int]
    steps: Sequence[PieceStep]
    joins: Sequence[ValueJoin]
    whole: Sequence[WholeSubtree]
    mover: Node | None = None


@dataclass(frozen=True, slots=True)
class _AboveNode:
    """What is above a node.

    Attributes:
        place: Moves a node below what is above it.
        factor: The scale of what is above; None if it is not fixed.
        look: The look of the outermost material above; None if there is none.
        is_exact: Whether values matter besides signs: what is above blends or moves surfaces.
        is_deformed: Whether a deformation is above: steps must be hard joins.
        is_of_many: Whether it is a member of a hard union of many.
        uses_normal: Whether a material above depends on the normal, that of the whole shape.
        repetition: The repetition that the node is a copy of, with what is above it.
    """

    place: _Place
    factor: float | None = 1.0
    look: int | None = None
    is_exact: bool = False
    is_deformed: bool = False
    is_of_many: bool = False
    uses_normal: bool = False
    repetition: Node | None = None


def program_of(root: Node, *, default_varies: bool = False) -> PieceProgram:
    """Return the program of a tree of solids.

    Args:
        root: The root of the tree.
        default_varies: Whether the material of leaves without one depends on the place.
    """
    return _written(root, _AboveNode(lambda node: node), default_varies=default_varies)


def values_of(root: Node, *, default_varies: bool = False) -> PieceProgram:
    """Return the program of a tree of solids that has its values at any place.

    Deformations of joined shapes are leaves. Arguments as for ``program_of``.
    """
    above = _AboveNode(lambda node: node, is_exact=True)
    return _written(root, above, default_varies=default_varies)


def _written(root: Node, above: _AboveNode, *, default_varies: bool) -> PieceProgram:
    writer = _ProgramWriter(default_varies=default_varies)
    writer.write(root, above)
    joins = list(writer.joins)
    return PieceProgram(
        writer.leaves, writer.looks, writer.steps, joins, writer.whole, writer.mover
    )


class _ProgramWriter:
    """Writes the steps of a tree."""

    def __init__(self, *, default_varies: bool) -> None:
        self.leaves: list[UnionMember] = []
        self.looks: list[int] = []
        self.steps: list[PieceStep] = []
        self.joins: dict[ValueJoin, int] = {}
        self.whole: list[WholeSubtree] = []
        self.mover: Node | None = None
        self._looks: dict[Any, int] = {}
        self._default_varies = default_varies
        self._alive: list[Any] = []  # keys are ids

    def write(self, node: Node, above: _AboveNode) -> None:
        """Append the steps of a node, which leave one value.

        Differences and blends nest in their first operands, often deeply: these are no recursion.
        """
        spine: list[tuple[Node, ValueJoin, _AboveNode]] = []
        reason = ""
        while node.rule in JOINING and node.rule is not UNION and not _is_small(node, above):
            join = self._join(node, above)
            if isinstance(join, str):
                reason = join
                break
            inside = self._inside(node, above)
            if not join.is_hard:
                inside = replace(inside, is_exact=True)
            spine.append((node, join, inside))
            node, above = node.children[0], inside
        self._write_other(node, above, reason)
        for joining, join, inside in reversed(spine):
            for child in joining.children[1:]:
                self._write_operand(joining, join, child, inside)

    def _join(self, node: Node, above: _AboveNode) -> ValueJoin | str:
        if above.uses_normal or _uses_normal(node.material):
            return NORMAL
        join = join_of(node, above.factor)
        if isinstance(join, str):
            return join
        if node.rule is CLEARANCE and isinstance(gap := gap_of(node, above.factor), str):
            return gap
        if above.is_deformed and (not join.is_hard or node.rule is CLEARANCE):
            return DEFORMED
        return join

    def _write_operand(self, node: Node, join: ValueJoin, child: Node, inside: _AboveNode) -> None:
        """Append the steps of an operand of a node but the first, and its join."""
        if join.code is not JoinCode.DIFFERENCE:
            self.write(child, inside)
            self._step(join)
            return
        material = child.cut_material
        shown = node.rule is not CLEARANCE and material is not None
        join = replace(join, shows_cutter=shown)
        inside = self._as_cutter(child, inside) if shown else _hidden(inside)
        if node.rule is CLEARANCE:
            self.write(child, replace(inside, is_exact=True))
            gap = gap_of(node, inside.factor)
            assert isinstance(gap, ValueJoin)
            self._step(gap)
            self._step(join)
            return
        # What is subtracted as a hard union is a chain of differences.
        many = list(self._united(child, inside)) if join.is_hard else [(child, inside)]
        for member, around in many:
            self.write(member, around)
            self._step(join)

    def _as_cutter(self, child: Node, inside: _AboveNode) -> _AboveNode:
        """Return the surroundings of a cutter: it shows its ``cut_material`` alone."""
        material = child.cut_material
        look = inside.look if inside.look is not None else self._look(material, child)
        placed = replace(inside, place=_painted(material, inside.place), look=look)
        return replace(placed, uses_normal=inside.uses_normal or _uses_normal(material))

    def _write_other(self, node: Node, above: _AboveNode, reason: str) -> None:
        """Append the steps of a node that is no join of two, or the node as a leaf.

        Args:
            node: The node.
            above: What is above it.
            reason: Why it stays whole, if that is known.
        """
        if not reason and not _is_small(node, above):
            has_normal = above.uses_normal or _uses_normal(node.material)
            if node.rule is UNION or copies_of(node) > 1:
                self._write_union(list(self._united(node, above)))
                return
            changes = _is_taken_apart(node) and not has_normal
            if node.rule in SPLITS and changes and not above.is_deformed:
                self._write_split(node, above)
                return
            if is_change(node) and changes:
                change = change_of(node, above.factor)
                if above.is_deformed:
                    change = DEFORMED
                if not isinstance(change, str):
                    inside = replace(self._inside(node, above), is_exact=True)
                    self.write(node.children[0], inside)
                    self._step(change)
                    return
                reason = change
            elif (inner := self._below_move(node, above)) is not None:
                self.write(node.children[0], inner)
                return
        if not reason and not _is_small(node, above) and len(node.children) > 0:
            reason = why_whole(node) if _joins(node) else ""
        self._leaf(node, above, reason)

    def _write_union(self, members: Sequence[tuple[Node, _AboveNode]]) -> None:
        """Append the steps of a hard union."""
        exists = [m for m in members if m[0].rule not in NOTHINGS] or members[:1]
        is_many = len(exists) >= MANY
        rule = HARD_RULES[JoinCode.UNION]
        join = ValueJoin(JoinCode.UNION, rule, mix=rule.mix)
        for i, (member, above) in enumerate(exists):
            self.write(member, replace(above, is_of_many=is_many))
            if i:
                self._step(join)

    def _write_split(self, node: Node, above: _AboveNode) -> None:
        """Append a cut by a plane: with a half space that has no material of its own."""
        self.write(node.children[0], self._inside(node, above))
        normal, offset = node.numbers["normal"], node.numbers["offset"]
        numbers = {"normal": normal, "distance": offset}
        plane = Node(PRIMITIVES["HalfSpace"], False, (), numbers, place=node.place)
        self._leaf(plane, _hidden(above), "")
        code = SPLITS[node.rule]  # type: ignore[index]  # an operator
        self._step(ValueJoin(code, HARD_RULES[code], mix=CLEARANCE.mix))

    def _below_move(self, node: Node, above: _AboveNode) -> _AboveNode | None:
        """Return what is above the child of a node that goes into the leaves; None if it stays."""
        rule = node.rule
        if len(node.children) != 1 or not _is_taken_apart(node) or varies(node):
            return None
        if moves_itself(node):
            self.mover = self.mover or node
        inside = self._inside(node, above)
        placed = replace(inside, place=_wrapped(node, above.place))
        if only_moves(rule):
            return placed
        if rule in SCALES:
            factor = node.numbers["factor"].plain
            if above.factor is None or not isinstance(factor, float | int):
                return replace(placed, factor=None)
            return replace(placed, factor=above.factor * factor)
        if deforms(rule) and not above.is_exact and _is_finite(node):
            return replace(placed, is_deformed=True)
        return None

    def _inside(self, node: Node, above: _AboveNode) -> _AboveNode:
        """Return what is above the children of a node that has a material, or has none."""
        inside = replace(above, is_of_many=False, repetition=None)
        if node.material is None:
            return inside
        look = above.look if above.look is not None else self._look(node.material, node)
        uses_normal = above.uses_normal or _uses_normal(node.material)
        place = _painted(node.material, above.place)
        return replace(inside, place=place, look=look, uses_normal=uses_normal)

    def _united(self, node: Node, above: _AboveNode) -> Iterator[tuple[Node, _AboveNode]]:
        """Yield the members of hard unions at the root of a tree."""
        stack = [(node, above)]
        while stack:
            node, above = stack.pop()
            if node.rule is UNION:
                inside = self._inside(node, above)
                stack.extend((child, inside) for child in reversed(node.children))
            elif copies_of(node) > 1:
                inside = replace(self._inside(node, above), repetition=above.place(node))
                yield from ((copy, inside) for copy in _copies(node))
            elif _unites(node) and (inner := self._below_move(node, above)) is not None:
                stack.append((node.children[0], inner))
            else:
                yield node, above

    def _step(self, join: ValueJoin) -> None:
        self.steps.append(PieceStep(NONE, self.joins.setdefault(join, len(self.joins))))

    def _leaf(self, node: Node, above: _AboveNode, reason: str) -> None:
        number = len(self.leaves)
        self.leaves.append(UnionMember(above.place(node), node, above.repetition))
        self.looks.append(self._look_of_leaf(node, above))
        self.steps.append(PieceStep(number, NONE))
        if reason:
            self.whole.append(WholeSubtree(number, node, reason))

    def _look_of_leaf(self, node: Node, above: _AboveNode) -> int:
        if above.look is not None:
            return above.look
        if node.material is not None:
            return self._look(node.material, node)
        materials = any(m is not None for n in node.walk() for m in (n.material, n.cut_material))
        if materials or self._default_varies:
            # A leaf of its own kind: it shows several materials, or one that differs by place.
            return self._new_look((len(self.leaves), "own"))
        return self._new_look("default")

    def _look(self, material: Any, node: Node) -> int:
        """Return the look of a material on a node, in whose space it is computed."""
        self._alive += (material, node)
        return self._new_look((id(material), id(node) if material.uses else 0))

    def _new_look(self, key: Any) -> int:
        return self._looks.setdefault(key, HIDDEN + 1 + len(self._looks))


def _hidden(above: _AboveNode) -> _AboveNode:
    return replace(above, look=HIDDEN)


def _painted(material: Any, place: _Place) -> _Place:
    return lambda node: place(node.with_material(material))


def _wrapped(operator: Node, place: _Place) -> _Place:
    return lambda node: place(replace(operator, children=(node,)))


def _is_small(node: Node, above: _AboveNode) -> bool:
    return above.is_of_many and node.parts <= SMALL_SUBTREE


def _unites(node: Node) -> bool:
    """Return whether there is a hard union below moves."""
    while len(node.children) == 1 and only_moves(node.rule) and copies_of(node) == 1:
        node = node.children[0]
    return node.rule is UNION or copies_of(node) > 1


def _uses_normal(material: Any) -> bool:
    return material is not None and "n" in material.uses


def _is_taken_apart(node: Node) -> bool:
    """Return whether there is a join below moves and changes of one shape."""
    while len(node.children) == 1 and copies_of(node) == 1:
        node = node.children[0]
    return node.rule in JOINING or copies_of(node) > 1


def _joins(node: Node) -> bool:
    """Return whether a tree joins shapes."""
    return any(len(inner.children) > 1 or copies_of(inner) > 1 for inner in node.walk())


def _is_finite(root: Node) -> bool:
    """Return whether all shapes of a tree have finite boxes, so that each can be deformed."""
    if any(node.rule is COMPLEMENT or varies(node) for node in root.walk()):
        return False
    try:
        bounds = [known_bounds_of(node) for node in root.walk()]
    except ImportError:
        return False  # without NumPy
    return all(abs(c) < ENDLESS for b in bounds for c in (*b.low, *b.high))
