"""Find targets by name; import a target's backend when it is used."""

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
# The modules of all targets, in the order of the help texts.
_BACKENDS: Final = {
    "llvm": "distal.backends.llvm",
    **{name: target.backend for name, target in TEXT_TARGETS.items()},
    "numpy": "distal.backends.numpy.interpreter",
}


def target_names() -> tuple[str, ...]:
    """Return the names of all targets, in the order of the help texts."""
    return tuple(_BACKENDS)


def _backend(name: str) -> Backend:
    return cast(Backend, importlib.import_module(_BACKENDS[name]))


def get_target(name: str) -> Target:
    """Return the capabilities of the target called ``name``.

    Raises:
        KeyError: There is no such target.
    """
    return TEXT_TARGETS.get(name) or _backend(name).TARGET


def emit(module: Module, target: Target) -> Artifact:
    """Return the program of a module, to which the passes for ``target`` have been applied.

    Raises:
        CompileError: The target cannot express the author's code.
    """
    return _backend(target.name).emit(module, target)


__all__ = ["TEXT_TARGETS", "Artifact", "emit", "get_target", "target_names"]
