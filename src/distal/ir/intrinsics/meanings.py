"""The NumPy definitions of built-ins that are longer than one expression.

The first argument ``xp`` of each function is the array module, so that this file does not depend on
NumPy. The last axis of an array is the lane axis, of length n >= 1: scalars have shape (n,),
vectors (size, n), matrices (columns, rows, n).
"""

from __future__ import annotations

from typing import Any

from distal.ir import limits


def minimum(xp: Any, a: Any, b: Any) -> Any:
    """Return b where b < a, else a, as GLSL and x86 do; where ``a`` is NaN, the result is NaN.

    Args:
        xp: The array module.
        a: The first argument, shape (..., n).
        b: The second argument, of the same shape.
    """
    return xp.where(b < a, b, a)


def maximum(xp: Any, a: Any, b: Any) -> Any:
    """Return b where a < b, else a.

    Args:
        xp: The array module.
        a: The first argument, shape (..., n).
        b: The second argument, of the same shape.
    """
    return xp.where(a < b, b, a)


def sign(xp: Any, a: Any) -> Any:
    """Return -1, 0 or 1, with the data type of ``a``."""
    return ((a > 0).astype(a.dtype) - (a < 0).astype(a.dtype)).astype(a.dtype)


def power(xp: Any, a: Any, b: Any) -> Any:
    """Return pow(max(a, 0), b), limited to the largest power; 0 ** 0 = 1.

    Args:
        xp: The array module.
        a: The bases, shape (..., n).
        b: The exponents, of the same shape.
    """
    bits = 8 * a.dtype.itemsize
    base = xp.where(a >= a.dtype.type(limits.smallest(bits)), a, xp.zeros_like(a))
    return xp.minimum(xp.power(base, b), a.dtype.type(limits.largest_power(bits)))


def angle(xp: Any, y: Any, x: Any) -> Any:
    """Return the arc tangent of y / x in its quadrant; the sign of a zero has no effect.

    Args:
        xp: The array module.
        y: The ordinates, shape (..., n).
        x: The abscissas, of the same shape.
    """
    zero = xp.zeros_like(y)
    return xp.arctan2(y + zero, x + zero)


def dot(xp: Any, a: Any, b: Any) -> Any:
    """Return the sum of products over the component axis, added left to right.

    Args:
        xp: The array module.
        a: The first vector, shape (size, n).
        b: The second vector, shape (size, n).
    """
    total = a[0] * b[0]
    for i in range(1, len(a)):
        total = total + a[i] * b[i]
    return total


def length(xp: Any, a: Any) -> Any:
    """Return the Euclidean length."""
    return xp.sqrt(dot(xp, a, a))


def cross(xp: Any, a: Any, b: Any) -> Any:
    """Return the right-handed cross product.

    Args:
        xp: The array module.
        a: The first vector, shape (3, n).
        b: The second vector, shape (3, n).
    """
    return xp.stack(
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    )


def truncated_quotient(xp: Any, a: Any, b: Any) -> Any:
    """Return the integer quotient rounded toward zero; requires b != 0 and a quotient in range.

    Args:
        xp: The array module.
        a: The dividends, shape (..., n).
        b: The divisors, of the same shape.
    """
    safe = xp.where(b == 0, xp.ones_like(b), b).astype(xp.int64)
    wide = a.astype(xp.int64)
    return (xp.sign(wide) * xp.sign(safe) * (abs(wide) // abs(safe))).astype(a.dtype)


def outer(xp: Any, a: Any, b: Any) -> Any:
    """Return the outer product: column i is a * b[i].

    Args:
        xp: The array module.
        a: The first vector, shape (size, n).
        b: The second vector, shape (size, n).
    """
    return xp.stack([a * b[i] for i in range(len(b))])
