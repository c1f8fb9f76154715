"""Bind each field of a struct to a local, for targets that run many pixels in lockstep.

Input: functions with Lets of constructed structs. Output: the same functions, where a struct of
which only fields are read has a Let for each field instead. So a field that is the same for all
pixels stays a scalar beside fields that differ, and fields that nothing reads are gone.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from distal.ir.nodes import Construct, Expr, Field, Function, Let, Module, Read, Stmt
from distal.ir.types import Struct
from distal.ir.walk import (
    children,
    expressions_in,
    map_statement,
    roots_in,
    statements_in,
    substitute,
)
from distal.passes.context import Context
from distal.passes.dead_code import remove_dead
from distal.passes.naming import FreshNames, local_names
from distal.passes.reachable import drop_unused


def run(module: Module, context: Context) -> Module:
    """Split the structs of every function, if the target computes pixels in lockstep."""
    if not context.target.predicated:
        return module
    return drop_unused(replace(module, functions=tuple(map(split, module.functions))))


def split(function: Function) -> Function:
    """Return the function with a local for each field of a struct that is never read whole."""
    constructed = {
        stmt.name: stmt.value
        for stmt in statements_in(function.body)
        if isinstance(stmt, Let) and isinstance(stmt.value, Construct) and _is_struct(stmt.value)
    }
    for name in _read_whole(function.body):
        constructed.pop(name, None)
    if not constructed:
        return function
    names = FreshNames(local_names(function))
    fields: dict[str, tuple[Read, ...]] = {}
    reads: dict[Expr, Expr] = {}
    for name, value in constructed.items():
        assert isinstance(value.type, Struct)
        whole = Read(name, value.type)
        fields[name] = tuple(
            Read(names.fresh(f"{name}_{field}"), type) for field, type in value.type.fields
        )
        for (field, type), read in zip(value.type.fields, fields[name], strict=True):
            reads[Field(whole, field, type)] = read
    memo: dict[Expr, Expr] = {}

    def block(body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
        return tuple(after for stmt in body for after in statement(stmt))

    def statement(stmt: Stmt) -> Iterator[Stmt]:
        mapped = map_statement(stmt, lambda e: substitute(e, reads, memo), block)
        if isinstance(mapped, Let) and mapped.name in fields:
            assert isinstance(mapped.value, Construct)
            for read, part in zip(fields[mapped.name], mapped.value.parts, strict=True):
                yield Let(read.name, part, span=stmt.span)
        else:
            yield mapped

    # A field may be a struct of which only fields are read.
    return split(replace(function, body=remove_dead(block(function.body))))


def _is_struct(e: Expr) -> bool:
    return isinstance(e.type, Struct)


def _read_whole(body: tuple[Stmt, ...]) -> set[str]:
    """Return the locals that are read otherwise than by a field."""
    found = {e.name for e in roots_in(body) if isinstance(e, Read)}
    for e in expressions_in(body):
        if not isinstance(e, Field):
            found.update(c.name for c in children(e) if isinstance(c, Read))
    return found
