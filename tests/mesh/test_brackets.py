"""What is proved of volume, mass, center and box, against closed forms and wrong slopes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import Box, Cone, Cylinder, Shape, Sphere, Torus
from distal.lang import exp, func, length, sin, slider, vec3
from distal.mesh import certain_boxes
from distal.mesh.brackets import brackets_of
from distal.mesh.certain_boxes import Effort, SlopeJudge, divided
from distal.mesh.kernels import FieldKernels
from distal.mesh.meshing import MeshRequest, extent_of
from distal.scene.tree.errors import SceneValueError

TURN = {"x": 0.3, "y": 0.5, "z": 0.7}
BALL = 4.0 / 3.0 * math.pi


def proved(shape, work=30_000, width=0.0, density=1.0, params=None):
    kernels = FieldKernels(shape.node, params or {}, 0.0)
    extent = extent_of(shape.node, MeshRequest(params=params or {}))
    effort = Effort(width, work)
    return brackets_of(kernels, extent, lambda share: None, effort, density)


CLOSED = [
    (Sphere(1.0), BALL, (0, 0, 0), (-1, -1, -1), (1, 1, 1)),
    (Sphere(1e-3), BALL * 1e-9, (0, 0, 0), (-1e-3,) * 3, (1e-3,) * 3),
    (Sphere(1e4), BALL * 1e12, (0, 0, 0), (-1e4,) * 3, (1e4,) * 3),
    # Far away: there, numbers of 32 bits are 1e-3 apart.
    (
        Sphere(0.25).translate(1e4, -1e4, 7.0),
        BALL / 64.0,
        (1e4, -1e4, 7.0),
        (9999.75, -10000.25, 6.75),
        (10000.25, -9999.75, 7.25),
    ),
    # A sheet, and a shell of a thousandth of its size.
    (Box(1.0, 1.0, 1e-4), 1e-4, (0, 0, 0), (-0.5, -0.5, -5e-5), (0.5, 0.5, 5e-5)),
    (
        Sphere(1.0) - Sphere(0.999),
        BALL * (1.0 - 0.999**3),
        (0, 0, 0),
        (-1, -1, -1),
        (1, 1, 1),
    ),
    (Box(2.0, 1.0, 0.5).rotate(**TURN), 1.0, (0, 0, 0), None, None),
    (Torus(1.0, 0.05), 2 * math.pi**2 * 0.05**2, (0, 0, 0), None, None),
    (
        Cylinder(0.5, 2.0).translate(3.0, -4.0, 5.0),
        0.5 * math.pi,
        (3, -4, 5),
        (2.5, -5, 4.5),
        (3.5, -3, 5.5),
    ),
    # A half ball: its center is 3/8 of the radius above the cut.
    (
        Sphere(1.0) & Box(4.0, 2.0, 4.0).translate(y=1.0),
        BALL / 2.0,
        (0, 0.375, 0),
        (-1, 0, -1),
        (1, 1, 1),
    ),
    # An L of three cubes.
    (
        Box(2.0, 1.0, 1.0) | Box(1.0).translate(-0.5, 1.0, 0.0),
        3.0,
        (-1 / 6, 1 / 3, 0),
        (-1, -0.5, -0.5),
        (1, 1.5, 0.5),
    ),
    (Sphere(1.0).shell(0.2, where="center"), BALL * (1.1**3 - 0.9**3), (0, 0, 0), None, None),
]


@pytest.mark.parametrize(("shape", "volume", "center", "low", "high"), CLOSED)
@pytest.mark.parametrize("work", [1, 60, 30_000])
def test_closed_forms_are_within_what_intervals_prove(shape, volume, center, low, high, work):
    found = proved(shape, work)
    assert found.slope is None and found.reason == ""
    assert found.boxes <= work
    assert found.volume[0] <= volume <= found.volume[1]
    for name, true in (("center", center), ("low", low), ("high", high)):
        if true is not None:
            least, most = (np.array(corner) for corner in getattr(found, name))
            # The true places are rounded to 64 bits here.
            rounding = 1e-15 * np.abs(true).max()
            assert (least <= np.array(true) + rounding).all(), name
            assert (np.array(true) - rounding <= most).all(), name
    # A shell of a thousandth of its width has no box of this many inside.
    if work == 30_000 and found.volume[0] > 0.1 * volume:
        assert found.undecided < 0.1
        widths = np.subtract(*found.center[::-1])
        assert (widths < np.subtract(found.high[1], found.low[0])).all()


@func
def steep_ball(p: vec3) -> float:
    """A ball of radius 1 whose value changes three times as fast as it says."""
    return 3.0 * (length(p) - 1.0) + 0.4 * sin(9.0 * p.x) * sin(9.0 * p.y) * exp(-p.z * p.z)


def test_a_wrong_slope_does_not_matter():
    """The volume by random points, of a shape that says it is three times less steep."""
    lying = Shape.from_function(steep_ball, slope=1.0, bounds=((-1.3,) * 3, (1.3,) * 3))
    rng = np.random.default_rng(7)
    points = rng.uniform(-1.3, 1.3, (200_000, 3))
    x, y, z = points.T
    inside = 3.0 * (np.linalg.norm(points, axis=1) - 1.0) + 0.4 * np.sin(9.0 * x) * np.sin(
        9.0 * y
    ) * np.exp(-z * z)
    share = float((inside < 0.0).mean())
    volume, error = 2.6**3 * share, 2.6**3 * 5.0 * math.sqrt(share / 2e5)
    found = proved(lying, 60_000)
    assert found.slope is None
    assert found.volume[0] <= volume + error and volume - error <= found.volume[1]
    assert found.width < 0.05
    # The slope, taken at its word, would exclude the truth.
    kernels = FieldKernels(lying.node, {}, 0.0)
    extent = extent_of(lying.node, MeshRequest())
    judge = SlopeJudge(kernels, extent.slopes.slope)
    wrong = divided(extent.low, extent.high, judge, Effort(0.0, 60_000), lambda share: None)
    assert (
        not wrong.volume <= volume + error or not volume - error <= wrong.volume + wrong.undecided
    )


def test_bounds_become_narrower_until_the_width_is_reached():
    widths = [proved(Sphere(1.0), work).width for work in (1_000, 10_000, 100_000)]
    # Ten times the boxes, a tenth of the width: it falls as the square of their sides.
    assert widths[1] < 0.15 * widths[0] and widths[2] < 0.15 * widths[1]
    enough = proved(Sphere(1.0), 4_000_000, width=0.02)
    assert enough.reached and enough.width <= 0.02 and enough.boxes < 50_000
    short = proved(Sphere(1.0), 1_000, width=0.001)
    assert not short.reached and short.boxes <= 1_000


@pytest.mark.parametrize(
    "shape",
    [
        Box(2.0, 1.0, 0.5),
        Box(1.0, 1.0, 1e-4),
        Box(3.0) - Box(1.0),
        Box(2.0, 1.0, 1.0) | Box(1.0).translate(-0.5, 1.0, 0.0),
    ],
)
def test_flat_faces_are_found_to_many_digits(shape):
    found = proved(shape, 30_000)
    assert found.width < 1e-4
    assert np.subtract(found.center[1], found.center[0]).max() < 1e-4


def test_turned_faces_are_between_planes():
    found = proved(Box(2.0, 1.0, 0.5).rotate(**TURN), 30_000)
    assert found.volume[0] <= 1.0 <= found.volume[1] and found.width < 0.02


def test_a_field_without_intervals_is_bounded_by_its_slope_and_says_so():
    axis = np.linspace(-1.5, 1.5, 25)
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    values = np.sqrt(x * x + y * y + z * z) - 1.0
    shape = Shape.from_volume(values, spacing=0.125, axes="xyz")
    found = proved(shape, 100_000)
    assert found.reason == "it reads a texture" and found.slope == pytest.approx(3.0**0.5)
    assert found.volume[0] < BALL < found.volume[1]


def test_parameters_and_density_are_those_of_the_measure():
    size = slider("size", 1.0, low=0.5, high=3.0)
    found = proved(Sphere(size), params={"size": 2.0}, density=5.0)
    assert found.volume[0] <= 8.0 * BALL <= found.volume[1]
    assert found.mass == pytest.approx([5.0 * end for end in found.volume])
    measured = Cone(1.0, 2.0).measure(2.0, tolerance=0.02, proved=True, work=50_000)
    assert measured.brackets.mass[0] <= measured.mass.value <= measured.brackets.mass[1]
    json = measured.as_json()["proved"]
    assert json["slope"] is None and json["reached"] and json["boxes"] <= 50_000
    assert json["volume"][0] <= 2.0 / 3.0 * math.pi <= json["volume"][1]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"width": 0.1}, "'width' is for proved bounds"),
        ({"work": 10}, "'work' is for proved bounds"),
        (
            {"proved": True, "width": -1},
            "the width of proved bounds is a share from 0 to 2, not -1",
        ),
        ({"proved": True, "width": math.nan}, "the width of proved bounds is a share from 0 to 2"),
        ({"proved": True, "width": "x"}, "is a share from 0 to 2, not 'x'"),
        (
            {"proved": True, "work": 0},
            "the work for proved bounds is 1 to 1,000,000,000 boxes, not 0",
        ),
        ({"proved": True, "work": 1.5}, "is 1 to 1,000,000,000 boxes, not 1.5"),
    ],
)
def test_a_wrong_effort_is_refused(given, message):
    with pytest.raises(SceneValueError) as caught:
        Box(1.0).measure(**given)
    assert message in str(caught.value)


def test_long_fields_do_without_gradients(monkeypatch):
    monkeypatch.setattr(certain_boxes, "_LONGEST", 10)
    found = proved(Sphere(1.0), 10_000)  # 11 operations
    assert found.volume[0] <= BALL <= found.volume[1]
    assert 0.05 < found.width < 1.0
