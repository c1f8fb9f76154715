"""Detect the processor's feature level, and the vector shape for it.

Input: the operating system's list of features, or the name of a level. Output: a ``CpuLevel``: the
processor that LLVM compiles for, and the lanes of a kernel. LLVM is asked only where the system
gives no list, so a stored kernel is found without loading LLVM.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import os
import platform
import sys
from dataclasses import dataclass
from functools import cache
from typing import Final

from distal.backends.llvm.lanes import Lanes
from distal.packages import imported

FEATURES_VARIABLE: Final = "DISTAL_CPU"


@dataclass(frozen=True, slots=True)
class CpuLevel:
    """One feature level.

    Attributes:
        name: Its name on the command line and in ``DISTAL_CPU``.
        architecture: ``x86_64`` or ``aarch64``.
        cpu: LLVM's name of the processor to compile for. It is the level's name, not the machine's:
            kernels in the cache run on every processor of the level, and LLVM knows all names.
        width: Floats in one register.
        chunks: Registers that each value occupies; measured with the raymarcher.
        block_width: Width of a block, in pixels.
        needs: The required features, named as in Linux's ``/proc/cpuinfo``.
    """

    name: str
    architecture: str
    cpu: str
    width: int
    chunks: int
    block_width: int
    needs: tuple[str, ...]

    def lanes(self, precision: int) -> Lanes:
        """Return the vector shape for floats of 32 or 64 bits (half as many per register)."""
        if precision == 64:
            return Lanes(self.width // 2, self.chunks, 64, self.block_width // 2, self.name)
        return Lanes(self.width, self.chunks, 32, self.block_width, self.name)


LEVELS: Final = (
    CpuLevel("avx512", "x86_64", "x86-64-v4", 16, 4, 8,
             ("avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl", "avx2", "fma", "bmi2")),
    CpuLevel("avx2", "x86_64", "x86-64-v3", 8, 4, 8,
             ("avx2", "fma", "bmi1", "bmi2", "f16c", "movbe")),
    CpuLevel("sse4.2", "x86_64", "x86-64-v2", 4, 8, 8, ("sse4_2", "ssse3", "popcnt")),
    CpuLevel("neon", "aarch64", "generic", 4, 4, 4, ("asimd",)),
)  # fmt: skip


def level_named(name: str) -> CpuLevel:
    """Return the level with this name.

    Raises:
        ValueError: There is no such level.
    """
    for level in LEVELS:
        if level.name == name:
            return level
    names = ", ".join(level.name for level in LEVELS)
    raise ValueError(f"there is no CPU feature level '{name}'; levels: {names}")


def machine() -> str:
    """Return this machine's architecture: ``x86_64``, ``aarch64`` or another."""
    name = platform.machine().lower()
    return {"amd64": "x86_64", "arm64": "aarch64"}.get(name, name)


@cache
def host_features() -> frozenset[str]:
    """Return the processor's features, named as in Linux; empty if they are not known."""
    if machine() == "aarch64":
        return frozenset({"asimd"})
    if sys.platform.startswith("linux"):
        return _from_cpuinfo() or _from_llvm()  # /proc may not be there
    if sys.platform == "darwin":
        return _from_sysctl()
    return _from_llvm()


def _from_cpuinfo() -> frozenset[str]:
    try:
        with open("/proc/cpuinfo", encoding="ascii", errors="replace") as file:
            text = file.read(16384)  # the first processor's paragraph
    except OSError:
        return frozenset()
    for line in text.splitlines():
        key, _, value = line.partition(":")
        if key.strip() == "flags":
            return frozenset(value.split())
    return frozenset()


def _from_sysctl() -> frozenset[str]:
    library = ctypes.CDLL(ctypes.util.find_library("c"))
    found: set[str] = set()
    for key in (b"machdep.cpu.features", b"machdep.cpu.leaf7_features"):
        size = ctypes.c_size_t(4096)
        buffer = ctypes.create_string_buffer(size.value)
        if library.sysctlbyname(key, buffer, ctypes.byref(size), None, 0) == 0:
            found.update(word.lower().decode() for word in buffer.value.split())
    renamed = {"sse4.2": "sse4_2", "avx1.0": "avx"}
    return frozenset(renamed.get(word, word) for word in found)


def _from_llvm() -> frozenset[str]:
    """Ask the processor itself, by LLVM, which takes 0.1 s to load."""
    try:
        features = imported("llvmlite.binding").get_host_cpu_features()
    except RuntimeError:
        return frozenset()
    renamed = {"sse4.2": "sse4_2", "bmi": "bmi1"}
    return frozenset(renamed.get(name, name) for name, is_there in features.items() if is_there)


@cache
def host_levels() -> tuple[CpuLevel, ...]:
    """Return the levels that this processor can run, the best first."""
    features = host_features()
    here = machine()
    return tuple(
        level for level in LEVELS
        if level.architecture == here and features.issuperset(level.needs)
    )  # fmt: skip


def chosen_level(name: str | None = None) -> CpuLevel:
    """Return the level to compile for: the named one, else that in ``DISTAL_CPU``, else the best.

    Raises:
        ValueError: There is no such level, or this processor cannot run it.
    """
    wanted = name or os.environ.get(FEATURES_VARIABLE) or None
    possible = host_levels()
    if wanted is not None:
        level = level_named(wanted)
        if level not in possible:
            raise ValueError(f"this processor cannot run the feature level '{wanted}'")
        return level
    if not possible:
        raise ValueError(
            f"the CPU device needs an x86-64 processor with SSE 4.2 or a 64-bit ARM one, "
            f"not {machine()}"
        )
    return possible[0]
