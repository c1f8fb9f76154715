"""Evaluate a function of constants without a device: the box of a shape, before it is compiled.

Input: a lowered module whose entry takes no arguments and reads no uniforms. Output: the value as
Python numbers, in 64 bits, by the rules that fold constants in scene code; None where these rules
leave an operation to a device. Standard library only.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache, reduce
from typing import Any, Final

from distal.backends import get_target
from distal.compiler.driver import run_passes
from distal.ir.build import add, components, multiply, swizzle
from distal.ir.contents import contents
from distal.ir.nodes import (
    Assign,
    Break,
    Call,
    Compose,
    Const,
    Construct,
    Continue,
    Expr,
    Field,
    For,
    Function,
    If,
    Let,
    MatMul,
    Module,
    Read,
    Return,
    Select,
    Splat,
    Stmt,
    Swizzle,
    Var,
)
from distal.ir.types import Matrix, Struct, Vector, component_count
from distal.ir.walk import children, rebuild
from distal.passes.fold.fold import fold_expression

# The passes that remove function values and gradients; the rest makes texts short, or fast.
_LAST_PASS: Final = "decompose"
_LONGEST_LOOP: Final = 4096
_EXPRESSIONS_KEPT: Final = 16384
_MODULES_KEPT: Final = 64
_VALUES: Final = frozenset({Const, Splat, Compose, Construct})


def evaluate(module: Module) -> Any | None:
    """Return the entry's value: a number, or nested tuples of numbers."""
    # Whoever has data is not kept: declarations are equal whatever the data is.
    return _evaluated(module) if module.resources else _kept(module)


def _evaluated(module: Module) -> Any | None:
    module = run_passes(module, get_target("llvm"), 64, after=_LAST_PASS)
    try:
        return _python_value(_Evaluator(module).call(module.entry, ()))
    except _NotConstantError:
        return None


_kept = lru_cache(maxsize=_MODULES_KEPT)(_evaluated)


class _NotConstantError(Exception):
    """An operation cannot be computed here."""


class _Leave(Exception):  # noqa: N818 (control flow, not an error)
    """A loop ends early, or goes on with the next iteration."""

    def __init__(self, stmt: Break | Continue) -> None:
        super().__init__()
        self.stmt = stmt


class _Evaluator:
    """Runs functions of a module on constant arguments."""

    def __init__(self, module: Module) -> None:
        self._functions = {f.name: f for f in module.functions}
        self._calls: dict[tuple[str, tuple[Expr, ...]], Expr] = {}

    def call(self, name: str, args: tuple[Expr, ...]) -> Expr:
        """Return the value of a function of these constants; each call is computed once."""
        key = (name, args)
        if key not in self._calls:
            self._calls[key] = self._run(self._functions[name], args)
        return self._calls[key]

    def _run(self, function: Function, args: tuple[Expr, ...]) -> Expr:
        env: dict[Expr, Expr] = {
            Read(p.name, p.type): arg for p, arg in zip(function.params, args, strict=True)
        }
        found = self._block(function.body, env)
        if found is None:
            raise _NotConstantError
        return found

    def _block(self, body: Sequence[Stmt], env: dict[Expr, Expr]) -> Expr | None:
        """Run statements; return the value of a Return among them."""
        for stmt in body:
            found = self._statement(stmt, env)
            if found is not None:
                return found
        return None

    def _statement(self, stmt: Stmt, env: dict[Expr, Expr]) -> Expr | None:
        match stmt:
            case Let(name, value) | Var(name, value):
                env[Read(name, value.type)] = self._value(value, env)
            case Assign(target, value):
                self._assign(target, self._value(value, env), env)
            case If(condition, then, otherwise):
                return self._block(then if self._number(condition, env) else otherwise, env)
            case For():
                return self._loop(stmt, env)
            case Break() | Continue():
                raise _Leave(stmt)
            case Return(value):
                return self._value(value, env)
            case _:  # a loop without a count
                raise _NotConstantError
        return None

    def _assign(self, target: Expr, value: Expr, env: dict[Expr, Expr]) -> None:
        """Assign to a variable, or to a part: then the whole gets a copy with another part."""
        match target:
            case Read():
                env[target] = value
            case Field(base, name):
                self._assign(base, _with_field(self._value(base, env), name, value), env)
            case Swizzle(base, lanes):
                self._assign(base, _with_lanes(self._value(base, env), lanes, value), env)
            case _:  # an element of an array
                raise _NotConstantError

    def _loop(self, stmt: For, env: dict[Expr, Expr]) -> Expr | None:
        counts = range(self._number(stmt.start, env), self._number(stmt.stop, env), stmt.step)
        if len(counts) > _LONGEST_LOOP:
            raise _NotConstantError
        for count in counts:
            env[Read(stmt.name, stmt.start.type)] = Const(count, stmt.start.type)
            try:
                found = self._block(stmt.body, env)
            except _Leave as leave:
                if isinstance(leave.stmt, Break):
                    break
                continue
            if found is not None:
                return found
        return None

    def _number(self, e: Expr, env: dict[Expr, Expr]) -> Any:
        value = self._value(e, env)
        if not isinstance(value, Const):
            raise _NotConstantError
        return value.value

    def _value(self, e: Expr, env: dict[Expr, Expr]) -> Expr:
        """Return an expression's value: constants, and structs of them."""
        folded = self._replaced(e, env, {})
        if not contents(folded).kinds <= _VALUES:
            raise _NotConstantError
        return folded

    def _replaced(self, e: Expr, env: dict[Expr, Expr], memo: dict[Expr, Expr]) -> Expr:
        """Return an expression with the values of its locals, folded; each node once."""
        done = env.get(e) or memo.get(e)
        if done is None:
            operands = children(e)
            if operands:
                e = rebuild(e, tuple([self._replaced(c, env, memo) for c in operands]))
            done = memo[e] = self._folded(e)
        return done

    def _folded(self, e: Expr) -> Expr:
        if isinstance(e, Call):
            return self.call(e.function, e.args)
        if isinstance(e, MatMul):
            e = _product(e)
        elif isinstance(e, Select) and isinstance(e.condition, Compose):
            e = _selected(e, e.condition)
        return e if not children(e) else _constant(e)


