"""Lights for paths: what they send to a white surface is what they are declared to send."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import AmbientLight, HemisphereLight, PointLight, Sky
from distal.lang import Buffer, func, vec3
from distal.render import ambient, brightness, emitters, lights, sky, surroundings
from distal.render.sampling import warps
from tests.paths.counting import SURPRISING, counted, deviation, grid

ORIGIN = (0.0, 0.0, 0.0)
SAMPLES = grid(128).astype(np.float32)

LIGHTS = {
    "ball": lights.point_light(ORIGIN, vec3(1.0, 2.0, 2.0), 3.0, radius=0.6),
    "small ball": lights.point_light(ORIGIN, vec3(1.0, 2.0, 2.0), 3.0, radius=1e-3),
    "large ball": lights.point_light(ORIGIN, vec3(1.0, 2.0, 2.0), 3.0, radius=1.5),
    "point": lights.point_light(ORIGIN, vec3(1.0, 2.0, 2.0), 3.0),
    "sun": lights.distant_light(ORIGIN, vec3(1.0, 2.0, 2.0), 3.0, angle=0.0093),
    "wide sun": lights.distant_light(ORIGIN, vec3(1.0, 2.0, 2.0), 3.0, angle=0.8),
    "sharp sun": lights.distant_light(ORIGIN, vec3(1.0, 2.0, 2.0), 3.0),
    "spot": lights.spot_light(ORIGIN, vec3(1.0, 2.0, 2.0), vec3(0.2, 0.0, 0.0), 3.0, radius=0.3),
}
WITH_SIZE = [name for name, light in LIGHTS.items() if light.radius > 0.0]
MIDDLE = np.array([1.0, 2.0, 2.0]) / 3.0


@pytest.mark.parametrize("name", LIGHTS)
def test_a_white_surface_shows_the_declared_value(name):
    """The integral of the cosine by the samples, divided by pi: what direct light shows."""
    light = LIGHTS[name]
    found = emitters.sample_light(light, SAMPLES)
    cosine = np.maximum(np.asarray(found.direction, float) @ MIDDLE, 0)
    shown = (np.asarray(found.weight, float)[:, 0] * cosine).mean() / math.pi
    assert shown == pytest.approx(light.radiance[0], rel=2e-4)


@pytest.mark.parametrize("name", WITH_SIZE)
def test_what_is_sampled_is_seen(name):
    light = LIGHTS[name]
    found = emitters.sample_light(light, SAMPLES * 0.998 + 0.001)
    seen = emitters.seen_light(light, np.asarray(found.direction))
    inside = np.asarray(seen.density) > 0
    # Directions within rounding errors of the rim of a tiny light may miss it.
    assert inside.mean() > 0.99
    assert np.asarray(seen.density)[inside] == pytest.approx(np.asarray(found.density)[inside])
    value = np.asarray(found.weight) * np.asarray(found.density)[:, None]
    assert np.asarray(seen.radiance)[inside] == pytest.approx(value[inside], rel=1e-4)
    near = np.asarray(seen.distance)[inside]
    assert near == pytest.approx(np.asarray(found.distance)[inside], rel=1e-3)


@pytest.mark.parametrize("name", WITH_SIZE)
def test_the_density_integrates_to_one(name):
    light = LIGHTS[name]
    axes = warps.axes_about(tuple(MIDDLE))
    around = 1.2 * light.radius + 1e-6 if light.radius < 0.7 else math.pi
    narrow = 1 - math.cos(min(around, math.pi))
    cone = warps.in_cone(grid(400).astype(np.float32), narrow)
    seen = emitters.seen_light(light, warps.into_space(axes, cone))
    whole = np.asarray(seen.density, float).mean() * 2 * math.pi * narrow
    assert whole == pytest.approx(1, abs=5e-3)


@pytest.mark.parametrize("radius", [1e-3, 0.5, 2.9])
def test_a_ball_is_met_on_its_surface(radius):
    light = lights.point_light(ORIGIN, vec3(1.0, 2.0, 2.0), 3.0, radius=radius)
    found = emitters.sample_light(light, SAMPLES)
    place = np.asarray(found.direction, float) * np.asarray(found.distance, float)[:, None]
    offset = np.linalg.norm(place - [1, 2, 2], axis=1)
    assert offset == pytest.approx(radius, abs=2e-3 * radius + 2e-6)
    # The near side.
    assert ((place - [1, 2, 2]) @ MIDDLE).max() < 1e-3


def test_a_ball_has_the_same_radiance_from_everywhere():
    for p in ((0.0, 0.0, 0.0), (1.0, 2.0, 1.0), (5.0, 5.0, 5.0), (1.0, 2.0, 1.9)):
        light = lights.point_light(vec3(*p), vec3(1.0, 2.0, 2.0), 3.0, radius=0.5)
        direction = np.array([1.0, 2.0, 2.0]) - p
        seen = emitters.seen_light(light, tuple(direction / np.linalg.norm(direction)))
        assert seen.radiance[0] == pytest.approx(3.0 / 0.25, rel=1e-5)


def test_an_emitting_ball_is_a_point_light_with_a_radius():
    light = lights.point_light(ORIGIN, vec3(1.0, 2.0, 2.0), 0.25, vec3(7.0, 5.0, 3.0), 0.5)
    seen = emitters.seen_light(light, tuple(MIDDLE))
    assert tuple(seen.radiance) == pytest.approx((7.0, 5.0, 3.0), rel=1e-5)
    assert seen.distance == pytest.approx(2.5, rel=1e-5)


def test_inside_of_a_ball_light_is_everywhere():
    light = lights.point_light(ORIGIN, vec3(0.1, 0.0, 0.0), 3.0, radius=0.5)
    found = emitters.sample_light(light, SAMPLES)
    assert np.asarray(found.density) == pytest.approx(1 / (4 * math.pi))
    assert np.asarray(found.weight)[:, 0] == pytest.approx(12.0 * 4 * math.pi, rel=1e-5)
    place = np.asarray(found.direction) * np.asarray(found.distance)[:, None]
    assert np.linalg.norm(place - [0.1, 0, 0], axis=1) == pytest.approx(0.5, abs=1e-5)


@pytest.mark.parametrize("p", [ORIGIN, (1e-30, 0.0, 0.0), (1e-4, 0.0, 0.0)])
@pytest.mark.parametrize("radius", [0.0, 0.1])
def test_a_point_at_the_light_gets_finite_numbers(p, radius):
    light = lights.point_light(vec3(*p), vec3(0.0), 3.0, radius=radius)
    found = emitters.sample_light(light, SAMPLES[:64])
    for part in (found.direction, found.weight, found.density, found.distance):
        assert np.isfinite(np.asarray(part)).all()


def test_the_power_heuristic_shares_all_of_it():
    rng = np.random.default_rng(1)
    a, b = (np.exp(rng.normal(size=(2, 200)) * 4)).astype(np.float32)
    total = np.asarray(emitters.power_share(a, b)) + np.asarray(emitters.power_share(b, a))
    assert total == pytest.approx(1.0, abs=1e-5)
    assert emitters.power_share(0.0, 3.0) == 1.0
    assert emitters.power_share(3.0, 0.0) == 1.0
    assert emitters.power_share(1.0, 1e30) == pytest.approx(0.0, abs=1e-20)


# ------------------------------------------------------------------ light from all sides


@pytest.mark.parametrize("n", [(0.0, 1.0, 0.0), (0.6, -0.8, 0.0), (0.0, 0.28, 0.96)])
@pytest.mark.parametrize(
    ("radiance", "received"),
    [
        (ambient.even_radiance, ambient.ambient_light),
        (ambient.hemisphere_radiance, ambient.hemisphere_light),
        (sky.sky_radiance, ambient.sky_ambient),
    ],
)
def test_radiance_from_all_sides_adds_up_to_the_ambient_light(radiance, received, n):
    axes = warps.axes_about(n)
    u = grid(256).astype(np.float32)
    directions = warps.into_space(axes, warps.in_cosine_hemisphere(u))
    mean = np.asarray(radiance(directions), float).mean(0)
    assert mean == pytest.approx(np.asarray(received(vec3(*n)), float), abs=2e-3)


def test_lights_from_all_sides_have_a_radiance():
    assert AmbientLight(0.3).radiance.values["intensity"] is not None
    assert HemisphereLight().radiance.func is ambient.hemisphere_radiance
    assert Sky().radiance.func is sky.sky_radiance
    assert PointLight((1, 2, 3)).radiance is None


# ------------------------------------------------------------------ environments


def picture():
    rng = np.random.default_rng(6)
    texels = rng.random((16, 32, 3)) ** 4
    texels[3, 5] = 60.0
    texels[12] = 0.0
    return texels


def interpolated_means(values, fine=64):
    """The mean of a picture over each texel, by many interpolated places."""
    inside = (np.arange(fine) + 0.5) / fine - 0.5
    towards, part = np.sign(inside).astype(int), np.abs(inside)
    rows, columns = np.indices(values.shape)
    total = np.zeros(values.shape)
    for dy, fy in zip(towards, part, strict=True):
        other = np.clip(rows + dy, 0, len(values) - 1)
        for dx, fx in zip(towards, part, strict=True):
            beside = (columns + dx) % values.shape[1]
            here = (1 - fx) * values[rows, columns] + fx * values[rows, beside]
            there = (1 - fx) * values[other, columns] + fx * values[other, beside]
            total += (1 - fy) * here + fy * there
    return total / fine**2


ROWS, COLUMNS, CELLS = brightness.brightness_table(picture())
TABLE = Buffer(CELLS)


@func
def from_table(u: vec3, turn: float) -> surroundings.DirectionSample:
    return surroundings.sample_surroundings(TABLE, 16, 32, turn, u)


@func
def density_in_table(direction: vec3, turn: float) -> float:
    return surroundings.surroundings_density(TABLE, 16, 32, turn, direction)


def test_an_alias_table_has_the_chances():
    chances = [0.5, 0.0, 0.25, 0.125, 0.125, 3.0]
    thresholds, others = brightness.alias_table(chances)
    found = np.zeros(6)
    for i in range(6):
        found[i] += thresholds[i] / 6
        found[others[i]] += (1 - thresholds[i]) / 6
    assert found == pytest.approx(np.array(chances) / 4, abs=1e-12)


@pytest.mark.parametrize("turn", [0.0, 1.3])
def test_directions_are_as_dense_as_the_picture_is_bright(turn):
    assert (ROWS, COLUMNS) == (16, 32)
    u = np.random.default_rng(7).random((1 << 17, 3)).astype(np.float32)
    found = from_table(u, turn)
    again = density_in_table(np.asarray(found.direction), turn)
    same = np.isclose(np.asarray(again), np.asarray(found.density), rtol=1e-5)
    assert same.mean() > 0.999  # the others are within rounding errors of a cell's border
    direction = np.asarray(found.direction, float)
    c, s = math.cos(turn), math.sin(turn)
    x, y = c * direction[:, 0] - s * direction[:, 2], direction[:, 1]
    z = s * direction[:, 0] + c * direction[:, 2]
    across = np.arctan2(x, -z) / (2 * math.pi) + 0.5
    up = np.arcsin(np.clip(y, -1, 1)) / math.pi + 0.5
    edges = np.cos(np.pi * np.arange(17) / 16)
    area = (edges[:-1] - edges[1:]) * 2 * math.pi / 32
    light = interpolated_means(picture().max(-1))[::-1] * area[:, None]
    expected = 0.95 * light / light.sum() + 0.05 * area[:, None] / (4 * math.pi)
    counts = counted(np.stack([up, across], 1), 16, 32)
    assert deviation(counts, expected * len(u)) < SURPRISING


def test_the_density_of_the_surroundings_integrates_to_one():
    directions = warps.on_sphere(grid(512).astype(np.float32))
    whole = np.asarray(density_in_table(directions, 0.4), float).mean() * 4 * math.pi
    assert whole == pytest.approx(1, abs=0.01)


def test_a_black_picture_is_sampled_evenly():
    rows, columns, cells = brightness.brightness_table(np.zeros((4, 8, 3)))
    assert (rows, columns) == (4, 8)
    assert [c[2] for c in cells] == pytest.approx([1 / (4 * math.pi)] * 32)


def test_a_large_picture_has_a_table_of_limited_size():
    texels = np.zeros((200, 600, 3))
    texels[50, 300] = 1.0
    rows, columns, cells = brightness.brightness_table(texels)
    assert (rows, columns) == (128, 256)
    assert len(cells) == 128 * 256
    densest = max(range(len(cells)), key=lambda i: cells[i][2])
    assert densest % 256 == 128
    assert 127 - densest // 256 == 50 * 128 // 200
