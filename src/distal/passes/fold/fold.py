"""Fold: compute constants, forward trivial locals, remove dead and unreachable code.

Input: any module after specialise. Output: the same functions, simplified. The author's names are
kept, except for locals that nothing reads and for locals that merely rename an expression of the
same length (a constant, a parameter, a uniform, or components of one).
"""

from __future__ import annotations

from dataclasses import replace

from distal.ir.constant_arithmetic import ConstantArithmetic
from distal.ir.exits import never_goes_on
from distal.ir.kept import kept
from distal.ir.nodes import (
    Assign,
    Break,
    Const,
    Continue,
    Expr,
    Field,
    For,
    Function,
    If,
    Index,
    Let,
    Module,
    Read,
    Return,
    Stmt,
    Swizzle,
    Unary,
    UnaryOp,
    Var,
    While,
)
from distal.ir.types import BOOL
from distal.ir.walk import children, rebuild, root_of, statements_in
from distal.passes.context import Context
from distal.passes.dead_code import remove_dead
from distal.passes.fold.rules import Rules
from distal.passes.reachable import drop_unused


def run(module: Module, context: Context) -> Module:
    """Fold every function, and remove what is unused."""
    functions = tuple(fold_function(f, context.precision) for f in module.functions)
    return drop_unused(replace(module, functions=functions))


@kept
def fold_function(function: Function, precision: int) -> Function:
    """Fold one function repeatedly until nothing changes."""
    body = function.body
    while True:
        folded = _Folder(body, precision).block(body)
        folded = remove_dead(folded)
        if folded == body:
            return function if folded is function.body else replace(function, body=folded)
        body = folded


def fold_expression(e: Expr, precision: int) -> Expr:
    """Fold a single expression; it must not read a Var."""
    return _Folder((), precision).expr(e)


class _Folder:
    def __init__(self, body: tuple[Stmt, ...], precision: int) -> None:
        self._mutable = {
            root_of(s.target).name for s in statements_in(body) if isinstance(s, Assign)
        }
        self._known: dict[Expr, Expr] = {}
        self._rules = Rules(ConstantArithmetic(precision), self._known, self._mutable)
        # Rewritten nodes -> results; also the Read of a trivial local -> its replacement.
        self._done: dict[Expr, Expr] = {}

    def expr(self, root: Expr) -> Expr:
        """Fold an expression bottom up, without recursion: sums of a thousand terms are deep."""
        done = self._done
        stack = [root]
        while stack:
            e = stack[-1]
            if e in done:
                stack.pop()
                continue
            operands = children(e)
            waiting = [c for c in operands if c not in done]
            if waiting:
                stack.extend(reversed(waiting))
                continue
            done[e] = self._rules.simplify(rebuild(e, tuple([done[c] for c in operands])))
            stack.pop()
        return done[root]

    def target(self, target: Expr) -> Expr:
        """Fold the indices in the target of an Assign; the rest of the target is kept."""
        if isinstance(target, Read):
            return target
        assert isinstance(target, Swizzle | Index | Field)
        base = self.target(target.base)
        operands = (base, self.expr(target.index)) if isinstance(target, Index) else (base,)
        return rebuild(target, operands)

    def block(self, body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
        """Fold a block and drop the statements that control never reaches."""
        result: list[Stmt] = []
        for stmt in body:
            for folded in self._statement(stmt):
                result.append(folded)
                if never_goes_on(folded):
                    return tuple(result)
        return tuple(result)

    def _statement(self, stmt: Stmt) -> tuple[Stmt, ...]:
        span = stmt.span
        match stmt:
            case Let(name, value):
                return self._bind(name, self.expr(value), stmt)
            case Var(name, value) if name not in self._mutable:
                return self._bind(name, self.expr(value), stmt)
            case Var(name, value):
                return (Var(name, self.expr(value), span=span),)
            case Assign(target, value):
                return (Assign(self.target(target), self.expr(value), span=span),)
            case Return(value):
                return (Return(self.expr(value), span=span),)
            case If():
                return self._if(stmt)
            case For():
                return self._for(stmt)
            case While(condition, body):
                condition = self.expr(condition)
                if isinstance(condition, Const) and not condition.value:
                    return ()
                return (While(condition, self.block(body), span=span),)
            case Break() | Continue():
                return (stmt,)

    def _bind(self, name: str, value: Expr, stmt: Let | Var) -> tuple[Stmt, ...]:
        read = Read(name, value.type)
        if self._rules.is_trivial(value):
            self._done[read] = value
            return ()
        self._known[read] = value
        return (Let(name, value, span=stmt.span),)

    def _if(self, stmt: If) -> tuple[Stmt, ...]:
        condition = self.expr(stmt.condition)
        if isinstance(condition, Const):
            return self.block(stmt.then if condition.value else stmt.otherwise)
        then, otherwise = self.block(stmt.then), self.block(stmt.otherwise)
        if not then and not otherwise:
            return ()
        if not then:
            condition = self._rules.simplify(Unary(UnaryOp.NOT, condition, BOOL))
            then, otherwise = otherwise, ()
        return (If(condition, then, otherwise, span=stmt.span),)

    def _for(self, stmt: For) -> tuple[Stmt, ...]:
        start, stop = self.expr(stmt.start), self.expr(stmt.stop)
        if isinstance(start, Const) and isinstance(stop, Const):
            rounds = len(range(int(start.value), int(stop.value), stmt.step))
            if rounds == 0:
                return ()
        body = self.block(stmt.body)
        return (For(stmt.name, start, stop, stmt.step, body, span=stmt.span),) if body else ()
