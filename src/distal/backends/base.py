"""What a backend returns, and what it must provide.

A backend of texts is a module with ``emit(module, target)``; its targets are declared beside it, in
``targets.py``. LLVM and the NumPy reference have one target each, their ``TARGET``. The module that
``emit`` gets has been through every pass for that target; emit never fails on one, except with a
``CompileError`` where the target cannot express what the author wrote.
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
        text: The program, complete and usable as it stands.
        interface: What a host must provide, JSON-able: uniforms, textures, buffers, stages.
        vertex: The vertex stage, for targets that have one of their own; else None.
        lines: For each line of ``text`` (from 1), the author's (file, line), where known: to map a
            driver's message back.
        vertex_lines: The same for ``vertex``.
    """

    text: str
    interface: dict[str, Any]
    vertex: str | None = None
    lines: tuple[tuple[str, int] | None, ...] = ()
    vertex_lines: tuple[tuple[str, int] | None, ...] = ()


class Backend(Protocol):
    """A module that writes programs."""

    TARGET: Target  # of a backend that is no text backend

    def emit(self, module: Module, target: Target) -> Artifact:
        """Write the whole program."""
        ...
