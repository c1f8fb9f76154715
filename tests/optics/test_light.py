"""Lights, mirrors, weights and colors whose answer is known in closed form, in whole scenes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import (
    AmbientLight,
    Box,
    Camera,
    DistantLight,
    Environment,
    HemisphereLight,
    Material,
    Plane,
    PointLight,
    Scene,
    Shape,
    Sky,
    Sphere,
    SpotLight,
    emissive,
    glass,
    matte,
    metal,
    mirror,
    plastic,
)
from distal.lang import func, sin, vec3
from tests.optics.looking import bent, compass, seen, thrown_back, unit, way_seen

FLOOR = Plane(y=0.0).paint("#fff")
EYE, ORIGIN = (0.6, 2.0, 1.2), (0.0, 0.0, 0.0)
UP = np.array([0.0, 1.0, 0.0])


def grey(value):
    return pytest.approx((value,) * 3, rel=3e-3, abs=3e-4)


def test_a_point_light_of_intensity_1_at_distance_1_shows_white_as_white():
    assert seen(FLOOR, EYE, ORIGIN, lights=[PointLight((0, 1, 0))]) == grey(1.0)


@pytest.mark.parametrize("distance", [0.5, 2.0, 5.0, 20.0])
@pytest.mark.parametrize("angle", [0.0, 0.7, 1.3])
def test_light_thins_with_the_square_of_the_distance_and_the_cosine(distance, angle):
    place = (distance * math.sin(angle), distance * math.cos(angle), 0.0)
    light = PointLight(place, intensity=3.0)
    expected = 3.0 * math.cos(angle) / distance**2
    assert seen(FLOOR, EYE, ORIGIN, lights=[light]) == pytest.approx([expected] * 3, rel=1e-2)


@pytest.mark.parametrize("angle", [0.0, 0.5, 1.0, 1.4])
def test_the_sun_is_as_bright_everywhere_and_goes_with_the_cosine(angle):
    sun = DistantLight((math.sin(angle), math.cos(angle), 0.0), intensity=2.0)
    for x in (0.0, 40.0):
        found = seen(FLOOR, (x, 2.0, 1.0), (x, 0.0, 0.0), lights=[sun])
        assert found == grey(2.0 * math.cos(angle))


def test_a_light_below_the_floor_does_not_shine_through_it():
    assert seen(FLOOR, EYE, ORIGIN, lights=[PointLight((0, -1, 0))]) == grey(0.0)


def test_lights_add_up_and_color_what_they_light():
    lights = [
        PointLight((0, 1, 0), 0.5, color=(1, 0, 0)),
        DistantLight((0, 1, 0), 0.25, color=(0, 1, 0)),
        AmbientLight(0.125, color=(0, 0, 1)),
    ]
    floor = Plane(y=0.0).paint((0.5, 0.5, 0.5))
    found = seen(floor, EYE, ORIGIN, lights=lights)
    assert found == pytest.approx((0.25, 0.125, 0.0625), rel=5e-3)


def test_a_spot_shines_in_its_cone_only():
    spot = SpotLight((0, 2, 0), (0, 0, 0), intensity=4.0, angle=math.pi / 4, softness=0.0)
    rim = 2.0 * math.tan(math.pi / 8)
    assert seen(FLOOR, (0, 2, 1), (0, 0, 0), lights=[spot]) == grey(1.0)
    inside, outside = 0.95 * rim, 1.05 * rim
    cosine = 2.0 / math.hypot(2.0, inside)
    expected = 4.0 * cosine / (4.0 + inside**2)
    assert seen(FLOOR, (inside, 2, 1), (inside, 0, 0), lights=[spot]) == grey(expected)
    assert seen(FLOOR, (outside, 2, 1), (outside, 0, 0), lights=[spot]) == grey(0.0)


@pytest.mark.parametrize(
    ("normal", "share"),
    [((0, 1, 0), 1.0), ((0, -1, 0), 0.0), ((1, 0, 0), 0.5), ((0, 0.6, 0.8), 0.8)],
)
def test_a_hemisphere_shows_by_how_far_a_surface_looks_up(normal, share):
    n = unit(*normal)
    light = HemisphereLight(sky=(1, 0, 0.5), ground=(0, 1, 0.5), intensity=1.0)
    found = seen(Sphere(1.0).paint("#fff"), tuple(4.0 * n), (0, 0, 0), lights=[light])
    assert found == pytest.approx((share, 1.0 - share, 0.5), abs=2e-3)


# What fully surrounds us

FURNACE = {
    "matte": matte("#fff"),
    "mirror": mirror("#fff"),
    "metal": metal((1.0, 1.0, 1.0), roughness=0.3),
    "plastic": plastic("#fff", roughness=0.1),
    "glass": glass(),
    "scattered and mirrored": Material(diffuse=0.6, specular=0.4),
    # From within, boundaries scatter nothing here: what goes in is mirrored or goes out.
    "mirrored and let in": Material(diffuse=0.0, specular=0.3, transmission=0.7),
}


@pytest.mark.parametrize("kind", FURNACE)
def test_in_even_light_nothing_white_is_seen(kind):
    """All that is white gives back what it gets: before a white sky it is not there."""
    for height in (0.0, 0.5, 0.9):
        found = seen(
            Sphere(1.0).paint(FURNACE[kind]),
            (0, height, 4),
            (0, height, 0),
            lights=[AmbientLight(1.0)],
            background=(1.0, 1.0, 1.0),
            bounces=10,
        )
        assert found == pytest.approx((1.0, 1.0, 1.0), abs=0.02), (kind, height)


def test_white_in_is_white_out_to_the_last_bit():
    floor = Plane(y=0.0).paint("#ffffff")
    lights, camera = [AmbientLight(1.0)], Camera((0, 2, 3))
    scene = Scene(floor, lights, camera, background="#ffffff", tone_map="none")
    picture = scene.render(size=(32, 24))
    assert np.all(picture.linear[..., :3] == 1.0)
    assert np.all(picture.array >= 1.0 - 2.0**-23)


@pytest.mark.filterwarnings("ignore:the picture is black")
@pytest.mark.parametrize("code", ["#000000", "#123456", "#808080", "#fedcba"])
def test_a_color_comes_out_as_it_was_written(code):
    wanted = [int(code[i : i + 2], 16) for i in (1, 3, 5)]
    scene = Scene(
        Plane(y=0.0).paint(code),
        lights=[AmbientLight(1.0)],
        camera=Camera((0, 2, 3)),
        background=code,
        tone_map="none",
    )
    pixels = scene.render(size=(16, 16)).array[..., :3] * 255.0
    assert np.abs(pixels - wanted).max() < 0.01


def test_exposure_is_a_factor_on_light_before_it_is_shown():
    lights, camera = [AmbientLight(0.1)], Camera((0, 2, 3))
    scene = Scene(FLOOR, lights, camera, exposure=2.0, tone_map="none")
    picture = scene.render(size=(16, 16))
    shown = 1.055 * 0.2 ** (1 / 2.4) - 0.055
    assert picture.array[-1, 8, :3] == pytest.approx([shown] * 3, abs=1e-3)


def test_fog_leaves_its_share():
    way = unit(*np.subtract(ORIGIN, EYE))
    distance = np.linalg.norm(EYE)
    found = seen(
        FLOOR,
        -distance * way,
        ORIGIN,
        lights=[AmbientLight(1.0)],
        fog=(0.0, 0.5, 1.0),
        fog_density=0.3,
    )
    clear = math.exp(-0.3 * distance)
    assert found == pytest.approx((clear, 0.5 + 0.5 * clear, 1.0), abs=1e-3)


def test_what_shines_shows_its_light_and_no_more():
    lamp = Sphere(1.0).paint(emissive((0.5, 2.0, 0.0), strength=2.0))
    lights = [AmbientLight(1.0), PointLight((0, 0, 3), 10.0)]
    found = seen(lamp, (0, 0, 4), (0, 0, 0), lights=lights)
    assert found == pytest.approx((1.0, 4.0, 0.0), abs=1e-4)


# Mirrors


@pytest.mark.parametrize("height", [0.0, 0.4, 0.7, 0.9])
def test_a_ball_mirrors_by_the_law_of_reflection(height):
    n = np.array([0.0, height, math.sqrt(1.0 - height**2)])
    expected = thrown_back(np.array([0.0, 0.0, -1.0]), n)
    found = way_seen(Sphere(1.0).paint(mirror()), (0, height, 5), (0, height, 0))
    assert found == pytest.approx(expected, abs=5e-3)


def middle_of(light):
    rows, columns = np.mgrid[0 : light.shape[0], 0 : light.shape[1]]
    return ((light * columns).sum() / light.sum(), (light * rows).sum() / light.sum())


@pytest.mark.parametrize("bead", [(0.3, 0.8, 0.0), (-0.5, 0.4, -1.0)])
def test_a_mirror_shows_a_lamp_where_its_image_is(bead):
    """The image is as far behind the mirror as the lamp is in front of it.

    Mirrored rays begin a hit's tolerance above the mirror: up to a pixel, as the tolerance is.
    """
    size, fov = 240, 0.8
    lamp = Sphere(0.05).translate(bead).paint(emissive("#fff"))
    camera = Camera((0, 1, 4), (0, 0, 0), fov=fov)
    scene = Scene(
        Plane(y=0.0).paint(mirror()) | lamp, lights=[], camera=camera, background=(0, 0, 0)
    )
    light = scene.render(size=(size, size)).linear[..., 0]

    forward = unit(0, -1, -4)
    right = np.array([1.0, 0.0, 0.0])
    above = np.cross(right, forward)

    def pixel(place):
        way = np.subtract(place, (0, 1, 4))
        across = np.array([way @ right, way @ above]) / (way @ forward) / math.tan(fov / 2)
        return (size * (1 + across[0]) - 1) / 2, (size * (1 - across[1]) - 1) / 2

    direct, image = pixel(bead), pixel((bead[0], -bead[1], bead[2]))
    halfway = round((direct[1] + image[1]) / 2)
    assert middle_of(light[:halfway]) == pytest.approx(direct, abs=0.5)
    column, row = middle_of(light[halfway:])
    assert (column, row + halfway) == pytest.approx(image, abs=1.0)


def test_a_corner_of_mirrors_sends_light_back_where_it_came_from():
    corner = (Plane(y=0.0) | Box(2, 20, 20).translate(x=-1) | Box(20, 20, 2).translate(z=-1)).paint(
        mirror()
    )
    way = unit(-1.0, -1.2, -0.9)
    found = way_seen(corner, tuple(np.array([0.5, 0.4, 0.6]) - 3.0 * way), (0.5, 0.4, 0.6))
    assert found == pytest.approx(-way, abs=3e-3)


def test_mirrors_are_followed_as_often_as_bounces_say():
    """Two lamps face two mirrors: each bounce adds what it meets."""
    walls = (Plane(y=0.0) | Box(20, 2, 20).translate(y=3)).paint(
        Material(diffuse=0.0, specular=0.5, emission=(1.0, 1.0, 1.0))
    )
    for bounces in (1, 2, 3, 5):
        found = seen(walls, (0, 1, 0), (0, 0, 0), bounces=bounces)
        assert found == grey(sum(0.5**i for i in range(bounces + 1)))


@pytest.mark.parametrize("angle", [0.0, 0.5, 1.1])
def test_weights_share_out_the_light(angle):
    """0.2 scattered of a light of 1, 0.3 mirrored, 0.5 bent, each from its own direction."""
    way = np.array([math.sin(angle), -math.cos(angle), 0.0])
    block = Plane(y=0.0).paint(Material(diffuse=0.2, specular=0.3, transmission=0.5, ior=1.5))
    found = seen(block, tuple(-3.0 * way), ORIGIN, lights=[AmbientLight(1.0)], background=compass)
    inside = bent(way, UP, 1.0, 1.5)
    shown = 0.3 * (0.5 + 0.5 * thrown_back(way, UP)) + 0.5 * (0.5 + 0.5 * inside)
    assert found == pytest.approx(0.2 + shown, abs=2e-3)


# Shadows


def penumbra(radius):
    """Where the light of a lamp comes past a straight edge 1 above the floor, the lamp 2 above.

    The edge is that of a thick bar: what is thinner than a light is wide is judged too thin.
    Returns the places along the floor and the share of light there.
    """
    side = 1.6 / math.sqrt(2.0)
    screen = Box(side, side, 20).rotate(z=math.pi / 4).translate(-0.8, 1.0, 0.0)
    scene = Scene(
        FLOOR | screen.paint((0, 0, 0)),
        lights=[PointLight((0, 2, 0), radius=radius)],
        background=(0, 0, 0),
        camera=Camera((0.3, 0.5, 0.0), (0.3, 0.0, 0.0), up=(0, 0, -1), fov_deg=100),
        exposure=1.0,
    )
    row = scene.render(size=(401, 401)).linear[200, :, 0].astype(float)
    x = 0.3 + (np.arange(401) - 200) / 200.5 * 0.5 * math.tan(math.radians(50))
    return x, row * (4 + x**2) ** 1.5 / 2.0


def width_of(x, share):
    return np.interp(0.9, share, x) - np.interp(0.1, share, x)


def test_half_of_a_lamp_is_hidden_where_the_edge_is_before_its_middle():
    x, share = penumbra(0.2)
    assert np.all(np.diff(share) > -0.02)
    assert np.interp(0.0, x, share) == pytest.approx(0.5, abs=0.1)
    assert share[0] < 0.01
    assert share[-1] == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("radius", [0.05, 0.1, 0.2])
def test_a_penumbra_is_as_wide_as_similar_triangles_say(radius):
    """A disc's share from 10 to 90 percent spans 0.687 of the penumbra, 2 radii here."""
    found = width_of(*penumbra(radius))
    expected = 0.687 * 2.0 * radius
    assert 0.6 * expected < found < 1.5 * expected


