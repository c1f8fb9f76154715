"""Programs that Mesa's llvmpipe would end early are warned of, others are not."""

from __future__ import annotations

import warnings

import pytest

from distal.devices.adapters import Adapter
from distal.devices.long_loops import certain_turns, warn_of_long_loops
from distal.frontend import lower
from distal.lang import Frame, func, image, vec3

LLVMPIPE = Adapter(0, "llvmpipe (LLVM 15.0.7, 256 bits)", "CPU", "Vulkan")
OTHER = Adapter(0, "NVIDIA H100", "DiscreteGPU", "Vulkan")


@func
def turns(n: int) -> float:
    total = 0.0
    for _ in range(40000):
        total += 1.0
    for j in range(10):
        for k in range(5, 4005, 2):
            if k == n:
                continue
            total += float(j)
    return total


@image
def long(frame: Frame) -> vec3:
    return vec3(turns(int(frame.coord.x)) + turns(int(frame.coord.y)))


@image
def left_early(frame: Frame) -> vec3:
    total = 0.0
    for _ in range(70000):
        total += 1.0
        if total > frame.coord.x:
            break
    return vec3(total)


def test_turns_of_all_loops_are_added() -> None:
    assert certain_turns(lower(long)) == 2 * (40000 + 10 * (1 + 2000))
    assert certain_turns(lower(left_early)) == 0


def test_llvmpipe_is_warned_of() -> None:
    with pytest.warns(RuntimeWarning, match="after 65535 turns together, and this program needs"):
        warn_of_long_loops(lower(long), LLVMPIPE)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_long_loops(lower(long), OTHER)
        warn_of_long_loops(lower(left_early), LLVMPIPE)
