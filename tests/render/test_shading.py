"""Soft shadows, fog, skies and highlights where their answer is a formula.

One place for what the present estimators promise: each test states the formula in its words and
computes it in NumPy. Scene functions are asked by the reference, which compiles nothing.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from distal.fields.guarantees import Bounds
from distal.lang import func, gradient, length, max, min, vec2, vec3
from distal.lang.runtime_access import executor
from distal.render import ambient, lights, material, shade, shadow_ray, shadows, sky, trace
from distal.render.camera import Ray
from distal.render.lights import LightSample
from distal.render.march import March
from distal.render.material import Surface

UP = (0.0, 1.0, 0.0)


def asked(function: Any, *args: Any) -> Any:
    """A scene function's values by the reference."""
    return executor().call(function, args, {}, device="reference")


# Soft shadows: the closest approach to the ray, in radii of the light as wide as it is there, is s;
# (1 + s)^2 (2 - s) / 4 of the light is left, none below -1, all above 1.


def left_of(s: Any) -> Any:
    s = np.clip(s, -1.0, 1.0)
    return 0.25 * (1.0 + s) ** 2 * (2.0 - s)


@func
def shadow_of_a_cone(at: vec2, radius: float, divisor: float, end: float) -> float:
    """The field is ``at.x`` times the way, but for ``at.y`` of way at the start."""
    light = LightSample(vec3(0.0, 0.6, 0.8), end, vec3(1.0), radius)
    room = Bounds(vec3(-1e18), vec3(1e18))

    def field(p: vec3) -> float:
        return at.x * length(p - vec3(0.5, 1.0, 2.0)) + at.y

    found = shadow_ray.find_edge(
        field,
        lambda p: gradient(field, p),
        Ray(vec3(0.5, 1.0, 2.0), light.direction),
        max(radius, shadows.SHARPEST),
        end,
        room,
        March(divisor, 0.0, 50.0, 1e-3),
        80,
        False,
        True,
    )
    return shadow_ray.share_of_disc(found.offset)


@pytest.mark.parametrize("radius", [0.2, 0.05])
@pytest.mark.parametrize("divisor", [1.0, 2.0])
def test_a_gap_as_wide_as_a_share_of_the_light_lets_its_share_through(radius, divisor):
    shares = np.array([-1.5, -0.9, -0.3, 0.0, 0.25, 0.6, 0.95, 1.4])
    at = np.stack([shares * radius * divisor, 0.0 * shares], axis=1)
    found = asked(shadow_of_a_cone, at, radius, divisor, 9.0)
    assert found == pytest.approx(left_of(shares), abs=2e-6)


def test_a_light_without_size_is_as_sharp_as_a_tangent_of_3_thousandths():
    at = np.array([[0.0015, 0.0], [-0.0015, 0.0], [0.0031, 0.0]])
    found = asked(shadow_of_a_cone, at, 0.0, 1.0, 9.0)
    assert found == pytest.approx(left_of(np.array([0.5, -0.5, 1.0])), abs=2e-6)


@func
def shadow_of_a_ball(at: vec3, distance: float, far: float, side: float) -> float:
    """A ball of radius 0.5 about ``at`` before a light along x that is ``distance`` away."""
    light = LightSample(vec3(1.0, 0.0, 0.0), distance, vec3(1.0), 0.1)
    room = Bounds(vec3(-side), vec3(side))
    found = shadows.soft_shadow(
        lambda p: length(p - at) - 0.5, vec3(0.0), light, room, March(1.0, 0.0, far, 1e-4), 200
    )
    return found.share


def test_what_stands_beyond_the_light_the_far_end_or_the_box_hides_nothing():
    ball = np.array([[4.0, 0.0, 0.0]])
    assert asked(shadow_of_a_ball, ball, 9.0, 50.0, 50.0)[0] == 0.0
    assert asked(shadow_of_a_ball, ball, 2.0, 50.0, 50.0)[0] == pytest.approx(1.0)
    assert asked(shadow_of_a_ball, ball, 9.0, 2.0, 50.0)[0] == pytest.approx(1.0)
    assert asked(shadow_of_a_ball, ball, 9.0, 50.0, 2.0)[0] == pytest.approx(1.0)
    assert asked(shadow_of_a_ball, -ball, 9.0, 50.0, 50.0)[0] == pytest.approx(1.0)


