"""Follow expressions of the IR: their scalars are constants, or values of a tape.

Input: expressions, the values of locals, and the program around them. Output: scalars. Does not
depend on statements.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, TypeAlias, assert_never

from distal.backends.llvm.lanes import field_offset, leaf_count
from distal.ir.nodes import (
    Apply,
    Binary,
    BinaryOp,
    Builtin,
    Call,
    Cast,
    Compare,
    Compose,
    Const,
    Construct,
    Expr,
    Field,
    FunctionRef,
    Gradient,
    Index,
    Logical,
    LogicalOp,
    MatMul,
    PerFrame,
    Read,
    Resource,
    Sample,
    Select,
    Size,
    Splat,
    Swizzle,
    Texel,
    Unary,
    Uniform,
)
from distal.ir.types import Array, Kind, Matrix, Struct, Type, Vector, kind_of
from distal.ir.types import Buffer as BufferType
from distal.tape.scalars import Scalar, Scalars, Varying, refuse_whole_numbers
from distal.tape.tape import TapeError

# The scalars of a value, in the order of ``leaf_kinds``.
Scalars_: TypeAlias = tuple[Scalar, ...]
Environment: TypeAlias = dict[str, Scalars_]


class ProgramAround(Protocol):
    """The program around a function: what an expression reads that is not a local.

    Attributes:
        scalars: Collects the operations.
    """

    scalars: Scalars

    def call(self, name: str, args: Sequence[Scalars_]) -> Scalars_:
        """Return the result of a call by name."""

    def uniform(self, name: str) -> Scalars_:
        """Return the value of a uniform."""

    def per_frame(self, name: str) -> Scalars_:
        """Return a value of the per-frame part."""

    def element(self, name: str, index: int, type: Type) -> Scalars_:
        """Return an element of a buffer."""

    def size(self, name: str) -> int:
        """Return the number of elements of a buffer."""


class ExpressionFollower:
    """Follows the expressions of one function, with the values of its locals."""

    def __init__(self, walker: ProgramAround, locals: Environment) -> None:
        self._walker = walker
        self._scalars = walker.scalars
        self._locals = locals
        # Expressions are shared: each is computed once, until a local changes.
        self._known: dict[Expr, Scalars_] = {}

    def _position(self, index: Expr) -> int:
        (position,) = self.expression(index)
        if isinstance(position, Varying):
            raise TapeError("it reads a table at a place that differs from point to point")
        return int(position)

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
