"""Arithmetic on tangents (the derivatives of values along one direction), keeping them sparse.

Input and output: values (expressions) and tangents. A tangent is an expression of the value's type,
or None for a tangent that is zero in every component. The int and bool parts of a tangent are zero.
Most tangents in a distance field are sparse, such as (1, 0, 0) times a factor; the functions here
detect the zeros, so that a derivative does not multiply by them. Derivatives therefore treat 0 * x
as 0 for every x, including infinity and NaN.
"""

from __future__ import annotations

from typing import TypeAlias

from distal.ir.nodes import (
    Binary,
    BinaryOp,
    Builtin,
    Compare,
    CompareOp,
    Compose,
    Const,
    Construct,
    Expr,
    Field,
    Index,
    MatMul,
    Select,
    Splat,
    Swizzle,
    Unary,
    UnaryOp,
)
from distal.ir.types import (
    BOOL,
    FLOAT,
    Array,
    Kind,
    Matrix,
    Scalar,
    Struct,
    Type,
    Vector,
    vector_of,
    with_kind,
)

Tangent: TypeAlias = Expr | None
Lanes: TypeAlias = tuple[Tangent, ...]

LETTERS = "xyzw"


def has_floats(type: Type) -> bool:
    """Return whether values of the type have a float part, so that they can have a derivative."""
    match type:
        case Scalar(kind) | Vector(kind):
            return kind is Kind.FLOAT
        case Matrix():
            return True
        case Struct(_, fields):
            return any(has_floats(t) for _, t in fields)
        case Array(element):
            return has_floats(element)
        case _:
            return False


def zero(type: Type) -> Expr:
    """Return the value of a type with zero in every part.

    Raises:
        AssertionError: The type is not a value type.
    """
    match type:
        case Scalar(kind):
            return Const({Kind.FLOAT: 0.0, Kind.BOOL: False}.get(kind, 0), type)
        case Vector(kind):
            return Splat(zero(Scalar(kind)), type)
        case Matrix(size):
            return Compose((zero(Vector(Kind.FLOAT, size)),) * size, type)
        case Struct(_, fields):
            return Construct(tuple(zero(t) for _, t in fields), type)
        case Array(element, length):
            return Construct((zero(element),) * length, type)
        case _:
            raise AssertionError(f"no zero of {type}")


def seeds(type: Type) -> tuple[Expr, ...]:
    """Return the tangents of a point along its coordinate axes (the unit vectors)."""
    if type is FLOAT:
        return (Const(1.0, FLOAT),)
    assert isinstance(type, Vector)
    ones = [[float(i == k) for i in range(type.size)] for k in range(type.size)]
    return tuple(Compose(tuple(Const(v, FLOAT) for v in row), type) for row in ones)


def filled(tangent: Tangent, type: Type) -> Expr:
    """Return the tangent as an expression: a zero tangent is written out as zeros."""
    return zero(type) if tangent is None else tangent


def number(value: float, type: Type) -> Expr:
    """Return a float constant in every component."""
    constant = Const(value, FLOAT)
    return constant if type is FLOAT else Splat(constant, type)


def constant_of(e: Expr) -> float | None:
    """Return the number that every component has if it is a constant, else None."""
    match e:
        case Const(value) if e.type is FLOAT:
            return float(value)
        case Splat(value):
            return constant_of(value)
        case _:
            return None


def is_constant(e: Expr) -> bool:
    """Return whether a scalar or vector consists of literal numbers only."""
    match e:
        case Const():
            return True
        case Splat(value):
            return is_constant(value)
        case Compose(parts):
            return all(map(is_constant, parts))
        case _:
            return False


def binary(op: BinaryOp, lhs: Expr, rhs: Expr) -> Expr:
    """Return ``lhs op rhs`` of values; if one side is a scalar, it is splatted.

    Args:
        op: The operator.
        lhs: The left operand.
        rhs: The right operand.
    """
    if lhs.type is not rhs.type:
        if isinstance(lhs.type, Scalar):
            lhs = Splat(lhs, rhs.type)
        else:
            rhs = Splat(rhs, lhs.type)
    return Binary(op, lhs, rhs, lhs.type)


def product(lhs: Expr, rhs: Expr) -> Expr:
    """Return the product of two values, component by component."""
    for one, other in ((lhs, rhs), (rhs, lhs)):
        value = constant_of(one)
        if value in (1.0, -1.0) and (one.type is other.type or one.type is FLOAT):
            return other if value == 1.0 else Unary(UnaryOp.NEGATE, other, other.type)
    if isinstance(lhs, Splat) and isinstance(rhs, Splat):
        return Splat(product(lhs.value, rhs.value), lhs.type)
    return binary(BinaryOp.MUL, lhs, rhs)


