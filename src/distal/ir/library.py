"""How a pass asks for a function of the prelude without knowing the front end."""

from __future__ import annotations

from typing import Protocol

from distal.ir.nodes import Function, Module
from distal.ir.types import Type


class Library(Protocol):
    """Lowered prelude functions, by name and argument types."""

    def find(self, name: str, args: tuple[Type, ...]) -> Function | None:
        """The overload of ``elementary.sine`` and the like for exactly these types, or None."""
        ...

    def link(self, module: Module, name: str, args: tuple[Type, ...]) -> tuple[Module, str]:
        """The module with that overload and what it calls added first, and its name there.

        Linking the same overload twice adds nothing; names never clash with the author's.
        """
        ...
