"""Split structs: a local for each field, uniform beside varying, and the same results."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from distal.backends import get_target
from distal.backends.llvm.uniformity import Uniformity
from distal.backends.numpy import interpreter as reference
from distal.compiler.driver import run_passes
from distal.frontend import lower
from distal.ir.nodes import Construct, Let
from distal.ir.verify import verify
from distal.ir.walk import expressions_in, statements_in
from distal.lang import func, struct
from distal.passes.split_structs import split


@struct
class Inner:
    count: int
    height: float


@struct
class Outer:
    inner: Inner
    place: float
    unread: float


@func
def by_fields(x: float, n: int) -> float:
    count = n * 2
    found = Outer(Inner(count, x), x + 1.0, x * 3.0)
    count += 5
    total = found.place + found.inner.height
    for i in range(found.inner.count):
        total += float(i)
    return total + float(count)


@func
def taken(inner: Inner) -> float:
    return inner.height * float(inner.count)


@func
def partly_whole(x: float, n: int) -> float:
    found = Outer(Inner(n, x), x + 1.0, x * 3.0)
    return taken(found.inner) + found.place


@func
def whole(x: float, n: int) -> float:
    inner = Inner(n, x)
    return taken(inner) + inner.height


def before(function):
    return run_passes(lower(function), get_target("llvm"), after="decompose")


def changed(function):
    module = before(function)
    result = replace(module, functions=tuple(split(f) for f in module.functions))
    verify(result, "decompose")
    return module, result


def entry_of(module, function):
    return next(f for f in module.functions if f.source_name == function.name)


def constructs(function):
    return [e for e in expressions_in(function.body) if isinstance(e, Construct)]


def test_a_struct_read_by_fields_is_gone_with_what_nothing_reads():
    module, result = changed(by_fields)
    assert len(constructs(entry_of(module, by_fields))) == 2
    function = entry_of(result, by_fields)
    assert constructs(function) == []
    assert not any("unread" in s.name for s in statements_in(function.body) if isinstance(s, Let))


def test_a_field_that_is_equal_for_all_pixels_does_not_vary():
    module, result = changed(by_fields)
    for functions, varies in ((module, True), (result, False)):
        function = entry_of(functions, by_fields)
        uniformity = Uniformity(function, frozenset({"x"}))
        assert bool(uniformity.divergent_loops or "i" in uniformity.varying) is varies


@pytest.mark.parametrize(("function", "kept"), [(partly_whole, 1), (whole, 1)])
def test_a_struct_that_is_read_whole_stays(function, kept):
    _, result = changed(function)
    assert len(constructs(entry_of(result, function))) == kept


@pytest.mark.parametrize("function", [by_fields, partly_whole, whole])
def test_the_same_results(function):
    module, result = changed(function)
    values = [np.linspace(-3.0, 4.0, 29).astype(np.float32), np.full(29, 3, np.int32)]
    expected = reference.evaluate(module, values, {}, {})
    np.testing.assert_array_equal(expected, reference.evaluate(result, values, {}, {}))
    assert len(np.unique(expected)) > 2
