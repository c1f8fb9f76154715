"""Convert a function's body to a form that can replace a call.

Input: a function's body. Output: statements that compute the result, without a Return, and the
result as an expression over their locals; or None if this would need flags (a return inside a loop,
or on only some paths through a branch).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from distal.ir import build
from distal.ir.exits import returns
from distal.ir.nodes import (
    Assign,
    Construct,
    Expr,
    For,
    Function,
    If,
    Let,
    Read,
    Return,
    Select,
    Stmt,
    Var,
    While,
)
from distal.ir.types import Array, Matrix, Scalar, Struct, Type, Vector
from distal.passes.cost import Costs

# A vector machine computes both values of a Select, but it can skip the branch of an If.
PICK_COST: Final = 16

RESULT: Final = "result"


@dataclass(frozen=True, slots=True)
class Straight:
    """Statements without a Return, and the function's result after them."""

    body: tuple[Stmt, ...]
    value: Expr

    @property
    def only_lets(self) -> bool:
        """Whether the statements only name parts of one expression."""
        return all(isinstance(s, Let) for s in self.body)


def straighten(function: Function, result: str, costs: Costs) -> Straight | None:
    """Return the function's body without Return, or None if this would need flags.

    Args:
        function: The function.
        result: A name that is not used in the function.
        costs: Costs of expressions.
    """
    body = function.body
    if not body:
        return None
    last = body[-1]
    if isinstance(last, Return) and not returns(body[:-1]):
        return Straight(body[:-1], last.value)
    target = Read(result, function.result)
    ladder = _ladder(body, target, costs)
    if ladder is None:
        return None
    last = ladder[-1]
    if isinstance(last, Assign) and last.target is target:
        return Straight(tuple(ladder[:-1]), last.value)
    return Straight((Var(result, zero(function.result)), *ladder), target)


def _ladder(body: tuple[Stmt, ...], result: Read, costs: Costs) -> list[Stmt] | None:
    """Replace each Return by an assignment; None if this would need flags.

    The statements after a branch that returns move into the other branch.
    """
    done: list[Stmt] = []
    for i, stmt in enumerate(body):
        match stmt:
            case Return(value):
                done.append(Assign(result, value, span=stmt.span))
                return done
            case If(condition, then, otherwise) if returns((stmt,)):
                rest = body[i + 1 :]
                if not _always_returns(then):
                    if returns(then):
                        return None
                    then += rest
                if not _always_returns(otherwise):
                    if returns(otherwise) or len(then) != len(stmt.then):
                        return None
                    otherwise += rest
                yes, no = _ladder(then, result, costs), _ladder(otherwise, result, costs)
                if yes is None or no is None:
                    return None
                picked = _pick(condition, yes, no, result, costs)
                done.append(picked or If(condition, tuple(yes), tuple(no), span=stmt.span))
                return done
            case For() | While() if returns((stmt,)):
                return None
            case _:
                done.append(stmt)
    return None


def _always_returns(body: tuple[Stmt, ...]) -> bool:
    match body[-1] if body else None:
        case Return():
            return True
        case If(_, then, otherwise):
            return _always_returns(then) and _always_returns(otherwise)
        case _:
            return False


def _pick(
    condition: Expr, yes: list[Stmt], no: list[Stmt], result: Read, costs: Costs
) -> Assign | None:
    """Return a Select if both branches only compute the result, at low cost; else None."""
    match yes, no:
        case [Assign(_, a)], [Assign(_, b)] if costs.of(a) + costs.of(b) <= PICK_COST:
            return Assign(result, Select(condition, a, b, result.type))
        case _:
            return None


def zero(type: Type) -> Expr:
    """Return the zero value of a type, as the initial value of a Var.

    Raises:
        AssertionError: The type is not a value type.
    """
    match type:
        case Scalar() | Vector():
            return build.number(0, type)
        case Matrix(size):
            column = build.number(0.0, build.element_type(type))
            return build.compose(type, *[column] * size)
        case Struct(_, fields):
            return Construct(tuple(zero(t) for _, t in fields), type)
        case Array(element, length):
            return Construct((zero(element),) * length, type)
        case _:
            raise AssertionError(f"no value of {type}")
