"""Optics, lights, cameras, colors: values that are known without a program."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal.lang import Buffer, func, vec3
from distal.render import ambient, camera, environment, lights, material, patterns, sky, tonemap
from distal.render.material import Surface


def tuple_of(v):
    return tuple(float(x) for x in v)


@pytest.mark.parametrize("ior", [1.1, 1.5, 2.42])
def test_fresnel_head_on_and_grazing(ior):
    assert material.fresnel_dielectric(1.0, ior) == pytest.approx(((ior - 1) / (ior + 1)) ** 2)
    assert material.fresnel_dielectric(0.0, ior) == pytest.approx(1.0)


def test_at_brewsters_angle_half_of_what_is_polarised_across_comes_back():
    angle = math.atan(1.5)
    across = math.sin(2 * angle - math.pi / 2) ** 2  # sin^2(i - r) with i + r a right angle
    found = material.fresnel_dielectric(math.cos(angle), 1.5)
    assert found == pytest.approx(0.5 * across, rel=1e-4)


def test_beyond_the_critical_angle_everything_is_mirrored():
    critical = math.asin(1 / 1.5)
    just_beyond = material.fresnel_dielectric(math.cos(critical + 1e-3), 1 / 1.5)
    just_before = material.fresnel_dielectric(math.cos(critical - 1e-3), 1 / 1.5)
    assert just_beyond == 1.0
    assert just_before < 0.9


def test_reflectance_is_the_same_from_both_sides():
    into = math.radians(40)
    inside = math.asin(math.sin(into) / 1.5)
    outer = material.fresnel_dielectric(math.cos(into), 1.5)
    assert material.fresnel_dielectric(math.cos(inside), 1 / 1.5) == pytest.approx(outer, rel=1e-4)


KINDS = {
    "matte": material.matte(),
    "glossy": material.glossy(),
    "metal": material.metal(),
    "mirror": material.mirror(),
    "glass": material.glass(),
    "plastic": material.plastic(),
    "emissive": material.emissive(),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("inside", [False, True])
@pytest.mark.parametrize("cosine", [0.0, 0.05, 0.3, 0.7, 1.0])
def test_no_surface_gives_back_more_than_it_gets(kind, inside, cosine):
    found = material.shares(KINDS[kind], cosine, inside)
    total = np.array(found.diffuse) + np.array(found.mirrored) + np.array(found.transmitted)
    assert np.all(total <= 1 + 1e-5)
    assert np.all(total >= 0)


def test_clear_glass_loses_nothing():
    for cosine in (0.05, 0.5, 1.0):
        found = material.shares(material.glass(1.5), cosine, False)
        assert tuple_of(found.mirrored + found.transmitted) == pytest.approx((1, 1, 1))


def test_weights_without_fresnel_hold_as_they_stand():
    surface = Surface(vec3(0.5, 1.0, 0.25), 0.05, 0.1, 0.85, 1.4)
    for cosine in (0.2, 1.0):
        found = material.shares(surface, cosine, False)
        assert tuple_of(found.diffuse) == pytest.approx((0.025, 0.05, 0.0125))
        assert tuple_of(found.mirrored) == pytest.approx((0.1, 0.1, 0.1))
        assert tuple_of(found.transmitted) == pytest.approx((0.425, 0.85, 0.2125))


def test_total_reflection_without_fresnel_mirrors_what_would_go_through():
    surface = Surface(vec3(1.0), 0.05, 0.1, 0.85, 1.4)
    found = material.shares(surface, 0.2, True)
    assert tuple_of(found.mirrored) == pytest.approx((0.95, 0.95, 0.95))
    assert tuple_of(found.transmitted) == (0, 0, 0)


def test_mixed_materials_mix_every_number():
    middle = material.mix_surfaces(material.matte(vec3(1, 0, 0)), material.glass(2.0), 0.25)
    assert middle.transmission == pytest.approx(0.25)
    assert middle.ior == pytest.approx(1.5 + 0.25 * 0.5)
    assert tuple_of(middle.color) == pytest.approx((1.0, 0.25, 0.25))


def head_on_albedo(roughness):
    """What a rough mirror sends straight up of light 1 from everywhere above."""
    cosines = (np.arange(200) + 0.5) / 200  # evenly by solid angle
    up = vec3(0.0, 1.0, 0.0)
    surface = Surface(roughness=roughness)
    shown = [
        material.highlight(surface, up, up, vec3(math.sqrt(1 - c * c), c, 0.0), 0.0)
        for c in cosines
    ]
    # In units of pi, what falls on the surface; the hemisphere is 2 pi wide.
    return 2.0 * float(np.mean(shown))


@pytest.mark.parametrize("roughness", [0.5, 0.7])
def test_a_rough_mirror_gives_back_what_the_textbook_says(roughness):
    """The same integral by the distribution and Smith's Lambda as Heitz (2014) writes them."""
    squared = roughness**4
    cosine = (np.arange(200) + 0.5) / 200
    middle = np.sqrt(0.5 * (1 + cosine))  # of half the angle
    tangent = (1 - middle**2) / middle**2
    facets = 1 / (math.pi * squared * middle**4 * (1 + tangent / squared) ** 2)
    masked = 0.5 * (np.sqrt(1 + squared * (1 / cosine**2 - 1)) - 1)
    sent = facets / (1 + masked) / (4 * cosine) * cosine
    assert head_on_albedo(roughness) == pytest.approx(2 * math.pi * sent.mean(), rel=1e-4)
    assert head_on_albedo(roughness) <= 1.0


