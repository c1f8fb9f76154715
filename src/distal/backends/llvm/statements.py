"""Write statements under lane masks.

Input: predicated blocks. Output: instructions; the environment contains each local's value. Locals
are SSA values: after a varying condition, each lane of a Var is selected from the two sides. So
inside a side only memory accesses, calls and tests for active lanes need a mask.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import assert_never

from distal.backends.llvm.expressions import LaneExpressions
from distal.backends.llvm.lanes import Leaf, Leaves, Stored, field_offset
from distal.backends.llvm.loops import Loops
from distal.backends.llvm.uniformity import reads_in
from distal.ir.contents import contents
from distal.ir.nodes import (
    Assign,
    Break,
    Const,
    Continue,
    Expr,
    Field,
    For,
    Function,
    If,
    Index,
    Let,
    Read,
    Return,
    Stmt,
    Swizzle,
    Var,
    While,
)
from distal.ir.types import Array, Kind, Scalar, Struct, Type
from distal.ir.walk import nodes_in, root_of, roots_in

# A block of at least this cost is skipped by a branch if no lane needs it.
SKIP_COST = 40


class Statements:
    """Writes the statements of one function.

    Attributes:
        reads: How often each local is read.
        indexed: The locals that are stored in memory, because an index is not constant.
        level: The number of loops around the current statement.
        levels: The number of loops around the declaration of each local.
        result: The leaves of the returned value.
    """

    def __init__(self, expressions: LaneExpressions, function: Function) -> None:
        self.expressions = expressions
        self.arithmetic = expressions.arithmetic
        self.writer = expressions.writer
        self.uniformity = expressions.uniformity
        self.reads = reads_in(function.body)
        self.indexed = _dynamically_indexed(function)
        self.loops = Loops(self)
        self.level = 0
        self.levels: dict[str, int] = {}
        self.result: Leaves = ()

    def block(self, block: tuple[Stmt, ...]) -> None:
        """Write the statements of a block."""
        for stmt in block:
            self.expressions.memo = {}
            self._statement(stmt)
        self.expressions.memo = {}

    def _statement(self, stmt: Stmt) -> None:
        expressions = self.expressions
        match stmt:
            case Let(name, value) | Var(name, value):
                self._bind(stmt, name, expressions.value(value), value.type)
            case Assign(target, value):
                self._assign(target, expressions.value(value))
            case If(condition, then, otherwise):
                self._if(expressions.scalar(condition), then, otherwise)
            case For():
                self.loops.counted(stmt)
            case While():
                self.loops.conditional(stmt)
            case Return(value):
                self.result = expressions.value(value)
            case Break() | Continue():
                raise AssertionError("the predicate pass leaves no such statement")
            case _:
                assert_never(stmt)

    def _bind(self, stmt: Let | Var, name: str, leaves: Leaves, type: Type) -> None:
        expressions = self.expressions
        self.levels[name] = self.level
        varies = name in self.uniformity.varying
        if isinstance(stmt, Let) and all(leaf.constant for leaf in leaves):
            expressions.environment[name] = leaves  # an indexed constant becomes a table
        elif name in self.indexed:
            expressions.environment[name] = expressions.stored(type, leaves, uniform=not varies)
        elif isinstance(stmt, Var) and varies:
            expressions.environment[name] = self.arithmetic.spread_all(leaves)
        else:
            expressions.environment[name] = leaves

    # Assignment

    def _assign(self, target: Expr, value: Leaves) -> None:
        expressions = self.expressions
        place = expressions.place(target) if not _picks_several(target) else None
        if place is not None:
            stored, offset, index = place
            mask = None if stored.uniform else expressions.mask
            expressions.storage.store(stored, value, offset, index, mask)
            return
        name = root_of(target).name
        held = expressions.environment[name]
        if isinstance(held, Stored):
            # Several components of a vector in memory: assign them one by one.
            assert isinstance(target, Swizzle)
            for lane, leaf in zip(target.lanes, value, strict=True):
                self._assign(Swizzle(target.base, lane, Scalar(leaf.kind)), (leaf,))
            return
        changed = self._replaced(target, held, value)
        if name in self.uniformity.varying:
            changed = self.arithmetic.spread_all(changed)
        expressions.environment[name] = changed

    def _replaced(self, target: Expr, whole: Leaves, value: Leaves) -> Leaves:
        """Return the leaves of the root, with the target's part replaced."""
        match target:
            case Read():
                return value
            case Field(base, name):
                assert isinstance(base.type, Struct)
                first = field_offset(base.type, name)
                part = self.expressions.value(base)
                part = (*part[:first], *value, *part[first + len(value) :])
                return self._replaced(base, whole, part)
            case Swizzle(base, lanes):
                parts = list(self.expressions.value(base))
                for lane, leaf in zip(lanes, value, strict=True):
                    parts["xyzw".index(lane)] = leaf
                return self._replaced(base, whole, tuple(parts))
            case Index(base, index):
                return self._replaced(base, whole, self._element_replaced(base, index, value))
            case _:
                raise AssertionError(f"not a target: {target}")

    def _element_replaced(self, base: Expr, index: Expr, value: Leaves) -> Leaves:
        part = self.expressions.value(base)
        size = len(value)
        if isinstance(index, Const):
            first = min(max(int(index.value), 0), len(part) // size - 1) * size
            return (*part[:first], *value, *part[first + size :])
        arithmetic, position = self.arithmetic, self.expressions.scalar(index)
        leaves: list[Leaf] = []
        for i, old in enumerate(part):
            element = arithmetic.constant(i // size, Kind.INT)
            here = arithmetic.apply(Kind.BOOL, "icmp eq {t0} {0}, {1}", position, element)
            leaves.append(arithmetic.select(here, value[i % size], old))
        return tuple(leaves)

    # Conditions

    def _if(self, condition: Leaf, then: tuple[Stmt, ...], otherwise: tuple[Stmt, ...]) -> None:
        if condition.constant:
            self.block(then if condition.names[0] == "true" else otherwise)
        elif condition.uniform:
            self._branch(condition.names[0], then, otherwise)
        else:
            self._diverge(condition, then, otherwise)

    def _branch(self, test: str, then: tuple[Stmt, ...], otherwise: tuple[Stmt, ...]) -> None:
        """Write a branch that is the same for all lanes."""
        writer = self.writer
        labels = writer.label("then"), writer.label("else"), writer.label("join")
        writer.branch(test, labels[0], labels[1] if otherwise else labels[2])
        before = dict(self.expressions.environment)
        ends = [] if otherwise else [(before, writer.block)]
        for label, block in zip(labels, (then, otherwise), strict=False):
            if block or label == labels[0]:
                writer.begin(label)
                self._apart(lambda block=block: self.block(block))  # type: ignore[misc]
                ends.append((self.expressions.environment, writer.block))
                writer.jump(labels[2])
                self.expressions.environment = dict(before)
        writer.begin(labels[2])
        self.join(before, ends)

    def _apart(self, write: Callable[[], None]) -> None:
        """Write code that may not run."""
        self.arithmetic.enter()
        write()
        self.arithmetic.leave()

    def join(
        self,
        names: dict[str, Leaves | Stored],
        ends: list[tuple[dict[str, Leaves | Stored], str]],
    ) -> None:
        """Write phis at the start of a block: the locals from several predecessor blocks.

        Args:
            names: The locals to merge, by name.
            ends: The environment at the end of each predecessor, and the predecessor's label.
        """
        merged: dict[str, Leaves | Stored] = {}
        for name, first in names.items():
            values = [environment[name] for environment, _ in ends]
            if isinstance(first, Stored) or all(v is values[0] for v in values):
                merged[name] = values[0]
            else:
                leaves = [(v, block) for v, (_, block) in zip(values, ends, strict=True)]
                merged[name] = self.expressions.merge(leaves)  # type: ignore[arg-type]
        self.expressions.environment = merged

    def _diverge(
        self, condition: Leaf, then: tuple[Stmt, ...], otherwise: tuple[Stmt, ...]
    ) -> None:
        """Write both sides, because lanes may differ; skip a costly side that no lane needs."""
        expressions, arithmetic = self.expressions, self.arithmetic
        before = dict(expressions.environment)
        outer = expressions.mask
        inverse = arithmetic.invert(condition) if otherwise else condition
        for holds, block in ((condition, then), (inverse, otherwise)):
            if not block:
                continue
            entering = dict(expressions.environment)
            expressions.mask = expressions.within(holds)
            if expressions.program.costs.block(block) >= SKIP_COST:
                self._skippable(holds, block, entering)
            else:
                self.block(block)
                self._blend(holds, entering)
            expressions.mask = outer
        expressions.environment = {name: expressions.environment[name] for name in before}

    def _skippable(
        self, holds: Leaf, block: tuple[Stmt, ...], entering: dict[str, Leaves | Stored]
    ) -> None:
        writer = self.writer
        assert self.expressions.mask is not None
        test = self.arithmetic.any_lane(Leaf(Kind.BOOL, self.expressions.mask, False))
        labels = writer.label("some"), writer.label("join")
        skipped = writer.block
        writer.branch(test, *labels)
        writer.begin(labels[0])

        def write() -> None:
            self.block(block)
            self._blend(holds, entering)

        self._apart(write)
        ends = [(entering, skipped), (self.expressions.environment, writer.block)]
        writer.jump(labels[1])
        writer.begin(labels[1])
        self.join(entering, ends)

    def _blend(self, holds: Leaf, otherwise: dict[str, Leaves | Stored]) -> None:
        """Restore the locals from ``otherwise`` in the lanes where the condition does not hold."""
        environment = self.expressions.environment
        blended: dict[str, Leaves | Stored] = {}
        for name, old in otherwise.items():
            new = environment[name]
            if new is old or isinstance(old, Stored) or isinstance(new, Stored):
                blended[name] = old
            else:
                blended[name] = tuple(
                    a if a == b else self.arithmetic.select(holds, a, b)
                    for a, b in zip(new, old, strict=True)
                )
        self.expressions.environment = blended


def _picks_several(target: Expr) -> bool:
    return isinstance(target, Swizzle) and len(target.lanes) > 1


def _dynamically_indexed(function: Function) -> frozenset[str]:
    """Return the locals that contain an array with an index that is not constant."""
    found = set()
    roots = (root for root in roots_in(function.body) if Index in contents(root).kinds)
    for e in (e for root in roots for e in nodes_in(root)):
        if (
            isinstance(e, Index)
            and not isinstance(e.index, Const)
            and isinstance(e.base.type, Array)
        ):
            root: Expr = e.base
            while isinstance(root, Index | Field):
                root = root.base
            if isinstance(root, Read):
                found.add(root.name)
    return frozenset(found)
