"""Decide which expressions of a function should be computed once per frame.

Input: a function, costs, and the forms of expressions at their places. Output: a decision for each
expression, and the calls that pixels still make. The pass asks twice, first to collect the
arguments of calls and then to rewrite; the decisions are the same both times.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from distal.ir.nodes import Call, Construct, Expr, Function, Let, Read, Splat
from distal.ir.walk import children, expressions, nodes_in, statements_in
from distal.passes.cost import Costs, node_cost
from distal.passes.per_frame.forms import Here
from distal.passes.per_frame.values import LEAST_COST, is_carried, is_exploded


class Picking:
    """The decisions for one function."""

    def __init__(self, function: Function, costs: Costs) -> None:
        self._costs = costs
        self.has_picked = False  # whether ``calls`` has met an expression that is picked
        reads: Counter[str] = Counter()
        lets: set[str] = set()
        for stmt in statements_in(function.body):
            roots = expressions(stmt)
            reads.update([e.name for e in roots if type(e) is Read])
            for e in nodes_in(*roots):
                for c in children(e):
                    if type(c) is Read:
                        reads[c.name] += 1
            if isinstance(stmt, Let):
                lets.add(stmt.name)
        self._read_once = {name for name in lets if reads[name] == 1}

    def picks(self, e: Expr, here: Here) -> bool:
        """Return whether the expression as a whole should be computed once per frame.

        A local that is read in several places does not count as cost: it is computed once per frame
        itself, and a sum of such locals is not worth another per-frame value.
        """
        form = here.form(e)
        if form is None or isinstance(e, Splat | Construct):
            return False
        if not (is_carried(e.type) or is_exploded(e.type)):
            return False
        if isinstance(e, Read | Call):
            return self._costs.of(form) >= LEAST_COST
        cost = 0
        for n in nodes_in(e):
            if isinstance(n, Read) and n.name in self._read_once:
                known = here.form(n)
                assert known is not None
                cost += self._costs.of(known)
            cost += node_cost(n, self._costs.calls)
            if cost >= LEAST_COST:
                return True
        return False

    def calls(self, root: Expr, here: Here) -> Iterator[Call]:
        """Yield the calls in an expression that pixels will make."""
        seen: set[Expr] = set()
        stack = [root]
        while stack:
            e = stack.pop()
            if e in seen:
                continue
            seen.add(e)
            if self.picks(e, here):
                self.has_picked = True
                continue
            if isinstance(e, Call):
                yield e
            stack.extend(children(e))
