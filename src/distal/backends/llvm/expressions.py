"""Compute expressions as leaves.

Input: IR expressions after the passes, and the values of the locals. Output: instructions and
leaves. An expression is computed once per statement, because nodes are interned; the share pass has
bound expressions that several statements share to locals. Does not depend on statements.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, assert_never

from distal.backends.llvm.arithmetic import LaneArithmetic
from distal.backends.llvm.builtins import builtin
from distal.backends.llvm.lanes import Leaf, Leaves, Stored, field_offset, leaf_count, leaf_kinds
from distal.backends.llvm.layout import RESOURCE_BYTES
from distal.backends.llvm.roots import quotient
from distal.backends.llvm.storage import Mask, Storage
from distal.backends.llvm.uniformity import Uniformity
from distal.ir.nodes import (
    Apply,
    Binary,
    BinaryOp,
    Builtin,
    Call,
    Cast,
    Compare,
    CompareOp,
    Compose,
    Const,
    Construct,
    Expr,
    Field,
    FunctionRef,
    Gradient,
    Index,
    Logical,
    LogicalOp,
    MatMul,
    PerFrame,
    Read,
    Resource,
    Sample,
    Select,
    Size,
    Splat,
    Swizzle,
    Texel,
    Unary,
    UnaryOp,
    Uniform,
)
from distal.ir.types import (
    Array,
    Buffer,
    Kind,
    Matrix,
    Scalar,
    Struct,
    Texture,
    TextureShape,
    Type,
    Vector,
    kind_of,
)

if TYPE_CHECKING:
    from distal.backends.llvm.program import LaneProgram

# The cost of a conditional expression's side from which a branch around it saves time.
BRANCH_COST = 40

_Value = Leaves | Stored


class LaneExpressions:
    """Computes the expressions of one function.

    Attributes:
        program: The module.
        uniformity: Which locals vary between lanes.
        arithmetic: Writes operations.
        writer: The text of the function.
        storage: Writes loads and stores.
        environment: The values of the locals.
        mask: The active lanes; None: all.
        memo: The values computed so far in the current statement.
    """

    def __init__(
        self, program: LaneProgram, arithmetic: LaneArithmetic, uniformity: Uniformity
    ) -> None:
        self.program = program
        self.uniformity = uniformity
        self.arithmetic = arithmetic
        self.writer = arithmetic.writer
        self.storage = Storage(arithmetic)
        self.environment: dict[str, _Value] = {}
        self.mask: Mask = None
        self.memo: dict[Expr, Leaves] = {}

    def value(self, e: Expr) -> Leaves:
        """Return the leaves of an expression."""
        known = self.memo.get(e)
        if known is None:
            known = self.memo[e] = self._compute(e)
        return known

    def scalar(self, e: Expr) -> Leaf:
        """Return the single leaf of a scalar expression."""
        (leaf,) = self.value(e)
        return leaf

    def _compute(self, e: Expr) -> Leaves:
        arithmetic = self.arithmetic
        match e:
            case Const(value, type):
                assert isinstance(type, Scalar)
                return (arithmetic.constant(value, type.kind),)
            case Read(name, type):
                held = self.environment[name]
                if isinstance(held, Stored):
                    return self.storage.load(held, type, 0, None, self.mask)
                return held
            case Uniform(name, type):
                return self._loaded("uniforms", self.program.layout.uniforms[name], type)
            case PerFrame(name, type):
                return self._loaded("frame", self.program.layout.frame[name], type)
            case Unary(op, operand):
                change = arithmetic.negate if op is UnaryOp.NEGATE else arithmetic.invert
                return tuple(change(leaf) for leaf in self.value(operand))
            case Binary(op, lhs, rhs):
                pairs = list(zip(self.value(lhs), self.value(rhs), strict=True))
                if op is BinaryOp.DIV:
                    return tuple(quotient(arithmetic, a, b) for a, b in pairs)
                return tuple(arithmetic.binary(op, a, b) for a, b in pairs)
            case Compare(op, lhs, rhs):
                pairs = list(zip(self.value(lhs), self.value(rhs), strict=True))
                return tuple(arithmetic.compare(op, a, b) for a, b in pairs)
            case Logical():
                return (self._logical(e),)
            case MatMul(lhs, rhs):
                return self._product(lhs, rhs)
            case Select():
                return self._select(e)
            case Splat(value, type):
                return self.value(value) * leaf_count(type)
            case Compose(parts) | Construct(parts):
                return tuple(leaf for part in parts for leaf in self.value(part))
            case Swizzle(base, lanes):
                leaves = self.value(base)
                return tuple(leaves["xyzw".index(lane)] for lane in lanes)
            case Index() | Field():
                return self._part(e)
            case Cast(value, type):
                kind = kind_of(type)
                assert kind is not None
                return tuple(arithmetic.cast(leaf, kind) for leaf in self.value(value))
            case Builtin("anywhere", (condition,)):
                return (self._anywhere(self.scalar(condition)),)
            case Builtin(name, args):
                types = tuple(a.type for a in args)
                return builtin(arithmetic, name, tuple(map(self.value, args)), types)
            case Call(function, args):
                return self.program.call(self, function, args)
            case Texel(texture, index):
                return self._texel(texture, index)
            case Size(resource):
                return self._size(resource)
            case Resource() | FunctionRef() | Apply() | Gradient() | Sample():
                raise AssertionError(f"not for this backend: {e}")
            case _:
                assert_never(e)

    # Loads of values that are the same for all pixels

    def _loaded(self, run: str, slot: int, type: Type) -> Leaves:
        return tuple(self._slot(run, slot + i, kind) for i, kind in enumerate(leaf_kinds(type)))

    def _slot(self, run: str, slot: int, kind: Kind) -> Leaf:
        def load() -> Leaf:
            lanes = self.arithmetic.lanes
            stored = Kind.INT if kind is Kind.BOOL else kind
            at = self.writer.value(f"getelementptr i8, ptr %{run}, i64 {slot * lanes.slot}")
            name = self.writer.value(f"load {lanes.scalar(stored)}, ptr {at}, !invariant.load !0")
            return self.arithmetic.cast(Leaf(stored, (name,), True), kind)

        leaf: Leaf = self.arithmetic.once((run, slot), load)
        return leaf

    # Operators

    def _anywhere(self, condition: Leaf) -> Leaf:
        """Return whether a condition holds in any active lane, as a scalar."""
        if condition.uniform:
            return condition
        active = Leaf(Kind.BOOL, self.within(condition), False)
        return Leaf(Kind.BOOL, (self.arithmetic.any_lane(active),), True)

    def _logical(self, e: Logical) -> Leaf:
        arithmetic = self.arithmetic
        first = self.scalar(e.lhs)
        is_and = e.op is LogicalOp.AND
        if self.program.costs.expression(e.rhs) < BRANCH_COST:
            join = arithmetic.both if is_and else arithmetic.either
            return join(first, self.scalar(e.rhs))

        def rest() -> Leaves:
            return self.value(e.rhs)

        def short() -> Leaves:
            return (arithmetic.constant(not is_and, Kind.BOOL),)

        yes, no = (rest, short) if is_and else (short, rest)
        (leaf,) = self._choose(first, yes, no, is_and, not is_and, self.uniformity.varies(e))
        return leaf

    def _product(self, lhs: Expr, rhs: Expr) -> Leaves:
        """Return a matrix product; a matrix is stored by columns."""
        a, b = self.value(lhs), self.value(rhs)
        if isinstance(rhs.type, Matrix):
            n = rhs.type.size
            columns = [b[i * n : i * n + n] for i in range(n)]
        else:
            assert isinstance(rhs.type, Vector)
            n = rhs.type.size
            columns = [b]
        if isinstance(lhs.type, Matrix):
            rows = [tuple(a[c * n + r] for c in range(n)) for r in range(n)]
        else:
            rows = [a]
        return tuple(self._inner(row, column) for column in columns for row in rows)

    def _inner(self, a: Leaves, b: Leaves) -> Leaf:
        arithmetic = self.arithmetic
        total = arithmetic.binary(BinaryOp.MUL, a[0], b[0])
        for x, y in zip(a[1:], b[1:], strict=True):
            total = arithmetic.binary(BinaryOp.ADD, total, arithmetic.binary(BinaryOp.MUL, x, y))
        return total

    # Conditional expressions

    def _select(self, e: Select) -> Leaves:
        condition = self.value(e.condition)
        if len(condition) == 1:
            costs = self.program.costs
            dear = [costs.expression(side) >= BRANCH_COST for side in (e.yes, e.no)]
            if any(dear):
                sides = (lambda: self.value(e.yes)), (lambda: self.value(e.no))
                varies = self.uniformity.varies(e)
                return self._choose(condition[0], *sides, dear[0], dear[1], varies)
            condition = condition * leaf_count(e.type)
        rows = list(zip(condition, self.value(e.yes), self.value(e.no), strict=True))
        return tuple(self.arithmetic.select(*row) for row in rows)

    def _choose(
        self,
        condition: Leaf,
        yes: Callable[[], Leaves],
        no: Callable[[], Leaves],
        skip_yes: bool,
        skip_no: bool,
        varies: bool,
    ) -> Leaves:
        """Compute one side, or both if lanes differ, with a branch around an expensive side."""
        arithmetic = self.arithmetic
        if condition.uniform:
            return self._branched(condition.names[0], yes, no, varies)
        outer = self.mask
        outcome: list[Leaves] = []
        inverse = arithmetic.invert(condition)
        for side, holds, skip in ((yes, condition, skip_yes), (no, inverse, skip_no)):
            self.mask = self.within(holds)
            if skip:
                test = arithmetic.any_lane(Leaf(Kind.BOOL, self.mask, False))
                outcome.append(self.skipped(test, side))
            else:
                outcome.append(side())
            self.mask = outer
        rows = list(zip(*outcome, strict=True))
        return tuple(arithmetic.select(condition, a, b) for a, b in rows)

    def within(self, condition: Leaf) -> tuple[str, ...]:
        """Return the active lanes where a condition holds, as a vector for each chunk."""
        if self.mask is not None:
            condition = self.arithmetic.both(Leaf(Kind.BOOL, self.mask, False), condition)
        return self.arithmetic.vectors(condition)

    def skipped(self, test: str, side: Callable[[], Leaves]) -> Leaves:
        """Compute a varying value only if a test holds; otherwise it is zero."""
        return self._branched(test, side, None, True)

    def _branched(
        self,
        test: str,
        yes: Callable[[], Leaves],
        no: Callable[[], Leaves] | None,
        varies: bool,
    ) -> Leaves:
        """Select one side by a branch; without ``no`` the other value is zero."""
        writer, arithmetic, memo = self.writer, self.arithmetic, self.memo
        join = writer.label("join")
        labels = writer.label("yes"), writer.label("no") if no else join
        before = writer.block
        writer.branch(test, *labels)
        ends: list[tuple[Leaves, str]] = []
        for label, side in zip(labels, (yes, no), strict=True):
            if side is None:
                continue
            writer.begin(label)
            arithmetic.enter()
            self.memo = dict(memo)
            leaves = side()
            leaves = arithmetic.spread_all(leaves) if varies else leaves
            arithmetic.leave()
            ends.append((leaves, writer.block))
            writer.jump(join)
        self.memo = memo
        writer.begin(join)
        if no is None:
            zeros = tuple(
                Leaf(leaf.kind, ("zeroinitializer",) * len(leaf.names), False)
                for leaf in ends[0][0]
            )
            ends.append((zeros, before))
        return self.merge(ends)

    def merge(self, ends: list[tuple[Leaves, str]]) -> Leaves:
        """Write phis at the start of a block: leaves from several predecessor blocks."""
        merged = []
        for row in zip(*(leaves for leaves, _ in ends), strict=True):
            first = row[0]
            if all(leaf == first for leaf in row):
                merged.append(first)
                continue
            assert all(leaf.uniform is first.uniform for leaf in row)
            type = self.arithmetic.lanes.type(first.kind, uniform=first.uniform)
            blocks = [block for _, block in ends]
            names = []
            for operands in zip(*(leaf.names for leaf in row), strict=True):
                if all(name == operands[0] for name in operands):
                    names.append(operands[0])
                else:
                    names.append(self.writer.phi(type, *zip(operands, blocks, strict=True)))
            merged.append(Leaf(first.kind, tuple(names), first.uniform))
        return tuple(merged)

    # Parts of values

    def _part(self, e: Index | Field) -> Leaves:
        """Return a field or element; it is loaded directly if the whole value is in memory."""
        if isinstance(e, Index) and isinstance(e.base.type, Buffer):
            return self._element_of_buffer(e)
        place = self.place(e)
        if place is not None:
            stored, offset, index = place
            return self.storage.load(stored, e.type, offset, index, self.mask)
        if isinstance(e, Field):
            assert isinstance(e.base.type, Struct)
            first = field_offset(e.base.type, e.name)
            return self.value(e.base)[first : first + leaf_count(e.type)]
        size = leaf_count(e.type)
        leaves = self.value(e.base)
        parts = [leaves[i : i + size] for i in range(0, len(leaves), size)]
        if isinstance(e.index, Const):
            return parts[min(max(int(e.index.value), 0), len(parts) - 1)]
        return self._picked(parts, self.scalar(e.index))

    def _picked(self, parts: list[Leaves], index: Leaf) -> Leaves:
        """Select one of a few parts by a chain of selects."""
        arithmetic = self.arithmetic
        picked = parts[0]
        for i, part in enumerate(parts[1:], 1):
            here = arithmetic.compare(CompareOp.EQ, index, arithmetic.constant(i, Kind.INT))
            rows = list(zip(part, picked, strict=True))
            picked = tuple(arithmetic.select(here, a, b) for a, b in rows)
        return picked

    def place(self, e: Expr) -> tuple[Stored, int, Leaf | None] | None:
        """Return the place of a part of a stored value, or None if the value is not in memory.

        The place is the memory, the offset in leaves, and a computed number of leaves to add.
        """
        match e:
            case Read(name):
                held = self.environment[name]
                return (held, 0, None) if isinstance(held, Stored) else None
            case Field(base, name):
                outer = self.place(base)
                if outer is None:
                    return None
                assert isinstance(base.type, Struct)
                return outer[0], outer[1] + field_offset(base.type, name), outer[2]
            case Swizzle(base, lanes) if len(lanes) == 1:
                outer = self.place(base)
                return outer and (outer[0], outer[1] + "xyzw".index(lanes), outer[2])
            case Index(base, index):
                outer = self.place(base)
                if outer is None and isinstance(base.type, Array) and not isinstance(index, Const):
                    outer = self._spilled(base), 0, None
                return outer and self._indexed(outer, index, leaf_count(e.type), base.type)
            case _:
                return None

    def _indexed(
        self, outer: tuple[Stored, int, Leaf | None], index: Expr, size: int, whole: Type
    ) -> tuple[Stored, int, Leaf | None]:
        stored, offset, so_far = outer
        if isinstance(index, Const):
            last = leaf_count(whole) // size - 1
            return stored, offset + min(max(int(index.value), 0), last) * size, so_far
        arithmetic = self.arithmetic
        steps = self.scalar(index)
        if size != 1:
            steps = arithmetic.binary(BinaryOp.MUL, steps, arithmetic.constant(size, Kind.INT))
        if so_far is not None:
            steps = arithmetic.binary(BinaryOp.ADD, so_far, steps)
        return stored, offset, steps

    def _spilled(self, e: Expr) -> Stored:
        """Return a value in memory, to index it; constants become a table."""
        leaves = self.value(e)
        if all(leaf.constant for leaf in leaves):
            return Stored(e.type, self.program.table(leaves), True)
        return self.stored(e.type, leaves, uniform=all(leaf.uniform for leaf in leaves))

    def stored(self, type: Type, leaves: Leaves, *, uniform: bool) -> Stored:
        """Store a value in newly allocated memory.

        Args:
            type: The type of the value.
            leaves: The leaves of the value.
            uniform: Whether the value is the same in all lanes.
        """
        size = self.storage.size(type, uniform=uniform)
        self.program.take_memory(size, self.uniformity.function)
        place = self.storage.allocate(type, uniform=uniform)
        self.storage.store(place, leaves, 0, None, None)
        return place

    # Textures and buffers

    def _resource(self, resource: Expr, field: int) -> str:
        """Return a field of a resource's entry: the address of its data, or one of three sizes."""
        assert isinstance(resource, Resource)
        at = self.program.layout.resources[resource.name] * RESOURCE_BYTES + field * 8
        type = "i32" if field else "ptr"

        def load() -> str:
            address = self.writer.value(f"getelementptr i8, ptr %resources, i64 {at}")
            return self.writer.value(f"load {type}, ptr {address}, !invariant.load !0")

        name: str = self.arithmetic.once(("resource", at), load)
        return name

    def _extent(self, resource: Expr, axis: int) -> Leaf:
        return Leaf(Kind.INT, (self._resource(resource, 1 + axis),), True)

    def _size(self, resource: Expr) -> Leaves:
        match resource.type:
            case Texture(TextureShape.VOLUME):
                return tuple(self._extent(resource, axis) for axis in range(3))
            case Texture():
                return tuple(self._extent(resource, axis) for axis in range(2))
            case _:
                return (self._extent(resource, 0),)

    def _element_of_buffer(self, e: Index) -> Leaves:
        index = self.storage.clamp(self.scalar(e.index), self._extent(e.base, 0))
        data = self._resource(e.base, 0)
        return self.storage.fetch(data, index, leaf_kinds(e.type), self.mask)

    def _texel(self, texture: Expr, index: Expr) -> Leaves:
        arithmetic = self.arithmetic
        position: Leaf | None = None
        coordinates = self.value(index)
        for axis in reversed(range(len(coordinates))):
            extent = self._extent(texture, axis)
            step = self.storage.clamp(coordinates[axis], extent)
            if position is not None:
                rows = arithmetic.binary(BinaryOp.MUL, position, extent)
                step = arithmetic.binary(BinaryOp.ADD, rows, step)
            position = step
        assert position is not None
        data = self._resource(texture, 0)
        return self.storage.fetch(data, position, (Kind.FLOAT,) * 4, self.mask)
