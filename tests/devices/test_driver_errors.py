"""The GPU device has careful functions where its driver's own are rough, and only there."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from distal.devices import driver_errors, gpu
from distal.devices.adapters import chosen, opened
from distal.devices.base import DeviceError
from distal.frontend import lower
from distal.lang import acos, asin, func, sin, vec3
from tests.gpu import GpuUnavailableError, device

PAGE = Path(__file__).parents[2] / "web/src/trust.ts"


@pytest.fixture(scope="module")
def adapter():
    try:
        device()
        return chosen(None)
    except (GpuUnavailableError, DeviceError) as error:
        pytest.skip(str(error))


def driver(**errors: float):
    """One whose functions are exact but for these errors."""

    def run(module, points):
        which, x = (np.asarray(p, np.float64) for p in points)
        names = [driver_errors.NAMES[int(i)] for i in which]
        values = [getattr(math, n)(a) + errors.get(n, 0.0) for n, a in zip(names, x, strict=True)]
        return np.array(values, np.float32)

    return run


@pytest.mark.parametrize("name", driver_errors.NAMES)
@pytest.mark.parametrize("error", [2e-5, -2e-5, math.nan])
def test_what_is_off_is_rough(name: str, error: float) -> None:
    found = driver_errors.rough_names(driver(**{name: error}))
    assert found == {name}


def test_what_is_good_is_not() -> None:
    assert driver_errors.rough_names(driver(**dict.fromkeys(driver_errors.NAMES, 5e-6))) == set()


def test_a_page_measures_alike() -> None:
    text = PAGE.read_text()
    names = re.search(r"NAMES = \[(.*?)\]", text)
    assert names is not None
    assert tuple(re.findall(r'"(\w+)"', names[1])) == driver_errors.NAMES
    numbers = dict(re.findall(r"^const (COUNT|STEP|MOST) = (.*);$", text, re.MULTILINE))
    assert {name: eval(number) for name, number in numbers.items()} == {
        "COUNT": driver_errors.COUNT,
        "STEP": driver_errors.STEP,
        "MOST": driver_errors.MOST,
    }


@func
def arcs(x: float) -> vec3:
    return vec3(asin(x), acos(x), sin(40.0 * x))


def test_arcs_on_this_driver_are_as_exact_as_ours(adapter) -> None:
    """Mesa's arc sine is off by 3.9e-4."""
    x = np.linspace(-1.0, 1.0, 401).astype(np.float32)
    found = np.asarray(gpu.prepare(lower(arcs)).evaluate([x], {}, {}))
    wide = x.astype(np.float64)
    wanted = np.stack([np.arcsin(wide), np.arccos(wide), np.sin(40.0 * wide)], axis=1)
    assert np.max(np.abs(found - wanted)) < driver_errors.MOST


def test_only_what_is_rough_is_replaced(adapter, monkeypatch) -> None:
    """And nothing is measured for a program without such functions."""
    measured = driver_errors.measured_errors(
        lambda module, points: gpu._drivers_own(adapter, module, points)
    )
    rough = {name for name, error in measured.items() if not error <= driver_errors.MOST}
    assert gpu._rough_names(adapter) == rough
    text = gpu.prepare(lower(arcs))._artifact.text
    assert ("fn arc_sine(" in text) == ("asin" in rough)
    assert ("fn sine(" in text) == ("sin" in rough)
    monkeypatch.delitem(gpu._ROUGH, opened(adapter))
    monkeypatch.setattr(gpu, "rough_names", lambda run: pytest.fail("measured"))
    gpu.prepare(lower(plain))


@func
def plain(x: float) -> float:
    return x * x