def compared(op: CompareOp, lhs: Expr, rhs: Expr) -> Expr:
    """Return ``lhs op rhs`` of values of one type.

    Args:
        op: The comparison.
        lhs: The left operand.
        rhs: The right operand.
    """
    return Compare(op, lhs, rhs, with_kind(lhs.type, Kind.BOOL))


def where_positive(test: Expr, value: Expr) -> Expr:
    """Return ``value`` where ``test > 0``, else 0: guards a derivative at the ends of a domain."""
    return where_above(test, 0.0, value)


def where_above(test: Expr, end: float, value: Expr) -> Expr:
    """Return ``value`` where ``test > end``, else 0.

    Args:
        test: The value that is compared.
        end: The limit.
        value: The result above the limit, of the same type as ``test``.
    """
    none = zero(value.type)
    return Select(compared(CompareOp.GT, test, number(end, test.type)), value, none, value.type)


def lanes_of(tangent: Tangent) -> Lanes | None:
    """Return the components of a vector tangent if at least one is known to be zero, else None."""
    if not isinstance(tangent, Compose) or not isinstance(tangent.type, Vector):
        return None
    if not all(isinstance(p.type, Scalar) for p in tangent.parts):
        return None
    found = tuple(None if constant_of(p) == 0.0 else p for p in tangent.parts)
    return found if None in found else None


def from_lanes(lanes: Lanes, type: Type) -> Tangent:
    """Return a vector tangent built from its components."""
    if all(lane is None for lane in lanes):
        return None
    return Compose(tuple(filled(lane, FLOAT) for lane in lanes), type)


def lane(value: Expr, i: int) -> Expr:
    """Return component ``i`` of a vector value."""
    assert isinstance(value.type, Vector)
    if isinstance(value, Splat):
        return value.value
    if isinstance(value, Compose) and len(value.parts) == value.type.size:
        return value.parts[i]
    if isinstance(value, Compare):
        return compared(value.op, lane(value.lhs, i), lane(value.rhs, i))
    return Swizzle(value, LETTERS[i], Scalar(value.type.kind))


def plus(a: Tangent, b: Tangent) -> Tangent:
    """Return the sum ``a + b``."""
    if a is None or b is None:
        return b if a is None else a
    left, right = lanes_of(a), lanes_of(b)
    if left is not None and right is not None:
        return from_lanes(tuple(map(plus, left, right)), a.type)
    if isinstance(a, Splat) and isinstance(b, Splat):
        inner = plus(a.value, b.value)
        assert inner is not None
        return Splat(inner, a.type)
    return Binary(BinaryOp.ADD, a, b, a.type)


def minus(a: Tangent, b: Tangent) -> Tangent:
    """Return the difference ``a - b``."""
    if b is None:
        return a
    if a is None:
        return negative(b)
    left, right = lanes_of(a), lanes_of(b)
    if left is not None and right is not None:
        return from_lanes(tuple(map(minus, left, right)), a.type)
    return Binary(BinaryOp.SUB, a, b, a.type)


def negative(a: Tangent) -> Tangent:
    """Return ``-a``."""
    if a is None:
        return None
    lanes = lanes_of(a)
    if lanes is not None:
        return from_lanes(tuple(map(negative, lanes)), a.type)
    match a:
        case Const(value):
            return Const(-value, a.type)
        case Unary(UnaryOp.NEGATE, operand):
            return operand
        case _:
            return Unary(UnaryOp.NEGATE, a, a.type)


def scaled(a: Tangent, factor: Expr) -> Tangent:
    """Return the product with a value, component by component; a scalar factor is splatted."""
    if a is None or constant_of(factor) == 0.0:
        return None
    lanes = lanes_of(a)
    if lanes is None:
        if factor.type is not a.type and isinstance(factor.type, Vector):
            a = Splat(a, factor.type)
        return product(a, factor)
    scalar = isinstance(factor.type, Scalar)
    factors = [factor if scalar else lane(factor, i) for i in range(len(lanes))]
    return from_lanes(tuple(map(scaled, lanes, factors)), a.type)


