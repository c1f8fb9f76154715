"""The table of terms in ``docs/guide/coming-from-other-tools.md`` says what is the same field.

Oracles: the formulas of the other tools, at random points. z points up in fogleman/sdf: its point
(x, y, z) is (x, z, -y) here.
"""

from __future__ import annotations

import numpy as np
import pytest

from distal import Box, Circle, InfiniteCylinder, Plane, RoundBox, Slab, Sphere, Torus

RNG = np.random.default_rng(16)
P = RNG.uniform(-1.6, 1.6, (1500, 3))  # in the other tool's axes
HERE = np.column_stack((P[:, 0], P[:, 2], -P[:, 1]))


def length(v):
    return np.linalg.norm(v, axis=1)


def box(p, size):
    q = np.abs(p) - np.array(size) / 2.0
    return length(np.maximum(q, 0.0)) + np.minimum(q.max(axis=1), 0.0)


def ball(p):
    return length(p) - 0.5


def smin(a, b, k):
    h = np.clip(0.5 + 0.5 * (b - a) / k, 0.0, 1.0)
    return b + (a - b) * h - k * h * (1.0 - h)


def turned(p, angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack((c * p[:, 0] - s * p[:, 1], s * p[:, 0] + c * p[:, 1], p[:, 2]))


def repeated(p, spacing, most):
    return p - spacing * np.clip(np.round(p / spacing), -most, most)


SLAB = np.abs(P[:, 2]) - 0.25
BAR = box(P, (1.2, 0.4, 0.6))
BAR_HERE = Box((1.2, 0.6, 0.4))
CASES = {
    "union, k is 4 smooth": (
        smin(ball(P), SLAB, 0.4),
        lambda: Sphere(0.5).union(Slab(0.5), smooth=0.1),
    ),
    "intersection, k is 4 smooth": (
        -smin(-ball(P), -SLAB, 0.4),
        lambda: Sphere(0.5).intersection(Slab(0.5), smooth=0.1),
    ),
    "difference, k is 4 smooth": (
        -smin(-SLAB, ball(P), 0.4),
        lambda: Slab(0.5).difference(Sphere(0.5), smooth=0.1),
    ),
    "blend": (0.7 * ball(P) + 0.3 * BAR, lambda: Sphere(0.5).morph(BAR_HERE, 0.3)),
    "shell": (np.abs(ball(P)) - 0.05, lambda: Sphere(0.5).shell(0.1, where="center")),
    "dilate": (ball(P) - 0.1, lambda: Sphere(0.5).offset(0.1)),
    "orient": (
        np.hypot(P[:, 1], P[:, 2]) - 0.3,
        lambda: InfiniteCylinder(0.3).orient((1.0, 0.0, 0.0)),
    ),
    "slab below": (P[:, 2] - 0.4, lambda: Plane(0.4)),
    "slab between": (
        np.maximum(0.1 - P[:, 2], P[:, 2] - 0.7),
        lambda: Slab(0.6).translate(y=0.4),
    ),
    "half sizes and radius of GLSL": (
        box(P, (0.8, 0.4, 0.6)) - 0.1,
        lambda: RoundBox((1.0, 0.8, 0.6), 0.1),
    ),
    "torus": (
        np.hypot(np.hypot(P[:, 0], P[:, 1]) - 0.8, P[:, 2]) - 0.2,
        lambda: Torus(0.8, 0.2),
    ),
    "revolve": (
        np.hypot(np.hypot(P[:, 0], P[:, 1]) - 0.8, P[:, 2]) - 0.2,
        lambda: Circle(0.2).revolve(0.8),
    ),
}

# Operators whose values may differ away from the surface: the insides are equal.
INSIDES = {
    "twist": (
        box(turned(P, 0.9 * P[:, 2]), (1.2, 0.4, 2.0)),
        lambda: Box((1.2, 2.0, 0.4)).twist(-0.9),
    ),
    "elongate": (
        ball(np.sign(P) * np.maximum(np.abs(P) - (0.3, 0.2, 0.1), 0.0)),
        lambda: Sphere(0.5).elongate(0.6, 0.2, 0.4),
    ),
    "repeat": (
        ball(np.column_stack((repeated(P[:, 0], 0.7, 2), P[:, 1:]))),
        lambda: Sphere(0.5).repeat(0.7, 0.0, 0.0, count=(5, 1, 1), neighbors=1),
    ),
}


@pytest.mark.parametrize("name", INSIDES)
def test_the_insides_are_equal(name):
    wanted, made = INSIDES[name]
    assert 20 < (wanted < 0.0).sum() < 1000
    assert ((made()(HERE) < 0.0) == (wanted < 0.0)).all()


@pytest.mark.parametrize("name", CASES)
def test_the_fields_are_equal(name):
    wanted, made = CASES[name]
    assert np.allclose(made()(HERE), wanted, atol=1e-6)
