"""Find the form of each value that is the same in every pixel of a frame.

Input: a function, and the forms of its parameters. Output: the *form* of each expression: the same
value as an expression over constants, uniforms and those parameters that are per frame at every
call; None for a value that differs between pixels. Locals are tracked through straight code and
branches; a local that a loop changes has no form.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Final, TypeAlias

from distal.ir import build
from distal.ir.constant_arithmetic import ConstantArithmetic
from distal.ir.contents import contents, nodes_outside
from distal.ir.exits import never_ends
from distal.ir.nodes import (
    Assign,
    Break,
    Call,
    Const,
    Continue,
    Expr,
    For,
    Function,
    FunctionRef,
    If,
    Let,
    PerFrame,
    Read,
    Resource,
    Return,
    Select,
    Stmt,
    Swizzle,
    Uniform,
    Var,
    While,
)
from distal.ir.types import BOOL, Scalar, Vector
from distal.ir.walk import (
    children,
    map_indices,
    rebuild,
    root_of,
    roots_in,
    statements_in,
)
from distal.passes.cost import rounds
from distal.passes.fold.rules import Rules
from distal.passes.versions import assigned_in

_NOT_HOISTED: Final = frozenset((Resource, FunctionRef))

Forms: TypeAlias = Mapping[str, Expr]


def hoistable_calls(functions: tuple[Function, ...]) -> frozenset[str]:
    """Return the functions that may run once per frame, whether or not a pixel needs them.

    Excluded are functions with a ``while``, which might not terminate for arguments that the scene
    never passes, and functions that read a resource, which not every target's per-frame part can.
    """
    found: set[str] = set()
    for function in functions:
        if any(isinstance(s, While) for s in statements_in(function.body)):
            continue
        inside = [contents(e) for e in roots_in(function.body)]
        if all(c.kinds.isdisjoint(_NOT_HOISTED) and found.issuperset(c.callees) for c in inside):
            found.add(function.name)
    return frozenset(found)


class Forming:
    """Computes the forms of expressions, given the forms of locals in ``env``."""

    def __init__(self, precision: int, callable: frozenset[str]) -> None:
        self._rules = Rules(ConstantArithmetic(precision), {}, frozenset())
        self._callable = callable
        self.precision = precision

    def simplified(self, e: Expr) -> Expr:
        """Fold the root node of the expression."""
        return self._rules.simplify(e)

    def form(self, root: Expr, env: Forms, memo: dict[Expr, Expr | None]) -> Expr | None:
        """Return the form of an expression, or None.

        Args:
            root: The expression.
            env: The forms of the locals that have one.
            memo: The forms of the nodes processed so far; extended.
        """
        for e in nodes_outside(root, memo):
            memo[e] = self._node(e, env, memo)
        return memo[root]

    def _node(self, e: Expr, env: Forms, memo: dict[Expr, Expr | None]) -> Expr | None:
        match e:
            case Const() | Uniform() | PerFrame():
                return e
            case Read(name):
                return env.get(name)
            case Resource() | FunctionRef():
                return None
            case Call(function) if function not in self._callable:
                return None
            case _:
                operands: list[Expr] = []
                for c in children(e):
                    known = memo[c]
                    if known is None:
                        return None
                    operands.append(known)
                return self._rules.simplify(rebuild(e, tuple(operands)))

    def replaced(self, form: Expr, params: Forms) -> Expr:
        """Substitute a call's arguments in a callee's form; its Reads are all of parameters."""
        result = self.form(form, params, {})
        assert result is not None
        return result


@dataclass(frozen=True, slots=True)
class Here:
    """The place of an expression: the form of any part of it, and how often it is computed."""

    form: Callable[[Expr], Expr | None]
    rate: int
    name: str | None  # the name of the Let with this value, if any


Visit: TypeAlias = Callable[[Expr, Here], Expr]


class FlowWalk:
    """Traverses a function in order and calls ``visit`` for every expression, with its forms."""

    def __init__(self, function: Function, params: Forms, forming: Forming, visit: Visit) -> None:
        self._function = function
        self._forming = forming
        self._visit = visit
        self._env: dict[str, Expr] = dict(params)
        self._memo: dict[Expr, Expr | None] = {}
        self._rate = 1

    def run(self) -> Function:
        """Return the function with every expression replaced by the result of ``visit``."""
        return replace(self._function, body=self._block(self._function.body))

    def _expr(self, e: Expr, name: str | None = None) -> Expr:
        return self._visit(e, Here(self._form, self._rate, name))

    def _form(self, e: Expr) -> Expr | None:
        return self._forming.form(e, self._env, self._memo)

    def _set(self, name: str, form: Expr | None) -> None:
        self._memo = {}
        if form is None:
            self._env.pop(name, None)
        else:
            self._env[name] = form

    def _block(self, body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
        return tuple(self._statement(s) for s in body)

    def _statement(self, stmt: Stmt) -> Stmt:
        span = stmt.span
        match stmt:
            case Let(name, value):
                changed, form = self._expr(value, name), self._form(value)
                if form is not None:
                    self._env[name] = form
                return Let(name, changed, span=span)
            case Var(name, value):
                changed, form = self._expr(value, name), self._form(value)
                self._set(name, form)
                return Var(name, changed, span=span)
            case Assign(target, value):
                changed, form = self._expr(value), self._form(value)
                where = map_indices(target, self._expr)
                self._set(root_of(target).name, self._after(target, form))
                return Assign(where, changed, span=span)
            case Return(value):
                return Return(self._expr(value), span=span)
            case If():
                return self._if(stmt)
            case For(name, start, stop, step, body):
                start, stop = self._expr(start), self._expr(stop)
                body = self._loop(stmt, body)
                return For(name, start, stop, step, body, span=span)
            case While(condition, body):
                for name in assigned_in(body):
                    self._set(name, None)
                condition = self._expr(condition)
                return While(condition, self._loop(stmt, body), span=span)
            case Break() | Continue():
                return stmt

    def _after(self, target: Expr, value: Expr | None) -> Expr | None:
        """Return the form of a Var after an assignment."""
        if isinstance(target, Read) or value is None:
            return value
        if not isinstance(target, Swizzle) or not isinstance(target.base, Read):
            return None
        before = self._env.get(target.base.name)
        if before is None:
            return None
        parts = list(build.components(before))
        for lane, part in zip(target.lanes, build.components(value), strict=True):
            parts["xyzw".index(lane)] = part
        simple = [self._forming.simplified(p) for p in parts]
        return self._forming.simplified(build.compose(before.type, *simple))

    def _loop(self, stmt: For | While, body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
        changed = assigned_in(body)
        for name in changed:
            self._set(name, None)
        rate, self._rate = self._rate, self._rate * max(1, rounds(stmt))
        done = self._block(body)
        self._rate = rate
        for name in changed:
            self._set(name, None)
        return done

    def _if(self, stmt: If) -> If:
        condition, test = self._expr(stmt.condition), self._form(stmt.condition)
        before = dict(self._env)
        then = self._block(stmt.then)
        yes, self._env, self._memo = self._env, before, {}
        before = dict(before)
        otherwise = self._block(stmt.otherwise)
        no, self._memo = self._env, {}
        if never_ends(stmt.then):
            self._env = no
        elif never_ends(stmt.otherwise):
            self._env = yes
        else:
            self._env = before
            for name in assigned_in((stmt,)):
                self._set(name, _either(test, yes.get(name), no.get(name)))
        return If(condition, then, otherwise, span=stmt.span)


def _either(test: Expr | None, yes: Expr | None, no: Expr | None) -> Expr | None:
    """Return the form of a local that a branch may have changed."""
    if yes is None or no is None or yes is no:
        return yes if no is not None else None
    if test is None or not isinstance(yes.type, Scalar | Vector):
        return None
    assert test.type is BOOL
    return Select(test, yes, no, yes.type)
