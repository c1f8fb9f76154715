"""Define operators, conversions and indexing on NumPy arrays.

Input and output: values. A scalar is an array (n,), a vector (size, n), a matrix (columns, rows,
n). The last axis is the lanes (points or pixels); its length is 1 if all lanes have the same value.
A struct or array is a tuple of values. Does not depend on nodes except operators, on control flow
or on names.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final, TypeAlias, assert_never

import numpy as np
from numpy.typing import NDArray

from distal.ir.nodes import BinaryOp, CompareOp, UnaryOp
from distal.ir.types import Array, Kind, Matrix, Scalar, Struct, Type, Vector

Leaf: TypeAlias = NDArray[Any]
Value: TypeAlias = "Leaf | tuple[Value, ...]"

_INT_RANGE = (-(2.0**31), 2.0**31 - 1)
_UINT_RANGE = (0.0, 2.0**32 - 1)


def dtype_of(kind: Kind, precision: int) -> Any:
    """Return the NumPy type of a component."""
    match kind:
        case Kind.FLOAT:
            return np.float32 if precision == 32 else np.float64
        case Kind.INT:
            return np.int32
        case Kind.UINT:
            return np.uint32
        case Kind.BOOL:
            return np.bool_
        case _:
            assert_never(kind)


def each_leaf(change: Callable[..., Leaf], *values: Value) -> Value:
    """Combine values of the same type, array by array, including nested tuples."""
    first = values[0]
    if isinstance(first, tuple):
        return tuple(each_leaf(change, *parts) for parts in zip(*values, strict=True))
    return change(*values)


def width(value: Value) -> int:
    """Return the number of lanes of a value: 1 or the lanes of the run."""
    if isinstance(value, tuple):
        return max(width(part) for part in value)
    return int(value.shape[-1])


def gather(value: Value, lanes: NDArray[np.intp]) -> Value:
    """Return the value in some lanes."""
    return each_leaf(lambda leaf: leaf if leaf.shape[-1] == 1 else leaf[..., lanes], value)


def blank(value: Value) -> Value:
    """Return zeros of a value's type, the same in all lanes."""
    return each_leaf(lambda leaf: np.zeros_like(leaf[..., :1]), value)


def scatter(old: Value, lanes: NDArray[np.intp], new: Value, count: int) -> Value:
    """Return a value with some of its lanes replaced.

    Args:
        old: The value before.
        lanes: The positions of the lanes to replace.
        new: The value in these lanes.
        count: The number of lanes of the result.
    """

    def replaced(before: Leaf, after: Leaf) -> Leaf:
        whole = np.broadcast_to(before, (*before.shape[:-1], count)).copy()
        whole[..., lanes] = after
        return whole

    return each_leaf(replaced, old, new)


def choose(condition: Leaf, yes: Value, no: Value) -> Value:
    """Return ``yes`` in the lanes where the condition holds, else ``no``.

    Args:
        condition: A bool, or a bvec for each component.
        yes: The value if the condition holds.
        no: The value if it does not.
    """

    def chosen(a: Leaf, b: Leaf) -> Leaf:
        return np.where(condition, a, b)

    return each_leaf(chosen, yes, no)


def _is_float(a: Leaf) -> bool:
    return a.dtype.kind == "f"


