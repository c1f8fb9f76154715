"""Split expressions into Lets before they become too deep or too long for a shader compiler.

Input: the body of a function. Output: the same body with no expression nested deeper than about
``DEEPEST``, and none whose text, with shared parts written out, would be longer than about
``LONGEST`` nodes. (naga's recursive parser crashes on thousands of nested parentheses.)
"""

from __future__ import annotations

from typing import Final

from distal.ir import build
from distal.ir.nodes import Assign, Break, Expr, If, Let, Read, Stmt, While
from distal.ir.types import is_static
from distal.ir.walk import children, map_statement, nodes_in, rebuild
from distal.passes.naming import FreshNames

DEEPEST: Final = 50
LONGEST: Final = 1000
SHARED: Final = "shared"  # the names of new Lets are this and a number


def split_deep(body: tuple[Stmt, ...], names: FreshNames) -> tuple[Stmt, ...]:
    """Split the expressions of every statement."""
    result: list[Stmt] = []
    for stmt in body:
        before: list[Stmt] = []

        def cut(e: Expr, before: list[Stmt] = before, stmt: Stmt = stmt) -> Expr:
            return split_expression(e, names, before, stmt)

        changed = map_statement(stmt, cut, lambda block: split_deep(block, names))
        if before and isinstance(changed, While):
            # The condition is computed in each iteration, so it moves into the loop with its parts.
            stop = If(build.negation(changed.condition), (Break(),), (), span=stmt.span)
            rounds = (*before, stop, *changed.body)
            before, changed = [], While(build.boolean(True), rounds, span=stmt.span)
        result.extend(before)
        result.append(changed)
    return tuple(result)


def split_expression(root: Expr, names: FreshNames, before: list[Stmt], stmt: Stmt) -> Expr:
    """Split an expression into Lets.

    Args:
        root: The expression.
        names: The taken names.
        before: Gets the Lets, to insert before the statement.
        stmt: The statement that contains the expression.

    Returns:
        The expression, which reads the Lets.
    """
    done: dict[Expr, Expr] = {}
    # Depth and length of the replacement of a node, with its shared parts written out.
    depths: dict[Expr, int] = {}
    lengths: dict[Expr, int] = {}
    for e in nodes_in(root):
        operands = children(e)
        depth = 1 + max((depths[c] for c in operands), default=0)
        length = 1 + sum(lengths[c] for c in operands)
        changed = rebuild(e, tuple([done[c] for c in operands]))
        too_long = depth >= DEEPEST or length >= LONGEST
        if too_long and e is not root and _may_be_bound(e, stmt):
            name = names.numbered(SHARED)
            before.append(Let(name, changed, span=stmt.span))
            changed, depth, length = Read(name, e.type), 1, 1
        done[e], depths[e], lengths[e] = changed, depth, length
    return done[root]


def _may_be_bound(e: Expr, stmt: Stmt) -> bool:
    if is_static(e.type) or not children(e):
        return False
    # A part of an Assign's target must not be replaced by a local.
    return not (isinstance(stmt, Assign) and e in target_parts(stmt.target))


def target_parts(target: Expr) -> set[Expr]:
    """Return a target and all targets that it is a part of."""
    parts = {target}
    while not isinstance(target, Read):
        target = children(target)[0]
        parts.add(target)
    return parts
