"""The runtime's machine code: one for all tapes, and for every CPU level."""

from __future__ import annotations

import numpy as np
import pytest

from distal.devices.features import LEVELS
from distal.devices.jit import compile_object
from distal.ir.intrinsics import INTRINSICS
from distal.lang.functions import Func
from distal.tape import layout, runtime
from distal.tape.elementary import elementary
from distal.tape.operations import ELEMENTARY, NUMBER, OPERATIONS
from distal.tape.runtime_text import runtime_text
from distal.tape.scene_text import overload_of
from distal.tape.tape import TapeBuilder


@pytest.mark.parametrize("level", LEVELS, ids=lambda level: level.name)
def test_every_level_compiles(level):
    code = compile_object(runtime_text(level.lanes(32)), level)
    for name in (
        layout.FILL,
        layout.FLOATS,
        layout.INTERVALS,
        layout.PRUNE,
        layout.ALLOCATE,
        layout.HEIGHTS,
    ):
        assert name.encode() in code


@pytest.mark.parametrize("level", LEVELS, ids=lambda level: level.name)
def test_interpreters_contract_nothing(level):
    parts = runtime_text(level.lanes(32)).split("\n\n")
    for name in ("floats", "intervals", "gradients"):
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


def test_every_elementary_built_in_is_an_operation():
    """Those that the CPU computes by polynomials; each number selects its own."""
    for i, name in enumerate(ELEMENTARY):
        points = np.full((4, 1), 0.4, np.float32)
        number = np.full(4, i, np.int32)
        found = elementary()(number, points[:, 0], points[:, 0])
        operands = ", ".join("xy"[: OPERATIONS[NUMBER[name]].operands])
        text = f"def alone(x: float, y: float) -> float:\n    return {name}({operands})\n"
        alone = Func(overload_of(text, "alone"))
        assert (found[:, 0] == alone(points[:, 0], points[:, 0])).all()
    assert {"sin", "exp", "atan2", "pow", "tanh"} <= set(ELEMENTARY) <= set(INTRINSICS)


def test_each_thread_has_its_own_memory():
    offsets, size = layout.workspace(1000, 30)
    assert list(offsets) == list(layout.WORKSPACE)
    ends = [*list(offsets.values())[1:], size]
    for (name, start), end in zip(offsets.items(), ends, strict=True):
        operation, slot, fixed = layout.WORKSPACE[name]
        assert end - start >= operation * 1000 + slot * 30 + fixed
        assert start % 64 == 0
