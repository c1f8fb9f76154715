"""Outline: cut a very long function into several functions, if the target requires it.

Input: predicated functions. Output: functions with the same values; in a function larger than
``LARGE``, sequences of statements become functions of about size ``PIECE`` that are not inlined
again. The time of LLVM's instruction selection and register allocation grows with the square of a
block's length: 800 lines of one block took 10 s, in pieces they take a tenth.

A piece takes the locals that it reads as parameters and returns those that are read after it. Large
arrays are not passed: statements that use one stay in the original function, and so do exits.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from distal.ir.exits import may_exit
from distal.ir.nodes import (
    Assign,
    Call,
    Construct,
    Expr,
    Field,
    For,
    Function,
    Let,
    Module,
    Param,
    Read,
    Return,
    Stmt,
    Var,
)
from distal.ir.types import INT, Array, Struct, Type
from distal.ir.walk import map_statement, names_read, statements_in
from distal.passes.context import Context
from distal.passes.cost import size
from distal.passes.naming import FreshNames, local_names, module_names
from distal.passes.versions import assigned_in

# The largest function of the examples has size 3600. A union of 150 shapes has 5700: cut into
# pieces, it compiles in 8.8 s instead of 11.5, and renders a quarter slower.
LARGE: Final = 5000
PIECE: Final = 1200
LARGE_ARRAY: Final = 16  # in elements; larger arrays are not passed


def run(module: Module, context: Context) -> Module:
    """Cut every large function, if the target requires it."""
    if not context.target.outlined:
        return module
    if all(size(f.body) <= LARGE for f in module.functions):
        return module
    names = FreshNames(module_names(module))
    functions: list[Function] = []
    for function in module.functions:
        if size(function.body) > LARGE:
            functions.extend(_Outlining(function, names).functions())
        else:
            functions.append(function)
    return replace(module, functions=tuple(functions))


@dataclass(slots=True)
class _Run:
    """Consecutive statements, and their total size."""

    body: list[Stmt]
    weight: int = 0


class _Outlining:
    """Cuts one large function."""

    def __init__(self, function: Function, names: FreshNames) -> None:
        self._function = function
        self._names = names
        self._locals = FreshNames(local_names(function))
        self._types: dict[str, Type] = {p.name: p.type for p in function.params}
        for stmt in statements_in(function.body):
            if isinstance(stmt, Let | Var):
                self._types[stmt.name] = stmt.value.type
            elif isinstance(stmt, For):
                self._types[stmt.name] = INT
        self._pieces: list[Function] = []

    def functions(self) -> list[Function]:
        """Return the pieces, and the function that calls them."""
        body = self._block(self._function.body)
        return [*self._pieces, replace(self._function, body=body)]

    def _block(self, body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
        if size(body) <= PIECE:
            return body
        body = tuple(map_statement(s, lambda e: e, self._block) for s in body)
        last_reads: dict[str, int] = {}
        for position, stmt in enumerate(body):
            for name in names_read((stmt,)):
                last_reads[name] = position
        result: list[Stmt] = []
        position = 0
        for run in self._runs(body):
            position += len(run.body)
            # A short run stays: moving it to a separate function would not help.
            if run.weight < PIECE // 2:
                result.extend(run.body)
            else:
                result.extend(self._piece(tuple(run.body), last_reads, position - 1))
        return tuple(result)

    def _runs(self, body: tuple[Stmt, ...]) -> list[_Run]:
        """Split the block into runs; a statement that has to stay is a run of weight 0."""
        runs: list[_Run] = []
        for stmt in body:
            if self._stays(stmt):
                runs.append(_Run([stmt]))
                continue
            weight = size((stmt,))
            if not runs or not runs[-1].weight or runs[-1].weight + weight > PIECE:
                runs.append(_Run([]))
            runs[-1].body.append(stmt)
            runs[-1].weight += weight
        return runs

    def _stays(self, stmt: Stmt) -> bool:
        if may_exit(stmt):
            return True
        names = names_read((stmt,)) | _declared_in((stmt,))
        return any(_is_large(self._types[name]) for name in names)

    def _piece(self, body: tuple[Stmt, ...], last_reads: dict[str, int], last: int) -> list[Stmt]:
        """Create a function from a run, and return the statements that call it."""
        declared = _declared_in(body)
        assigned = sorted(assigned_in(body) - declared)
        given = sorted(names_read(body) - declared)
        kept = [s for s in body if isinstance(s, Let | Var) and last_reads.get(s.name, -1) > last]
        wanted = [*assigned, *(s.name for s in kept)]
        if not wanted:
            return list(body)
        params, before = [], []
        for name in given:
            param = self._locals.fresh(f"{name}_given") if name in assigned else name
            params.append(Param(param, self._types[name]))
            if name in assigned:
                before.append(Var(name, Read(param, self._types[name])))
        reads = [Read(name, self._types[name]) for name in wanted]
        value: Expr = reads[0]
        name = self._names.fresh(f"{self._function.name}_part")
        if len(reads) > 1:
            fields = tuple((r.name, r.type) for r in reads)
            value = Construct(tuple(reads), Struct(name, fields, False))
        self._pieces.append(
            replace(
                self._function,
                name=name,
                params=tuple(params),
                result=value.type,
                body=(*before, *body, Return(value)),
                apart=True,
            )
        )
        args = tuple(Read(n, self._types[n]) for n in given)
        call = Call(name, args, value.type, span=body[0].span)
        return self._results(call, reads, {s.name for s in kept if isinstance(s, Let)}, assigned)

    def _results(
        self, call: Call, wanted: list[Read], lets: set[str], assigned: list[str]
    ) -> list[Stmt]:
        """Return the statements that restore the locals after the call of a piece."""
        span = call.span
        result: list[Stmt] = []
        values: list[Expr] = [call]
        if len(wanted) > 1:
            whole = Read(self._locals.fresh("part"), call.type)
            self._types[whole.name] = whole.type
            result.append(Let(whole.name, call, span=span))
            values = [Field(whole, r.name, r.type) for r in wanted]
        for read, value in zip(wanted, values, strict=True):
            if read.name in assigned:
                result.append(Assign(read, value, span=span))
            elif read.name in lets:
                result.append(Let(read.name, value, span=span))
            else:
                result.append(Var(read.name, value, span=span))
        return result


def _declared_in(body: tuple[Stmt, ...]) -> set[str]:
    return {s.name for s in statements_in(body) if isinstance(s, Let | Var | For)}


def _is_large(type: Type) -> bool:
    if isinstance(type, Struct):
        return any(_is_large(t) for _, t in type.fields)
    return isinstance(type, Array) and (type.length > LARGE_ARRAY or _is_large(type.element))
