"""Convert values between NumPy arrays and a kernel's memory.

Input: the user's arrays, and shapes as ``distal.backends.llvm.layout`` describes them. Output: runs
of slots, one run for each leaf; and the reverse.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.backends.llvm.layout import kinds_in
from distal.devices.base import Values

_Array = NDArray[Any]
_STORED: Final = {"int": np.int32, "uint": np.uint32, "bool": np.int32}


def float_type(precision: int) -> Any:
    """Return the NumPy type of a float of 32 or 64 bits."""
    return np.float32 if precision == 32 else np.float64


def _slots(count: int, precision: int) -> _Array:
    return np.zeros(count, float_type(precision))


def _put(slots: _Array, at: Any, kind: str, values: _Array) -> None:
    """Write numbers of a kind into slots; an int occupies a slot's first four bytes."""
    if kind == "float":
        slots[at] = values
        return
    if kind == "uint":
        whole = np.asarray(values).astype(np.uint32).view(np.int32)
    else:
        whole = np.asarray(values).astype(np.int32)
    if slots.dtype == np.float32:
        slots.view(np.int32)[at] = whole
    else:
        slots.view(np.int64)[at] = whole


def _get(slots: _Array, kind: str) -> _Array:
    """Read numbers of a kind from slots."""
    if kind == "float":
        return slots.copy()
    whole = slots.view(np.int32) if slots.dtype == np.float32 else slots.view(np.int32)[::2]
    return whole != 0 if kind == "bool" else whole.astype(_STORED[kind])


class UniformSlots:
    """The slots of a kernel's uniforms. ``rows`` are (name, slot, shape, default), in slot order.

    A scene may have a thousand uniforms, which are written for each picture. So all values are
    collected first and converted together: 0.1 ms, where one array for each uniform took 4 ms.
    """

    def __init__(self, rows: Sequence[Any], count: int, precision: int) -> None:
        self._rows = [(name, default) for name, _, _, default in rows]
        self._count = max(1, count)
        self._precision = precision
        kinds = [kind for _, _, shape, _ in rows for kind in kinds_in(shape)]
        self._others = {
            kind: np.array([i for i, k in enumerate(kinds) if k == kind], np.intp)
            for kind in set(kinds) - {"float"}
        }

    def packed(self, values: Mapping[str, Any]) -> _Array:
        """Return the values as slots; missing ones take their defaults."""
        flat: list[Any] = []
        for name, default in self._rows:
            value = values.get(name, default)
            if isinstance(value, float | int):
                flat.append(value)
            else:
                flat.extend(np.asarray(value).reshape(-1).tolist())
        # 64 bits hold every int and uint exactly.
        numbers = np.array(flat, np.float64)
        slots = _slots(self._count, self._precision)
        slots[: len(numbers)] = numbers
        for kind, where in self._others.items():
            _put(slots, where, kind, numbers[where])
        return slots


def pack_resource(row: Sequence[Any], value: Any, precision: int) -> tuple[_Array, list[int]]:
    """Return a texture's or buffer's numbers as slots, and its width (or count), height and depth.

    Args:
        row: The resource's entry in the interface: name, kind of resource, shape of an element.
        value: The array.
        precision: Bits of a float, 32 or 64.

    Raises:
        ValueError: The array does not have the shape of such a resource.
    """
    name, sort, shape = row
    kinds = kinds_in(shape)
    array = np.asarray(value)
    if sort == "buffer":
        count = len(array)
        flat = array.reshape(count, -1)
        sizes = [count, 1, 1]
    else:
        flat = array.reshape(-1, array.shape[-1])
        sizes = [*array.shape[-2::-1], 1, 1][:3]
    if flat.size == 0 or flat.shape[1] != len(kinds):
        raise ValueError(f"'{name}' has the shape {array.shape}, which is no {sort} here")
    slots = _slots(flat.size, precision)
    _put(slots, slice(None), kinds[0], flat.reshape(-1))
    return slots, sizes


