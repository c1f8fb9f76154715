"""Fit the polynomials of ``distal.lang.prelude.elementary`` and print them.

Input: for each function the form of its polynomial, its interval and the error to minimize.
Output: for each its coefficients, rounded to 32 bits, lowest power first, and the largest error
that the rounded polynomial has when it is computed exactly. Does not depend on distal.

The method is Lawson's: fit by weighted least squares, multiply each point's weight by its error,
repeat; the largest error falls toward the smallest possible. (Remez's exchange is quicker and
fails here, because the higher powers alone all vanish at 0.) Coefficients are rounded one after
the other from the lowest power, the rest fitted again each time, so that later coefficients correct
the rounding of earlier ones.

Run: ``python tools/fit_elementary.py``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]
GRID_POINTS = 601
ROUNDS = 150


@dataclass(frozen=True)
class Form:
    """A function to fit as ``known(x) + sum of coefficient * power``.

    Attributes:
        name: What the coefficients are printed under.
        function: What is approximated.
        known: The part of the approximation that is fixed.
        powers: The powers of x whose coefficients are looked for.
        low: Lower end of the interval.
        high: Upper end of the interval.
    """

    name: str
    function: Callable[[Reals], Reals]
    known: Callable[[Reals], Reals]
    powers: tuple[int, ...]
    low: float
    high: float


HALF_ROOT = 2.0**0.5 / 2.0
FORMS = (
    Form("sine", np.sin, lambda x: x, (3, 5, 7, 9), 0.0, 1.5709),
    Form("tangent", np.tan, lambda x: x, (3, 5, 7, 9, 11, 13), 0.0, 0.7855),
    Form("exponential", np.exp, lambda x: 1.0 + x, (2, 3, 4, 5, 6), -0.3467, 0.3467),
    Form("exponential_base_2", np.exp2, lambda x: 1.0 + 0.0 * x, (1, 2, 3, 4, 5, 6), -0.5, 0.5),
    Form(
        "logarithm",
        np.log1p,
        lambda x: x - 0.5 * x * x,
        (3, 4, 5, 6, 7, 8, 9),
        HALF_ROOT - 1.0,
        2.0 * HALF_ROOT - 1.0,
    ),
    Form("arc_sine", np.arcsin, lambda x: x, (3, 5, 7, 9, 11), 0.0, 0.5),
    Form("arc_tangent", np.arctan, lambda x: x, (3, 5, 7, 9, 11, 13, 15, 17), 0.0, 1.0),
    Form("hyperbolic_sine", np.sinh, lambda x: x, (3, 5, 7), 0.0, 1.0),
    Form("hyperbolic_tangent", np.tanh, lambda x: x, (3, 5, 7, 9, 11), 0.0, 0.625),
)


def flattest(target: Reals, basis: Reals, weight: Reals) -> Reals:
    """The coefficients of ``basis`` whose weighted distance to ``target`` is nowhere large.

    Args:
        target: The function at the grid points.
        basis: One row for each grid point, one column for each coefficient.
        weight: What the error is multiplied by.
    """
    attention = np.full(len(target), 1.0 / len(target))
    # Powers of a small x differ by magnitudes; columns of one size keep the system well posed.
    size = np.max(np.abs(basis), axis=0)
    best, smallest = np.zeros(basis.shape[1]), np.inf
    for _ in range(ROUNDS):
        scale = weight * np.sqrt(attention)
        solution = np.linalg.lstsq(basis / size * scale[:, None], target * scale, rcond=None)[0]
        error = np.abs(target - basis / size @ solution) * weight
        if error.max() < smallest:
            best, smallest = solution / size, float(error.max())
        attention = attention * error
        attention /= attention.sum()
    return best


def fit(form: Form) -> tuple[list[float], float]:
    """The rounded coefficients, and the largest relative error they leave."""
    steps = np.arange(GRID_POINTS) / (GRID_POINTS - 1)
    x = form.low + (form.high - form.low) * (1.0 - np.cos(np.pi * steps)) / 2.0
    # Near a zero of the function all relative errors vanish with the higher powers; keep off it.
    x = x[np.abs(form.function(x)) > 1e-4]
    exact = form.function(x)
    weight = 1.0 / np.abs(exact)
    rest = exact - form.known(x)
    rounded: list[float] = []
    powers = list(form.powers)
    while powers:
        basis = np.stack([x**power for power in powers], axis=1)
        first = float(np.float32(flattest(rest, basis, weight)[0]))
        rounded.append(first)
        rest = rest - first * x ** powers.pop(0)
    return rounded, float(np.max(np.abs(rest) * weight))


def main() -> None:
    """Print every form's coefficients."""
    for form in FORMS:
        coefficients, error = fit(form)
        print(f"{form.name}: largest relative error {error:.2e}")
        for power, value in zip(form.powers, coefficients, strict=True):
            print(f"    x^{power:<2} {np.float32(value)!s}")


if __name__ == "__main__":
    main()
