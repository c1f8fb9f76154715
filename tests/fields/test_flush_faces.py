"""Fillets and chamfers leave faces in one plane where they are, measured on the fields."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Final

import numpy as np
import pytest

from distal import Box, Circle, Cylinder, Rectangle, Scene, Sphere, compile, union
from distal.fields.combine.blends import COMBINATIONS, PRISMS
from distal.lang import toggle
from distal.lang.runtime_access import executor
from tests.fields.drawing import random_sample
from tests.fields.library import primitives
from tests.fields.seeds import SEED, seed_of

WORDS: Final = ("fillet", "chamfer")
COUNT: Final = 60_000
# Numbers of shapes, and so rotations, have 32 bits: of a size of 60.
CLOSE: Final = 2e-5


def slab(low, high):
    """A box from corner to corner."""
    low, high = np.array(low, float), np.array(high, float)
    return Box(*(high - low).tolist()).translate(*(0.5 * (low + high)).tolist())


BASE: Final = ((-30, 0, -15), (30, 14, 15))
LEG: Final = ((-30, 0, -15), (-16, 50, 15))
# Shapes, the size of the profile, and the box around the sharp union.
CASES: Final = {
    "L": ((BASE, LEG), 8.0),
    "L, thin": ((((-30, 0, -15), (30, 3, 15)), ((-30, 0, -15), (-27, 50, 15))), 8.0),
    "T": ((((-30, 0, -10), (30, 8, 10)), ((-4, 0, -10), (4, 40, 10))), 6.0),
    "cross": ((((-30, -4, -10), (30, 4, 10)), ((-4, -30, -10), (4, 30, 10))), 6.0),
    "flush at one side": ((((-30, 0, -30), (30, 6, 30)), ((10, 6, -10), (30, 26, 10))), 5.0),
    "nested": ((BASE, LEG, ((16, 0, -15), (30, 40, 15))), 4.0),
    "step of .01": ((BASE, ((-30, -0.01, -15.01), (-16, 50, 15.01))), 8.0),
    "step of 2": ((BASE, ((-30, -2, -17), (-16, 50, 17))), 8.0),
    "step of 7.9": ((BASE, ((-30, -7.9, -22.9), (-16, 50, 22.9))), 8.0),
}
PLACED: Final = {
    "as they are": lambda shape, turn: shape,
    "turned": lambda shape, turn: shape.rotate(x=turn[0], y=turn[1], z=turn[2]),
    "turned and moved": lambda shape, turn: (
        shape.translate(7, 0, -3).rotate(x=turn[0], y=turn[1], z=turn[2]).scale(0.5)
    ),
}


def around(boxes):
    corners = np.array(boxes, float)
    return slab(corners[:, 0].min(0), corners[:, 1].max(0))


def joined(shapes, word, size):
    """Each shape united with those before, and the edge of each union shaped."""
    first, *rest = shapes
    for shape in rest:
        first = getattr(first | shape, word)(size)
    return first


def inside_of(shape, low, high, rng, count=COUNT):
    p = rng.uniform(low, high, (count, len(low)))
    return p[shape(p) <= 0.0]


def steepest(shape, p, rng):
    way = rng.normal(size=p.shape)
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    return np.abs(shape(p + 5e-5 * way) - shape(p - 5e-5 * way)).max() / 1e-4


@pytest.mark.parametrize("placed", PLACED)
@pytest.mark.parametrize("word", WORDS)
@pytest.mark.parametrize("name", CASES)
def test_a_union_is_as_large_as_its_shapes(name, word, placed):
    boxes, size = CASES[name]
    rng = np.random.default_rng(seed_of(f"{name} {word} {placed}"))
    turn = rng.uniform(-math.pi, math.pi, 3).tolist()

    def place(shape):
        return PLACED[placed](shape, turn)

    scale = 0.5 if placed == "turned and moved" else 1.0
    parts = [place(slab(*box)) for box in boxes]
    shape, hull = joined(parts, word, scale * size), place(around(boxes))
    low, high = map(np.array, hull.bounds())
    margin = scale * size
    inside = inside_of(shape, low - margin, high + margin, rng)
    assert len(inside) > 300
    assert hull(inside).max() < CLOSE, f"DISTAL_FIELD_SEED={SEED}"
    sharp = union(parts)(inside)
    assert (sharp > 0.0).any(), "nothing was added"
    everywhere = rng.uniform(low - margin, high + margin, (COUNT, 3))
    assert (shape(everywhere) <= union(parts)(everywhere) + CLOSE).all(), "the shapes are cut"
    limit = math.sqrt(len(boxes))
    assert shape.slope == pytest.approx(limit)
    assert steepest(shape, everywhere, rng) < limit + 1e-4, f"DISTAL_FIELD_SEED={SEED}"
    if placed == "as they are":
        np.testing.assert_allclose(shape.bounds(), [low, high], rtol=1e-6)


def test_the_bracket_of_the_guide():
    bracket = (slab(*BASE) | slab(*LEG)).fillet(8)
    assert bracket.bounds() == ((-30.0, 0.0, -15.0), (30.0, 50.0, 15.0))
    foot = (Box(40, 6, 30) | Cylinder(8, 30).translate(y=12)).fillet(4)
    assert foot.bounds() == ((-20.0, -3.0, -15.0), (20.0, 27.0, 15.0))
    below = np.array([[0.0, -3.0 - 1e-6, 0.0], [0.0, -3.0 + 1e-6, 0.0]])
    assert (foot(below) <= 0.0).tolist() == [False, True]


@pytest.mark.parametrize("z", [0.0, 14.9, -15.0])
def test_the_radius_is_exact_at_a_right_angle(z):
    angle = np.linspace(0.02, 0.5 * math.pi - 0.02, 9)
    arc = np.stack([-8.0 - 8.0 * np.cos(angle), 22.0 - 8.0 * np.sin(angle), 0.0 * angle + z], 1)
    assert np.abs((slab(*BASE) | slab(*LEG)).fillet(8)(arc)).max() < 1e-9
    share = np.linspace(0.05, 0.95, 9)
    face = np.stack([-16.0 + 8.0 * share, 22.0 - 8.0 * share, 0.0 * share + z], 1)
    assert np.abs((slab(*BASE) | slab(*LEG)).chamfer(8)(face)).max() < 1e-9


def volume(shape, low, high, n=90):
    """The volume, counted on a grid of n points along each axis."""
    low, high = np.array(low, float), np.array(high, float)
    axes = [a + (b - a) * (np.arange(n) + 0.5) / n for a, b in zip(low, high, strict=True)]
    p = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return float((shape(p) <= 0.0).mean() * (high - low).prod())


def test_nothing_fills_in_between_faces_that_are_nearly_flush():
    """With steps of 2 a prototype counted 45,783; uncut it was 48,690, and if points were moved
    inwards, as for prisms, 51,181. A layer of this grid, on a face, is 340.
    """
    base = slab(*BASE)
    found = {}
    for step in (0.0, 0.01, 0.1, 2.0):
        leg = slab((-30, -step, -15 - step), (-16, 50, 15 + step))
        shape = (base | leg).fillet(8)
        corners = ((-36, -6 - step, -21 - step), (36, 56, 21 + step))
        found[step] = volume(shape, *corners) - volume(base | leg, *corners)
        if step == 2.0:
            assert volume(shape, *corners) == pytest.approx(45_783, abs=400)
    # A quarter of a circle along 30: 64 (1 - pi / 4) 30.
    assert found[0.0] == pytest.approx(64.0 * (1.0 - 0.25 * math.pi) * 30.0, rel=0.05)
    assert found[0.01] == pytest.approx(found[0.0], abs=20.0)
    assert found[0.1] == pytest.approx(found[0.0], abs=120.0)


def test_a_thin_floor_under_a_pocket_stays():
    plate = slab((-30, 0, -30), (30, 10, 30)) - slab((-20, 0.5, -20), (20, 20, 20))
    shape = (plate | slab((24, 0, -30), (30, 30, 30))).fillet(4)
    y = np.array([-1e-6, 1e-6, 0.25, 0.5 - 1e-6, 0.5 + 1e-6])
    p = np.stack([0.0 * y, y, 0.0 * y], axis=1)
    assert (shape(p) <= 0.0).tolist() == [False, True, True, True, False]


def test_many_shapes_are_joined_one_after_the_other():
    rng = np.random.default_rng(5)
    boxes = [*CASES["nested"][0], ((16, 0, -15), (60, 10, 15))]
    p = rng.uniform((-40, -10, -25), (70, 60, 25), (4000, 3))
    for place in PLACED.values():
        parts = [place(slab(*box), (0.4, -1.0, 2.0)) for box in boxes]
        at_once = union(parts, smooth=3.0, blend="round")
        assert np.array_equal(at_once(p), joined(parts, "fillet", 3.0)(p))
        assert at_once.bounds() == joined(parts, "fillet", 3.0).bounds()
        assert (
            np.abs(at_once(p) - executor().call(at_once, (p,), {}, device="reference")).max() < 1e-9
        )


def test_flat_shapes_are_as_large_as_their_parts():
    rng = np.random.default_rng(6)
    a, b = Rectangle(60, 14).translate(0, 7), Rectangle(14, 50).translate(-23, 25)
    for place in (lambda s: s, lambda s: s.rotate(0.7).translate(20, 3).scale(0.5)):
        hull = place(Rectangle(60, 50).translate(0, 25))
        for word in WORDS:
            shape = getattr(place(a) | place(b), word)(4.0)
            low, high = map(np.array, hull.bounds())
            inside = inside_of(shape, low - 4.0, high + 4.0, rng, 20_000)
            assert hull(inside).max() < CLOSE
            assert (union(place(a), place(b))(inside) > 0.0).any()
    assert (a | b).fillet(8).bounds() == ((-30.0, 0.0), (30.0, 50.0))
    arc = np.array([[-8.0 - 8.0 * math.sqrt(0.5), 22.0 - 8.0 * math.sqrt(0.5)]])
    assert (a | b).fillet(8)(arc) == pytest.approx(0.0, abs=1e-9)


def test_a_shape_that_is_not_there_cuts_nothing():
    shape = (slab(*BASE).shown(toggle("base", True)) | slab(*LEG)).fillet(8)
    p = np.random.default_rng(1).uniform((-40, -10, -25), (40, 60, 25), (2000, 3))
    assert np.abs(shape(p, params={"base": False}) - slab(*LEG)(p)).max() < 1e-6
    assert np.array_equal(shape(p), (slab(*BASE) | slab(*LEG)).fillet(8)(p))


def test_an_infinite_shape_is_blended_as_ever():
    from distal import Plane  # noqa: PLC0415

    foot = (Plane() | Cylinder(2, 10)).fillet(1)
    angle = np.linspace(0.1, 1.4, 7)
    arc = np.stack([3.0 - np.cos(angle), 1.0 - np.sin(angle), 0.0 * angle], axis=1)
    assert np.abs(foot(arc)).max() < 1e-9


# Intersections

BAR: Final = ((-30, -15, -15), (30, 15, 15))
POST: Final = ((-20, -15, -25), (20, 15, 25))


@pytest.mark.parametrize("word", WORDS)
def test_an_intersection_of_prisms_does_not_shrink(word):
    shape = getattr(slab(*BAR) & slab(*POST), word)(4)
    rng = np.random.default_rng(2)
    hull = slab((-20, -15, -15), (20, 15, 15))
    p = rng.uniform((-26, -19, -19), (26, 19, 19), (COUNT, 3))
    inside = shape(p) <= 0.0
    assert hull(p[inside]).max() < 1e-9
    assert shape.bounds() == ((-20.0, -15.0, -15.0), (20.0, 15.0, 15.0))
    # The ends along y are whole but for the edges along y, which are shaped.
    edge = np.minimum(20.0 - np.abs(p[:, 0]), 15.0 - np.abs(p[:, 2])) < 4.0
    assert inside[(hull(p) < -1e-9) & ~edge].all()
    assert steepest(shape, p, rng) < math.sqrt(2.0) + 1e-4
    assert shape.slope == pytest.approx(math.sqrt(2.0))
    x, z = 16.0 + 4.0 * math.sqrt(0.5), 11.0 + 4.0 * math.sqrt(0.5)
    if word == "chamfer":
        x, z = 18.0, 13.0
    for y in (-14.99, 0.0, 14.99):
        assert shape(np.array([[x, y, z]])) == pytest.approx(0.0, abs=1e-9)
    # An edge between ends that are far apart is shaped as ever.
    low = getattr(slab((-30, -15, -15), (30, 5, 15)) & slab(*POST), word)(4)
    assert low(np.array([[x, 1.0 + (x - 16.0), 0.0]])) == pytest.approx(0.0, abs=1e-9)


def test_an_intersection_of_outlines_does_not_shrink():
    disc, plate = Circle(20).extrude(10), Rectangle(60, 30).extrude(10)
    shape = (disc & plate).fillet(3)
    y = np.array([4.999, 5.001])
    p = np.stack([0.0 * y, 0.0 * y, y], axis=1)
    assert (shape(p) <= 0.0).tolist() == [True, False]
    flat = (Rectangle(60, 30) & Rectangle(40, 30)).fillet(4)
    inside = flat(np.array([[0.0, 14.999], [0.0, 15.001], [19.999, 0.0], [20.001, 0.0]])) <= 0.0
    assert inside.tolist() == [True, False, True, False]


def test_ends_that_come_apart_are_shaped_by_degrees():
    sections = []
    for apart in (0.0, 1.0, 2.0, 3.0, 4.0, 5.0):
        other = slab((-20, -25, -25), (20, 15 + apart, 25))
        shape = (slab(*BAR) & other).fillet(4)
        x = np.linspace(10.0, 20.0, 2001)
        inside = shape(np.stack([x, 0.0 * x + 15.0 - 1e-6, 0.0 * x], axis=1)) <= 0.0
        sections.append(float(x[inside].max()))
    assert sections[0] == pytest.approx(20.0, abs=0.01)
    assert sections[-1] == pytest.approx(16.0, abs=0.01)
    assert all(a >= b - 0.01 for a, b in pairwise(sections))


def test_only_prisms_are_evaluated_elsewhere():
    rule = COMBINATIONS["intersection", "round"]
    assert (Sphere(2) & Box(3)).fillet(0.2).node.rule is rule
    assert (Box(3).rotate(x=0.3) & Box(3)).fillet(0.2).node.rule is rule
    assert ((Box(3) - Box(1)) & Box(3)).fillet(0.2).node.rule is rule
    assert (Box(3) & Box(2) & Box(1)).fillet(0.2).node.rule is rule
    assert (Box(3) & Cylinder(2, 3)).fillet(0.2).node.rule is PRISMS[rule][0]


PRISMATIC: Final = [name for name, row in primitives().items() if row.along]


@pytest.mark.parametrize("name", PRISMATIC)
def test_a_prism_has_the_same_sections_everywhere(name):
    row = primitives()[name]
    for i in range(5):
        rng = np.random.default_rng(seed_of(f"prism {name} {i}"))
        sample = random_sample(row, rng)
        _, low, high, *_ = sample.promise()
        low, high = np.maximum(low, -3.0), np.minimum(high, 3.0)
        p = rng.uniform(low - 0.2, high + 0.2, (3000, len(low)))
        for axis in row.along:
            at = "xyz".index(axis)
            p[:, at] = rng.uniform(low[at], high[at], len(p))
            q = p.copy()
            q[:, at] = rng.uniform(low[at], high[at], len(p))
            d = [np.asarray(sample.evaluate(each)[0]) for each in (p, q)]
            apart = np.abs(d[0]) > 1e-9
            assert ((d[0] > 0.0) == (d[1] > 0.0))[apart & (np.abs(d[1]) > 1e-9)].all(), str(sample)


SCENES: Final = {
    "turned": lambda: (
        slab(*BASE).rotate(x=0.3, y=0.1, z=0.2) | slab(*LEG).rotate(x=0.3, y=0.1, z=0.2)
    ).fillet(4),
    "prisms": lambda: (slab(*BAR) & slab(*POST)).chamfer(4),
    "flat": lambda: (Rectangle(60, 14) | Rectangle(14, 50).rotate(0.1)).fillet(4).extrude(2),
}


@pytest.mark.parametrize("name", SCENES)
def test_every_target_has_the_same_values(name):
    shape = SCENES[name]()
    p = np.random.default_rng(4).uniform(-40, 60, (3000, 3))
    reference = executor().call(shape, (p,), {}, device="reference")
    assert np.abs(shape(p) - reference).max() < 1e-9
    assert np.abs(shape(p.astype(np.float32)) - reference).max() < 1e-4
    for target in ("glsl-es300", "glsl-es100", "wgsl"):
        assert len(compile(Scene(shape), target=target).text) > 1000
