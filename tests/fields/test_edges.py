"""Gradients of exact shapes at their edges, corners and axes, in 32 bits.

An exact field has a gradient of length 1 wherever it has one. Points of the surface are found by
following the gradient in 64 bits from outside and inside, which leads to edges and corners as often
as to faces; a part of the points lies on planes of symmetry. In 32 bits, the branches of a formula
meet at such points with different rounding, and components can be equal: there, a sum of two
branches or a fold by ``max`` and ``min`` gives a gradient longer than 1.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import pytest

from distal import Box, Rectangle
from distal.fields.guarantees import Guarantee
from tests.fields.drawing import default_sample, random_sample
from tests.fields.library import primitives
from tests.fields.seeds import seed_of
from tests.fields.subject import subject_of

COUNT: Final = 1200
SIDES: Final = (Guarantee.EXACT_OUTSIDE, Guarantee.EXACT_INSIDE)
EXACT_ROWS: Final = [
    pytest.param(row, id=name)
    for name, row in primitives().items()
    if not row.claims.isdisjoint(SIDES)
]
# On the surface a gradient may be shorter than 1: it is 0 where a distance is the length of a
# vector of zeros. Longer than 1, it would break the slope.
OVER: Final = 2e-3
# Distances from the surface, in scales, where it must not be shorter either.
NEAR: Final = (1e-4, 1e-2)
# In 32 bits, at a distance of 1e-4 scales from a corner.
OFF: Final = 2e-2


def _points(subject, rng):
    low, high = subject.region
    margin = 0.7 * subject.scale
    anywhere = rng.uniform(low - margin, high + margin, (COUNT, subject.dimension))
    on_axes = np.where(rng.random(anywhere.shape) < 0.3, 0.0, anywhere)
    on_diagonals = anywhere.copy()
    on_diagonals[:, 0] = on_diagonals[:, -1]
    return np.concatenate([anywhere, on_axes, on_diagonals])


def _feet(subject, rng):
    """Points of the surface with the unit gradient and the side that led there."""
    p = _points(subject, rng)
    d, g = subject.evaluate(p)
    exact = np.where(d > 0.0, SIDES[0] in subject.claims, SIDES[1] in subject.claims)
    usable = exact & (d != 0.0) & (np.abs(np.linalg.norm(g, axis=1) - 1.0) < 1e-6)
    p, d, g = p[usable], d[usable], g[usable]
    return p - d[:, None] * g, d, g


@pytest.mark.parametrize("row", EXACT_ROWS)
def test_gradients_of_exact_shapes_have_length_1_at_edges_too(row):
    rng = np.random.default_rng(seed_of(f"edges of {row.name}"))
    for sample in (default_sample(row), random_sample(row, rng)):
        subject = subject_of(sample)
        feet, d, g = _feet(subject, rng)
        steep = np.linalg.norm(sample.evaluate(feet, precision=32)[1], axis=1)
        worst = int(np.argmax(steep))
        assert steep[worst] < 1.0 + OVER, f"{sample}: {steep[worst]} at {feet[worst]}"
        for share in NEAR:
            away = np.sign(d) * np.minimum(share * subject.scale, np.abs(d))
            near = (feet + away[:, None] * g).astype(np.float32).astype(np.float64)
            values, exact = subject.evaluate(near)
            # Points that rounding moved across the medial axis are left out.
            held = np.abs(values - away) < 1e-5 * subject.scale
            held &= np.abs(np.linalg.norm(exact, axis=1) - 1.0) < 1e-3
            assert held.mean() > 0.9
            lengths = np.linalg.norm(sample.evaluate(near[held], precision=32)[1], axis=1)
            worst = int(np.argmax(np.abs(lengths - 1.0)))
            assert abs(lengths[worst] - 1.0) < OFF, (
                f"{sample}: {lengths[worst]} at {near[held][worst]}"
            )


def test_mirrors_at_diagonals_keep_the_length_of_gradients():
    """Where two coordinates are equal, the derivative of the fold is still a mirror."""
    solid = Box(0.5, 0.6, 0.7).translate(1.0, 0.0, 0.2)
    flat = Rectangle(0.5, 0.6).translate(1.0, 0.2)
    along = np.linspace(0.2, 2.0, 40)
    for shape, p in (
        (solid.apply("symmetry octant"), np.stack([along, 0.1 + 0.0 * along, along], axis=1)),
        (solid.apply("symmetry diagonal"), np.stack([along, 0.1 + 0.0 * along, along], axis=1)),
        (flat.apply("flat symmetry octant"), np.stack([along, along], axis=1)),
        (flat.apply("flat symmetry diagonal"), np.stack([along, along], axis=1)),
    ):
        lengths = np.linalg.norm(shape.gradient(p.astype(np.float32)), axis=1)
        np.testing.assert_allclose(lengths, 1.0, atol=1e-5)
