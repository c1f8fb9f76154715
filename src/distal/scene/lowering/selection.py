"""Statements that compute one of two values: only the one that a condition selects.

Input: a condition, which is the same for all pixels, and functions that add what each value needs
to a list of statements. Output: the value. The other one costs a branch that no pixel takes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from distal.ir.build import number
from distal.ir.nodes import Assign, Const, Expr, If, Read, Var
from distal.ir.types import FLOAT, Type
from distal.scene.tree.values import StatementList

# Adds statements, and returns the value that they compute.
Make: TypeAlias = Callable[[StatementList], Expr]


def selected(
    body: StatementList, second: Expr, make_a: Make, make_b: Make, type: Type = FLOAT
) -> Expr:
    """Return the value of the second if the condition holds, else that of the first.

    Args:
        body: The statements to add to.
        second: The condition.
        make_a: Adds the first.
        make_b: Adds the second.
        type: The type of both.
    """
    if isinstance(second, Const):
        return (make_b if second.value else make_a)(body)
    name = body.fresh("chosen")
    body.statements.append(Var(name, number(0.0, type), span=body.place))
    target = Read(name, type)
    blocks = []
    for make in (make_b, make_a):
        block = body.block()
        block.statements.append(Assign(target, make(block), span=body.place))
        blocks.append(tuple(block.statements))
    body.statements.append(If(second, *blocks, span=body.place))
    return body.let("d", target)
