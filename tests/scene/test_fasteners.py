"""Threads have the pitch and the diameters of their sizes, and bolts and nuts do not overlap."""

from __future__ import annotations

import math

import numpy as np
import pytest

import distal
from distal.lang.runtime_access import executor
from distal.scene.objects.metric_sizes import METRIC

# The value is the distance in the plane through the axis, divided by at most this (M2 to M20).
DIVISOR = 1.01


def values(shape, points):
    return np.asarray(executor().call(shape, (np.asarray(points, float),), {}, device="reference"))


def radii_where_it_ends(shape, angles, heights, low=1.0, high=5.0):
    """The radii of the surface in some directions, by halving."""
    angles, heights = np.broadcast_arrays(angles, heights)
    low, high = np.full(angles.shape, low), np.full(angles.shape, high)
    for _ in range(28):
        middle = 0.5 * (low + high)
        points = [middle * np.cos(angles), heights, -middle * np.sin(angles)]
        rows = np.stack(points, axis=-1).reshape(-1, 3)
        inside = values(shape, rows).reshape(angles.shape) < 0.0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return low


@pytest.mark.parametrize("left", [False, True])
def test_a_thread_has_its_diameters_and_rises_by_its_pitch(left):
    """ISO 68-1, M6: 6 over the crests, 6 - 1.0825 in the grooves, 5.3505 where both are equal."""
    rod = distal.MetricThread("M6", 20.0, left=left)
    sign = -1.0 if left else 1.0
    turns = np.array([[0.0], [0.2], [0.45], [2.3]])
    ends = radii_where_it_ends(rod, math.tau * turns, sign * turns + [0.0, 0.5, 0.25])
    for row in ends:
        assert row == pytest.approx([3.0, 3.0 - 0.541266, 0.5 * 5.350481], abs=2e-6)
    # flanks of 30 degrees to the plane across the axis
    at = radii_where_it_ends(rod, 0.0, [0.15, 0.30])
    assert math.atan2(0.15, at[0] - at[1]) == pytest.approx(math.radians(30.0), abs=1e-5)


def test_sizes_are_those_of_the_standards():
    for name, size in METRIC.items():
        assert float(name[1:]) == size.diameter
        assert size.pitch < size.head < size.nut < size.across < size.diameter * 2.01
        assert size.hole == pytest.approx(size.diameter * 1.1, abs=0.5)
    assert (METRIC["M8"].pitch, METRIC["M8"].across, METRIC["M8"].nut) == (1.25, 13.0, 6.8)


@pytest.mark.parametrize(
    ("size", "left", "clearance"), [("M2", False, 0.05), ("M8", True, 0.15), ("M20", False, 0.2)]
)
def test_a_nut_fits_on_its_bolt_at_every_height(size, left, clearance):
    row = METRIC[size]
    bolt = distal.Bolt(size, 3.0 * row.diameter, left=left)
    nut = distal.Nut(size, gap=clearance, left=left)
    rng = np.random.default_rng(3)
    for height in (-2.4 * row.diameter, -2.0 * row.diameter - 0.37 * row.pitch):
        angle, out = rng.uniform(0.0, math.tau, 20_000), rng.uniform(0.35, 0.6, 20_000)
        y = height + rng.uniform(-0.5, 0.5, 20_000) * row.nut
        out *= row.diameter
        points = np.stack([out * np.cos(angle), y, out * np.sin(angle)], axis=-1)
        a, b = values(bolt, points), values(nut.screwed(height), points)
        # In the middle of the gap both are half of the clearance away, everywhere else one is more.
        gap = np.maximum(a, b)
        assert gap.min() > 0.5 * clearance / DIVISOR
        assert gap.min() < 0.5 * clearance + 0.02 * row.pitch
        turned = nut.screwed(height).rotate(y=math.pi)
        assert np.maximum(a, values(turned, points)).min() < 0.0  # half a pitch out of step


def test_a_bolt_has_its_lengths():
    (low, high) = distal.Bolt("M6", 20.0).bounds()
    assert (low[1], high[1]) == pytest.approx((-20.0, 4.0))
    assert (low[2], high[2]) == pytest.approx((-5.0, 5.0))
    bolt = distal.Bolt("M6", 40.0, thread=12.0)
    shank, *ends = radii_where_it_ends(bolt, 0.0, [-20.0, *np.linspace(-30.0, -31.0, 9)])
    assert shank == pytest.approx(3.0, abs=1e-6)
    assert min(ends) == pytest.approx(3.0 - 0.541266, abs=2e-6)


