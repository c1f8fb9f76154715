"""distal: 3D scenes written as ordinary Python functions, compiled to every target.

The names here are loaded when first used, so that ``import distal`` is quick and the compile path
needs the standard library only.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from distal.executor_hook import (
    set_calculator_loader,
    set_combiner_loader,
    set_executor_loader,
)
from distal.version import __version__

if TYPE_CHECKING:
    from distal.backends.base import Artifact
    from distal.compiler import compile
    from distal.diagnostics import CompileError, LoadError
    from distal.film.picture import Picture
    from distal.loading import gallery, load

_HOMES = {
    "Artifact": "distal.backends.base",
    "CompileError": "distal.diagnostics",
    "LoadError": "distal.diagnostics",
    "Picture": "distal.film.picture",
    "compile": "distal.compiler",
    "gallery": "distal.loading",
    "load": "distal.loading",
}

__all__ = [
    "Artifact",
    "CompileError",
    "LoadError",
    "Picture",
    "__version__",
    "compile",
    "gallery",
    "load",
]


def _executor() -> Any:
    return importlib.import_module("distal.executor").PythonExecutor()


def _calculator() -> Any:
    return importlib.import_module("distal.constant_values").compute


def _combiner() -> Any:
    return importlib.import_module("distal.frontend.python_expressions").combine


set_executor_loader(_executor)
set_calculator_loader(_calculator)
set_combiner_loader(_combiner)


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'distal' has no attribute '{name}'")
    value = getattr(importlib.import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})
