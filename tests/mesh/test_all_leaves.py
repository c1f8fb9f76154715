"""Every leaf of a flat shape, and of a solid in a slice, has lines in the outline."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import Box, Circle, Cylinder, Rectangle, Sphere, union
from distal.diagnostics import CompileError
from distal.mesh.kernels import FieldKernels
from distal.mesh.outlines import all_leaves
from distal.mesh.outlines.layers import layers_at
from distal.mesh.outlines.outline import Outline
from distal.mesh.outlines.outlining import OutlineRequest
from distal.mesh.outlines.tiles import FlatExtent
from distal.mesh.outlines.tracing import traced

SHEET = Rectangle(600, 400)


def loops(outline):
    """How many loops go around the inside, and how many around holes."""
    signs = []
    for loop in outline.loops:
        x, y = loop.T
        signs.append(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) > 0)
    return sum(signs), len(signs) - sum(signs)


def traced_loops(shape):
    """How many loops there are without the comparison."""
    low, high = (np.array(corner) for corner in shape.bounds())
    extent = FlatExtent(low, high, shape.slope, shape.divisor)
    kernels = FieldKernels(shape.node, {}, 0.0)
    return len(traced(kernels, extent, 2e-4 * extent.size, lambda share: None).loops)


def test_a_hole_of_two_is_there_wherever_it_is():
    rng = np.random.default_rng(0)
    lost = 0
    for x, y in rng.uniform(-190, 190, (10, 2)).tolist():
        shape = SHEET - Circle(1.0).translate(1.5 * x, y)
        lost += traced_loops(shape) < 2
        made = shape.outline()
        assert loops(made) == (1, 1)
        assert made.area == pytest.approx(600 * 400 - math.pi, abs=0.5)
    assert lost > 0  # without the comparison some are lost


@pytest.mark.parametrize("radius", [0.05, 0.3])
def test_smaller_holes_are_there(radius):
    made = (SHEET - Circle(radius).translate(31.7, -20.9)).outline()
    assert loops(made) == (1, 1)


def test_each_copy_of_an_array_is_there():
    holes = Circle(0.7).repeat(11.3, count=(21, 21))
    assert loops((SHEET - holes).outline()) == (1, 441)
    half = holes & Rectangle(400, 400).translate(205.0, 0.0)
    assert loops((SHEET - half).outline()) == (1, 10 * 21)


def test_slits_islands_and_bridges_are_there():
    slit = Rectangle(80, 0.4).rotate(0.4).translate(50.0, 30.0)
    island = Circle(0.5).translate(0.0, 230.0)
    assert loops(((SHEET - slit) | island).outline()) == (2, 1)
    # A bridge of .5 between two windows: it is neither cut nor lost.
    windows = union(*(Rectangle(60, 60).translate(x, 10.0) for x in (-30.25, 30.25)))
    assert loops((SHEET - windows).outline()) == (1, 2)


def test_slices_and_layers_show_all_leaves_of_a_solid():
    bores = union(*(Cylinder(0.6, 40).translate(17.3 * i - 60, 0, 9.7 * i - 30) for i in range(8)))
    plate = Box(200, 10, 200) - bores - Sphere(2.0).translate(70.0, 1.0, 70.0)
    made = plate.slice((0, 1.2, 0), (0, 1, 0)).outline()
    assert loops(made) == (1, 9)
    found = list(layers_at(plate, [-3.0, 1.2, 4.4], "y", OutlineRequest()))
    outlines = [layer.outline for layer in found]
    assert [loops(made) for made in outlines if isinstance(made, Outline)] == [
        (1, 8),
        (1, 9),
        (1, 8),
    ]


def test_a_leaf_that_stays_missing_is_an_error_at_its_line(monkeypatch):
    monkeypatch.setattr(all_leaves, "MOST_TILES", 0)
    with pytest.raises(CompileError) as raised:
        (SHEET - Circle(0.05).translate(31.7, -20.9)).outline()
    text = str(raised.value)
    assert "'Circle' (line " in text and "is missing in the outline at (31" in text
    assert "Circle(0.05)" in text  # the author's line


def test_edges_that_touch_inside_have_no_places():
    shape = Rectangle(10, 10) | Rectangle(10, 10).translate(10, 0) | Circle(3)
    made = shape.outline()
    assert loops(made) == (1, 0)
    assert made.area == pytest.approx(200.0, rel=1e-6)
