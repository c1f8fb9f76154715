"""Every rule of fold, held against the reference: a simplified expression has the same value.

All operations are tried with constants on either side that rules look for, their neighbors, and
the ends of each kind's range; as scalars and as vectors whose components agree or differ.
"""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from distal.backends.numpy.interpreter import evaluate
from distal.ir import build
from distal.ir.nodes import (
    Binary,
    BinaryOp,
    Break,
    CompareOp,
    Const,
    Construct,
    Continue,
    EntryKind,
    Expr,
    Function,
    If,
    Index,
    Let,
    Module,
    Param,
    Return,
    Select,
    Stmt,
    Uniform,
    While,
)
from distal.ir.types import (
    BOOL,
    FLOAT,
    INT,
    MAT2,
    UINT,
    VEC2,
    VEC3,
    Array,
    Kind,
    Struct,
    Type,
    Vector,
    kind_of,
    vector_of,
)
from distal.passes.fold.fold import fold_expression, fold_function

ARITHMETIC = (BinaryOp.ADD, BinaryOp.SUB, BinaryOp.MUL, BinaryOp.FLOOR_DIV, BinaryOp.MOD)
BITS = (BinaryOp.AND, BinaryOp.OR, BinaryOp.XOR)
OPERATIONS = {
    FLOAT: (*ARITHMETIC, BinaryOp.DIV),
    INT: (*ARITHMETIC, *BITS, BinaryOp.SHL, BinaryOp.SHR),
    UINT: (*ARITHMETIC, *BITS, BinaryOp.SHL, BinaryOp.SHR),
    BOOL: BITS,
}
CONSTANTS = {
    FLOAT: (-4.0, -2.0, -1.0, -0.5, 0.0, 0.25, 1.0, 2.0, 3.0, 2.0**-126, 2.0**127),
    INT: (-(2**31), -8, -2, -1, 0, 1, 2, 3, 8, 31, 32, 2**30, 2**31 - 1),
    UINT: (0, 1, 2, 3, 8, 31, 32, 2**31, 2**32 - 1),
    BOOL: (False, True),
}
VALUES = {
    FLOAT: np.array([-1e30, -3.5, -1.0, -0.75, 0.0, 0.5, 1.0, 7.25, 1e30, np.inf, np.nan], "f4"),
    INT: np.array([-(2**31), -9, -8, -2, -1, 0, 1, 2, 3, 7, 2**31 - 1], "i4"),
    UINT: np.array([0, 1, 2, 3, 7, 8, 9, 255, 2**31, 2**32 - 2, 2**32 - 1], "u4"),
    BOOL: np.array([False, True] * 5 + [True]),
}


def evaluated(e: Expr, x: Expr, y: Expr) -> np.ndarray:
    """An expression of x and y at every pair of a few values."""
    scalar = next(t for t in VALUES if kind_of(t) is kind_of(x.type))
    a, b = (grid.ravel() for grid in np.meshgrid(VALUES[scalar], VALUES[scalar]))
    given = (np.stack([a, b]), np.stack([b, a])) if isinstance(x.type, Vector) else (a, b)
    params = (Param("x", x.type), Param("y", y.type))
    function = Function("f", params, e.type, (Return(e),), "f")
    with np.errstate(all="ignore"):
        return np.asarray(evaluate(Module((function,), "f", EntryKind.FUNCTION), given, {}, {}))


def keeps_its_value(e: Expr, x: Expr, y: Expr) -> None:
    """Folded or not, e is worth the same."""
    simpler = fold_expression(e, 32)
    wanted, got = evaluated(e, x, y), evaluated(simpler, x, y)
    wanted, got = np.broadcast_arrays(wanted, got)
    assert simpler.type is e.type
    assert np.array_equal(wanted, got, equal_nan=wanted.dtype.kind == "f"), (e, simpler)


def constant(scalar: Type, type: Type, first: object, second: object) -> Expr:
    parts = tuple(Const(value, scalar) for value in (first, second))
    if type is scalar:
        return parts[0]
    return build.splat(parts[0], type) if first == second else build.compose(type, *parts)


def types_of(scalar: Type) -> tuple[Type, ...]:
    kind = kind_of(scalar)
    assert kind is not None
    return scalar, vector_of(kind, 2)


CASES = [(s, t, op) for s in OPERATIONS for t in types_of(s) for op in OPERATIONS[s]]


