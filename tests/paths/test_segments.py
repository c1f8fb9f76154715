"""Segments of rays against closed forms: where they end, slabs, what is no hit, exhaustion."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from distal.fields.guarantees import Bounds
from distal.fields.solids.boxes import box
from distal.fields.solids.round import sphere
from distal.lang import func, vec3
from distal.render.camera import Ray
from distal.render.march import OUT_OF_STEPS, PASSED, TOO_FAR, Hit, March
from distal.render.segment import segment
from tests.paths.solids import SOLIDS, Solid
from tests.paths.walks import fresnel, through_glass, unit

ULP = 2.0**-23


@func
def to_ball(
    origin: vec3, direction: vec3, side: float, slope: float, far: float, steps: int
) -> Hit:
    """The crossing of a ball of radius 1."""
    bounds = Bounds(vec3(-1.01), vec3(1.01))
    numbers = March(1.0, 0.0, far, 0.0)
    ray = Ray(origin, direction)
    return segment(lambda p: sphere(p, 1.0), ray, side, slope, bounds, numbers, steps)


def ball_hits(
    origin: Any,
    direction: Any,
    side: Any = 0.0,
    slope: Any = 0.0,
    far: float = 1e9,
    steps: int = 256,
) -> Any:
    """As ``to_ball``, for many rays."""
    origin = np.atleast_2d(np.asarray(origin, np.float32))
    direction = np.broadcast_to(np.asarray(direction, np.float32), origin.shape)
    rest = [np.full(len(origin), x, np.float32) for x in (side, slope, far)]
    return to_ball(origin, direction, *rest, np.full(len(origin), steps, np.int32))


def test_rays_end_at_the_root_of_the_closed_form():
    rng = np.random.default_rng(1)
    origin = (4.0 * unit(rng.normal(size=(20000, 3)))).astype(np.float32)
    direction = unit(rng.uniform(-1.0, 1.0, (20000, 3)) - origin).astype(np.float32)
    hit = ball_hits(origin, direction)
    start, way = origin.astype(float), direction.astype(float)
    along, length2 = -(start * way).sum(axis=1), (way * way).sum(axis=1)
    root = along**2 - length2 * ((start * start).sum(axis=1) - 1.0)
    clear = np.abs(root) > 1e-4
    assert np.array_equal(hit.found[clear], root[clear] > 0.0)
    meets = clear & hit.found
    t = (along - np.sqrt(np.maximum(root, 0.0))) / length2
    # The rounding of a place by the slope with which the ray meets the ball.
    error = np.abs(hit.t - t)[meets] * np.sqrt(root[meets]) / (ULP * np.abs(t[meets]))
    assert error.max() < 8.0
    assert np.median(error) < 0.5
    assert (hit.side == 1.0).all()


@pytest.mark.parametrize("depth", [1e-5, 1e-4, 1e-2])
def test_a_hit_is_a_crossing_and_not_a_near_miss(depth):
    """Two rays past a ball, one that deep in it and one that far above it."""
    hit = ball_hits([(-3.0, 1.0 - depth, 0.0), (-3.0, 1.0 + depth, 0.0)], (1.0, 0.0, 0.0))
    assert hit.found.tolist() == [True, False]
    assert hit.lost.tolist() == [PASSED, PASSED]
    chord = math.sqrt(2.0 * depth - depth**2)
    assert hit.t[0] == pytest.approx(3.0 - chord, abs=4 * 3 * ULP * 5.0 / chord)


def test_the_side_of_a_camera_is_found():
    hit = ball_hits([(0.0, 0.0, 0.5), (0.0, 0.0, 3.0)], (0.0, 0.0, -1.0))
    assert hit.side.tolist() == [-1.0, 1.0]
    assert hit.t == pytest.approx([1.5, 2.0], rel=1e-6)


@pytest.mark.parametrize("slope", [1.0, 0.3, 1e-2, 1e-3])
def test_a_chord_from_a_surface_has_its_length(slope):
    way = np.array([math.sqrt(1.0 - slope**2), -slope, 0.0])
    hit = ball_hits((0.0, 1.0, 0.0), way, side=-1.0, slope=slope)
    assert hit.found.all()
    assert hit.side.tolist() == [-1.0]
    assert hit.t == pytest.approx([2.0 * slope], abs=8 * ULP * 2.0 / slope)


def test_a_ray_that_leaves_a_surface_outwards_has_not_hit_it():
    slopes = np.float32(10.0) ** -np.arange(0.0, 7.0, 0.1, dtype=np.float32)
    ways = np.stack([np.sqrt(1.0 - slopes**2), slopes, 0.0 * slopes], axis=1)
    for x in (0.0, 0.3, 0.6):
        n = np.array([x, math.sqrt(1.0 - x * x), 0.0])
        across = np.array([n[1], -n[0], 0.0])
        direction = ways[:, :1] * across + ways[:, 1:2] * n
        hit = to_ball(
            np.broadcast_to(n, ways.shape).astype(np.float32),
            direction.astype(np.float32),
            np.ones(len(ways), np.float32),
            slopes,
            np.full(len(ways), 1e9, np.float32),
            np.full(len(ways), 256, np.int32),
        )
        assert not hit.found[slopes > 1e-3].any()
        assert (hit.lost == PASSED).all()
        # Nearer to the tangent the place's own rounding decides; the crossing is where it is.
        assert (hit.t[hit.found] < 2e-3).all()


def test_without_enough_steps_there_is_no_hit():
    rng = np.random.default_rng(2)
    origin = (4.0 * unit(rng.normal(size=(2000, 3)))).astype(np.float32)
    direction = unit(rng.uniform(-0.7, 0.7, (2000, 3)) - origin).astype(np.float32)
    whole = ball_hits(origin, direction)
    for steps in (1, 2, 3, 4, 6):
        hit = ball_hits(origin, direction, steps=steps)
        assert (hit.steps <= steps).all()
        out = hit.lost == OUT_OF_STEPS
        assert not hit.found[out].any()
        # What is found in fewer steps is the same crossing, as far as the steps told.
        found = hit.found
        assert whole.found[found].all()
        assert (np.abs(hit.t - whole.t)[found] < 2e-3).all()
        assert out.any() == (steps < 6) or out.mean() < 0.5
    assert (whole.lost != OUT_OF_STEPS).all()


def test_the_far_limit_ends_a_ray():
    hit = ball_hits((0.9, 0.0, 4.0), (0.0, 0.0, -1.0), far=3.5)
    assert (hit.found.tolist(), hit.lost.tolist()) == ([False], [TOO_FAR])
    hit = ball_hits((0.9, 0.0, 4.0), (0.0, 0.0, 1.0), far=3.5)
    assert (hit.found.tolist(), hit.lost.tolist()) == ([False], [PASSED])


def slab(thickness: float) -> Solid:
    """A slab across y."""

    @func
    def field(p: vec3) -> float:
        """It."""
        return box(p, vec3(100.0, thickness, 100.0))

    pane = SOLIDS["pane"]
    return replace(pane, field=field, half=(50.0, 0.5 * thickness, 50.0))


@pytest.mark.parametrize("thickness", [1.0, 0.1, 0.01, 1e-3, 1e-4])
def test_a_slab_of_glass_lets_through_what_the_closed_form_says(thickness):
    """Of the paths a share (1 - F) / (1 + F), in and out; and no path ends inside."""
    ior, paths = 1.5, 20000
    for angle in (0.0, 1.0, 1.5):
        rng = np.random.default_rng(3)
        way = np.array([math.sin(angle), -math.cos(angle), 0.0])
        target = rng.uniform(-0.2, 0.2, (paths, 3)) * (1.0, 0.0, 1.0)
        origin = (target - way).astype(np.float32)
        direction = np.broadcast_to(way, origin.shape).astype(np.float32)
        through = back = inside = 0
        length = 0.0
        for hit, ways, side in through_glass(slab(thickness), origin, direction, ior, rng):
            ends = ~hit.found
            through += int((ends & (ways[:, 1] < 0.0)).sum())
            back += int((ends & (ways[:, 1] > 0.0)).sum())
            inside += int((ends & (side < 0.0)).sum())
            length += float(hit.t[(side < 0.0) & hit.found].sum())
        assert (through + back, inside) == (paths, 0)
        mirrored, beyond = fresnel(np.array(math.cos(angle)), np.array(1.0 / ior))
        share = (1.0 - mirrored) / (1.0 + mirrored)
        sigma = math.sqrt(share * (1.0 - share) * paths)
        assert abs(through - share * paths) < 3.0 * sigma, angle
        # A path enters with 1 - F, and crosses the slab 1 / (1 - F) times.
        mean = thickness / float(beyond)
        spread = 3.0 * mean * math.sqrt(paths * (1.0 + mirrored)) / (1.0 - mirrored)
        assert abs(length - mean * paths) < spread + 1e-5 * paths, angle
