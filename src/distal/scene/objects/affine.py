"""Affine matrices as operators: a rotation, factors along the axes, a rotation, a translation.

Input: the author's matrix. Output: operators with their numbers. Every matrix is such a product
(its singular value decomposition), so no operator of its own is needed, and what keeps all angles
stays exact.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any, Final, TypeAlias

from distal.diagnostics import Span
from distal.fields.guarantees import Operator
from distal.fields.place import solid as placing
from distal.scene.tree.errors import refuse, refuse_kind

Columns: TypeAlias = list[list[float]]
Placing: TypeAlias = tuple[Operator, tuple[Any, ...]]
_HINT: Final = "transform([[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]])"
# Factors that differ by less are equal but for rounding to 32 bits.
_EQUAL: Final = 1e-6
# The cosine of what is a right angle.
_RIGHT: Final = 1e-14
# The smallest factor, as a share of the largest one.
_FLAT: Final = 1e-6


def affine_parts(matrix: Any, place: Span | None) -> list[Placing]:
    """Return the operators of a matrix, the first one first.

    Args:
        matrix: Three or four rows of four numbers.
        place: The author's line.

    Raises:
        SceneValueError: It is no invertible affine matrix.
        SceneTypeError: A number is none.
    """
    rows = _rows(matrix, place)
    columns = [[row[i] for row in rows] for i in range(3)]
    before, factors, after = _decomposed(columns)
    if not min(factors) > _FLAT * max(factors):
        refuse("the matrix of transform flattens the shape: its determinant is 0", _HINT, place)
    if max(factors) <= min(factors) * (1.0 + _EQUAL):
        turned = [_mapped(after, [v[i] for v in before]) for i in range(3)]
        parts = [(placing.SCALE, (sum(factors) / 3.0,)), (placing.ROTATE_MATRIX, _vectors(turned))]
    else:
        back = [[v[i] for v in before] for i in range(3)]
        parts = [
            (placing.ROTATE_MATRIX, _vectors(back)),
            (placing.STRETCH, (tuple(factors),)),
            (placing.ROTATE_MATRIX, _vectors(after)),
        ]
    parts.append((placing.TRANSLATE, (tuple(row[3] for row in rows),)))
    return [part for part in parts if part not in _NOTHING] or parts[-1:]


_AXES: Final = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
_NOTHING: Final[list[Placing]] = [
    (placing.SCALE, (1.0,)),
    (placing.ROTATE_MATRIX, _AXES),
    (placing.TRANSLATE, ((0.0, 0.0, 0.0),)),
]


def _rows(matrix: Any, place: Span | None) -> list[list[float]]:
    """Return the three rows of a matrix that are not (0, 0, 0, 1)."""
    try:
        rows = [list(row) for row in matrix]
    except TypeError:
        rows = []
    if [len(row) for row in rows] not in ([4] * 3, [4] * 4):
        refuse("the matrix of transform is three or four rows of four numbers", _HINT, place)
    try:
        numbers = [[_number(value) for value in row] for row in rows]
    except TypeError:
        hint = "rotate, scale and translate take parameters"
        refuse_kind("the matrix of transform takes plain numbers", hint, place)
    if not all(abs(value) < 1e15 for value in itertools.chain(*numbers)):
        refuse("a number of the matrix of transform is not finite or too large", None, place)
    if len(numbers) == 4 and numbers[3] != [0.0, 0.0, 0.0, 1.0]:
        last = ", ".join(f"{value:g}" for value in numbers[3])
        refuse(
            f"the last row of the matrix of transform is (0, 0, 0, 1), not ({last})",
            "transpose it if its translation is in the last row",
            place,
        )
    return numbers[:3]


def _number(value: Any) -> float:
    if isinstance(value, str | bytes | bool) or not hasattr(type(value), "__float__"):
        raise TypeError
    return float(value)


def _decomposed(columns: Columns) -> tuple[Columns, list[float], Columns]:
    """Return the singular value decomposition of a matrix, all by columns.

    Columns are turned in pairs until all are at right angles; those that are so are left.

    Args:
        columns: The columns of the matrix.

    Returns:
        V, the factors, and U: the matrix is U times the factors times V transposed. V is a
        rotation.

    Source: one-sided Jacobi rotations; Hestenes, "Inversion of Matrices by Biorthogonalization"
        (1958).
    """
    u = [list(column) for column in columns]
    v: Columns = [list(axis) for axis in _AXES]
    for _ in range(30):
        is_done = True
        for i, j in ((0, 1), (0, 2), (1, 2)):
            across = _dot(u[i], u[j])
            a, b = _dot(u[i], u[i]), _dot(u[j], u[j])
            if abs(across) <= _RIGHT * math.sqrt(a * b):
                continue
            is_done = False
            half = (b - a) / (2.0 * across)
            t = math.copysign(1.0, half) / (abs(half) + math.hypot(1.0, half))
            c = 1.0 / math.hypot(1.0, t)
            for m in (u, v):
                m[i], m[j] = (
                    [c * (x - t * y) for x, y in zip(m[i], m[j], strict=True)],
                    [c * (t * x + y) for x, y in zip(m[i], m[j], strict=True)],
                )
        if is_done:
            break
    factors = [math.hypot(*column) for column in u]
    return (
        v,
        factors,
        _upright([[x / (f or 1.0) for x in m] for m, f in zip(u, factors, strict=True)]),
    )


def _upright(columns: Columns) -> Columns:
    """Return columns at exactly right angles, from such that nearly are."""
    x, y, z = columns
    y = [b - _dot(x, y) * a for a, b in zip(x, y, strict=True)]
    y = [b / (math.hypot(*y) or 1.0) for b in y]
    third = [
        x[1] * y[2] - x[2] * y[1],
        x[2] * y[0] - x[0] * y[2],
        x[0] * y[1] - x[1] * y[0],
    ]
    side = math.copysign(1.0, _dot(third, z))
    return [x, y, [side * part for part in third]]


def _mapped(columns: Columns, vector: Sequence[float]) -> list[float]:
    return [sum(m[i] * f for m, f in zip(columns, vector, strict=True)) for i in range(3)]


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


def _vectors(columns: Columns) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(part + 0.0 for part in column) for column in columns)


def refuse_mirrored(columns: Sequence[Sequence[Any]], place: Span | None) -> None:
    """Refuse three columns that are a mirror image and no rotation.

    Raises:
        SceneValueError: They are.
    """
    try:
        x, y, z = ([_number(part) for part in column] for column in columns)
    except (TypeError, ValueError):
        return  # parameters, or another shape, which the operator refuses
    if len(x) == len(y) == len(z) == 3:
        volume = (
            x[0] * (y[1] * z[2] - y[2] * z[1])
            - x[1] * (y[0] * z[2] - y[2] * z[0])
            + x[2] * (y[0] * z[1] - y[1] * z[0])
        )
        if volume < 0.0:
            refuse(
                "rotate matrix: the columns of a rotation must be right-handed; "
                "transform takes the other kind",
                None,
                place,
            )
