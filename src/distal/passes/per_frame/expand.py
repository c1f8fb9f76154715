"""Expand calls in per-frame values, so that values share what their calls have in common.

Input: the functions of a module and an expression. Output: the same value as an expression in which
long functions without branches and loops are written out. The rays of a camera, for example, all
need the lens that moves it: written out, the lens is one expression, computed once.
"""

from __future__ import annotations

from typing import Final

from distal.ir.contents import nodes_outside
from distal.ir.nodes import Call, Expr, Function, Let, Read, Return
from distal.ir.walk import children, rebuild
from distal.passes.cost import Costs
from distal.passes.per_frame.forms import Forming

LEAST_COST: Final = 60  # of a function that is written out; a careful sine costs about 30


class Expansion:
    """Writes out the calls of expressions of one module.

    Attributes:
        names: The author's names of parts of the expressions.
    """

    def __init__(self, functions: tuple[Function, ...], forming: Forming, costs: Costs) -> None:
        self._forming = forming
        self._functions = {
            f.name: f for f in functions if _is_straight(f) and costs.calls[f.name] >= LEAST_COST
        }
        self._memo: dict[Expr, Expr] = {}
        self.names: dict[Expr, str] = {}

    def expanded(self, root: Expr) -> Expr:
        """Return the expression without calls of long straight functions."""
        return self._value(root, self._memo)

    def _value(self, root: Expr, memo: dict[Expr, Expr]) -> Expr:
        for e in nodes_outside(root, memo):
            value = rebuild(e, tuple([memo[c] for c in children(e)]))
            memo[e] = self._call(value) if isinstance(value, Call) else self._simple(value)
        return memo[root]

    def _simple(self, e: Expr) -> Expr:
        return self._forming.simplified(e) if children(e) else e

    def _call(self, call: Call) -> Expr:
        function = self._functions.get(call.function)
        if function is None:
            return call
        done = self._memo.get(call)
        if done is None:
            memo: dict[Expr, Expr] = {
                Read(p.name, p.type): a for p, a in zip(function.params, call.args, strict=True)
            }
            for stmt in function.body:
                match stmt:
                    case Let(name, value):
                        part = self._value(value, memo)
                        memo[Read(name, value.type)] = part
                        self.names.setdefault(part, name)
                    case Return(value):
                        done = self._value(value, memo)
            assert done is not None
            self._memo[call] = done
        return done


def _is_straight(function: Function) -> bool:
    """Return whether a function only names parts of one expression."""
    *lets, last = function.body or (None,)
    return isinstance(last, Return) and all(isinstance(s, Let) for s in lets)
