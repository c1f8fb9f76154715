"""Lowering for tests: printed bodies, and values computed by the reference."""

from __future__ import annotations

import linecache
import textwrap
from typing import Any

import numpy as np

from distal.backends.numpy import interpreter as reference
from distal.compiler.prelude_library import PreludeLibrary
from distal.frontend import lower
from distal.ir.nodes import Module
from distal.ir.printer import print_module
from distal.ir.types import BOOL, FLOAT, INT, UINT, Type
from distal.ir.verify import verify
from distal.passes import bounds, entry
from distal.passes.context import Context
from distal.passes.decompose import decompose
from distal.passes.gradient import gradient
from distal.passes.specialise import specialise

_PASSES = (entry, specialise, gradient, decompose, specialise, bounds)
_DTYPES = {FLOAT: np.float64, INT: np.int32, UINT: np.uint32, BOOL: np.bool_}


def from_text(text: str, name: str = "scene", file: str = "author.py", **names: Any) -> Any:
    """What a file of an author's defines under ``name``."""
    text = "from distal.lang import *\n" + textwrap.dedent(text)
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    scope: dict[str, Any] = {"__name__": file.removesuffix(".py"), **names}
    exec(compile(text, file, "exec", dont_inherit=True), scope)
    return scope[name]


def lowered(func: Any, types: tuple[Type, ...] | None = None) -> Module:
    """The verified module."""
    module = lower(func, types)
    verify(module)
    return module


def printed(func: Any, types: tuple[Type, ...] | None = None) -> str:
    """The functions of the module as text, without the uniforms and structs."""
    text = print_module(lowered(func, types))
    return text[text.index("fn ") :].rstrip()


def body(func: Any, types: tuple[Type, ...] | None = None) -> str:
    """The statements of the entry, the last function of the module."""
    return "\n" + printed(func, types).rpartition("fn ")[2].partition("\n")[2] + "\n"


def value(func: Any, *args: Any, uniforms: dict[str, Any] | None = None) -> Any:
    """The function's value for scalars, by the 64-bit reference."""
    module = lowered(func)
    context = Context(reference.TARGET, PreludeLibrary(), 64)
    for one in _PASSES:
        module = one.run(module, context)
        verify(module)
    params = module.function(module.entry).params
    given = [np.array([a], _DTYPES[p.type]) for a, p in zip(args, params, strict=True)]
    found = reference.evaluate(module, given, uniforms or {}, {}, 64)
    return np.asarray(found)[..., 0].tolist()
