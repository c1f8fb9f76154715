"""Share: what is bound and where, what stays, and that both mean the same."""

from __future__ import annotations

import pytest

from distal.ir import build
from distal.ir.nodes import (
    Assign,
    Break,
    Call,
    CompareOp,
    EntryKind,
    Expr,
    For,
    Function,
    If,
    Let,
    Module,
    Origin,
    Param,
    Read,
    Return,
    Stmt,
    UniformDeclaration,
    Var,
    While,
)
from distal.ir.types import BOOL, FLOAT, INT, VEC3, Kind
from distal.ir.walk import children, nodes_in
from distal.passes.share.share import run, share_function
from distal.passes.share.split_deep import DEEPEST
from tests.unit.passes.random_modules import Generator, check, context

x, y = build.read("x", FLOAT), build.read("y", FLOAT)
v = build.read("v", FLOAT)
p = build.read("p", VEC3)
n = build.read("n", INT)
flag = build.read("flag", BOOL)
shared = build.read("shared_0", FLOAT)
wave = build.builtin("sin", x)
one, two = build.number(1.0), build.number(2.0)
zero, nine = build.integer(0), build.integer(9)
low = build.compare(CompareOp.LT, y, one)


def share(*body: Stmt) -> tuple[Stmt, ...]:
    params = {"x": FLOAT, "y": FLOAT, "p": VEC3, "n": INT, "flag": BOOL}
    function = Function("f", tuple(Param(k, t) for k, t in params.items()), FLOAT, body, "f")
    return share_function(function, {"march": 500}, set()).body


def doubled(e: Expr) -> Expr:
    return build.multiply(e, two)


def grow(by: Expr) -> Assign:
    return Assign(v, build.add(v, by))


def loop(*body: Stmt, stop: Expr = nine) -> For:
    return For("i", zero, stop, 1, body)


def test_a_value_used_twice_gets_a_name() -> None:
    body = share(Return(build.add(wave, doubled(wave))))
    assert body == (Let("shared_0", wave), Return(build.add(shared, doubled(shared))))


def test_a_sum_is_not_worth_a_name() -> None:
    total = build.add(x, y)
    body = (Return(build.multiply(total, total)),)
    assert share(*body) == body


def test_the_largest_common_value_is_bound_and_its_parts_are_not() -> None:
    whole = build.builtin("cos", build.add(wave, y))
    body = share(Return(build.add(whole, doubled(whole))))
    assert body == (Let("shared_0", whole), Return(build.add(shared, doubled(shared))))


def test_a_part_that_is_used_elsewhere_too_is_bound_as_well() -> None:
    whole = build.builtin("cos", build.add(wave, y))
    body = share(Return(build.add(build.add(whole, doubled(whole)), wave)))
    second = build.read("shared_1", FLOAT)
    assert body == (
        Let("shared_0", wave),
        Let("shared_1", build.builtin("cos", build.add(shared, y))),
        Return(build.add(build.add(second, doubled(second)), shared)),
    )


def test_the_authors_name_is_kept() -> None:
    body = share(Let("a", doubled(wave)), Let("height", wave), Return(build.read("height", FLOAT)))
    assert body == (
        Let("height", wave),
        Let("a", doubled(build.read("height", FLOAT))),
        Return(build.read("height", FLOAT)),
    )


def test_a_second_name_for_a_value_goes() -> None:
    a, b = build.read("a", FLOAT), build.read("b", FLOAT)
    body = share(Let("a", wave), Let("b", wave), Return(build.add(a, doubled(b))))
    assert body == (Let("a", wave), Return(build.add(a, doubled(a))))


def test_a_changed_local_has_another_value() -> None:
    sine = build.builtin("sin", v)
    body = (Var("v", x), Let("a", sine), grow(one), Return(build.add(sine, build.read("a", FLOAT))))
    assert share(*body) == body
    # Before the change both uses have one value, also where the change is in the same statement.
    body = share(Var("v", x), Let("b", doubled(sine)), grow(sine), Return(v))
    assert body == (
        Var("v", x),
        Let("shared_0", build.builtin("sin", v)),
        Let("b", doubled(shared)),
        grow(shared),
        Return(v),
    )


def test_a_branch_keeps_its_work_unless_both_have_it() -> None:
    apart = (Var("v", x), If(low, (grow(wave),), ()), If(flag, (grow(wave),), ()), Return(v))
    assert share(*apart) == apart
    both = share(Var("v", x), If(low, (grow(wave),), (grow(doubled(wave)),)), Return(v))
    assert both == (
        Var("v", x),
        Let("shared_0", wave),
        If(low, (grow(shared),), (grow(doubled(shared)),)),
        Return(v),
    )
    inside = share(Var("v", x), If(low, (grow(wave), grow(doubled(wave))), ()), Return(v))
    assert inside == (
        Var("v", x),
        If(low, (Let("shared_0", wave), grow(shared), grow(doubled(shared))), ()),
        Return(v),
    )


def test_nothing_moves_before_an_exit() -> None:
    body = (If(low, (Return(doubled(wave)),), ()), Return(wave))
    assert share(*body) == body


