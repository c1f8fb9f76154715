"""The runtime's machine code: one for all tapes, and for every CPU level."""

from __future__ import annotations

import inspect

import numpy as np
import pytest

from distal.devices.features import LEVELS
from distal.devices.jit import compile_object
from distal.ir.intrinsics import INTRINSICS
from distal.tape import layout, runtime
from distal.tape.elementary import elementary
from distal.tape.operations import ELEMENTARY, NUMBER, OPERATIONS
from distal.tape.runtime_text import runtime_text
from distal.tape.tape import TapeBuilder


@pytest.mark.parametrize("level", LEVELS, ids=lambda level: level.name)
def test_every_level_compiles(level):
    code = compile_object(runtime_text(level.lanes(32)), level)
    for name in (layout.FILL, layout.FLOATS, layout.INTERVALS, layout.PRUNE, layout.ALLOCATE):
        assert name.encode() in code


@pytest.mark.parametrize("level", LEVELS, ids=lambda level: level.name)
def test_interpreters_contract_nothing(level):
    parts = runtime_text(level.lanes(32)).split("\n\n")
    for name in ("floats", "intervals"):
        (text,) = (part for part in parts if part.startswith(f"define internal void @{name}("))
        assert "fmul <" in text
        assert not any(word in text for word in ("contract", "fast", "reassoc", "nnan", "llvm.fma"))


def test_a_new_tape_compiles_nothing(monkeypatch):
    def tape(number: float) -> runtime.TapeProgram:
        builder = TapeBuilder()
        value = builder.operation("add", builder.operation("x"), builder.constant(number))
        return runtime.TapeProgram(builder.tape(value))

    tape(1.0)
    monkeypatch.setattr(runtime, "compile_object", None)
    assert tape(2.0).values(np.zeros((1, 2)))[0] == 2.0


def test_elementary_functions_are_the_built_ins_in_the_order_of_the_table():
    source = inspect.getsource(elementary.python_function)
    called = [
        line.split("=")[1].split("(")[0].strip() for line in source.splitlines() if "(x" in line
    ]
    assert [name for name in called if name in INTRINSICS] == list(ELEMENTARY)
    first = NUMBER[ELEMENTARY[0]]
    assert [row.name for row in OPERATIONS[first:]] == list(ELEMENTARY)


def test_each_thread_has_its_own_memory():
    offsets, size = layout.workspace(1000, 30)
    assert list(offsets) == list(layout.WORKSPACE)
    ends = [*list(offsets.values())[1:], size]
    for (name, start), end in zip(offsets.items(), ends, strict=True):
        operation, slot, fixed = layout.WORKSPACE[name]
        assert end - start >= operation * 1000 + slot * 30 + fixed
        assert start % 64 == 0
