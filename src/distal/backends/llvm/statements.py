"""Statements under lane masks.

What flows in: predicated blocks. What flows out: instructions that leave each local's value in the
environment. Locals are SSA values: after a condition that varies, a Var is picked from both sides
lane by lane, so nothing inside a side needs a mask but memory, calls and tests for active lanes.
A loop goes round while a lane is left; its Vars keep their value in lanes that have left, unless
nobody reads them afterwards.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import assert_never

from distal.backends.llvm.costs import constant_rounds
from distal.backends.llvm.expressions import Expressions
from distal.backends.llvm.lanes import Leaf, Leaves, Stored, field_offset
from distal.backends.llvm.uniformity import reads_in
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
from distal.ir.walk import expressions_in, root_of, statements_in

# A block of at least this cost is branched around when no lane wants it.
SKIP_COST = 40
# Loops that may go round more often than this, inner loops included, ask whether to stop.
POLL_ROUNDS = 65536

_INT_MAX = 2**31 - 1


@dataclass(slots=True)
class _Loop:
    """A loop under construction: what goes round."""

    header: str
    before: str  # the block control comes from
    names: list[str]  # Vars that the body changes
    entering: dict[str, Leaves]
    phis: dict[str, list[list[tuple[str, int]]]]  # for each name and leaf: phi name, line


class Statements:
    """Writes the statements of one function."""

    def __init__(self, expressions: Expressions, function: Function) -> None:
        self.expressions = expressions
        self.arithmetic = expressions.arithmetic
        self.writer = expressions.writer
        self.uniformity = expressions.uniformity
        self.reads = reads_in(function.body)
        self.indexed = _dynamically_indexed(function)
        self.level = 0  # how many loops we are in
        self.levels: dict[str, int] = {}
        self.result: Leaves = ()

    def block(self, block: tuple[Stmt, ...]) -> None:
        """Write a block in order."""
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
                self._for(stmt)
            case While():
                self._while(stmt)
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
            expressions.environment[name] = leaves  # an indexed one becomes a table
        elif name in self.indexed:
            stored = expressions.storage.allocate(type, uniform=not varies)
            expressions.storage.store(stored, leaves, 0, None, None)
            expressions.environment[name] = stored
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
            # Several components of a vector in memory: one after the other.
            assert isinstance(target, Swizzle)
            for lane, leaf in zip(target.lanes, value, strict=True):
                self._assign(Swizzle(target.base, lane, Scalar(leaf.kind)), (leaf,))
            return
        changed = self._replaced(target, held, value)
        if name in self.uniformity.varying:
            changed = self.arithmetic.spread_all(changed)
        expressions.environment[name] = changed

    def _replaced(self, target: Expr, whole: Leaves, value: Leaves) -> Leaves:
        """The root's leaves with the target's part replaced."""
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
        """All lanes go the same way."""
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
        self._join(before, ends)

    def _apart(self, write: Callable[[], None]) -> None:
        """Write code that may not run."""
        self.arithmetic.enter()
        write()
        self.arithmetic.leave()

    def _join(
        self,
        names: dict[str, Leaves | Stored],
        ends: list[tuple[dict[str, Leaves | Stored], str]],
    ) -> None:
        """At the start of a block: the locals as they come from several blocks."""
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
        """Lanes may differ: both sides, each skipped when dear and no lane wants it."""
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
        self._join(entering, ends)

    def _blend(self, holds: Leaf, otherwise: dict[str, Leaves | Stored]) -> None:
        """Where the condition fails, locals are as in ``otherwise``."""
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

    # Loops

    def _for(self, stmt: For) -> None:
        start, stop = self.expressions.scalar(stmt.start), self.expressions.scalar(stmt.stop)
        rounds = constant_rounds(stmt)
        if rounds == 0:
            return
        if not (start.uniform and stop.uniform):
            self._for_apart(stmt, start, stop)
            return
        self._for_together(stmt, start, stop, certain=rounds is not None)

    def _for_together(self, stmt: For, start: Leaf, stop: Leaf, *, certain: bool) -> None:
        """The count is the same in all lanes, though they may leave one by one."""
        writer, expressions = self.writer, self.expressions
        before, done = dict(expressions.environment), writer.label("done")
        outer = expressions.mask
        diverges = id(stmt) in self.uniformity.divergent_loops
        skipped = ""
        if not certain:
            skipped, enter = writer.block, writer.label("enter")
            sign = "slt" if stmt.step > 0 else "sgt"
            test = writer.value(f"icmp {sign} i32 {start.names[0]}, {stop.names[0]}")
            writer.branch(test, enter, done)
            writer.begin(enter)
        loop = self._begin_loop(stmt.body, before)
        count, count_at = writer.fresh(), writer.reserve()
        live = self._begin_mask(outer) if diverges else None
        self.arithmetic.enter()
        expressions.environment[stmt.name] = (Leaf(Kind.INT, (count,), True),)
        leave = self._body(stmt.body)
        ahead = self._kept(loop, live, stmt.body)
        tests = []
        if expressions.program.costs.rounds((stmt,)) > POLL_ROUNDS:
            tests.append(self._polled())
        if live is not None:
            remaining, test = self._remaining(live[0], leave)
            tests.append(test)
        elif leave is not None:
            tests.append(self.arithmetic.invert(leave).names[0])
        following = writer.value(f"add i32 {count}, {stmt.step}")
        near = stop.constant and abs(int(stop.names[0]) + stmt.step) <= _INT_MAX
        tests.append(self._more(count, stop.names[0], stmt.step, following if near else None))
        test = tests[0]
        for other in tests[1:]:
            test = writer.value(f"and i1 {test}, {other}")
        end = writer.block
        writer.branch(test, loop.header, done)
        self.arithmetic.leave()
        first, back = (start.names[0], loop.before), (following, end)
        writer.fill(count_at, f"{count} = phi i32 [ {first[0]}, %{first[1]} ], "
                              f"[ {back[0]}, %{back[1]} ]")  # fmt: skip
        if live is not None:
            self._fill_mask(live, outer, loop.before, remaining, end)
        self._fill(loop, ahead, end)
        writer.begin(done)
        expressions.mask = outer
        ends = [(ahead, end)] if certain else [(before, skipped), (ahead, end)]
        self._join(before, ends)

    def _more(self, count: str, stop: str, step: int, following: str | None) -> str:
        """Whether another round follows; ``following`` is the next count if it cannot overflow."""
        if following is not None:
            return self.writer.value(f"icmp {'slt' if step > 0 else 'sgt'} i32 {following}, {stop}")
        left, right = (stop, count) if step > 0 else (count, stop)
        rest = self.writer.value(f"sub i32 {left}, {right}")
        return self.writer.value(f"icmp ugt i32 {rest}, {abs(step)}")

    def _for_apart(self, stmt: For, start: Leaf, stop: Leaf) -> None:
        """Each lane counts for itself."""
        writer, expressions, arithmetic = self.writer, self.expressions, self.arithmetic
        before, outer = dict(expressions.environment), expressions.mask
        up = stmt.step > 0
        order = "icmp slt {t0} {0}, {1}" if up else "icmp sgt {t0} {0}, {1}"
        entering = expressions.within(arithmetic.apply(Kind.BOOL, order, start, stop))
        test = arithmetic.any_lane(Leaf(Kind.BOOL, entering, False))
        first = arithmetic.vectors(start)
        arithmetic.vectors(stop)
        enter, done = writer.label("enter"), writer.label("done")
        skipped = writer.block
        writer.branch(test, enter, done)
        writer.begin(enter)
        loop = self._begin_loop(stmt.body, before)
        counts = [(writer.fresh(), writer.reserve()) for _ in first]
        live = self._begin_mask(entering)
        arithmetic.enter()
        count = Leaf(Kind.INT, tuple(name for name, _ in counts), False)
        expressions.environment[stmt.name] = (count,)
        leave = self._body(stmt.body)
        ahead = self._kept(loop, live, stmt.body)
        step = arithmetic.constant(abs(stmt.step), Kind.INT)
        rest = arithmetic.apply(
            Kind.INT, "sub {t0} {0}, {1}", *((stop, count) if up else (count, stop))
        )
        more = arithmetic.apply(Kind.BOOL, "icmp ugt {t0} {0}, {1}", rest, step)
        form = "add {t0} {0}, {1}" if up else "sub {t0} {0}, {1}"
        following = arithmetic.apply(Kind.INT, form, count, step)
        leave = arithmetic.invert(more) if leave is None else arithmetic.either(
            arithmetic.invert(more), leave
        )  # fmt: skip
        remaining, test = self._remaining(live[0], leave)
        test = writer.value(f"and i1 {test}, {self._polled()}")
        end = writer.block
        writer.branch(test, loop.header, done)
        arithmetic.leave()
        type = arithmetic.lanes.vector(Kind.INT)
        for (name, at), a, b in zip(counts, first, following.names, strict=True):
            writer.fill(at, f"{name} = phi {type} [ {a}, %{loop.before} ], [ {b}, %{end} ]")
        self._fill_mask(live, entering, loop.before, remaining, end)
        self._fill(loop, ahead, end)
        writer.begin(done)
        expressions.mask = outer
        self._join(before, [(before, skipped), (ahead, end)])

    def _while(self, stmt: While) -> None:
        writer, expressions, arithmetic = self.writer, self.expressions, self.arithmetic
        before, outer = dict(expressions.environment), expressions.mask
        diverges = id(stmt) in self.uniformity.divergent_loops
        loop = self._begin_loop(stmt.body, before)
        live = self._begin_mask(outer) if diverges else None
        arithmetic.enter()
        expressions.memo = {}
        holds = expressions.scalar(stmt.condition)
        at_top = dict(expressions.environment)
        if live is not None:
            expressions.mask = expressions.within(holds)
            live = (Leaf(Kind.BOOL, expressions.mask, False), live[1])
            test = arithmetic.any_lane(live[0])
        else:
            test = holds.names[0]
        test = writer.value(f"and i1 {test}, {self._polled()}")
        inside, done = writer.label("inside"), writer.label("done")
        top = writer.block
        writer.branch(test, inside, done)
        writer.begin(inside)
        leave = self._body(stmt.body)
        ahead = self._kept(loop, live, stmt.body)
        ends = [(at_top, top)]
        remaining: tuple[str, ...] = ()
        if live is not None:
            remaining, _ = self._remaining(live[0], leave)
            end = writer.block
            writer.jump(loop.header)
        else:
            end = writer.block
            if leave is not None:
                ends.append((ahead, end))
                writer.branch(leave.names[0], done, loop.header)
            else:
                writer.jump(loop.header)
        arithmetic.leave()
        if live is not None:
            self._fill_mask(live, outer, loop.before, remaining, end)
        self._fill(loop, ahead, end)
        writer.begin(done)
        expressions.mask = outer
        self._join(before, ends)

    def _begin_loop(self, body: tuple[Stmt, ...], before: dict[str, Leaves | Stored]) -> _Loop:
        """Jump to a loop's first block and begin it with a phi for each Var the body changes."""
        writer = self.writer
        assigned = {root_of(s.target).name for s in statements_in(body) if isinstance(s, Assign)}
        names = [name for name in before if name in assigned]
        entering: dict[str, Leaves] = {}
        for name in names:
            held = before[name]
            if not isinstance(held, Stored):
                entering[name] = held
        loop = _Loop(writer.label("loop"), writer.block, list(entering), entering, {})
        writer.jump(loop.header)
        writer.begin(loop.header)
        for name, leaves in entering.items():
            loop.phis[name] = [[(writer.fresh(), writer.reserve()) for _ in leaf.names]
                               for leaf in leaves]  # fmt: skip
            self.expressions.environment[name] = tuple(
                Leaf(leaf.kind, tuple(n for n, _ in phis), leaf.uniform)
                for leaf, phis in zip(leaves, loop.phis[name], strict=True)
            )
        return loop

    def _fill(self, loop: _Loop, ahead: dict[str, Leaves | Stored], end: str) -> None:
        """Write the phis of a loop's first block, now that its end is known."""
        for name in loop.names:
            last = ahead[name]
            assert not isinstance(last, Stored)
            for before, after, phis in zip(loop.entering[name], last, loop.phis[name], strict=True):
                type = self.arithmetic.lanes.type(before.kind, uniform=before.uniform)
                for (phi, at), a, b in zip(phis, before.names, after.names, strict=True):
                    edges = f"[ {a}, %{loop.before} ], [ {b}, %{end} ]"
                    self.writer.fill(at, f"{phi} = phi {type} {edges}")

    def _begin_mask(self, outer: object) -> tuple[Leaf, list[tuple[str, int]]]:
        """The phi of the lanes that are left, and make them the active ones."""
        writer = self.writer
        phis = [(writer.fresh(), writer.reserve()) for _ in range(self.arithmetic.lanes.chunks)]
        names = tuple(name for name, _ in phis)
        self.expressions.mask = names
        return Leaf(Kind.BOOL, names, False), phis

    def _fill_mask(
        self,
        live: tuple[Leaf, list[tuple[str, int]]],
        outer: tuple[str, ...] | None,
        before: str,
        remaining: tuple[str, ...],
        end: str,
    ) -> None:
        type = self.arithmetic.lanes.vector(Kind.BOOL)
        first = outer or ("splat (i1 true)",) * len(live[1])
        for (name, at), a, b in zip(live[1], first, remaining, strict=True):
            self.writer.fill(at, f"{name} = phi {type} [ {a}, %{before} ], [ {b}, %{end} ]")

    def _body(self, body: tuple[Stmt, ...]) -> Leaf | None:
        """A round; the condition of its trailing ``if leave: break``."""
        self.level += 1
        leave: Leaf | None = None
        match body[-1:]:
            case (If(condition, (Break(),), ()),):
                self.block(body[:-1])
                leave = self.expressions.scalar(condition)
            case _:
                self.block(body)
        self.expressions.memo = {}
        self.level -= 1
        return leave

    def _kept(
        self, loop: _Loop, live: tuple[Leaf, object] | None, body: tuple[Stmt, ...]
    ) -> dict[str, Leaves | Stored]:
        """The locals at a round's end; lanes that left before it keep their values."""
        environment = dict(self.expressions.environment)
        if live is None:
            return environment
        inside = reads_in(body)
        for name in loop.names:
            dead = self.levels.get(name) == self.level and inside.get(name, 0) == self.reads.get(
                name, 0
            )
            if dead:
                continue
            changed = environment[name]
            assert not isinstance(changed, Stored)
            rows = zip(changed, loop.phis[name], strict=True)
            kept = []
            for new, phis in rows:
                old = Leaf(new.kind, tuple(n for n, _ in phis), new.uniform)
                kept.append(new if new == old else self.arithmetic.select(live[0], new, old))
            environment[name] = tuple(kept)
        return environment

    def _remaining(self, live: Leaf, leave: Leaf | None) -> tuple[tuple[str, ...], str]:
        """The lanes that go round again, and whether there is one."""
        if leave is not None:
            live = self.arithmetic.both(live, self.arithmetic.invert(leave))
        return live.names, self.arithmetic.any_lane(live)

    def _polled(self) -> str:
        """A test, in loops that may be long, that nobody asked to stop."""
        self.expressions.program.polls = True
        flag = self.writer.value("load volatile i32, ptr %stop")
        return self.writer.value(f"icmp eq i32 {flag}, 0")


def _picks_several(target: Expr) -> bool:
    return isinstance(target, Swizzle) and len(target.lanes) > 1


def _dynamically_indexed(function: Function) -> frozenset[str]:
    """Locals with an array in them that is indexed by what is not constant."""
    found = set()
    for e in expressions_in(function.body):
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
