"""Every row of the table in 64 bits: the CPU agrees with NumPy's own functions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from distal.devices import cpu, reference
from distal.devices.cache import Cache
from distal.ir import build
from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import EntryKind, Function, Module, Param, Read, Return
from distal.ir.types import Kind, Matrix, Scalar, Type, Vector

ROWS = [
    row for row in INTRINSICS.values()
    if not row.hidden and "bits" not in row.name and row.name != "pcg"
]  # fmt: skip
# NumPy's functions and the C library's may differ in the last digit or two.
RTOL = 1e-13


def sampled(type: Type, low: float, high: float, rng: Any) -> Any:
    match type:
        case Scalar(kind):
            shape: tuple[int, ...] = (500,)
        case Vector(kind, size):
            shape = (500, size)
        case Matrix(size):
            kind, shape = Kind.FLOAT, (500, size, size)
        case _:
            raise AssertionError(type)
    if kind is Kind.BOOL:
        return rng.random(shape) < 0.5
    values = rng.uniform(low, high, shape)
    if kind is Kind.FLOAT:
        return values
    return np.abs(values).astype(np.uint32) if kind is Kind.UINT else values.astype(np.int32)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.name)
def test_row(row: Any) -> None:
    rng = np.random.default_rng(7)
    for params, _ in row.signatures[0].instances():
        names = [f"a{i}" for i in range(len(params))]
        reads = [Read(n, t) for n, t in zip(names, params, strict=True)]
        value = build.builtin(row.name, *reads)
        declared = tuple(Param(n, t) for n, t in zip(names, params, strict=True))
        function = Function("f", declared, value.type, (Return(value),), "f")
        module = Module((function,), "f", EntryKind.FUNCTION)
        args = [
            sampled(t, low, high, rng) for t, (low, high) in zip(params, row.domain, strict=True)
        ]
        actual = cpu.prepare(module, precision=64, cache=Cache(None)).evaluate(args, {}, {})
        expected = reference.prepare(module, precision=64).evaluate(args, {}, {})
        assert isinstance(actual, np.ndarray)
        assert actual.dtype == expected.dtype
        # An inverse loses what the matrix's condition takes.
        rtol = 1e-9 if row.name in ("inverse", "refract") else RTOL
        np.testing.assert_allclose(actual, expected, rtol=rtol, atol=1e-12)
