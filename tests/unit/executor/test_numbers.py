"""The numbers of a scene: values that a kernel is handed, constants where that is asked for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import distal
from distal.devices.cpu import CpuKernel
from distal.frontend import lower
from distal.ir.printer import print_identity, print_module
from distal.lang import slider
from distal.lang.expressions import time
from distal.lang.render_options import RenderOptions
from distal.runtime.executor import PythonExecutor
from tests.unit.executor.composing import Ball, Display, Ramp

SIZE = (40, 3)


def rendered(executor: PythonExecutor, ramp: Ramp, **options: object) -> np.ndarray:
    return executor.render(ramp, RenderOptions(size=SIZE, **options)).array  # type: ignore[arg-type]


def test_scenes_that_differ_in_numbers_share_a_kernel(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DISTAL_CACHE_DIR", str(tmp_path))
    executor = PythonExecutor()
    first, second = Ramp([1.0, 2.0]), Ramp([3.0, 0.5])
    columns = np.arange(40) + 0.5
    assert np.allclose(rendered(executor, first)[0, :, 0], 3.0 * columns)
    assert np.allclose(rendered(executor, second)[0, :, 0], 3.5 * columns)
    assert np.allclose(rendered(executor, first)[0, :, 0], 3.0 * columns)
    assert len(executor.kernels) == 1
    # The stored kernel is found too, though the numbers are others than when it was made.
    fresh = PythonExecutor().render(Ramp([0.0, 0.25]), RenderOptions(size=SIZE))
    assert fresh.stats["cache_hit"]
    assert np.allclose(fresh.array[0, :, 0], 0.25 * columns)
    # Another count of numbers is another kernel.
    rendered(executor, Ramp([1.0, 2.0, 3.0]))
    assert len(executor.kernels) == 2


def test_the_identity_of_a_module_leaves_numbers_out_and_parameters_in() -> None:
    one, other = lower(Ramp([1.0])), lower(Ramp([2.0]))
    assert print_identity(one) == print_identity(other)
    assert print_module(one) != print_module(other)
    low, high = (lower(Ramp([], slider("Blue", b) * 1)) for b in (0.25, 0.5))
    assert print_identity(low) != print_identity(high)


@pytest.mark.parametrize("device", ["cpu", "reference"])
@pytest.mark.parametrize("freeze", [False, True])
def test_settings_are_for_one_picture(device: str, freeze: bool) -> None:
    executor = PythonExecutor()
    ramp = Ramp([1.0, 2.0])
    options = {"device": device, "freeze": freeze}
    changed = rendered(executor, ramp, settings={"Weight_2": 7}, **options)
    plain = rendered(executor, ramp, **options)
    assert np.allclose(changed[0, :, 0], 8.0 * (np.arange(40) + 0.5))
    assert np.allclose(plain[0, :, 0], 3.0 * (np.arange(40) + 0.5))


def test_frozen_numbers_are_constants() -> None:
    executor = PythonExecutor()
    rendered(executor, Ramp([1.0, 2.0]), freeze=True)
    rendered(executor, Ramp([1.0, 3.0]), freeze=True)
    assert len(executor.kernels) == 2
    for kernel in executor.kernels._kernels.values():
        assert isinstance(kernel, CpuKernel)
        assert [name for name, *_ in kernel._interface["uniforms"]] == []


@pytest.mark.parametrize(
    ("settings", "kind", "message"),
    [
        ({"Depth": 1.0}, ValueError, "there is no number 'Depth' in the scene"),
        ({"Weight": "1"}, TypeError, "'Weight' takes a number"),
        ({"Weight": 1e39}, ValueError, "32-bit"),
    ],
)
def test_mistaken_settings_are_named(
    settings: dict[str, object], kind: type[Exception], message: str
) -> None:
    with pytest.raises(kind, match=message):
        PythonExecutor().render(Ramp([1.0]), RenderOptions(size=SIZE, settings=settings))


def test_time_and_parameters_reach_pictures_and_calls() -> None:
    blue = slider("Time", 0.25) * time  # a parameter that is called like a value of the frame
    executor = PythonExecutor()
    for device in ("cpu", "reference"):
        options = RenderOptions(size=SIZE, time=3.0, params={"Time": 0.5}, device=device)
        picture = executor.render(Ramp([], blue), options)
        assert np.all(picture.array[..., 2] == 1.5)
        assert picture.provenance.parameters == {"time": 0.5}
    ball = Ball(blue)
    points = np.array([[3.0, 4.0, 0.0], [0.0, 0.0, 1.0]])
    found = executor.call(ball, (points,), {}, params={"time": 1.0}, time=2.0)
    assert found.dtype == np.float64
    assert np.allclose(found, [3.0, -1.0])
    assert [p.name for p in executor.parameters(ball)] == ["time"]
    with pytest.raises(ValueError, match="there is no parameter 'size'"):
        executor.call(ball, (points,), {}, params={"size": 1.0})


def test_calls_of_objects_are_checked_like_functions() -> None:
    executor = PythonExecutor()
    ball = Ball(0.5)
    assert executor.call(ball, ((0.0, 3.0, 4.0),), {}) == 4.5
    assert executor.call(ball, (), {"p": np.zeros((2, 3))}).tolist() == [-0.5, -0.5]
    assert executor.call(ball, (np.zeros((0, 3)),), {}).shape == (0,)
    takes = r"ball\(\) does not take \(1.0\); it takes \(p: vec3\) -> float"
    with pytest.raises(TypeError, match=takes):
        executor.call(ball, (1.0,), {})
    with pytest.raises(TypeError, match=r"ball\(\) misses its arguments: p"):
        executor.call(ball, (), {})


def test_objects_are_lowered_once() -> None:
    executor = PythonExecutor()
    ball = Ball(0.5)
    executor.call(ball, (np.zeros((2, 3)),), {})
    first = executor.lower(ball, None)
    assert executor.lower(ball, None) is first


@pytest.mark.parametrize("device", ["cpu", "reference"])
def test_a_display_encodes_what_the_kernel_gives(device: str) -> None:
    executor = PythonExecutor()
    ramp = Ramp([0.01], display=Display())
    assert [p.name for p in executor.parameters(ramp)] == ["gain"]
    for size in ((40, 3), (1, 1), (7, 5), (333, 17)):
        options = RenderOptions(size=size, device=device, params={"gain": 2.0})
        picture = executor.render(ramp, options)
        columns = 0.01 * (np.arange(size[0]) + 0.5)
        assert np.allclose(picture.linear[0, :, 0], columns, rtol=1e-6)
        assert np.allclose(picture.array[0, :, 0], 2.0 * columns + 0.25, rtol=1e-6)
        assert np.allclose(picture.array[..., 1], 2.0 * picture.linear[..., 1] + 0.25, rtol=1e-6)
        assert np.all(picture.array[..., 3] == 1.0)
        assert picture.provenance.parameters == {"gain": 2.0}
    with pytest.raises(ValueError, match="read-only"):
        picture.linear[0, 0, 0] = 1.0


def test_a_thousand_numbers_on_every_target() -> None:
    ramp = Ramp([0.001 * n for n in range(1000)], time * 1)
    executor = PythonExecutor()
    expected = 0.001 * (999 * 500) * (np.arange(40) + 0.5)
    assert np.allclose(rendered(executor, ramp)[0, :, 0], expected, rtol=1e-4)
    for target in ("glsl-es300", "glsl-330", "glsl-es100"):
        artifact = distal.compile(ramp, target)
        # 200 vectors of four; the time takes the place of one number.
        told = {u["name"]: u for u in artifact.interface["uniforms"]}
        assert sum(u["origin"] == "number" for u in told.values()) == 799
        assert told["Weight_2"]["default"] == 0.001
        apart = artifact.interface["constants"]
        assert len(apart) == 201
        assert apart[-1]["name"] == "Weight_1000"
        assert artifact.text.count("const float Weight_") == 201
        assert artifact.text.count("// Numbers beyond what a stage has room for") == 1
    few = distal.compile(Ramp([1.0]), "glsl-es300")
    assert "constants" not in few.interface
    shadertoy = distal.compile(ramp, "shadertoy")
    assert shadertoy.text.count("const float Weight") == 1000
    wgsl = distal.compile(ramp, "wgsl")
    assert sum(u["origin"] == "number" for u in wgsl.interface["uniforms"]) == 1000
