"""List the GPUs of this machine, and open one device for each GPU that is used.

Input: a requested device: "auto", a number or part of a name. Output: an ``Adapter``, and an open
``Gpu``. wgpu is imported only when it is needed. Does not depend on kernels.
"""

from __future__ import annotations

import contextlib
import functools
import importlib
import importlib.util
import json
import logging
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

from distal.diagnostics import LONGEST_MESSAGE, DeviceError, printable
from distal.forking import after_fork, new_lock
from distal.packages import PackageError, loading, raised_in

_ANSWER_TIMEOUT_S: Final = 30  # a driver may compile its internal shaders at its first start
_KINDS: Final = ("DiscreteGPU", "IntegratedGPU", "VirtualGPU", "Unknown", "CPU")
_SOFTWARE: Final = ("llvmpipe", "softpipe", "lavapipe", "swiftshader", "basic render driver")
_LIMITS: Final = (
    "max-buffer-size",
    "max-storage-buffer-binding-size",
    "max-uniform-buffer-binding-size",
    "max-texture-dimension-2d",
    "max-texture-dimension-3d",
    "max-storage-buffers-per-shader-stage",
    "max-sampled-textures-per-shader-stage",
    "max-samplers-per-shader-stage",
    "max-bindings-per-bind-group",
)
_INFO_KEYS: Final = ("device", "adapter_type", "backend_type", "vendor", "description")
_NEEDED: Final = ("gpu", "GPUError", "GPUOutOfMemoryError")
_NO_WGPU: Final = "wgpu is not installed: pip install 'distal[gpu]'"
NO_ADAPTER: Final = (
    "no GPU adapter: install the GPU's driver, or in software: apt-get install"
    " mesa-vulkan-drivers; or --device cpu"
)
# XDG_RUNTIME_DIR for Mesa, which prints a warning without it. It connects to a socket ``wayland-0``
# there: in a temporary folder that would be any user's, who could let it wait for ever.
NO_SOCKETS: Final = os.path.abspath(os.sep)
_QUESTION: Final = """
import json, wgpu
print(json.dumps([dict(a.info) for a in wgpu.gpu.enumerate_adapters_sync()], default=str))
"""


@dataclass(frozen=True, slots=True)
class Adapter:
    """A way to reach a GPU.

    Attributes:
        number: Its index in wgpu's list, which ``--adapter`` takes.
        name: The GPU's own name.
        kind: DiscreteGPU, IntegratedGPU, VirtualGPU, CPU or Unknown.
        backend: Vulkan, Metal, D3D12 or OpenGL.
        driver: The driver's description of itself.
    """

    number: int
    name: str
    kind: str
    backend: str
    driver: str = ""

    @staticmethod
    def of(number: int, info: dict[str, Any]) -> Adapter:
        """Return the adapter with this number, from wgpu's information about it."""
        text = {key: printable(info.get(key) or "") for key in _INFO_KEYS}
        name = text["device"] or text["vendor"] or "a GPU without a name"
        driver = text["description"]
        return Adapter(number, name, text["adapter_type"], text["backend_type"], driver)

    @property
    def is_software(self) -> bool:
        """Whether it renders in software, on the CPU."""
        return self.kind == "CPU" or any(word in self.name.lower() for word in _SOFTWARE)

    @property
    def rank(self) -> tuple[int, int, int]:
        """A sort key, the best adapter first: hardware first, discrete first, OpenGL last."""
        kind = "CPU" if self.is_software else self.kind
        place = _KINDS.index(kind) if kind in _KINDS else _KINDS.index("Unknown")
        return place, int(self.backend.startswith("OpenGL")), self.number

    def __str__(self) -> str:
        return f"{self.number}: {self.name} ({self.backend})"


@dataclass(frozen=True, slots=True)
class Resolved:
    """The device that a request selects.

    Attributes:
        device: The device as ``render`` takes it: never "auto", and without the adapter.
        adapter: The adapter's name; None for the best one, or for a device without adapters.
        reason: Why this device was selected, in words.
    """

    device: str
    adapter: str | None
    reason: str


# Listing


