"""Import a module when one of its names is first read.

Input: the full name of a module. Output: an object with the module's attributes. Code that uses it
also imports the real module by the same name under ``TYPE_CHECKING``, for the type checker.
"""

from __future__ import annotations

import importlib
import sys
from typing import Any

from distal.packages import not_in_the_playground


class LazyModule:
    """A module that is imported later, because it is slow to import or in a higher package."""

    __slots__ = ("_name",)

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> Any:
        try:
            module = importlib.import_module(self._name)
        except ModuleNotFoundError as error:
            if sys.platform != "emscripten" or not str(error.name).startswith("distal."):
                raise
            raise not_in_the_playground(str(error.name)) from error
        return getattr(module, attribute)
