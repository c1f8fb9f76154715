"""Safe fields: each part of hard unions is divided by its own divisor.

A safe field has the zero set of the author's field, its values are never more than the distance to
it, and it is as fast as the part that is near.
"""

from __future__ import annotations

import numpy as np
import pytest

import distal
from distal import Box, Plane, Scene, Shape, Sphere, Torus
from distal.frontend import Assembly
from distal.ir.nodes import Apply, Param, Read, Return
from distal.ir.types import FLOAT, VEC3
from distal.lang import func, length, vec3
from distal.lang.composed import Composed
from distal.lang.runtime_access import executor
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.tree.values import StatementList


class SafeField(Composed):
    """A shape's safe field as a function of a point."""

    def __init__(self, shape):
        self._node = shape.node
        self.name = "safe field"
        self.result = FLOAT
        self.signature = (("p", VEC3),)

    def compose(self, assembly: Assembly) -> str:
        composer = ShapeComposer(assembly, [self._node])
        values = composer.values.all(self._node)
        field = composer.safe_field(self._node, values, ZERO_CELL)
        value = Apply(field, (Read("p", VEC3),), FLOAT)
        body = StatementList(taken={"p"})
        body.statements.append(Return(value))
        return assembly.define("safe", (Param("p", VEC3),), FLOAT, body.statements)

    def __call__(self, points):
        return executor().call(self, (points,), {}, device="reference")


TWISTED = Box((1.0, 3.0, 1.0)).twist(1.6)
BENT = Torus(0.6, 0.2).twist(0.7).rotate(x=0.4)
SHAPES = {
    "union": Plane(y=-1.0) | TWISTED.translate(3.0, 1.0, 0.0) | Sphere(0.6),
    "difference": Box(2.0, 2.0, 2.0) - TWISTED,
    "intersection": Sphere(1.2) & TWISTED.scale(1.3),
    "xor": Sphere(1.0) ^ TWISTED.rotate(y=0.5),
    "shared": TWISTED
    | TWISTED.translate(x=3.0)
    | (BENT | Sphere(0.3)).scale(2.0).symmetry(across=(1, 0, 0)),
    "smooth": TWISTED.union(Sphere(1.0), smooth=0.2) | Plane(y=-2.0),
}


def points(count=4000):
    return np.random.default_rng(8).uniform(-4.0, 4.0, (count, 3))


@pytest.mark.parametrize("name", SHAPES)
def test_a_safe_field_has_the_zero_set_and_is_less_than_the_field(name):
    shape, at = SHAPES[name], points()
    raw, safe = np.asarray(shape(at)), SafeField(shape)(at)
    assert np.all(np.sign(raw) == np.sign(safe))
    assert np.all(np.abs(safe) <= np.abs(raw) * (1.0 + 1e-5))
    assert np.all(np.abs(safe) >= np.abs(raw) / shape.divisor * (1.0 - 1e-4)), (
        "no part is divided by more than the whole was"
    )


@pytest.mark.parametrize("name", SHAPES)
def test_a_safe_field_grows_by_at_most_1(name):
    """So that none of its values is more than a distance."""
    safe, at = SafeField(SHAPES[name]), points(2000)
    way = np.random.default_rng(9).normal(size=at.shape)
    way *= 1e-3 / np.linalg.norm(way, axis=1, keepdims=True)
    assert np.abs(safe(at + way) - safe(at)).max() < 1.001e-3


def test_a_part_that_is_exact_is_not_divided():
    shape, at = Sphere(0.6) | TWISTED.translate(40.0, 0.0, 0.0), points(500)
    assert shape.divisor > 1.5
    assert SafeField(shape)(at) == pytest.approx(np.linalg.norm(at, axis=1) - 0.6, abs=1e-5)


def test_a_shape_without_divisor_is_its_own_safe_field():
    text = distal.compile(Scene(Sphere() | Plane(y=-1.0)), target="glsl-es300").text
    assert "safe" not in text


def test_equal_parts_share_a_function():
    """Ten equal parts add ten calls, not ten copies."""
    row = TWISTED
    for k in range(1, 10):
        row = row | TWISTED.translate(x=3.0 * k)
    one, ten = (distal.compile(Scene(s), target="glsl-es300").text for s in (TWISTED, row))
    assert len(ten) < 1.6 * len(one)
    assert ten.count("= twisted(") <= one.count("= twisted(") + 1


@func
def ball(p: vec3) -> float:
    return length(p) - 1.0


def test_a_safer_slope_moves_no_outline():
    """A hit is where the surface is, not where the divided value is small."""
    depths = []
    for slope in (1.0, 3.0, 10.0):
        scene = Scene(Shape.from_function(ball, slope=slope), lights=[])
        depths.append(scene.render(size=(160, 120), layers="depth").layers["depth"])
    seen = [np.isfinite(depth) for depth in depths]
    for safer, found in zip(depths[1:], seen[1:], strict=True):
        assert np.mean(found != seen[0]) < 2e-3
        both = found & seen[0]
        error = np.abs(safer[both] - depths[0][both]) / depths[0][both]
        assert np.percentile(error, 97.0) < 2e-3  # the others graze the outline
