"""A scene of many parts shows the same with and without its table, on every target."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from distal import (
    AmbientLight,
    Box,
    Camera,
    Capsule,
    Cylinder,
    DistantLight,
    Ellipsoid,
    Plane,
    PointLight,
    Scene,
    Sphere,
    Torus,
    checker,
    glass,
    matte,
    mirror,
    union,
)
from distal.lang import slider
from distal.render.shadows import SHARPEST
from distal.scene.checks.probe import probe
from distal.scene.lowering.parts.table import rolled

SIZE = (48, 36)
EYE = Camera((3.0, 2.5, 5.0), target=(0.0, 0.0, 0.0))
SUN = DistantLight((1.0, 2.0, 1.5), angle=0.05)
LAMP = PointLight((2.0, 4.0, 3.0), intensity=20.0, radius=0.4)


def shape_of(rng, size):
    """A shape of one of six kinds, turned and moved."""
    a, b = rng.uniform(0.3, 1.0, 2) * size
    made = [
        Sphere(a),
        Box(a, b, a),
        Torus(a, 0.3 * a),
        Capsule(0.3 * b, a),
        Cylinder(a, b),
        Ellipsoid((a, b, 0.5 * a)),
    ][rng.integers(6)]
    if rng.random() < 0.5:
        made = made.rotate(x=float(rng.uniform(-3, 3)), y=float(rng.uniform(-3, 3)))
    return made.translate(*rng.uniform(-1.5, 1.5, 3))


def many(seed, count, size=0.3, paint=True):
    """Parts of several sizes that overlap, touch, coincide and hold one another."""
    rng = np.random.default_rng(seed)
    shapes = [shape_of(rng, size * rng.choice([0.05, 1.0, 1.0, 3.0])) for _ in range(count - 2)]
    shapes += [shapes[0], Box(0.4, 0.4, 0.4).translate(0.4, 0.0, 0.0)]  # one twice, one beside
    if paint:
        shapes = [s.paint(tuple(rng.uniform(0.1, 0.9, 3))) for s in shapes]
    return shapes[0].union(shapes[1:])


def both(shape, size=SIZE, **given):
    """Render a scene with its table and without; return the linear light of both."""
    given = {"camera": EYE, "lights": SUN, "background": (0.1, 0.2, 0.4), **given}
    scenes = [Scene(shape, acceleration=a, **given) for a in (True, False)]
    assert rolled(scenes[0].shape.node).table is not None
    return [s.render(size=size, samples=1).array.astype(float)[..., :3] for s in scenes]


def far_off(a, b, limit=0.05):
    """Return the share of the pixels that differ."""
    return float((np.abs(a - b).max(axis=-1) > limit).mean())


@settings(max_examples=3)
@given(st.integers(0, 10**6))
def test_random_parts_have_the_same_picture(seed):
    a, b = both(many(seed, 20) | Plane(y=-1.6))
    assert a.std() > 0.01
    assert far_off(a, b) < 0.01


@pytest.mark.parametrize(
    "given",
    [
        {"look": "studio", "lights": None, "background": None},
        {
            "camera": Camera((-0.3, 1.3, 0.4), target=(1.0, 0.2, 0.0)),
            "lights": [SUN, AmbientLight()],
        },
    ],
    ids=["studio", "among"],
)
def test_lights_and_cameras(given):
    a, b = both(many(5, 24) | Plane(y=-1.6), **given)
    assert far_off(a, b) < 0.01


def test_a_camera_inside_of_parts_that_overlap():
    shells = [Sphere(1.0 + 0.1 * i).translate(0.05 * i, 0.0, 0.0) for i in range(20)]
    camera = Camera((0.0, 0.0, 0.0), target=(1.0, 0.0, 0.0))
    whole = shells[0].union(shells[1:]).paint(checker("red", "white", 0.3))
    a, b = both(whole, camera=camera, lights=AmbientLight())
    assert far_off(a, b) == 0.0


@pytest.mark.parametrize("material", [glass(1.3, "#ddffee"), mirror()], ids=["glass", "mirror"])
def test_rays_that_go_on(material):
    rng = np.random.default_rng(8)
    balls = [Sphere(0.25).translate(*p).paint(material) for p in rng.uniform(-1.2, 1.2, (24, 3))]
    floor = Plane(y=-1.6).paint(checker("black", "white", 0.5))
    a, b = both(balls[0].union(balls[1:]) | floor, bounces=4)
    # A few rays between three balls go another way after a difference of a rounding error.
    assert far_off(a, b) < 0.03 and abs(a.mean() - b.mean()) < 2e-3


def test_thin_parts_side_by_side_leave_no_light_between_them():
    boards = [Box(0.1, 0.02, 2.0).translate(0.1 * i - 1.2, 0.0, 0.0) for i in range(25)]
    a, b = both(
        boards[0].union(boards[1:]) | Plane(y=-1.0), lights=DistantLight((0.0, 1.0, 0.0), angle=0.1)
    )
    assert far_off(a, b, 0.02) < 0.01


@pytest.mark.parametrize("turn", [0.0, 0.3, 1.9, -2.4])
@pytest.mark.parametrize("inner", [Box(0.8, 0.4, 0.8), Torus(0.3, 0.1), Cylinder(0.4, 0.4)])
def test_of_surfaces_at_one_place_the_first_is_shown(inner, turn):
    # Rays of all octants, which meet boxes in eight orders: no seam, and no speckles.
    places = [(float(i), 0.0, float(j)) for i in range(-2, 3) for j in range(-2, 3)]
    twice = [inner.translate(at).paint(c) for at in places for c in ("red", "blue")]
    whole = union(twice).rotate(y=turn)
    eye = Camera((0.2, 4.0, 4.0), target=(0.2, 0.0, 0.0))
    picture = Scene(whole, lights=AmbientLight(1.0), camera=eye, background="black").render(
        (96, 72)
    )
    red, _, blue = np.moveaxis(picture.array.astype(float)[..., :3], -1, 0)
    assert (red > 0.1).mean() > 0.2 and (blue > 0.1).mean() < 5e-4


@pytest.mark.parametrize("thickness", [1e-5, 1e-4, 1e-3, 0.02])
@pytest.mark.parametrize("lean", [0.0, 0.5, 1.2])
def test_no_light_of_a_sharp_sun_passes_thin_parts(thickness, lean):
    # Most are thinner than the cone around a ray, and lie between two points of its march.
    strips = [Box(0.5, thickness, 4.0).translate(0.4 * i - 8.0, 2.0, 0.0) for i in range(40)]
    sun = DistantLight((math.sin(lean), math.cos(lean), 0.0), angle=0.001)
    eye = Camera((0.0, 1.9, 0.01), target=(0.0, 0.0, 0.0))
    scene = Scene(union(strips) | Plane(), lights=sun, camera=eye, ambient_occlusion=0.0)
    middle = scene.render((40, 30)).array.astype(float)[12:18, 16:24, :3]
    assert middle.max() <= 1e-6


def test_the_edge_of_a_sharp_shadow_is_where_it_is():
    # Closed form: a ball of radius 1, 4 above a plane under the sun, has a round shadow.
    balls = [Sphere(0.02).translate(9.0 + 0.1 * i, 0.02, 9.0) for i in range(20)]
    sun = DistantLight((0.0, 1.0, 0.0), angle=0.001)
    eye = Camera((0.0, 2.0, 0.01), target=(0.0, 0.0, 0.0), fov_deg=60.0)
    whole = union([Sphere(1.0).translate(0.0, 4.0, 0.0), *balls]) | Plane()
    scene = Scene(whole, lights=sun, camera=eye, ambient_occlusion=0.0)
    lit = scene.render((200, 200)).array.astype(float)[..., 0]
    share = 1.0 - lit / lit.max()
    pixel = 2.0 * 2.0 * math.tan(math.radians(30.0)) / 200.0
    radius = math.sqrt(share.sum() * pixel**2 / math.pi)
    # Half of a radius of the narrowest cone farther out.
    assert radius == pytest.approx(1.0 + 0.5 * SHARPEST * 4.0, abs=0.002)


def test_tiny_and_huge_parts_in_one_table():
    tiny = [Sphere(0.002).translate(0.01 * i, 0.0, 0.0) for i in range(20)]
    huge = [Sphere(1e3).translate(0.0, -1e3 - 0.01, 0.0), Box(50.0, 1e-3, 50.0)]
    camera = Camera((0.1, 0.05, 0.4), target=(0.1, 0.0, 0.0))
    a, b = both(tiny[0].union([*tiny[1:], *huge]), camera=camera)
    assert far_off(a, b) < 0.01


@pytest.mark.parametrize("device", ["reference", "gpu", "gpu-fragment"])
def test_targets_agree(device):
    scene = Scene(many(9, 18) | Plane(y=-1.6), camera=EYE, lights=LAMP, ambient_occlusion=0.4)
    pictures = [scene.render(size=(24, 18), samples=1, device=d).array for d in ("cpu", device)]
    a, b = (p.astype(float)[..., :3] for p in pictures)
    assert far_off(a, b, 0.02) < 0.01


def distance_from_box(points, low, high):
    return np.linalg.norm(np.maximum(np.maximum(low - points, points - high), 0.0), axis=1)


def test_distances_are_those_of_the_parts():
    """A part whose box is farther than another part may be left out, where its field is less.

    Fields of ellipsoids are less than the distance: both values are lower bounds then. Which one
    comes depends on the lanes that walk the tree together, and so on the processor.
    """
    rng = np.random.default_rng(2)
    shapes = [shape_of(rng, 0.3) for _ in range(40)]
    points = rng.uniform(-3, 3, (2000, 3))
    fields = np.array([s(points) for s in shapes])
    boxes = np.array([distance_from_box(points, *s.bounds()) for s in shapes])
    least, most = fields.min(axis=0), np.maximum(fields, boxes).min(axis=0)
    whole = shapes[0].union(shapes[1:])
    found = whole(points)
    assert (found >= least - 2e-6).all()
    assert (found <= most + 2e-6).all()
    equal = most - least < 2e-6
    assert equal.mean() > 0.9
    assert found[equal] == pytest.approx(least[equal], abs=4e-6)
    low, high = whole.bounds()
    assert low == pytest.approx(np.min([s.bounds()[0] for s in shapes], axis=0), abs=1e-5)
    assert high == pytest.approx(np.max([s.bounds()[1] for s in shapes], axis=0), abs=1e-5)


def test_a_slider_moves_a_part_of_the_table():
    ball = Sphere(0.3).translate(slider("x", 0.0, low=-2.0, high=2.0), 1.0, 0.0).paint("red")
    dots = [Sphere(0.1).translate(0.3 * i - 2.0, 0.0, 0.0) for i in range(16)]
    scene = Scene(dots[0].union([*dots[1:], ball]), camera=EYE, lights=SUN)
    left, right = (scene.render(size=SIZE, samples=1, params={"x": x}).array for x in (-1.0, 1.0))

    def column(picture):
        red = picture[..., 0].astype(float) - picture[..., 1]
        return np.argmax(red.sum(axis=0))

    assert column(left) < column(right) - 8


def test_the_probe_names_the_part():
    dots = [
        Sphere(0.1)
        .translate(0.3 * i - 2.3, 0.0, 0.0)
        .named(f"dot {i}")
        .paint(("red", "blue")[i % 2])
        for i in range(16)
    ]
    camera = Camera((0.1, 0.0, 5.0), target=(0.1, 0.0, 0.0))
    scene = Scene(dots[0].union(dots[1:]).translate(0.0, 0.0, 0.0), camera=camera, lights=SUN)
    found = probe(scene, (50, 50), (101, 101))
    assert found.hit and [n.name for n in found.path] == ["translate", "union", "dot 8", "Sphere"]
    assert found.path[-1].place is not None
    assert tuple(found.seen.surface.color) == pytest.approx((1.0, 0.0, 0.0))


def test_parts_of_several_pieces_have_their_own_leaves_and_materials():
    def lollipop(i):
        stick = Capsule(0.03, 0.5).translate(0.0, -0.25, 0.0).paint("white")
        return (Sphere(0.12).paint((0.05 * i, 0.5, 0.2)).union(stick, smooth=0.02)).translate(
            0.3 * i - 2.4, 0.0, 0.0
        )

    sweets = [lollipop(i) for i in range(17)]
    scene = Scene(sweets[0].union(sweets[1:]), camera=Camera((0, 0, 5), target=(0, 0, 0)))
    assert len(rolled(scene.shape.node).table.kinds) == 1
    found = probe(scene, (50, 50), (101, 101))
    assert found.path[-1].name == "Sphere" and found.seen.surface.color.x == pytest.approx(0.4)
    below = probe(scene, (50, 57), (101, 101))
    assert below.path[-1].name == "Capsule" and below.seen.surface.color.x == pytest.approx(1.0)


def test_layers_number_materials_by_the_authors_order():
    paints = [matte(color) for color in ("red", "lime", "blue")]
    dots = [Sphere(0.2).translate(0.5 * i - 4.0, 0, 0).paint(paints[i % 3]) for i in range(16)]
    camera = Camera((0.0, 0.0, 12.0), target=(0.0, 0.0, 0.0), fov_deg=10.0)
    numbers = [
        Scene(dots[0].union(dots[1:]), camera=camera, acceleration=a).render(
            size=(64, 9), layers=["material"], samples=1
        )
        for a in (True, False)
    ]
    one, other = (n.layers["material"] for n in numbers)
    assert set(np.unique(other)) >= {1, 2, 3}
    assert np.array_equal(one, other)


def test_a_thousand_parts_of_a_loop():
    rng = np.random.default_rng(1)
    dots = [Sphere(0.03).translate(*p) for p in rng.uniform(-1, 1, (1000, 3))]
    shape = dots[0].union(dots[1:])
    points = rng.uniform(-1.2, 1.2, (500, 3))
    centers = np.random.default_rng(1).uniform(-1, 1, (1000, 3))
    expected = np.linalg.norm(points[:, None] - centers, axis=-1).min(axis=1) - 0.03
    assert shape(points) == pytest.approx(expected, abs=1e-5)


def test_copies_at_positions_have_the_same_picture():
    places = np.random.default_rng(6).uniform((-2, -0.5, -2), (2, 0.5, 2), (60, 3))
    a, b = both(Torus(0.2, 0.06).paint("tomato").array(places).rotate(y=0.4) | Plane(y=-0.8))
    assert far_off(a, b) < 0.01
