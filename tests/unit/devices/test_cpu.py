"""The CPU device: scene code in, pictures and values out, on every feature level it can run."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from distal.devices import cpu, reference
from distal.devices.base import Cancelled
from distal.devices.cache import Cache
from distal.devices.features import host_levels
from distal.frontend import lower
from distal.lang import (
    Buffer,
    Frame,
    Texture2D,
    array,
    func,
    image,
    ivec2,
    length,
    mat3,
    sample,
    sin,
    slider,
    struct,
    texel,
    vec2,
    vec3,
    vec4,
)

LEVELS = [level.name for level in host_levels()]
NO_CACHE = Cache(None)
photo = Texture2D(np.arange(5 * 3 * 4, dtype=np.float32).reshape(3, 5, 4) / 60.0)
numbers = Buffer([3.0, -1.0, 4.0, 1.5])
blend = slider("Blend", 0.25)


@struct
class Hit:
    distance: float
    steps: int


@image
def many_ways(frame: Frame) -> vec4:
    """Loops left early, nested conditions, a table indexed lane by lane, per-frame work."""
    uv = frame.coord / frame.resolution
    table = [0.1, 0.7, 0.3, 0.9]
    total = 0.0
    steps = 0
    for i in range(24):
        if uv.x * 20.0 < float(i):
            break
        if i % 3 == 1:
            continue
        total += table[int(uv.y * 4.0)] * sin(frame.time)
        for j in range(i, 26, 7):
            if total > 4.0 + uv.y:
                return vec4(total, float(j), 0.5, 1.0)
            steps += j
    while float(steps) > 30.0 * uv.y + 1.0:
        steps = steps // 2
    return vec4(total, float(steps), table[steps % 4], blend)


@image
def reads(frame: Frame) -> vec4:
    i = ivec2(frame.coord)
    return sample(photo, frame.coord / 7.0) + texel(photo, i % 9 - 2) * numbers[i.x - 3]


@image
def endless(frame: Frame) -> vec4:
    x = frame.coord.x
    while x > 0.0:
        x = x * 0.5 + 1.0
    return vec4(x)


@image
def endless_per_frame(frame: Frame) -> vec4:
    x = frame.time
    while x > 0.0:
        x = x * 0.5 + 1.0
    return vec4(x) + frame.coord.x


@func
def march(p: vec3, bound: float) -> Hit:
    t = 0.0
    n = 0
    while t < bound:
        d = length(p) * 0.25
        if d < 0.1:
            return Hit(t, n)
        t += d
        n += 1
    return Hit(t, -n)


@func
def turned(m: mat3, p: vec3) -> vec3:
    return m @ p


@func
def sorted_pair(values: array[float, 4], i: int) -> array[float, 4]:
    out = values
    out[i] = out[3 - i] * 2.0
    return out


@func
def parity(i: int) -> tuple[bool, vec2]:
    return i % 2 == 0, vec2(float(i), 0.5)


def values_for(module: Any, width: int, height: int) -> dict[str, Any]:
    """The frame's values, and every parameter's default."""
    frame = {
        "resolution": (float(width), float(height)),
        "time": 1.25,
        "mouse": (0.0, 0.0, 0.0, 0.0),
        "index": 0,
        "seed": 0,
    }
    return {**frame, **{u.name: u.default for u in module.uniforms}}


def rendered(scene: Any, width: int, height: int, **options: Any) -> Any:
    module = lower(scene)
    values = values_for(module, width, height)
    resources = {r.name: r.source for r in module.resources}
    kernel = cpu.prepare(module, cache=NO_CACHE, **options)
    picture = kernel.render(width, height, values, resources)
    expected = reference.prepare(module).render(width, height, values, resources)
    return picture, expected


@pytest.mark.parametrize("level", LEVELS)
def test_control_flow_is_the_references(level: str) -> None:
    picture, expected = rendered(many_ways, 70, 37, features=level)
    np.testing.assert_allclose(picture, expected, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("level", LEVELS)
def test_textures_and_buffers_are_the_references(level: str) -> None:
    picture, expected = rendered(reads, 31, 17, features=level)
    np.testing.assert_allclose(picture, expected, rtol=1e-5, atol=1e-5)


def test_double_precision() -> None:
    picture, expected = rendered(many_ways, 33, 21, precision=64)
    assert picture.dtype == np.float32
    np.testing.assert_allclose(picture, expected, rtol=1e-5, atol=1e-5)
    picture, expected = rendered(reads, 33, 21, precision=64)
    np.testing.assert_allclose(picture, expected, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("size", [(1, 1), (7, 3), (64, 16), (65, 17), (200, 1), (1, 90)])
def test_every_size_is_filled_and_nothing_beyond(size: tuple[int, int]) -> None:
    picture, expected = rendered(many_ways, *size)
    np.testing.assert_allclose(picture, expected, rtol=1e-5, atol=1e-5)


def points(function: Any, *args: Any, precision: int = 32) -> Any:
    module = lower(function)
    resources = {r.name: r.source for r in module.resources}
    kernel = cpu.prepare(module, precision=precision, cache=NO_CACHE)
    return kernel.evaluate(args, {}, resources)


@pytest.mark.parametrize("count", [1, 3, 64, 1000, 9000])
def test_a_struct_comes_back_field_by_field(count: int) -> None:
    p = np.random.default_rng(1).normal(size=(count, 3)).astype(np.float32) * 3.0
    distance, steps = points(march, p, np.float32([7.5]))
    expected = reference.prepare(lower(march)).evaluate([p, np.float32([7.5] * count)], {}, {})
    np.testing.assert_allclose(distance, expected[0], rtol=1e-5)
    np.testing.assert_array_equal(steps, expected[1])
    assert steps.dtype == np.int32


@pytest.mark.parametrize("precision", [32, 64])
def test_matrices_have_numpys_rows_and_columns(precision: int) -> None:
    rng = np.random.default_rng(2)
    kind = np.float32 if precision == 32 else np.float64
    m, p = rng.normal(size=(50, 3, 3)).astype(kind), rng.normal(size=(50, 3)).astype(kind)
    result = points(turned, m, p, precision=precision)
    assert result.dtype == kind
    limit = 1e-5 if precision == 32 else 1e-13
    np.testing.assert_allclose(result, np.einsum("nij,nj->ni", m, p), rtol=limit, atol=limit)


def test_arrays_are_indexed_lane_by_lane() -> None:
    values = np.arange(400, dtype=np.float32).reshape(100, 4)
    index = (np.arange(100) % 7 - 1).astype(np.int32)
    result = points(sorted_pair, values, index)
    expected = values.copy()
    for row, i in enumerate(index):
        expected[row, np.clip(i, 0, 3)] = values[row, np.clip(3 - i, 0, 3)] * 2.0
    np.testing.assert_array_equal(result, expected)


def test_tuples_and_bools() -> None:
    even, pair = points(parity, np.arange(5, dtype=np.int32))
    assert even.dtype == np.bool_
    assert even.tolist() == [True, False, True, False, True]
    assert pair.shape == (5, 2)


@pytest.mark.parametrize("scene", [endless, endless_per_frame])
def test_an_endless_loop_can_be_cancelled(scene: Any) -> None:
    module = lower(scene)
    kernel = cpu.prepare(module, cache=NO_CACHE)
    values = values_for(module, 640, 480)
    event = threading.Event()
    threading.Timer(0.1, event.set).start()
    started = time.perf_counter()
    with pytest.raises(Cancelled):
        kernel.render(640, 480, values, {}, cancel=event)
    assert time.perf_counter() - started < 60.0


def test_progress_ends_at_one_and_cancel_may_be_a_function() -> None:
    module = lower(many_ways)
    kernel = cpu.prepare(module, cache=NO_CACHE)
    values = values_for(module, 70, 37)
    told: list[float] = []
    kernel.render(64, 64, values, {}, progress=told.append)
    assert told[-1] == 1.0
    with pytest.raises(Cancelled):
        kernel.render(64, 64, values, {}, cancel=lambda: True)


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_threads_share_the_tiles(threads: int) -> None:
    module = lower(many_ways)
    kernel = cpu.prepare(module, cache=NO_CACHE)
    values = values_for(module, 70, 37)
    picture = kernel.render(300, 200, values, {}, threads=threads)
    assert kernel.stats["threads"] == threads
    np.testing.assert_array_equal(picture, kernel.render(300, 200, values, {}, threads=1))


def test_a_picture_still_held_is_never_written_again() -> None:
    module = lower(many_ways)
    kernel = cpu.prepare(module, cache=NO_CACHE)
    values = values_for(module, 70, 37)
    first = kernel.render(200, 200, values, {})
    part, copy = first[10:20, :, :2], first[10:20, :, :2].copy()
    del first
    kernel.render(200, 200, {**values, "time": 0.3}, {})
    np.testing.assert_array_equal(part, copy)


def test_sizes_and_thread_counts_that_cannot_be_are_refused() -> None:
    module = lower(many_ways)
    kernel = cpu.prepare(module, cache=NO_CACHE)
    values = values_for(module, 70, 37)
    with pytest.raises(ValueError, match="a picture is"):
        kernel.render(0, 10, values, {})
    with pytest.raises(ValueError, match="threads"):
        kernel.render(10, 10, values, {}, threads=0)


def test_a_kernel_is_found_again_without_the_compiler(tmp_path: Path) -> None:
    module = lower(many_ways)
    values = values_for(module, 70, 37)
    first = cpu.prepare(module, cache=Cache(tmp_path / "kernels"))

    def unwanted(*_: Any) -> Any:
        raise AssertionError("compiled again")

    again = cpu.prepare(module, unwanted, cache=Cache(tmp_path / "kernels"))
    assert (first.stats["cache_hit"], again.stats["cache_hit"]) == (False, True)
    np.testing.assert_array_equal(
        first.render(64, 40, values, {}), again.render(64, 40, values, {})
    )
    other = cpu.prepare(module, precision=64, cache=Cache(tmp_path / "kernels"))
    assert not other.stats["cache_hit"]


@pytest.mark.skipif(sys.platform == "win32", reason="sends a signal")
def test_control_c_ends_an_endless_picture(tmp_path: Path) -> None:
    """In a process of its own, interrupted while its threads are in compiled code."""
    scene = tmp_path / "endless_scene.py"
    scene.write_text(
        "from distal.lang import Frame, image, vec4\n"
        "@image\n"
        "def picture(frame: Frame) -> vec4:\n"
        "    x = frame.coord.x\n"
        "    while x > 0.0:\n"
        "        x = x * 0.5 + 1.0\n"
        "    return vec4(x)\n"
    )
    program = (
        # A shell's background job hands on that ctrl-C is ignored.
        "import signal, sys\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        f"sys.path.insert(0, {str(tmp_path)!r})\n"
        "from endless_scene import picture\n"
        "from distal.devices import cpu\n"
        "from distal.devices.cache import Cache\n"
        "from distal.frontend import lower\n"
        "kernel = cpu.prepare(lower(picture), cache=Cache(None))\n"
        "try:\n"
        "    print('ready', flush=True)\n"
        "    kernel.render(640, 480, {'resolution': (640.0, 480.0)}, {})\n"
        "except KeyboardInterrupt:\n"
        "    print('interrupted', flush=True)\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        try:
            rest, _ = process.communicate(timeout=60)
        finally:
            process.kill()
        assert rest == "interrupted\n"
