"""Placements, deformations and repetitions against what they mean, worked out in NumPy."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from distal.fields import ease, extents
from distal.fields.combine.joins import displaced
from distal.fields.deform import solid as deform
from distal.fields.guarantees import UNBOUNDED, Bounds
from distal.fields.place import solid as place
from distal.fields.repeat.along import along_line, along_line_value, around_ring, ring
from distal.fields.repeat.cells import (
    counted,
    endless,
    nearest_copy_distance,
    site_in,
    slope_in,
    value_in,
)
from distal.fields.repeat.polar import (
    repeated_polar,
    repeated_polar_around,
    repeated_polar_slope,
    repeated_polar_value,
)
from distal.lang import func, length, vec2, vec3

POINTS = np.random.default_rng(5).uniform(-3.0, 3.0, (3000, 3))


def about(axis: str, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return {
        "x": np.array([[1, 0, 0], [0, c, -s], [0, s, c]]),
        "y": np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]),
        "z": np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]),
    }[axis]


# Placement: what a shape shows at a turned point is what it showed at the point


def test_rotations_turn_forwards():
    for axis, turned in (("x", place.rotated_x), ("y", place.rotated_y), ("z", place.rotated_z)):
        matrix = about(axis, 0.75)
        assert np.abs(turned(POINTS @ matrix.T, 0.75) - POINTS).max() < 1e-6
        unit = tuple(np.eye(3)["xyz".index(axis)])
        assert np.abs(place.rotated(POINTS @ matrix.T, unit, 0.75) - POINTS).max() < 1e-6


def test_euler_angles_turn_about_fixed_x_then_y_then_z():
    matrix = about("z", -1.0) @ about("y", 0.5) @ about("x", 0.25)
    back = place.rotated_euler(POINTS @ matrix.T, (0.25, 0.5, -1.0))
    assert np.abs(back - POINTS).max() < 1e-6


def test_a_quaternion_turns_by_twice_its_angle():
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    quaternion = (*(axis * np.sin(0.4)), np.cos(0.4))
    there = place.rotated(POINTS, tuple(axis), 0.8)
    assert np.abs(place.rotated_quaternion(POINTS, quaternion) - there).max() < 1e-6


@pytest.mark.parametrize("target", [(0.0, 3.0, 4.0), (-1.0, 0.0, 0.0), (1.0, 0.0, 0.0)])
def test_orient_takes_one_direction_to_the_other_without_mirroring(target):
    unit = np.array(target) / np.linalg.norm(target)
    back = place.oriented(np.array([unit]), (1.0, 0.0, 0.0), target)
    assert np.abs(back - [[1.0, 0.0, 0.0]]).max() < 1e-6
    frame = place.oriented(np.eye(3), (1.0, 0.0, 0.0), target)
    assert np.linalg.det(frame) == pytest.approx(1.0, abs=1e-6)


@func
def stretch_of(a: vec3, b: vec3, c: vec3) -> float:
    return place.largest_stretch(place.mat3(a, b, c))


def test_the_largest_stretch_is_a_tight_bound():
    for seed in range(20):
        m = np.random.default_rng(seed).normal(size=(3, 3)).astype(np.float32)
        true = np.linalg.svd(m)[1][0]
        bound = stretch_of(tuple(m[:, 0]), tuple(m[:, 1]), tuple(m[:, 2]))
        assert true * (1.0 - 1e-5) <= bound <= true * 1.01


def test_a_turned_box_without_end_keeps_its_other_sides():
    box = Bounds((-1.0, -2.0, -UNBOUNDED), (1.0, 2.0, UNBOUNDED))
    turned = place.rotated_z_bounds(box, 0.5 * np.pi)
    assert tuple(turned.low)[:2] == pytest.approx((-2.0, -1.0), abs=1e-5)
    assert tuple(turned.high)[2] >= UNBOUNDED / 1000.0
    leaning = tuple(place.rotated_x_bounds(box, 0.5).high)
    assert leaning[0] == 1.0
    assert min(leaning[1:]) >= UNBOUNDED / 1000.0


def test_the_distance_to_a_box_is_true():
    box = Bounds((-1.0, 0.0, -UNBOUNDED), (1.0, 2.0, UNBOUNDED))
    found = extents.box_distance(np.array([[2.0, 3.0, 9.0], [0.5, 1.0, 0.0]]), box)
    assert found == pytest.approx([np.sqrt(2.0), -0.5])


# Deformation


@pytest.mark.parametrize("way", range(len(ease.EASES)))
def test_an_ease_rises_from_0_to_1_no_faster_than_it_says(way):
    t = np.linspace(-0.5, 1.5, 4001)
    done = ease.eased(t, way)
    rise = np.diff(done) / np.diff(t)
    assert (done[0], done[-1]) == (0.0, 1.0)
    assert way == ease.BOUNCE or rise.min() >= -1e-6
    assert done.min() >= 0.0 and done.max() <= 1.0
    assert np.abs(rise).max() == pytest.approx(ease.ease_slope(way), rel=2e-3)


def test_an_ease_at_its_quarters():
    names = {"quartic": (1 / 32, 31 / 32), "quintic": (1 / 64, 63 / 64)}
    for name, wanted in names.items():
        found = ease.eased(np.array([0.25, 0.75]), ease.EASES.index(name))
        np.testing.assert_allclose(found, wanted)
    # The ball lands at 4, 8 and 10 elevenths of the time; between, it rises a quarter, a sixteenth
    # and a 64th of the way back.
    times = np.array([4, 6, 8, 9, 10, 10.5, 11]) / 11
    heights = [1.0, 0.75, 1.0, 1 - 1 / 16, 1.0, 1 - 1 / 64, 1.0]
    np.testing.assert_allclose(ease.eased(times, ease.BOUNCE), heights)


def test_a_twist_is_as_steep_as_its_shear():
    box = Bounds((-3.0, -1.0, -4.0), (3.0, 1.0, 4.0))
    shear = 0.5 * 5.0
    expected = 0.5 * (shear + np.sqrt(shear**2 + 4.0))
    assert deform.twisted_slope(1.0, box, 0.5) == pytest.approx(expected, rel=1e-6)


def test_what_never_ends_is_not_twisted():
    endless = Bounds((-UNBOUNDED, -1.0, -1.0), (UNBOUNDED, 1.0, 1.0))
    assert deform.twisted_slope(1.0, endless, 0.5) >= UNBOUNDED / 1000.0
    assert deform.bent_slope(1.0, endless, 0.5) >= UNBOUNDED / 1000.0
    assert deform.tapered_slope(1.0, endless, 0.0, 1.0, 0.5) >= UNBOUNDED / 1000.0


# Repetition: a ball off its cell's middle, and all its copies

BALL, RADIUS = np.array([0.2, -0.1, 0.15]), 0.25
SPACING = (1.0, 1.25, 0.75)


@func
def ball(p: vec3) -> float:
    return length(p - vec3(0.2, -0.1, 0.15)) - 0.25


@func
def ball_in(p: vec3, cell: vec3) -> float:
    return ball(p)


@func
def ball_box(unused: float) -> Bounds:
    middle = vec3(0.2, -0.1, 0.15)
    return Bounds(middle - 0.25, middle + 0.25)


def nearest(points: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    away = points[:, None, :] - (BALL + offsets)[None, :, :]
    return np.linalg.norm(away, axis=2).min(axis=1) - RADIUS


GRID = np.array(list(product(range(-6, 7), repeat=3))) * SPACING
BLOCK = np.array([(x, 0, z) for x in (-0.5, 0.5) for z in (-1, 0, 1)]) * SPACING


@func
def in_cells(p: vec3) -> float:
    copies, box = endless(vec3(1.0, 1.25, 0.75)), ball_box(0.0)
    return value_in(ball(site_in(p, copies, box).p), p, copies, box, False)


@func
def in_neighbors(p: vec3) -> float:
    return nearest_copy_distance(ball_in, p, endless(SPACING), ball_box(0.0), 1, False)


@func
def in_more_neighbors(p: vec3) -> float:
    return nearest_copy_distance(ball_in, p, endless(SPACING), ball_box(0.0), 2, False)


@func
def in_block(p: vec3) -> float:
    copies, box = counted(vec3(1.0, 1.25, 0.75), 2, 1, 3), ball_box(0.0)
    return value_in(ball(site_in(p, copies, box).p), p, copies, box, True)


@func
def in_block_neighbors(p: vec3) -> float:
    return nearest_copy_distance(ball_in, p, counted(SPACING, 2, 1, 3), ball_box(0.0), 1, True)


@func
def on_line(p: vec3) -> float:
    start, end, box = vec3(-1.0, 0.0, 0.0), vec3(1.0, 1.0, 0.0), ball_box(0.0)
    site = along_line(p, start, end, 3, box)
    return along_line_value(ball(site.p), p, start, end, 3, box)


LINE = np.array([(-1.0, 0.0, 0.0), (0.0, 0.5, 0.0), (1.0, 1.0, 0.0)])


@func
def on_ring(p: vec3) -> float:
    return around_ring(ball_in, p, ring(vec2(1.0, 0.75), 4, 3), ball_box(0.0))


RING = np.array(
    [(x - 1.5, 0.0, (z - 1.0) * 0.75) for x in range(4) for z in range(3) if x in (0, 3) or z != 1]
)

ALL = [
    pytest.param(in_cells, GRID, id="cells"),
    pytest.param(in_neighbors, GRID, id="neighbors"),
    pytest.param(in_more_neighbors, GRID, id="more neighbors"),
    pytest.param(in_block, BLOCK, id="block"),
    pytest.param(in_block_neighbors, BLOCK, id="block, neighbors"),
    pytest.param(on_line, LINE, id="line"),
    pytest.param(on_ring, RING, id="ring"),
]


@pytest.mark.parametrize(("field", "offsets"), ALL)
def test_a_repetition_is_the_union_of_its_copies(field, offsets):
    """The same surface; outside never more than the distance; inside it exactly."""
    rng = np.random.default_rng(6)
    close = BALL + offsets[rng.integers(len(offsets), size=1000)]
    points = np.concatenate([POINTS, close + rng.uniform(-0.3, 0.3, (1000, 3))])
    true = nearest(points, offsets)
    found = field(points)
    inside = true < 0.0
    assert inside.sum() > 200
    assert np.abs(found - true)[inside].max() < 1e-6
    assert (found[~inside] > 0.0).all()
    assert (found - true).max() < 1e-6


@pytest.mark.parametrize(("field", "offsets"), ALL[1:3])
def test_neighbors_make_a_repetition_exact(field, offsets):
    assert np.abs(field(POINTS) - nearest(POINTS, offsets)).max() < 1e-6


@pytest.mark.parametrize(("field", "offsets"), ALL)
def test_a_march_arrives_in_few_steps(field, offsets):
    """The bound by boxes must not make a march crawl: not far away, not between the copies."""
    rng = np.random.default_rng(8)
    steps = []
    for _ in range(200):
        p = rng.normal(size=(1, 3))
        p *= 20.0 / np.linalg.norm(p)
        aim = BALL + offsets[rng.integers(len(offsets))] * (0.0 if offsets is GRID else 1.0)
        direction = aim - p
        direction /= np.linalg.norm(direction)
        count, gone = 0, 0.0
        while count < 400 and gone < 24.0:
            d = field(p)[0]
            if d < 1e-4:
                break
            p = p + direction * d
            gone += d
            count += 1
        steps.append(count)
    assert np.mean(steps) < 60.0
    assert max(steps) < 400


def test_the_index_of_the_cell():
    spacing = (1.0, 0.0, 2.0)
    box = Bounds((-0.1, -0.1, -0.1), (0.1, 0.1, 0.1))
    site = site_in((2.9, 7.0, -3.25), endless(spacing), box)
    assert tuple(site.cell) == (3.0, 0.0, -2.0)
    assert tuple(site.p) == pytest.approx((-0.1, 7.0, 0.75), abs=1e-6)
    last = site_in((9.0, 0.0, -9.0), counted(spacing, 4, 1, 3), box)
    assert tuple(last.cell) == (3.0, 0.0, 0.0)
    assert tuple(last.p) == pytest.approx((7.5, 0.0, -7.0))


def test_what_does_not_fit_its_cell_has_no_slope():
    box = Bounds((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))
    assert slope_in(1.0, box, endless((1.0, 2.0, 2.0)), 0) >= UNBOUNDED / 1000.0
    assert slope_in(1.0, box, endless((1.1, 0.0, 2.0)), 0) == 1.0
    assert slope_in(1.0, box, endless((1.0, 2.0, 2.0)), 1) == 1.0
    assert slope_in(1.0, box, endless((0.5, 2.0, 2.0)), 1) >= UNBOUNDED / 1000.0
    assert slope_in(1.0, box, endless((0.5, 2.0, 2.0)), 2) == 1.0
    assert repeated_polar_slope(1.0, box, 3) >= UNBOUNDED / 1000.0


@func
def carousel(p: vec3) -> float:
    box = Bounds(vec3(1.0, -0.25, -0.25), vec3(1.5, 0.25, 0.25))
    q = repeated_polar(p, 7, box).p
    return repeated_polar_value(length(q - vec3(1.25, 0.0, 0.0)) - 0.25, p, 7, box)


@func
def rider(p: vec3) -> float:
    return length(p - vec3(1.25, 0.0, 0.0)) - 0.25


@func
def rider_in(p: vec3, cell: vec3) -> float:
    return rider(p)


@func
def carousel_neighbors(p: vec3) -> float:
    box = Bounds(vec3(1.0, -0.25, -0.25), vec3(1.5, 0.25, 0.25))
    return repeated_polar_around(rider_in, p, 7, box, 1)


@pytest.mark.parametrize("field", [carousel, carousel_neighbors])
def test_polar_copies_are_turned_about_the_y_axis(field):
    angles = 2.0 * np.pi * np.arange(7) / 7.0
    middles = 1.25 * np.stack([np.cos(angles), 0.0 * angles, -np.sin(angles)], axis=1)
    true = np.linalg.norm(POINTS[:, None] - middles[None], axis=2).min(axis=1) - 0.25
    found = field(POINTS)
    assert np.abs(found - true)[true < 0.0].max() < 1e-5
    assert (found - true).max() < 1e-5
    assert (found[true > 1e-4] > 0.0).all()


def test_polar_copies_are_counted_from_above():
    box = Bounds((0.9, -0.1, -0.1), (1.1, 0.1, 0.1))
    for k in range(4):
        angle = 0.5 * np.pi * k + 0.1
        site = repeated_polar((np.cos(angle), 0.0, -np.sin(angle)), 4, box)
        assert tuple(site.cell) == (float(k), 0.0, 0.0)


def test_a_field_above_0_moves_the_surface_out():
    assert displaced(0.25, 0.5, 0.5) == 0.0
    assert displaced(0.5, 9.0, 0.5) == 0.0