@pytest.mark.parametrize(
    ("scalar", "type", "op"), CASES, ids=[f"{t}-{op.name}" for _, t, op in CASES]
)
def test_an_operation_keeps_its_value(scalar: Type, type: Type, op: BinaryOp) -> None:
    x, y = build.read("x", type), build.read("y", type)
    operands = [x, y]
    for value in CONSTANTS[scalar]:
        operands.append(constant(scalar, type, value, value))
    if type is not scalar:
        pairs = zip(CONSTANTS[scalar], CONSTANTS[scalar][1:], strict=False)
        operands += [constant(scalar, type, a, b) for a, b in pairs]
    if scalar is not BOOL:
        operands += [build.negate(x), build.negate(y)]
    for other in operands:
        keeps_its_value(Binary(op, x, other, type), x, y)
        keeps_its_value(Binary(op, other, x, type), x, y)
    if scalar is not BOOL:
        keeps_its_value(Binary(op, build.negate(x), build.negate(y), type), x, y)


@pytest.mark.parametrize("scalar", [FLOAT, INT, UINT], ids=str)
def test_a_comparison_and_its_opposite_keep_their_value(scalar: Type) -> None:
    x, y = build.read("x", scalar), build.read("y", scalar)
    for op, other in product(CompareOp, (x, y, Const(CONSTANTS[scalar][1], scalar))):
        keeps_its_value(build.compare(op, x, other), x, y)
        keeps_its_value(build.negation(build.compare(op, x, other)), x, y)


def test_truths_keep_their_value() -> None:
    x, y = build.read("x", BOOL), build.read("y", BOOL)
    yes, no = build.boolean(True), build.boolean(False)
    operands = (x, y, yes, no, build.negation(x), build.both(x, y))
    for a, b in product(operands, operands):
        keeps_its_value(build.both(a, b), x, y)
        keeps_its_value(build.either(a, b), x, y)
        for c in operands:
            keeps_its_value(build.select(a, b, c), x, y)
    pair = vector_of(Kind.BOOL, 2)
    u, v = build.read("x", pair), build.read("y", pair)
    ends = [constant(BOOL, pair, *p) for p in product((False, True), repeat=2)]
    for a, b in product((u, v, *ends), (u, v, *ends)):
        keeps_its_value(Select(u, a, b, pair), u, v)


@pytest.mark.parametrize("scalar", [FLOAT, INT, UINT, BOOL], ids=str)
def test_casts_of_casts_keep_their_value(scalar: Type) -> None:
    kinds = (Kind.FLOAT, Kind.INT, Kind.UINT, Kind.BOOL)
    for type, first, last in product(types_of(scalar), kinds, kinds):
        x, y = build.read("x", type), build.read("y", type)
        keeps_its_value(build.cast(build.cast(x, first), last), x, y)


def test_builtins_of_builtins_keep_their_value() -> None:
    x, y = build.read("x", FLOAT), build.read("y", FLOAT)
    inner = ("abs", "floor", "ceil", "round", "trunc", "sign")
    for outer, name in product(inner, inner):
        keeps_its_value(build.builtin(outer, build.builtin(name, x)), x, y)
    for name in inner:
        keeps_its_value(build.builtin(name, build.negate(x)), x, y)
    for name, other in product(("min", "max"), (x, y, build.negate(x), build.number(1.0))):
        keeps_its_value(build.builtin(name, x, other), x, y)


def test_parts_of_vectors_keep_their_value() -> None:
    x, y = build.read("x", VEC2), build.read("y", VEC2)
    made = build.compose(VEC3, build.swizzle(x, "yx"), build.swizzle(y, "y"))
    parts = [
        made,
        build.compose(VEC3, x, build.number(2.0)),
        build.splat(build.swizzle(y, "x"), VEC3),
    ]
    for base, lanes in product(parts, product("xyz", repeat=2)):
        keeps_its_value(build.swizzle(base, "".join(lanes)), x, y)
    for base, position in product(parts, range(3)):
        keeps_its_value(build.index(base, build.integer(position)), x, y)
    columns = build.compose(MAT2, x, y)
    for base, position in product((columns, Construct((x, y), Array(VEC2, 2))), range(2)):
        keeps_its_value(build.index(base, build.integer(position)), x, y)


n, k = build.number, build.integer
X, J = build.read("x", FLOAT), build.read("j", INT)
B, M = build.read("b", BOOL), build.read("m", MAT2)
U = build.read("u", UINT)