def test_the_roughest_mirror_gives_back_what_its_integral_says():
    """2 times the integral of c / (2 (1 + c)) from 0 to 1: 1 - ln 2, the rest is masked."""
    assert head_on_albedo(1.0) == pytest.approx(1 - math.log(2), abs=1e-4)


@pytest.mark.parametrize("distance", [0.5, 1.0, 3.0])
def test_light_thins_with_the_square_of_the_distance(distance):
    found = lights.point_light(vec3(0.0), vec3(0.0, distance, 0.0), 2.0)
    assert tuple_of(found.radiance) == pytest.approx((2 / distance**2,) * 3)
    assert found.distance == pytest.approx(distance)
    assert tuple_of(found.direction) == pytest.approx((0, 1, 0))


def test_a_spot_is_full_inside_half_on_the_rim_and_dark_outside():
    def shown(angle):
        p = vec3(math.sin(angle), -math.cos(angle), 0.0)
        light = lights.spot_light(p, vec3(0.0), vec3(0.0, -1.0, 0.0), angle=1.0, softness=0.2)
        return light.radiance[0]

    assert shown(0.39) == pytest.approx(1.0, abs=1e-4)
    assert 0.1 < shown(0.45) < 0.9
    assert shown(0.51) == 0.0


def test_the_sun_fills_its_angle():
    found = lights.distant_light(vec3(5.0), vec3(0.0, 2.0, 0.0), angle=0.0093)
    assert found.radius == pytest.approx(math.tan(0.00465))


def directions(count=40000):
    """Directions spread evenly over the ball, by the golden angle."""
    index = np.arange(count) + 0.5
    y = 1 - 2 * index / count
    around = index * math.pi * (3 - math.sqrt(5))
    level = np.sqrt(1 - y * y)
    return np.stack([level * np.cos(around), y, level * np.sin(around)], axis=1)


@pytest.mark.parametrize("n", [(0, 1, 0), (0, -1, 0), (0.6, 0.8, 0), (1, 0, 0)])
def test_the_skys_diffuse_light_is_the_mean_of_the_sky(n):
    seen = directions()
    light = np.asarray(sky.sky(seen, sun_intensity=0.0))
    weight = np.maximum(seen @ np.array(n), 0.0)
    expected = (light * weight[:, None]).sum(0) * 4.0 / len(seen)
    assert tuple_of(ambient.sky_ambient(vec3(*n))) == pytest.approx(tuple(expected), abs=2e-3)


