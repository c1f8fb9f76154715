"""Bounds: an index is in range, by proof or by clamping."""

import numpy as np
import pytest

from distal.ir.build import add, builtin, integer, multiply, negate, read, subtract
from distal.ir.build import index as indexed
from distal.ir.nodes import Assign, Binary, BinaryOp, Cast, Const, For, Let, Return, Select, Var
from distal.ir.printer import print_expression, print_module
from distal.ir.target import FramePlace, Target
from distal.ir.types import BOOL, FLOAT, INT, MAT3, UINT, VEC3, Array
from distal.ir.verify import verify
from distal.lang import clamp, func
from distal.passes import bounds
from tests.unit.passes.evaluation import evaluate, passed
from tests.unit.passes.sample_target import CONTEXT, function, program

FOUR = Array(FLOAT, 4)
VALUES = read("values", FOUR)
AT = read("i", INT)
U = read("u", UINT)
LOOP = read("k", INT)


def clamped(index, *before, base=VALUES):
    """The text of ``base[index]`` after the pass, for parameters of any value."""
    params = {"values": FOUR, "v": VEC3, "m": MAT3, "i": INT, "u": UINT, "flag": BOOL}
    body = (*before, Return(indexed(base, index)))
    fn = function("f", params, body[-1].value.type, *body)
    module = bounds.run(program(fn), CONTEXT)
    verify(module, "bounds")
    return print_module(module)


MASK = Binary(BinaryOp.AND, AT, integer(3), INT)
REMAINDER = Binary(BinaryOp.MOD, AT, integer(4), INT)
HASHED = Cast(Binary(BinaryOp.MOD, U, Const(4, UINT), UINT), INT)


@pytest.mark.parametrize(
    "index",
    [
        integer(3),
        MASK,
        REMAINDER,
        HASHED,
        builtin("clamp", AT, integer(0), integer(3)),
        builtin("min", builtin("max", AT, integer(0)), integer(3)),
        Cast(read("flag", BOOL), INT),
        Select(read("flag", BOOL), integer(0), integer(3), INT),
        subtract(integer(3), MASK),
        add(Cast(read("flag", BOOL), INT), integer(2)),
    ],
    ids=print_expression,
)
def test_a_proven_index_is_left_alone(index):
    assert f"return values[{print_expression(index)}]\n" in clamped(index)


@pytest.mark.parametrize(
    ("index", "text"),
    [
        (AT, "values[(min (max i 0) 3)]"),
        (add(MASK, integer(1)), "values[(min (add (and i 3) 1) 3)]"),
        (subtract(MASK, integer(1)), "values[(max (sub (and i 3) 1) 0)]"),
        (Binary(BinaryOp.MOD, AT, integer(-4), INT), "values[(min (max (mod i -4) 0) 3)]"),
        (multiply(MASK, negate(MASK)), "(max (mul (and i 3) (negate (and i 3))) 0)]"),
        # what may wrap is not believed
        (
            add(builtin("max", AT, integer(0)), integer(1)),
            "(min (max (add (max i 0) 1) 0) 3)]",
        ),
        (Cast(U, INT), "values[(min (max (cast int u) 0) 3)]"),
        (integer(7), "values[3]"),
    ],
    ids=lambda e: e if isinstance(e, str) else print_expression(e),
)
def test_any_other_index_is_clamped(index, text):
    assert text in clamped(index)


def test_vectors_and_matrices():
    assert "v[(min (max i 0) 2)]" in clamped(AT, base=read("v", VEC3))
    assert "m[(min (max i 0) 2)]" in clamped(AT, base=read("m", MAT3))


def test_lets_are_followed_and_vars_are_not():
    x = read("x", INT)
    assert "values[x]" in clamped(x, Let("x", MASK))
    assert "values[(min (max x 0) 3)]" in clamped(x, Var("x", MASK), Assign(x, AT))


@pytest.mark.parametrize(
    ("start", "stop", "step", "proven"),
    [(0, 4, 1, True), (0, 5, 1, False), (3, -1, -1, True), (3, -2, -1, False), (-1, 4, 2, False),
     (5, 2, 1, False)],
)  # fmt: skip
def test_loop_counters(start, stop, step, proven):
    total = read("total", FLOAT)
    loop = For(
        "k",
        integer(start),
        integer(stop),
        step,
        (Assign(total, add(total, indexed(VALUES, LOOP))),),
    )
    fn = function(
        "f", {"values": FOUR}, FLOAT, Var("total", Const(0.0, FLOAT)), loop, Return(total)
    )
    text = print_module(bounds.run(program(fn), CONTEXT))
    assert ("values[k]" in text) == proven


def test_targets_of_assignments_are_clamped():
    own = read("own", FOUR)
    fn = function(
        "f",
        {"values": FOUR, "i": INT},
        FLOAT,
        Var("own", VALUES),
        Assign(indexed(own, AT), Const(1.0, FLOAT)),
        Return(indexed(own, integer(0))),
    )
    assert "set own[(min (max i 0) 3)] = 1.0" in print_module(bounds.run(program(fn), CONTEXT))


def test_bounds_that_became_prelude_calls_are_known():
    target = Target("plain", "llvm", FramePlace.NONE, samples=False)

    @func
    def pick(n: int) -> float:
        values = [1.0, 2.0, 3.0]
        return values[n % 3] + values[clamp(n, 0, 2)]

    @func
    def floor_remainder(n: int, m: int) -> int:
        return n + m  # the author's own, of a misleading name

    @func
    def trapped(n: int) -> float:
        values = [1.0, 2.0, 3.0]
        return values[floor_remainder(n, 3)] + values[n % 3]

    text = print_module(passed(pick, target=target, precision=32))
    assert "floor_remainder(n, 3)]" in text and "clamped(n, 0, 2)]" in text
    module = passed(trapped, target=target, precision=32)
    assert "values[(min (max floor_remainder(n, 3) 0) 2)]" in print_module(module)
    assert "values[floor_remainder_2(n, 3)]" in print_module(module)
    n = np.array([-7, -1, 0, 1, 2, 100], np.int32)
    assert np.isfinite(evaluate(module, n, precision=32)).all()
