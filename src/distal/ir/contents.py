"""What an expression contains, found once for each expression.

Input: an expression. Output: its nodes, and the names that they read and call. Passes ask for the
same expressions again and again: nodes are interned, so the answer is kept on the node and lives as
long as it (decision 29).
"""

from __future__ import annotations

from collections.abc import Container
from itertools import chain
from typing import Any, Final

from distal.ir.nodes import Call, Const, Expr, FunctionRef, PerFrame, Read
from distal.ir.operands import OPERANDS

# The longest list of nodes that is kept: then the lists of an expression and of all its parts take
# memory in proportion to its length.
_LONGEST: Final = 400

_NOTHING: Final[frozenset[Any]] = frozenset()


class Contents:
    """The nodes of an expression, itself included, and what they refer to.

    An expression of more than ``_LONGEST`` nodes is *long*. What is in a long part of it was
    computed for that part, so that a chain of n expressions, each with the one before in it, takes
    work and memory in proportion to n.

    Attributes:
        below: The distinct nodes below the expression, operands before users; None: it is long.
        own: The nodes of a long expression that are in none of its ``parts``.
        parts: The long expressions that were looked at before and are parts of a long one.
        kinds: The classes of the nodes.
        reads: The names of the parameters and locals that it reads.
        frames: The names of the per-frame values that it reads.
        callees: The functions that it calls or refers to, each once.
        called: For each distinct Call, the name of the function; None: not computed.
        size: The number of distinct nodes, except constants and reads; None: not computed.
        cost: The cost of all nodes except calls, once ``distal.passes.cost`` has computed it.
        lane_cost: The same of ``distal.backends.llvm.costs``.
    """

    __slots__ = (
        *("below", "called", "callees", "cost", "frames", "kinds", "lane_cost", "own", "parts"),
        *("reads", "size"),
    )

    def __init__(self, nodes: list[Expr], parts: list[Expr]) -> None:
        is_short = not parts and len(nodes) <= _LONGEST
        self.below = tuple(nodes[:-1]) if is_short else None
        self.own = () if is_short else tuple(nodes)
        self.parts = tuple(parts)
        self.kinds = frozenset(map(type, nodes))
        self.reads = _NOTHING
        self.frames = _NOTHING
        self.called: tuple[str, ...] | None = None if parts else ()
        self.callees: tuple[str, ...] = ()
        if Read in self.kinds:
            self.reads = frozenset([n.name for n in nodes if type(n) is Read])
        if PerFrame in self.kinds:
            self.frames = frozenset([n.name for n in nodes if type(n) is PerFrame])
        if Call in self.kinds or FunctionRef in self.kinds:
            functions = [n for n in nodes if isinstance(n, Call | FunctionRef)]
            names = [n.function if isinstance(n, Call) else n.name for n in functions]
            self.callees = tuple(dict.fromkeys(names))
            if not parts:
                self.called = tuple([n.function for n in functions if isinstance(n, Call)])
        self.cost: int | None = None
        self.lane_cost: int | None = None
        self.size: int | None = None if parts else _size(nodes)
        if parts:
            self._add(list(map(contents, parts)))

    def _add(self, parts: list[Contents]) -> None:
        """Add what was computed for parts of a long expression."""
        self.kinds = self.kinds.union(*[part.kinds for part in parts])
        self.reads = self.reads.union(*[part.reads for part in parts])
        self.frames = self.frames.union(*[part.frames for part in parts])
        names = chain(*[part.callees for part in parts], self.callees)
        self.callees = tuple(dict.fromkeys(names))


def contents(e: Expr) -> Contents:
    """Return what an expression contains."""
    try:
        found: Contents = e.memo
    except AttributeError:
        parts: list[Expr] = []
        found = Contents(_walked(e, parts=parts), parts)
        object.__setattr__(e, "memo", found)
    return found


def calls_in(e: Expr) -> tuple[str, ...]:
    """Return the name of the function of each distinct Call in an expression."""
    record = contents(e)
    if record.called is None:
        record.called = tuple([n.function for n in _walked(e) if isinstance(n, Call)])
    return record.called


def size_of(e: Expr) -> int:
    """Return the number of distinct nodes of an expression, except constants and reads."""
    record = contents(e)
    if record.size is None:
        record.size = _size(_walked(e))
    return record.size


def _size(nodes: list[Expr]) -> int:
    return len(nodes) - sum([type(n) is Const or type(n) is Read for n in nodes])


def _is_long(e: Expr) -> bool:
    memo: Contents | None = getattr(e, "memo", None)
    return memo is not None and memo.below is None


def nodes_of(e: Expr) -> tuple[Expr, ...]:
    """Return the distinct nodes of an expression, operands before users, the expression last."""
    below = contents(e).below
    return tuple(_walked(e)) if below is None else (*below, e)


def nodes_outside(root: Expr, memo: Container[Expr]) -> list[Expr]:
    """Return the nodes of an expression as ``nodes_of``, without those in ``memo`` and below."""
    return [] if root in memo else _walked(root, memo)


def _walked(root: Expr, memo: Container[Expr] = (), parts: list[Expr] | None = None) -> list[Expr]:
    """Return the nodes of an expression, operands before users.

    Args:
        root: The expression.
        memo: Nodes that are left out, with all that is below them.
        parts: Gets the long parts that were looked at before; they are left out. None: none is.
    """
    # A node is pushed again inside a one-element tuple; it is appended when the tuple is popped,
    # after its operands.
    found: list[Expr] = []
    seen: set[Expr] = set()
    stack: list[Any] = [root]
    while stack:
        e = stack.pop()
        if type(e) is tuple:
            found.append(e[0])
        elif e not in seen and e not in memo:
            seen.add(e)
            operands = OPERANDS[type(e)](e)
            if not operands:
                found.append(e)
            elif parts is not None and _is_long(e):
                parts.append(e)
            else:
                stack.append((e,))
                stack.extend(operands[::-1])
    return found