def resolve(device: str) -> Resolved:
    """Return the device that a name selects: "auto" selects a hardware GPU, or else the CPU."""
    if device != "auto":
        name, _, adapter = device.partition(":")
        return Resolved(name, adapter or None, "as requested")
    if _is_forked:
        return Resolved("cpu", None, _FORKED)
    if importlib.util.find_spec("wgpu") is None:
        return Resolved("cpu", None, "wgpu is not installed")
    found, complaint = listed_in_subprocess()
    best = _best_hardware(found)
    if best is not None:
        return Resolved("gpu", best.name, f"{best.name} ({best.backend})")
    if complaint:
        return Resolved("cpu", None, f"no GPU: {complaint}")
    if found:
        names = " and ".join(sorted({row.name.partition(" (")[0] for row in found}))
        return Resolved("cpu", None, f"no GPU: only {names}, in software")
    return Resolved("cpu", None, "no GPU: no driver offers one")


def hardware() -> Adapter | None:
    """Return the best hardware adapter, or None; the listing is shared with ``resolve("auto")``."""
    if importlib.util.find_spec("wgpu") is None:
        return None
    return _best_hardware(listed_in_subprocess()[0])


def _best_hardware(found: Sequence[Adapter]) -> Adapter | None:
    return min((a for a in found if not a.is_software), key=lambda a: a.rank, default=None)


@functools.cache
def listed_in_subprocess() -> tuple[list[Adapter], str]:
    """Return the adapters, listed once in a separate process, and an error message or "".

    With "auto" the user did not request a GPU, so a driver that hangs or crashes must not stop the
    rendering. This costs 0.4 s once per process. For a named adapter, ``adapters`` lists them in
    this process.
    """
    try:
        answer = subprocess.run(
            [sys.executable, "-P", "-c", _QUESTION],
            capture_output=True,
            text=True,
            timeout=_ANSWER_TIMEOUT_S,
            stdin=subprocess.DEVNULL,
            env={"XDG_RUNTIME_DIR": NO_SOCKETS, **os.environ},
        )
    except subprocess.TimeoutExpired:
        return [], f"the driver did not answer within {_ANSWER_TIMEOUT_S} s"
    except OSError as error:
        return [], f"the drivers cannot be listed: {error}"
    if answer.returncode < 0:
        return [], f"the driver crashed when its GPUs were listed (signal {-answer.returncode})"
    if answer.returncode > 0:
        last = answer.stderr.strip().splitlines()[-1:] or [f"exit code {answer.returncode}"]
        return [], printable(last[0])
    try:
        rows = json.loads(answer.stdout.strip().splitlines()[-1])
    except (ValueError, IndexError):
        return [], "the drivers gave no answer"
    return [Adapter.of(i, info) for i, info in enumerate(rows)], ""


def adapters() -> list[Adapter]:
    """Return the adapters, listed in this process.

    Raises:
        DeviceError: wgpu is not installed.
    """
    return [Adapter.of(i, dict(handle.info)) for i, handle in enumerate(_handles())]


def chosen(request: str | None = None) -> Adapter:
    """Return the adapter with a number or with a part of a name; the best one for None or "".

    Raises:
        DeviceError: There is no adapter, or none matches; the message lists the adapters.
    """
    found = adapters()
    if not found:
        raise DeviceError(NO_ADAPTER)
    wanted = (request or "").strip().lower()
    if wanted.isdecimal():
        matching = [a for a in found if a.number == int(wanted)]
    else:
        matching = [a for a in found if wanted in a.name.lower()]
    if not matching:
        known = "; ".join(map(str, found))
        raise DeviceError(f"there is no adapter '{printable(request, 80)}'; adapters: {known}")
    return min(matching, key=lambda a: a.rank)


@functools.cache
def _handles() -> list[Any]:
    wgpu = wgpu_module()
    try:
        with _quiet_mesa():
            return list(wgpu.gpu.enumerate_adapters_sync())
    except RuntimeError:  # wgpu raises it if no driver is installed
        return []
    except Exception as error:
        raise DeviceError(f"wgpu cannot list the GPUs: {_short(error)}; or --device cpu") from error


_FORKED: Final = (
    "a GPU cannot be used in a forked process whose parent has used it: start the process by"
    ' "spawn" or "forkserver", or --device cpu'
)
_is_forked = False  # from a process that has loaded the drivers


def _forked() -> None:
    global _is_forked
    _is_forked |= "wgpu" in sys.modules
    _OPEN.clear()


def require_unforked() -> None:
    """Refuse a GPU in a fork of a process that has used it.

    Raises:
        DeviceError: This process is one.
    """
    if _is_forked:
        raise DeviceError(_FORKED)


