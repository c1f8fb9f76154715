"""Fold: what is computed, what is left alone, and that both mean the same."""

from __future__ import annotations

import struct

import pytest

from distal.ir import build
from distal.ir.nodes import (
    Assign,
    Binary,
    BinaryOp,
    Break,
    Call,
    Cast,
    Compare,
    CompareOp,
    Construct,
    EntryKind,
    Expr,
    For,
    Function,
    If,
    Let,
    Module,
    Param,
    Read,
    Return,
    Splat,
    Stmt,
    Uniform,
    Var,
    While,
)
from distal.ir.types import BOOL, FLOAT, INT, IVEC2, UINT, VEC2, VEC3, Array, Kind, Struct
from distal.passes.fold.fold import fold_expression, fold_function, run
from tests.unit.passes.random_modules import Generator, check, context

x = build.read("x", FLOAT)
p = build.read("p", VEC3)
i = build.read("i", INT)
flag = build.read("flag", BOOL)


def folded(*body: Stmt) -> tuple[Stmt, ...]:
    """The folded body of a function of x, p, i and flag."""
    params = (Param("x", FLOAT), Param("p", VEC3), Param("i", INT), Param("flag", BOOL))
    return fold_function(Function("f", params, FLOAT, body, "f"), 32).body


def fold32(e: Expr) -> Expr:
    """An expression folded in 32 bits."""
    return fold_expression(e, 32)


def float32(value: float) -> float:
    """The nearest 32-bit float."""
    return float(struct.unpack("f", struct.pack("f", value))[0])


n = build.number


def test_floats_round_like_the_target() -> None:
    tenth = build.add(n(0.1), n(0.2))
    assert fold_expression(tenth, 64) is n(0.1 + 0.2)
    assert fold32(tenth) is n(float32(float32(0.1) + float32(0.2)))
    # 2 ** 24 + 1 is no 32-bit float: half to even goes down.
    assert fold32(build.add(n(16777216.0), n(1.0))) is n(16777216.0)


@pytest.mark.parametrize(
    "e",
    [
        build.divide(n(1.0), n(0.0)),
        build.divide(n(0.0), n(0.0)),
        build.multiply(n(3e38), n(10.0)),
        build.multiply(n(1e-20), n(1e-20)),
    ],
)
def test_no_nan_infinity_or_denormal_is_made(e: Expr) -> None:
    assert fold32(e) is e


@pytest.mark.parametrize(
    ("op", "a", "b", "result"),
    [
        (BinaryOp.ADD, 2**31 - 1, 1, -(2**31)),
        (BinaryOp.MUL, 65536, 65536, 0),
        (BinaryOp.FLOOR_DIV, -7, 2, -4),
        (BinaryOp.FLOOR_DIV, 7, 0, 7),
        (BinaryOp.FLOOR_DIV, -(2**31), -1, -(2**31)),
        (BinaryOp.MOD, -7, 3, 2),
        (BinaryOp.MOD, 7, -3, -2),
        (BinaryOp.MOD, 7, 0, 0),
        (BinaryOp.SHL, 1, 33, 2),
        (BinaryOp.SHL, 1, 31, -(2**31)),
        (BinaryOp.SHR, -8, 1, -4),
        (BinaryOp.SHR, -8, 33, -4),
        (BinaryOp.XOR, -1, 5, -6),
    ],
)
def test_ints(op: BinaryOp, a: int, b: int, result: int) -> None:
    assert fold32(build.binary(op, build.integer(a), build.integer(b))) is build.integer(result)


def test_unsigned() -> None:
    u = build.unsigned
    assert fold32(build.subtract(u(0), u(1))) is u(2**32 - 1)
    assert fold32(build.binary(BinaryOp.SHR, u(2**31), u(31))) is u(1)
    assert fold32(build.negate(u(1))) is u(2**32 - 1)


@pytest.mark.parametrize(
    ("value", "kind", "result"),
    [
        (build.number(-2.9), Kind.INT, build.integer(-2)),
        (build.number(3e9), Kind.INT, build.integer(2**31 - 1)),
        (build.number(-3e9), Kind.INT, build.integer(-(2**31))),
        (build.number(-1.0), Kind.UINT, build.unsigned(0)),
        (build.number(5e9), Kind.UINT, build.unsigned(2**32 - 1)),
        (build.integer(-1), Kind.UINT, build.unsigned(2**32 - 1)),
        (build.unsigned(2**31), Kind.INT, build.integer(-(2**31))),
        (build.integer(16777217), Kind.FLOAT, build.number(16777216.0)),
        (build.number(0.5), Kind.BOOL, build.boolean(True)),
    ],
)
def test_casts(value: Expr, kind: Kind, result: Expr) -> None:
    assert fold32(build.cast(value, kind)) is result