def over(a: Tangent, divisor: Expr) -> Tangent:
    """Return the quotient by a value, component by component; a scalar divisor is splatted."""
    if a is None:
        return None
    lanes = lanes_of(a)
    if lanes is None:
        return binary(BinaryOp.DIV, a, divisor)
    scalar = isinstance(divisor.type, Scalar)
    divisors = [divisor if scalar else lane(divisor, i) for i in range(len(lanes))]
    return from_lanes(tuple(map(over, lanes, divisors)), a.type)


def splatted(a: Tangent, type: Type) -> Tangent:
    """Return the vector or matrix tangent with the same tangent in every component."""
    return None if a is None else Splat(a, type)


def picked(condition: Expr, yes: Tangent, no: Tangent, type: Type) -> Tangent:
    """Return ``yes`` where the condition holds, else ``no``.

    Args:
        condition: A bool, or a bvec that selects component by component.
        yes: The tangent where the condition holds.
        no: The tangent where it does not.
        type: The type of the result.
    """
    if yes is no:
        return yes
    left, right = _sparse(yes, type), _sparse(no, type)
    if left is None or right is None:
        return Select(condition, filled(yes, type), filled(no, type), type)
    whole = condition.type is BOOL
    conditions = [condition if whole else lane(condition, i) for i in range(len(left))]
    triples = zip(conditions, left, right, strict=True)
    return from_lanes(tuple(picked(c, y, n, FLOAT) for c, y, n in triples), type)


def _sparse(tangent: Tangent, type: Type) -> Lanes | None:
    if tangent is None and isinstance(type, Vector):
        return (None,) * type.size
    return lanes_of(tangent)


def inner(value: Expr, a: Tangent) -> Tangent:
    """Return the inner product of a vector value with a tangent."""
    lanes = lanes_of(a)
    if lanes is not None:
        total: Tangent = None
        for i, part in enumerate(lanes):
            total = plus(total, scaled(part, lane(value, i)))
        return total
    return None if a is None else Builtin("dot", (value, a), FLOAT)


def composed(parts: tuple[Expr, ...], tangents: Lanes, type: Type) -> Tangent:
    """Return the tangent of a vector or matrix built from ``parts``.

    Args:
        parts: The scalars and vectors, or the columns.
        tangents: The tangent of each part.
        type: The type of the vector or matrix.
    """
    if all(t is None for t in tangents):
        return None
    whole = tuple(filled(t, p.type) for p, t in zip(parts, tangents, strict=True))
    if isinstance(type, Matrix) or not any(t is None or lanes_of(t) for t in tangents):
        return Compose(whole, type)
    spread: list[Tangent] = []
    for part, tangent in zip(parts, tangents, strict=True):
        if not isinstance(part.type, Vector):
            spread.append(tangent)
            continue
        known = _sparse(tangent, part.type)
        if known is None:
            assert tangent is not None
            known = tuple(lane(tangent, i) for i in range(part.type.size))
        spread.extend(known)
    return from_lanes(tuple(spread), type)


def swizzled(a: Tangent, letters: str) -> Tangent:
    """Return the tangent of a swizzle, ``a.letters``."""
    if a is None:
        return None
    type = vector_of(Kind.FLOAT, len(letters))
    if isinstance(a, Splat):
        return a.value if len(letters) == 1 else Splat(a.value, type)
    if isinstance(a, Compose) and all(isinstance(p.type, Scalar) for p in a.parts):
        parts = [a.parts[LETTERS.index(c)] for c in letters]
        found = tuple(None if constant_of(p) == 0.0 else p for p in parts)
        return found[0] if len(letters) == 1 else from_lanes(found, type)
    return Swizzle(a, letters, type)


def element(a: Tangent, position: Expr, type: Type) -> Tangent:
    """Return ``a[position]`` of an array, vector or matrix.

    Args:
        a: The tangent of the array, vector or matrix.
        position: The index, an int.
        type: The type of the element.
    """
    return None if a is None else Index(a, position, type)


def member(a: Tangent, name: str, type: Type) -> Tangent:
    """Return ``a.name`` of a struct's tangent; None if the field has no float part.

    Args:
        a: The tangent of the struct.
        name: The field's name.
        type: The field's type.
    """
    if a is None or not has_floats(type):
        return None
    if isinstance(a, Construct):
        assert isinstance(a.type, Struct)
        return a.parts[[n for n, _ in a.type.fields].index(name)]
    return Field(a, name, type)


def matrix_product(lhs: Expr, rhs: Expr, type: Type) -> Expr:
    """Return ``lhs @ rhs``.

    Args:
        lhs: The left matrix or vector.
        rhs: The right matrix or vector.
        type: The type of the product.
    """
    return MatMul(lhs, rhs, type)