def wgpu_module() -> Any:
    """Import wgpu, and keep its warnings off the terminal.

    Raises:
        DeviceError: It is not installed, or cannot be loaded, or this process is a fork of one that
            has used it.
    """
    require_unforked()
    try:
        with loading("wgpu"):
            module = importlib.import_module("wgpu")
            for name in _NEEDED:  # missing in a broken installation
                getattr(module, name)
    except PackageError as error:
        message = _NO_WGPU if error.is_missing else f"{error}; or --device cpu"
        raise DeviceError(message) from error
    # Without a handler Python prints the warnings; an application that configures logging still
    # gets them. wgpu must create the logger first, because it has a special class.
    logger = logging.getLogger("wgpu")
    if not logger.handlers:
        logger.addHandler(logging.NullHandler())
    return module


@contextlib.contextmanager
def _quiet_mesa() -> Iterator[None]:
    """Set XDG_RUNTIME_DIR to a folder, which silences Mesa; then restore it for windows."""
    if "XDG_RUNTIME_DIR" in os.environ:
        yield
        return
    os.environ["XDG_RUNTIME_DIR"] = NO_SOCKETS
    try:
        yield
    finally:
        os.environ.pop("XDG_RUNTIME_DIR", None)


# Opening


class Gpu:
    """An open device.

    Attributes:
        adapter: The GPU.
        wgpu: The package; ``wgpu_module`` takes 30 µs each time.
        device: wgpu's device.
        lock: Held while commands are submitted: a window and a video may share the device.
        is_lost: Whether the device was lost; kernels then open a new one.
        filters_floats: Whether it can filter textures of 32-bit floats.
    """

    def __init__(self, adapter: Adapter, handle: Any) -> None:
        self.adapter = adapter
        self.wgpu = wgpu_module()
        self.lock = new_lock()
        self.is_lost = False
        self.filters_floats = "float32-filterable" in handle.features
        limits = {name: handle.limits[name] for name in _LIMITS if name in handle.limits}
        try:
            with _quiet_mesa():
                self.device = handle.request_device_sync(
                    required_features=["float32-filterable"] if self.filters_floats else [],
                    required_limits=limits,
                )
        except Exception as error:  # of wgpu, its binding or the driver
            raise DeviceError(f"{adapter.name} cannot be used: {_short(error)}") from error

    def limit(self, name: str) -> int:
        """Return one of the device's limits, by wgpu's name."""
        return int(self.device.limits[name])

    @contextlib.contextmanager
    def commands(self, doing: str = "rendering") -> Iterator[Any]:
        """Lock the device and yield it; convert its errors to ``DeviceError``.

        Raises:
            DeviceError: The GPU was lost, has too little memory, or rejects a command.
        """
        with self.lock:
            if self.is_lost:
                raise DeviceError(self._lost(doing))
            try:
                yield self.device
            except self.wgpu.GPUOutOfMemoryError as error:
                raise DeviceError(
                    f"{self.adapter.name} has not enough memory; a smaller picture, or --device cpu"
                ) from error
            except Exception as error:
                is_ours = not isinstance(error, self.wgpu.GPUError | RuntimeError)
                if is_ours and not raised_in(error, "wgpu"):
                    raise
                if _tells_of_loss(error):
                    self.drop()
                    raise DeviceError(self._lost(doing)) from error
                raise DeviceError(f"{self.adapter.name} refuses: {_short(error)}") from error

    def _lost(self, doing: str) -> str:
        return (
            f"the GPU was lost while {doing} ({self.adapter.name}): its driver was reset or"
            " updated, or the work took too long; try again, or --device cpu"
        )

    def drop(self) -> None:
        """Mark this device as lost, so that ``opened`` does not return it again."""
        self.is_lost = True
        with _OPENING:
            for number, gpu in list(_OPEN.items()):
                if gpu is self:
                    del _OPEN[number]


_OPEN: dict[int, Gpu] = {}
after_fork(_forked)
_OPENING = new_lock()


def opened(adapter: Adapter) -> Gpu:
    """Return the open device of an adapter; there is one per process.

    Raises:
        DeviceError: It cannot be opened.
    """
    with _OPENING:
        gpu = _OPEN.get(adapter.number)
        if gpu is None:
            gpu = _OPEN[adapter.number] = Gpu(adapter, _handles()[adapter.number])
        return gpu


def _tells_of_loss(error: BaseException) -> bool:
    text = str(error).lower()
    return "device is lost" in text or "device lost" in text or "devicelost" in text


def _short(error: BaseException) -> str:
    """Return wgpu's error message on one line."""
    lines = (line.strip(" :") for line in str(error).splitlines())
    words = ": ".join(
        line for line in lines if line and line not in ("Validation Error", "Caused by")
    )
    return printable(words or type(error).__name__, LONGEST_MESSAGE)
