"""Intervals hold what the reference computes, and are narrow where a text goes without a guard."""

from __future__ import annotations

import random

import numpy as np
import pytest

from distal.backends import get_target
from distal.backends.numpy.interpreter import evaluate
from distal.compiler.driver import compile
from distal.compiler.prelude_library import PreludeLibrary
from distal.ir import build
from distal.ir.build import builtin, number, read
from distal.ir.nodes import EntryKind, Expr, Function, Module, Param, Return, Unary, UnaryOp
from distal.ir.types import FLOAT
from distal.lang import cos, exp, func, normalize, smoothstep, sqrt, vec3
from distal.passes.context import Context
from distal.passes.decompose import decompose
from distal.passes.fold.float_ranges import interval

VALUES = np.float32([0.0, -0.0, 1.0, -1.0, 0.3, -2.7, 40.0, -1e4, 1e18, -1e18, 1e-30])
ONE = ("abs", "sin", "cos", "fract", "sqrt", "exp", "tanh", "cosh")
TWO = ("min", "max", "step", "pow")


def grown(source: random.Random, depth: int) -> Expr:
    kind = source.randrange(8 if depth else 2)
    if kind == 0:
        return number(float(source.choice((0.0, 1.0, -1.0, 0.5, -3.0, 2.0))))
    if kind == 1:
        return read(source.choice("xy"), FLOAT)
    first = grown(source, depth - 1)
    if kind == 2:
        return Unary(UnaryOp.NEGATE, first, FLOAT)
    if kind == 3:
        return builtin(source.choice(ONE), first)
    second = first if source.random() < 0.3 else grown(source, depth - 1)
    if kind == 4:
        return builtin(source.choice(TWO), first, second)
    if kind == 5:
        return builtin("clamp", first, number(-1.0), second)
    return source.choice((build.add, build.subtract, build.multiply))(first, second)


@pytest.mark.parametrize("seed", range(20))
def test_values_are_within(seed: int) -> None:
    source = random.Random(seed)
    context = Context(get_target("numpy"), PreludeLibrary())
    x, y = (a.ravel() for a in np.meshgrid(VALUES, VALUES))
    narrow = 0
    for _ in range(15):
        e = grown(source, 4)
        low, high = interval(e, {})
        narrow += low > -np.inf or high < np.inf
        function = Function("f", (Param("x", FLOAT), Param("y", FLOAT)), FLOAT, (Return(e),), "f")
        module = decompose.run(Module((function,), "f", EntryKind.FUNCTION), context)
        found = np.asarray(evaluate(module, [x, y], {}, {})).astype(np.float64)
        assert not np.any(found < low) and not np.any(found > high), (e, low, high)
    assert narrow > 3


@func
def kept(t: float, a: float) -> vec3:
    v = vec3(3.0 * cos(a), 0.8 + 0.2 * cos(t), 3.0)
    return normalize(-v) * exp(-0.02 * t * t) * sqrt(t * t + 1.0) * smoothstep(0.2, 0.4, t)


@func
def guarded(t: float, a: float) -> vec3:
    v = vec3(a, t, 0.0)
    return normalize(v) * exp(-0.02 * t * a) * sqrt(t) * smoothstep(0.2, a, t)


@pytest.mark.parametrize("target", ["shadertoy", "wgsl", "glsl-es100"])
def test_texts_are_guarded_where_they_need_it(target: str) -> None:
    text = compile(kept, target).text
    assert "exp(-0.02 * t * t)" in text and "normalize(-v)" in text
    assert "smoothstep(0.2, 0.4, t)" in text and "max(" not in text
    text = compile(guarded, target).text
    assert "exp(min(-0.02 * t * a, 87.0))" in text and "normalized(v)" in text
    assert "smoothstepped(0.2, a, t)" in text and "sqrt(max(t, 0.0))" in text
