"""Tapes of functions: the same values as the ordinary kernel, or a refusal with its reason."""

from __future__ import annotations

import numpy as np
import pytest

import distal
from distal.backends.llvm import TARGET
from distal.compiler.driver import run_passes
from distal.frontend import lower
from distal.lang import Buffer, atan2, exp, func, log, sin, smoothstep, vec2, vec3
from distal.tape.from_ir import LAST_PASS, PRECISION, tape_of
from distal.tape.runtime import TapeProgram
from distal.tape.tape import Tape, TapeError


def tape(function, **uniforms) -> Tape:
    module = run_passes(lower(function), TARGET, PRECISION, after=LAST_PASS)
    return tape_of(module, uniforms)


def agrees(function, size: int = 2, tolerance: float = 2e-6) -> Tape:
    made = tape(function)
    points = np.random.default_rng(3).uniform(-2, 2, (300, size)).astype(np.float32)
    found, expected = TapeProgram(made).values(points), function(points)
    assert np.abs(found - expected).max() <= tolerance * max(1.0, np.abs(expected).max())
    return made


SHAPES = [
    distal.Circle(0.7),
    distal.Rectangle((1.0, 0.5)).rotate(0.3).translate(0.2, 0.1),
    distal.RegularPolygon(0.8, 7),
    distal.GearProfile(),
    distal.Heart(),
    distal.Pentagram(),
    distal.Circle(0.5).union(distal.Rectangle((1.0, 0.2)), smooth=0.1),
    distal.Circle(0.5) - distal.Circle(0.3).translate(0.2, 0.0),
    distal.Circle(0.2).repeat(0.7, 0.7),
    distal.Circle(0.2).translate(0.7, 0.0).repeat_polar(5),
    distal.Torus(0.8, 0.2),
    distal.Box((1.0, 0.6, 0.4)).rotate(0.5, axis=(0.0, 0.6, 0.8)),
    distal.Capsule(0.2, 1.0).rotate(z=0.5).twist(0.5),
]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: s.name)
def test_shapes_have_the_same_values(shape):
    assert len(agrees(shape, 2 if shape.flat else 3, 1e-5)) > 3


@func
def branches(p: vec2) -> float:
    if p.x > 0.5:
        return p.y * 2.0
    d = p.x
    if p.y > 0.0:
        d = d + p.y
        if p.x < -1.0:
            d = -d
    else:
        d = d - 3.0
    return d


@func
def loops(p: vec3) -> float:
    total = 0.0
    for i in range(6):
        q = vec3(p.z, p.x, p.y) * float(i)
        q.x += 1.0
        if i % 2 == 0:
            continue
        total += max(abs(q.x), q.y * q.z)
    return total


@func
def elementary_functions(p: vec2) -> float:
    a = sin(p.x) * exp(p.y) + atan2(p.y, p.x)
    b = log(abs(p.x)) ** 2 + abs(p.y) ** 1.7
    return a + b + smoothstep(0.0, 1.0, p.x) + p.x % 0.7 + p.y // 0.3


@pytest.mark.parametrize("function, size", [(branches, 2), (loops, 3), (elementary_functions, 2)])
def test_functions_have_the_same_values(function, size):
    agrees(function, size, 1e-5)


@func
def depends_on_the_point(p: vec2) -> float:
    d = p.x
    while d > 1.0:
        d = d * 0.5
    return d


@func
def counts(p: vec2) -> float:
    total = 0.0
    for i in range(int(p.x)):
        total += float(i)
    return total


@func
def whole_numbers(p: vec2) -> float:
    return float(int(p.x) * 3)


TABLE = Buffer(np.linspace(0.0, 1.0, 8, dtype=np.float32))


@func
def reads_a_table(p: vec2) -> float:
    return TABLE[int(p.x * 8.0)]


REFUSALS = [
    (depends_on_the_point, "it has a loop whose length differs from point to point"),
    (counts, "it computes with whole numbers that differ from point to point"),
    (whole_numbers, "it computes with whole numbers that differ from point to point"),
    (reads_a_table, "it computes with whole numbers that differ from point to point"),
]


@pytest.mark.parametrize("function, reason", REFUSALS, ids=lambda x: getattr(x, "name", ""))
def test_what_cannot_be_a_tape_is_refused(function, reason):
    with pytest.raises(TapeError) as error:
        tape(function)
    assert str(error.value) == reason


@func
def long_function(p: vec2) -> float:
    total = p.x
    for _ in range(300):
        for _ in range(300):
            total = total * 1.0001 + p.y
    return total


def test_a_function_that_is_too_long_is_refused():
    with pytest.raises(TapeError, match="a tape has at most 65535 operations"):
        tape(long_function)


def test_equal_operations_are_one():
    @func
    def twice(p: vec2) -> float:
        return (p.x + p.y) * (p.x + p.y)

    made = tape(twice)
    assert str(made) == "_0 x\n_1 y\n_2 add _0 _1\n_3 square _2"


def test_numbers_of_a_shape_are_constants_of_its_tape():
    shape = distal.Circle(0.25)
    module = lower(shape)
    (uniform,) = module.uniforms
    one, other = tape(shape), tape(shape, **{uniform.name: 0.5})
    assert (one.operations == other.operations).all()
    assert 0.25 in one.constants
    assert 0.5 in other.constants