@pytest.mark.parametrize("radius", [0.05, 0.2])
def test_a_penumbra_is_the_share_of_the_disc_beside_a_straight_edge(radius):
    x, share = penumbra(radius)
    c = np.clip(x / radius, -1.0, 1.0)
    expected = 0.5 + (c * np.sqrt(1.0 - c * c) + np.arcsin(c)) / math.pi
    assert np.sqrt(np.mean((share - expected)[np.abs(x) < 1.3 * radius] ** 2)) < 0.02


def test_a_point_casts_a_hard_shadow():
    assert width_of(*penumbra(0.0)) < 0.02


def test_without_shadows_nothing_is_hidden():
    screen = Box(2, 0.1, 2).translate(0.0, 1.0, 0.0)
    light = [PointLight((0, 2, 0), 4.0)]
    under = {"lights": light, "position": (2.0, 0.5, 0.0), "target": ORIGIN}
    assert seen(FLOOR | screen, **under) == grey(0.0)
    assert seen(FLOOR | screen, **under, shadows=False) == grey(1.0)


@func
def swell(p: vec3) -> float:
    return p.y - 0.2 * sin(3.0 * p.x) * sin(2.0 * p.z)


def test_waves_that_are_strode_over_do_not_shade_themselves():
    """Places found too far below the surface once stood in their own shadow: dark rings."""
    sea = Shape.from_function(swell, slope=1.3, bounds=((-50, -9, -50), (50, 0.3, 50)))
    eye = Camera((0, 1.5, 4), (0, 0, -4))
    near = slice(140, 240)  # towards the horizon waves are smaller than pixels
    strode, walked = (
        Scene(sea, camera=eye, far=40.0, march=march).render(size=(360, 240)).array[near]
        for march in ("heightfield", "sphere")
    )
    assert (np.abs(strode - walked).max(axis=2) > 0.08).mean() < 1e-3


