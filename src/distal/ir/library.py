"""The interface through which passes get prelude functions without depending on the front end."""

from __future__ import annotations

from typing import Protocol

from distal.ir.nodes import Function, Module
from distal.ir.types import Type


class Library(Protocol):
    """Lowered prelude functions, looked up by name and argument types."""

    def find(self, name: str, args: tuple[Type, ...]) -> Function | None:
        """Return the overload of a function such as ``elementary.sine`` for exactly these types.

        None if there is no such overload.
        """
        ...

    def link(self, module: Module, name: str, args: tuple[Type, ...]) -> tuple[Module, str]:
        """Add an overload and its callees at the front of the module.

        Linking the same overload twice adds nothing. Names never clash with the author's.

        Args:
            module: The module to add to.
            name: The prelude function's name, such as ``elementary.sine``.
            args: The argument types of the overload.

        Returns:
            The new module, and the function's name in it.
        """
        ...
