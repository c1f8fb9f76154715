"""The name of machine code: nothing that the code depends on is left out of it."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

import distal
from distal.compiler import driver
from distal.devices import cpu, kernel_key, levels, object_files
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
    assert cache.size()[0] == 2 * 2 * len(HERE)  # a row with the interface, and an object file
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
    files = sorted(tmp_path.iterdir())
    assert len(files) == 4
    for first, second in combinations(files, 2):
        data = first.read_bytes()
        first.write_bytes(second.read_bytes())
        second.write_bytes(data)
        kernels = [cpu.prepare(lower(function), cache=cache) for function in (slope, other)]
        assert not all(kernel.stats["cache_hit"] for kernel in kernels)
        for kernel, picture in zip(kernels, right, strict=True):
            assert np.array_equal(kernel.render(9, 7, {}, {}), picture)


def test_a_changed_compiler_that_writes_the_same_text_reuses_its_object(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cache = Cache(tmp_path)
    monkeypatch.setenv("DISTAL_LLVM_LEVEL", "2")
    cpu.prepare(lower(slope), cache=cache)
    monkeypatch.setattr(kernel_key, "compiler_sources", lambda: "another")
    monkeypatch.setattr(object_files, "compile_objects", None)  # is not called
    kernel = cpu.prepare(lower(slope), cache=cache)
    assert not kernel.stats["cache_hit"]
    assert kernel.render(9, 7, {}, {}).shape == (7, 9, 4)


def test_another_checkout_has_the_same_fingerprint(tmp_path: Path) -> None:
    package = Path(kernel_key.__file__).parent.parent
    files = [str(f) for name in ("ir", "tape") for f in sorted((package / name).glob("*.py"))]
    copies = []
    for file in files:
        copy = tmp_path / Path(file).relative_to(package)
        copy.parent.mkdir(exist_ok=True)
        copy.write_bytes(Path(file).read_bytes())
        copies.append(str(copy))
    here = kernel_key.contents_of(package, files)
    assert kernel_key.contents_of(tmp_path, copies) == here
    with open(copies[0], "a", encoding="utf-8") as file:
        file.write("#")
    assert kernel_key.contents_of(tmp_path, copies) != here
    Path(copies[1]).rename(copies[1] + ".py")
    copies[1] += ".py"
    assert kernel_key.contents_of(tmp_path, copies) != here


def test_another_environment_with_the_same_llvm_has_the_same_fingerprint(tmp_path: Path) -> None:
    package, file = tmp_path / "llvmlite", "llvmlite/binding/libllvmlite.so"
    record = tmp_path / "llvmlite-1.0.dist-info/RECORD"
    record.parent.mkdir()
    record.write_text(f"llvmlite/__init__.py,sha256=abc,5\n{file},sha256=xyz,12\n")
    assert kernel_key._recorded(package, file, 12) == "sha256=xyz"
    assert kernel_key._recorded(package, file, 13) == ""  # another library than the wheel's
    assert kernel_key._recorded(package, "llvmlite/other.so", 12) == ""


def test_the_limit_of_the_cache_can_be_set(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("DISTAL_CACHE_MIB", "3")
    assert Cache(tmp_path).limit == 3 * 2**20
    monkeypatch.setenv("DISTAL_CACHE_MIB", "much")
    with pytest.raises(ValueError, match="DISTAL_CACHE_MIB is a whole number of MiB: 'much'"):
        Cache(tmp_path)
    monkeypatch.delenv("DISTAL_CACHE_MIB")
    assert Cache(tmp_path).limit == 256 * 2**20


def test_the_level_of_code_generation_can_be_set(monkeypatch: pytest.MonkeyPatch) -> None:
    level, keys = LEVELS[0], []
    for chosen in (0, 2):
        monkeypatch.setenv("DISTAL_LLVM_LEVEL", str(chosen))
        assert kernel_key.optimization() == chosen
        keys += [key_of(level, 32, "text"), kernel_key.object_key(level, "text", chosen)]
    assert len(set(keys)) == 4
    monkeypatch.delenv("DISTAL_LLVM_LEVEL")
    assert key_of(level, 32, "text") == keys[2]
    monkeypatch.setenv("DISTAL_LLVM_LEVEL", "fast")
    message = "DISTAL_LLVM_LEVEL is a level of LLVM's code generation, 0 to 3: 'fast'"
    with pytest.raises(ValueError, match=message):
        kernel_key.optimization()


def test_a_text_is_kept_for_other_processes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DISTAL_CACHE_DIR", str(tmp_path))
    made = distal.compile(slope)
    monkeypatch.setattr(driver, "run_passes", None)  # is not called again
    found = distal.compile(slope)
    assert found == made
    assert found.lines == made.lines
    assert {line[0] for line in found.lines if line is not None} == {__file__}
    with pytest.raises(TypeError):
        distal.compile(other)