def _with_field(struct: Expr, name: str, value: Expr) -> Expr:
    """Return a struct with another value of one field."""
    if not isinstance(struct, Construct) or not isinstance(struct.type, Struct):
        raise _NotConstantError
    names = [field_name for field_name, _ in struct.type.fields]
    parts = zip(names, struct.parts, strict=True)
    return Construct(tuple(value if n == name else part for n, part in parts), struct.type)


def _with_lanes(vector: Expr, lanes: str, value: Expr) -> Expr:
    """Return a vector with other values of some components."""
    given = dict(zip(lanes, components(value), strict=True))
    kept = zip("xyzw", components(vector), strict=False)
    parts = [_constant(given.get(lane, part)) for lane, part in kept]
    return Compose(tuple(parts), vector.type)


def _product(e: MatMul) -> Expr:
    """Return the product of a constant matrix and a matrix or column as sums of columns."""
    if not isinstance(e.lhs, Compose) or not isinstance(e.lhs.type, Matrix):
        raise _NotConstantError
    columns = e.lhs.parts

    def column(of: Expr) -> Expr:
        letters = "xyzw"[: len(columns)]
        terms = [multiply(c, swizzle(of, x)) for c, x in zip(columns, letters, strict=True)]
        return _constant(reduce(add, terms))

    if isinstance(e.rhs.type, Matrix):
        if not isinstance(e.rhs, Compose):
            raise _NotConstantError
        return Compose(tuple(map(column, e.rhs.parts)), e.type)
    return column(e.rhs)


def _selected(e: Select, condition: Compose) -> Expr:
    """Return the components of two vectors that constant conditions choose."""
    chosen = [
        swizzle(e.yes if isinstance(c, Const) and c.value else e.no, letter)
        for c, letter in zip(map(_constant, components(condition)), "xyzw", strict=False)
    ]
    return Compose(tuple(map(_constant, chosen)), e.type)


# While a number is dragged, most boxes are those of before.
@lru_cache(maxsize=_EXPRESSIONS_KEPT)
def _constant(e: Expr) -> Expr:
    return fold_expression(e, 64)


def _python_value(e: Expr) -> Any:
    match e:
        case Const(value):
            return value
        case Splat(inner, type):
            return (_python_value(inner),) * component_count(type)
        case Compose(parts, Vector()):
            values = [_python_value(part) for part in parts]
            return tuple(
                v for value in values for v in (value if isinstance(value, tuple) else [value])
            )
        case Compose(parts) | Construct(parts):
            return tuple(_python_value(part) for part in parts)
        case _:
            raise _NotConstantError
