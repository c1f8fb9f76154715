"""Express the operations that a target lacks by operations that it has.

Input: a module without function values and gradients. Output: a module with only those operations
that the target has (``distal.ir.target``). Most replacements are calls of prelude functions, which
are linked in and decomposed too, until nothing is left to replace. An operation that cannot be
expressed on the target is a CompileError at the author's line (``decompose.limits``).

Nothing is moved: a replacement takes the place of the operation, so that conditional computation
stays conditional. If the prelude function takes scalars only, a new function applies it to each
component.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from distal.diagnostics import CompileError, Span
from distal.ir.build import binary, components, integer, number, splat
from distal.ir.intrinsics import INTRINSICS
from distal.ir.limits import largest_power, smallest
from distal.ir.nodes import (
    Assign,
    Binary,
    BinaryOp,
    Builtin,
    Call,
    Cast,
    Compose,
    Const,
    Expr,
    For,
    Function,
    Index,
    Let,
    Module,
    Param,
    Read,
    Resource,
    Return,
    Sample,
    Splat,
    Stmt,
    Swizzle,
    span_in,
)
from distal.ir.nodes import Field as FieldNode
from distal.ir.types import INT, Kind, Scalar, Texture, TextureShape, Type, Vector, kind_of
from distal.ir.walk import map_statement, rebuild, rewrite
from distal.passes.author_places import author_place
from distal.passes.call_order import in_call_order
from distal.passes.context import Context
from distal.passes.decompose.edges import (
    divides,
    floor_quotient,
    held,
    nearer_zero,
    never_crossed,
    remainder,
    target_serves,
)
from distal.passes.decompose.indices import assignments, picked_element, settled_index
from distal.passes.decompose.limits import Blame, constant_loop, refuse_expression, refuse_statement
from distal.passes.naming import FreshNames, local_names, module_names
from distal.passes.ranges import Ranges, declared_ranges

_SAMPLERS: Final = {
    TextureShape.FLAT: "textures.sample_2d",
    TextureShape.CUBE: "textures.sample_cube",
    TextureShape.VOLUME: "textures.sample_3d",
}
_WRAPS: Final = {"repeat": 0, "clamp": 1}
_ENDS: Final = {"smallest_normal": smallest, "largest_power": largest_power}
_WHOLE: Final = (Kind.INT, Kind.UINT)


def run(module: Module, context: Context) -> Module:
    """Decompose every function, then the prelude functions that this adds, until none is left."""
    linker = _Linker(module, context)
    done: dict[str, Function] = {}
    while len(done) < len(linker.module.functions):
        for function in linker.module.functions:
            if function.name not in done:
                done[function.name] = _decomposed(linker, context, function, module)
    standing_in = [replace(f, native=linker.natives.get(f.name)) for f in done.values()]
    functions = in_call_order(standing_in, module.entry)
    return replace(linker.module, functions=functions)


def _decomposed(linker: _Linker, context: Context, function: Function, module: Module) -> Function:
    """Return a function without what the target lacks.

    Raises:
        CompileError: It needs what the target cannot express; the place is the author's.
    """
    try:
        return _Decomposer(linker, context, function).function()
    except CompileError as error:
        (first, *_) = error.diagnostics
        if first.span is not None:
            raise
        blame = linker.blame(function.name)
        span = author_place(module, blame.function if blame else function.name)
        raise CompileError([replace(first, span=span)]) from None


class _Linker:
    """The module, to which prelude functions are added.

    Attributes:
        module: The module with the functions added so far.
        natives: Functions that replace a built-in of an inaccurate driver -> the built-in's name.
        ranges: The declared ranges of the module's uniforms.
    """

    def __init__(self, module: Module, context: Context) -> None:
        self.module = module
        self.ranges = declared_ranges(module.uniforms)
        self.natives: dict[str, str] = {}
        self._library = context.library
        self._blames: dict[str, Blame] = {}  # prelude function -> who needs it
        self._wrappers: dict[tuple[str, tuple[Type, ...]], str] = {}
        self._linked: dict[tuple[str, tuple[Type, ...]], str] = {}

    def blame(self, function: str) -> Blame | None:
        """Return the author's operation that needs a prelude function; None for other functions."""
        return self._blames.get(function)

    def call(self, name: str, args: tuple[Expr, ...], type: Type, blame: Blame) -> Call:
        """Return a call of a prelude function, by components if it takes scalars only.

        Args:
            name: The prelude function.
            args: The arguments.
            type: The type of the result.
            blame: The author's operation that needs the function.
        """
        types = tuple(a.type for a in args)
        if self._library.find(name, types) is not None:
            return Call(self._link(name, types, blame), args, type, span=blame.span)
        key = (name, types)
        if key not in self._wrappers:
            self._wrappers[key] = self._wrap(name, types, type, blame)
        return Call(self._wrappers[key], args, type, span=blame.span)

    def _link(self, name: str, types: tuple[Type, ...], blame: Blame) -> str:
        function = self._linked.get((name, types))
        if function is None:
            before = {f.name for f in self.module.functions}
            self.module, function = self._library.link(self.module, name, types)
            for added in self.module.functions:
                if added.name not in before:
                    self._blames[added.name] = blame
            self._linked[name, types] = function
        return function

    def _wrap(self, name: str, types: tuple[Type, ...], type: Type, blame: Blame) -> str:
        """Create a function that applies the scalar overload to each component; return its name."""
        scalars = tuple(Scalar(t.kind) if isinstance(t, Vector) else t for t in types)
        found = self._library.find(name, scalars)
        assert found is not None, f"the prelude has no {name} of {', '.join(map(str, types))}"
        assert isinstance(type, Vector), type
        scalar = self._link(name, scalars, blame)
        params = tuple(Param(p.name, t) for p, t in zip(found.params, types, strict=True))
        reads = [Read(p.name, p.type) for p in params]
        lanes = [components(r) if isinstance(r.type, Vector) else (r,) * type.size for r in reads]
        calls = (Call(scalar, args, Scalar(type.kind)) for args in zip(*lanes, strict=True))
        new = FreshNames(module_names(self.module)).fresh(f"{scalar}_{type}")
        body = (Return(Compose(tuple(calls), type), span=found.span),)
        function = Function(new, params, type, body, found.source_name, span=found.span)
        self.module = replace(self.module, functions=(*self.module.functions, function))
        self._blames[new] = blame
        return new