def test_a_ball_beside_the_ray_hides_as_much_of_the_disc_as_rays_count():
    beside = np.array([0.45, 0.6, 0.7, 0.8, 0.95])
    at = np.stack([np.full(5, 4.0), beside, 0.0 * beside], axis=1)
    k = np.arange(2000.0)
    out, angle = 0.1 * np.sqrt((k + 0.5) / 2000.0), 2.399963 * k
    rays = np.stack([np.ones(2000), out * np.cos(angle), out * np.sin(angle)], axis=1)
    along = at @ rays.T / np.linalg.norm(rays, axis=1)
    missed = (np.sum(at**2, axis=1)[:, None] - along**2 > 0.25).mean(axis=1)
    found = asked(shadow_of_a_ball, at, 9.0, 50.0, 50.0)
    assert np.sqrt(np.mean((found - missed) ** 2)) < 0.02


# Fog: of a color, exp(-density * way) is left, the rest is the fog's.


def test_fog_mixes_by_the_way():
    color, fog = np.array([[0.2, 1.5, 0.0]]), np.array([0.7, 0.4, 0.1])
    for t, density in ((0.0, 0.5), (2.0, 0.5), (3.0, 0.0), (7.0, 0.13)):
        clear = math.exp(-density * t)
        found = asked(shade.fogged, color, t, tuple(fog), density)
        assert found[0] == pytest.approx(clear * color[0] + (1.0 - clear) * fog, abs=1e-6)


# Lights


@pytest.mark.parametrize(("angle", "softness"), [(0.9, 0.4), (1.6, 1.0), (0.5, 0.1)])
def test_a_spots_rim_is_a_smooth_step_of_the_cosine(angle, softness):
    """0 at half the angle, 1 where the softness ends it; 3 s^2 - 2 s^3 between."""
    half = 0.5 * angle
    offs = np.linspace(0.0, 1.2 * half, 25)
    places = np.stack([2.0 * np.sin(offs), -2.0 * np.cos(offs), 0.0 * offs], axis=1)
    rim, full = math.cos(half), math.cos(half * (1.0 - softness))
    s = np.clip((np.cos(offs) - rim) / (full - rim), 0.0, 1.0)
    expected = 3.0 / 4.0 * s * s * (3.0 - 2.0 * s)

    @func
    def shown(p: vec3, angle: float, softness: float) -> vec3:
        light = lights.spot_light(
            p, vec3(0.0), vec3(0.0, -5.0, 0.0), 3.0, vec3(1.0, 0.5, 0.2), angle, softness, 0.3
        )
        return vec3(light.radiance.y, light.distance, light.radius)

    found = asked(shown, places, angle, softness)
    assert found[:, 0] == pytest.approx(0.5 * expected, abs=1e-5)
    assert found[:, 1] == pytest.approx(2.0)
    assert found[:, 2] == pytest.approx(0.15)


def test_on_the_light_itself_it_is_a_rounding_error_away():
    @func
    def shown(p: vec3) -> vec2:
        light = lights.point_light(p, vec3(1.0, 2.0, 3.0), 2.0)
        return vec2(light.radiance.x, light.distance)

    found = asked(shown, np.array([[1.0, 2.0, 3.0]]))[0]
    assert found == pytest.approx((2e12 / 14.0, 1e-6 * math.sqrt(14.0)), rel=1e-4)


def test_no_light_shines_nowhere():
    assert tuple(lights.no_light().radiance) == (0.0, 0.0, 0.0)
    assert tuple(lights.no_light().direction) == UP
    assert lights.no_light().distance > 1e6


def test_a_light_that_climbs_with_the_height_gives_its_moments():
    """2/3 facing up, nothing facing down, 2/(3 pi) to the side; summed up elsewhere."""
    heights = np.array([1.0, -1.0, 0.0, 0.6, -0.6])
    found = asked(ambient.climbing_share, heights)
    assert found[:3] == pytest.approx([2.0 / 3.0, 0.0, 2.0 / (3.0 * math.pi)], abs=1e-6)
    # The light of height y minus that of height -y is y itself: 2/3 of the cosine.
    assert found[3] - found[4] == pytest.approx(2.0 / 3.0 * 0.6, abs=1e-6)
    summed = [moment(h) for h in (0.6, -0.6)]
    assert found[3:] == pytest.approx(summed, abs=2e-4)


