"""Random well-formed modules of exact operations, and the value of a module by the reference.

A pass is right when what it returns obeys the IR's rules and has the same value in every lane.
Expressions are drawn from the ones already used as often as they are made, so that there is
something to share, and from uniforms and constants as often as from what varies.
"""

from __future__ import annotations

import random

import numpy as np

from distal.backends.numpy.interpreter import evaluate
from distal.ir import build
from distal.ir.nodes import (
    Assign,
    BinaryOp,
    Break,
    Call,
    CompareOp,
    Construct,
    Continue,
    EntryKind,
    Expr,
    For,
    Function,
    If,
    Let,
    Module,
    Origin,
    Param,
    Return,
    Stmt,
    Uniform,
    UniformDeclaration,
    Var,
    While,
)
from distal.ir.types import BOOL, FLOAT, INT, VEC2, VEC3, Array, Kind, Struct, Type
from distal.ir.verify import verify
from distal.passes.context import Context

BALL = Struct("Ball", (("centre", VEC2), ("radius", FLOAT)), False)
ROW = Array(FLOAT, 3)
VALUES: tuple[Type, ...] = (FLOAT, FLOAT, FLOAT, INT, BOOL, VEC2, VEC3, BALL, ROW)
UNIFORMS: tuple[tuple[str, Type, object], ...] = (
    ("time", FLOAT, 1.25),
    ("speed", FLOAT, -0.5),
    ("count", INT, 3),
    ("shown", BOOL, True),
    ("eye", VEC3, (1.0, -2.0, 0.5)),
)
LANES = 7


