"""Analysis of how control leaves statements and blocks.

Input: statements. Output: whether they return, break or continue, or whether control reaches the
statement after them.
"""

from __future__ import annotations

from collections.abc import Collection

from distal.ir.nodes import Break, Const, Continue, For, If, Return, Stmt, While
from distal.ir.walk import blocks, statements_in


def never_goes_on(stmt: Stmt) -> bool:
    """Return whether the statement after this one is never reached."""
    match stmt:
        case Return() | Break() | Continue():
            return True
        case If(_, then, otherwise):
            return never_ends(then) and never_ends(otherwise)
        case While(Const(True), body):
            return not _breaks(body)
        case _:
            return False


def never_ends(body: Collection[Stmt]) -> bool:
    """Return whether no path reaches the end of the block."""
    return any(map(never_goes_on, body))


def _breaks(body: Collection[Stmt]) -> bool:
    """Return whether a Break in this block leaves the loop whose body this block is."""
    return any(
        isinstance(stmt, Break)
        or (isinstance(stmt, If) and (_breaks(stmt.then) or _breaks(stmt.otherwise)))
        for stmt in body
    )


def returns(body: tuple[Stmt, ...]) -> bool:
    """Return whether the block, or a block inside it, contains a Return."""
    return any(isinstance(stmt, Return) for stmt in statements_in(body))


def may_exit(stmt: Stmt) -> bool:
    """Return whether control may leave the statement other than through its end."""
    match stmt:
        case Return() | Break() | Continue():
            return True
        case For() | While():
            return returns(stmt.body)  # breaks and continues of the loop itself stay inside it
        case _:
            return any(may_exit(inner) for block in blocks(stmt) for inner in block)
