"""Loops under lane masks.

What flows in: predicated loops, whose one way out besides their end is a last ``if flag: break``.
What flows out: instructions. A loop goes round while a lane is left; its Vars keep their value in
lanes that have left, unless nobody reads them afterwards. A count that is the same in all lanes is
a scalar, even where lanes leave one by one. Loops that may go on for long ask whether to stop.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from distal.backends.llvm.costs import constant_rounds
from distal.backends.llvm.lanes import Leaf, Leaves, Stored
from distal.backends.llvm.uniformity import reads_in
from distal.ir.nodes import Assign, Break, For, If, Stmt, While
from distal.ir.types import Kind
from distal.ir.walk import root_of, statements_in

if TYPE_CHECKING:
    from distal.backends.llvm.statements import Statements

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
        self.statements.join(before, ends)

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
        self.statements.join(before, [(before, skipped), (ahead, end)])

    def conditional(self, stmt: While) -> None:
        """Write a loop that goes on while a condition holds."""
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
        self.statements.join(before, ends)

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
        self, loop: _Loop, live: tuple[Leaf, object] | None, body: tuple[Stmt, ...]
    ) -> dict[str, Leaves | Stored]:
        """The locals at a round's end; lanes that left before it keep their values."""
        environment = dict(self.expressions.environment)
        if live is None:
            return environment
        inside = reads_in(body)
        for name in loop.names:
            if self._dead_after(name, inside):
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

    def _dead_after(self, name: str, inside: dict[str, int]) -> bool:
        """Whether a Var is of no use after the loop: bound beside it and read inside only."""
        statements = self.statements
        beside = statements.levels.get(name) == statements.level
        return beside and inside.get(name, 0) == statements.reads.get(name, 0)

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