def test_a_pictures_harmonics_light_as_the_picture_does():
    height, width = 32, 64
    rows, columns = np.mgrid[0:height, 0:width]
    polar = math.pi * (rows + 0.5) / height
    around = 2 * math.pi * ((columns + 0.5) / width - 0.5)
    x, y, z = np.sin(polar) * np.sin(around), np.cos(polar), -np.sin(polar) * np.cos(around)
    texels = np.stack([1 + y, 1 + 0.5 * x * y + x, 1 + z * z - 0.3 * z], axis=-1)
    table = Buffer([tuple(row) for row in environment.harmonics(texels)])

    @func
    def lit(n: vec3) -> vec3:
        return ambient.environment_ambient(n, table)

    area = np.sin(polar) * (math.pi / height) * (2 * math.pi / width)
    for n in ((0.0, 1.0, 0.0), (0.0, 0.0, -1.0), (0.6, 0.0, 0.8), (0.36, -0.48, 0.8)):
        weight = np.maximum(x * n[0] + y * n[1] + z * n[2], 0.0) * area / math.pi
        expected = (texels * weight[..., None]).sum((0, 1))
        assert tuple_of(lit(vec3(*n))) == pytest.approx(tuple(expected), abs=4e-3)


def test_cameras_look_where_they_are_told():
    middle, up = (0.0, 0.0), (0.0, 1.0)
    ray = camera.look_at(middle, vec3(3.0, 0.0, 4.0), vec3(0.0), fov=math.pi / 2)
    assert tuple_of(ray.direction) == pytest.approx((-0.6, 0.0, -0.8))
    top = camera.look_at(up, vec3(0.0, 0.0, 5.0), vec3(0.0), fov=math.pi / 2)
    assert tuple_of(top.direction) == pytest.approx((0, math.sqrt(0.5), -math.sqrt(0.5)), abs=1e-6)


def test_a_turned_camera_looks_along_minus_z_then_left_then_up():
    straight = camera.turned((0.0, 0.0))
    assert tuple_of(straight.direction) == pytest.approx((0, 0, -1))
    left = camera.turned((0.0, 0.0), yaw=math.pi / 2)
    assert tuple_of(left.direction) == pytest.approx((-1, 0, 0), abs=1e-6)
    high = camera.turned((0.0, 0.0), pitch=math.pi / 4)
    assert tuple_of(high.direction) == pytest.approx((0, 0.5**0.5, -(0.5**0.5)), abs=1e-6)
    # A camera that rolls counterclockwise has its right side up.
    rolled = camera.turned((1.0, 0.0), roll=math.pi / 2, screen_height=2.0)
    assert tuple_of(rolled.direction) == pytest.approx((0, 0.5**0.5, -(0.5**0.5)), abs=1e-6)


def test_mirrored_cameras_swap_left_and_right():
    right = camera.look_at((0.5, 0.2), mirrored=False).direction
    left = camera.look_at((0.5, 0.2), mirrored=True).direction
    assert (left[0], left[1], left[2]) == pytest.approx((-right[0], right[1], right[2]))


def test_orbit_stands_on_its_ball():
    ray = camera.orbit((0.0, 0.0), 4.0, math.pi / 2, 0.0, vec3(1.0, 2.0, 3.0))
    assert tuple_of(ray.origin) == pytest.approx((5, 2, 3), abs=1e-5)
    above = camera.orbit((0.0, 0.0), 4.0, 0.0, math.pi / 2)
    assert tuple_of(above.direction) == pytest.approx((0, -1, 0), abs=1e-6)


