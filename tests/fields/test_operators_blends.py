"""Blends and edges against numbers worked out by hand."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import pytest

from distal.fields.combine import blends as edges
from distal.fields.combine import edge_profiles, joins, smooth
from distal.fields.combine.blends import BLENDS, COMBINATIONS, UNION_BLENDS

PLAIN = [name for name, blend in BLENDS.items() if not blend.counted]
SMOOTH = [
    "quadratic",
    "cubic",
    "quartic",
    "circular",
    "circular_geometric",
    "exponential",
    "root",
    "sigmoid",
]
RNG = np.random.default_rng(3)
A = RNG.uniform(-1.0, 1.0, 4000)
B = RNG.uniform(-1.0, 1.0, 4000)


@pytest.mark.parametrize("name", SMOOTH)
@pytest.mark.parametrize("k", [0.01, 0.3, 2.0])
def test_k_is_how_far_the_surface_moves_where_both_are_equal(name, k):
    at_surface = BLENDS[name].union(np.array([k]), np.array([k]), k)
    assert at_surface[0] == pytest.approx(0.0, abs=1e-7 * max(k, 1.0))


@pytest.mark.parametrize("name", [n for n in SMOOTH if n != "circular_geometric"])
def test_where_both_are_zero_the_blend_is_minus_k(name):
    assert BLENDS[name].union(0.0, 0.0, 0.25) == pytest.approx(-0.25, abs=1e-6)


def test_the_rounded_right_angle_is_a_quarter_circle():
    radius = 0.5
    angle = np.linspace(0.0, 0.5 * np.pi, 20)
    a, b = radius - radius * np.cos(angle), radius - radius * np.sin(angle)
    assert np.abs(smooth.round_corner(a, b, radius)).max() < 1e-12


def test_the_seeds_units():
    """The cubic form's .3 is smooth=0.05, the quadratic form's .3 is smooth=0.075."""
    h = np.maximum(0.3 - np.abs(A - B), 0.0) / 0.3
    cubic = np.minimum(A, B) - h**3 * 0.3 / 6.0
    quadratic = np.minimum(A, B) - h**2 * 0.3 / 4.0
    # the numbers of a call are floats of 32 bits
    assert np.abs(smooth.cubic(A, B, 0.05) - cubic).max() < 1e-8
    assert np.abs(smooth.quadratic(A, B, 0.075) - quadratic).max() < 1e-8


@pytest.mark.parametrize("name", PLAIN)
def test_without_size_a_blend_is_the_sharp_minimum(name):
    blend = BLENDS[name]
    assert np.abs(blend.union(A, B, 0.0) - np.minimum(A, B)).max() < 1e-12
    share = blend.mix(A, B, 0.0)
    assert np.abs(share - np.where(B < A, 1.0, 0.0)).max() < 1e-12


@pytest.mark.parametrize("name", ["columns", "stairs"])
def test_without_size_counted_edges_are_sharp(name):
    assert np.abs(BLENDS[name].union(A, B, 0.0, 3) - np.minimum(A, B)).max() < 1e-12


@pytest.mark.parametrize("name", SMOOTH)
def test_the_share_is_the_derivative_by_the_second(name):
    blend, step, k = BLENDS[name], 1e-6, 0.1
    by_a = (blend.union(A + step, B, k) - blend.union(A - step, B, k)) / (2.0 * step)
    by_b = (blend.union(A, B + step, k) - blend.union(A, B - step, k)) / (2.0 * step)
    away = np.abs(A - B) > 1e-4  # the quarter circle's floor has a crease there
    assert np.abs(blend.mix(A, B, k) - by_b / (by_a + by_b))[away].max() < 1e-6


@pytest.mark.parametrize("name", [n for n in PLAIN if BLENDS[n].local])
def test_local_blends_are_the_minimum_far_away(name):
    far = np.abs(A - B) > 0.6
    outside = far & (np.minimum(A, B) > -0.05)
    union = BLENDS[name].union(A, B, 0.05)
    assert np.array_equal(union[outside], np.minimum(A, B)[outside])


def test_the_exponential_is_the_same_in_any_order():
    c = RNG.uniform(-1.0, 1.0, 4000)
    one = smooth.exponential(smooth.exponential(A, B, 0.1), c, 0.1)
    other = smooth.exponential(A, smooth.exponential(c, B, 0.1), 0.1)
    assert np.abs(one - other).max() < 1e-9


def test_the_power_blend_keeps_the_surface():
    union = smooth.power_union(A, B, 4.0)
    assert np.array_equal(union <= 0.0, np.minimum(A, B) <= 0.0)
    assert smooth.power_union(1.0, 1.0, 2.0) == pytest.approx(math.sqrt(0.5), abs=1e-6)


def test_a_chamfer_runs_from_one_surface_to_the_other():
    assert edge_profiles.chamfer(0.2, 0.0, 0.2) == pytest.approx(0.0, abs=1e-7)
    assert edge_profiles.chamfer(0.1, 0.1, 0.2) == pytest.approx(0.0, abs=1e-7)
    assert edge_profiles.chamfer(0.3, 0.3, 0.2) == pytest.approx(0.4 * math.sqrt(0.5), abs=1e-6)


def test_stairs_have_treads_and_risers():
    """Two steps of 0.2 in the corner: the first ends where a is 0.2, the second at 0.4."""
    stairs = edge_profiles.stairs
    for a, b in ((0.1, 0.2), (0.2, 0.1), (0.2, 0.15), (0.15, 0.2)):
        assert stairs(a, b, 0.4, 2) == pytest.approx(0.0, abs=1e-6), (a, b)
    assert stairs(0.1, 0.25, 0.4, 2) == pytest.approx(0.05, abs=1e-6)
    assert stairs(0.5, 0.05, 0.4, 2) == pytest.approx(0.05, abs=1e-6)


def test_columns_stand_side_by_side_in_the_corner():
    k, count = 1.0, 3
    radius = k * math.sqrt(0.5) / (count - 1 + math.sqrt(0.5))
    wall = radius * (count - 1 - math.sqrt(0.5))
    u = wall + radius  # the middle column's front
    a = b = u * math.sqrt(0.5)
    assert edge_profiles.columns(a, b, k, count) == pytest.approx(0.0, abs=1e-6)
    beside = wall * math.sqrt(0.5), wall * math.sqrt(0.5)
    assert edge_profiles.columns(*beside, k, count) < -0.9 * radius
    v = radius  # where two columns touch, the wall is as deep as their middles
    a, b = (wall - v) * math.sqrt(0.5), (wall + v) * math.sqrt(0.5)
    assert edge_profiles.columns(a, b, k, count) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("name", PLAIN)
def test_the_other_combinations_follow_from_the_union(name):
    union = BLENDS[name].union
    intersection = COMBINATIONS["intersection", name].combine
    difference = COMBINATIONS["difference", name].combine
    assert np.abs(intersection(A, B, 0.1) + union(-A, -B, 0.1)).max() < 1e-12
    assert np.abs(difference(A, B, 0.1) + union(-A, B, 0.1)).max() < 1e-12


COMBINING: Final = [
    *(row for (_, name), row in COMBINATIONS.items() if name != "power"),
    *(joins.UNION, joins.INTERSECTION, joins.DIFFERENCE, joins.XOR),
    *(edges.PIPE, edges.ENGRAVE, edges.GROOVE, edges.TONGUE),
]


@pytest.mark.parametrize("row", COMBINING, ids=lambda row: row.name)
def test_every_combination_rises_no_faster_than_it_says(row):
    numbers = {"smooth": 0.2, "radius": 0.2, "count": 3, "depth": 0.1, "width": 0.1}
    # What is cut by a box is the larger of the blend and of a distance, whose slope is 1.
    cut = row in UNION_BLENDS and UNION_BLENDS[row].cut
    combine = UNION_BLENDS[row].union if cut else row.combine
    wanted = combine.python_function.__code__
    given = {n: numbers[n] for n in wanted.co_varnames[2 : wanted.co_argcount]}
    step = 1e-6
    here = combine(A, B, **given)
    by_a = np.abs(combine(A + step, B, **given) - here) / step
    by_b = np.abs(combine(A, B + step, **given) - here) / step
    promised = 1.0 if row.slope is None else row.slope(1.0, 1.0)
    # parallel gradients are the worst case: both rises add up
    assert (by_a + by_b).max() <= promised + 1e-4
    share = np.zeros(1)
    if row.mix is not None:
        wanted = row.mix.python_function.__code__
        given = {n: numbers[n] for n in wanted.co_varnames[2 : wanted.co_argcount]}
        share = np.asarray(row.mix(A, B, **given))
    assert share.min() >= 0.0
    assert share.max() <= 1.0
