"""Targets by name. A backend is a module, imported when one of its targets is emitted."""

from __future__ import annotations

import importlib
from typing import Final, cast

from distal.backends.base import Artifact, Backend
from distal.backends.glsl.targets import TARGETS as GLSL_TARGETS
from distal.backends.targets import TextTarget
from distal.backends.wgsl.targets import TARGETS as WGSL_TARGETS
from distal.ir.nodes import Module
from distal.ir.target import Target

TEXT_TARGETS: Final[dict[str, TextTarget]] = {
    target.name: target for target in (*GLSL_TARGETS, *WGSL_TARGETS)
}
# The modules of all targets, in the order that help texts list them.
_BACKENDS: Final = {
    "llvm": "distal.backends.llvm",
    **{name: target.backend for name, target in TEXT_TARGETS.items()},
    "numpy": "distal.backends.numpy.interpreter",
}


def target_names() -> tuple[str, ...]:
    """The names of all targets, in the order that help texts list them."""
    return tuple(_BACKENDS)


def _backend(name: str) -> Backend:
    return cast(Backend, importlib.import_module(_BACKENDS[name]))


def get_target(name: str) -> Target:
    """What the target called ``name`` can do.

    Raises:
        KeyError: There is no such target.
    """
    return TEXT_TARGETS.get(name) or _backend(name).TARGET


def emit(module: Module, target: Target) -> Artifact:
    """Write the program of a module that has been through the passes for ``target``.

    Raises:
        CompileError: The target cannot say what the author wrote.
    """
    return _backend(target.name).emit(module, target)


__all__ = ["TEXT_TARGETS", "Artifact", "emit", "get_target", "target_names"]
