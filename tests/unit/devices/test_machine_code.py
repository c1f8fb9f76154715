"""From LLVM text to code in memory, for every level LLVM knows and those that run here."""

from __future__ import annotations

import numpy as np
import pytest

from distal.backends.llvm import TARGET, emit_for
from distal.compiler.driver import run_passes
from distal.devices import features
from distal.devices.executable import Executable
from distal.devices.features import (
    LEVELS,
    CpuLevel,
    chosen_level,
    host_features,
    host_levels,
    level_named,
)
from distal.devices.jit import compile_object
from distal.frontend import lower
from distal.lang import Frame, image, length, sin, vec4

HERE = host_levels()[0]


@image
def scene(frame: Frame) -> vec4:
    table = [0.1, 0.2, 0.4]
    total = 0.0
    for i in range(40):
        if length(frame.coord) < float(i):
            break
        total += table[int(frame.coord.x) % 3] * sin(frame.time)
    return vec4(total)


def text_for(level: CpuLevel, precision: int = 32) -> str:
    return emit_for(run_passes(lower(scene), TARGET, precision), level.lanes(precision)).text


@pytest.mark.parametrize("level", LEVELS, ids=lambda level: level.name)
@pytest.mark.parametrize("precision", [32, 64])
def test_every_level_compiles(
    level: CpuLevel, precision: int, capfd: pytest.CaptureFixture[str]
) -> None:
    code = compile_object(text_for(level, precision), level)
    assert b"distal_render" in code
    assert capfd.readouterr().err == ""  # LLVM has nothing to say about features
    # In 64 bits elementary functions are the C library's; in 32 none is called.
    assert (b"\0sin\0" in code) is (precision == 64)


def test_wide_registers_are_used_where_they_are_promised() -> None:
    if HERE.architecture != "x86_64":
        pytest.skip("looks for x86 registers")
    for name, register in (("avx512", "zmm"), ("avx2", "ymm"), ("sse4.2", "xmm")):
        level = level_named(name)
        assembly = compile_object(text_for(level), level, assembly=True)
        assert register in assembly
        wider = {"xmm": "ymm", "ymm": "zmm", "zmm": "no such"}[register]
        assert wider not in assembly


def test_code_is_called_and_constants_lie_beside_it() -> None:
    text = """
    @numbers = private constant [4 x i32] [i32 3, i32 5, i32 8, i32 13], align 16
    define void @fill(ptr %out) {
      %v = load <4 x i32>, ptr @numbers
      store <4 x i32> %v, ptr %out, align 4
      ret void
    }"""
    out = np.zeros(4, np.int32)
    executable = Executable(compile_object(text, HERE))
    executable.function("fill")(out.ctypes.data)
    assert out.tolist() == [3, 5, 8, 13]
    assert "fill" in executable
    assert "nothing" not in executable


def test_a_library_function_is_found_and_called() -> None:
    text = """
    declare double @cos(double)
    define void @turn(ptr %x) {
      %a = load double, ptr %x
      %b = call double @cos(double %a)
      store double %b, ptr %x
      ret void
    }"""
    x = np.array([0.5])
    Executable(compile_object(text, HERE)).function("turn")(x.ctypes.data)
    assert x[0] == pytest.approx(np.cos(0.5), rel=1e-15)


def test_levels_are_chosen_by_name_and_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DISTAL_CPU", raising=False)
    assert chosen_level() is HERE
    last = host_levels()[-1]
    monkeypatch.setenv("DISTAL_CPU", last.name)
    assert chosen_level() is last
    assert chosen_level(HERE.name) is HERE
    with pytest.raises(ValueError, match=r"no CPU feature level 'mmx'; levels: avx512, avx2"):
        chosen_level("mmx")
    foreign = "neon" if HERE.architecture == "x86_64" else "avx2"
    with pytest.raises(ValueError, match="cannot run"):
        chosen_level(foreign)
    assert host_features()


def test_a_system_without_a_list_of_features(monkeypatch: pytest.MonkeyPatch) -> None:
    """LLVM asks the processor itself: the same levels."""
    listed = host_levels()
    monkeypatch.setattr(features, "_from_cpuinfo", frozenset)
    monkeypatch.setattr(features.sys, "platform", "linux")
    try:
        for function in (host_features, host_levels):
            function.cache_clear()
        assert host_levels() == listed
    finally:
        for function in (host_features, host_levels):
            function.cache_clear()