# No light counts twice

SKY = {"zenith": (0.4, 0.4, 0.4), "horizon": (0.4, 0.4, 0.4), "ground": (0.4, 0.4, 0.4)}
TURNED = {"sun": (0, 1, 0), "sun_color": (1, 1, 1), "sun_intensity": 0.5, **SKY}


def test_a_sky_as_background_is_no_light():
    assert seen(FLOOR, EYE, ORIGIN, background=Sky(**TURNED)) == grey(0.0)


@pytest.mark.parametrize("light", [False, True])
def test_a_sky_lights_once_however_it_is_given(light):
    """0.4 from all around and 0.5 from its sun overhead, on a white floor."""
    sky = Sky(**TURNED, light=light)
    once = grey(0.9)
    look = {"position": EYE, "target": ORIGIN}
    assert seen(FLOOR, **look, lights=[sky], background=(0, 0, 0)) == once
    assert seen(FLOOR, **look, lights=[sky], background=None) == once
    assert seen(FLOOR, **look, lights=[sky], background=sky) == once
    if light:
        assert seen(FLOOR, **look, background=sky) == once


@pytest.mark.parametrize("light", [False, True])
def test_surroundings_light_once_however_they_are_given(light):
    around = Environment(np.full((32, 64, 3), 0.7, np.float32), light=light)
    look = {"position": EYE, "target": ORIGIN}
    assert seen(FLOOR, **look, lights=[around], background=around) == grey(0.7)
    assert seen(FLOOR, **look, lights=[around], background=None) == grey(0.7)
    assert seen(FLOOR, **look, background=around) == grey(0.7 if light else 0.0)


def test_the_same_light_twice_is_two_lights():
    lamp = PointLight((0, 1, 0), 0.25)
    assert seen(FLOOR, EYE, ORIGIN, lights=[lamp, lamp]) == grey(0.5)
