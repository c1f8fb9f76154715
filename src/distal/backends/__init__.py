"""Targets by name. Each backend is a module, imported when one of its targets is asked for."""

from __future__ import annotations

import importlib
from typing import Final, cast

from distal.backends.base import Artifact, TextBackend
from distal.ir.nodes import Module
from distal.ir.target import Target

# Target -> the module that has it in its TARGETS.
_BACKENDS: Final = {
    "llvm": "distal.backends.llvm",
    "shadertoy": "distal.backends.glsl.backend",
    "glslcanvas": "distal.backends.glsl.backend",
    "isf": "distal.backends.glsl.backend",
    "glsl-es300": "distal.backends.glsl.backend",
    "glsl-330": "distal.backends.glsl.backend",
    "glsl-es100": "distal.backends.glsl.backend",
    "wgsl": "distal.backends.wgsl.backend",
    "wgsl-compute": "distal.backends.wgsl.backend",
    "numpy": "distal.backends.numpy.interpreter",
}


def target_names() -> tuple[str, ...]:
    """The names of all targets, in the order that help texts list them."""
    return tuple(_BACKENDS)


def _backend(name: str) -> TextBackend:
    return cast(TextBackend, importlib.import_module(_BACKENDS[name]))


def get_target(name: str) -> Target:
    """What the target called ``name`` can do.

    Raises:
        KeyError: There is no such target.
    """
    return next(target for target in _backend(name).TARGETS if target.name == name)


def emit(module: Module, target: Target) -> Artifact:
    """Write the program of a module that has been through the passes for ``target``.

    Raises:
        CompileError: The target cannot say what the author wrote.
    """
    return _backend(target.name).emit(module, target)


__all__ = ["Artifact", "emit", "get_target", "target_names"]
