"""What the LLVM text says: scalars where lanes agree, branches, polls, no calls but our own."""

from __future__ import annotations

import re
from typing import Any

import pytest

from distal.backends.llvm import TARGET, Lanes, emit, emit_for
from distal.compiler.driver import run_passes
from distal.diagnostics import CompileError
from distal.frontend import lower
from distal.ir.nodes import (
    Assign,
    Construct,
    EntryKind,
    Function,
    Index,
    Module,
    Param,
    Read,
    Return,
    Var,
)
from distal.ir.types import FLOAT, INT, Array
from distal.lang import Frame, func, image, length, sin, slider, vec2, vec3, vec4

count = slider("Count", 3.0, low=1.0, high=9.0)


@image
def flat(frame: Frame) -> vec4:
    """The same color everywhere, by way of a loop whose end is known at run time only."""
    total = 0.0
    for i in range(int(count)):
        total = total * 0.5 + float(i) * frame.time
    return vec4(total)


@image
def divergent(frame: Frame) -> vec4:
    color = vec3(0.0)
    if frame.coord.x > 20.0:
        p = frame.coord * 0.01
        for _ in range(9):
            p = vec2(p.x * p.x - p.y, 2.0 * p.x * p.y) / (1.0 + length(p))
        color = vec3(p, length(p))
    return vec4(color, 1.0)


@func
def spiral(p: vec2, turns: int) -> float:
    q = p
    for i in range(turns):
        q = vec2(q.y, -q.x) * (1.0 + 0.1 * sin(q.x + float(i)))
    return length(q)


def text_of(scene: Any, lanes: Lanes | None = None, precision: int = 32) -> str:
    module = run_passes(lower(scene), TARGET, precision)
    return emit_for(module, lanes or Lanes()).text


def test_the_default_text_is_the_same_every_time() -> None:
    first, again = (emit(run_passes(lower(divergent), TARGET), TARGET) for _ in range(2))
    assert first.text == again.text
    assert first.interface == again.interface
    assert "/" not in first.text.split("\n")[0]


def test_what_all_lanes_share_is_computed_once() -> None:
    text = text_of(flat)
    vector_arithmetic = re.findall(r"= f(?:add|mul|sub|div) .*<8 x float>.*", text)
    # The pixel's own coordinate, a half added to whole numbers, is all that differs.
    assert vector_arithmetic
    assert all("splat (float 0x3FE0000000000000)" in line for line in vector_arithmetic)


def test_a_loop_with_an_end_known_at_run_time_polls() -> None:
    assert "load volatile i32, ptr %stop" in text_of(flat)
    once_per_tile = text_of(divergent).count("load volatile i32, ptr %stop")
    assert once_per_tile == 1


def test_dear_code_under_a_condition_is_branched_around() -> None:
    assert re.search(r"bitcast <8 x i1> %v\d+ to i8", text_of(divergent))


def test_the_shape_of_vectors_is_the_callers() -> None:
    text = text_of(divergent, Lanes(4, 3, 64, 4, "avx2"))
    assert "<4 x double>" in text
    assert "<8 x double>" not in text


def test_no_function_of_a_library_is_called_in_32_bits() -> None:
    for scene in (flat, divergent, spiral):
        called = set(re.findall(r"call [^@]*@([\w.\"]+)\(", text_of(scene)))
        assert all(name.startswith("llvm.") for name in called), called


def test_interface_tells_how_to_call() -> None:
    interface = emit(run_passes(lower(spiral), TARGET), TARGET).interface
    assert interface["kind"] == "function"
    assert interface["params"] == [["p", {"kind": "float", "size": 2}], ["turns", {"kind": "int"}]]
    assert interface["result"] == {"kind": "float"}


def test_arrays_that_no_stack_holds_are_refused() -> None:
    """Built by hand: no author writes 50,000 elements."""
    elements = 50_000
    kind = Array(FLOAT, elements)
    filled = Construct((Read("x", FLOAT),) * elements, kind)
    at = Read("i", INT)
    body = (
        Var("a", filled),
        Assign(Index(Read("a", kind), at, FLOAT), Read("x", FLOAT)),
        Return(Index(Read("a", kind), at, FLOAT)),
    )
    function = Function("f", (Param("x", FLOAT), Param("i", INT)), FLOAT, body, "f")
    module = Module((function,), "f", EntryKind.FUNCTION)
    with pytest.raises(CompileError, match="arrays of 'f' are too large for the CPU"):
        emit_for(module, Lanes(16, 4))
