"""Make the cache key of machine code from everything that the code depends on.

Input: the source of the code, and its CPU level. Output: a key for ``Cache``, made without loading
LLVM. All keys are made here, so that no kind of kernel can omit the level, the compiler or the
version.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import sys
from functools import cache
from pathlib import Path
from typing import Final

from distal.devices.features import CpuLevel
from distal.version import __version__

# The packages that turn a module into machine code. The front end is included, because passes link
# functions of the prelude, which the front end lowers.
_COMPILER: Final = (
    *("ir", "passes", "backends/llvm", "devices", "frontend", "lang/prelude"),
    *("backends/base.py", "compiler", "tape"),
)
_VERSION_FILE: Final = "_version.py"
_LIBRARIES: Final = ("libllvmlite.so", "libllvmlite.dylib", "llvmlite.dll")


def kernel_key(level: CpuLevel, precision: int, *compiled: str) -> str:
    """Return the cache key of machine code.

    Args:
        level: The CPU level that it is compiled for.
        precision: Bits of a float or of a result.
        compiled: Texts that identify what is compiled.
    """
    parts = (
        compiled,
        level,
        precision,
        sys.platform,
        __version__,
        compiler_sources(),
        llvm_fingerprint(),
    )
    return hashlib.sha256(repr(parts).encode()).hexdigest()


@cache
def compiler_sources() -> str:
    """Return a fingerprint of the compiler's files: a changed compiler does not use old kernels."""
    root = Path(__file__).parent.parent
    rows: list[tuple[str, int, int]] = []
    for name in _COMPILER:
        for file in _python_files(root / name):
            info = os.stat(file)
            rows.append((os.path.relpath(file, root), info.st_size, info.st_mtime_ns))
    return hashlib.sha256(repr(sorted(rows)).encode()).hexdigest()


def _python_files(place: Path) -> list[str]:
    if place.suffix == ".py":
        return [str(place)]
    return [
        os.path.join(folder, name)
        for folder, _, names in os.walk(place)
        for name in names
        if name.endswith(".py")
    ]


@cache
def llvm_fingerprint() -> tuple[object, ...]:
    """Return a fingerprint of the installed LLVM without loading it: its version and its library.

    Sizes and times alone are not enough: some installers give every file the same time.
    """
    spec = importlib.util.find_spec("llvmlite")
    if spec is None or spec.origin is None:
        return ()
    folder = Path(spec.origin).parent
    found: list[object] = []
    try:
        found.append((folder / _VERSION_FILE).read_text("utf-8", "replace"))
    except OSError:
        found.append(None)
    for library in _LIBRARIES:
        try:
            info = os.stat(folder / "binding" / library)
        except OSError:
            continue
        found.append((library, info.st_size, info.st_mtime_ns))
    return tuple(found)
