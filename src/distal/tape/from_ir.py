"""Turn a function of the IR into a tape.

Input: a module whose entry is a function of a point, after the CPU's passes up to ``LAST_PASS`` in
64 bits (there, elementary functions are still built-ins), and values of its uniforms and buffers.
Output: a tape. Calls are followed, loops with constant bounds are unrolled, and both branches of a
condition are computed. What depends on uniforms only is computed now, so that other values of
uniforms need a new tape.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, TypeAlias, assert_never

import numpy as np

from distal.backends.llvm.lanes import field_offset, leaf_count, leaf_kinds
from distal.ir.nodes import (
    Apply,
    Assign,
    Binary,
    BinaryOp,
    Break,
    Builtin,
    Call,
    Cast,
    Compare,
    Compose,
    Const,
    Construct,
    Continue,
    Expr,
    Field,
    For,
    Function,
    FunctionRef,
    Gradient,
    If,
    Index,
    Let,
    Logical,
    LogicalOp,
    MatMul,
    Module,
    PerFrame,
    Read,
    Resource,
    Return,
    Sample,
    Select,
    Size,
    Splat,
    Stmt,
    Swizzle,
    Texel,
    Unary,
    Uniform,
    Var,
    While,
)
from distal.ir.types import Array, Kind, Matrix, Struct, Type, Vector, component_count, kind_of
from distal.ir.types import Buffer as BufferType
from distal.ir.walk import statements_in
from distal.tape.layout import MOST_OPERATIONS
from distal.tape.scalars import Scalar, Scalars, Varying, refuse_whole_numbers
from distal.tape.tape import Tape, TapeError

LAST_PASS: Final = "predicate"
PRECISION: Final = 64
_MOST_STEPS: Final = 4 * MOST_OPERATIONS  # statements and calls that are followed

# The scalars of a value, in the order of ``leaf_kinds``.
Scalars_: TypeAlias = tuple[Scalar, ...]
Environment: TypeAlias = dict[str, Scalars_]


def tape_of(
    module: Module,
    uniforms: Mapping[str, Any] | None = None,
    resources: Mapping[str, Any] | None = None,
) -> Tape:
    """Return the tape of a function of a point.

    Args:
        module: The module; its entry takes a vec2 or vec3 and returns a float.
        uniforms: Values of uniforms by name; the others have their defaults.
        resources: Buffers by name: arrays with one row for each element.

    Raises:
        TapeError: The function cannot be a tape: it has loops whose length differs from point to
            point, textures, whole numbers that differ from point to point, or is too long.
    """
    walker = _CallFollower(module, uniforms or {}, resources or {})
    entry = module.function(module.entry)
    size = component_count(entry.params[0].type)
    point = tuple(walker.scalars.operation(axis) for axis in "xyz"[:size])
    (result,) = walker.function(entry, [point])
    return walker.scalars.builder.tape(walker.scalars.value(result))


def followed(
    module: Module,
    args: Sequence[Scalars_],
    uniforms: Mapping[str, Scalars_],
    resources: Mapping[str, Any],
    scalars: Scalars,
) -> Scalars_:
    """Return the scalars of a function's result.

    Args:
        module: The module.
        args: The scalars of each parameter of its entry.
        uniforms: The scalars of uniforms by name; the others have their defaults.
        resources: Buffers by name: arrays with one row for each element.
        scalars: Computes with scalars.

    Raises:
        TapeError: The function has something that cannot be followed; see ``tape_of``.
    """
    walker = _CallFollower(module, {}, resources, scalars, uniforms)
    return walker.function(module.function(module.entry), args)


class _CallFollower:
    """Follows a function from its entry."""

    def __init__(
        self,
        module: Module,
        uniforms: Mapping[str, Any],
        resources: Mapping[str, Any],
        scalars: Scalars | None = None,
        known: Mapping[str, Scalars_] | None = None,
    ) -> None:
        self.scalars = scalars or Scalars()
        self._functions = {f.name: f for f in module.functions}
        self._uniforms = {
            u.name: _flat(uniforms.get(u.name, u.default), u.type) for u in module.uniforms
        }
        self._uniforms |= known or {}
        self._resources = resources
        self._constant_resources = {r.name: r.values for r in module.resources if r.values}
        self._frame: Environment = {}
        self._steps = 0
        for name, value in module.frame:
            self._frame[name] = _BodyFollower(self, {}).expression(value)

    def function(self, function: Function, args: Sequence[Scalars_]) -> Scalars_:
        """Return the result of a call."""
        names = (p.name for p in function.params)
        body = _BodyFollower(self, dict(zip(names, args, strict=True)))
        result = body.block(function.body)
        assert result is not None, function.name
        return result

    def step(self) -> None:
        """Count a statement or a call."""
        self._steps += 1
        if self._steps > _MOST_STEPS:
            raise TapeError(f"it takes more than {_MOST_STEPS} steps")

    def call(self, name: str, args: Sequence[Scalars_]) -> Scalars_:
        """Return the result of a call by name."""
        self.step()
        return self.function(self._functions[name], args)

    def uniform(self, name: str) -> Scalars_:
        """Return the value of a uniform."""
        return self._uniforms[name]

    def per_frame(self, name: str) -> Scalars_:
        """Return a value of the per-frame part."""
        return self._frame[name]

    def element(self, name: str, index: int, type: Type) -> Scalars_:
        """Return an element of a buffer."""
        rows = self._constant_resources.get(name)
        if rows is None:
            rows = self._resources.get(name)
        if rows is None:
            raise TapeError(f"it reads '{name}', whose numbers are not known")
        return _flat(rows[min(max(index, 0), len(rows) - 1)], type)

    def size(self, name: str) -> int:
        """Return the number of elements of a buffer."""
        rows = self._constant_resources.get(name, self._resources.get(name))
        if rows is None:
            raise TapeError(f"it reads the size of '{name}', which is not known")
        return len(rows)


def _flat(value: Any, type: Type) -> Scalars_:
    """Return the scalars of a value from outside."""
    numbers = np.asarray(value).reshape(-1).tolist()
    convert: dict[Kind, Callable[[Any], Scalar]]
    convert = {Kind.FLOAT: float, Kind.INT: int, Kind.UINT: int, Kind.BOOL: bool}
    return tuple(convert[k](n) for k, n in zip(leaf_kinds(type), numbers, strict=True))


class _BodyFollower:
    """Follows the statements of one function, with the values of its locals."""

    def __init__(self, walker: _CallFollower, locals: Environment) -> None:
        self._walker = walker
        self._scalars = walker.scalars
        self._locals = locals
        # Expressions are shared: each is computed once, until a local changes.
        self._known: dict[Expr, Scalars_] = {}

    # Statements

    def block(self, body: Sequence[Stmt]) -> Scalars_ | None:
        """Follow statements; return the function's result if they end with it."""
        for i, stmt in enumerate(body):
            self._walker.step()
            match stmt:
                case Let(name, value) | Var(name, value):
                    self._locals[name] = self.expression(value)
                case Assign(target, value):
                    self._assign(target, self.expression(value))
                case Return(value):
                    return self.expression(value)
                case If():
                    if (result := self._if(stmt, body[i + 1 :])) is not None:
                        return result[0]
                case For():
                    self._for(stmt)
                case While():
                    raise TapeError("it has a loop whose length differs from point to point")
                case Break() | Continue():
                    raise TapeError("it leaves a loop early")
                case _:
                    assert_never(stmt)
        return None

    def _if(self, stmt: If, rest: Sequence[Stmt]) -> tuple[Scalars_ | None] | None:
        """Follow a condition; return the result of the function if ``rest`` is followed too."""
        (condition,) = self.expression(stmt.condition)
        if not isinstance(condition, Varying):
            return (self.block((*(stmt.then if condition else stmt.otherwise), *rest)),)
        if any(isinstance(s, Return) for s in statements_in((stmt,))):
            results = []
            for branch in (stmt.then, stmt.otherwise):
                result = self._copy().block((*branch, *rest))
                assert result is not None
                results.append(result)
            return (self._either(condition, results[0], results[1]),)
        copies = self._copy(), self._copy()
        for branch, copy in zip((stmt.then, stmt.otherwise), copies, strict=True):
            copy.block(branch)
        for name in self._locals:
            yes, no = (copy._locals[name] for copy in copies)
            if yes is not no:
                self._locals[name] = self._either(condition, yes, no)
        self._known.clear()
        return None

    def _copy(self) -> _BodyFollower:
        copy = _BodyFollower(self._walker, dict(self._locals))
        copy._known = dict(self._known)
        return copy

    def _either(self, condition: Scalar, yes: Scalars_, no: Scalars_) -> Scalars_:
        pairs = zip(yes, no, strict=True)
        return tuple(self._scalars.select(condition, a, b) for a, b in pairs)

    def _for(self, loop: For) -> None:
        (start,), (stop,) = self.expression(loop.start), self.expression(loop.stop)
        if isinstance(start, Varying) or isinstance(stop, Varying):
            raise TapeError("it has a loop whose length differs from point to point")
        for index in range(int(start), int(stop), loop.step):
            self._walker.step()
            self._locals[loop.name] = (index,)
            self._known.clear()
            self.block(loop.body)
        self._known.clear()

    def _assign(self, target: Expr, value: Scalars_) -> None:
        name, places = self._places(target)
        scalars = list(self._locals[name])
        for place, scalar in zip(places, value, strict=True):
            scalars[place] = scalar
        self._locals[name] = tuple(scalars)
        self._known.clear()

    def _places(self, target: Expr) -> tuple[str, Sequence[int]]:
        """Return the local that a target is a part of, and the positions of its scalars."""
        match target:
            case Read(name, type):
                return name, range(leaf_count(type))
            case Swizzle(base, lanes):
                name, places = self._places(base)
                return name, [places["xyzw".index(lane)] for lane in lanes]
            case Field(base, field):
                name, places = self._places(base)
                assert isinstance(base.type, Struct)
                first = field_offset(base.type, field)
                return name, places[first : first + leaf_count(target.type)]
            case Index(base, index):
                name, places = self._places(base)
                size = leaf_count(target.type)
                first = self._position(index) * size
                return name, places[first : first + size]
            case _:
                raise AssertionError(f"{target} is no target")

    def _position(self, index: Expr) -> int:
        (position,) = self.expression(index)
        if isinstance(position, Varying):
            raise TapeError("it reads a table at a place that differs from point to point")
        return int(position)

    # Expressions

    def expression(self, e: Expr) -> Scalars_:
        """Return the scalars of an expression."""
        known = self._known.get(e)
        if known is None:
            known = self._known[e] = self._computed(e)
        return known

    def _computed(self, e: Expr) -> Scalars_:
        match e:
            case Const(value):
                return (value,)
            case Read(name):
                return self._locals[name]
            case Uniform(name):
                return self._walker.uniform(name)
            case PerFrame(name):
                return self._walker.per_frame(name)
            case Unary(op, operand):
                kind = _kind(e.type)
                return tuple(self._scalars.unary(op, a, kind) for a in self.expression(operand))
            case Binary(op, lhs, rhs):
                kind = _kind(e.type)
                both = zip(self.expression(lhs), self.expression(rhs), strict=True)
                return tuple(self._scalars.binary(op, a, b, kind) for a, b in both)
            case Compare(order, lhs, rhs):
                both = zip(self.expression(lhs), self.expression(rhs), strict=True)
                return tuple(self._scalars.compare(order, a, b) for a, b in both)
            case Logical(logical, lhs, rhs):
                (a,), (b,) = self.expression(lhs), self.expression(rhs)
                join = self._scalars.both if logical is LogicalOp.AND else self._scalars.either
                return (join(a, b),)
            case Select(condition, yes, no):
                return self._selected(self.expression(condition), yes, no)
            case Splat(value):
                return self.expression(value) * leaf_count(e.type)
            case Compose(parts) | Construct(parts):
                return tuple(s for part in parts for s in self.expression(part))
            case Swizzle(base, lanes):
                scalars = self.expression(base)
                return tuple(scalars["xyzw".index(lane)] for lane in lanes)
            case Field(base, name):
                assert isinstance(base.type, Struct)
                first = field_offset(base.type, name)
                return self.expression(base)[first : first + leaf_count(e.type)]
            case Cast(value):
                kinds = _kind(value.type), _kind(e.type)
                return tuple(self._scalars.cast(a, *kinds) for a in self.expression(value))
            case Call(function, args):
                return self._walker.call(function, [self.expression(a) for a in args])
            case Index(base, index):
                return self._indexed(base, index, e.type)
            case MatMul(lhs, rhs):
                return self._product(lhs, rhs)
            case Builtin(name, args):
                return self._builtin(name, args)
            case Size(resource):
                if isinstance(resource, Resource) and isinstance(resource.type, BufferType):
                    return (self._walker.size(resource.name),)
                raise TapeError("it reads a texture")
            case Sample() | Texel():
                raise TapeError("it reads a texture")
            case Resource() | FunctionRef() | Apply() | Gradient():
                raise TapeError(f"it has a {type(e).__name__}, which tapes do not have")
            case _:
                assert_never(e)

    def _selected(self, conditions: Scalars_, yes: Expr, no: Expr) -> Scalars_:
        if len(conditions) == 1 and not isinstance(conditions[0], Varying):
            return self.expression(yes if conditions[0] else no)
        a, b = self.expression(yes), self.expression(no)
        if len(conditions) == 1:
            conditions = conditions * len(a)
        return tuple(map(self._scalars.select, conditions, a, b))

    def _indexed(self, base: Expr, index: Expr, type: Type) -> Scalars_:
        position = self._position(index)
        if isinstance(base, Resource):
            return self._walker.element(base.name, position, type)
        assert isinstance(base.type, Array | Vector | Matrix)
        size = leaf_count(type)
        first = min(max(position, 0), leaf_count(base.type) // size - 1) * size
        return self.expression(base)[first : first + size]

    def _product(self, lhs: Expr, rhs: Expr) -> Scalars_:
        """Return a matrix product; the scalars of a matrix are in the order of its columns."""
        a, b = self.expression(lhs), self.expression(rhs)
        if isinstance(lhs.type, Matrix):
            n = lhs.type.size
            rows = [[a[column * n + row] for column in range(n)] for row in range(n)]
        else:
            n = len(a)
            rows = [list(a)]
        columns = [b[at : at + n] for at in range(0, len(b), n)]
        return tuple(self._dot(row, column) for column in columns for row in rows)

    def _dot(self, a: Sequence[Scalar], b: Sequence[Scalar]) -> Scalar:
        binary = self._scalars.binary
        total: Scalar | None = None
        for x, y in zip(a, b, strict=True):
            product = binary(BinaryOp.MUL, x, y, Kind.FLOAT)
            first = total is None
            total = product if first else binary(BinaryOp.ADD, total or 0.0, product, Kind.FLOAT)
        return 0.0 if total is None else total

    def _builtin(self, name: str, args: Sequence[Expr]) -> Scalars_:
        values = [self.expression(a) for a in args]
        first = values[0]
        match name:
            case "dot":
                return (self._dot(first, values[1]),)
            case "length":
                return (self._scalars.builtin("sqrt", [self._dot(first, first)], Kind.FLOAT),)
            case "cross":
                return self._cross(first, values[1])
            case "any" | "all":
                join = self._scalars.either if name == "any" else self._scalars.both
                joined = first[0]
                for scalar in first[1:]:
                    joined = join(joined, scalar)
                return (joined,)
            case "transpose":
                (matrix,) = (a.type for a in args)
                assert isinstance(matrix, Matrix)
                n = matrix.size
                return tuple(first[row * n + column] for column in range(n) for row in range(n))
            case _:
                kind = _kind(args[0].type)
                rows = zip(*values, strict=True)
                return tuple(self._scalars.builtin(name, row, kind) for row in rows)

    def _cross(self, a: Scalars_, b: Scalars_) -> Scalars_:
        def minor(i: int, j: int) -> Scalar:
            binary = self._scalars.binary
            plus = binary(BinaryOp.MUL, a[i], b[j], Kind.FLOAT)
            return binary(
                BinaryOp.SUB, plus, binary(BinaryOp.MUL, a[j], b[i], Kind.FLOAT), Kind.FLOAT
            )

        return minor(1, 2), minor(2, 0), minor(0, 1)


def _kind(type: Type) -> Kind:
    kind = kind_of(type)
    if kind is None:
        refuse_whole_numbers()
    return kind
