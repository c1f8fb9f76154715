"""The checks themselves: each notices a shape that is broken on purpose."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from distal.fields.guarantees import (
    EXACT,
    LOWER_BOUND,
    NOTHING,
    Bounds,
    Guarantee,
    Limit,
    Primitive,
)
from distal.lang import abs, func, length, max, min, normalize, select, vec2, vec3
from tests.fields.checks import examined, numbers_hold
from tests.fields.drawing import default_sample, random_sample
from tests.fields.library import measured
from tests.fields.subject import subject_of


@func
def ball_bounds(radius: float) -> Bounds:
    return Bounds(vec3(-radius), vec3(radius))


@func
def small_bounds(radius: float) -> Bounds:
    return Bounds(vec3(-radius), vec3(radius, 0.9 * radius, radius))


@func
def ball(p: vec3, radius: float = 1.0) -> float:
    """A sound shape.

    Measured:
        ball((2.0, 0.0, 0.0)) = 1.0
        ball((0.0, 3.0, 0.0), 0.5) = 2.5
    """
    return length(p) - radius


@func
def steep_ball(p: vec3, radius: float = 1.0) -> float:
    return 1.01 * (length(p) - radius)


@func
def steep_at_one_place(p: vec3, radius: float = 1.0) -> float:
    d = length(p) - radius
    return d + 0.02 * max(0.0, 1.0 - 4.0 * length(p - vec3(1.3, 0.3, 0.2)))


@func
def ball_with_a_step(p: vec3, radius: float = 1.0) -> float:
    return length(p) - radius + select(p.x > 1.8, 0.01, 0.0)


@func
def shell(p: vec3, radius: float = 1.0) -> float:
    return abs(length(p) - radius)


@func
def half_turned_out(p: vec3, radius: float = 1.0) -> float:
    d = length(p) - radius
    return select(p.x > 0.0, d, -d)


@func
def blunt_box(p: vec3, radius: float = 1.0) -> float:
    q = abs(p) - radius
    return max(q.x, q.y, q.z)


@func
def two_balls(p: vec3, radius: float = 1.0) -> float:
    shift = vec3(0.4 * radius, 0.0, 0.0)
    return min(length(p - shift), length(p + shift)) - 0.6 * radius


@func
def ball_without_a_pole(p: vec3, radius: float = 1.0) -> float:
    return length(normalize(p) * length(p)) / (length(p) / length(p)) - radius


@func
def ball_of_eighth_powers(p: vec3, radius: float = 1.0) -> float:
    q = p * p
    r = q * q
    return (r.x * r.x + r.y * r.y + r.z * r.z) ** 0.125 - radius


@func
def flat_ball(p: vec2, radius: float = 1.0) -> float:
    return length(p) - radius


BALL = Primitive("Ball", ball, EXACT, bounds=ball_bounds, limits={"radius": Limit.POSITIVE})


def found(row: Primitive) -> str:
    return "\n".join(examined(subject_of(default_sample(row)), 1).findings)


def test_a_sound_shape_passes():
    rng = np.random.default_rng(4)
    for sample in (default_sample(BALL), random_sample(BALL, rng)):
        report = examined(subject_of(sample), 1)
        assert not report.findings
        assert report.error < 1e-9
        assert report.slope == pytest.approx(1.0, abs=1e-6)
        assert report.points > 3000


def test_a_flat_shape_passes():
    assert found(replace(BALL, distance=flat_ball, bounds=None)) == ""


BROKEN = {
    "steeper everywhere": (replace(BALL, distance=steep_ball), "promises slope 1"),
    "too far outside": (replace(BALL, distance=steep_ball), "outside at"),
    "steps that go too far": (replace(BALL, distance=steep_ball, claims=NOTHING), "a step from"),
    "steeper at one place": (
        replace(BALL, distance=steep_at_one_place, claims=NOTHING),
        "promises slope 1",
    ),
    "a step": (replace(BALL, distance=ball_with_a_step, claims=NOTHING), "promises slope 1"),
    "a step makes it inexact": (replace(BALL, distance=ball_with_a_step), "outside at"),
    "no inside": (replace(BALL, distance=shell), "nowhere negative"),
    "an inside that it denies": (replace(BALL, signed=False), "says it has no inside"),
    "the sign flips": (replace(BALL, distance=half_turned_out), "the sign jumps"),
    "a bound that claims to be exact": (replace(BALL, distance=blunt_box), "but the surface is"),
    "inside of a union": (replace(BALL, distance=two_balls), "inside at"),
    "a small box": (replace(BALL, bounds=small_bounds), "leaves out the surface"),
    "no slope": (replace(BALL, slope=1e18), "the slope's bound"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_shape_is_noticed(case):
    row, words = BROKEN[case]
    assert words in found(row)


def test_a_true_bound_passes_as_what_it_is():
    inside_and_bound = frozenset({Guarantee.EXACT_INSIDE, Guarantee.LOWER_BOUND})
    assert found(replace(BALL, distance=blunt_box, claims=inside_and_bound)) == ""
    outside_and_bound = frozenset({Guarantee.EXACT_OUTSIDE, Guarantee.LOWER_BOUND})
    assert found(replace(BALL, distance=two_balls, claims=outside_and_bound)) == ""


def test_an_estimate_may_be_steep():
    assert found(replace(BALL, distance=steep_ball, claims=NOTHING, estimate=True)) == ""


def test_a_hole_in_the_numbers_is_noticed():
    sample = default_sample(replace(BALL, distance=ball_without_a_pole))
    assert "in 64 bits at (0, 0, 0)" in "\n".join(numbers_hold(sample, subject_of(sample)))


def test_what_32_bits_cannot_hold_is_noticed():
    row = replace(BALL, distance=ball_of_eighth_powers, claims=LOWER_BOUND)
    sample = default_sample(row)
    findings = "\n".join(numbers_hold(sample, subject_of(sample)))
    assert "in 32 bits at" in findings
    assert "in 64 bits at (1" not in findings


def test_measured_lines_are_read():
    lines = measured(ball)
    assert [(m.function, m.args, m.value) for m in lines] == [
        ("ball", ((2.0, 0.0, 0.0),), 1.0),
        ("ball", ((0.0, 3.0, 0.0), 0.5), 2.5),
    ]
