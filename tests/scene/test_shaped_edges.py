"""Fillets, chamfers, infills and reliefs are the operators that they stand for."""

from __future__ import annotations

import math

import numpy as np
import pytest

import distal
from distal.lang.runtime_access import executor


def values(shape, points):
    return np.asarray(executor().call(shape, (np.asarray(points, float),), {}, device="reference"))


FLOOR, WALL = distal.HalfPlane((0.0, 1.0)), distal.HalfPlane((1.0, 0.0))


def test_a_fillet_is_a_quarter_of_a_circle():
    """In the corner of two half planes: the circle around (1, 1) touches both at (1, 0), (0, 1)."""
    angle = np.linspace(0.02, math.pi / 2.0 - 0.02, 9)
    arc = np.stack([1.0 - np.cos(angle), 1.0 - np.sin(angle)], axis=-1)
    assert values((FLOOR | WALL).fillet(1.0), arc) == pytest.approx(0.0, abs=1e-6)
    assert values((FLOOR & WALL).fillet(1.0), -arc) == pytest.approx(0.0, abs=1e-6)
    assert values((FLOOR - ~WALL).fillet(1.0), -arc) == pytest.approx(0.0, abs=1e-6)


def test_a_chamfer_is_a_straight_face():
    share = np.linspace(0.05, 0.95, 7)
    face = np.stack([share, 1.0 - share], axis=-1)
    assert values((FLOOR | WALL).chamfer(1.0), face) == pytest.approx(0.0, abs=1e-6)
    assert values((FLOOR & WALL).chamfer(1.0), -face) == pytest.approx(0.0, abs=1e-6)


def test_an_extrusion_gets_its_own_edges():
    rng = np.random.default_rng(0)
    points = rng.uniform(-1.0, 1.0, (200, 3))
    plate = distal.Rectangle(1.0, 0.6).extrude(0.4)
    for made, wanted in (
        (plate.fillet(0.1), distal.Rectangle(1.0, 0.6).extrude(0.4, rounding=0.1)),
        (plate.chamfer(0.1), distal.Rectangle(1.0, 0.6).extrude(0.4, chamfer=0.1)),
    ):
        assert np.array_equal(values(made, points), values(wanted, points))


def test_material_and_name_are_kept():
    part = (distal.Box(1) - distal.Sphere(0.6)).paint("#ff0000").named("part").fillet(0.05)
    assert part.name == "part"
    assert part.node.material is not None


@pytest.mark.parametrize("lattice", [distal.Gyroid(0.4), distal.Honeycomb(0.3, 0.04)])
def test_an_infill_fills_a_skin(lattice):
    rng = np.random.default_rng(1)
    points = rng.uniform(-0.6, 0.6, (400, 3))
    ball = distal.Sphere(0.5)
    found = values(ball.infill(lattice, 0.05), points)
    out = np.linalg.norm(points, axis=1) - 0.5
    if lattice.flat:  # upright: its walls run along y, and its own y axis is -z
        inside = values(lattice, points[:, [0, 2]] * [1.0, -1.0])
    else:
        inside = values(lattice, points)
    wanted = np.minimum(np.maximum(out, -0.05 - out), np.maximum(inside, out))
    assert found == pytest.approx(wanted, abs=1e-6)


def test_an_outline_is_extruded_without_end():
    endless = distal.Circle(0.5).extrude(None)
    assert values(endless, [[1.0, 0.0, 1e4], [0.0, 0.0, -9.0]]) == pytest.approx([0.5, -0.5])
    assert endless.bounds()[1][2] == math.inf
    with pytest.raises(ValueError, match="without end has no edges"):
        distal.Circle(0.5).extrude(None, rounding=0.1)


def test_a_relief_stands_out_of_a_cylinder():
    band = distal.Rectangle(1.0, 0.5).wrap_around(2.0, 0.1, depth=0.3)
    assert values(band, [[0, 0, z] for z in (2.2, 2.1, 1.7, 1.5)]) == pytest.approx(
        [0.1, 0.0, 0.0, 0.2], abs=1e-5
    )
    even = distal.Rectangle(1.0, 0.5).wrap_around(2.0, 0.1)
    assert values(even, [[0, 0, 2.2], [0, 0, 1.8]]) == pytest.approx([0.1, 0.1], abs=1e-5)


MISTAKES = [
    (lambda: distal.Sphere(1).fillet(0.1), "the last operation of this shape is 'Sphere'"),
    (lambda: distal.Box(1).fillet(0.1), "RoundBox(size, rounding)"),
    (lambda: distal.Box(1).chamfer(0.1), "ChamferBox(size, bevel)"),
    (
        lambda: (distal.Box(1) | distal.Sphere(0.6)).translate(1, 0, 0).chamfer(0.1),
        "call chamfer right after the operator: (a - b).chamfer(0.1).translate(…)",
    ),
    (
        lambda: (distal.Box(1) - distal.Sphere(0.6)).fillet(-1),
        "'radius of fillet' must be 0 or more",
    ),
    (lambda: distal.Box(1).infill(0.2, 0.1), "an infill is a lattice, not 0.2"),
    (lambda: distal.Circle(1).infill(distal.Gyroid(), 0.1), "an infill is a lattice"),
]


@pytest.mark.parametrize(("make", "message"), MISTAKES)
def test_mistakes_are_named(make, message):
    with pytest.raises((ValueError, TypeError)) as caught:
        make()
    assert message in str(caught.value)
    assert "test_shaped_edges.py" in str(caught.value)
