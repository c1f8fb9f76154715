"""Which code a picture's first kernel has: plain, or optimized where the run is long."""

from __future__ import annotations

import pytest

from distal.devices.kernel_key import LEVEL_VARIABLE
from distal.lang import Frame, image, runtime_access, vec4
from distal.runtime.executor import PythonExecutor


@image
def slope(frame: Frame) -> vec4:
    return vec4(frame.coord.x * 0.01, frame.coord.y * 0.02, 0.5, 1.0)


@pytest.mark.parametrize(
    ("size", "samples", "level"),
    [((64, 48), None, 0), ((64, 48), 40, 0), ((64, 48), 50, 2), ((640, 480), None, 2)],
)
def test_long_runs_begin_with_optimized_code(size, samples, level, monkeypatch):
    monkeypatch.delenv(LEVEL_VARIABLE, raising=False)
    monkeypatch.setenv("DISTAL_CACHE_DIR", "off")
    monkeypatch.setattr("distal.devices.threads.usable_threads", lambda: 2)
    monkeypatch.setattr("distal.devices.background.BackgroundWork._start", lambda _: None)
    monkeypatch.setattr("distal.devices.background.BackgroundWork.check", lambda _: None)
    monkeypatch.setitem(runtime_access._EXECUTOR, "", PythonExecutor())
    picture = slope.render(size, samples=samples, device="cpu")
    assert picture.stats["optimization"] == level
