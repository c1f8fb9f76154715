"""The operands of a program as a tree of chains, in arrays, for the builder of pieces.

Input: a program, the slopes and growths of its leaves. Output: its nodes in the order of the tree,
parents first. A chain joins any number of operands by one join: ``a - b - c`` is one of three. Its
value is ``turn * min(member_turn * operand, ...)`` for the minimum or its blend, so that unions,
intersections, differences and complements are one case.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.fields.combine.joins import CLEARANCE, COMPLEMENT
from distal.scene.lowering.pieces.joins import JoinCode, ValueJoin
from distal.scene.lowering.pieces.programs import HIDDEN, PieceProgram

Floats = NDArray[np.float64]
Whole = NDArray[np.int64]
Flags = NDArray[np.bool_]

LEAF: Final = 0
CHAIN: Final = 1
CHANGE: Final = 2


@dataclass(slots=True)
class _Operand:
    """A node under construction.

    Attributes:
        kind: LEAF, CHAIN or CHANGE.
        leaf: The number of the leaf, or -1.
        join: How a change changes, or how a chain joins.
        children: The operands.
        joins: The number of the join of each child of a chain; that of the second for the first.
    """

    kind: int
    leaf: int = -1
    join: ValueJoin | None = None
    children: list[_Operand] = field(default_factory=list)
    joins: list[int] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class OperandTree:
    """The nodes, parents first and children in their order.

    Attributes:
        kind: LEAF, CHAIN or CHANGE (n,).
        leaf: The leaf of a node; -1 for others.
        parent: The node above; -1 for the root.
        level: How many nodes are above.
        last: The place of the node in the order in which children come before their parents.
        join: How the node is joined in its chain: a number in ``joins``; -1 for others.
        own_join: How a change changes, or how a chain joins its second operand; -1 for leaves.
        turn: The sign of a chain: -1 for a maximum.
        member_turn: The sign of the node in its chain.
        is_open: Whether the box of a chain is that around its operands (a union).
        width: The width of the blend of a chain.
        settles: Whether a chain of several blends is widened once (``ValueJoin.settles``).
        shift: The shift of a change.
        half: Half of the thickness of a shell; -1 for shifts.
        slope: A bound on the slope of the node.
        growth: A bound on the growth of its sides.
        must_stay: Whether the node is what others are cut from, and shows more than one material:
            it may be dropped only with them.
        shown: For operands that are subtracted: the leaf whose material their faces show if what
            they are cut from is dropped; -1 for their own.
        joins: The joins of the program, and a complement.
        complement: The number of the complement.
    """

    kind: Whole
    leaf: Whole
    parent: Whole
    level: Whole
    last: Whole
    join: Whole
    own_join: Whole
    turn: Floats
    member_turn: Floats
    is_open: Flags
    width: Floats
    settles: Flags
    shift: Floats
    half: Floats
    slope: Floats
    growth: Floats
    must_stay: Flags
    shown: Whole
    joins: Sequence[ValueJoin]
    complement: int


def operand_tree(program: PieceProgram, slopes: Floats, growths: Floats) -> OperandTree:
    """Return the operands of a program.

    Args:
        program: The program.
        slopes: Lipschitz bounds (slopes) of its leaves (n,).
        growths: The growths of the sides of their boxes (n,).
    """
    joins = [*program.joins]
    plain = ValueJoin(JoinCode.COMPLEMENT, COMPLEMENT)
    if plain not in joins:
        joins.append(plain)
    root = _parsed(program)
    order, parents, levels, members = _in_order(root)
    count = len(order)
    last = _children_first(parents, levels)
    made = OperandTree(
        kind=np.array([o.kind for o in order]),
        leaf=np.array([o.leaf for o in order]),
        parent=np.array(parents),
        level=np.array(levels),
        last=last,
        join=np.array(members),
        own_join=np.array([o.joins[0] if o.joins else -1 for o in order]),
        turn=np.array([_turn(o) for o in order]),
        member_turn=np.ones(count),
        is_open=np.array([o.join is not None and o.join.code is JoinCode.UNION for o in order]),
        width=np.array([o.join.width if o.join and o.kind == CHAIN else 0.0 for o in order]),
        settles=np.array([o.join is None or o.join.settles for o in order]),
        shift=np.array([o.join.shift if o.join else 0.0 for o in order]),
        half=np.array(
            [o.join.half if o.join and o.join.code is JoinCode.SHELL else -1.0 for o in order]
        ),
        slope=np.zeros(count),
        growth=np.zeros(count),
        must_stay=np.zeros(count, bool),
        shown=np.full(count, -1),
        joins=joins,
        complement=joins.index(plain),
    )
    number = {id(operand): i for i, operand in enumerate(order)}
    is_leaf = made.leaf >= 0
    made.slope[is_leaf] = slopes[made.leaf[is_leaf]]
    made.growth[is_leaf] = growths[made.leaf[is_leaf]]
    for i in range(count - 1, 0, -1):
        above = parents[i]
        made.slope[above] = max(made.slope[above], made.slope[i])
        made.growth[above] = max(made.growth[above], made.growth[i])
    for operand in order:
        if operand.kind == CHAIN:
            _mark_members(made, operand, [number[id(c)] for c in operand.children], program)
    return made


def _parsed(program: PieceProgram) -> _Operand:
    """Return the root of a program's operands, with one chain for joins that follow each other."""
    stack: list[_Operand] = []
    for step in program.steps:
        if step.leaf >= 0:
            stack.append(_Operand(LEAF, step.leaf))
            continue
        join = program.joins[step.join]
        if not join.code.is_binary:
            kind = CHAIN if join.code is JoinCode.COMPLEMENT else CHANGE
            stack.append(_Operand(kind, -1, join, [stack.pop()], [step.join]))
            continue
        b, a = stack.pop(), stack.pop()
        if a.kind == CHAIN and a.join is not None and _continues(a.join, join):
            a.children.append(b)
            a.joins.append(step.join)
            stack.append(a)
        else:
            stack.append(_Operand(CHAIN, -1, join, [a, b], [step.join, step.join]))
    (root,) = stack
    return root


