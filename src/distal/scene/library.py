"""The whole field library, loaded: importing a room of it declares its shapes and operators."""

from __future__ import annotations

import importlib
import pkgutil

import distal.fields
from distal.fields.claims import OPERATORS, PRIMITIVES

for _module in pkgutil.iter_modules(distal.fields.__path__):
    importlib.import_module(f"distal.fields.{_module.name}")

__all__ = ["OPERATORS", "PRIMITIVES"]
