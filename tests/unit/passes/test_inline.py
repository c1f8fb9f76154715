"""Inline: what moves into the caller, what stays a call, and that both mean the same."""

from __future__ import annotations

from dataclasses import replace

import pytest

from distal.ir import build
from distal.ir.nodes import (
    Assign,
    Call,
    CompareOp,
    EntryKind,
    Expr,
    For,
    Function,
    If,
    Let,
    Module,
    Param,
    Return,
    Stmt,
    Var,
    While,
)
from distal.ir.target import FramePlace, Target
from distal.ir.types import BOOL, FLOAT, Type
from distal.ir.walk import expressions_in
from distal.passes.inline.inline import run
from tests.unit.passes.random_modules import Generator, check, context

VECTORS = Target("llvm", "llvm", FramePlace.HOST, inline=True)
TEXT = Target("glsl-es300", "glsl", FramePlace.VERTEX)

x, y = build.read("x", FLOAT), build.read("y", FLOAT)
flag = build.read("flag", BOOL)
one = build.number(1.0)


def function(name: str, params: dict[str, Type], *body: Stmt) -> Function:
    return Function(name, tuple(Param(n, t) for n, t in params.items()), FLOAT, body, name)


def inlined(*functions: Function, target: Target = VECTORS) -> Function:
    """The entry, the last function, after the pass."""
    module = Module(functions, functions[-1].name, EntryKind.FUNCTION)
    return run(module, context(target)).functions[-1]


def calls(body: tuple[Stmt, ...]) -> list[str]:
    return [e.function for e in expressions_in(body) if isinstance(e, Call)]


def call(name: str, *args: Expr) -> Call:
    return Call(name, args, FLOAT)


SQUARE = function("square", {"x": FLOAT}, Return(build.multiply(x, x)))
# Not cheap: has a loop.
d = build.read("d", FLOAT)
DOUBLED = function(
    "doubled",
    {"x": FLOAT},
    Var("d", x),
    For("i", build.integer(0), build.integer(9), 1, (Assign(d, build.add(d, d)),)),
    Return(d),
)


def test_text_keeps_its_functions_but_not_the_unused() -> None:
    main = function("main", {"y": FLOAT}, Return(call("square", y)))
    module = Module((DOUBLED, SQUARE, main), "main", EntryKind.FUNCTION)
    kept = run(module, context(TEXT))
    assert kept.functions == (SQUARE, main)


def test_a_function_that_few_pixels_need_stays_a_call() -> None:
    entry = function("entry", {"x": FLOAT}, Return(call("square", x)))
    assert calls(inlined(SQUARE, entry).body) == []
    assert calls(inlined(replace(SQUARE, apart=True), entry).body) == ["square"]


def test_arguments_become_lets_unless_they_cost_nothing() -> None:
    main = function("main", {"y": FLOAT}, Return(build.add(call("square", y), one)))
    assert inlined(SQUARE, main).body == (Return(build.add(build.multiply(y, y), one)),)
    main = function("main", {"x": FLOAT}, Return(call("square", build.add(x, one))))
    x_2 = build.read("x_2", FLOAT)
    assert inlined(SQUARE, main).body == (
        Let("x_2", build.add(x, one)),
        Return(build.multiply(x_2, x_2)),
    )


def test_locals_are_renamed_and_a_repeated_call_is_computed_once() -> None:
    body = build.add(call("doubled", y), build.multiply(call("doubled", y), d))
    main = function("main", {"y": FLOAT, "d": FLOAT}, Let("z", call("doubled", y)), Return(body))
    result = inlined(DOUBLED, main)
    assert [s.name for s in result.body if isinstance(s, Var)] == ["d_2"]
    assert not calls(result.body)


