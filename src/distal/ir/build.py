"""Making expressions whose type follows from their operands. Scalars are splatted as needed."""

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
    """A constant of a scalar type, or of a vector or matrix type with equal components."""
    kind = kind_of(type)
    assert kind is not None
    converted = {Kind.FLOAT: float, Kind.INT: int, Kind.UINT: int, Kind.BOOL: bool}[kind](value)
    return splat(Const(converted, Scalar(kind)), type)


def integer(value: int) -> Expr:
    """An int constant."""
    return Const(value, INT)


def unsigned(value: int) -> Expr:
    """A uint constant."""
    return Const(value, UINT)


def boolean(value: bool) -> Expr:
    """A bool constant."""
    return Const(value, BOOL)


def read(name: str, type: Type) -> Expr:
    """A read of a local."""
    return Read(name, type)


def splat(value: Expr, type: Type) -> Expr:
    """``value`` widened to ``type``; itself when it already has it."""
    return value if value.type is type else Splat(value, type)


def widen(lhs: Expr, rhs: Expr) -> tuple[Expr, Expr]:
    """Splat a scalar beside a vector or matrix."""
    if isinstance(lhs.type, Scalar):
        return splat(lhs, rhs.type), rhs
    return lhs, splat(rhs, lhs.type)


def binary(op: BinaryOp, lhs: Expr, rhs: Expr) -> Expr:
    """``lhs op rhs``, a scalar side splatted."""
    lhs, rhs = widen(lhs, rhs)
    return Binary(op, lhs, rhs, lhs.type)


def add(lhs: Expr, rhs: Expr) -> Expr:
    """Sum."""
    return binary(BinaryOp.ADD, lhs, rhs)


def subtract(lhs: Expr, rhs: Expr) -> Expr:
    """Difference."""
    return binary(BinaryOp.SUB, lhs, rhs)


def multiply(lhs: Expr, rhs: Expr) -> Expr:
    """Product, component by component."""
    return binary(BinaryOp.MUL, lhs, rhs)


def divide(lhs: Expr, rhs: Expr) -> Expr:
    """Quotient of floats."""
    return binary(BinaryOp.DIV, lhs, rhs)


def negate(operand: Expr) -> Expr:
    """``-operand``."""
    return Unary(UnaryOp.NEGATE, operand, operand.type)


def negation(operand: Expr) -> Expr:
    """``not operand``."""
    return Unary(UnaryOp.NOT, operand, operand.type)


def matmul(lhs: Expr, rhs: Expr) -> Expr:
    """Matrix product."""
    return MatMul(lhs, rhs, rhs.type if isinstance(lhs.type, Matrix) else lhs.type)


def compare(op: CompareOp, lhs: Expr, rhs: Expr) -> Expr:
    """``lhs op rhs``: bool, or a bvec."""
    lhs, rhs = widen(lhs, rhs)
    return Compare(op, lhs, rhs, with_kind(lhs.type, Kind.BOOL))


def both(lhs: Expr, rhs: Expr) -> Expr:
    """``lhs and rhs`` of bools."""
    return Logical(LogicalOp.AND, lhs, rhs, BOOL)


def either(lhs: Expr, rhs: Expr) -> Expr:
    """``lhs or rhs`` of bools."""
    return Logical(LogicalOp.OR, lhs, rhs, BOOL)


def select(condition: Expr, yes: Expr, no: Expr) -> Expr:
    """``yes if condition else no``."""
    return Select(condition, yes, no, yes.type)


def compose(type: Type, *parts: Expr) -> Expr:
    """A vector from components, a matrix from columns."""
    return Compose(parts, type)


def swizzle(base: Expr, lanes: str) -> Expr:
    """``base.xy``."""
    assert isinstance(base.type, Vector)
    return Swizzle(base, lanes, vector_of(base.type.kind, len(lanes)))


def components(value: Expr) -> tuple[Expr, ...]:
    """The scalars of a scalar or vector."""
    if isinstance(value.type, Scalar):
        return (value,)
    assert isinstance(value.type, Vector)
    return tuple(swizzle(value, lane) for lane in "xyzw"[: value.type.size])


def literal_components(e: Expr) -> tuple[bool | int | float, ...] | None:
    """The numbers of a literal scalar, vector or matrix; None for what is no literal."""
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
    """The type that an index into ``type`` gives."""
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
    """``base[position]``."""
    return Index(base, position, element_type(base.type))


def field(base: Expr, name: str) -> Expr:
    """``base.name``."""
    assert isinstance(base.type, Struct)
    found = base.type.field(name)
    assert found is not None, f"{base.type} has no {name}"
    return Field(base, name, found)


def cast(value: Expr, kind: Kind) -> Expr:
    """The value with components of another kind; itself when it has them."""
    type = with_kind(value.type, kind)
    return value if value.type is type else Cast(value, type)


def builtin(name: str, *args: Expr) -> Expr:
    """A call of an intrinsic; the arguments have exactly the types of one signature."""
    types = [a.type for a in args]
    for signature in INTRINSICS[name].signatures:
        result = signature.match(types)
        if result is not None:
            return Builtin(name, args, result)
    raise AssertionError(f"{name} does not take {', '.join(map(str, types))}")