def _continues(chain: ValueJoin, join: ValueJoin) -> bool:
    """Return whether a join goes on a chain.

    A difference that shows the cutter's material is another than one that keeps that of all before
    it, which may be that of another cutter.
    """
    if (chain.code, chain.rule, chain.numbers) != (join.code, join.rule, join.numbers):
        return False
    shows = chain.shows_cutter == join.shows_cutter and chain.mix is join.mix
    return shows and (join.is_hard or join.settles)


def _in_order(root: _Operand) -> tuple[list[_Operand], list[int], list[int], list[int]]:
    """Return the operands in the order of the tree: with their parents, levels and joins."""
    order: list[_Operand] = []
    parents: list[int] = []
    levels: list[int] = []
    members: list[int] = []
    stack = [(root, -1, 0, -1)]
    while stack:
        operand, parent, level, join = stack.pop()
        me = len(order)
        order.append(operand)
        parents.append(parent)
        levels.append(level)
        members.append(join)
        joins = operand.joins if operand.kind == CHAIN else [-1] * len(operand.children)
        pairs = zip(operand.children, joins, strict=True)
        stack += [(child, me, level + 1, j) for child, j in reversed(list(pairs))]
    return order, parents, levels, members


def _children_first(parents: Sequence[int], levels: Sequence[int]) -> Whole:
    """Return the place of each node in the order in which children come before their parents."""
    size = np.ones(len(parents), np.int64)
    for i in range(len(parents) - 1, 0, -1):
        size[parents[i]] += size[i]
    # Before a node come those below it, and all that come before it but are not above it.
    found: Whole = np.arange(len(parents)) - np.asarray(levels) + size - 1
    return found


def _turn(operand: _Operand) -> float:
    if operand.kind != CHAIN or operand.join is None:
        return 1.0
    return 1.0 if operand.join.code is JoinCode.UNION else -1.0


def _mark_members(
    made: OperandTree, chain: _Operand, numbers: Sequence[int], program: PieceProgram
) -> None:
    """Mark the signs of a chain's operands, and whose materials they show."""
    assert chain.join is not None
    code = chain.join.code
    first, others = numbers[0], numbers[1:]
    if code is JoinCode.INTERSECTION:
        made.member_turn[numbers] = -1.0
    elif code is JoinCode.DIFFERENCE:
        made.member_turn[first] = -1.0
    is_split = chain.join.mix is CLEARANCE.mix
    if code is JoinCode.INTERSECTION:
        made.must_stay[first] = is_split
    if code is not JoinCode.DIFFERENCE or chain.join.shows_cutter:
        return
    leaves = made.leaf[first : _end(made, first)]
    leaves = leaves[leaves >= 0]
    seen = [leaf for leaf in leaves.tolist() if program.looks[leaf] != HIDDEN]
    looks = {program.looks[leaf] for leaf in seen}
    made.must_stay[first] = len(leaves) > 1 if is_split else len(looks) > 1
    made.shown[others] = seen[0] if seen else int(leaves[0])


def _end(made: OperandTree, node: int) -> int:
    """Return the number after the last node below a node."""
    # Those below a node come right after it: as many as come before it in the other order.
    return int(made.last[node] + made.level[node]) + 1