@pytest.mark.parametrize(("size", "left"), [("M6", False), ("M20", True), ("M2", False)])
def test_the_depth_of_a_thread_falls_to_nothing_before_the_shank(size, left):
    """In the middle of a groove, at some shares of the last pitch; the crests stay."""
    row = METRIC[size]
    crest, depth, plain = 0.5 * row.diameter, 0.541266 * row.pitch, 3.0 * row.pitch
    bolt = distal.Bolt(size, plain + 4.0 * row.pitch, thread=4.0 * row.pitch, left=left)
    shares = np.array([-1.2, -0.5, 0.0, 0.25, 0.5, 0.75, 0.999])
    heights = -plain - row.pitch * (1.0 - shares)
    turns = (-1.0 if left else 1.0) * heights / row.pitch
    low, high = 0.3 * row.diameter, row.diameter
    at_crests = radii_where_it_ends(bolt, math.tau * turns, heights, low, high)
    assert at_crests == pytest.approx(np.full(7, crest), abs=2e-6 * row.diameter)
    in_grooves = radii_where_it_ends(bolt, math.tau * (turns + 0.5), heights, low, high)
    expected = crest - depth * (1.0 - np.maximum(shares, 0.0))
    assert in_grooves == pytest.approx(expected, abs=2e-6 * row.diameter)


def test_a_thread_up_to_the_head_has_its_full_depth():
    bolt = distal.Bolt("M6", 12.0, thread=12.0)
    heights = np.linspace(-0.05, -0.95, 19)
    ends = radii_where_it_ends(bolt, math.tau * (heights + 0.5), heights)
    assert ends == pytest.approx(np.full(19, 3.0 - 0.541266), abs=2e-6)


def test_holes_let_a_bolt_through_or_take_its_thread():
    plain = distal.MetricHole("M6", 8.0, threaded=False)
    assert values(plain, [[3.2, 4.1, 0.0], [3.4, 0.0, 0.0]]) == pytest.approx([-0.1, 0.1], abs=1e-6)
    tapped = distal.MetricHole("M6", 8.0, gap=0.1, through=False)
    ends = radii_where_it_ends(tapped, 0.0, [0.0, 0.5])
    assert ends == pytest.approx([3.1, 3.1 - 0.541266], abs=2e-6)
    assert values(tapped, [[0.0, -5.0, 0.0], [0.0, -3.5, 0.0]]) == pytest.approx(
        [1.0, -0.5], abs=1e-6
    )


def test_lengths_have_units():
    assert (distal.mm, distal.cm, distal.meter) == (1.0, 10.0, 1000.0)
    assert 180 * distal.deg == pytest.approx(math.pi, abs=1e-15)
    assert (distal.inch, distal.foot) == (25.4, pytest.approx(12.0 * 25.4))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: distal.Nut("M7"), "Nut takes a size from M2 to M20, not 'M7'"),
        (lambda: distal.Bolt(6), "Bolt takes a size from M2 to M20, not 6"),
        (
            lambda: distal.Bolt("M6", 10.0, thread=12.0),
            "thread of Bolt must be from its pitch, 1, to its length",
        ),
        (lambda: distal.Bolt("M6", 0.0), "length of Bolt must be above its pitch, 1"),
        (lambda: distal.Bolt("M6", "long"), "length of Bolt is a number, not 'long'"),
        (
            lambda: distal.MetricThread("M6", 9.0, pitch=4.0),
            "pitch may be at most half of diameter",
        ),
        (lambda: distal.MetricThread("M6", -1.0), "length of Thread' must be above 0"),
    ],
)
def test_mistakes_are_named(make, message):
    with pytest.raises((ValueError, TypeError)) as caught:
        make()
    assert message in str(caught.value)
    assert "test_fasteners.py" in str(caught.value)


def test_other_sizes_are_suggested():
    with pytest.raises(ValueError, match="did you mean 'M10'"):
        distal.Nut("M100")