def moment(height: float) -> float:
    """The mean over the cosine's lobe of max(y, 0), summed up."""
    n = np.array([math.sqrt(1.0 - height**2), height])
    y = (np.arange(400) + 0.5) / 400
    around = 2.0 * math.pi * (np.arange(400) + 0.5) / 400
    x = np.sqrt(1.0 - y**2)[:, None] * np.cos(around)
    lobe = np.maximum(n[0] * x + n[1] * y[:, None], 0.0)
    return float((lobe * y[:, None]).mean() * 2.0)


def test_a_sky_lights_by_height_and_ground():
    """Upwards: 1/3 of the horizon and 2/3 of the zenith; downwards: the ground; sideways: both."""
    zenith, horizon, ground = (
        np.array(c) for c in ((0.1, 0.4, 0.9), (0.8, 0.6, 0.5), (0.3, 0.2, 0))
    )
    normals = np.array([UP, (0.0, -1.0, 0.0), (0.6, 0.0, 0.8)])
    found = asked(ambient.sky_ambient, normals, tuple(zenith), tuple(horizon), tuple(ground), 1.5)
    side = 0.5 * (ground + horizon) + (zenith - horizon) * 2.0 / (3.0 * math.pi)
    expected = 1.5 * np.array([horizon / 3.0 + zenith * 2.0 / 3.0, ground, side])
    assert found == pytest.approx(expected, abs=1e-5)


def test_a_sky_shows_air_ground_sun_and_glow():
    """The disc shows 4 of the sun's 1, the glow 1/4 cos^64 + 1/2 cos^512, a rim of a fifth."""
    zenith, horizon, ground = (
        np.array(c) for c in ((0.1, 0.4, 0.9), (0.8, 0.6, 0.5), (0.3, 0.2, 0))
    )
    sun, color, angle = np.array([0.0, 0.6, 0.8]), np.array([1.0, 0.9, 0.5]), 0.3
    across = np.array([0.0, 0.8, -0.6])
    offs = np.array([0.0, 0.1, 0.149, 0.1516, 0.18, 0.25, 0.6, 1.7])
    ways = np.cos(offs)[:, None] * sun + np.sin(offs)[:, None] * across
    ways = np.concatenate([ways, [(0.6, -0.8, 0.0), (1.0, 0.0, 0.0), (1.0, 5e-4, 0.0)]])
    found = asked(
        sky.sky, ways, tuple(5.0 * sun), tuple(color), 2.0, angle,
        tuple(zenith), tuple(horizon), tuple(ground), 1.5,
    )  # fmt: skip

    def step(low: float, high: float, x: Any) -> Any:
        s = np.clip((x - low) / (high - low), 0.0, 1.0)
        return s * s * (3.0 - 2.0 * s)

    y = ways[:, 1:2]
    above = step(-1e-3, 1e-3, y)
    air = horizon + (zenith - horizon) * np.clip(y, 0.0, 1.0)
    cosine = (ways @ sun)[:, None]
    rim = math.cos(0.5 * angle)
    disc = step(rim - 0.2 * (1.0 - rim), rim + 0.2 * (1.0 - rim), cosine)
    assert 0.0 < disc[2, 0] < 1.0
    assert 0.0 < disc[3, 0] < 1.0
    glow = 0.25 * np.maximum(cosine, 0.0) ** 64 + 0.5 * np.maximum(cosine, 0.0) ** 512
    expected = 1.5 * (ground + (air - ground) * above) + 2.0 * color * (4.0 * disc + glow)
    assert found == pytest.approx(expected, abs=1e-4)
    assert found[-2] == pytest.approx(1.5 * 0.5 * (horizon + ground), abs=1e-5)


# Surfaces