def test_what_a_loop_does_not_change_moves_before_it() -> None:
    body = share(Var("v", y), loop(grow(wave)), Return(v))
    assert body == (Var("v", y), Let("shared_0", wave), loop(grow(shared)), Return(v))
    a, b = build.read("a", FLOAT), build.read("b", FLOAT)
    named = share(
        Var("v", y),
        loop(Let("a", wave), Let("b", build.builtin("cos", a)), grow(build.multiply(a, b))),
        Return(v),
    )
    assert named == (
        Var("v", y),
        Let("a", wave),
        Let("b", build.builtin("cos", a)),
        loop(grow(build.multiply(a, b))),
        Return(v),
    )


def test_what_a_loop_changes_or_may_never_compute_stays() -> None:
    for body in (
        (Var("v", y), loop(grow(build.builtin("sin", v))), Return(v)),
        (Var("v", y), loop(grow(wave), stop=n), Return(v)),
        (Var("v", y), loop(If(low, (grow(wave),), ())), Return(v)),
        (Var("v", y), loop(If(low, (Break(),), ()), grow(wave)), Return(v)),
        (Var("v", y), loop(grow(build.builtin("sin", build.cast(Read("i", INT), Kind.FLOAT)))),
         Return(v)),
    ):  # fmt: skip
        assert share(*body) == body


def test_a_while_computes_its_condition_once_at_least() -> None:
    condition = build.compare(CompareOp.LT, v, wave)
    body = share(Var("v", y), While(condition, (grow(one),)), Return(v))
    bound = build.compare(CompareOp.LT, v, shared)
    assert body == (
        Var("v", y),
        Let("shared_0", wave),
        While(bound, (grow(one),)),
        Return(v),
    )
    # The condition and the body share a value that no block holds.
    sine = build.builtin("sin", v)
    body = (
        Var("v", y),
        While(build.compare(CompareOp.LT, sine, one), (grow(sine),)),
        Return(v),
    )
    assert share(*body) == body


def test_what_a_select_may_skip_is_bound_only_when_cheap() -> None:
    square = build.multiply(wave, wave)
    body = share(Return(build.select(flag, square, one)))
    assert body == (
        Let("shared_0", wave),
        Return(build.select(flag, build.multiply(shared, shared), one)),
    )
    call = Call("march", (x,), FLOAT)
    body = (Return(build.select(flag, build.multiply(call, call), one)),)
    assert share(*body) == body
    surely = share(Return(build.add(call, build.select(flag, doubled(call), one))))
    assert surely[0] == Let("shared_0", call)


def test_an_index_of_a_target_is_shared_and_the_target_stays() -> None:
    w = build.read("w", VEC3)
    index = build.builtin("min", build.add(n, build.multiply(n, n)), build.integer(2))
    place = build.index(w, index)
    other = build.index(p, index)
    body = share(Var("w", p), Assign(place, other), Return(build.swizzle(w, "x")))
    i = build.read("shared_0", INT)
    assert body == (
        Var("w", p),
        Let("shared_0", index),
        Assign(build.index(w, i), build.index(p, i)),
        Return(build.swizzle(w, "x")),
    )


def depth(e: Expr) -> int:
    depths: dict[Expr, int] = {}
    for node in nodes_in(e):
        depths[node] = 1 + max((depths[c] for c in children(node)), default=0)
    return depths[e]


def test_deep_expressions_are_cut() -> None:
    total: Expr = x
    for k in range(3000):
        total = build.add(total, build.multiply(x, build.number(k)))
    body = share(Return(total))
    assert len(body) > 50
    assert all(depth(s.value) <= DEEPEST + 1 for s in body if isinstance(s, Let | Return))
    looping = share(
        Var("v", y), While(build.compare(CompareOp.LT, v, total), (grow(one),)), Return(v)
    )
    assert all(depth(s.condition) < DEEPEST for s in looping if isinstance(s, While))


def test_doubling_does_not_explode() -> None:
    total: Expr = x
    for _ in range(60):
        total = build.add(total, total)
    body = share(Return(total))
    assert len(body) < 61


@pytest.mark.parametrize("seed", range(80))
def test_random_modules_keep_their_value(seed: int) -> None:
    module = Generator(seed).module()
    check(module, run(module, context(None)), "share")


def caller_beside(callee: Expr, uniform: str = "other") -> tuple[Stmt, ...]:
    """The body of a function that calls another one twice, after ``run``."""
    call = Call("short", (x,), FLOAT)
    twice = build.add(build.multiply(call, y), call)
    params = (Param("x", FLOAT), Param("y", FLOAT))
    short = Function("short", params[:1], FLOAT, (Return(callee),), "short")
    caller = Function("f", params, FLOAT, (Return(twice),), "f")
    declared = UniformDeclaration(uniform, FLOAT, Origin.NUMBER, 1.0)
    module = Module((short, caller), "f", EntryKind.FUNCTION, (declared,))
    return run(module, context(None)).function("f").body


def test_what_is_kept_of_a_function_depends_on_what_it_calls_and_on_taken_names() -> None:
    assert len(caller_beside(x)) == 1  # a call that costs nothing is as short as a name
    long = build.builtin("sin", wave)
    assert [s.name for s in caller_beside(long)[:-1]] == ["shared_0"]
    assert [s.name for s in caller_beside(long, "shared_0")[:-1]] == ["shared_1"]
    assert caller_beside(x) == caller_beside(x)
