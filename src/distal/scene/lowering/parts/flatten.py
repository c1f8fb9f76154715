"""The parts of a union: its members, with what is above them moved into them.

Input: a tree. Output: trees whose union is the same shape with the same materials, in the author's
order. Moves, rotations and uniform scales of a union become those of each member, and a union's
material that of each member. A repetition at given positions is a union of its copies.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final

from distal.fields.combine.alternatives import NOTHING, NOTHINGS, SELECT
from distal.fields.combine.joins import UNION
from distal.fields.deform.offsets import OFFSET, ROUND, SECTION
from distal.fields.guarantees import Guarantee, Operator, Primitive
from distal.fields.place.flat import SCALE_FLAT
from distal.fields.place.solid import SCALE, TRANSLATE
from distal.fields.repeat.along import REPEAT_AT
from distal.ir.types import VEC3
from distal.scene.tree.arguments import slots_of
from distal.scene.tree.conversion import Number
from distal.scene.tree.node import Node
from distal.scene.tree.varying import varied_in

# The fewest copies of a repetition that are parts of their own.
LEAST_COPIES: Final = 16
CELL: Final = "cell"
# Operators that change the values of a shape by a function that never decreases.
RISING: Final = frozenset((SCALE, SCALE_FLAT, ROUND, OFFSET, SECTION))


@dataclass(frozen=True, slots=True)
class UnionMember:
    """A member of the unions at the root of a tree.

    Attributes:
        part: The member with what is above it.
        source: The member itself, a node of the author's tree.
        repetition: The repetition that the part is a copy of, with what is above it.
    """

    part: Node
    source: Node
    repetition: Node | None = None


def members_of(root: Node) -> list[UnionMember]:
    """Return the members of the unions at the root of a tree."""
    found: list[UnionMember] = []
    stack: list[tuple[Node, Callable[[Node], Node]]] = [(root, _unchanged)]
    while stack:
        node, above = stack.pop()
        if node.rule is NOTHING:
            continue
        if node.rule is UNION:
            inner = _painted(node, above)
            stack.extend((child, inner) for child in reversed(node.children))
        elif _selects_many(node):
            stack.extend((node.children[i], _selected(node, i, above)) for i in (1, 0))
        elif _passes(node) and _unites(node):
            stack.append((node.children[0], _wrapped(node, above)))
        elif copies_of(node) > 1:
            whole = above(node)
            found.extend(UnionMember(above(copy), node, whole) for copy in _copies(node))
        else:
            found.append(UnionMember(above(node), node))
    return found


def _selects_many(node: Node) -> bool:
    """Return whether one of two shapes is shown, and their parts are worth a table."""
    return node.rule is SELECT and not node.flat and member_count(node) >= LEAST_COPIES


def _selected(node: Node, index: int, above: Callable[[Node], Node]) -> Callable[[Node], Node]:
    """Return how a member of one of two shapes becomes a part: shown where that shape is.

    Args:
        node: The node that selects one of the two.
        index: Which of them it is.
        above: How the node becomes a part.
    """
    if node.children[index].rule in NOTHINGS:
        return above
    other = Node(NOTHING, False, place=node.place)

    def place(member: Node) -> Node:
        return above(replace(node, children=(other, member) if index else (member, other)))

    return place


def _unchanged(node: Node) -> Node:
    return node


def _painted(union: Node, above: Callable[[Node], Node]) -> Callable[[Node], Node]:
    """Return how a member of a union becomes a part: with the union's material, if it has one."""
    if union.material is None and union.cut_material is None:
        return above

    def place(node: Node) -> Node:
        return above(
            replace(
                node,
                material=union.material or node.material,
                cut_material=union.cut_material or node.cut_material,
            )
        )

    return place


def _wrapped(operator: Node, above: Callable[[Node], Node]) -> Callable[[Node], Node]:
    return lambda node: above(replace(operator, children=(node,)))


def _passes(node: Node) -> bool:
    """Return whether an operator on a union is the union of the operator on its members."""
    return _passes_unions(node.rule) and len(node.children) == 1


@lru_cache(maxsize=1024)
def _passes_unions(rule: Primitive | Operator) -> bool:
    if not isinstance(rule, Operator) or rule.around is not None:
        return False
    moves_only = rule.slope is None and rule.finish is None and not rule.repeats
    return rule in RISING or (moves_only and Guarantee.LOWER_BOUND in rule.keeps)


def _unites(node: Node) -> bool:
    """Return whether there is a union below operators that pass it on."""
    inner = node.children[0]
    while _passes(inner):
        inner = inner.children[0]
    return inner.rule is UNION or copies_of(inner) > 1


def member_count(root: Node) -> int:
    """Return about how many parts a tree has: its own, and the copies of repetitions."""
    return root.derived("member count", lambda: _member_count(root))


def _member_count(root: Node) -> int:
    count, stack = root.parts, [root]
    while stack:
        node = stack.pop()
        if node.rule in (UNION, SELECT) or _passes(node):
            stack.extend(node.children)
        else:
            count += copies_of(node) - 1
    return count


def copies_of(node: Node) -> int:
    """Return how many copies a repetition has that may be parts of their own; 1 for other nodes.

    The copies differ if something in them reads the index of the repetition.
    """
    if node.rule is not REPEAT_AT:
        return 1
    count = len(node.constants["positions"].data)
    return 1 if count < LEAST_COPIES or reads_cell(node.children[0]) else count


def reads_cell(root: Node) -> bool:
    """Return whether a tree reads the index of a repetition."""
    if varied_in(root):
        return True
    materials = (m for n in root.walk() for m in (n.material, n.cut_material) if m is not None)
    return any(CELL in material.uses for material in materials) or any(
        slot.name == CELL for function in root.functions() for slot in slots_of(function)
    )


def _copies(repetition: Node) -> Iterator[Node]:
    """Yield the copies of a repetition, each moved by itself."""
    positions = repetition.constants["positions"].data
    for position in positions:
        offset = Number(VEC3, tuple(map(float, position)))
        yield replace(repetition, rule=TRANSLATE, constants={}, numbers={"offset": offset})