def test_a_mixed_surface_mixes_all_its_numbers():
    bump = {"height": 0.2, "tilt": vec3(0.1, 0.3, 0.2)}
    a = Surface(
        *(vec3(0.1, 0.2, 0.3), 0.5, 0.2, 0.1, 1.3, 0.4, 0.2),
        *(vec3(1.0, 2.0, 3.0), vec3(0.5), 0.0, 0.1),
        **bump,
        bsdf_share=0.5,
        bsdf=3,
    )
    b = Surface(
        *(vec3(0.9, 0.7, 0.2), 0.1, 0.3, 0.6, 2.3, 0.9, 0.8),
        *(vec3(0.0, 4.0, 1.0), vec3(0.1), 1.0, 0.7),
    )
    mixed = material.mix_surfaces(a, b, 0.3)
    assert (mixed.bsdf, material.mix_surfaces(b, a, 0.3).bsdf) == (3, 3)
    for name in set(Surface.__annotations__) - {"bsdf"}:
        first, second = (np.asarray(getattr(s, name), float) for s in (a, b))
        found = np.asarray(getattr(mixed, name), float)
        assert found == pytest.approx(0.7 * first + 0.3 * second, abs=1e-6), name
        assert np.all(first != second), name


@func
def shares_of(color: vec3, cosine: float, fresnel: float, metal: float) -> material.Shares:
    surface = Surface(color, 0.4, 0.1, 0.3, 1.5, 0.0, metal, vec3(0.0), vec3(0.0), fresnel)
    return material.shares(surface, cosine, False)


@pytest.mark.parametrize("cosine", [1.0, 0.6, 0.25])
def test_with_fresnel_the_weights_share_out_what_is_left(cosine):
    """0.8 of the mirrored share in all; of the rest each weight, in the surface's color."""
    color = np.array([0.9, 0.5, 0.2])
    eta, sine = 1.5, math.sqrt(1.0 - cosine**2)
    below = math.sqrt(1.0 - (sine / eta) ** 2)
    across = (cosine - eta * below) / (cosine + eta * below)
    parallel = (eta * cosine - below) / (eta * cosine + below)
    of_glass = 0.5 * (across**2 + parallel**2)
    of_metal = color + (1.0 - color) * (1.0 - cosine) ** 5
    for metal in (0.0, 0.25, 1.0):
        mirrored = (1.0 - metal) * of_glass + metal * of_metal
        for fresnel in (0.0, 0.5, 1.0):
            found = shares_of(vec3(*color), cosine, fresnel, metal)
            left = 1.0 - fresnel * mirrored
            plain = 0.1 * ((1.0 - metal) + metal * color)
            assert np.asarray(found.diffuse) == pytest.approx(0.4 * color * left, abs=1e-6)
            assert np.asarray(found.transmitted) == pytest.approx(0.3 * color * left, abs=1e-6)
            wanted = (1.0 - fresnel) * plain + fresnel * 0.8 * mirrored
            assert np.asarray(found.mirrored) == pytest.approx(wanted, abs=1e-6)


@func
def shine(view: vec3, light: vec3, roughness: float, widened: float) -> float:
    return material.highlight(
        Surface(roughness=roughness), vec3(0.0, 1.0, 0.0), view, light, widened
    )


def unit(*v: float) -> Any:
    return np.array(v) / np.linalg.norm(v)


@pytest.mark.parametrize("widened", [0.0, 0.3])
@pytest.mark.parametrize("roughness", [0.2, 0.6, 1.0])
def test_a_highlight_is_the_microfacet_formula(roughness, widened):
    """D G2 / (4 cos cos) cos pi by Trowbridge, Reitz and Smith, as Heitz (2014) writes them."""
    alpha = float(np.minimum(roughness**2 + 0.5 * widened, 1.0))
    n = np.array(UP)
    for view, light in (
        (unit(0.3, 1.0, 0.2), unit(-0.5, 0.8, 0.1)),
        (unit(0.9, 0.3, 0.0), unit(-0.9, 0.4, 0.3)),
        (n, unit(0.0, 1.0, 0.7)),
    ):
        half = unit(*(view + light))
        cosine = half @ n
        tangent = (1.0 - cosine**2) / cosine**2
        facets = 1.0 / (math.pi * alpha**2 * cosine**4 * (1.0 + tangent / alpha**2) ** 2)

        def masking(way: Any, alpha: float = alpha) -> float:
            a2 = alpha**2 * (1.0 / way[1] ** 2 - 1.0)
            return 0.5 * (math.sqrt(1.0 + a2) - 1.0)

        seen = 1.0 / (1.0 + masking(view) + masking(light))
        expected = math.pi * facets * seen / (4.0 * view[1])
        found = shine(tuple(view), tuple(light), roughness, widened)
        assert found == pytest.approx(expected, rel=2e-4)


