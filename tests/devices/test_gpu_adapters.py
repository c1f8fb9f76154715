"""Which adapter is meant, and what is said where there is none. No GPU is needed here."""

from __future__ import annotations

import builtins
import importlib.util
import logging
import os
import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from typing import Any

import pytest

from distal.devices import adapters
from distal.devices.adapters import Adapter, chosen, resolve
from distal.devices.base import DeviceError

LLVMPIPE = Adapter(0, "llvmpipe (LLVM 15.0.6, 256 bits)", "CPU", "Vulkan")
SOFT_GL = Adapter(1, "llvmpipe (LLVM 15.0.6, 256 bits)", "CPU", "OpenGL")
ARC = Adapter(2, "Intel Arc", "IntegratedGPU", "Vulkan")
RTX_GL = Adapter(3, "NVIDIA RTX 4000", "DiscreteGPU", "OpenGL")
RTX = Adapter(4, "NVIDIA RTX 4000", "DiscreteGPU", "Vulkan")
ALL = [LLVMPIPE, SOFT_GL, ARC, RTX_GL, RTX]


@pytest.fixture
def listed_again() -> Iterator[None]:
    adapters.listed_in_subprocess.cache_clear()
    yield
    adapters.listed_in_subprocess.cache_clear()


@pytest.mark.parametrize(
    ("wish", "expected"),
    [
        (None, RTX),
        ("", RTX),
        ("0", LLVMPIPE),
        ("3", RTX_GL),
        ("nvidia", RTX),
        ("ARC", ARC),
        ("llvm", LLVMPIPE),
    ],
)
def test_a_wish_is_a_number_or_part_of_a_name(
    monkeypatch: pytest.MonkeyPatch, wish: str | None, expected: Adapter
) -> None:
    monkeypatch.setattr(adapters, "adapters", lambda: ALL)
    assert chosen(wish) == expected


def test_software_is_the_best_where_there_is_nothing_else(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(adapters, "adapters", lambda: [SOFT_GL, LLVMPIPE])
    assert chosen() == LLVMPIPE


@pytest.mark.parametrize("wish", ["radeon", "9"])
def test_an_unknown_adapter_lists_those_there_are(
    monkeypatch: pytest.MonkeyPatch, wish: str
) -> None:
    monkeypatch.setattr(adapters, "adapters", lambda: [LLVMPIPE, ARC])
    with pytest.raises(DeviceError) as caught:
        chosen(wish)
    assert str(caught.value) == (
        f"there is no adapter '{wish}'; adapters:"
        " 0: llvmpipe (LLVM 15.0.6, 256 bits) (Vulkan); 2: Intel Arc (Vulkan)"
    )


def test_without_an_adapter_the_mend_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(adapters, "adapters", list)
    with pytest.raises(DeviceError) as caught:
        chosen()
    assert str(caught.value) == (
        "no GPU adapter: install the GPU's driver, or in software:"
        " apt-get install mesa-vulkan-drivers; or --device cpu"
    )


@pytest.mark.parametrize(
    ("found", "complaint", "device", "reason"),
    [
        (ALL, "", "gpu", "NVIDIA RTX 4000 (Vulkan)"),
        ([LLVMPIPE, SOFT_GL], "", "cpu", "no GPU: only llvmpipe, in software"),
        ([], "", "cpu", "no GPU: no driver offers one"),
        ([], "the driver crashed", "cpu", "no GPU: the driver crashed"),
    ],
)
def test_auto_is_hardware_or_the_cpu_with_a_reason(
    monkeypatch: pytest.MonkeyPatch, found: list[Adapter], complaint: str, device: str, reason: str
) -> None:
    monkeypatch.setattr(adapters, "listed_in_subprocess", lambda: (found, complaint))
    resolved = resolve("auto")
    assert (resolved.device, resolved.reason) == (device, reason)
    assert resolved.adapter == ("NVIDIA RTX 4000" if device == "gpu" else None)
    assert (adapters.hardware() == RTX) == (device == "gpu")


def test_a_named_device_asks_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(adapters, "listed_in_subprocess", lambda: pytest.fail("asked"))
    assert resolve("gpu-fragment:arc") == adapters.Resolved("gpu-fragment", "arc", "as requested")
    assert resolve("reference").device == "reference"


def test_a_missing_package_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    # What the import system does where a package is not installed.
    monkeypatch.delitem(sys.modules, "wgpu", raising=False)
    real = builtins.__import__

    def missing(name: str, *rest: Any, **more: Any) -> Any:
        if name.partition(".")[0] == "wgpu":
            raise ModuleNotFoundError("No module named 'wgpu'", name="wgpu")
        return real(name, *rest, **more)

    monkeypatch.setattr(adapters.importlib, "import_module", missing)
    with pytest.raises(DeviceError) as caught:
        adapters.wgpu_module()
    assert str(caught.value) == "wgpu is not installed: pip install 'distal[gpu]'"
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert resolve("auto").reason == "wgpu is not installed"


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        (subprocess.CompletedProcess([], -11, "", ""), "crashed when its GPUs were listed"),
        (subprocess.CompletedProcess([], 1, "", "a\nRuntimeError: no driver"), "no driver"),
        (subprocess.CompletedProcess([], 0, "", ""), "the drivers gave no answer"),
    ],
)
def test_a_driver_that_fails_apart_leaves_the_cpu(
    monkeypatch: pytest.MonkeyPatch,
    listed_again: None,
    answer: subprocess.CompletedProcess[str],
    reason: str,
) -> None:
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: answer)
    resolved = resolve("auto")
    assert resolved.device == "cpu"
    assert reason in resolved.reason


def test_the_answer_apart_is_the_answer_here(listed_again: None) -> None:
    pytest.importorskip("wgpu")
    assert adapters.listed_in_subprocess()[0] == adapters.adapters()


def test_nobody_sees_the_drivers_chatter_and_the_environment_stays() -> None:
    pytest.importorskip("wgpu")
    code = (
        "import os; before = dict(os.environ)\n"
        "import distal\n"
        "from distal.devices import adapters\n"
        "from distal.devices.base import DeviceError\n"
        "try:\n"
        "    gpu = adapters.opened(adapters.chosen())\n"
        "except DeviceError:\n"
        "    pass\n"
        "else:\n"
        "    gpu.device.destroy()\n"
        "assert dict(os.environ) == before\n"
    )
    environment = {k: v for k, v in os.environ.items() if k != "XDG_RUNTIME_DIR"}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment, timeout=60
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert logging.getLogger("wgpu").propagate


def test_drivers_connect_to_no_socket_of_another_user(
    listed_again: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Mesa looks for ``wayland-0``: in a folder of all users it would wait for whoever made it."""
    for name in ("XDG_RUNTIME_DIR", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with tempfile.TemporaryDirectory() as folder, socket.socket(socket.AF_UNIX) as server:
        monkeypatch.setenv("TMPDIR", folder)
        monkeypatch.setattr(tempfile, "tempdir", None)
        server.bind(f"{folder}/wayland-0")
        server.listen()
        server.setblocking(False)
        monkeypatch.setattr(adapters, "_ANSWER_TIMEOUT_S", 20.0)
        adapters.listed_in_subprocess()
        with pytest.raises(BlockingIOError):
            server.accept()


@pytest.mark.skipif(os.name == "nt", reason="no such sockets")
def test_the_folder_of_sockets_is_nobodys(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("XDG_RUNTIME_DIR", raising=False)
    with adapters._quiet_mesa():
        folder = os.environ["XDG_RUNTIME_DIR"]
    info = os.stat(folder)
    assert info.st_uid == 0 and not info.st_mode & 0o022