def test_identities() -> None:
    assert fold32(build.multiply(p, n(1.0))) is p
    assert fold32(build.add(n(0.0), p)) is p
    assert fold32(build.divide(x, n(4.0))) is build.multiply(x, n(0.25))
    assert fold32(build.divide(x, n(3.0))) is build.divide(x, n(3.0))
    assert fold32(build.multiply(x, n(0.0))) is build.multiply(x, n(0.0))
    assert fold32(build.subtract(x, x)) is build.subtract(x, x)
    assert fold32(build.negate(build.negate(x))) is x
    assert fold32(build.subtract(x, build.negate(x))) is build.add(x, x)
    zero = build.integer(0)
    assert fold32(build.multiply(i, zero)) is zero
    assert fold32(build.subtract(i, i)) is zero
    eight = build.integer(8)
    assert fold32(build.binary(BinaryOp.FLOOR_DIV, i, eight)) is build.binary(
        BinaryOp.SHR, i, build.integer(3)
    )
    assert fold32(build.binary(BinaryOp.MOD, i, eight)) is build.binary(
        BinaryOp.AND, i, build.integer(7)
    )


def test_only_opposites_of_a_nan_are_turned() -> None:
    less = build.compare(CompareOp.LT, x, n(1.0))
    equal = build.compare(CompareOp.EQ, x, n(1.0))
    assert fold32(build.negation(less)) is build.negation(less)
    assert fold32(build.negation(equal)) is build.compare(CompareOp.NE, x, n(1.0))
    int_less = build.compare(CompareOp.LT, i, build.integer(1))
    assert fold32(build.negation(int_less)) is build.compare(CompareOp.GE, i, build.integer(1))
    assert fold32(build.compare(CompareOp.EQ, x, x)) is build.compare(CompareOp.EQ, x, x)


def test_selects() -> None:
    assert fold32(build.select(flag, x, x)) is x
    assert fold32(build.select(build.boolean(True), x, n(1.0))) is x
    assert fold32(build.select(flag, build.boolean(True), build.boolean(False))) is flag
    assert fold32(build.select(build.negation(flag), x, n(1.0))) is build.select(flag, n(1.0), x)
    assert fold32(build.both(build.boolean(True), flag)) is flag
    assert fold32(build.either(flag, build.boolean(True))) is build.boolean(True)


def test_vectors_are_taken_apart() -> None:
    made = build.compose(VEC3, build.swizzle(p, "zx"), n(2.0))
    assert fold32(build.swizzle(made, "x")) is build.swizzle(p, "z")
    assert fold32(build.swizzle(made, "yx")) is build.swizzle(p, "xz")
    assert fold32(build.swizzle(made, "zy")) is build.compose(VEC2, n(2.0), build.swizzle(p, "x"))
    assert fold32(build.compose(VEC3, *build.components(p))) is p
    assert fold32(build.compose(VEC3, x, x, x)) is build.splat(x, VEC3)
    assert fold32(build.swizzle(build.splat(x, VEC3), "xy")) is build.splat(x, VEC2)
    assert fold32(build.swizzle(build.swizzle(p, "zyx"), "x")) is build.swizzle(p, "z")
    sums = build.add(build.compose(VEC2, n(1.0), n(2.0)), n(1.0))
    assert fold32(sums) is build.compose(VEC2, n(2.0), n(3.0))
    both = build.add(build.splat(x, VEC3), build.splat(build.multiply(x, x), VEC3))
    assert fold32(both) is build.splat(build.add(x, build.multiply(x, x)), VEC3)


def test_structs_and_arrays_are_taken_apart() -> None:
    ball = Struct("Ball", (("centre", VEC3), ("radius", FLOAT)), False)
    made = Construct((p, x), ball)
    assert fold32(build.field(made, "radius")) is x
    some = Read("b", ball)
    again = Construct((build.field(some, "centre"), build.field(some, "radius")), ball)
    assert fold32(again) is some
    items = Construct((x, n(1.0)), Array(FLOAT, 2))
    assert fold32(build.index(items, build.integer(1))) is n(1.0)
    assert fold32(build.index(items, i)) is build.index(items, i)
    assert fold32(build.index(p, build.integer(2))) is build.swizzle(p, "z")


def test_builtins() -> None:
    assert fold32(build.builtin("sqrt", n(9.0))) is n(3.0)
    assert fold32(build.builtin("round", n(2.5))) is n(2.0)
    assert fold32(build.builtin("fract", n(-0.25))) is n(0.75)
    assert fold32(build.builtin("mod", n(-1.0), n(3.0))) is n(2.0)
    assert fold32(build.builtin("pow", n(-2.0), n(2.0))) is n(0.0)
    assert fold32(build.builtin("pow", n(0.0), n(0.0))) is n(1.0)
    assert fold32(build.builtin("length", build.compose(VEC2, n(3.0), n(4.0)))) is n(5.0)
    assert fold32(build.builtin("abs", build.integer(-(2**31)))) is build.integer(-(2**31))
    assert fold32(build.builtin("float_bits_to_int", n(1.0))) is build.integer(0x3F800000)
    bits = build.builtin("float_bits_to_int", n(1.0))
    assert fold_expression(bits, 64) is bits
    z = build.builtin("cross", build.compose(VEC3, n(1), n(0), n(0)), p)
    assert fold32(z) is z


