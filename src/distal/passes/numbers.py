"""The numbers of a scene's shapes as constants, for a text or a kernel that is final.

Input: a lowered module. Output: the same without uniforms of origin NUMBER: each value stands where
it was read, and the passes fold it. It costs a compilation for every change of a number.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from distal.ir.build import number
from distal.ir.nodes import Compose, Expr, Module, Origin, Uniform
from distal.ir.types import Kind, Matrix, Scalar, Type, Vector
from distal.ir.walk import map_expressions, substitute


def freeze(module: Module) -> Module:
    """The module with its numbers as constants."""
    constants: dict[Expr, Expr] = {
        Uniform(u.name, u.type): constant(u.default, u.type)
        for u in module.uniforms
        if u.origin is Origin.NUMBER
    }
    if not constants:
        return module
    memo: dict[Expr, Expr] = {}
    functions = tuple(
        replace(f, body=map_expressions(f.body, lambda e: substitute(e, constants, memo)))
        for f in module.functions
    )
    kept = tuple(u for u in module.uniforms if u.origin is not Origin.NUMBER)
    return replace(module, functions=functions, uniforms=kept)


def constant(value: Any, type: Type) -> Expr:
    """A uniform's value as an expression."""
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
