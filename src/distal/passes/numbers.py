"""Replace the numbers in a scene's shapes by constants, for a text or kernel that will not change.

Input: a lowered module. Output: the same module without uniforms of origin NUMBER: each read is
replaced by the value, so that the passes fold it. Then every change of a number requires a new
compilation.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import Any

from distal.ir.build import number
from distal.ir.nodes import Compose, Expr, Module, Origin, Uniform
from distal.ir.types import Kind, Matrix, Scalar, Type, Vector
from distal.ir.walk import map_expressions, substitute


def freeze(module: Module, kept: Collection[str] = ()) -> Module:
    """Return the module with its numbers as constants, except those whose names are ``kept``."""
    constants: dict[Expr, Expr] = {
        Uniform(u.name, u.type): constant(u.default, u.type)
        for u in module.uniforms
        if u.origin is Origin.NUMBER and u.name not in kept
    }
    if not constants:
        return module
    memo: dict[Expr, Expr] = {}
    functions = tuple(
        replace(f, body=map_expressions(f.body, lambda e: substitute(e, constants, memo)))
        for f in module.functions
    )
    left = tuple(u for u in module.uniforms if u.origin is not Origin.NUMBER or u.name in kept)
    return replace(module, functions=functions, uniforms=left)


def constant(value: Any, type: Type) -> Expr:
    """Return a uniform's value as an expression.

    Raises:
        AssertionError: A uniform cannot have this type.
    """
    match type:
        case Scalar():
            return number(value, type)
        case Vector(kind):
            return Compose(tuple(_scalar(v, kind) for v in value), type)
        case Matrix(size):
            column = Vector(Kind.FLOAT, size)
            columns = (value[i * size : (i + 1) * size] for i in range(size))
            return Compose(tuple(constant(c, column) for c in columns), type)
        case _:
            raise AssertionError(f"{type} is no uniform's")


def _scalar(value: Any, kind: Kind) -> Expr:
    return number(value, Scalar(kind))