def test_early_returns_without_loops_become_branches() -> None:
    low = build.compare(CompareOp.LT, x, one)
    cheap = function("cheap", {"x": FLOAT}, If(low, (Return(one),), ()), Return(build.add(x, x)))
    main = function("main", {"x": FLOAT}, Return(call("cheap", x)))
    assert inlined(cheap, main).body == (Return(build.select(low, one, build.add(x, x))),)

    long = function(
        "long",
        {"x": FLOAT},
        If(low, (Let("s", build.builtin("sin", x)), Return(build.read("s", FLOAT))), ()),
        Return(build.builtin("cos", x)),
    )
    result = build.read("result", FLOAT)
    main = function("main", {"x": FLOAT}, Return(call("long", x)))
    assert inlined(long, main).body == (
        Var("result", build.number(0.0)),
        If(
            low,
            (Let("s", build.builtin("sin", x)), Assign(result, build.read("s", FLOAT))),
            (Assign(result, build.builtin("cos", x)),),
        ),
        Return(result),
    )


def test_a_return_out_of_a_loop_stays_a_call() -> None:
    found = If(build.compare(CompareOp.LT, x, one), (Return(x),), ())
    search = function(
        "search",
        {"x": FLOAT},
        For("i", build.integer(0), build.integer(9), 1, (found,)),
        Return(one),
    )
    main = function("main", {"x": FLOAT}, Return(call("search", x)))
    assert inlined(search, main) == main


def test_what_may_be_skipped_does_not_move() -> None:
    lazily = build.select(flag, call("doubled", x), one)
    main = function("main", {"x": FLOAT, "flag": BOOL}, Return(lazily))
    assert inlined(DOUBLED, main) == main
    lazily = build.select(flag, call("square", x), one)
    main = function("main", {"x": FLOAT, "flag": BOOL}, Return(lazily))
    assert inlined(SQUARE, main).body == (Return(build.select(flag, build.multiply(x, x), one)),)


def test_a_condition_of_a_while_is_computed_each_round() -> None:
    v = build.read("v", FLOAT)
    step = Assign(v, build.add(v, one))

    def loop(name: str) -> Function:
        condition = build.compare(CompareOp.LT, call(name, v), build.number(9.0))
        return function("main", {"y": FLOAT}, Var("v", y), While(condition, (step,)), Return(v))

    assert calls(inlined(DOUBLED, loop("doubled")).body) == ["doubled"]
    assert inlined(SQUARE, loop("square")).body[1] == While(
        build.compare(CompareOp.LT, build.multiply(v, v), build.number(9.0)), (step,)
    )


def test_a_big_callee_is_inlined_into_loops_only() -> None:
    total: Expr = x
    for k in range(100):
        total = build.add(build.builtin("sin", build.multiply(total, build.number(k))), total)
    big = function("big", {"x": FLOAT}, Return(total))
    v = build.read("v", FLOAT)
    main = function(
        "main",
        {"y": FLOAT},
        Var("v", call("big", y)),
        For("i", build.integer(0), build.integer(9), 1, (Assign(v, call("big", v)),)),
        Return(build.add(v, call("big", build.add(v, one)))),
    )
    result = inlined(big, main)
    loop = result.body[1]
    assert isinstance(loop, For) and not calls(loop.body)
    assert calls(result.body) == ["big", "big"]


def test_growth_is_bounded() -> None:
    functions: list[Function] = [function("f0", {"x": FLOAT}, Return(build.builtin("sin", x)))]
    for k in range(1, 30):
        twice = build.add(call(f"f{k - 1}", x), call(f"f{k - 1}", build.add(x, one)))
        functions.append(function(f"f{k}", {"x": FLOAT}, Return(twice)))
    v = build.read("v", FLOAT)
    loop = For("i", build.integer(0), build.integer(9), 1, (Assign(v, call("f29", v)),))
    functions.append(function("main", {"x": FLOAT}, Var("v", x), loop, Return(v)))
    module = run(Module(tuple(functions), "main", EntryKind.FUNCTION), context(VECTORS))
    assert sum(1 for f in module.functions for _ in expressions_in(f.body)) < 3000


@pytest.mark.parametrize("seed", range(60))
def test_random_modules_keep_their_value(seed: int) -> None:
    module = Generator(seed).module()
    check(module, run(module, context(VECTORS)), "inline")
