"""The name of machine code: nothing that the code depends on is left out of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from distal.devices import cpu, kernel_key, levels
from distal.devices.cache import Cache
from distal.devices.features import FEATURES_VARIABLE, LEVELS, host_levels
from distal.devices.kernel_key import kernel_key as key_of
from distal.frontend import lower
from distal.lang import Frame, image, vec4

HERE = [level.name for level in host_levels()]


@image
def slope(frame: Frame) -> vec4:
    """Something that differs from pixel to pixel."""
    return vec4(frame.coord.x * 0.01, frame.coord.y * 0.02, 0.5, 1.0)


@image
def other(frame: Frame) -> vec4:
    """The same but for one number."""
    return vec4(frame.coord.x * 0.01, frame.coord.y * 0.03, 0.5, 1.0)


def test_each_level_of_this_machine_has_a_kernel_of_its_own(tmp_path: Path) -> None:
    cache, module = Cache(tmp_path), lower(slope)
    pictures = []
    for again in (False, True):
        for name in HERE:
            for precision in (32, 64):
                kernel = cpu.prepare(module, features=name, precision=precision, cache=cache)
                assert kernel.stats["cache_hit"] is again, (name, precision)
                assert kernel.stats["level"] == name
                pictures.append(kernel.render(9, 7, {}, {}).copy())
    assert cache.size()[0] == 2 * len(HERE)
    assert all(np.allclose(picture, pictures[0], atol=1e-6) for picture in pictures)


def test_each_level_has_machine_code_of_its_own_for_the_levels_of_a_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DISTAL_CACHE_DIR", str(tmp_path))
    for name in HERE:
        monkeypatch.setenv(FEATURES_VARIABLE, name)
        levels._code.cache_clear()
        assert levels.levels(np.array([0.5], np.float32), 8) is not None
    levels._code.cache_clear()
    assert Cache(tmp_path).size()[0] == len(HERE)


def test_everything_that_code_depends_on_names_it(monkeypatch: pytest.MonkeyPatch) -> None:
    level = LEVELS[0]
    keys = [key_of(each, bits, "text") for each in LEVELS for bits in (32, 64)]
    keys += [key_of(replace(level, chunks=2), 32, "text"), key_of(level, 32, "other")]
    keys += [key_of(level, 32, "te", "xt")]
    with monkeypatch.context() as changed:
        changed.setattr(kernel_key, "__version__", "0.0.0")
        keys.append(key_of(level, 32, "text"))
    for name in ("compiler_sources", "llvm_fingerprint"):
        with monkeypatch.context() as changed:
            changed.setattr(kernel_key, name, lambda: "another")
            keys.append(key_of(level, 32, "text"))
    with monkeypatch.context() as changed:
        changed.setattr(kernel_key.sys, "platform", "another")
        keys.append(key_of(level, 32, "text"))
    assert len(set(keys)) == len(keys)
    assert key_of(level, 32, "text") == keys[0]


def test_llvm_is_told_apart_by_its_version() -> None:
    version, *libraries = kernel_key.llvm_fingerprint()
    assert isinstance(version, str)
    assert "version" in version
    assert libraries


def test_swapped_kernels_show_no_picture_of_each_other(tmp_path: Path) -> None:
    cache = Cache(tmp_path)
    right = [cpu.prepare(lower(f), cache=cache).render(9, 7, {}, {}).copy() for f in (slope, other)]
    assert not np.array_equal(*right)
    first, second = sorted(tmp_path.iterdir())
    held = first.read_bytes()
    first.write_bytes(second.read_bytes())
    second.write_bytes(held)
    for function, picture in zip((slope, other), right, strict=True):
        kernel = cpu.prepare(lower(function), cache=cache)
        assert not kernel.stats["cache_hit"]
        assert np.array_equal(kernel.render(9, 7, {}, {}), picture)
