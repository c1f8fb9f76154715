"""Products fused with sums: which ones, the values to the bit, and the processors that cannot."""

from __future__ import annotations

import re
from fractions import Fraction

import numpy as np
import pytest

from distal.backends.llvm import Lanes
from distal.backends.llvm.fusion import fused
from distal.devices import cpu
from distal.devices.cache import Cache
from distal.devices.features import LEVELS, host_levels
from distal.frontend import lower
from distal.lang import floor, func
from tests.unit.llvm.test_text import text_of


@func
def sum_right(a: float, b: float, c: float) -> float:
    return c + a * b


@func
def sum_left(a: float, b: float, c: float) -> float:
    return a * b + c


@func
def difference_right(a: float, b: float, c: float) -> float:
    return c - a * b


@func
def difference_left(a: float, b: float, c: float) -> float:
    return a * b - c


@func
def part_of_product(a: float, b: float, c: float) -> float:
    product = a * b
    return product - floor(product) + c


# Each: the signs of the product and of the summand.
SUMS = {
    "sum_right": (sum_right, 1, 1),
    "sum_left": (sum_left, 1, 1),
    "difference_right": (difference_right, -1, 1),
    "difference_left": (difference_left, 1, -1),
}


def rounded(exact: Fraction) -> np.float32:
    """The nearest float; a double is not wide enough for a sum of any product."""
    near = np.float32(float(exact))
    neighbors = (np.nextafter(near, np.float32(-np.inf)), near, np.nextafter(near, np.float32(9e9)))
    return min(
        neighbors, key=lambda f: (abs(Fraction(float(f)) - exact), int(f.view(np.int32)) % 2)
    )


@pytest.mark.parametrize("level", host_levels(), ids=lambda level: level.name)
@pytest.mark.parametrize("name", SUMS)
def test_a_sum_is_rounded_once_where_the_processor_can(name, level):
    function, of_product, of_summand = SUMS[name]
    rng = np.random.default_rng(3)
    a, b = rng.uniform(-2, 2, (2, 300)).astype(np.float32)
    c = (-of_product * of_summand * (a * b) * (1 + rng.integers(-3, 4, 300) * 2.0**-23)).astype(
        np.float32
    )
    kernel = cpu.prepare(lower(function), features=level.name, cache=Cache(None))
    values = kernel.evaluate([a, b, c], {}, {})
    if level.lanes(32).has_fma:
        exact = [
            of_product * Fraction(float(x)) * Fraction(float(y)) + of_summand * Fraction(float(z))
            for x, y, z in zip(a, b, c, strict=True)
        ]
        expected = np.array([rounded(each) for each in exact])
    else:
        expected = of_product * (a * b) + of_summand * c
    assert np.array_equal(values, expected)


def test_a_product_with_two_uses_is_not_fused():
    text = text_of(part_of_product)
    assert "= fmul <8 x float>" in text
    assert "llvm.fma" not in text


def test_an_equal_product_counts_as_a_use():
    """Two statements that compute the same: both, or neither, see the rounded product."""
    lines = [
        "  %v1 = fmul float %a, %b",
        "  %v2 = fadd float %v1, %c",
        "  %v3 = fsub float %v1, %v2",
    ]
    assert fused(lines, set()) == lines


def test_a_product_of_another_block_is_not_fused():
    lines = ["  %v1 = fmul float %a, %b", "next1:", "  %v2 = fadd float %v1, %c"]
    assert fused(lines, set()) == lines
    assert fused([lines[0], lines[2]], set()) != [lines[0], lines[2]]


def test_levels_know_whether_they_fuse():
    for level in LEVELS:
        has_fma = level.architecture == "aarch64" or "fma" in level.needs
        assert level.lanes(32).has_fma is has_fma, level.name
        text = text_of(sum_left, level.lanes(32))
        # On a processor without the instruction it would be a slow call for each lane.
        assert ("@llvm.fma" in text) is has_fma


@pytest.mark.parametrize("precision", [32, 64])
def test_no_instruction_leaves_a_choice_to_llvm(precision):
    """Flags are allowed to change values at one of its levels of optimization and not at others."""
    text = text_of(sum_left, Lanes(precision=precision), precision)
    flags = r"\b(?:contract|nsz|nnan|ninf|arcp|afn|reassoc|fast)\b"
    assert f"@llvm.fma.v8f{precision}" in text
    assert not re.search(flags, text)