def test_fisheye_panorama_and_orthographic():
    side = camera.fisheye((1.0, 0.0), vec3(0.0), vec3(0.0, 0.0, -1.0), fov=math.pi)
    assert tuple_of(side.direction) == pytest.approx((1, 0, 0), abs=1e-6)
    behind = camera.panorama((2.0, 0.0), vec3(0.0), vec3(0.0, 0.0, -1.0))
    assert tuple_of(behind.direction) == pytest.approx((0, 0, 1), abs=1e-6)
    flat = camera.orthographic((1.0, 0.0), vec3(0.0, 0.0, 5.0), vec3(0.0), height=6.0)
    assert tuple_of(flat.origin) == pytest.approx((3, 0, 5))
    assert tuple_of(flat.direction) == pytest.approx((0, 0, -1))


def test_panorama_and_environment_are_each_others_inverse():
    for uv in ((0.3, 0.2), (-1.5, -0.7), (1.9, 0.9)):
        ray = camera.panorama(uv, vec3(0.0), vec3(0.0, 0.0, -1.0))
        place = camera.equirectangular(ray.direction)
        assert tuple_of(place) == pytest.approx((uv[0] / 4 + 0.5, uv[1] / 2 + 0.5), abs=1e-4)


def test_srgb_there_and_back():
    values = np.linspace(0, 1, 257)
    grey = np.stack([values] * 3, axis=1)
    back = tonemap.decode_srgb(tonemap.encode_srgb(grey))
    assert np.abs(np.asarray(back) - grey).max() < 1e-5
    assert tonemap.encode_srgb(vec3(0.5))[0] == pytest.approx(0.735357, abs=1e-5)


@pytest.mark.parametrize("tone_map", range(5))
def test_tone_maps_keep_black_rise_and_stay_in_range(tone_map):
    light = np.concatenate([[0.0], np.geomspace(1e-4, 1.0 if tone_map == 0 else 50.0, 200)])
    grey = np.stack([light] * 3, axis=1)
    shown = np.asarray(tonemap.tone_mapped(grey, tone_map))
    assert shown.min() >= -1e-6
    assert shown.max() <= 1.0 + 1e-6
    assert shown[0].max() < 2e-3
    assert np.all(np.diff(shown[:, 0]) >= -1e-4)


def test_white_in_white_out():
    shown = tonemap.display((1.0, 1.0, 1.0, 0.5), 1.0, tonemap.NONE)
    assert tuple_of(shown) == pytest.approx((1, 1, 1, 0.5))


def test_checkers_alternate_and_do_not_flicker_on_their_borders():
    for x, z in ((0, 0), (1, 0), (3, 2), (-1, -4)):
        p = vec3(x + 0.5, 0.0, z + 0.5)
        assert patterns.checker(p) == (x + z) % 2
        # A floor at height 0 lies on a border of cubes, give or take a march's error.
        assert patterns.checker(p - vec3(0.0, 1e-4, 0.0)) == (x + z) % 2


def test_noise_is_within_its_range_and_uses_it():
    p = np.random.default_rng(3).uniform(-20, 20, (4000, 3))
    shown = np.asarray(patterns.clouds(p, 1.0, 3))
    assert 0 <= shown.min() < 0.3
    assert 0.7 < shown.max() <= 1
    assert shown.mean() == pytest.approx(0.5, abs=0.03)


def test_cells_have_colours_of_their_own():
    cells = np.array([(x, y, 0.0) for x in range(6) for y in range(6)])
    shown = np.asarray(patterns.by_cell(cells))
    apart = np.abs(shown[:, None] - shown[None]).max(-1)
    assert np.all(apart[~np.eye(36, dtype=bool)] > 1e-3)
    assert shown.min() >= 0
    assert shown.max() <= 1


def test_the_suns_limb_is_darker():
    n = vec3(0.0, 0.0, 1.0)
    assert patterns.limb_darkening(n, n) == pytest.approx(1.0)
    assert patterns.limb_darkening(n, vec3(1.0, 0.0, 0.0)) == pytest.approx(0.4)
