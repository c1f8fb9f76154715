"""Imports the whole field library: each module declares its shapes and operators on import."""

from __future__ import annotations

import importlib
import pkgutil

import distal.fields
from distal.fields.guarantees import OPERATORS, PRIMITIVES

for _module in pkgutil.walk_packages(distal.fields.__path__, "distal.fields."):
    if _module.name != __name__:
        importlib.import_module(_module.name)

# In the order of their modules, whichever of them was imported before this one.
_sorted = sorted(PRIMITIVES.items(), key=lambda row: row[1].distance.python_function.__module__)
PRIMITIVES.clear()
PRIMITIVES.update(_sorted)

__all__ = ["OPERATORS", "PRIMITIVES"]
