"""List the third-party packages and report those that are missing or broken.

Input: the name of a module, or an error that an import raised. Output: the module, or a
``PackageError`` whose message is one line with the command that repairs the installation. An
installation can be broken in many ways: a missing native library, a build for another processor,
an incomplete upgrade. Imports only the standard library.
"""

from __future__ import annotations

import importlib
import importlib.util
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import PurePath
from types import ModuleType, TracebackType
from typing import Any, Final, NoReturn

from distal.diagnostics import printable


class PackageError(ImportError):
    """A third-party package is missing or cannot be loaded; the message has the reason and the fix.

    Attributes:
        is_missing: Whether the package is not installed.
    """

    def __init__(self, message: str, *, is_missing: bool = False) -> None:
        super().__init__(message)
        self.is_missing = is_missing


@dataclass(frozen=True, slots=True)
class Package:
    """A third-party package that distal uses.

    Attributes:
        name: Its name for pip.
        extra: The extra of distal that installs it; "" if distal itself installs it.
        purpose: What it is needed for.
        module: Its name in Python, if different from ``name``.
    """

    name: str
    extra: str
    purpose: str
    module: str = ""

    @property
    def imported_as(self) -> str:
        """The name of its Python module."""
        return self.module or self.name

    @property
    def remedy(self) -> str:
        """The command that installs the package."""
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
    Package("pyoidn", "denoise", "removing noise"),
    Package("fonttools", "text", "letters of fonts", "fontTools"),
    Package("uharfbuzz", "text", "letters that join or combine"),
    Package("python-bidi", "text", "text from right to left", "bidi"),
    Package("markdown-it-py", "lessons", "pages of lessons", "markdown_it"),
    Package("pygments", "lessons", "pages of lessons"),
    Package("scipy", "design", "Sobol points"),
    Package("distributed", "cluster", "rendering on more than one machine"),
    Package("cryptography", "cluster", "the keys of --cluster local"),
    Package("websockets", "studio", "the studio in a browser"),
)
_BY_MODULE: Final = {package.imported_as: package for package in PACKAGES}
# Texts of errors that loaders and libraries raise when memory runs out; the class varies.
_NO_MEMORY: Final = ("failed to map segment", "cannot allocate memory", "out of memory")


def imported(module: str) -> Any:
    """Import a module of a package in ``PACKAGES``.

    Raises:
        PackageError: It is missing or cannot be loaded.
        MemoryError: There is not enough memory to load it.
    """
    with loading(module.partition(".")[0]):
        return importlib.import_module(module)


def is_installed(module: str) -> bool:
    """Return whether a package is there, without importing it; it may still be broken."""
    try:
        return importlib.util.find_spec(module) is not None
    except (ImportError, ValueError):
        return False


def missing(module: str) -> str | None:
    """Return the line that says that a package is not installed, and how to install it; or None."""
    if is_installed(module):
        return None
    return str(_reported(ModuleNotFoundError(name=module), _BY_MODULE[module]))


@contextmanager
def loading(module: str) -> Iterator[None]:
    """Convert every error raised in the block into a report about a package.

    Raises:
        PackageError: It is missing or cannot be loaded.
        MemoryError: There is not enough memory to load it.
    """
    try:
        yield
    except PackageError:
        raise
    except Exception as error:
        raise _reported(error, _missing(error) or _BY_MODULE[module]) from error


def explained(error: BaseException) -> PackageError | MemoryError | None:
    """Return the report for an error that a package caused; None for other errors.

    A package caused an error that was raised while it was imported, or because one of its modules
    lacks an attribute.
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


class StandIn:
    """A class or function whose package is missing: using it raises the report about that."""

    def __init__(self, name: str, report: PackageError) -> None:
        self._name = name
        self._report = report

    def __call__(self, *args: Any, **kwargs: Any) -> NoReturn:
        """Raise the report."""
        raise self._report

    def __getattr__(self, attribute: str) -> NoReturn:
        if attribute.startswith("__"):
            raise AttributeError(attribute)
        raise self._report

    def __repr__(self) -> str:
        return f"<{self._name}: {self._report}>"


def stand_in(name: str, error: ModuleNotFoundError) -> StandIn:
    """Return what takes the place of a name whose import failed.

    Raises:
        ModuleNotFoundError: The missing module is of no package in ``PACKAGES``.
    """
    package = _missing(error)
    if package is None:
        raise error
    report = _reported(error, package)
    assert isinstance(report, PackageError)
    return StandIn(name, report)


def raised_in(error: BaseException, module: str) -> bool:
    """Return whether an error was raised in the code of a package, not in distal."""
    at = error.__traceback__
    if at is None:
        return False
    while at.tb_next is not None:
        at = at.tb_next
    return _top(at) == module


def _missing(error: BaseException) -> Package | None:
    return _BY_MODULE.get(error.name or "") if isinstance(error, ModuleNotFoundError) else None


def _of_file(name: str) -> Package | None:
    """Return the package that a file belongs to, by the nearest parent folder with a known name."""
    known = (_BY_MODULE.get(part) for part in reversed(PurePath(name).parts[:-1]))
    return next(filter(None, known), None)


def _importing(at: TracebackType | None) -> Package | None:
    """Return the package that was being imported; if there are several, the innermost."""
    found = None
    while at is not None:
        if at.tb_frame.f_code.co_name == "<module>":
            found = _BY_MODULE.get(_top(at), found)
        at = at.tb_next
    return found


def _top(at: TracebackType) -> str:
    return str(at.tb_frame.f_globals.get("__name__", "")).partition(".")[0]


def not_in_the_playground(name: str, more: str = "") -> PackageError:
    """Return the error of something that the playground's Python lacks.

    Args:
        name: A package, or a module of distal.
        more: What else the author can do.
    """
    fix = f"run the scene on your machine{more}"
    return PackageError(f"{name} is not in the playground: {fix}", is_missing=True)


def _reported(error: Exception, package: Package) -> PackageError | MemoryError:
    if _missing(error) is package:
        if sys.platform == "emscripten":
            name = "NumPy" if package.name == "numpy" else package.name
            return not_in_the_playground(name, ", or write it with math and distal.lang")
        return PackageError(f"{package.name} is missing: {package.remedy}", is_missing=True)
    causes = list(_causes(error))
    if any(isinstance(c, MemoryError) or _says_no_memory(c) for c in causes):
        return MemoryError(f"{package.name} cannot be loaded")
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    reason = printable(f"{type(error).__name__}: {lines[0]}" if lines else type(error).__name__)
    repair = f"pip install --force-reinstall {package.name}"
    return PackageError(f"{package.name} cannot be loaded: {reason}; {repair}")


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    """Yield the error and the errors that caused it."""
    seen: set[int] = set()
    while error is not None and id(error) not in seen:
        seen.add(id(error))
        yield error
        error = error.__cause__ or error.__context__


def _says_no_memory(error: BaseException) -> bool:
    text = str(error).lower()
    return any(words in text for words in _NO_MEMORY)
