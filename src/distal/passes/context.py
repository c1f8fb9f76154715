"""The arguments of every pass besides the module."""

from __future__ import annotations

from dataclasses import dataclass

from distal.ir.library import Library
from distal.ir.target import Target


@dataclass(frozen=True, slots=True)
class Context:
    """The target, the prelude library, and the float precision in bits (32 or 64)."""

    target: Target
    library: Library
    precision: int = 32