class Generator:
    """Makes one module from one seed."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.functions: list[Function] = []
        self.count = 0

    def module(self) -> Module:
        """Helper functions, and an entry of a float, an int and a vec2."""
        for number in range(self.random.randint(1, 3)):
            types = [self.random.choice(VALUES) for _ in range(self.random.randint(0, 3))]
            self.function(f"help{number}", types, self.random.choice(VALUES))
        self.function("entry", [FLOAT, INT, VEC2], FLOAT)
        uniforms = tuple(UniformDeclaration(n, t, Origin.FRAME, v) for n, t, v in UNIFORMS)
        return Module(tuple(self.functions), "entry", EntryKind.FUNCTION, uniforms)

    def name(self, stem: str) -> str:
        self.count += 1
        return f"{stem}{self.count}"

    def function(self, name: str, types: list[Type], result: Type) -> None:
        params = tuple(Param(f"p{i}", t) for i, t in enumerate(types))
        scope: list[Expr] = [build.read(p.name, p.type) for p in params]
        self.used: dict[Expr, list[Expr]] = {}
        self.result = result
        body = self.block(scope, [], depth=0, in_loop=False)
        value = self.expr(result, scope, 3)
        if result is FLOAT:
            # Every local of the body has a part in it: else most of the body would be dead.
            reads = [build.read(s.name, s.value.type) for s in body if isinstance(s, Let | Var)]
            for part in (*scope, *reads):
                value = build.add(value, as_float(part))
        body.append(Return(value))
        self.functions.append(Function(name, params, result, tuple(body), name))

    # Statements

    def block(
        self, scope: list[Expr], variables: list[Expr], depth: int, in_loop: bool
    ) -> list[Stmt]:
        scope, variables = list(scope), list(variables)
        body: list[Stmt] = []
        for _ in range(self.random.randint(1, 5 if depth == 0 else 3)):
            body.extend(self.statement(scope, variables, depth, in_loop))
        return body

    def statement(
        self, scope: list[Expr], variables: list[Expr], depth: int, in_loop: bool
    ) -> list[Stmt]:
        roll = self.random.random()
        if roll < 0.35:
            type = self.random.choice(VALUES)
            value = self.expr(type, scope, 3)
            name = self.name("a")
            scope.append(build.read(name, type))
            return [Let(name, value)]
        if roll < 0.5 or not variables:
            type = self.random.choice(VALUES)
            value = self.expr(type, scope, 2)
            name = self.name("v")
            scope.append(build.read(name, type))
            variables.append(scope[-1])
            return [Var(name, value)]
        if roll < 0.75 or depth > 2:
            return [self.assign(scope, variables)]
        if roll < 0.85:
            return [self.branch(scope, variables, depth, in_loop)]
        return self.loop(scope, variables, depth)

    def assign(self, scope: list[Expr], variables: list[Expr]) -> Stmt:
        target = self.random.choice(variables)
        if self.random.random() < 0.5:
            if target.type is VEC3:
                target = build.swizzle(target, self.random.choice(["x", "zy", "yx"]))
            elif target.type is BALL:
                target = build.field(target, "radius")
            elif target.type is ROW:
                target = build.index(target, self.in_range(scope))
        return Assign(target, self.expr(target.type, scope, 3))

    def in_range(self, scope: list[Expr]) -> Expr:
        if self.random.random() < 0.5:
            return build.integer(self.random.randint(0, 2))
        some = self.expr(INT, scope, 1)
        return held(some, build.integer(0), build.integer(2))

    def branch(self, scope: list[Expr], variables: list[Expr], depth: int, in_loop: bool) -> Stmt:
        condition = self.expr(BOOL, scope, 2)
        then = self.block(scope, variables, depth + 1, in_loop)
        otherwise: list[Stmt] = []
        if self.random.random() < 0.5:
            otherwise = self.block(scope, variables, depth + 1, in_loop)
        roll = self.random.random()
        if in_loop and roll < 0.4:
            then.append(self.random.choice([Break(), Continue()]))
        elif roll < 0.6:
            self.random.choice([then, otherwise]).append(Return(self.expr(self.result, scope, 2)))
        return If(condition, tuple(then), tuple(otherwise))

    def loop(self, scope: list[Expr], variables: list[Expr], depth: int) -> list[Stmt]:
        if self.random.random() < 0.7:
            name = self.name("i")
            start = build.integer(self.random.randint(-1, 2))
            stop = build.integer(self.random.randint(0, 4))
            if self.random.random() < 0.3:
                some = self.expr(INT, scope, 1)
                stop = build.binary(BinaryOp.MOD, some, build.integer(4))
            inner = [*scope, build.read(name, INT)]
            body = self.block(inner, variables, depth + 1, in_loop=True)
            return [For(name, start, stop, self.random.choice([1, 2]), tuple(body))]
        # A counter that nothing else assigns ends the loop.
        counter = build.read(self.name("n"), INT)
        inner = [*scope, counter]
        step = Assign(counter, build.add(counter, build.integer(1)))
        body = self.block(inner, variables, depth + 1, in_loop=True)
        limit = build.compare(CompareOp.LT, counter, build.integer(3))
        condition = build.both(limit, self.expr(BOOL, inner, 1))
        return [Var(counter.name, build.integer(0)), While(condition, (step, *body))]

    # Expressions

    def expr(self, type: Type, scope: list[Expr], depth: int) -> Expr:
        if depth > 1 and self.random.random() < 0.15:
            scope = []  # of uniforms and constants only
        known = [e for e in self.used if e.type is type and set(self.used[e]) <= set(scope)]
        if known and self.random.random() < 0.35:
            return self.random.choice(known)
        e = self.leaf(type, scope) if depth == 0 else self.operation(type, scope, depth - 1)
        self.used[e] = list(scope)
        return e

    def leaf(self, type: Type, scope: list[Expr]) -> Expr:
        reads = [e for e in scope if e.type is type]
        if reads and self.random.random() < 0.6:
            return self.random.choice(reads)
        uniforms = [Uniform(n, t) for n, t, _ in UNIFORMS if t is type]
        if uniforms and self.random.random() < 0.6:
            return self.random.choice(uniforms)
        return self.constant(type)

    def constant(self, type: Type) -> Expr:
        match type:
            case Struct(_, fields):
                return Construct(tuple(self.constant(t) for _, t in fields), type)
            case Array(element, length):
                return Construct(tuple(self.constant(element) for _ in range(length)), type)
            case _:
                value = self.random.choice([-2, -1, 0, 1, 2, 0.5, 4, -0.25])
                kind = getattr(type, "kind", Kind.FLOAT)
                return build.number(value if kind is Kind.FLOAT else int(value), type)

    def operation(self, type: Type, scope: list[Expr], depth: int) -> Expr:
        roll = self.random.random()
        callees = [f for f in self.functions if f.result is type]
        if callees and roll < 0.2:
            callee = self.random.choice(callees)
            args = tuple(self.expr(p.type, scope, depth) for p in callee.params)
            return Call(callee.name, args, type)
        if roll < 0.3:
            condition = self.expr(BOOL, scope, depth)
            yes, no = self.expr(type, scope, depth), self.expr(type, scope, depth)
            return build.select(condition, yes, no)
        if roll < 0.4:
            return self.leaf(type, scope)
        match type:
            case Struct(_, fields):
                return Construct(tuple(self.expr(t, scope, depth) for _, t in fields), type)
            case Array(element, length):
                parts = tuple(self.expr(element, scope, depth) for _ in range(length))
                return Construct(parts, type)
        if type is BOOL:
            return self.truth(scope, depth)
        if roll < 0.55:
            return self.part(type, scope, depth)
        a, b = self.expr(type, scope, depth), self.expr(type, scope, depth)
        return self.arithmetic(type, a, b)

    def arithmetic(self, type: Type, a: Expr, b: Expr) -> Expr:
        pick = self.random.choice
        if type is INT:
            ops = (BinaryOp.ADD, BinaryOp.SUB, BinaryOp.MUL, BinaryOp.FLOOR_DIV, BinaryOp.MOD)
            return build.binary(pick((*ops, BinaryOp.XOR, BinaryOp.SHL, BinaryOp.SHR)), a, b)
        name = pick(["+", "-", "*", "min", "max", "floor", "sqrt", "/", "negate"])
        match name:
            case "min" | "max":
                return build.builtin(name, a, b)
            case "floor":
                return build.builtin(name, a)
            case "sqrt":
                return build.builtin(name, build.builtin("abs", a))
            case "negate":
                return build.negate(a)
            case _:
                op = {"+": BinaryOp.ADD, "-": BinaryOp.SUB, "*": BinaryOp.MUL}
                return build.binary(op.get(name, BinaryOp.DIV), a, b)

    def truth(self, scope: list[Expr], depth: int) -> Expr:
        roll = self.random.random()
        if roll < 0.6:
            type = self.random.choice([FLOAT, INT])
            a, b = self.expr(type, scope, depth), self.expr(type, scope, depth)
            return build.compare(self.random.choice(list(CompareOp)), a, b)
        a, b = self.expr(BOOL, scope, depth), self.expr(BOOL, scope, depth)
        return self.random.choice([build.both, build.either, lambda x, _: build.negation(x)])(a, b)

    def part(self, type: Type, scope: list[Expr], depth: int) -> Expr:
        if type is FLOAT:
            match self.random.randint(0, 3):
                case 0:
                    return build.swizzle(self.expr(VEC3, scope, depth), self.random.choice("xyz"))
                case 1:
                    return build.field(self.expr(BALL, scope, depth), "radius")
                case 2:
                    return build.index(self.expr(ROW, scope, depth), self.in_range(scope))
                case _:
                    return build.cast(self.expr(INT, scope, depth), Kind.FLOAT)
        if type is VEC2:
            if self.random.random() < 0.5:
                return build.field(self.expr(BALL, scope, depth), "centre")
            return build.swizzle(self.expr(VEC3, scope, depth), "zx")
        if type is VEC3:
            return build.compose(VEC3, self.expr(VEC2, scope, depth), self.expr(FLOAT, scope, 0))
        kinds = {INT: FLOAT}
        source = self.expr(kinds[type], scope, depth)
        return build.cast(held(source, build.number(-9), build.number(9)), Kind.INT)


def as_float(value: Expr) -> Expr:
    """A float that every part of the value has a part in."""
    match value.type:
        case Struct(_, fields):
            parts = [as_float(build.field(value, name)) for name, _ in fields]
        case Array(_, length):
            parts = [build.index(value, build.integer(i)) for i in range(length)]
        case _:
            if value.type is BOOL:
                return build.select(value, build.number(1.0), build.number(-2.0))
            if value.type is INT:
                return build.cast(build.binary(BinaryOp.AND, value, build.integer(255)), Kind.FLOAT)
            parts = list(build.components(value))
    total = parts[0]
    for part in parts[1:]:
        total = build.subtract(total, part)
    return total


def held(value: Expr, low: Expr, high: Expr) -> Expr:
    """The value clamped."""
    return build.builtin("min", build.builtin("max", value, low), high)


def value(module: Module, count: object = 3, time: float = 1.25) -> np.ndarray:
    """The value of the entry in a few lanes, for some values of the uniforms."""
    values = {n: v for n, _, v in UNIFORMS} | {"count": count, "time": time}
    grid = np.arange(LANES)
    args = [
        (grid - 3).astype(np.float32) * np.float32(0.75),
        (grid * 2 - 5).astype(np.int32),
        np.stack([grid - 2.5, 4.0 - grid]).astype(np.float32),
    ]
    return np.broadcast_to(np.asarray(evaluate(module, args, values, {})), (LANES,))


def check(before: Module, after: Module, stage: str) -> None:
    """Both have one value in every lane, whatever the uniforms, and the second obeys the rules."""
    verify(after, stage)
    for count, time in ((3, 1.25), (-2, -0.5)):
        wanted, got = value(before, count, time), value(after, count, time)
        assert np.array_equal(wanted, got, equal_nan=True), f"{wanted}\n{got}"


class NoLibrary:
    """The passes here need no prelude."""

    def find(self, name: str, args: tuple[Type, ...]) -> None:
        """Nothing."""
        return None

    def link(self, module: Module, name: str, args: tuple[Type, ...]) -> tuple[Module, str]:
        """Refused."""
        raise AssertionError(name)


def context(target: object) -> Context:
    """The context for a target, with an empty library."""
    return Context(target, NoLibrary())  # type: ignore[arg-type]
