"""Callees stand before callers: set once before the passes, kept by each, relied on by most."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest

import distal
from distal.backends import emit, get_target, target_names
from distal.compiler.driver import run_passes
from distal.frontend import lower
from distal.ir import build
from distal.ir.nodes import (
    Call,
    Construct,
    EntryKind,
    Field,
    Function,
    Module,
    Origin,
    Param,
    Return,
    Uniform,
    UniformDeclaration,
)
from distal.ir.target import FramePlace, Target
from distal.ir.types import FLOAT, INT, VEC2, Struct
from distal.ir.verify import verify
from distal.passes import predicate
from distal.passes.fold import fold
from distal.passes.inline import inline
from distal.passes.per_frame import frequency
from distal.passes.reachable import callees
from distal.passes.share import share
from tests.unit.passes.random_modules import VALUES, Generator, check, context

PLACES = {
    place: Target(
        place.value, "glsl", place, integer_floor=True, saturating_cast=True, inline=True,
        predicated=True,
    )
    for place in (FramePlace.HOST, FramePlace.VERTEX, FramePlace.PIXEL)
}  # fmt: skip
PASSES = {"fold": fold, "frequency": frequency, "inline": inline, "share": share}


class ManyHelpers(Generator):
    """Small functions that call one another, so that there are many orders."""

    def module(self) -> Module:
        for number in range(9):
            types = [self.random.choice(VALUES) for _ in range(self.random.randint(1, 3))]
            self.function(f"small{number}", types, self.random.choice(VALUES))
        return super().module()


def another_order(module: Module, seed: int) -> Module:
    """The functions in a random order, callees first."""
    chance = random.Random(seed)
    waiting = list(module.functions)
    placed: list[Function] = []
    while waiting:
        names = {f.name for f in placed}
        ready = [f for f in waiting if callees(f) <= names]
        placed.append(chance.choice(ready))
        waiting.remove(placed[-1])
    return replace(module, functions=tuple(placed))


@pytest.mark.parametrize("name", PASSES)
@pytest.mark.parametrize("seed", range(12))
def test_every_order_of_callees_first_will_do(name: str, seed: int) -> None:
    module = ManyHelpers(seed).module()
    for place, target in PLACES.items():
        if name != "frequency" and place is not FramePlace.HOST:
            continue
        for order in range(3):
            shuffled = another_order(module, order)
            verify(shuffled)
            check(module, PASSES[name].run(shuffled, context(target)), name)


def test_predication_takes_every_order() -> None:
    target = PLACES[FramePlace.HOST]
    for seed in range(6):
        module = ManyHelpers(seed).module()
        check(module, predicate.run(another_order(module, seed), context(target)), "predicate")


PAIR = Struct("Pair", (("low", FLOAT), ("high", FLOAT)), False)


def test_a_cheap_call_stays_with_the_caller() -> None:
    """``clamped``, which stands first, must not come to call ``pair``, which stands behind it."""
    x, low, p, s = (build.read(n, t) for n, t in (("x", FLOAT), ("low", FLOAT), ("p", PAIR),
                                                  ("s", FLOAT)))  # fmt: skip
    time = Uniform("time", FLOAT)
    functions = (
        Function("clamped", (Param("x", FLOAT), Param("low", FLOAT)), FLOAT,
                 (Return(build.builtin("max", x, low)),), "clamped"),
        Function("pair", (Param("s", FLOAT),), PAIR,
                 (Return(Construct((s, build.number(2.0)), PAIR)),), "pair"),
        Function("within", (Param("x", FLOAT), Param("p", PAIR)), FLOAT,
                 (Return(Call("clamped", (x, Field(p, "low", FLOAT)), FLOAT)),), "within"),
        Function("entry", (Param("x", FLOAT), Param("n", INT), Param("v", VEC2)), FLOAT,
                 (Return(Call("within", (x, Call("pair", (time,), PAIR)), FLOAT)),), "entry"),
    )  # fmt: skip
    uniforms = (UniformDeclaration("time", FLOAT, Origin.FRAME, 0.0),)
    module = Module(functions, "entry", EntryKind.FUNCTION, uniforms)
    verify(module)
    for target in PLACES.values():
        check(module, frequency.run(module, context(target)), "frequency")


SHAPE = distal.BezierTube().bend(-0.45).repeat(2.38)


@pytest.mark.parametrize("name", [n for n in target_names() if n != "numpy"])
def test_the_order_of_a_module_changes_nothing(name: str) -> None:
    target = get_target(name)
    for module in (lower(SHAPE.emitted()), lower(distal.load("example:raymarcher"))):
        wanted = emit(run_passes(module, target), target).text
        functions = list(module.functions)
        random.Random(name).shuffle(functions)
        shuffled = replace(module, functions=tuple(functions))
        assert emit(run_passes(shuffled, target), target).text == wanted


def test_a_bent_and_repeated_tube_has_a_distance() -> None:
    assert SHAPE((0.0, 0.0, 0.0)) == pytest.approx(SHAPE((2.38, 0.0, 0.0)), abs=1e-5)