def test_a_smooth_mirror_shows_no_point():
    assert shine(UP, UP, 0.0, 0.0) == 0.0
    assert shine(UP, UP, 0.03, 0.0) == 0.0  # its square is below a thousandth
    assert shine(UP, UP, 0.04, 0.0) > 0.0


def test_the_brightest_component_is_the_largest():
    assert material.brightest((0.3, 0.9, 0.5)) == pytest.approx(0.9)


# Direct light: emission, what is around, and each light by its cosine and its shadow.


@func
def lit(weights: vec3, occlusion: float) -> vec3:
    """A floor, a wall 0.3 away; a light from above and one from below it."""
    surface = Surface(emission=vec3(0.01, 0.02, 0.03), roughness=weights.z)
    parts = material.Shares(vec3(weights.x), vec3(weights.y), vec3(0.0))
    hit = trace.SurfacePoint(4.5, False, vec3(0.3, 0.0, 0.0), vec3(0.0, 1.0, 0.0), surface, parts)
    found = shade.direct_light(
        Ray(vec3(3.0, 3.6, 0.0), vec3(-0.6, -0.8, 0.0)),
        hit,
        lambda p, n, slope: shade.ambient_occlusion(
            lambda q: min(q.y, q.x), p, n, occlusion, slope
        ),
        lambda i, p: lights.distant_light(
            p, vec3(3.0, 4.0, 0.0) if i == 0 else vec3(0.0, -1.0, 0.0), 2.0, vec3(1.0, 0.5, 0.25)
        ),
        lambda n: vec3(0.1) + 0.2 * max(n, 0.0),
        shadows.no_shadow,
        March(1.0, 0.0, 50.0, 1e-4),
        shade.Shading(occlusion, 0.0),
        2,
        False,
    )
    return found.color


@func
def occlusion_beside_a_wall(distance: float, reach: float) -> float:
    """On a floor, by ``test_occlusion``, as high above it as rays start."""
    above = vec3(distance, trace.ray_offset(March(1.0, 0.0, 50.0, 1e-4), 4.5, False), 0.0)
    return shade.ambient_occlusion(lambda p: min(p.y, p.x), above, vec3(0.0, 1.0, 0.0), reach, 1.0)


def test_direct_light_is_the_sum_of_its_parts():
    """0.5 scattered, 0.3 mirrored at a roughness of 0.4, with what is around occluded."""
    light = 2.0 * np.array([1.0, 0.5, 0.25])
    emission = np.array([0.01, 0.02, 0.03])
    around = 0.5 * np.array([0.1, 0.3, 0.1]) + 0.3 * 0.4 * np.array([0.1, 0.26, 0.1])
    hidden = occlusion_beside_a_wall(0.3, 1.0)
    toward = (0.6, 0.8, 0.0)
    gloss = shine(toward, toward, 0.4, 0.0)
    for occlusion, share in ((0.0, 1.0), (1.0, hidden)):
        expected = emission + share * around + light * (0.5 * 0.8 + 0.3 * gloss)
        found = lit((0.5, 0.3, 0.4), occlusion)
        assert tuple(found) == pytest.approx(tuple(expected), rel=1e-5)


def test_only_what_is_rough_mirrors_what_is_around_here():
    smooth = lit((0.5, 0.3, 0.0), 0.0)
    light = 2.0 * np.array([1.0, 0.5, 0.25])
    around = 0.5 * np.array([0.1, 0.3, 0.1])
    expected = np.array([0.01, 0.02, 0.03]) + around + light * 0.5 * 0.8
    assert tuple(smooth) == pytest.approx(tuple(expected), rel=1e-5)


@func
def start_of_rays(threshold: float, t: float, hybrid: bool) -> float:
    return trace.ray_offset(March(1.0, 0.0, 50.0, threshold), t, hybrid)


def test_rays_begin_above_what_a_march_may_be_off():
    """A march ends within one threshold of the way, the hybrid one within two."""
    assert start_of_rays(1e-3, 5.0, False) >= 2.0 * 1e-3 * 5.0
    assert start_of_rays(1e-3, 5.0, False) < 2.1 * 1e-3 * 5.0
    assert 3.0 * 1e-3 * 5.0 <= start_of_rays(1e-3, 5.0, True) < 3.1 * 1e-3 * 5.0
