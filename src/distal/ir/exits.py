"""How control leaves statements and blocks.

Input: statements. Output: whether they return, break, or let control run on to what follows.
"""

from __future__ import annotations

from collections.abc import Collection

from distal.ir.nodes import Break, Const, Continue, For, If, Return, Stmt, While
from distal.ir.walk import blocks, statements_in


def never_goes_on(stmt: Stmt) -> bool:
    """True when the statement after this one is never reached."""
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
    """True when no path reaches the end of the block."""
    return any(map(never_goes_on, body))


def _breaks(body: Collection[Stmt]) -> bool:
    """True when a Break in this block leaves the loop whose body it is."""
    return any(
        isinstance(stmt, Break)
        or (isinstance(stmt, If) and (_breaks(stmt.then) or _breaks(stmt.otherwise)))
        for stmt in body
    )


def returns(body: tuple[Stmt, ...]) -> bool:
    """True when there is a Return in the block or in blocks inside it."""
    return any(isinstance(stmt, Return) for stmt in statements_in(body))


def may_exit(stmt: Stmt) -> bool:
    """True when control may leave past the end of the statement."""
    match stmt:
        case Return() | Break() | Continue():
            return True
        case For() | While():
            return returns(stmt.body)  # its own breaks stay inside
        case _:
            return any(may_exit(inner) for block in blocks(stmt) for inner in block)
