"""Move large tables of literals to buffers, for targets whose drivers compile arrays slowly.

Input: functions that index arrays of literals by computed numbers. Output: the same reads from at
most three buffers (``tables.layout``), which are in ``Module.resources`` with their values. If a
table, or a part of one, is passed to a function, it is bound to a clone of the function. Where a
table is read as a whole, its literals are kept. Decision 19 has the measurements.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import chain
from typing import Final

from distal.ir.nodes import (
    Assign,
    Call,
    Const,
    Construct,
    Expr,
    Field,
    Function,
    Index,
    Let,
    Module,
    Param,
    PerFrame,
    Read,
    Return,
    Select,
    Stmt,
    Var,
)
from distal.ir.types import BOOL, INT, Array, Struct, Type
from distal.ir.walk import (
    children,
    expressions_in,
    is_unchanging,
    map_indices,
    map_statement,
    nodes_in,
    rebuild,
    statements_in,
)
from distal.passes.context import Context
from distal.passes.dead_code import remove_dead
from distal.passes.naming import FreshNames, local_names, module_names
from distal.passes.reachable import drop_unused
from distal.passes.tables.layout import (
    Choice,
    TablePlace,
    Tables,
    holds_table,
    is_large_literal,
    whole,
)

_NONE: Final[dict[Type, Const]] = {INT: Const(0, INT), BOOL: Const(False, BOOL)}


def run(module: Module, context: Context) -> Module:
    """Move every large table that is indexed to a buffer, if the target requires it."""
    largest = context.target.largest_table
    if largest is None or not _has_table(module, largest):
        return module
    names = FreshNames(module_names(module))
    clones = _TableFunctions(module, Tables(names), names, largest)
    frame = _TableRewriter(clones).frame(module.frame)
    for function in module.functions:
        clones.instance(function.name, (None,) * len(function.params))
    resources = (*module.resources, *clones.tables.declarations())
    functions = tuple(clones.made.values())
    return drop_unused(replace(module, functions=functions, frame=frame, resources=resources))


def _has_table(module: Module, largest: int) -> bool:
    in_functions = (expressions_in(f.body) for f in module.functions)
    found = chain(nodes_in(*(value for _, value in module.frame)), *in_functions)
    return any(is_large_literal(e, largest) for e in found)


def _shape(place: TablePlace) -> TablePlace:
    """Return a location without its expressions computed at run time: part of a clone's key."""
    return place.with_operands([_NONE[o.type] for o in place.operands])


class _TableFunctions:
    """The rewritten functions created so far, callees first.

    Attributes:
        tables: The buffers.
        made: The functions by name.
        largest: The largest number of scalars in an array that is not moved.
        per_frame: The per-frame values that are tables or parts of tables -> their locations.
    """

    def __init__(self, module: Module, tables: Tables, names: FreshNames, largest: int) -> None:
        self.tables = tables
        self.made: dict[str, Function] = {}
        self.per_frame: dict[str, TablePlace] = {}
        self._functions = {f.name: f for f in module.functions}
        self.largest = largest
        self._names = names
        self._by_key: dict[tuple[str, tuple[TablePlace | None, ...]], str] = {}

    def instance(self, name: str, shapes: tuple[TablePlace | None, ...]) -> str:
        """Return the name of a function with tables bound to some parameters; create it once."""
        key = name, shapes
        if key not in self._by_key:
            bound = any(shape is not None for shape in shapes)
            new = self._names.fresh(f"{name}_of_table") if bound else name
            self._by_key[key] = new
            self.made[new] = _TableRewriter(self, self._functions[name]).function(new, shapes)
        return self._by_key[key]

    def returned(self, name: str) -> Expr | None:
        """Return the table that a function returns if it does nothing else, or None."""
        match self._functions[name].body:
            case (Return(value),) if is_large_literal(value, self.largest):
                return value
            case _:
                return None