class _Decomposer:
    """Decomposes one function."""

    def __init__(self, linker: _Linker, context: Context, function: Function) -> None:
        self._linker = linker
        self._context = context
        self._target = context.target
        self._original = function
        self._blame = linker.blame(function.name)
        self._names = FreshNames(local_names(function))
        # A loop over a parameter outside its declared range runs for that range's length only.
        self._ranges = Ranges(uniforms=linker.ranges)
        self._known: dict[Expr, Expr] = {}
        self._memo: dict[Expr, Expr] = {}
        self._span: Span | None = function.span

    def function(self) -> Function:
        if not self._target.unsigned:
            for param in self._original.params:
                refuse_expression(
                    Read(param.name, param.type), self._target, self._blamed(None, "")
                )
        return replace(self._original, body=self._block(self._original.body))

    def _blamed(self, e: Expr | None, what: str) -> Blame:
        if self._blame is not None:
            return self._blame
        span = span_in(self._span, e) if e is not None else self._span
        return Blame(span, what, self._original.name)

    # Statements.

    def _block(self, body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
        written: list[Stmt] = []
        for stmt in body:
            self._span = stmt.span
            refuse_statement(stmt, self._target, self._blamed(None, "this loop"))
            written.extend(self._statement(stmt))
        return tuple(written)

    def _statement(self, stmt: Stmt) -> list[Stmt]:
        before: list[Stmt] = []
        if isinstance(stmt, For) and not self._target.dynamic_loops:
            blame = self._blamed(None, "this loop")
            stmt = constant_loop(stmt, self._ranges, self._names, self._target, blame, before)
            before = [self._mapped(s) for s in before]
        if isinstance(stmt, Let | For):
            self._ranges.enter(stmt)
        if isinstance(stmt, Let):
            self._known[Read(stmt.name, stmt.value.type)] = stmt.value
        if isinstance(stmt, Assign):
            assign = Assign(self._path(stmt.target), self._expression(stmt.value), span=stmt.span)
            if self._target.dynamic_index:
                return [assign]
            return assignments(assign, self._names)
        return [*before, self._mapped(stmt)]

    def _mapped(self, stmt: Stmt) -> Stmt:
        return map_statement(stmt, self._expression, self._block)

    def _path(self, target: Expr) -> Expr:
        """Decompose the target of an Assign: only its indices are computed expressions."""
        match target:
            case Index(base, index):
                path = rebuild(target, (self._path(base), self._expression(index)))
                assert isinstance(path, Index)
                able = self._target.dynamic_index
                return path if able else settled_index(path, self._ranges)
            case Swizzle(base) | FieldNode(base):
                return rebuild(target, (self._path(base),))
            case _:
                return target

    # Expressions.

    def _expression(self, e: Expr) -> Expr:
        return rewrite(e, self._changed, self._memo)

    def _changed(self, e: Expr) -> Expr:
        refuse_expression(e, self._target, self._blamed(e, ""))
        match e:
            case Builtin():
                return self._builtin(e)
            case Binary(BinaryOp.FLOOR_DIV | BinaryOp.MOD):
                return self._floored(e)
            case Binary(BinaryOp.SHL | BinaryOp.SHR, _, rhs):
                return rebuild(e, (e.lhs, _shift_count(rhs)))
            case Cast(value) if kind_of(value.type) is Kind.FLOAT and kind_of(e.type) in _WHOLE:
                return self._cast(e)
            case Sample(texture, coord) if not self._target.samples:
                return self._sample(e, texture, coord)
            case Index() if not self._target.dynamic_index:
                return picked_element(settled_index(e, self._ranges))
            case _:
                return e

    def _scene(self, e: Expr, name: str, args: tuple[Expr, ...], what: str) -> Call:
        return self._linker.call(name, args, e.type, self._blamed(e, what))

    def _builtin(self, e: Builtin) -> Expr:
        intrinsic = INTRINSICS[e.name]
        family = self._target.family
        precision = self._context.precision
        if e.name == "nearer_zero":
            return nearer_zero(e.args[0], precision)
        if e.name in _ENDS:
            return number(_ENDS[e.name](precision), e.type)
        e = held(e, intrinsic, self._target, precision)
        if e.name in self._target.rough and intrinsic.careful is not None:
            careful = self._scene(e, intrinsic.careful, e.args, e.name)
            self._linker.natives[careful.function] = e.name
            return careful
        spelling = intrinsic.spelling(family)
        # GLSL ES 1.00 has these functions for floats only, not for ints.
        if family == "glsl100" and intrinsic.scene and kind_of(e.args[0].type) in _WHOLE:
            spelling = f"@{intrinsic.scene}"
        if e.name == "mod" and divides(e.args[1], self._known):
            return remainder(e.args[0], e.args[1], self._known, precision)
        if intrinsic.guarded and not target_serves(e, self._known):
            assert intrinsic.scene is not None, intrinsic
            return self._scene(e, intrinsic.scene, e.args, e.name)
        if spelling is None or not spelling.startswith("@"):
            return never_crossed(e) if e.name == "clamp" else e
        # The elementary polynomials are for 32 bits; for 64 bits the backend has its own functions.
        if precision == 64 and family == "llvm" and "@elementary." in spelling:
            return e
        return self._scene(e, spelling[1:], e.args, e.name)

    def _floored(self, e: Binary) -> Expr:
        if kind_of(e.type) is Kind.FLOAT:
            if e.op is BinaryOp.FLOOR_DIV:
                return floor_quotient(e.lhs, e.rhs)
            if divides(e.rhs, self._known):
                return remainder(e.lhs, e.rhs, self._known, self._context.precision)
            return self._scene(e, "rounding.remainder", (e.lhs, e.rhs), e.op.value)
        if self._target.integer_floor:
            return e
        power = _power_of_two(e.rhs)
        if power is not None and self._target.unsigned:
            # An arithmetic shift and a mask round down exactly as // and % do.
            if e.op is BinaryOp.FLOOR_DIV:
                return binary(BinaryOp.SHR, e.lhs, _like(e.rhs, power))
            return binary(BinaryOp.AND, e.lhs, _like(e.rhs, (1 << power) - 1))
        name = "floor_quotient" if e.op is BinaryOp.FLOOR_DIV else "floor_remainder"
        return self._scene(e, f"integers.{name}", (e.lhs, e.rhs), e.op.value)

    def _cast(self, e: Cast) -> Expr:
        if isinstance(e.value, Const):
            return Const(_saturated(float(e.value.value), e.type), e.type, span=e.span)
        if self._target.saturating_cast:
            return e
        name = "casts.float_to_int" if kind_of(e.type) is Kind.INT else "casts.float_to_uint"
        return self._scene(e, name, (e.value,), str(e.type))

    def _sample(self, e: Expr, texture: Expr, coord: Expr) -> Expr:
        assert isinstance(texture, Resource) and isinstance(texture.type, Texture)
        declared = next(r for r in self._linker.module.resources if r.name == texture.name)
        args = (texture, coord, integer(_WRAPS[declared.wrap]))
        return self._scene(e, _SAMPLERS[texture.type.shape], args, "sample")


def _constant(e: Expr) -> int | None:
    """Return the integer that every component of a constant has, else None."""
    if isinstance(e, Splat):
        e = e.value
    return int(e.value) if isinstance(e, Const) else None


def _like(e: Expr, value: int) -> Expr:
    """Return an integer constant in every component of the type of ``e``."""
    kind = kind_of(e.type)
    assert kind is not None
    return splat(Const(value, Scalar(kind)), e.type)


def _power_of_two(e: Expr) -> int | None:
    """Return the exponent if ``e`` is a constant power of two, else None."""
    value = _constant(e)
    if value is None or value <= 0 or value & (value - 1):
        return None
    return value.bit_length() - 1


def _shift_count(count: Expr) -> Expr:
    """Return ``count & 31``; the mask is left out for a constant that is already in range."""
    value = _constant(count)
    if value is None:
        return binary(BinaryOp.AND, count, _like(count, 31))
    return count if 0 <= value < 32 else _like(count, value & 31)


def _saturated(value: float, type: Type) -> int:
    low, high = (-(2**31), 2**31 - 1) if type is INT else (0, 2**32 - 1)
    return min(max(math.trunc(value), low), high)
