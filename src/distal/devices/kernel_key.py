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
from collections.abc import Sequence
from contextlib import suppress
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
LEVEL_VARIABLE: Final = "DISTAL_LLVM_LEVEL"
_VERSION_FILE: Final = "_version.py"
_LIBRARIES: Final = ("libllvmlite.so", "libllvmlite.dylib", "llvmlite.dll")


def kernel_key(
    level: CpuLevel, precision: int, *compiled: str, llvm_level: int | None = None
) -> str:
    """Return the cache key of machine code.

    Args:
        level: The CPU level that it is compiled for.
        precision: Bits of a float or of a result.
        compiled: Texts that identify what is compiled.
        llvm_level: LLVM's level of code generation; None: ``optimization()``.
    """
    parts = (
        compiled,
        level,
        precision,
        optimization() if llvm_level is None else llvm_level,
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
    return contents_of(root, sorted(f for name in _COMPILER for f in _python_files(root / name)))


def contents_of(root: Path, files: Sequence[str]) -> str:
    """Return a hash of the names and contents of files: the same in another checkout."""
    found = hashlib.sha256()
    for file in files:
        with open(file, "rb") as opened:
            text = opened.read()
        found.update(f"{os.path.relpath(file, root)} {len(text)}\n".encode())
        found.update(text)
    return found.hexdigest()


def _python_files(place: Path) -> list[str]:
    if place.suffix == ".py":
        return [str(place)]
    return [
        os.path.join(folder, name)
        for folder, _, names in os.walk(place)
        for name in names
        if name.endswith(".py")
    ]


def _recorded(package: Path, file: str, size: int) -> str:
    """Return the hash of a package's file from its wheel's record; "" if there is none."""
    for record in package.parent.glob(f"{package.name}-*.dist-info/RECORD"):
        with suppress(OSError):
            for line in record.read_text("utf-8", "replace").splitlines():
                name, _, rest = line.partition(",")
                digest, _, recorded_size = rest.partition(",")
                if name == file and digest and recorded_size == str(size):
                    return digest
    return ""


def object_key(level: CpuLevel, text: str, llvm_level: int) -> str:
    """Return the cache key of an object file: a changed compiler may write the same LLVM text."""
    parts = ("object", text, level, llvm_level, sys.platform, llvm_fingerprint())
    return hashlib.sha256(repr(parts).encode()).hexdigest()


def text_key(target: str, *compiled: str) -> str:
    """Return the cache key of a program's text for a target."""
    parts = ("text", compiled, target, __version__, text_sources())
    return hashlib.sha256(repr(parts).encode()).hexdigest()


@cache
def text_sources() -> str:
    """Return a fingerprint of all files that write texts."""
    root = Path(__file__).parent.parent
    names = (*_COMPILER, "backends")
    return contents_of(root, sorted({f for name in names for f in _python_files(root / name)}))


def optimization() -> int:
    """Return LLVM's level of code generation: 2 unless ``DISTAL_LLVM_LEVEL`` names one.

    Raises:
        ValueError: It is not a level.
    """
    level = os.environ.get(LEVEL_VARIABLE) or "2"
    if level not in ("0", "1", "2", "3"):
        raise ValueError(
            f"{LEVEL_VARIABLE} is a level of LLVM's code generation, 0 to 3: '{level}'"
        )
    return int(level)


def is_level_named() -> bool:
    """Return whether ``DISTAL_LLVM_LEVEL`` names a level."""
    return bool(os.environ.get(LEVEL_VARIABLE))


@cache
def llvm_fingerprint() -> tuple[object, ...]:
    """Return a fingerprint of the installed LLVM without loading it: its version and its library.

    A wheel's record has the library's hash: another environment with the same LLVM has the same
    one. Without a record it is the library's size and time, which alone are not enough: some
    installers give every file the same time.
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
        recorded = _recorded(folder, f"llvmlite/binding/{library}", info.st_size)
        found.append((library, info.st_size, recorded or info.st_mtime_ns))
    return tuple(found)
