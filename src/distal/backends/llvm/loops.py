"""Write loops under lane masks.

Input: predicated loops, whose only ``break`` is a final ``if flag: break``. Output: instructions. A
loop runs while any lane is active. Its Vars keep their values in lanes that have left the loop,
unless they are not read afterwards. A counter that is the same in all lanes is a scalar, even if
lanes leave one by one. Loops that may run long check the stop flag.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from distal.backends.llvm.costs import constant_rounds
from distal.backends.llvm.lanes import Leaf, Leaves, Stored
from distal.backends.llvm.layout import STOP
from distal.backends.llvm.storage import Mask
from distal.backends.llvm.uniformity import reads_in
from distal.ir.nodes import Assign, Break, CompareOp, For, If, Stmt, While
from distal.ir.types import Kind
from distal.ir.walk import root_of, statements_in

if TYPE_CHECKING:
    from distal.backends.llvm.statements import Statements

# Loops that may have more iterations than this, inner loops included, check the stop flag.
POLL_ROUNDS = 65536

_INT_MAX = 2**31 - 1


@dataclass(slots=True)
class _Carried:
    """A loop-carried leaf: its values on entry, its phis, and its value inside the loop."""

    entering: tuple[str, ...]
    phis: tuple[str, ...]
    inside: Leaf


@dataclass(slots=True)
class _VectorLoop:
    """A loop that is being written."""

    header: str
    before: str  # the block before the loop
    head: int  # the line where the phis are written
    variables: dict[str, list[_Carried]]  # the Vars that the body changes
    others: list[_Carried]  # the count and the active lanes


class Loops:
    """Writes the loops of one function."""

    def __init__(self, statements: Statements) -> None:
        self.statements = statements
        self.expressions = statements.expressions
        self.arithmetic = statements.arithmetic
        self.writer = statements.writer
        self.uniformity = statements.uniformity

    def counted(self, stmt: For) -> None:
        """Write a loop over a range."""
        start, stop = self.expressions.scalar(stmt.start), self.expressions.scalar(stmt.stop)
        rounds = constant_rounds(stmt)
        if rounds == 0:
            return
        if not (start.uniform and stop.uniform):
            self._for_apart(stmt, start, stop)
            return
        self._for_together(stmt, start, stop, certain=rounds is not None)

    def _for_together(self, stmt: For, start: Leaf, stop: Leaf, *, certain: bool) -> None:
        """Write a loop whose counter is the same in all lanes; lanes may leave one by one."""
        writer, expressions = self.writer, self.expressions
        before, done = dict(expressions.environment), writer.label("done")
        outer = expressions.mask
        skipped = ""
        if not certain:
            skipped, enter = writer.block, writer.label("enter")
            sign = "slt" if stmt.step > 0 else "sgt"
            test = writer.value(f"icmp {sign} i32 {start.names[0]}, {stop.names[0]}")
            writer.branch(test, enter, done)
            writer.begin(enter)
        diverges = id(stmt) in self.uniformity.divergent_loops
        loop = self._begin(stmt.body, [start, *self._lanes_left(outer, diverges)])
        count = loop.others[0].inside
        live = self._activate(loop.others[1]) if diverges else None
        self.arithmetic.enter()
        expressions.environment[stmt.name] = (count,)
        leave = self._body(stmt.body)
        ahead = self._kept(loop, live, stmt.body)
        following = self._following(count, stmt.step)
        near = stop.constant and abs(int(stop.names[0]) + stmt.step) <= _INT_MAX
        tests = [self._more(count, stop, stmt.step, following if near else None)]
        carried = [following]
        if live is not None:
            carried.append(self._remaining(live, leave))
            tests.append(self.arithmetic.any_lane(carried[1]))
        elif leave is not None:
            tests.append(self.arithmetic.invert(leave).names[0])
        if expressions.program.costs.rounds((stmt,)) > POLL_ROUNDS:
            tests.append(self._polled())
        end = self._end(loop, ahead, carried)
        writer.branch(self._all(tests), loop.header, done)
        self.arithmetic.leave()
        writer.begin(done)
        expressions.mask = outer
        ends = [(ahead, end)] if certain else [(before, skipped), (ahead, end)]
        self.statements.join(before, ends)

    def _following(self, count: Leaf, step: int) -> Leaf:
        amount = self.arithmetic.constant(step, Kind.INT)
        return self.arithmetic.apply(Kind.INT, "add {t0} {0}, {1}", count, amount)

    def _more(self, count: Leaf, stop: Leaf, step: int, following: Leaf | None) -> str:
        """Test for another iteration; ``following`` is the next count if it cannot overflow."""
        if following is not None:
            order = "slt" if step > 0 else "sgt"
            return self.writer.value(f"icmp {order} i32 {following.names[0]}, {stop.names[0]}")
        return self._more_apart(count, stop, step).names[0]

    def _more_apart(self, count: Leaf, stop: Leaf, step: int) -> Leaf:
        """Test for another iteration by the unsigned distance to the end, which cannot overflow."""
        sides = (stop, count) if step > 0 else (count, stop)
        rest = self.arithmetic.apply(Kind.INT, "sub {t0} {0}, {1}", *sides)
        amount = self.arithmetic.constant(abs(step), Kind.INT)
        return self.arithmetic.apply(Kind.BOOL, "icmp ugt {t0} {0}, {1}", rest, amount)

    def _for_apart(self, stmt: For, start: Leaf, stop: Leaf) -> None:
        """Write a loop in which each lane has a separate counter."""
        writer, expressions, arithmetic = self.writer, self.expressions, self.arithmetic
        before, outer = dict(expressions.environment), expressions.mask
        start, stop = arithmetic.spread(start), arithmetic.spread(stop)
        order = CompareOp.LT if stmt.step > 0 else CompareOp.GT
        some = Leaf(Kind.BOOL, expressions.within(arithmetic.compare(order, start, stop)), False)
        enter, done = writer.label("enter"), writer.label("done")
        skipped = writer.block
        writer.branch(arithmetic.any_lane(some), enter, done)
        writer.begin(enter)
        loop = self._begin(stmt.body, [start, some])
        count = loop.others[0].inside
        live = self._activate(loop.others[1])
        arithmetic.enter()
        expressions.environment[stmt.name] = (count,)
        leave = self._body(stmt.body)
        ahead = self._kept(loop, live, stmt.body)
        finished = arithmetic.invert(self._more_apart(count, stop, stmt.step))
        leave = finished if leave is None else arithmetic.either(finished, leave)
        remaining = self._remaining(live, leave)
        test = self._all([arithmetic.any_lane(remaining), self._polled()])
        end = self._end(loop, ahead, [self._following(count, stmt.step), remaining])
        writer.branch(test, loop.header, done)
        arithmetic.leave()
        writer.begin(done)
        expressions.mask = outer
        self.statements.join(before, [(before, skipped), (ahead, end)])

    def conditional(self, stmt: While) -> None:
        """Write a ``while`` loop."""
        writer, expressions, arithmetic = self.writer, self.expressions, self.arithmetic
        before, outer = dict(expressions.environment), expressions.mask
        diverges = id(stmt) in self.uniformity.divergent_loops
        loop = self._begin(stmt.body, self._lanes_left(outer, diverges))
        live = self._activate(loop.others[0]) if diverges else None
        arithmetic.enter()
        expressions.memo = {}
        holds = expressions.scalar(stmt.condition)
        at_top = dict(expressions.environment)
        if live is not None:
            expressions.mask = expressions.within(holds)
            live = Leaf(Kind.BOOL, expressions.mask, False)
        test = self._all([arithmetic.any_lane(holds if live is None else live), self._polled()])
        inside, done = writer.label("inside"), writer.label("done")
        ends = [(at_top, writer.block)]
        writer.branch(test, inside, done)
        writer.begin(inside)
        leave = self._body(stmt.body)
        ahead = self._kept(loop, live, stmt.body)
        end = self._end(loop, ahead, [] if live is None else [self._remaining(live, leave)])
        if live is None and leave is not None:
            ends.append((ahead, end))
            writer.branch(leave.names[0], done, loop.header)
        else:
            writer.jump(loop.header)
        arithmetic.leave()
        writer.begin(done)
        expressions.mask = outer
        self.statements.join(before, ends)

    # Loop-carried values

    def _begin(self, body: tuple[Stmt, ...], others: list[Leaf]) -> _VectorLoop:
        """Begin a loop, with phis for the Vars that the body changes and for other leaves."""
        writer, environment = self.writer, self.expressions.environment
        assigned = {root_of(s.target).name for s in statements_in(body) if isinstance(s, Assign)}
        entering: dict[str, Leaves] = {}
        for name, held in environment.items():
            if name in assigned and not isinstance(held, Stored):
                entering[name] = held
        # Values on entry are converted before the jump, values inside the loop after all phis.
        variables = {name: [self._carried(leaf) for leaf in v] for name, v in entering.items()}
        loop = _VectorLoop(
            writer.label("loop"), writer.block, 0, variables, list(map(self._carried, others))
        )
        writer.jump(loop.header)
        writer.begin(loop.header)
        loop.head = writer.reserve()
        for carried in (*(c for row in variables.values() for c in row), *loop.others):
            leaf = carried.inside
            names = (
                self.arithmetic.from_carried(leaf.kind, name, uniform=leaf.uniform)
                for name in carried.phis
            )
            carried.inside = Leaf(leaf.kind, tuple(names), leaf.uniform)
        for name, row in variables.items():
            environment[name] = tuple(carried.inside for carried in row)
        return loop

    def _carried(self, leaf: Leaf) -> _Carried:
        phis = tuple(self.writer.fresh() for _ in leaf.names)
        return _Carried(self._packed(leaf), phis, leaf)

    def _packed(self, leaf: Leaf) -> tuple[str, ...]:
        return tuple(
            self.arithmetic.to_carried(leaf.kind, name, uniform=leaf.uniform) for name in leaf.names
        )

    def _end(self, loop: _VectorLoop, ahead: dict[str, Leaves | Stored], others: list[Leaf]) -> str:
        """End an iteration: complete the phis of the loop-carried values; return the last block."""
        end = self.writer.block
        pairs = list(zip(loop.others, others, strict=True))
        for name, row in loop.variables.items():
            last = ahead[name]
            assert not isinstance(last, Stored)
            pairs += zip(row, last, strict=True)
        for carried, leaf in pairs:
            kind, uniform = carried.inside.kind, carried.inside.uniform
            assert leaf.uniform is uniform
            type = self.arithmetic.carried(kind, uniform=uniform)
            rows = zip(carried.phis, carried.entering, self._packed(leaf), strict=True)
            for phi, first, back in list(rows):
                edges = f"[ {first}, %{loop.before} ], [ {back}, %{end} ]"
                self.writer.fill(loop.head, f"{phi} = phi {type} {edges}")
        return end

    def _lanes_left(self, outer: Mask, diverges: bool) -> list[Leaf]:
        """Return the lanes that enter a loop, if lanes leave it one by one."""
        if not diverges:
            return []
        every = ("splat (i1 true)",) * self.arithmetic.lanes.chunks
        return [Leaf(Kind.BOOL, outer or every, False)]

    def _activate(self, lanes_left: _Carried) -> Leaf:
        """Make the remaining lanes the active ones."""
        self.expressions.mask = lanes_left.inside.names
        return lanes_left.inside

    def _all(self, tests: list[str]) -> str:
        """Return the conjunction of all tests."""
        joined = tests[0]
        for test in tests[1:]:
            joined = self.writer.value(f"and i1 {joined}, {test}")
        return joined

    def _body(self, body: tuple[Stmt, ...]) -> Leaf | None:
        """Write the body; return the condition of its final ``if leave: break``."""
        self.statements.level += 1
        leave: Leaf | None = None
        match body[-1:]:
            case (If(condition, (Break(),), ()),):
                self.statements.block(body[:-1])
                leave = self.expressions.scalar(condition)
            case _:
                self.statements.block(body)
        self.expressions.memo = {}
        self.statements.level -= 1
        return leave

    def _kept(
        self, loop: _VectorLoop, live: Leaf | None, body: tuple[Stmt, ...]
    ) -> dict[str, Leaves | Stored]:
        """Return the locals at the end of an iteration; lanes that left keep their values."""
        environment = dict(self.expressions.environment)
        if live is None:
            return environment
        inside = reads_in(body)
        for name, row in loop.variables.items():
            if self._dead_after(name, inside):
                continue
            changed = environment[name]
            assert not isinstance(changed, Stored)
            environment[name] = tuple(
                new if new == old.inside else self.arithmetic.select(live, new, old.inside)
                for new, old in zip(changed, row, strict=True)
            )
        return environment

    def _dead_after(self, name: str, inside: dict[str, int]) -> bool:
        """Return whether a Var is unused after the loop: declared beside it, read only inside."""
        statements = self.statements
        beside = statements.levels.get(name) == statements.level
        return beside and inside.get(name, 0) == statements.reads.get(name, 0)

    def _remaining(self, live: Leaf, leave: Leaf | None) -> Leaf:
        """Return the lanes that run the next iteration."""
        if leave is None:
            return live
        return self.arithmetic.spread(self.arithmetic.both(live, self.arithmetic.invert(leave)))

    def _polled(self) -> str:
        """Return a test that the work is not to stop, for loops that may run long."""
        self.expressions.program.polls = True
        flag = self.writer.value("load volatile i32, ptr %stop")
        return self.writer.value(f"icmp ne i32 {flag}, {STOP}")
