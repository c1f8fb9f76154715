"""Examine what this machine can do for distal, and how to install what is missing.

Input: the machine. Output: a list of ``MachineFact``. Nothing here raises: an error becomes a fact.
Does not depend on how the facts are shown.
"""

from __future__ import annotations

import ctypes.util
import importlib.metadata
import importlib.util
import os
import platform
import shutil
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Final

from distal.diagnostics import LONGEST_MESSAGE, printable
from distal.packages import PACKAGES
from distal.version import __version__


class State(Enum):
    """Whether something works."""

    READY = "ready"
    OPTIONAL = "optional"  # missing, and only some features need it
    BROKEN = "broken"  # missing or faulty, and rendering needs it


@dataclass(frozen=True, slots=True)
class MachineFact:
    """One fact about the machine.

    Attributes:
        area: The heading under which it is listed.
        subject: The thing that was examined.
        state: Whether it works.
        detail: The result.
        remedy: The command or setting that repairs it, or "".
    """

    area: str
    subject: str
    state: State
    detail: str
    remedy: str = ""

    def __post_init__(self) -> None:
        for field in ("subject", "detail", "remedy"):
            object.__setattr__(self, field, printable(getattr(self, field), LONGEST_MESSAGE))


_PROBE: Final = "doctor-probe"
_LOADING_S: Final = 60
_MARK: Final = "distal-doctor "
_TRY: Final = f"""
import sys
from distal.packages import imported
for module in sys.argv[1:]:
    fault = ""
    try:
        imported(module)
        if module == "llvmlite":
            from distal.devices.jit import llvm_binding
            llvm_binding()
    except Exception as error:
        fault = str(error) or type(error).__name__
    print({_MARK!r} + " ".join(fault.split()), flush=True)
"""


def examine() -> list[MachineFact]:
    """Examine everything; takes a few seconds if a GPU driver has to start."""
    return [
        finding
        for look in (_python, _cpu, _cache, _packages, _gpu, _system)
        for finding in _safely(look)
    ]


def _safely(look: Callable[[], Iterator[MachineFact]]) -> Iterator[MachineFact]:
    try:
        yield from look()
    except Exception as error:  # any error of a broken installation becomes a fact
        area = look.__name__.strip("_")
        yield MachineFact(area, "examination", State.BROKEN, f"{type(error).__name__}: {error}")


def _python() -> Iterator[MachineFact]:
    version = platform.python_version()
    supported = sys.version_info >= (3, 11)
    yield MachineFact(
        "python",
        platform.python_implementation(),
        State.READY if supported else State.BROKEN,
        version,
        "" if supported else "install Python 3.11 or newer",
    )
    yield MachineFact(
        "python", "distal", State.READY, f"{__version__} in {Path(__file__).parents[1]}"
    )
    yield MachineFact("python", "system", State.READY, platform.platform())


def _cpu() -> Iterator[MachineFact]:
    yield MachineFact("cpu", "model", State.READY, _cpu_model())
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    yield MachineFact("cpu", "threads", State.READY, f"{usable} usable of {os.cpu_count()}")
    from distal.devices.features import FEATURES_VARIABLE, chosen_level, host_levels

    possible = ", ".join(level.name for level in host_levels())
    try:
        level = chosen_level()
    except ValueError as error:  # an old processor, or a level that the processor lacks
        remedy = f"unset {FEATURES_VARIABLE}" if FEATURES_VARIABLE in os.environ else ""
        yield MachineFact("cpu", "feature level", State.BROKEN, str(error), remedy)
    else:
        detail = f"{level.name} of {possible}; {level.lanes(32).count} lanes"
        yield MachineFact("cpu", "feature level", State.READY, detail)


def _cpu_model() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    named = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(named, platform.machine())


def _cache() -> Iterator[MachineFact]:
    """Test the kernel cache by storing something, because many things can prevent that."""
    from distal.devices.cache import FOLDER_VARIABLE, Cache, default_folder

    folder = default_folder()
    if folder is None:
        detail = "off: every start compiles again"
        yield MachineFact("cache", "folder", State.OPTIONAL, detail, f"unset {FOLDER_VARIABLE}")
        return
    if not folder.exists():
        yield MachineFact("cache", "folder", State.READY, f"{folder} (the first render makes it)")
        return
    cache = Cache(folder)
    with warnings.catch_warnings(record=True) as complaints:
        warnings.simplefilter("always")
        kernels, size = cache.size()
        usable = cache.store(_PROBE, b"probe") and cache.load(_PROBE) == b"probe"
    cache.discard(_PROBE)
    if usable:
        detail = f"{folder}: {kernels} kernels, {size / 2**20:.1f} MiB"
        yield MachineFact("cache", "folder", State.READY, detail)
    else:
        reason = str(complaints[0].message) if complaints else f"{folder} cannot be written"
        remedy = f"chmod go-w '{folder}', or set {FOLDER_VARIABLE} to a folder of your own"
        yield MachineFact("cache", "folder", State.OPTIONAL, reason, remedy)