def laws() -> list[tuple[Expr, Expr]]:
    """What a rule has to make simpler, and what of it."""
    op, zero = build.binary, k(0)
    keeps_right = [op(o, J, zero) for o in (*BITS[1:], BinaryOp.SHL, BinaryOp.SHR)]
    keeps_right += [op(o, J, zero) for o in (BinaryOp.ADD, BinaryOp.SUB, BinaryOp.FLOOR_DIV)]
    keeps_right += [op(BinaryOp.MUL, J, k(1)), op(BinaryOp.FLOOR_DIV, J, k(1))]
    keeps_left = [op(o, zero, J) for o in (BinaryOp.ADD, *BITS[1:])] + [op(BinaryOp.MUL, k(1), J)]
    itself = [op(BinaryOp.AND, J, J), op(BinaryOp.OR, J, J)]
    nothing = [op(o, a, b) for o in (BinaryOp.MUL, BinaryOp.AND) for a, b in ((J, zero), (zero, J))]
    nothing += [op(BinaryOp.MOD, J, k(c)) for c in (0, 1)]
    nothing += [op(o, J, J) for o in (BinaryOp.SUB, BinaryOp.XOR)]
    minus = build.negate(X)
    return [
        *((e, J) for e in (*keeps_right, *keeps_left, *itself)),
        *((e, zero) for e in nothing),
        *((e, X) for e in (build.add(X, n(0.0)), build.add(n(0.0), X), build.subtract(X, n(0.0)))),
        *((e, X) for e in (build.multiply(X, n(1.0)), build.multiply(n(1.0), X))),
        *((e, minus) for e in (build.multiply(X, n(-1.0)), build.multiply(n(-1.0), X))),
        (build.divide(X, n(1.0)), X),
        (build.divide(X, n(-1.0)), minus),
        (build.divide(X, n(-0.5)), build.multiply(X, n(-2.0))),
        (build.divide(X, n(2.0**-127)), build.divide(X, n(2.0**-127))),
        (build.add(n(3.0), minus), build.subtract(n(3.0), X)),
        (build.add(minus, n(3.0)), build.subtract(n(3.0), X)),
        (build.multiply(minus, minus), build.multiply(X, X)),
        (build.builtin("abs", minus), build.builtin("abs", X)),
        (build.builtin("max", X, X), X),
        (build.builtin("floor", build.builtin("ceil", X)), build.builtin("ceil", X)),
        (build.both(B, B), B),
        (build.either(B, build.boolean(False)), B),
        (build.select(B, build.boolean(False), build.boolean(True)), build.negation(B)),
        (build.cast(build.cast(B, Kind.INT), Kind.BOOL), B),
        (build.compose(MAT2, build.index(M, k(0)), build.index(M, k(1))), M),
        (build.binary(BinaryOp.MOD, U, build.unsigned(1)), build.unsigned(0)),
    ]


@pytest.mark.parametrize("number", range(len(laws())))
def test_a_law_makes_it_simpler(number: int) -> None:
    e, simpler = laws()[number]
    assert fold_expression(e, 32) is simpler


def test_columns_in_another_order_are_another_matrix() -> None:
    other = build.read("o", MAT2)
    first, second = (Index(M, k(i), VEC2) for i in range(2))
    for parts in ((second, first), (first, first), (first, Index(other, k(1), VEC2))):
        made = build.compose(MAT2, *parts)
        assert fold_expression(made, 32) is made


def test_fields_in_another_order_are_another_struct() -> None:
    pair = Struct("Pair", (("a", FLOAT), ("b", FLOAT)), False)
    s, other = build.read("s", pair), build.read("o", pair)
    a, b = build.field(s, "a"), build.field(s, "b")
    for parts in ((b, a), (a, a), (a, build.field(other, "b")), (a, X)):
        made = Construct(parts, pair)
        assert fold_expression(made, 32) is made
    assert fold_expression(Construct((a, b), pair), 32) is s


def test_an_index_beyond_the_end_is_the_last() -> None:
    items = Construct((X, n(1.0), n(2.0)), Array(FLOAT, 3))
    assert fold_expression(build.index(items, k(7)), 32) is n(2.0)
    p = build.read("p", VEC3)
    assert fold_expression(build.index(p, k(7)), 32) is build.swizzle(p, "z")


def folded(*body: Stmt) -> tuple[Stmt, ...]:
    params = (Param("x", FLOAT), Param("p", VEC3), Param("b", BOOL))
    return fold_function(Function("f", params, FLOAT, body, "f"), 32).body


@pytest.mark.parametrize(
    "value",
    [
        build.swizzle(build.read("p", VEC3), "xx"),
        build.splat(X, VEC2),
        Uniform("size", VEC2),
    ],
    ids=["parts", "splat of a local", "uniform"],
)
def test_a_local_that_names_what_is_free_is_forwarded(value: Expr) -> None:
    square = build.builtin("dot", build.read("v", VEC2), build.read("v", VEC2))
    assert folded(Let("v", value), Return(square)) == (Return(build.builtin("dot", value, value)),)


@pytest.mark.parametrize("leaves", [Break(), Return(n(1.0))], ids=["break", "return"])
@pytest.mark.parametrize("otherwise", [False, True])
def test_a_loop_that_is_left_in_one_branch_goes_on_after_it(leaves: Stmt, otherwise: bool) -> None:
    step = (Continue(),)
    branches = (step, (leaves,)) if otherwise else ((leaves,), step)
    body = (While(build.boolean(True), (If(B, *branches),)), Return(X))
    kept = Return(X) in folded(*body)
    assert kept is isinstance(leaves, Break)
