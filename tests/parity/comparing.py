"""Holding a target's results against the reference's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.parity.programs import Case, Numbers


@dataclass(frozen=True)
class Disagreement:
    """How far a target is off where a promise is made.

    Attributes:
        case: The case.
        absolute: The largest difference.
        relative: The largest difference over the larger magnitude, where that is above 1e-3.
        message: What is wrong in the worst sample beyond the tolerance; None if all are within.
    """

    case: Case
    absolute: float
    relative: float
    message: str | None


def disagreement(case: Case, expected: Numbers, actual: Numbers, *, on_cpu: bool) -> Disagreement:
    """Compare (components, samples); NaN equals NaN, and zeros of either sign are equal."""
    inputs = case.inputs()
    promised = np.ones(expected.shape[1], bool)
    if case.defined is not None:
        promised = case.defined(inputs, on_cpu)
    same = (expected == actual) | (np.isnan(expected) & np.isnan(actual))
    with np.errstate(invalid="ignore"):
        error = np.where(same | ~promised, 0.0, np.abs(expected - actual))
    size = np.fmax(np.abs(expected), np.abs(actual))
    error = np.where(np.isnan(error), np.inf, error)
    with np.errstate(invalid="ignore"):
        beyond = (error > 0.0) & ~(error <= case.atol + case.rtol * size)
        share = np.where(size > 1e-3, error / np.where(size > 0.0, size, 1.0), 0.0)
    message = None
    if beyond.any():
        component, sample = np.unravel_index(np.argmax(np.where(beyond, error, -1.0)), error.shape)
        message = (
            f"{case.name}: {beyond.sum()} of {promised.sum() * len(expected)} results are off; "
            f"component {component} of {[a[:, sample].tolist() for a in inputs]} "
            f"should be {expected[component, sample]}, is {actual[component, sample]}"
        )
    return Disagreement(case, float(error.max()), float(np.nanmax(share)), message)
