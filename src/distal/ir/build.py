"""Build expressions whose type follows from their operands. Scalars are splatted as needed."""

from __future__ import annotations

from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import (
    Binary,
    BinaryOp,
    Builtin,
    Cast,
    Compare,
    CompareOp,
    Compose,
    Const,
    Expr,
    Field,
    Index,
    Logical,
    LogicalOp,
    MatMul,
    Read,
    Select,
    Splat,
    Swizzle,
    Unary,
    UnaryOp,
)
from distal.ir.types import (
    BOOL,
    FLOAT,
    INT,
    UINT,
    Array,
    Buffer,
    Kind,
    Matrix,
    Scalar,
    Struct,
    Type,
    Vector,
    component_count,
    kind_of,
    vector_of,
    with_kind,
)


def number(value: float, type: Type = FLOAT) -> Expr:
    """Return a constant of a scalar type, or of a vector or matrix type with equal components."""
    kind = kind_of(type)
    assert kind is not None
    converted = {Kind.FLOAT: float, Kind.INT: int, Kind.UINT: int, Kind.BOOL: bool}[kind](value)
    return splat(Const(converted, Scalar(kind)), type)


def integer(value: int) -> Expr:
    """Return an int constant."""
    return Const(value, INT)


def unsigned(value: int) -> Expr:
    """Return a uint constant."""
    return Const(value, UINT)


def boolean(value: bool) -> Expr:
    """Return a bool constant."""
    return Const(value, BOOL)


def read(name: str, type: Type) -> Expr:
    """Return a read of a local or parameter."""
    return Read(name, type)


def splat(value: Expr, type: Type) -> Expr:
    """Return ``value`` splatted to ``type``, or ``value`` itself when it already has that type."""
    return value if value.type is type else Splat(value, type)


def widen(lhs: Expr, rhs: Expr) -> tuple[Expr, Expr]:
    """Return both operands with one type: a scalar is splatted to the other operand's type."""
    if isinstance(lhs.type, Scalar):
        return splat(lhs, rhs.type), rhs
    return lhs, splat(rhs, lhs.type)


def binary(op: BinaryOp, lhs: Expr, rhs: Expr) -> Expr:
    """Return ``lhs op rhs``; if one side is a scalar, it is splatted to the other side's type.

    Args:
        op: The operator.
        lhs: The left operand.
        rhs: The right operand.
    """
    lhs, rhs = widen(lhs, rhs)
    return Binary(op, lhs, rhs, lhs.type)


def add(lhs: Expr, rhs: Expr) -> Expr:
    """Return ``lhs + rhs``."""
    return binary(BinaryOp.ADD, lhs, rhs)


def subtract(lhs: Expr, rhs: Expr) -> Expr:
    """Return ``lhs - rhs``."""
    return binary(BinaryOp.SUB, lhs, rhs)


def multiply(lhs: Expr, rhs: Expr) -> Expr:
    """Return ``lhs * rhs``, component by component."""
    return binary(BinaryOp.MUL, lhs, rhs)


def divide(lhs: Expr, rhs: Expr) -> Expr:
    """Return ``lhs / rhs`` of floats."""
    return binary(BinaryOp.DIV, lhs, rhs)


def negate(operand: Expr) -> Expr:
    """Return ``-operand``."""
    return Unary(UnaryOp.NEGATE, operand, operand.type)


def negation(operand: Expr) -> Expr:
    """Return ``not operand``."""
    return Unary(UnaryOp.NOT, operand, operand.type)


def matmul(lhs: Expr, rhs: Expr) -> Expr:
    """Return the matrix product ``lhs @ rhs``."""
    return MatMul(lhs, rhs, rhs.type if isinstance(lhs.type, Matrix) else lhs.type)


def compare(op: CompareOp, lhs: Expr, rhs: Expr) -> Expr:
    """Return ``lhs op rhs``: a bool, or a bvec with one bool for each component.

    Args:
        op: The comparison.
        lhs: The left operand.
        rhs: The right operand.
    """
    lhs, rhs = widen(lhs, rhs)
    return Compare(op, lhs, rhs, with_kind(lhs.type, Kind.BOOL))


def both(lhs: Expr, rhs: Expr) -> Expr:
    """Return ``lhs and rhs`` of bools."""
    return Logical(LogicalOp.AND, lhs, rhs, BOOL)


def either(lhs: Expr, rhs: Expr) -> Expr:
    """Return ``lhs or rhs`` of bools."""
    return Logical(LogicalOp.OR, lhs, rhs, BOOL)


def select(condition: Expr, yes: Expr, no: Expr) -> Expr:
    """Return ``yes if condition else no``.

    Args:
        condition: A bool, or a bvec that selects component by component.
        yes: The value where the condition is true.
        no: The value where it is false, of the same type.
    """
    return Select(condition, yes, no, yes.type)


def compose(type: Type, *parts: Expr) -> Expr:
    """Return a vector built from its components, or a matrix built from its columns."""
    return Compose(parts, type)


def swizzle(base: Expr, lanes: str) -> Expr:
    """Return the given components of a vector, such as ``base.xy``."""
    assert isinstance(base.type, Vector)
    return Swizzle(base, lanes, vector_of(base.type.kind, len(lanes)))


def components(value: Expr) -> tuple[Expr, ...]:
    """Return the scalar components of a scalar or vector."""
    if isinstance(value.type, Scalar):
        return (value,)
    assert isinstance(value.type, Vector)
    return tuple(swizzle(value, lane) for lane in "xyzw"[: value.type.size])


def literal_components(e: Expr) -> tuple[bool | int | float, ...] | None:
    """Return the numbers of a literal scalar, vector or matrix; None if ``e`` is not a literal."""
    match e:
        case Const(value):
            return (value,)
        case Splat(value, type):
            one = literal_components(value)
            return one and one * component_count(type)
        case Compose(parts):
            found = [literal_components(part) for part in parts]
            if any(numbers is None for numbers in found):
                return None
            return tuple(number for numbers in found if numbers is not None for number in numbers)
        case _:
            return None


def element_type(type: Type) -> Type:
    """Return the type of ``base[index]`` for a base of type ``type``.

    Raises:
        AssertionError: The type cannot be indexed.
    """
    match type:
        case Array(element) | Buffer(element):
            return element
        case Vector(kind):
            return Scalar(kind)
        case Matrix(size):
            return Vector(Kind.FLOAT, size)
        case _:
            raise AssertionError(f"{type} takes no index")


def index(base: Expr, position: Expr) -> Expr:
    """Return ``base[position]``."""
    return Index(base, position, element_type(base.type))


def field(base: Expr, name: str) -> Expr:
    """Return ``base.name``."""
    assert isinstance(base.type, Struct)
    found = base.type.field(name)
    assert found is not None, f"{base.type} has no {name}"
    return Field(base, name, found)


def cast(value: Expr, kind: Kind) -> Expr:
    """Convert the components to ``kind``; return ``value`` itself when they already are."""
    type = with_kind(value.type, kind)
    return value if value.type is type else Cast(value, type)


def builtin(name: str, *args: Expr) -> Expr:
    """Return a call of an intrinsic whose argument types match one of its signatures exactly.

    Raises:
        AssertionError: No signature has these argument types.
    """
    types = [a.type for a in args]
    for signature in INTRINSICS[name].signatures:
        result = signature.match(types)
        if result is not None:
            return Builtin(name, args, result)
    raise AssertionError(f"{name} does not take {', '.join(map(str, types))}")
