"""The NumPy meaning of built-ins that is longer than one expression.

Each takes the array module first, so that this file needs no NumPy. Arrays have one lane axis, the
last: scalars (n,), vectors (size, n), matrices (columns, rows, n), n may be 1.
"""

from __future__ import annotations

from typing import Any

from distal.ir import limits


def minimum(xp: Any, a: Any, b: Any) -> Any:
    """B where b < a, else a: what GLSL and x86 do, and what a NaN in ``a`` gets."""
    return xp.where(b < a, b, a)


def maximum(xp: Any, a: Any, b: Any) -> Any:
    """B where a < b, else a."""
    return xp.where(a < b, b, a)


def sign(xp: Any, a: Any) -> Any:
    """-1, 0 or 1 of a's own type."""
    return ((a > 0).astype(a.dtype) - (a < 0).astype(a.dtype)).astype(a.dtype)


def power(xp: Any, a: Any, b: Any) -> Any:
    """pow(max(a, 0), b) up to its limit, and 0 ** 0 = 1."""
    bits = 8 * a.dtype.itemsize
    base = xp.where(a >= a.dtype.type(limits.smallest(bits)), a, xp.zeros_like(a))
    return xp.minimum(xp.power(base, b), a.dtype.type(limits.largest_power(bits)))


def angle(xp: Any, y: Any, x: Any) -> Any:
    """The arc tangent of y / x in its quadrant, whatever the sign of a zero."""
    zero = xp.zeros_like(y)
    return xp.arctan2(y + zero, x + zero)


def dot(xp: Any, a: Any, b: Any) -> Any:
    """Sum over the component axis, left to right."""
    total = a[0] * b[0]
    for i in range(1, len(a)):
        total = total + a[i] * b[i]
    return total


def length(xp: Any, a: Any) -> Any:
    """Euclidean length."""
    return xp.sqrt(dot(xp, a, a))


def cross(xp: Any, a: Any, b: Any) -> Any:
    """Right-handed vector product."""
    return xp.stack(
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    )


def truncated_quotient(xp: Any, a: Any, b: Any) -> Any:
    """Integer quotient toward zero; callers keep b != 0 and the quotient in range."""
    safe = xp.where(b == 0, xp.ones_like(b), b).astype(xp.int64)
    wide = a.astype(xp.int64)
    return (xp.sign(wide) * xp.sign(safe) * (abs(wide) // abs(safe))).astype(a.dtype)


def outer(xp: Any, a: Any, b: Any) -> Any:
    """Column i is a * b[i]."""
    return xp.stack([a * b[i] for i in range(len(b))])