class _TableRewriter:
    """Rewrites one function, or expressions outside all functions."""

    def __init__(self, clones: _TableFunctions, function: Function | None = None) -> None:
        self._clones = clones
        self._original = function
        self._names = FreshNames(local_names(function) if function is not None else ())
        body = function.body if function is not None else ()
        self._variables = {s.name for s in statements_in(body) if isinstance(s, Var)}
        self._places: dict[str, TablePlace] = {}
        self._memo: dict[Expr, Expr] = {}

    def function(self, name: str, shapes: Sequence[TablePlace | None]) -> Function:
        """Return the function with reads of buffers, and tables bound to its parameters."""
        function = self._original
        assert function is not None
        params: list[Param] = []
        bound: list[Stmt] = []
        for param, shape in zip(function.params, shapes, strict=True):
            if shape is None:
                params.append(param)
                continue
            extra = [Param(self._names.fresh(f"{param.name}_at"), o.type) for o in shape.operands]
            params += extra
            place = shape.with_operands([Read(p.name, p.type) for p in extra])
            self._places[param.name] = place
            bound.append(Let(param.name, self._clones.tables.value(place), span=function.span))
        body = remove_dead((*bound, *self._block(function.body)))
        return replace(function, name=name, params=tuple(params), body=body)

    def frame(self, values: Iterable[tuple[str, Expr]]) -> tuple[tuple[str, Expr], ...]:
        """Return the per-frame values with reads of buffers."""
        written = []
        for name, value in values:
            place = self._place(value)
            if place is not None:
                self._clones.per_frame[name] = place
            written.append((name, self.expression(value)))
        return tuple(written)

    # Statements.

    def _block(self, body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
        written: list[Stmt] = []
        for stmt in body:
            match stmt:
                case Let(name, value) if isinstance(value.type, Array | Struct):
                    place = self._place(value)
                    if place is not None:
                        self._places[name] = self._kept(place, stmt, written)
                    written.append(Let(name, self.expression(value), span=stmt.span))
                case Assign(target, value):
                    path = map_indices(target, self.expression)
                    written.append(Assign(path, self.expression(value), span=stmt.span))
                case _:
                    written.append(map_statement(stmt, self.expression, self._block))
        return tuple(written)

    def _kept(self, place: TablePlace, stmt: Let, written: list[Stmt]) -> TablePlace:
        """Bind operands of the location that may change later to Lets; return the new location."""
        operands: list[Expr] = []
        for operand in place.operands:
            if not is_unchanging(operand, self._variables):
                name = self._names.fresh(f"{stmt.name}_at")
                written.append(Let(name, operand, span=stmt.span))
                operand = Read(name, operand.type)
            operands.append(operand)
        return place.with_operands(operands)

    # Expressions.

    def expression(self, e: Expr) -> Expr:
        """Return the expression with reads of buffers."""
        done = self._memo.get(e)
        if done is None:
            done = self._memo[e] = self._rewritten(e)
        return done

    def _rewritten(self, e: Expr) -> Expr:
        match e:
            case Index() | Field() if not holds_table(e.type, self._clones.largest):
                place = self._place(e)
                if place is not None:
                    return self._clones.tables.value(place)
            case Call():
                return self._call(e)
            case Construct() if self._is_table(e):
                return e
            case _:
                pass
        return rebuild(e, tuple(map(self.expression, children(e))))

    def _is_table(self, e: Expr) -> bool:
        return is_large_literal(e, self._clones.largest)

    def _place(self, e: Expr) -> TablePlace | None:
        """Return the location if the expression is a table or a part of one, else None."""
        match e:
            case Construct():
                return whole(e) if self._is_table(e) else None
            case Read(name):
                return self._places.get(name)
            case PerFrame(name):
                return self._clones.per_frame.get(name)
            case Index(base, index) if isinstance(base.type, Array):
                place = self._place(base)
                return place and place.element(self.expression(index))
            case Field(base, name):
                place = self._place(base)
                return place and place.field(name)
            case Select(condition, yes, no, Array() | Struct()):
                first, second = self._place(yes), self._place(no)
                if first is None or second is None:
                    return None
                return Choice(self.expression(condition), first, second)
            case Call(name):
                table = self._clones.returned(name)
                return None if table is None else whole(table)
            case _:
                return None

    def _call(self, e: Call) -> Call:
        largest = self._clones.largest
        places = [self._place(a) if holds_table(a.type, largest) else None for a in e.args]
        name = self._clones.instance(e.function, tuple(p and _shape(p) for p in places))
        args: list[Expr] = []
        for arg, place in zip(e.args, places, strict=True):
            args += [self.expression(arg)] if place is None else place.operands
        return Call(name, tuple(args), e.type, span=e.span)