def _floor_quotient(a: Leaf, b: Leaf) -> Leaf:
    if _is_float(a):
        return np.floor(a / b)
    # No quotient overflows in 64 bits; the conversion back wraps.
    divisor = np.where(b == 0, 1, b).astype(np.int64)
    return (a.astype(np.int64) // divisor).astype(a.dtype)


def _int_remainder(a: Leaf, b: Leaf) -> Leaf:
    divisor = np.where(b == 0, 1, b).astype(np.int64)
    return (a.astype(np.int64) % divisor).astype(a.dtype)


def _mod(a: Leaf, b: Leaf) -> Leaf:
    if not _is_float(a):
        return _int_remainder(a, b)
    zero = np.zeros_like(b)
    end = np.nextafter(b, zero)
    rest = a - b * _floor_quotient(a, b)
    held: Leaf = np.minimum(np.maximum(rest, np.minimum(end, zero)), np.maximum(end, zero))
    return held


def _shifted_left(a: Leaf, b: Leaf) -> Leaf:
    # Shift as unsigned: the highest bits are lost, including the sign.
    return (a.view(np.uint32) << (b.view(np.uint32) & np.uint32(31))).view(a.dtype)


def _shifted_right(a: Leaf, b: Leaf) -> Leaf:
    shifted: Leaf = a >> (b & b.dtype.type(31))
    return shifted


# The operators, component by component; both operands are of the same kind.
UNARY: Final[dict[UnaryOp, Callable[[Leaf], Leaf]]] = {
    UnaryOp.NEGATE: np.negative,
    UnaryOp.NOT: np.logical_not,
    UnaryOp.INVERT: np.invert,
}
BINARY: Final[dict[BinaryOp, Callable[[Leaf, Leaf], Leaf]]] = {
    BinaryOp.ADD: np.add,
    BinaryOp.SUB: np.subtract,
    BinaryOp.MUL: np.multiply,
    BinaryOp.DIV: np.true_divide,
    BinaryOp.FLOOR_DIV: _floor_quotient,
    BinaryOp.MOD: _mod,
    BinaryOp.AND: np.bitwise_and,
    BinaryOp.OR: np.bitwise_or,
    BinaryOp.XOR: np.bitwise_xor,
    BinaryOp.SHL: _shifted_left,
    BinaryOp.SHR: _shifted_right,
}
COMPARISONS: Final[dict[CompareOp, Callable[[Leaf, Leaf], Leaf]]] = {
    CompareOp.EQ: np.equal,
    CompareOp.NE: np.not_equal,
    CompareOp.LT: np.less,
    CompareOp.LE: np.less_equal,
    CompareOp.GT: np.greater,
    CompareOp.GE: np.greater_equal,
}
for _table, _operators in ((UNARY, UnaryOp), (BINARY, BinaryOp), (COMPARISONS, CompareOp)):
    assert set(_table) == set(_operators), "an operator without a meaning"


def convert(a: Leaf, kind: Kind, precision: int) -> Leaf:
    """Return the components converted to another kind.

    Args:
        a: The value.
        kind: The kind to convert to.
        precision: Bits of a float, 32 or 64.
    """
    dtype = dtype_of(kind, precision)
    match kind:
        case Kind.BOOL:
            return np.asarray(a != 0)
        case Kind.INT if _is_float(a):
            return _saturated(a, _INT_RANGE).astype(dtype)
        case Kind.UINT if _is_float(a):
            return _saturated(a, _UINT_RANGE).astype(dtype)
        case Kind.FLOAT | Kind.INT | Kind.UINT:
            return a.astype(dtype)
        case _:
            assert_never(kind)


def _saturated(a: Leaf, limits: tuple[float, float]) -> Leaf:
    """Round toward zero and clamp; NaN becomes 0. Every int is exact as a 64-bit float."""
    wide = np.trunc(a.astype(np.float64))
    return np.clip(np.where(np.isnan(wide), 0.0, wide), *limits).astype(np.int64)


def matrix_product(a: Leaf, b: Leaf) -> Leaf:
    """Return ``a @ b`` of matrices and vectors; sums are computed from left to right."""
    if a.ndim == 2:
        return np.stack([_inner(a, column) for column in b])
    if b.ndim == 2:
        return _combined(a, b)
    return np.stack([_combined(a, column) for column in b])


def _combined(columns: Leaf, weights: Leaf) -> Leaf:
    total: Leaf = columns[0] * weights[0]
    for i in range(1, len(weights)):
        total = total + columns[i] * weights[i]
    return total


def _inner(a: Leaf, b: Leaf) -> Leaf:
    total: Leaf = a[0] * b[0]
    for i in range(1, len(a)):
        total = total + a[i] * b[i]
    return total


def splat(value: Leaf, type: Type) -> Leaf:
    """Return a vector or matrix with a scalar in every component."""
    assert isinstance(type, Vector | Matrix), f"nothing is splatted to {type}"
    shape = (type.size,) if isinstance(type, Vector) else (type.size, type.size)
    whole = np.empty((*shape, *value.shape), value.dtype)
    whole[...] = value
    return whole


def compose(parts: Sequence[Leaf], type: Type) -> Leaf:
    """Return a vector made of scalars and vectors, or a matrix made of columns."""
    assert isinstance(type, Vector | Matrix), f"no {type} is composed"
    lanes = max([part.shape[-1] for part in parts])
    if isinstance(type, Matrix):
        matrix = np.empty((type.size, type.size, lanes), parts[0].dtype)
        for column, part in enumerate(parts):
            matrix[column] = part
        return matrix
    vector = np.empty((type.size, lanes), parts[0].dtype)
    row = 0
    for part in parts:
        end = row + (1 if part.ndim == 1 else len(part))
        vector[row:end] = part
        row = end
    assert row == type.size, f"{row} components for a {type}"
    return vector


def pick(base: Value, index: Leaf) -> Value:
    """Return ``base[index]``; the index is clamped and may differ between lanes."""
    held = np.clip(index, 0, len(base) - 1)
    if held.shape[-1] == 1:
        return base[int(held[0])]
    if isinstance(base, tuple):
        return each_leaf(lambda *leaves: _pick_leaf(_stacked(leaves), held), *base)
    return _pick_leaf(base, held)


def _stacked(leaves: tuple[Leaf, ...]) -> Leaf:
    return np.stack(np.broadcast_arrays(*leaves))


def _pick_leaf(choices: Leaf, index: Leaf) -> Leaf:
    lanes = index.shape[-1]
    whole = np.broadcast_to(choices, (*choices.shape[:-1], lanes))
    where = index.reshape((1,) * (choices.ndim - 1) + (lanes,))
    picked: Leaf = np.take_along_axis(whole, where, axis=0)[0]
    return picked


def put(base: Value, index: Leaf, new: Value) -> Value:
    """Return a copy of ``base`` with ``base[index] = new``.

    Args:
        base: The array, vector or matrix.
        index: The index, which is clamped and may differ between lanes.
        new: The new element.
    """
    held = np.clip(index, 0, len(base) - 1)
    parts = tuple(choose(held == i, new, base[i]) for i in range(len(base)))
    if isinstance(base, tuple):
        return parts
    lanes = max(width(part) for part in parts)
    return np.stack([np.broadcast_to(part, (*part.shape[:-1], lanes)) for part in leaves(parts)])


def leaves(parts: tuple[Value, ...]) -> list[Leaf]:
    """Return the parts that are NumPy arrays (for the type checker: all are)."""
    return [part for part in parts if isinstance(part, np.ndarray)]


def put_components(base: Leaf, positions: list[int], new: Leaf) -> Leaf:
    """Return a copy of a vector with some components replaced.

    Args:
        base: The vector.
        positions: The numbers of the components.
        new: The new components.
    """
    lanes = max(base.shape[-1], new.shape[-1])
    result = np.broadcast_to(base, (*base.shape[:-1], lanes)).copy()
    result[positions] = new if len(positions) > 1 else np.atleast_2d(new)
    return result


def as_value(data: Any, type: Type, precision: int) -> Value:
    """Return numbers, or nested sequences of numbers, as a value that is the same in all lanes.

    Args:
        data: A number; the components of a vector, the columns of a matrix, or the parts of a
            struct or array.
        type: The type of the value.
        precision: Bits of a float, 32 or 64.
    """
    match type:
        case Scalar(kind):
            return np.array([data]).astype(dtype_of(kind, precision))
        case Vector(kind):
            return np.array([*data]).astype(dtype_of(kind, precision))[:, None]
        case Matrix():
            columns = [[*column] for column in data]
            return np.array(columns).astype(dtype_of(Kind.FLOAT, precision))[:, :, None]
        case Array(element):
            return tuple(as_value(part, element, precision) for part in data)
        case Struct(_, fields):
            return tuple(
                as_value(part, t, precision) for part, (_, t) in zip(data, fields, strict=True)
            )
        case _:
            raise AssertionError(f"{type} has no value")
