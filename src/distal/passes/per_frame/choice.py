"""Which expressions of a function should be computed once a frame.

Input: a function, costs, and the forms of expressions where they stand. Output: yes or no for each,
and the calls that are left to pixels. Asked twice, once to learn what calls pass on and once to
rewrite, it answers the same.
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
    """The choices in one function."""

    def __init__(self, function: Function, costs: Costs) -> None:
        self._costs = costs
        reads: Counter[str] = Counter()
        lets: set[str] = set()
        for stmt in statements_in(function.body):
            roots = expressions(stmt)
            reads.update(e.name for e in roots if isinstance(e, Read))
            for e in nodes_in(*roots):
                reads.update(c.name for c in children(e) if isinstance(c, Read))
            if isinstance(stmt, Let):
                lets.add(stmt.name)
        self._read_once = {name for name in lets if reads[name] == 1}

    def picks(self, e: Expr, here: Here) -> bool:
        """True when the expression as a whole shall be computed once a frame.

        A local that is read in several places counts nothing here: it is computed once a frame
        by itself, and a sum of it does not pay for another value.
        """
        if isinstance(e, Splat | Construct) or not (is_carried(e.type) or is_exploded(e.type)):
            return False
        form = here.form(e)
        if form is None:
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
        """The calls in an expression that pixels will make."""
        seen: set[Expr] = set()
        stack = [root]
        while stack:
            e = stack.pop()
            if e in seen:
                continue
            seen.add(e)
            if self.picks(e, here):
                continue
            if isinstance(e, Call):
                yield e
            stack.extend(children(e))