def shared_length(args: Sequence[Values]) -> int:
    """Return the number of points of the arguments: the largest number of rows.

    Raises:
        ValueError: Two arguments have different numbers of rows, both greater than 1.
    """
    counts = {len(array) for arg in args for array in _arrays(arg)}
    many = counts - {1}
    if len(many) > 1:
        raise ValueError(f"arguments for different numbers of points: {sorted(many)}")
    return many.pop() if many else 1


def _arrays(value: Values) -> list[_Array]:
    if isinstance(value, tuple):
        return [array for part in value for array in _arrays(part)]
    return [np.asarray(value)]


def pack_points(
    shapes: Sequence[Any], args: Sequence[Values], points: int, stride: int, precision: int
) -> _Array:
    """Return the arguments as runs of ``stride`` slots, one run for each leaf.

    Args:
        shapes: The shapes of the parameters.
        args: The arguments, with one row for each point.
        points: The number of points.
        stride: Slots of a run: the points, padded to whole blocks.
        precision: Bits of a float, 32 or 64.
    """
    kinds = [k for shape in shapes for k in kinds_in(shape)]
    slots = np.empty(max(1, len(kinds)) * stride, float_type(precision))
    leaves = [leaf for shape, arg in zip(shapes, args, strict=True) for leaf in _leaves(shape, arg)]
    for i, (kind, leaf) in enumerate(zip(kinds, leaves, strict=True)):
        run = slots[i * stride : (i + 1) * stride]
        _put(run, slice(None, points), kind, leaf)
        # Padding lanes repeat the last point, so their loops do not run longer.
        run[points:] = run[points - 1]
    return slots


def _leaves(shape: Any, value: Values) -> list[_Array]:
    """Return one array of numbers for each leaf."""
    if "struct" in shape:
        return [
            leaf
            for (_, part), field in zip(shape["fields"], value, strict=True)
            for leaf in _leaves(part, field)
        ]
    if "element" in shape:
        if isinstance(value, tuple):  # an array of structs: a tuple of arrays (n, length, …)
            elements = [_at(value, i) for i in range(shape["length"])]
        else:
            elements = [np.asarray(value)[:, i] for i in range(shape["length"])]
        return [leaf for element in elements for leaf in _leaves(shape["element"], element)]
    array = np.asarray(value)
    if "columns" in shape:
        n = shape["columns"]
        return [array[:, row, column] for column in range(n) for row in range(n)]
    if "size" in shape:
        return [array[:, i] for i in range(shape["size"])]
    return [array]


def _at(value: Values, index: int) -> Values:
    if isinstance(value, tuple):
        return tuple(_at(part, index) for part in value)
    return np.asarray(value)[:, index]


def unpack_points(shape: Any, slots: _Array, points: int, stride: int) -> Values:
    """Return a result from runs of ``stride`` slots.

    Args:
        shape: The shape of the result.
        slots: The slots.
        points: The number of points.
        stride: Slots of a run.
    """
    kinds = kinds_in(shape)
    leaves = [_get(slots[i * stride : i * stride + points], k) for i, k in enumerate(kinds)]
    return _assembled(shape, iter(leaves), points)


def _assembled(shape: Any, leaves: Any, points: int) -> Values:
    if "struct" in shape:
        return tuple(_assembled(part, leaves, points) for _, part in shape["fields"])
    if "element" in shape:
        return _stacked([_assembled(shape["element"], leaves, points)
                         for _ in range(shape["length"])])  # fmt: skip
    if "columns" in shape:
        n = shape["columns"]
        columns = [np.stack([next(leaves) for _ in range(n)], axis=1) for _ in range(n)]
        return np.stack(columns, axis=2)
    if "size" in shape:
        return np.stack([next(leaves) for _ in range(shape["size"])], axis=1)
    first: _Array = next(leaves)
    return first


def _stacked(elements: Sequence[Values]) -> Values:
    """Stack elements along the second axis; structs field by field."""
    if isinstance(elements[0], tuple):
        fields = zip(*elements, strict=True)
        return tuple(_stacked(list(field)) for field in fields)
    return np.stack([np.asarray(e) for e in elements], axis=1)
