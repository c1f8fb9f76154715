"""The renderers, on every target; marches against what is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

import distal
from distal.fields.guarantees import Bounds
from distal.lang import func, length, vec2, vec3
from distal.render import heightfield_march, march, normals, segment, settings
from distal.render.camera import Ray
from tests.pictures.comparison import difference
from tests.render import scenes

IMAGES = {
    "plain": scenes.plain,
    "mirrored": scenes.mirrored,
    "refracted": scenes.refracted,
    "cost": scenes.cost,
    "sliced": scenes.sliced,
}
SIZE = (96, 64)
SMALL = (48, 32)  # for the reference, whose time grows with the pixels


@func
def ball(p: vec3) -> float:
    return length(p) - 1.0


@func
def hit_of(origin: vec3, direction: vec3, divisor: float, steps: int) -> march.Hit:
    room = Bounds(vec3(-1.1), vec3(1.1))
    numbers = march.March(divisor, 0.0, 50.0, 1e-5)
    return segment.segment(ball, Ray(origin, direction), 0.0, 0.0, room, numbers, steps)


@pytest.mark.parametrize("divisor", [1.0, 2.5])
@pytest.mark.parametrize("offset", [0.0, 0.3, 0.8])
def test_a_march_meets_a_ball_where_the_quadratic_says(offset, divisor):
    found = hit_of((offset, 0.0, 5.0), (0.0, 0.0, -1.0), divisor, 200)
    assert found.found
    assert found.side == 1.0
    assert found.t == pytest.approx(5.0 - math.sqrt(1 - offset**2), abs=3e-4)


def test_a_ray_that_begins_inside_finds_the_way_out():
    found = hit_of((0.0, 0.0, 0.5), (0.0, 0.0, -1.0), 1.0, 200)
    assert found.found
    assert found.side == -1.0
    assert found.t == pytest.approx(1.5, abs=1e-3)


@pytest.mark.parametrize("start", [0.9, 0.5, 0.0, -0.5, -0.9])
@pytest.mark.parametrize("room", [1.0, 1.1, 1.5])
def test_a_long_step_does_not_leap_out_of_the_box_past_a_surface(start, room):
    """From inside, and back again from outside: the last step may end beyond the box."""

    @func
    def march_within(z: float, size: float) -> march.Hit:
        numbers = march.March(1.0, 0.0, 50.0, 1e-4)
        box = settings.grown_bounds(Bounds(vec3(-size), vec3(size)))
        ray = Ray(vec3(0.0, 0.0, z), vec3(0.0, 0.0, -1.0))
        return segment.segment(ball, ray, 0.0, 0.0, box, numbers, 200)

    found = march_within(start, room)
    assert found.found
    assert found.t == pytest.approx(1.0 + start, abs=1e-3)


@pytest.mark.parametrize("away", [1.5, 2.0, 3.0, 4.0, 5.0, 7.3, 21.0])
def test_a_long_step_head_on_does_not_end_inside(away):
    found = hit_of((0.0, 0.0, away), (0.0, 0.0, -1.0), 1.0, 200)
    assert found.found
    assert found.t == pytest.approx(away - 1.0, abs=1e-5 * away + 1e-5)


def test_a_ray_beside_the_box_asks_nothing():
    found = hit_of((3.0, 0.0, 5.0), (0.0, 0.0, -1.0), 1.0, 200)
    assert not found.found
    assert found.steps == 0


def test_steps_that_run_out_leave_no_halo():
    """Few steps: a ray that passes a tenth away is still a miss."""
    for steps in (4, 8, 12):
        assert not hit_of((1.1, 0.0, 5.0), (0.0, 0.0, -1.0), 1.0, steps).found


ON_THE_BALL = np.array([(0.6, 0.8, 0.0), (0.48, -0.6, 0.64)])


def normals_by(kind, step):
    @func
    def normal(p: vec3) -> vec3:
        return normals.normal(ball, p, kind, step)

    return np.asarray(normal(ON_THE_BALL))


@pytest.mark.parametrize("kind", [normals.EXACT, normals.SIX_TAPS])
def test_normals_of_a_ball(kind):
    assert normals_by(kind, 1e-2) == pytest.approx(ON_THE_BALL, abs=2e-4)


def test_a_tetrahedrons_normal_is_off_by_its_step_times_the_curvature():
    """Along z, by the step times the second derivative across x and y: -0.48 at the first point."""
    found = normals_by(normals.TETRAHEDRON, 1e-2)
    assert found == pytest.approx(ON_THE_BALL, abs=5e-3)
    assert found[0, 2] == pytest.approx(-0.48e-2, rel=1e-2)


def test_forward_normals_are_nearly_right_and_no_normal_is_nan():
    @func
    def forward(p: vec3) -> vec3:
        return normals.normal(ball, p, normals.FORWARD, 1e-3)

    @func
    def middle(p: vec3) -> vec3:
        return normals.normal(ball, p, normals.EXACT, 1e-3)

    assert tuple(forward((0.6, 0.8, 0.0))) == pytest.approx((0.6, 0.8, 0.0), abs=2e-3)
    assert tuple(middle((0.0, 0.0, 0.0))) == (0.0, 1.0, 0.0)


def test_the_hybrid_march_asks_a_third_for_the_true_sea():
    hybrid = scenes.hybrid.render(size=(120, 90)).array
    traced = scenes.traced.render(size=(120, 90)).array
    true = scenes.true_sea.render(size=(120, 90)).array[..., 0]
    assert 3.0 * hybrid[..., 3].mean() <= traced[..., 3].mean()
    apart = np.abs(hybrid[..., 0] - true)
    assert apart.mean() <= 1 / 255
    assert (apart > 2 / 255).mean() <= 0.002


def test_a_stride_ends_at_the_rays_end_and_not_beyond():
    """The ground lies just above where the ray ends; strides are ten times as long."""

    @func
    def way(far: float) -> vec2:
        room = Bounds(vec3(-1e18), vec3(1e18))
        stride = heightfield_march.Stride(0.5, 10.0, 1.05)
        numbers = march.March(1.0, 0.0, far, 1e-4)
        ray = Ray(vec3(0.0, 1.0, 0.0), vec3(0.0, -0.6, -0.8))
        hit = heightfield_march.march_heightfield(lambda p: p.y, ray, room, numbers, stride, 100)
        return vec2(hit.t, 1.0 if hit.found else 0.0)

    assert tuple(way(1.7)) == pytest.approx((1.0 / 0.6, 1.0), abs=1e-3)
    assert way(1.6)[1] == 0.0


def test_a_cliff_is_found_though_its_value_jumps():
    @func
    def cliff(p: vec3) -> float:
        return -0.001 if p.z < -3.3 else 0.001

    @func
    def way(origin: vec3) -> float:
        room = Bounds(vec3(-1e18), vec3(1e18))
        stride = heightfield_march.Stride(2.0, 0.1, 1.05)
        numbers = march.March(1.0, 1.0, 50.0, 1e-5)
        ray = Ray(origin, vec3(0.0, 0.0, -1.0))
        hit = heightfield_march.march_heightfield(cliff, ray, room, numbers, stride, 100)
        return hit.t if hit.found and hit.steps < 40 else -1.0

    assert way((0.0, 1.0, 0.0)) == pytest.approx(3.3, abs=1e-2)


def test_a_stride_does_not_start_for_rays_that_rise_above_all():
    @func
    def steps(origin: vec3, direction: vec3) -> int:
        room = Bounds(vec3(-1e18), vec3(1e18))
        stride = heightfield_march.Stride(0.13, 0.05, 1.05)
        numbers = march.March(1.0, 0.0, 50.0, 1e-4)
        ray = Ray(origin, direction)
        return heightfield_march.march_heightfield(
            scenes.sea, ray, room, numbers, stride, 100
        ).steps

    assert steps((0.0, 1.0, 0.0), (0.0, 0.6, -0.8)) == 0
    assert steps((0.0, 1.0, 0.0), (0.0, -0.6, -0.8)) > 0


@pytest.fixture(scope="module")
def on_the_cpu():
    return {name: image.render(size=SIZE).array for name, image in IMAGES.items()}


@pytest.mark.sample(2)
@pytest.mark.parametrize("name", IMAGES)
def test_the_reference_draws_the_cpus_picture(name):
    drawn = IMAGES[name].render(size=SMALL, device="reference").array
    found = difference(drawn, IMAGES[name].render(size=SMALL).array)
    assert found.is_agreement, found
    assert np.isfinite(drawn).all()


@pytest.mark.sample(3, each="name")
@pytest.mark.parametrize("name", IMAGES)
@pytest.mark.parametrize("target", ["glsl-es300", "glsl-330", "shadertoy"])
def test_glsl_draws_the_cpus_picture(name, target, on_the_cpu):
    glsl = pytest.importorskip("tests.glsl")
    artifact = distal.compile(IMAGES[name], target=target)
    try:
        drawn = glsl.run_glsl(artifact, SIZE)
    except glsl.egl.EglUnavailableError as error:
        pytest.skip(str(error))
    found = difference(drawn, on_the_cpu[name])
    assert found.is_agreement, found


@pytest.mark.sample(2, each="name")
@pytest.mark.parametrize("name", IMAGES)
@pytest.mark.parametrize("target", ["wgsl", "wgsl-compute"])
def test_wgsl_draws_the_cpus_picture(name, target, on_the_cpu):
    gpu = pytest.importorskip("tests.gpu")
    artifact = distal.compile(IMAGES[name], target=target)
    try:
        drawn = gpu.run_wgsl(artifact, SIZE)
    except gpu.GpuUnavailableError as error:
        pytest.skip(str(error))
    found = difference(drawn, on_the_cpu[name])
    assert found.is_agreement, found
