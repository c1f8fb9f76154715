"""The interface of a backend and of its output.

A text backend is a Python module with ``emit(module, target)``; ``targets.py`` in its package
declares its targets. LLVM and the NumPy reference have one target each, their ``TARGET``. All
passes for the target have been applied to the module that ``emit`` gets. ``emit`` fails only with
a ``CompileError``, if the target cannot express the author's code.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from distal.ir.nodes import Module
from distal.ir.target import Target


@dataclass(frozen=True, slots=True)
class Artifact:
    """The output of a text backend.

    Attributes:
        text: The complete program, usable without changes.
        interface: What a host must provide, as JSON data: uniforms, textures, buffers, stages.
        vertex: The text of the vertex stage, for targets that have a separate one; else None.
        lines: For each line of ``text``, the author's (file, line) if known; used to map a driver's
            messages to the author's code.
        vertex_lines: The same for ``vertex``.
    """

    text: str
    interface: dict[str, Any]
    vertex: str | None = None
    lines: tuple[tuple[str, int] | None, ...] = ()
    vertex_lines: tuple[tuple[str, int] | None, ...] = ()


class Backend(Protocol):
    """A Python module that writes programs."""

    TARGET: Target  # only in LLVM and the NumPy reference

    def emit(self, module: Module, target: Target) -> Artifact:
        """Return the whole program."""
        ...
