"""What an expression contains, found once for each expression.

Input: an expression. Output: its nodes, and the names that they read and call. Passes ask for the
same expressions again and again: nodes are interned, so the answer is kept on the node and lives as
long as it (decision 29).
"""

from __future__ import annotations

from typing import Any, Final

from distal.ir.nodes import Call, Const, Expr, FunctionRef, PerFrame, Read
from distal.ir.operands import OPERANDS

# The longest list of nodes that is kept: then the lists of an expression and of all its parts take
# memory in proportion to its length.
_LONGEST: Final = 400

_NOTHING: Final[frozenset[Any]] = frozenset()


class Contents:
    """The nodes of an expression, itself included, and what they refer to.

    Attributes:
        below: The distinct nodes below the expression, operands before users; None: not kept.
        kinds: The classes of the nodes.
        reads: The names of the parameters and locals that it reads.
        frames: The names of the per-frame values that it reads.
        called: For each distinct Call, the name of the function.
        callees: The functions that it calls or refers to, each once.
        size: The number of distinct nodes, except constants and reads.
        cost: The cost of all nodes except calls, once ``distal.passes.cost`` has computed it.
        lane_cost: The same of ``distal.backends.llvm.costs``.
    """

    __slots__ = (
        *("below", "called", "callees", "cost", "frames", "kinds", "lane_cost", "reads", "size"),
    )

    def __init__(self, nodes: list[Expr]) -> None:
        self.below = tuple(nodes[:-1]) if len(nodes) <= _LONGEST else None
        self.kinds = frozenset(map(type, nodes))
        self.reads = _NOTHING
        self.frames = _NOTHING
        self.called: tuple[str, ...] = ()
        self.callees: tuple[str, ...] = ()
        if Read in self.kinds:
            self.reads = frozenset([n.name for n in nodes if type(n) is Read])
        if PerFrame in self.kinds:
            self.frames = frozenset([n.name for n in nodes if type(n) is PerFrame])
        if Call in self.kinds:
            self.called = tuple([n.function for n in nodes if type(n) is Call])
            self.callees = tuple(dict.fromkeys(self.called))
        if FunctionRef in self.kinds:
            functions = [n for n in nodes if isinstance(n, Call | FunctionRef)]
            names = [n.function if isinstance(n, Call) else n.name for n in functions]
            self.callees = tuple(dict.fromkeys(names))
        self.cost: int | None = None
        self.lane_cost: int | None = None
        self.size = len(nodes) - sum([type(n) is Const or type(n) is Read for n in nodes])


def contents(e: Expr) -> Contents:
    """Return what an expression contains."""
    try:
        found: Contents = e.memo
    except AttributeError:
        found = Contents(_walked(e))
        object.__setattr__(e, "memo", found)
    return found


def nodes_of(e: Expr) -> tuple[Expr, ...]:
    """Return the distinct nodes of an expression, operands before users, the expression last."""
    below = contents(e).below
    return tuple(_walked(e)) if below is None else (*below, e)


def _walked(root: Expr) -> list[Expr]:
    # A node is pushed again inside a one-element tuple; it is appended when the tuple is popped,
    # after its operands.
    found: list[Expr] = []
    seen: set[Expr] = set()
    stack: list[Any] = [root]
    while stack:
        e = stack.pop()
        if type(e) is tuple:
            found.append(e[0])
        elif e not in seen:
            seen.add(e)
            operands = OPERANDS[type(e)](e)
            if operands:
                stack.append((e,))
                stack.extend(operands[::-1])
            else:
                found.append(e)
    return found
