"""A tree of many shapes shows the same with pieces and without, on every target."""

from __future__ import annotations

import numpy as np
import pytest

from distal import (
    AmbientLight,
    Box,
    Camera,
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
from distal.compiler import driver
from distal.scene.checks.probe import probe
from distal.scene.lowering.pieces.brick_table import bricked
from distal.scene.lowering.pieces.table import pieced

pytestmark = pytest.mark.usefixtures("always_pieces")
SIZE = (64, 48)
EYE = Camera((3.0, 2.5, 5.0), target=(0.0, 0.0, 0.0))
SUN = DistantLight((1.0, 2.0, 1.5), angle=0.05)


def balls(count, radius=0.25, seed=0, *, paint=False):
    rng = np.random.default_rng(seed)
    made = [Sphere(radius).translate(*p) for p in rng.uniform(-1, 1, (count, 3)).tolist()]
    return [b.paint(tuple(rng.uniform(0.1, 0.9, 3))) for b in made] if paint else made


def posts(count, seed=0):
    rng = np.random.default_rng(seed)
    return [
        Cylinder(0.12, 4.0).rotate(x=a, z=b).translate(c, 0, d)
        for a, b, c, d in rng.uniform(-1, 1, (count, 4)).tolist()
    ]


def plate():
    holes = [
        Cylinder(0.12, 1).translate(0.4 * i - 1, 0, 0.4 * j - 1) for i in range(6) for j in range(6)
    ]
    return Box(2.6, 0.3, 2.6) - union(holes)


TREES = {
    "plate": plate,
    "plate on a floor": lambda: plate().rotate(x=0.5).paint("orange") | Plane(y=-1.2),
    "cheese": lambda: Box(2, 2, 2) - union(balls(40)),
    "colors": lambda: union(balls(30, paint=True)) & Box(1.6, 1.6, 1.6).paint("red"),
    "cut faces": lambda: union(balls(24, 0.4, paint=True)) - Box(4, 4, 4).translate(2, 0, 0),
    "cutters with colors": lambda: (
        Box(2, 2, 2).paint("gray") - union(balls(20, 0.3, paint=True)).cut_material("gold")
    ),
    "soft": lambda: union(balls(40, 0.2, paint=True), smooth=0.1),
    "soft less hard": lambda: union(balls(30, 0.3, paint=True), smooth=0.05) - union(posts(10)),
    "hard less soft": lambda: Box(2, 2, 2).difference(union(balls(20, 0.3)), smooth=0.1),
    "shell": lambda: union(balls(20, 0.5)).shell(0.1) - Box(4, 4, 4).translate(2, 1, 0),
    "posts": lambda: union(posts(20)) & Ellipsoid(1.2, 1.0, 1.4),
    "nested": lambda: (
        (Box(2, 1, 2) - union(balls(12)))
        | (union(balls(12, 0.3, seed=1), smooth=0.1) & Box(1, 3, 1))
        | Torus(1.3, 0.1)
    ),
    "moved": lambda: (
        (union(balls(20)) - Box(1, 4, 1)).scale(0.7).rotate(y=0.4).translate(0.3, 0.2, 0)
        | (Box(1, 1, 1) - union(posts(8))).symmetry(across=(1, 0, 0))
    ),
    "complement": lambda: Box(2, 2, 2) & union(balls(20, 0.3)).complement(),
}


def has_pieces(shape):
    return pieced(shape.node).table is not None


def both(shape, **given):
    """Render a scene with pieces and without; return the linear light of both."""
    assert has_pieces(shape)
    given = {"camera": EYE, "lights": SUN, "background": (0.1, 0.2, 0.4), **given}
    scenes = [Scene(shape, acceleration=a, **given) for a in (True, False)]
    return [s.render(size=SIZE, samples=1).array.astype(float)[..., :3] for s in scenes]


def far_off(a, b, limit=0.05):
    """The share of pixels that differ."""
    return float((np.abs(a - b).max(axis=-1) > limit).mean())


@pytest.mark.parametrize("name", TREES)
def test_trees_have_the_same_picture(name):
    a, b = both(TREES[name]())
    assert far_off(a, b) < 0.02


@pytest.mark.parametrize(
    "given",
    [
        {"lights": [SUN, AmbientLight(0.4)]},
        {"lights": PointLight((2.0, 4.0, 3.0), intensity=20.0, radius=0.4)},
        {"lights": DistantLight((1.0, 2.0, 1.5))},
        {"camera": Camera((0.0, 0.2, 0.1), target=(1.0, 0.0, 0.0))},
    ],
    ids=["occlusion", "lamp", "sharp", "among"],
)
def test_lights_and_cameras(given):
    a, b = both((Box(2.2, 2.2, 2.2) - union(balls(40, 0.35))) | Plane(y=-1.3), **given)
    assert far_off(a, b) < 0.03


@pytest.mark.parametrize("material", [mirror(), matte(checker("white", "black", 0.2))])
def test_materials(material):
    whole = (Box(2.2, 2.2, 2.2) - union(balls(40, 0.35))).paint(material) | Plane(y=-1.3)
    a, b = both(whole)
    assert far_off(a, b) < 0.03


@pytest.mark.parametrize("device", ["reference", "gpu", "gpu-fragment"])
def test_targets_agree_on_pieces(device):
    shape = (union(balls(20, 0.4, paint=True), smooth=0.1) - union(posts(6))) | Plane(y=-1.3)
    assert has_pieces(shape)
    scene = Scene(shape, lights=[SUN, AmbientLight(0.3)], camera=EYE)
    pictures = [scene.render(size=(24, 18), samples=1, device=d).array for d in ("cpu", device)]
    a, b = (p.astype(float)[..., :3] for p in pictures)
    assert far_off(a, b, 0.02) < 0.01


@pytest.mark.parametrize(
    "make",
    [
        lambda: union(balls(70, 0.3, paint=True), smooth=0.05).paint(glass(1.2, "#ddffee")),
        lambda: (Box(2, 2, 2) - union(balls(70, 0.2))).paint(glass()) | Plane(y=-1.1),
    ],
    ids=["soft", "bubbles"],
)
def test_glass_has_bricks(make):
    shape = make()
    assert bricked(shape.node, exact=False).tables
    given = {"camera": EYE, "lights": SUN, "background": (0.1, 0.2, 0.4)}
    scenes = [Scene(shape, acceleration=a, **given) for a in (True, False)]
    a, b = (s.render(size=SIZE, samples=1).array.astype(float)[..., :3] for s in scenes)
    assert far_off(a, b) < 0.02


@pytest.mark.parametrize(
    "make",
    [
        lambda: (Box(2, 2, 2).paint("red") - union(balls(40))) | Plane(y=-1.1),
        lambda: TREES["cutters with colors"]() | Sphere(0.5).translate(1.6, 0, 1).paint(glass()),
        lambda: (Box(2, 2, 2) - union(balls(40))).paint(mirror()) | Plane(y=-1.1),
    ],
    ids=["matte", "beside glass", "mirror"],
)
def test_paths_have_the_same_light(make):
    given = {"camera": EYE, "lights": [SUN, AmbientLight(0.5)]}
    scenes = [Scene(make(), acceleration=a, **given) for a in (True, False)]
    a, b = (
        s.render(size=(24, 18), samples=64, mode="path").array.astype(float)[..., :3]
        for s in scenes
    )
    # The same random numbers: only paths along edges differ.
    assert far_off(a, b, 0.1) < 0.03
    assert a.mean() == pytest.approx(b.mean(), rel=0.01)


def test_texts_have_the_same_size_for_any_number_of_shapes():
    for make in (
        lambda n: union(balls(n, 0.1), smooth=0.05),
        lambda n: (Box(2, 2, 2) - union(balls(n, 0.1))).paint(glass()),
    ):
        sizes = [len(driver.compile(Scene(make(n), camera=EYE), "wgsl").text) for n in (260, 400)]
        assert abs(sizes[0] - sizes[1]) < 200


def test_probes_find_the_shape_with_the_larger_share():
    shape = union(balls(30, paint=True), smooth=0.06)
    near = Camera((0.8, 0.8, 1.8), target=(0.0, 0.0, 0.0))
    scenes = [Scene(shape, acceleration=on, camera=near, lights=SUN) for on in (True, False)]
    leaves = set()
    for pixel in ((24, 12), (9, 7), (45, 8), (20, 18)):
        a, b = (probe(scene, pixel, size=(48, 36)) for scene in scenes)
        assert [id(node) for node in a.path] == [id(node) for node in b.path]
        assert a.material is b.material
        leaves |= {id(node) for node in a.path[-1:]}
    assert len(leaves) > 1


@pytest.mark.parametrize("view", ["slice", "material", "normal", "depth", "distance"])
def test_views_show_the_same(view):
    shape = union(balls(30, 0.3, paint=True), smooth=0.06) - Box(0.6, 3, 0.6)
    scenes = [Scene(shape, acceleration=on, camera=EYE, lights=SUN) for on in (True, False)]
    a, b = (s.render(size=(48, 36), samples=1, view=view).array / 255.0 for s in scenes)
    assert far_off(a, b) < 0.02
