"""Turn early exits into flags, for targets that run many pixels in lockstep.

Input: functions with return, break and continue anywhere. Output: functions whose only Return is
the last statement, and loops whose only Break is a last statement ``if flag: break``. A backend
with lane masks then only has to handle ifs and loops. Does not depend on masks.

If one branch of an If always exits, the statements after the If move into the other branch, which
costs nothing; a flag is created only for exits that are nested more deeply.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import assert_never

from distal.diagnostics import Span
from distal.ir import build
from distal.ir.exits import may_exit, returns
from distal.ir.nodes import (
    Assign,
    Break,
    Compose,
    Construct,
    Continue,
    Expr,
    For,
    Function,
    If,
    Let,
    Module,
    Read,
    Return,
    Stmt,
    Unary,
    UnaryOp,
    Var,
    While,
)
from distal.ir.types import (
    BOOL,
    Array,
    Buffer,
    FunctionType,
    Matrix,
    Scalar,
    Struct,
    Texture,
    Type,
    Vector,
)
from distal.ir.walk import statements_in
from distal.passes.context import Context

_Block = tuple[Stmt, ...]
_EXITS = (Return, Break, Continue)


def run(module: Module, context: Context) -> Module:
    """Predicate every function, if the target requires it."""
    if not context.target.predicated:
        return module
    return replace(module, functions=tuple(map(predicated, module.functions)))


def predicated(function: Function) -> Function:
    """Return the function with a single Return at its end and one exit at the end of each loop."""
    *before, last = function.body
    exits = any(isinstance(s, _EXITS) for s in statements_in(tuple(before)))
    if isinstance(last, Return) and not exits:
        return function
    return replace(function, body=_Predicate(function).body())


def zero(type: Type) -> Expr:
    """Return the value of a type with every component zero or false.

    Raises:
        AssertionError: The type is not a value type.
    """
    match type:
        case Scalar() | Vector():
            return build.number(0, type)
        case Matrix(size):
            column = build.number(0, build.element_type(type))
            return Compose((column,) * size, type)
        case Struct(_, fields):
            return Construct(tuple(zero(t) for _, t in fields), type)
        case Array(element, length):
            return Construct((zero(element),) * length, type)
        case Texture() | Buffer() | FunctionType():
            raise AssertionError(f"{type} is not a value")
        case _:
            assert_never(type)


@dataclass(slots=True)
class _LoopFlags:
    """The flags of the loop being rewritten, created when first needed."""

    leave: str | None = None  # set when the loop ends
    skip: str | None = None  # set when the current iteration ends


def _always_exits(block: _Block) -> bool:
    """Return whether control never reaches the end of a block."""
    if not block:
        return False
    match block[-1]:
        case Return() | Break() | Continue():
            return True
        case If(_, then, otherwise):
            return _always_exits(then) and _always_exits(otherwise)
        case _:
            return False


class _Predicate:
    """Rewrites one function."""

    def __init__(self, function: Function) -> None:
        self.function = function
        self.names = {p.name for p in function.params} | {
            s.name for s in statements_in(function.body) if isinstance(s, Let | Var | For)
        }
        self.result = self._fresh("result")
        self.returned: str | None = None

    def body(self) -> _Block:
        inner = self._block(self._guarded(self.function.body, in_loop=False), None)
        head: list[Stmt] = [Var(self.result, zero(self.function.result), span=self.function.span)]
        if self.returned is not None:
            head.append(Var(self.returned, build.boolean(False), span=self.function.span))
        last = Return(Read(self.result, self.function.result), span=self.function.span)
        return (*head, *inner, last)

    def _guarded(self, block: _Block, *, in_loop: bool) -> _Block:
        """Return the block with an exit after each loop that may return."""
        done: list[Stmt] = []
        for stmt in block:
            match stmt:
                case If(condition, then, otherwise):
                    inner = (self._guarded(b, in_loop=in_loop) for b in (then, otherwise))
                    done.append(If(condition, *inner, span=stmt.span))
                case For() | While():
                    done.append(replace(stmt, body=self._guarded(stmt.body, in_loop=True)))
                    if returns(stmt.body):
                        leave: Stmt = Break(span=stmt.span)
                        if not in_loop:
                            leave = Return(self._result(), span=stmt.span)
                        flag = Read(self._returned(), BOOL)
                        done.append(If(flag, (leave,), (), span=stmt.span))
                case Let() | Var() | Assign() | Return() | Break() | Continue():
                    done.append(stmt)
                case _:
                    assert_never(stmt)
        return tuple(done)

    def _result(self) -> Read:
        return Read(self.result, self.function.result)

    def _fresh(self, wanted: str) -> str:
        name, count = wanted, 2
        while name in self.names:
            name, count = f"{wanted}_{count}", count + 1
        self.names.add(name)
        return name

    def _block(self, block: _Block, loop: _LoopFlags | None) -> _Block:
        """Return a block without exits: the statements after an exit are moved or guarded."""
        done: list[Stmt] = []
        for position, stmt in enumerate(block):
            rest = block[position + 1 :]
            match stmt:
                case Return(value):
                    if value is not self._result():
                        done.append(Assign(self._result(), value, span=stmt.span))
                    if loop is not None:
                        done.append(_raise(self._returned(), stmt.span))
                        done.append(_raise(self._leave(loop), stmt.span))
                    return tuple(done)
                case Break():
                    assert loop is not None
                    done.append(_raise(self._leave(loop), stmt.span))
                    return tuple(done)
                case Continue():
                    assert loop is not None
                    return tuple(done)
                case If() if may_exit(stmt):
                    done.extend(self._branch(stmt, rest, loop))
                    return tuple(done)
                case For() | While():
                    done.append(self._loop(stmt))
                case If(_, then, otherwise):
                    done.append(self._if(stmt, then, otherwise, loop))
                case Let() | Var() | Assign():
                    done.append(stmt)
                case _:
                    assert_never(stmt)
        return tuple(done)

    def _branch(self, stmt: If, rest: _Block, loop: _LoopFlags | None) -> Iterator[Stmt]:
        """Yield the statements for an If that may exit and for the statements after it."""
        then, otherwise = stmt.then, stmt.otherwise
        if _always_exits(then):
            yield self._if(stmt, then, (*otherwise, *rest), loop)
        elif _always_exits(otherwise):
            yield self._if(stmt, (*then, *rest), otherwise, loop)
        elif loop is None:
            # Outside a loop the nested exit is a Return: the rest runs if none was executed.
            flag = self._returned()
            yield self._if(stmt, self._marked(then, flag), self._marked(otherwise, flag), None)
            yield from self._unless(flag, self._block(rest, None), stmt.span)
        else:
            if loop.skip is None:
                loop.skip = self._fresh("skip")
            flag = loop.skip
            yield self._if(stmt, self._marked(then, flag), self._marked(otherwise, flag), loop)
            yield from self._unless(flag, self._block(rest, loop), stmt.span)

    def _if(self, stmt: If, then: _Block, otherwise: _Block, loop: _LoopFlags | None) -> If:
        condition, yes, no = stmt.condition, self._block(then, loop), self._block(otherwise, loop)
        if not yes:
            condition, yes, no = Unary(UnaryOp.NOT, condition, BOOL), no, ()
        return If(condition, yes, no, span=stmt.span)

    def _marked(self, block: _Block, flag: str) -> _Block:
        """Return the block with ``flag`` set before each exit from it."""
        done: list[Stmt] = []
        for stmt in block:
            match stmt:
                case Return() | Break() | Continue():
                    done += (_raise(flag, stmt.span), stmt)
                case If(condition, then, otherwise):
                    marked = self._marked(then, flag), self._marked(otherwise, flag)
                    done.append(If(condition, *marked, span=stmt.span))
                case Let() | Var() | Assign() | For() | While():
                    done.append(stmt)
                case _:
                    assert_never(stmt)
        return tuple(done)

    def _unless(self, flag: str, block: _Block, span: Span | None) -> Iterator[Stmt]:
        if block:
            condition = Unary(UnaryOp.NOT, Read(flag, BOOL), BOOL)
            yield If(condition, block, (), span=span)

    def _loop(self, stmt: For | While) -> Stmt:
        """Return a loop whose only exit is its last statement."""
        loop = _LoopFlags()
        body = self._block(stmt.body, loop)
        head: list[Stmt] = []
        tail: list[Stmt] = []
        if loop.skip is not None:
            head.append(Var(loop.skip, build.boolean(False), span=stmt.span))
        if loop.leave is not None:
            head.append(Var(loop.leave, build.boolean(False), span=stmt.span))
            leave = Read(loop.leave, BOOL)
            tail.append(If(leave, (Break(span=stmt.span),), (), span=stmt.span))
        return replace(stmt, body=(*head, *body, *tail))

    def _returned(self) -> str:
        if self.returned is None:
            self.returned = self._fresh("returned")
        return self.returned

    def _leave(self, loop: _LoopFlags) -> str:
        if loop.leave is None:
            loop.leave = self._fresh("leave")
        return loop.leave


def _raise(flag: str, span: Span | None) -> Stmt:
    return Assign(Read(flag, BOOL), build.boolean(True), span=span)
