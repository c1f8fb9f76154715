"""What stands for built-ins a target lacks means the same, whatever drivers there are.

Each case is brought down for a target by the passes, and the result is run by the reference: a
check of the prelude and of decompose alone, also for GLSL ES 1.00, whose driver would need other
ways in and out for the samples.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from distal.backends import get_target
from distal.backends.numpy.interpreter import evaluate
from distal.backends.numpy.operations import Value
from distal.compiler.prelude_library import PreludeLibrary
from distal.diagnostics import CompileError
from distal.ir.build import read
from distal.ir.nodes import EntryKind, Function, Module, Param, Return
from distal.ir.types import Kind, Matrix, Scalar, component_count, kind_of
from distal.passes import bounds
from distal.passes.context import Context
from distal.passes.decompose import decompose
from tests.parity.cases import operator_cases, table_cases
from tests.parity.comparing import disagreement
from tests.parity.programs import Case, Numbers
from tests.parity.sampling import component


@cache
def _cases() -> tuple[Case, ...]:
    return (*table_cases(), *operator_cases())


def _module(case: Case) -> Module:
    value = case.expression([read(f"x{i}", t) for i, t in enumerate(case.args)])
    params = tuple(Param(f"x{i}", t) for i, t in enumerate(case.args))
    function = Function("f", params, value.type, (Return(value),), "f")
    return Module((function,), "f", EntryKind.FUNCTION)


def _arguments(case: Case) -> list[Value]:
    values: list[Value] = []
    dtypes = {Kind.FLOAT: np.float32, Kind.INT: np.int32, Kind.UINT: np.uint32}
    for type, bits in zip(case.args, case.samples, strict=True):
        kind = kind_of(type)
        assert kind is not None
        rows = np.stack([component(bits, i) for i in range(component_count(type))])
        whole = rows != 0 if kind is Kind.BOOL else rows.view(dtypes[kind])
        if isinstance(type, Scalar):
            whole = whole[0]
        elif isinstance(type, Matrix):
            whole = whole.reshape(type.size, type.size, -1)
        values.append(whole)
    return values


def _results(case: Case, module: Module) -> Numbers:
    result = evaluate(module, _arguments(case), {}, {})
    assert isinstance(result, np.ndarray)
    flat = result.reshape(-1, result.shape[-1]).astype(np.float64)
    return np.broadcast_to(flat, (len(flat), len(case.samples[0])))


@pytest.mark.parametrize("target", ["glsl-es100", "glsl-es300", "wgsl", "llvm"])
def test_decomposed_cases_mean_the_same(target: str) -> None:
    context = Context(get_target(target), PreludeLibrary())
    plain = Context(get_target("numpy"), PreludeLibrary())
    compared, messages = 0, []
    for case in _cases():
        module = _module(case)
        try:
            lowered = bounds.run(decompose.run(module, context), context)
        except CompileError:
            continue  # the target refuses what needs unsigned integers or bits
        if lowered.functions[-1].body == module.functions[-1].body:
            continue
        compared += 1
        expected = _results(case, bounds.run(decompose.run(module, plain), plain))
        # What the target has itself and the reference has not, such as a clamp, is its meaning.
        runs = decompose.run(lowered, plain)
        found = disagreement(case, expected, _results(case, runs), on_cpu=True)
        messages.append(found.message)
    assert compared > 50
    assert not any(messages), "\n".join(filter(None, messages))
