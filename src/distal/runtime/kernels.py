"""A cache of compiled kernels for the life of the process.

Input: a lowered function, the name of a device, a precision. Output: a ``Kernel``, shared by
functions with equal digests. Does not depend on pictures or values.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Final, TypeAlias

from distal.at_once import AtOnce
from distal.devices.base import Kernel
from distal.devices.kernel_key import optimization
from distal.forking import new_lock
from distal.ir.nodes import Module
from distal.lang.lazy_module import LazyModule
from distal.runtime.device_names import AUTO, CPU, DEVICE_NAMES, GPU, GPU_FRAGMENT, REFERENCE
from distal.runtime.lowered import Lowered

if TYPE_CHECKING:
    from distal.devices import adapters, cpu, gpu, reference
else:
    adapters = LazyModule("distal.devices.adapters")
    cpu = LazyModule("distal.devices.cpu")
    gpu = LazyModule("distal.devices.gpu")
    reference = LazyModule("distal.devices.reference")

KERNELS_KEPT: Final = 128  # limits the memory of a session in which a scene is edited for hours

# Compiles a module for a precision in bits, on a GPU for an adapter, on a CPU for a long first run.
Prepare: TypeAlias = Callable[[Module, int, str | None, bool], Kernel]
DEVICES: Final[Mapping[str, Prepare]] = {
    CPU: lambda module, bits, _, is_long: cpu.prepare(module, precision=bits, is_long=is_long),
    GPU: lambda module, bits, adapter, _: gpu.prepare(
        module, precision=bits, path="compute", adapter=adapter
    ),
    GPU_FRAGMENT: lambda module, bits, adapter, _: gpu.prepare(
        module, precision=bits, path="fragment", adapter=adapter
    ),
    REFERENCE: lambda module, bits, _, __: reference.prepare(module, precision=bits),
}


class KernelCache:
    """The kernels that were used last, by digest of the lowered function, device and precision.

    Scenes that differ only in their numbers share a kernel.
    """

    def __init__(self) -> None:
        self._kernels: dict[tuple[str, str, int, int], Kernel] = {}
        self._at_once = AtOnce()
        self._lock = new_lock()  # never held while a kernel is compiled

    def __len__(self) -> int:
        return len(self._kernels)

    def kernel(
        self, lowered: Lowered, device: str, precision: int, *, is_long: bool = False
    ) -> Kernel:
        """Return the kernel of a function; compile it if it is not in the cache.

        Args:
            lowered: The function.
            device: A name of ``DEVICES``; for a GPU, an adapter may follow after a colon.
            precision: Bits of a float, 32 or 64.
            is_long: Whether the first run takes longer than the compiler; a CPU then has optimized
                code at once.

        Raises:
            ValueError: There is no such device.
            DeviceError: The device is missing.
        """
        name, _, adapter = device.partition(":")
        if name not in DEVICES or (adapter and not name.startswith("gpu")):
            known = ", ".join(DEVICE_NAMES)
            raise ValueError(f"there is no device '{device}'; devices: {known}")
        key = (lowered.digest, device, precision, optimization())

        def found() -> Kernel | None:
            with self._lock:
                kernel = self._kernels.pop(key, None)
                if kernel is not None:
                    self._kernels[key] = kernel  # the most recently used kernel is last
                return kernel

        def made() -> Kernel:
            kernel = DEVICES[name](lowered.module, precision, adapter or None, is_long)
            with self._lock:
                self._kernels[key] = kernel
                while len(self._kernels) > KERNELS_KEPT:
                    self._kernels.pop(next(iter(self._kernels)), None)
            return kernel

        return self._at_once.result(key, found, made)


def automatic_device() -> str:
    """Return the device that "auto" selects on this machine."""
    found = adapters.resolve(AUTO)
    return f"{found.device}:{found.adapter}" if found.adapter else str(found.device)


def is_software(device: str) -> bool:
    """Return whether a device is a GPU's driver that runs on the CPU."""
    name, _, adapter = device.partition(":")
    return name.startswith(GPU) and adapters.chosen(adapter or None).is_software
