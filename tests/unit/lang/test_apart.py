"""``@apart``: the mark reaches the IR, and the function means the same."""

from __future__ import annotations

import numpy as np

from distal.backends import get_target
from distal.compiler.driver import run_passes
from distal.frontend import lower
from distal.ir.printer import print_module
from distal.lang import func, max
from distal.lang.functions import apart


@apart
@func
def rare(x: float) -> float:
    total = x
    for _ in range(3):
        total = total * total + 0.1
    return total


@func
def caller(x: float) -> float:
    if x > 0.5:
        return rare(x)
    return max(x, 0.0)


def test_the_mark_reaches_the_code_of_the_cpu():
    module = run_passes(lower(caller), get_target("llvm"))
    marked = [f.source_name for f in module.functions if f.apart]
    assert marked == ["rare"]
    # Kernels are stored by this text.
    assert "fn rare(x: float) -> float apart" in print_module(module)


def test_vectors_without_and_with_few_pixels_have_the_same_values():
    x = np.zeros(300, np.float32)
    x[[3, 64, 299]] = 0.75
    expected = x.copy()
    once = np.float32(0.75)
    for _ in range(3):
        once = once * once + np.float32(0.1)
    expected[x > 0.5] = once
    np.testing.assert_allclose(caller(x), expected, rtol=1e-6)
