"""Machine code for levels gives what NumPy's definition gives, for every kind of value."""

import numpy as np
import pytest

from distal.devices.features import FEATURES_VARIABLE, host_levels
from distal.devices.levels import _code, levels
from distal.images.png import defined_levels

BITS = (8, 16)
ODD = (np.nan, -np.nan, np.inf, -np.inf, -0.0, 0.0, 1.0, 1.0 + 1e-7, -1e-30, 1e-40, 3e38)


@pytest.fixture(params=[level.name for level in host_levels()], autouse=True)
def machine(request, monkeypatch):
    """Every feature level of this machine in turn."""
    monkeypatch.setenv(FEATURES_VARIABLE, request.param)
    _code.cache_clear()
    yield request.param
    _code.cache_clear()


@pytest.mark.parametrize("bits", BITS)
def test_every_tie_and_its_neighbors(bits):
    most = 2**bits - 1
    ties = (np.arange(most, dtype=np.float64) + 0.5) / most
    near = ties.astype(np.float32)
    values = np.concatenate(
        [near, np.nextafter(near, np.float32(0.0)), np.nextafter(near, np.float32(1.0))]
    )
    found = levels(values, bits)
    assert found.dtype == (np.uint8 if bits == 8 else np.uint16)
    assert (found == defined_levels(values, bits)).all()


@pytest.mark.parametrize("bits", BITS)
@pytest.mark.parametrize("count", [0, 1, 15, 16, 17, 31, 32, 33, 1000])
def test_any_count_with_odd_values_anywhere(bits, count):
    values = np.random.default_rng(count).normal(0.5, 0.7, count).astype(np.float32)
    values[: len(ODD)] = ODD[:count]
    values[::-1][: len(ODD)] = ODD[:count]
    assert (levels(values, bits) == defined_levels(values, bits)).all()


def test_pictures_keep_their_shape_and_views_their_order():
    picture = np.random.default_rng(1).random((7, 9, 4), np.float32)
    assert (levels(picture, 8) == defined_levels(picture, 8)).all()
    turned = picture[::-1, ::2, :3]
    assert (levels(turned, 8) == defined_levels(turned, 8)).all()


def test_without_our_code_there_is_numpy(monkeypatch):
    monkeypatch.setenv(FEATURES_VARIABLE, "nonesuch")
    _code.cache_clear()
    assert levels(np.zeros(3, np.float32), 8) is None
