"""LLVM's levels of code generation: machine code of each computes the same values, to the bit."""

from __future__ import annotations

import numpy as np
import pytest

import distal
from distal import Box, DistantLight, Plane, Scene, Sphere
from distal.devices import cpu
from distal.devices.cache import Cache
from distal.devices.features import host_levels
from distal.devices.kernel_key import LEVEL_VARIABLE, optimization
from distal.frontend import lower
from distal.tape import runtime
from distal.tape.operations import ELEMENTARY, NUMBER, OPERATIONS
from distal.tape.tape import TapeBuilder
from tests.tape.random_tapes import bits
from tests.unit.llvm.test_text import spiral

SCENES = {
    "shape": lambda: Sphere(1) - Box(1),
    "soft shadows": lambda: Scene(
        Sphere(0.5).translate(0, 0.5, 0) | Plane(), lights=DistantLight((1, 2, 1.5), angle=0.1)
    ),
    "function of a pixel": lambda: distal.load("example:raymarcher"),
    "heights": lambda: distal.load("example:sea"),
    "paths": lambda: distal.load("example:cornell_box"),
    "glass": lambda: distal.load("example:sdfray_glass"),
    "lens": lambda: distal.load("example:depth_of_field"),
}


def both_levels(monkeypatch, compute):
    """What a function returns at LLVM's levels 0 and 2."""
    results = []
    for level in (0, 2):
        monkeypatch.setenv(LEVEL_VARIABLE, str(level))
        assert optimization() == level
        results.append(compute())
    return results


@pytest.mark.parametrize("name", SCENES)
def test_pictures_are_equal(name, monkeypatch):
    drawn = SCENES[name]()
    plain, optimized = both_levels(monkeypatch, lambda: drawn.render((48, 32)).array)
    assert np.array_equal(plain, optimized, equal_nan=True)
    assert len(np.unique(plain)) > 100


@pytest.mark.parametrize("level", host_levels(), ids=lambda level: level.name)
@pytest.mark.parametrize("precision", [32, 64])
def test_values_are_equal_on_each_processor(level, precision, monkeypatch):
    points, turns = np.random.default_rng(1).uniform(-3, 3, (500, 2)), np.arange(500) % 7

    def values():
        kernel = cpu.prepare(lower(spiral), None, precision, level.name, Cache(None))
        return kernel.evaluate([points, turns], {}, {})

    assert np.array_equal(*both_levels(monkeypatch, values))


def test_values_of_tapes_are_equal(monkeypatch):
    builder = TapeBuilder()
    inputs = builder.operation("x"), builder.operation("y")
    total = builder.constant(0.0)
    for name in ("mul", *ELEMENTARY):
        value = builder.operation(name, *inputs[: OPERATIONS[NUMBER[name]].operands])
        total = builder.operation("add", total, value)
    tape = builder.tape(total)
    points = np.random.default_rng(4).uniform(0.1, 0.9, (4096, 2))

    def values():
        runtime._code.cache_clear()
        return bits(runtime.TapeProgram(tape).values(points))

    try:
        assert np.array_equal(*both_levels(monkeypatch, values))
    finally:
        runtime._code.cache_clear()
