"""Bind every function, texture and buffer that is passed to a function.

Input: functions with parameters of static types, and ``Apply`` of function values. Output:
functions of plain values only. Each function with static parameters is cloned once for each
combination of values bound to them; the captures of a bound function become additional parameters
of the clone; ``Apply`` becomes ``Call``. A constant argument that controls loops or branches
(``steering``) is bound too. Functions that cannot be reached are removed. The function of a
``Gradient`` becomes a FunctionRef to a specialised function, for the gradient pass.

A bound value is itself an expression: a Resource, or a FunctionRef whose captures are reads of the
clone's additional parameters or again bound values.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, TypeAlias

from distal.diagnostics import CompileError, Span
from distal.error_codes import ErrorCode
from distal.ir.contents import contents
from distal.ir.nodes import (
    Apply,
    Call,
    Const,
    Expr,
    Function,
    FunctionRef,
    Gradient,
    Let,
    Module,
    Param,
    Read,
    Resource,
    Select,
    Stmt,
    Var,
    span_in,
)
from distal.ir.types import FunctionType, Type, is_static
from distal.ir.walk import children, is_unchanging, map_statement, rebuild, statements_in
from distal.passes.call_order import in_call_order
from distal.passes.context import Context
from distal.passes.naming import FreshNames, local_names
from distal.passes.specialise.steering import SteeringParameters

# A function nested in itself this often through function values would never end.
_DEEPEST: Final = 64
_LONGEST_NAME: Final = 60

_CHOSEN_HINT: Final = "call both functions and choose between their results"


@dataclass(frozen=True)
class _BoundShape:
    """A bound value without the run-time values it captures: part of the key of a clone."""

    name: str
    captures: tuple[_BoundShape | Type, ...]


_SPECIALISED: Final = frozenset({Call, Apply, Gradient, FunctionRef, Resource})

_Bound: TypeAlias = _BoundShape | Const | None  # None: a run-time parameter


def run(module: Module, context: Context) -> Module:
    """Specialise every function that the entry reaches.

    Raises:
        CompileError: The entry has a static parameter, the code is recursive, or a static value is
            selected at run time.
    """
    entry = module.function(module.entry)
    for param in entry.params:
        if is_static(param.type):
            raise CompileError.at(
                ErrorCode.CALL,
                f"'{entry.source_name}' takes a {param.type} and can only be called "
                "from scene code",
                entry.span,
                "call it from an @image or another @func that binds it",
            )
    clones = _SpecialisedFunctions(module)
    clones.instance(module.entry, (None,) * len(entry.params), None)
    return replace(module, functions=in_call_order(clones.made.values(), module.entry))


class _SpecialisedFunctions:
    """The specialised functions created so far."""

    def __init__(self, module: Module) -> None:
        self._functions = {f.name: f for f in module.functions}
        self._names = FreshNames(self._functions)
        self.steering = SteeringParameters(self._functions)
        self._by_key: dict[tuple[str, tuple[_Bound, ...]], str] = {}
        self._open: list[str] = []  # the functions whose clones are being created
        self.made: dict[str, Function] = {}

    def parameters(self, name: str) -> tuple[Param, ...]:
        """Return the parameters of a function as the author wrote it."""
        return self._functions[name].params

    def instance(self, name: str, bindings: tuple[_Bound, ...], span: Span | None) -> str:
        """Return the name of the clone with these bindings; create it if it does not exist.

        Args:
            name: The function.
            bindings: For each parameter the bound value; None: a run-time parameter.
            span: The place of the call, for errors.

        Raises:
            CompileError: The function calls itself.
        """
        key = (name, bindings)
        found = self._by_key.get(key)
        if found is not None:
            if found not in self.made:
                raise self._recursion(name, span)
            return found
        if self._open.count(name) >= _DEEPEST:
            raise self._recursion(name, span)
        bound = [b for b in bindings if b is not None]
        new = name
        if bound:
            wanted = "_".join([name, *(word for b in bound for word in _words(b))])
            new = self._names.fresh(wanted[:_LONGEST_NAME].rstrip("_"))
        self._by_key[key] = new
        self._open.append(name)
        self.made[new] = _Clone(self, self._functions[name], bindings).function(new)
        self._open.pop()
        return new

    def _recursion(self, name: str, span: Span | None) -> CompileError:
        return CompileError.at(
            ErrorCode.RECURSION,
            f"'{self._functions[name].source_name}' calls itself through a function it is given",
            span,
            "scene code has no recursion; use a loop",
        )


def _binding(arg: Expr, *, steers: bool) -> _Bound:
    if is_static(arg.type):
        return _shape(arg)
    return arg if steers and isinstance(arg, Const) else None


def _words(shape: _BoundShape | Const) -> Iterator[str]:
    if isinstance(shape, Const):
        yield str(shape.value).lower().replace("-", "minus_")
        return
    yield shape.name
    for capture in shape.captures:
        if isinstance(capture, _BoundShape):
            yield from _words(capture)


def _shape(bound: Expr) -> _BoundShape:
    if isinstance(bound, Resource):
        return _BoundShape(bound.name, ())
    assert isinstance(bound, FunctionRef)
    captures = (_shape(c) if is_static(c.type) else c.type for c in bound.captures)
    return _BoundShape(bound.name, tuple(captures))


def _runtime_parts(bound: Expr) -> Iterator[Expr]:
    """Yield the run-time values that a bound value captures, in the order of the parameters."""
    if isinstance(bound, FunctionRef):
        for capture in bound.captures:
            if is_static(capture.type):
                yield from _runtime_parts(capture)
            else:
                yield capture


class _Clone:
    """Creates a clone of one function with its static parameters bound."""

    def __init__(
        self, clones: _SpecialisedFunctions, original: Function, bindings: tuple[_Bound, ...]
    ) -> None:
        self._clones = clones
        self._original = original
        self._names = FreshNames(local_names(original))
        self._bound: dict[str, Expr] = {}
        self._memo: dict[Expr, Expr] = {}
        self._span: Span | None = original.span
        self._vars = {s.name for s in statements_in(original.body) if isinstance(s, Var)}
        params: list[Param] = []
        extra: list[Param] = []
        for param, binding in zip(original.params, bindings, strict=True):
            if binding is None:
                params.append(param)
            elif isinstance(binding, Const):
                self._memo[Read(param.name, param.type)] = binding
            else:
                self._bound[param.name] = self._open_binding(param, binding, extra)
        self._params = (*params, *extra)
        # The names whose reads are replaced.
        self._replaced = {
            p.name for p, b in zip(original.params, bindings, strict=True) if b is not None
        }

    def _open_binding(self, param: Param, shape: _BoundShape, extra: list[Param]) -> Expr:
        """Return the bound value as an expression over the clone's additional parameters."""
        if not isinstance(param.type, FunctionType):
            return Resource(shape.name, param.type)
        taken = self._clones.parameters(shape.name)
        captures: list[Expr] = []
        count = len(shape.captures)
        for captured, inner in zip(taken[len(taken) - count :], shape.captures, strict=True):
            if isinstance(inner, _BoundShape):
                captures.append(self._open_binding(captured, inner, extra))
            else:
                name = self._names.fresh(f"{param.name}_{captured.name}")
                extra.append(Param(name, inner))
                captures.append(Read(name, inner))
        return FunctionRef(shape.name, tuple(captures), param.type)

    def function(self, name: str) -> Function:
        body = self._block(self._original.body)
        return replace(self._original, name=name, params=self._params, body=body)

    def _block(self, body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
        written: list[Stmt] = []
        for stmt in body:
            self._span = stmt.span
            if isinstance(stmt, Let) and is_static(stmt.value.type):
                self._bound[stmt.name] = self._kept(self._static(stmt.value), stmt, written)
                self._replaced.add(stmt.name)
            elif isinstance(stmt, Var) and is_static(stmt.value.type):
                raise self._chosen(stmt.value)
            else:
                written.append(map_statement(stmt, self._expression, self._block))
        return tuple(written)

    def _kept(self, bound: Expr, stmt: Let, written: list[Stmt]) -> Expr:
        """Bind captured values that may change later to Lets, to keep their current values."""
        if not isinstance(bound, FunctionRef):
            return bound
        captures: list[Expr] = []
        for capture in bound.captures:
            if is_static(capture.type):
                captures.append(self._kept(capture, stmt, written))
            elif is_unchanging(capture, self._vars):
                captures.append(capture)
            else:
                name = self._names.fresh(f"{stmt.name}_captured")
                written.append(Let(name, capture, span=stmt.span))
                captures.append(Read(name, capture.type))
        return FunctionRef(bound.name, tuple(captures), bound.type)

    def _expression(self, e: Expr) -> Expr:
        known = contents(e)
        if known.kinds.isdisjoint(_SPECIALISED) and known.reads.isdisjoint(self._replaced):
            return e  # most expressions of the library: nothing in them is static
        done = self._memo.get(e)
        if done is None:
            done = self._memo[e] = self._rewritten(e)
        return done

    def _rewritten(self, e: Expr) -> Expr:
        match e:
            case Read() | Resource() | FunctionRef() if is_static(e.type):
                return self._static(e)
            case Call(name, args, type):
                return self._call(name, args, type, e.span)
            case Apply(function, args, type):
                bound = self._static(function)
                assert isinstance(bound, FunctionRef)
                # The captures are already rewritten: bound values and reads of the clone.
                given = (*(self._expression(a) for a in args), *bound.captures)
                return self._bound_call(bound.name, given, type, e.span)
            case Gradient(function, point, with_value, type):
                bound = self._static(function)
                assert isinstance(bound, FunctionRef)
                callee = self._reference(bound)
                return Gradient(callee, self._expression(point), with_value, type, span=e.span)
            case Select(_, _, _, type) if is_static(type):
                return self._static(e)
            case _:
                return rebuild(e, tuple(self._expression(c) for c in children(e)))

    def _static(self, e: Expr) -> Expr:
        """Return the value that a static expression is bound to.

        Raises:
            CompileError: The value is selected at run time.
        """
        match e:
            case Read(name) if name in self._bound:
                return self._bound[name]
            case Resource():
                return e
            case FunctionRef(name, captures, type):
                return FunctionRef(name, tuple(self._expression(c) for c in captures), type)
            case Select(Const(value), yes, no):
                return self._static(yes if value else no)
            case _:
                raise self._chosen(e)

    def _call(self, name: str, args: tuple[Expr, ...], type: Type, span: Span | None) -> Expr:
        return self._bound_call(name, [self._expression(a) for a in args], type, span)

    def _bound_call(self, name: str, args: Sequence[Expr], type: Type, span: Span | None) -> Expr:
        """Return a call of the clone for the static arguments; ``args`` are already rewritten."""
        steering = self._clones.steering.of(name)
        bindings: tuple[_Bound, ...] = tuple(
            _binding(a, steers=i in steering) for i, a in enumerate(args)
        )
        new = self._clones.instance(name, bindings, self._span)
        plain = [a for a, b in zip(args, bindings, strict=True) if b is None]
        captured = [part for a in args if is_static(a.type) for part in _runtime_parts(a)]
        return Call(new, (*plain, *captured), type, span=span)

    def _reference(self, bound: FunctionRef) -> FunctionRef:
        """Return a reference to the clone for the static captures of a bound function."""
        free = len(self._clones.parameters(bound.name)) - len(bound.captures)
        inner = tuple(_shape(c) if is_static(c.type) else None for c in bound.captures)
        name = self._clones.instance(bound.name, (*(None,) * free, *inner), self._span)
        plain = [c for c in bound.captures if not is_static(c.type)]
        captured = [p for c in bound.captures if is_static(c.type) for p in _runtime_parts(c)]
        return FunctionRef(name, (*plain, *captured), bound.type)

    def _chosen(self, e: Expr) -> CompileError:
        what = "function" if isinstance(e.type, FunctionType) else str(e.type)
        hint = _CHOSEN_HINT if isinstance(e.type, FunctionType) else "read both and choose after"
        return CompileError.at(
            ErrorCode.LANGUAGE,
            f"a {what} cannot be chosen while the program runs",
            span_in(self._span, e),
            hint,
        )