def _packages() -> Iterator[MachineFact]:
    """Yield what is installed, and which of it cannot be loaded."""
    faults = _faults([package.imported_as for package in PACKAGES])
    for package in PACKAGES:
        fault = faults.get(package.imported_as, "")
        area = f"packages [{package.extra}]" if package.extra else "packages"
        try:
            version = importlib.metadata.version(package.name)
        except importlib.metadata.PackageNotFoundError:
            state = State.OPTIONAL if package.extra else State.BROKEN
            detail = f"missing ({package.purpose})"
            yield MachineFact(area, package.name, state, detail, package.remedy)
        else:
            if not fault:
                yield MachineFact(area, package.name, State.READY, version)
                continue
            state = State.OPTIONAL if package.extra else State.BROKEN
            what, _, remedy = fault.rpartition("; ")
            yield MachineFact(area, package.name, state, f"{version}: {what or fault}", remedy)


def _faults(modules: list[str]) -> dict[str, str]:
    """Import modules in a subprocess, which an import may crash; return the error of each."""
    path = os.pathsep.join(filter(None, sys.path))
    found: dict[str, str] = {}
    while len(found) < len(modules):
        try:
            tried = subprocess.run(
                [sys.executable, "-P", "-c", _TRY, *modules[len(found) :]],
                capture_output=True,
                text=True,
                timeout=_LOADING_S,
                stdin=subprocess.DEVNULL,
                env={**os.environ, "PYTHONPATH": path},
            )
            answer, end = tried.stdout, f"ends the process that imports it ({tried.returncode})"
        except subprocess.TimeoutExpired as error:
            answer, end = _text(error.stdout), f"does not load within {_LOADING_S} s"
        except OSError as error:
            return {module: f"cannot be tried: {error}" for module in modules}
        lines = [line for line in answer.splitlines() if line.startswith(_MARK)]
        for line in lines:
            found[modules[len(found)]] = line.removeprefix(_MARK)
        if len(found) < len(modules):
            found[modules[len(found)]] = end
    return found


def _text(output: str | bytes | None) -> str:
    return output.decode("utf-8", "replace") if isinstance(output, bytes) else output or ""


def _gpu() -> Iterator[MachineFact]:
    """Yield the adapters with their numbers for ``--adapter``, and the choice of "auto"."""
    if importlib.util.find_spec("wgpu") is None:
        return
    from distal.devices import adapters

    found, complaint = adapters.listed_in_subprocess()
    best = adapters.hardware()
    for row in found:
        facts = (row.kind, row.backend, row.driver, "taken by auto" if row == best else "")
        detail = ", ".join(filter(None, facts))
        yield MachineFact("gpu", f"{row.number}: {row.name}", State.READY, detail)
    remedy = "install the GPU's driver"
    if not found:
        remedy += ", or in software: apt-get install mesa-vulkan-drivers"
        yield MachineFact("gpu", "adapters", State.OPTIONAL, complaint or "none", remedy)
    elif best is None:
        reason = adapters.resolve("auto").reason
        yield MachineFact("gpu", "auto", State.OPTIONAL, f"takes the CPU; {reason}", remedy)


def _system() -> Iterator[MachineFact]:
    for library, package in (("EGL", "libegl1"), ("GL", "libgl1"), ("vulkan", "libvulkan1")):
        found = ctypes.util.find_library(library)
        yield MachineFact(
            "system",
            f"lib{library}",
            State.READY if found else State.OPTIONAL,
            found or "missing (GPU work, tests)",
            "" if found else f"apt-get install {package}",
        )
    validator = shutil.which("glslangValidator")
    yield MachineFact(
        "system",
        "glslangValidator",
        State.READY if validator else State.OPTIONAL,
        validator or "missing (tests)",
        "" if validator else "apt-get install glslang-tools",
    )
