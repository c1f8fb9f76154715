"""A package that is missing or broken is one line, in whatever way it is broken."""

import subprocess
import sys

import numpy as np
import pytest

from distal.cli import doctor
from distal.devices import adapters, jit, levels, threads
from distal.diagnostics import DeviceError
from distal.packages import PACKAGES, PackageError, explained, imported

FAILURES = {
    "ImportError": "raise ImportError('libx.so.1: cannot open shared object\\nmore')",
    "OSError": "raise OSError('cannot load library libx')",
    "RuntimeError": "raise RuntimeError('\\x1b[2J of another build')",
    "AttributeError": "raise AttributeError('no attribute')",
    "ModuleNotFoundError": "import a_dependency_that_is_missing",
    "SystemError": "raise SystemError('initialization failed')",
    "AssertionError": "assert False",
    "SyntaxError": "def (",
}


pytest.importorskip("wgpu")  # not for the first time in place of a broken one


@pytest.fixture
def broken(tmp_path, monkeypatch):
    """Put a package of a given text in the place of the real one."""

    replaced = []

    def loaded():
        return [name for name in sys.modules if name.partition(".")[0] in replaced]

    def put(module, text):
        folder = tmp_path / module
        folder.mkdir()
        (folder / "__init__.py").write_text(text)
        monkeypatch.syspath_prepend(tmp_path)
        replaced.append(module)
        for name in loaded():
            monkeypatch.delitem(sys.modules, name)

    yield put
    for name in loaded():  # the broken one; that from before comes back after this
        del sys.modules[name]


@pytest.mark.parametrize("kind", FAILURES)
def test_every_way_to_fail_is_one_line_with_the_repair(broken, kind):
    broken("anywidget", FAILURES[kind])
    with pytest.raises(PackageError) as caught:
        imported("anywidget")
    text = str(caught.value)
    assert text.startswith(f"anywidget cannot be loaded: {kind}")
    assert text.endswith("; pip install --force-reinstall anywidget")
    assert text.isprintable()
    assert not caught.value.is_missing
    with pytest.raises(Exception) as plain:
        import anywidget  # noqa: F401, PLC0415 (as a module of ours does)
    assert str(explained(plain.value)) == text


def test_missing_package_and_its_extra(monkeypatch):
    for package in PACKAGES:
        monkeypatch.setitem(sys.modules, package.imported_as, None)
        with pytest.raises(PackageError) as caught:
            imported(package.imported_as)
        assert str(caught.value) == f"{package.name} is missing: {package.remedy}"
        assert caught.value.is_missing


def test_half_a_package_and_what_is_no_packages_fault(broken):
    broken("av", "")
    import av  # noqa: PLC0415 (the empty one)

    with pytest.raises(AttributeError) as caught:
        av.VideoFrame  # noqa: B018
    assert "av cannot be loaded: AttributeError" in str(explained(caught.value))
    for fault in (ValueError("a"), AttributeError("b"), ImportError("c", name="distal.x")):
        assert explained(fault) is None


def test_lack_of_memory_is_said_as_such(broken):
    broken("av", "raise OSError('libx.so: failed to map segment from shared object')")
    with pytest.raises(MemoryError, match="av cannot be loaded"):
        imported("av")


@pytest.mark.parametrize("text", ["", "raise OSError('no libx')", "import missing_dependency"])
def test_broken_wgpu_is_a_device_that_is_missing(broken, text):
    broken("wgpu", text)
    with pytest.raises(DeviceError, match=r"^wgpu cannot be loaded: .*; or --device cpu$"):
        adapters.wgpu_module()


class OddAdapter:
    """An adapter whose every use fails as a binding of another version does."""

    features, limits = (), {}

    def request_device_sync(self, **_):
        """Fail."""
        raise TypeError("an option\nis unknown")


def test_device_that_cannot_be_opened_is_one_line():
    row = adapters.Adapter(0, "Odd", "DiscreteGPU", "Vulkan")
    with pytest.raises(DeviceError, match=r"^Odd cannot be used: an option: is unknown$"):
        adapters.Gpu(row, OddAdapter())


def test_listing_that_fails_is_one_line(broken):
    broken(
        "wgpu",
        "class GPUError(Exception): ...\nclass GPUOutOfMemoryError(GPUError): ...\n"
        "class gpu:\n    def enumerate_adapters_sync():\n        raise AttributeError('no lib')\n",
    )
    adapters._handles.cache_clear()
    try:
        with pytest.raises(DeviceError, match=r"^wgpu cannot list the GPUs: no lib; or --device"):
            adapters.adapters()
    finally:
        adapters._handles.cache_clear()


def test_levels_of_a_picture_need_no_llvm(broken, monkeypatch):
    broken("llvmlite", "raise OSError('no libllvmlite')")
    monkeypatch.setenv("DISTAL_CACHE_DIR", "off")
    jit.llvm_binding.cache_clear()
    levels._code.cache_clear()
    try:
        assert levels.levels(np.zeros(3, np.float32), 8) is None
        with pytest.raises(PackageError, match="llvmlite cannot be loaded"):
            jit.llvm_binding()
    finally:
        jit.llvm_binding.cache_clear()
        levels._code.cache_clear()


@pytest.mark.parametrize("allowed", [1, 0])
def test_fewer_threads_than_wanted_do_the_work(monkeypatch, allowed):
    real, begun, calls = threads.threading.Thread.start, [], []

    def start(thread):
        if len(begun) == allowed:
            raise RuntimeError("can't start new thread")
        begun.append(thread)
        real(thread)

    monkeypatch.setattr(threads.threading.Thread, "start", start)
    work = threads.Work(np.zeros(1, np.int32), np.zeros(1, np.int32), 8)
    if allowed:
        assert threads.run(work, lambda: calls.append(1), 4, None, None) == 1
        assert calls == [1]
    else:
        with pytest.raises(MemoryError, match="starts no thread"):
            threads.run(work, lambda: calls.append(1), 4, None, None)


LIMITED = """
import resource, sys
sys.argv[1:] = ["render", "example:raymarcher", "-o", "a.png", "--size", "8x8"]
resource.setrlimit(resource.RLIMIT_AS, ({kilobytes} * 1024,) * 2)
from distal.cli import main
main()
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits are Linux's")
@pytest.mark.parametrize("kilobytes", [90_000, 230_000, 340_000])
def test_limit_of_memory_is_one_line_or_a_picture(tmp_path, monkeypatch, kilobytes):
    monkeypatch.setenv("DISTAL_CACHE_DIR", "off")
    code = LIMITED.format(kilobytes=kilobytes)
    made = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=120
    )
    if made.returncode == 0:
        assert (tmp_path / "a.png").exists()
    else:
        assert made.returncode == 1
        assert made.stderr.startswith("error: not enough memory: ")
        assert made.stderr.count("\n") == 1


def test_doctor_finds_what_cannot_be_loaded(broken, tmp_path):
    broken("av", "raise OSError('no libx')")
    (tmp_path / "glfw.py").write_text("import os\nos._exit(9)\n")
    found = doctor._faults(["av", "glfw", "rich"])
    assert found["av"].startswith("av cannot be loaded: OSError: no libx; ")
    assert "ends the process" in found["glfw"]
    assert found["rich"] == ""
