"""Packages of others: which there are, and how one that is missing or broken is reported.

Input: an import, or an error that one raised. Output: the module, or a
``PackageError`` of one line with the command that repairs it. An installation can fail in any way:
a native library that is missing, a build for another processor, half an upgrade. Imports nothing
but the standard library.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import PurePath
from types import ModuleType, TracebackType
from typing import Any, Final

from distal.diagnostics import printable


class PackageError(ImportError):
    """A package of others that is missing or cannot be loaded: why, and what repairs it.

    Attributes:
        is_missing: Whether it is not installed at all.
    """

    def __init__(self, message: str, *, is_missing: bool = False) -> None:
        super().__init__(message)
        self.is_missing = is_missing


@dataclass(frozen=True, slots=True)
class Package:
    """A package of the registry.

    Attributes:
        name: What pip calls it.
        extra: The extra of distal that brings it, "" for the core.
        purpose: What needs it.
        module: What Python calls it, where that is another name.
    """

    name: str
    extra: str
    purpose: str
    module: str = ""

    @property
    def imported_as(self) -> str:
        """The name of its module."""
        return self.module or self.name

    @property
    def remedy(self) -> str:
        """The command that installs it."""
        return f"pip install 'distal[{self.extra}]'" if self.extra else f"pip install {self.name}"


PACKAGES: Final = (
    Package("numpy", "", "arrays and the reference"),
    Package("llvmlite", "", "the CPU device"),
    Package("pillow", "", "PNG files", "PIL"),
    Package("typer", "", "this command"),
    Package("rich", "", "this command"),
    Package("wgpu", "gpu", "GPU work"),
    Package("rendercanvas", "gpu", "windows"),
    Package("glfw", "gpu", "windows"),
    Package("av", "video", "video files"),
    Package("OpenEXR", "exr", "EXR files"),
    Package("anywidget", "notebook", "sliders in notebooks"),
    Package("fonttools", "text", "letters of fonts", "fontTools"),
)
_BY_MODULE: Final = {package.imported_as: package for package in PACKAGES}
# What loaders and libraries say where memory is short; the error's class does not.
_NO_MEMORY: Final = ("failed to map segment", "cannot allocate memory", "out of memory")


def imported(module: str) -> Any:
    """A module of a package of the table.

    Raises:
        PackageError: It is missing or cannot be loaded.
        MemoryError: There is not the memory to load it.
    """
    with loading(module.partition(".")[0]):
        return importlib.import_module(module)


@contextmanager
def loading(module: str) -> Iterator[None]:
    """Report whatever is raised while a package gets ready as that package's fault.

    Raises:
        PackageError: It is missing or cannot be loaded.
        MemoryError: There is not the memory to load it.
    """
    try:
        yield
    except PackageError:
        raise
    except Exception as error:
        raise _reported(error, _missing(error) or _BY_MODULE[module]) from error


def explained(error: BaseException) -> PackageError | MemoryError | None:
    """What an error says of a package; None if it is no package's fault.

    That is one which arose while a package was imported, or from a module that lacks a part.
    """
    if isinstance(error, PackageError):
        return error
    if not isinstance(error, Exception):
        return None
    package = _missing(error) or _importing(error.__traceback__)
    if package is None and isinstance(error, SyntaxError):
        package = _of_file(error.filename or "")
    if package is None and isinstance(error, ImportError):
        package = _BY_MODULE.get((error.name or "").partition(".")[0])
    if package is None and isinstance(error, AttributeError) and isinstance(error.obj, ModuleType):
        package = _BY_MODULE.get(error.obj.__name__.partition(".")[0])
    return None if package is None else _reported(error, package)


def raised_in(error: BaseException, module: str) -> bool:
    """Whether an error arose in the code of a package, not in ours."""
    at = error.__traceback__
    if at is None:
        return False
    while at.tb_next is not None:
        at = at.tb_next
    return _top(at) == module


def _missing(error: BaseException) -> Package | None:
    return _BY_MODULE.get(error.name or "") if isinstance(error, ModuleNotFoundError) else None


def _of_file(name: str) -> Package | None:
    """The package that a file belongs to, by the folder that is nearest to it."""
    known = (_BY_MODULE.get(part) for part in reversed(PurePath(name).parts[:-1]))
    return next(filter(None, known), None)


def _importing(at: TracebackType | None) -> Package | None:
    """The package whose modules were being run; of several the innermost."""
    found = None
    while at is not None:
        if at.tb_frame.f_code.co_name == "<module>":
            found = _BY_MODULE.get(_top(at), found)
        at = at.tb_next
    return found


def _top(at: TracebackType) -> str:
    return str(at.tb_frame.f_globals.get("__name__", "")).partition(".")[0]


def _reported(error: Exception, package: Package) -> PackageError | MemoryError:
    if _missing(error) is package:
        return PackageError(f"{package.name} is missing: {package.remedy}", is_missing=True)
    causes = list(_causes(error))
    if any(isinstance(c, MemoryError) or _says_no_memory(c) for c in causes):
        return MemoryError(f"{package.name} cannot be loaded")
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    reason = printable(f"{type(error).__name__}: {lines[0]}" if lines else type(error).__name__)
    repair = f"pip install --force-reinstall {package.name}"
    return PackageError(f"{package.name} cannot be loaded: {reason}; {repair}")


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    """The error, and those it arose from."""
    seen: set[int] = set()
    while error is not None and id(error) not in seen:
        seen.add(id(error))
        yield error
        error = error.__cause__ or error.__context__


def _says_no_memory(error: BaseException) -> bool:
    text = str(error).lower()
    return any(words in text for words in _NO_MEMORY)