def test_trivial_locals_are_forwarded_and_others_keep_their_names() -> None:
    a, b, c = (build.read(name, FLOAT) for name in "abc")
    body = folded(
        Let("a", build.swizzle(p, "x")),
        Let("b", build.add(a, x)),
        Let("c", Uniform("time", FLOAT)),
        Let("unused", build.builtin("sin", x)),
        Return(build.multiply(build.add(b, c), b)),
    )
    assert body == (
        Let("b", build.add(build.swizzle(p, "x"), x)),
        Return(build.multiply(build.add(b, Uniform("time", FLOAT)), b)),
    )


def test_a_local_that_names_a_changing_one_stays() -> None:
    v, before = build.read("v", FLOAT), build.read("before", FLOAT)
    body = (
        Var("v", x),
        Let("before", v),
        Assign(v, build.add(v, n(1.0))),
        Return(build.multiply(v, before)),
    )
    assert folded(*body) == body


def test_a_vector_of_a_changing_local_is_not_looked_through() -> None:
    v, pair = build.read("v", FLOAT), build.read("pair", VEC2)
    body = (
        Var("v", x),
        Let("pair", build.compose(VEC2, v, n(1.0))),
        Assign(v, build.add(v, n(1.0))),
        Return(build.multiply(v, build.swizzle(pair, "x"))),
    )
    assert folded(*body) == body


def test_control_flow_on_constants() -> None:
    v = build.read("v", FLOAT)
    one, two = (Assign(v, n(k)) for k in (1.0, 2.0))
    yes = build.compare(CompareOp.LT, n(1.0), n(2.0))
    body = folded(
        Var("v", x),
        If(yes, (one,), (two,)),
        For("k", build.integer(3), build.integer(3), 1, (two,)),
        While(build.boolean(False), (two,)),
        Return(v),
        Return(x),
    )
    assert body == (Var("v", x), one, Return(v))


def test_an_empty_branch_turns_its_condition() -> None:
    v, dead = build.read("v", FLOAT), build.read("dead", FLOAT)
    condition = build.compare(CompareOp.LT, x, n(1.0))
    body = folded(
        Var("v", x),
        Var("dead", x),
        If(condition, (Assign(dead, n(1.0)),), (Assign(v, n(1.0)),)),
        Return(v),
    )
    assert body == (Var("v", x), If(build.negation(condition), (Assign(v, n(1.0)),), ()), Return(v))


def test_a_var_that_only_feeds_itself_dies_but_a_while_stays() -> None:
    v, k = build.read("v", FLOAT), build.read("k", INT)
    counting = (
        Var("k", i),
        While(
            build.compare(CompareOp.LT, k, build.integer(9)),
            (Assign(k, build.add(k, build.integer(1))),),
        ),
    )
    body = folded(
        Var("v", x),
        For("j", build.integer(0), i, 1, (Assign(v, build.add(v, n(1.0))),)),
        *counting,
        Return(x),
    )
    assert body == (*counting, Return(x))


def test_what_follows_an_endless_loop_is_dropped() -> None:
    v = build.read("v", FLOAT)
    grow = Assign(v, build.add(v, n(1.0)))
    stop = If(build.compare(CompareOp.GT, v, n(9.0)), (Return(v),), ())
    endless = While(build.boolean(True), (grow, stop))
    assert folded(Var("v", x), endless, Return(x)) == (Var("v", x), endless)
    leaves = While(build.boolean(True), (grow, stop, Break()))
    assert folded(Var("v", x), leaves, Return(x))[-1] == Return(x)


def test_a_very_deep_sum_is_no_trouble() -> None:
    total: Expr = x
    for _ in range(5000):
        total = build.add(total, x)
    assert folded(Return(total)) == (Return(total),)


def test_unreached_functions_go() -> None:
    callee = Function("g", (), FLOAT, (Return(n(1.0)),), "g")
    body = (If(build.boolean(False), (Return(Call("g", (), FLOAT)),), (Return(x),)),)
    main = Function("f", (Param("x", FLOAT),), FLOAT, body, "f")
    module = run(Module((callee, main), "f", EntryKind.FUNCTION), context(None))
    assert [f.name for f in module.functions] == ["f"]
    assert module.functions[0].body == (Return(x),)


def test_int_vectors_and_their_casts() -> None:
    whole = build.read("whole", IVEC2)
    there_and_back = build.cast(build.cast(whole, Kind.UINT), Kind.INT)
    assert fold32(there_and_back) is whole
    assert fold32(Cast(Splat(i, IVEC2), VEC2)) is Splat(Cast(i, FLOAT), VEC2)
    assert fold32(Compare(CompareOp.LE, whole, whole, build.cast(whole, Kind.BOOL).type)) is (
        build.splat(build.boolean(True), build.cast(whole, Kind.BOOL).type)
    )
    same = Binary(BinaryOp.XOR, build.read("u", UINT), build.read("u", UINT), UINT)
    assert fold32(same) is build.unsigned(0)


@pytest.mark.parametrize("seed", range(60))
def test_random_modules_keep_their_value(seed: int) -> None:
    module = Generator(seed).module()
    check(module, run(module, context(None)), "fold")
