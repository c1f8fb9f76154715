"""A module that is imported when one of its names is first read.

Input: a module's full name. Output: an object with the module's attributes. A type checker sees the
real module, imported under ``TYPE_CHECKING`` by the same name.
"""

from __future__ import annotations

import importlib
from typing import Any


class LazyModule:
    """Represents a module that is too heavy, or too high in the layers, to be imported at once."""

    __slots__ = ("_name",)

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> Any:
        return getattr(importlib.import_module(self._name), attribute)
