"""Shapes along approximated curves: the declared error is the measured one.

The oracle is the curve itself: many of its points, where the value of a line of radius r is -r.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import pytest

import distal
from tests.fields.library import operators, primitives

T: Final = np.linspace(0.0, 1.0, 2001)[:, None]
START, END = np.array([-0.5, -0.3, 0.0]), np.array([0.5, -0.3, 0.0])
CONTROL = np.array([0.0, 0.8, 0.4])
POINTS: Final = np.array([(-1.0, -0.3), (-0.2, 0.6), (0.4, -0.5), (1.1, 0.2), (0.9, 0.9)])


def quadratic(a, b, c):
    return (1 - T) ** 2 * a + 2 * T * (1 - T) * b + T**2 * c


def cubic(a, b, c, d):
    return (1 - T) ** 3 * a + 3 * (1 - T) ** 2 * T * b + 3 * (1 - T) * T**2 * c + T**3 * d


def off(shape, curve, radius):
    """How far the pieces are from the curve, as a fraction of the curve's size."""
    return np.abs(shape(curve) + radius).max() / np.ptp(curve, axis=0).max()


def cubic_bezier():
    corners = [(-0.5, -0.3), (-0.3, 0.7), (0.3, -0.7), (0.5, 0.3)]
    return off(distal.CubicBezier(), cubic(*map(np.array, corners)), 0.05)


def spline_path():
    v = np.gradient(POINTS, axis=0) / 3.0
    spans = range(len(POINTS) - 1)
    parts = [
        cubic(POINTS[i], POINTS[i] + v[i], POINTS[i + 1] - v[i + 1], POINTS[i + 1]) for i in spans
    ]
    return off(distal.SplinePath([tuple(p) for p in POINTS]), np.concatenate(parts), 0.05)


def cubic_bezier_tube():
    leaving, arriving = np.array([-0.3, 0.7, 0.3]), np.array([0.3, -0.7, 0.3])
    return off(
        distal.CubicBezierTube(), cubic(START, leaving, arriving, END), 0.12 - 0.06 * T[:, 0]
    )


def tapered_bezier_tube():
    return off(distal.TaperedBezierTube(), quadratic(START, CONTROL, END), 0.12 - 0.06 * T[:, 0])


def turning():
    return np.concatenate([np.cos(6.0 * np.pi * T), np.sin(6.0 * np.pi * T)], axis=1)


def archimedean_spiral():
    return off(distal.ArchimedeanSpiral(), (0.1 + 0.9 * T) * turning(), 0.04)


def logarithmic_spiral():
    return off(distal.LogarithmicSpiral(), 0.05 ** (1.0 - T) * turning(), 0.02)


def round_tube(major, minor, pitch, turns):
    """Points of the tube of radius ``minor`` around a helix."""
    angle = np.linspace(-np.pi * turns, np.pi * turns, 400)[:, None]
    rise = pitch / (2.0 * np.pi)
    c, s = np.cos(angle), np.sin(angle)
    axis = np.concatenate([major * c, rise * angle, major * s], axis=1)
    along = np.concatenate([-major * s, rise + 0.0 * s, major * c], axis=1)
    along /= np.hypot(major, rise)
    out = np.concatenate([c, 0.0 * c, s], axis=1)
    across = np.cross(along, out)
    around = np.linspace(0.0, 2.0 * np.pi, 60)[:, None, None]
    return (axis + minor * (np.cos(around) * out + np.sin(around) * across)).reshape(-1, 3)


def helix():
    return np.abs(distal.Helix()(round_tube(0.5, 0.1, 0.4, 1.0))).max() / 1.2


def spring():
    # The part between the flat ends.
    p = round_tube(0.4, 0.07, 0.25, 3.0)
    return np.abs(distal.Spring()(p)).max() / 1.0


def sweep_bezier():
    swept = distal.Circle(0.05).sweep_bezier(tuple(START), tuple(CONTROL), tuple(END))
    curve = quadratic(START, CONTROL, END)[200:-200]  # not next to the flat ends
    return off(swept, curve, 0.05)


MEASURES: Final = {
    "CubicBezier": cubic_bezier,
    "SplinePath": spline_path,
    "CubicBezierTube": cubic_bezier_tube,
    "TaperedBezierTube": tapered_bezier_tube,
    "ArchimedeanSpiral": archimedean_spiral,
    "LogarithmicSpiral": logarithmic_spiral,
    "Helix": helix,
    "Spring": spring,
    "sweep bezier": sweep_bezier,
}


def test_all_approximations_are_measured():
    rules = {**primitives(), **operators()}
    assert {name for name, rule in rules.items() if rule.approximates is not None} == set(MEASURES)


@pytest.mark.parametrize("name", MEASURES)
def test_the_declared_error_is_the_measured_one(name):
    found = {**primitives(), **operators()}[name].approximates
    measured = MEASURES[name]()
    assert 0.8 * found.error < measured <= found.error
