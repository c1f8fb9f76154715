"""What ``measure`` says of volume and area, against closed forms, proofs and finer tolerances."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import Box, Cylinder, Prism, Sphere, union
from distal.mesh import measuring, rungs
from distal.scene.tree.errors import SceneValueError
from tests.mesh.closed_volumes import BALL, KINDS, deviations, solid

SMALL_BALLS = union(
    *(
        Sphere(0.1).translate(i * 37 % 30 * 2.0, i * 17 % 30 * 2.0, i * 7 % 30 * 2.0)
        for i in range(30)
    )
)


@pytest.mark.parametrize("number", [7, 16, 24, 47])
def test_closed_volumes_are_within_their_errors(number):
    closed = solid(number, 1)
    found = closed.shape.measure()
    for name, off in deviations(found, closed):
        assert off <= 1.0, (closed.kind, name)
    # An error that holds everything says nothing.
    assert found.volume.error < 0.02 * closed.volume


@pytest.mark.parametrize("number", [252, 279])
def test_areas_that_show_an_order_or_agree_by_chance_are_within_their_errors(number):
    """A rod whose three meshes show the second order; a frustum whose coarse meshes agree."""
    closed = solid(number)
    for name, off in deviations(closed.shape.measure(), closed):
        assert off <= 1.0, (closed.kind, name)


def test_the_generator_has_every_kind():
    assert {solid(i).kind.split()[0] for i in range(len(KINDS))} == set(KINDS)


def test_smooth_volumes_are_of_the_fourth_order():
    found = Sphere(1.0).measure()
    assert abs(found.volume.value - BALL) < 1e-7 < found.volume.error < 1e-6
    assert abs(found.area.value - 4.0 * math.pi) < 1e-5
    assert np.abs(np.array(found.inertia.value) - 0.4 * BALL * np.eye(3)).max() < 1e-7


def test_small_balls_in_a_wide_box_are_all_there():
    found = SMALL_BALLS.measure()
    true = 30 * BALL * 1e-3
    assert abs(found.volume.value - true) <= found.volume.error < 0.01 * true
    assert not found.warnings


@pytest.mark.parametrize("thickness", [1e-3, 1e-4])
def test_the_error_of_a_shell_that_meshes_miss_holds_its_volume(thickness):
    found = (Sphere(1.0) - Sphere(1.0 - thickness)).measure()
    true = BALL * (1.0 - (1.0 - thickness) ** 3)
    assert abs(found.volume.value - true) <= found.volume.error
    assert "parts of it are missing; give a smaller feature=" in found.warnings[0]


def test_a_disc_that_no_mesh_shows_is_refused_with_its_thickness():
    with pytest.raises(SceneValueError, match=r"nothing of 'Box' is as thick as .* is thinner at"):
        Box((1.0, 1.0, 1e-5)).measure()


@pytest.mark.parametrize("apart", [10.0, 500.0, 5000.0])
def test_two_small_balls_far_apart_have_an_inside(apart):
    ball = Sphere(0.01)
    found = (ball | ball.translate(apart, 0, 0)).measure()
    assert abs(found.volume.value - 2.0 * BALL * 1e-6) <= found.volume.error < BALL * 1e-6


@pytest.mark.parametrize(
    ("solid", "words"),
    [
        (Sphere(0.01) | Sphere(0.01).translate(3e4, 0, 0), "nothing of 'union' is as thick as"),
        (Sphere(1.0) - Sphere(1.0), "'difference' has no inside"),
        (Sphere(1.0) - Sphere(2.0), "'difference' has no inside"),
    ],
)
def test_no_mesh_has_its_true_reason(solid, words):
    with pytest.raises(SceneValueError, match=words):
        solid.measure()


def test_what_meshes_miss_is_held_by_the_error_and_said(monkeypatch):
    # So few bricks that no mesh shows the balls.
    monkeypatch.setattr(rungs, "_BRICKS", 1)
    found = SMALL_BALLS.measure()
    true = 30 * BALL * 1e-3
    assert abs(found.volume.value - true) <= found.volume.error
    assert "parts of it are missing; give a smaller feature=" in found.warnings[0]
    assert found.high.error > 1.0


def test_a_volume_outside_the_proof_is_moved_and_said(monkeypatch):
    monkeypatch.setattr(rungs, "_ROUGH", 0.0)
    real = rungs.integrals_of

    def wrong(*args):
        integrals = real(*args)
        return rungs.Integrals(
            **{name: getattr(integrals, name) for name in integrals.__slots__ if name != "volume"},
            volume=0.8 * integrals.volume,
        )

    monkeypatch.setattr(rungs, "integrals_of", wrong)
    found = Box(1.0).measure(proved=True, work=10_000)
    lower, upper = found.brackets.volume
    assert lower <= found.volume.value <= upper
    assert abs(found.volume.value - 1.0) <= found.volume.error
    assert "the meshes miss parts of" in found.warnings[0]


def stepped_shaft():
    shaft = Cylinder(10, 20) | Cylinder(7, 30).translate(y=25) | Cylinder(5, 15).translate(y=47.5)
    return shaft.rotate(x=0.3, z=0.5), math.pi * (100 * 20 + 49 * 30 + 25 * 15)


def socket_screw():
    socket = Prism(3.0, 8, count=6).rotate(x=math.pi / 2).translate(y=8)
    screw = (Cylinder(6.5, 8).translate(y=4) - socket) | Cylinder(4, 30).translate(y=-15)
    volume = math.pi * (6.5**2 * 8 + 16 * 30) - 6 * 9 * math.tan(math.pi / 6) * 4
    return screw, volume


@pytest.mark.parametrize(
    ("make", "asked"),
    [
        (stepped_shaft, {"tolerance": 0.05}),
        (stepped_shaft, {"feature": 1.0}),
        (stepped_shaft, {"volume_tolerance": 0.5}),
        (socket_screw, {"tolerance": 0.05}),
    ],
)
def test_asking_for_more_neither_enlarges_nor_leaves_the_error(make, asked):
    shape, true = make()
    usual, finer = shape.measure(), shape.measure(**asked)
    assert finer.volume.error <= usual.volume.error
    for found in (usual, finer):
        assert abs(found.volume.value - true) <= found.volume.error
    assert finer.volume.error <= asked.get("volume_tolerance", math.inf)


def test_a_tolerance_of_the_volume_that_is_too_fine_says_what_is_reached(monkeypatch):
    monkeypatch.setattr(rungs, "_BRICKS_OF_TOLERANCE", 500)
    with pytest.raises(SceneValueError) as caught:
        Cylinder(0.5, 1.0).rotate(x=0.3).measure(volume_tolerance=1e-12)
    assert "more than its tolerance, 1e-12: finer cells than" in str(caught.value)
    assert "volume_tolerance=" in str(caught.value)


@pytest.mark.parametrize("wrong", [0, -1.0, math.nan, True, "1"])
def test_a_wrong_tolerance_of_the_volume_is_refused(wrong):
    with pytest.raises(SceneValueError, match="a volume_tolerance is a number above 0, not"):
        Sphere(1.0).measure(volume_tolerance=wrong)


@pytest.mark.parametrize("far", [1e4, 1e6, 1e9])
def test_a_solid_far_away_is_measured_or_refused(far):
    found = Sphere(1.0).translate(far, -far, 0.3 * far).measure()
    assert abs(found.volume.value - BALL) <= found.volume.error < 0.01
    assert measuring.Quantity(found.center.value, 0.0).value == pytest.approx(
        [far, -far, 0.3 * far], abs=found.center.error
    )
