"""Numbers of shapes that differ from place to place: fields, boxes, slopes, messages.

Oracles: the same formula written with NumPy; the change of the value between points.
"""

from __future__ import annotations

import numpy as np
import pytest

import distal
from distal import (
    Box,
    Camera,
    Circle,
    Cylinder,
    Plane,
    Scene,
    Shape,
    Sphere,
    cell,
    matte,
    place,
    random_by_cell,
    time,
)
from distal.fields.combine import blends
from distal.fields.guarantees import ENDLESS
from distal.lang import clamp, func, length, sin, slider, vec3
from distal.scene.tree.arguments import slots_of

RANDOM = np.random.default_rng(11)
WIDE = 0.5 + 0.05 * np.sin(10.0 * place.y)


@func
def bulged(p: vec3) -> float:
    return length(p) - (0.5 + 0.05 * sin(10.0 * p.y))


def points_around(shape, count=20000, beyond=0.4):
    low, high = (np.clip(corner, -2.0, 2.0) for corner in shape.bounds())
    return RANDOM.uniform(low - beyond, high + beyond, (count, len(low)))


def within(shape, points):
    low, high = shape.bounds()
    return ((points > low) & (points < high)).all(axis=1)


def test_the_value_within_the_box_is_that_of_the_formula():
    made, own = Sphere(WIDE), Shape.from_function(bulged, slope=1.5)
    points = points_around(made)
    inside = within(made, points)
    assert inside.sum() > 3000
    assert np.abs(made(points) - own(points))[inside].max() < 1e-6
    assert np.array_equal(made(points) < 0.0, own(points) < 0.0)
    assert np.abs(made.gradient(points) - own.gradient(points))[inside].max() < 1e-5


def sheared(p):
    q = np.abs(p - np.stack([0.3 * np.sin(3.0 * p[:, 1]), 0.0 * p[:, 0], 0.0 * p[:, 0]], 1))
    beyond = q - np.array([0.5, 1.0, 0.5])
    return np.linalg.norm(np.maximum(beyond, 0.0), axis=1) + np.minimum(beyond.max(axis=1), 0.0)


def test_an_operator_takes_the_number_at_its_own_point():
    made = Box(1.0, 2.0, 1.0).translate(x=0.3 * np.sin(3.0 * place.y))
    points = points_around(made)
    inside = within(made, points)
    assert np.abs(made(points) - sheared(points))[inside].max() < 1e-6
    low, high = made.bounds()
    assert high[0] == pytest.approx(0.8, abs=0.03) and low[1] == pytest.approx(-1.0, abs=0.03)


SHAPES = {
    "sphere": lambda: Sphere(WIDE),
    "fast": lambda: Sphere(0.5 + 0.002 * np.sin(2000.0 * place.y)),
    "box": lambda: Box(0.6 + 0.1 * np.sin(4.0 * place.y)),
    "circle": lambda: Circle(0.5 + 0.1 * np.sin(6.0 * place.x)),
    "lifted": lambda: Circle(0.5 + 0.1 * np.sin(6.0 * place.x)).extrude(0.5),
    "extruded": lambda: Circle(0.5).extrude(1.0 + 0.2 * np.sin(place.x)),
    "rounded": lambda: Box(1.0).round(0.05 + 0.04 * np.sin(5.0 * place.y)),
    "shell": lambda: Sphere(0.4).shell(0.05 + 0.03 * np.sin(8.0 * place.y), where="center"),
    "turned": lambda: Box(1.0, 2.0, 1.0).rotate(y=place.y),
    "twisted": lambda: Box(1.0, 2.0, 1.0).twist(clamp(place.y, -1.0, 1.0)),
    "tapered": lambda: Box(1.0).scale(clamp(1.0 + 0.3 * place.y, 0.5, 2.0)),
    "melted": lambda: Sphere(1.0).union(Box(1.4), smooth=clamp(0.1 + 0.1 * place.x, 0.02, 0.3)),
    "ground": lambda: Plane().offset(0.1 * np.sin(3.0 * place.x)),
    "moving": lambda: Sphere(0.5 + 0.05 * np.sin(10.0 * place.y + time)),
    "copies": lambda: Sphere(0.3 + random_by_cell(0.0, 0.1) * np.sin(9.0 * place.x)).repeat(
        1.0, count=(3, 1, 1)
    ),
    "waves over copies": lambda: (
        Sphere(0.3).repeat(1.0, count=(3, 1, 1)).offset(0.05 * np.sin(3.0 * place.x))
    ),
    "both": lambda: Sphere(0.4 + 0.05 * np.sin(9.0 * place.x)).scale(1.0 + 0.1 * np.sin(place.y)),
}


@pytest.mark.parametrize("name", SHAPES)
def test_slope_and_box_hold(name):
    made = SHAPES[name]()
    points = points_around(made)
    for size in (1e-4, 0.05, 1.0):
        steps = np.random.default_rng(6).normal(size=points.shape) * size
        change = np.abs(made(points + steps) - made(points))
        # Where numbers differ much, 32 bits are worth less than a tenth of a millionth.
        assert (change <= made.slope * np.linalg.norm(steps, axis=1) + 2e-6).all(), size
    outside = ~within(made, points)
    assert outside.sum() > 500
    low, high = made.bounds()
    beyond = np.maximum(np.maximum(low - points, points - high), 0.0)[outside]
    least = max(made.slope, 1.0) * np.linalg.norm(beyond, axis=1)
    if name not in ("copies", "lifted", "both"):  # made of shapes with smaller boxes
        assert (made(points)[outside] >= least * (1.0 - 1e-5) - 1e-6).all()
    assert (made(points)[outside] > 0.0).all()
    inside = made(points) < 0.0
    assert inside.sum() > 100
    room = np.array(
        [max(b - a, 0.0) if b - a < ENDLESS else np.inf for a, b in zip(low, high, strict=True)]
    )
    found = points[inside].max(axis=0) - points[inside].min(axis=0)
    # The box is that of all numbers that there may be anywhere.
    most = 0.55 if name in ("turned", "melted") else 0.35
    assert ((room - found < most) | np.isinf(room)).all(), "the box is much too large"


@pytest.mark.parametrize(
    ("make", "slope"),
    [
        (lambda: Sphere(WIDE), 1.5),
        (lambda: Circle(0.5 + 0.1 * np.sin(6.0 * place.x)), 1.6),
        (lambda: Sphere(0.4).shell(0.05 + 0.03 * np.sin(8.0 * place.y), where="center"), 1.12),
        (lambda: Cylinder(0.4 + 0.02 * np.sin(30.0 * place.y), 2.0), 1.6),
        # Half of a size is a distance; the three components change together.
        (lambda: Box(0.6 + 0.1 * np.sin(4.0 * place.y)), 1.0 + 0.2 * np.sqrt(3.0)),
    ],
)
def test_slopes_are_those_of_the_chain_rule(make, slope):
    assert make().slope == pytest.approx(slope, rel=2e-2)


def test_bounds_hold_for_all_times_and_all_values_of_a_slider():
    depth = slider("Depth", 0.0, low=0.0, high=0.1)
    made = Sphere(0.5 + depth * np.sin(10.0 * place.y + time))
    assert made.slope == pytest.approx(2.0, rel=1e-3)
    assert made.bounds()[1][0] == pytest.approx(0.6, abs=0.02)
    points = points_around(made, 4000)
    for value, at in ((0.1, 0.0), (0.1, 2.5), (0.0, 1.0)):
        found = made(points, params={"depth": value}, time=at)
        radius = 0.5 + value * np.sin(10.0 * points[:, 1] + at)
        true = np.linalg.norm(points, axis=1) - radius
        assert np.abs(found - true)[within(made, points)].max() < 1e-6
    with pytest.raises(distal.CompileError, match="has no known limit where the shape may be"):
        Sphere(0.5 + np.abs(time) * (2.0 + np.sin(place.y)))


def test_a_picture_has_the_waves_and_no_flat_places():
    """The outline of the column is that of the formula, and where it touches its box it is lit."""
    column = Cylinder(0.5 + 0.1 * np.sin(8.0 * place.y), 2.2).paint(matte("#888"))
    camera = distal.OrthographicCamera((0, 0, 5), (0, 0, 0), height=2.4)
    scene = Scene(column, camera=camera, background="#000", floor=False)
    picture = scene.render(size=(120, 120), samples=1).array[..., :3].max(axis=-1)
    heights = 1.2 - 2.4 * (np.arange(120) + 0.5) / 120
    for row in range(14, 106):
        width = (picture[row] > 0.0).sum() * 2.4 / 120
        assert width == pytest.approx(1.0 + 0.2 * np.sin(8.0 * heights[row]), abs=0.05)


def test_where_a_shape_touches_its_box_it_has_its_own_normals():
    """A ray ends a little before the surface; beyond a box without margin, it met a flat disc."""
    column = Cylinder(0.5 + 0.1 * np.sin(8.0 * place.y), 2.2)
    aside = np.linspace(-0.03, 0.03, 50)
    points = np.stack([np.full(50, 0.601), np.full(50, np.pi / 16), aside], axis=1)
    true = np.stack([np.full(50, 0.601), np.zeros(50), aside], axis=1)
    true /= np.linalg.norm(true, axis=1)[:, None]
    assert np.abs(column.gradient(points) - true).max() < 1e-3


@pytest.mark.parametrize("name", blends.BLENDS)
def test_a_blend_changes_no_more_with_its_size_than_is_declared(name):
    count = 100000
    for kind in ("union", "intersection", "difference", "xor"):
        rule = blends.COMBINATIONS[kind, name]
        # What is cut by a box does not change more than the blend.
        cut = kind == "union" and blends.BLENDS[name].cut
        combine = blends.BLENDS[name].union if cut else rule.combine
        numbers = [slot.name for slot in slots_of(combine)][3:]
        for parts in (1, 2, 3, 8) if numbers else (0,):
            k = np.exp(RANDOM.uniform(-5.0, 1.0, count))
            a = RANDOM.uniform(-8.0, 8.0, count) * k
            b = np.where(
                RANDOM.random(count) < 0.5,
                a + RANDOM.uniform(-2.0, 2.0, count) * k,
                RANDOM.uniform(-8.0, 8.0, count) * k,
            )
            more = [np.full(count, parts)] * len(numbers)
            above, below = (np.asarray(combine(a, b, k * f, *more)) for f in (1.01, 0.99))
            change = np.abs(above - below) / (0.02 * k)
            assert change.max() <= 1.001 * rule.changes["smooth"], (kind, parts)
    most = blends.BLENDS[name].change
    assert most == 1.0 or most < 4.0


WRONG = [
    (
        lambda: Sphere(0.5 + 0.1 * place.y),
        "'radius of Sphere' has no known limit where the shape may be",
        "limit it: clamp(…, low, high) of distal.lang, or a wave: sin of distal.lang; a"
        " parameter needs low= and high=",
    ),
    (
        lambda: Sphere(0.5 + 0.1 * cell.x * np.sin(place.y)),
        "'radius of Sphere' has no known limit where the shape may be, in any cell",
        "limit it: clamp(…, low, high) of distal.lang, or a wave: sin of distal.lang; a"
        " parameter needs low= and high=",
    ),
    (
        lambda: Sphere(0.1 + 0.25 * np.sin(9.0 * place.x)),
        "'radius of Sphere' must be above 0; where the shape may be it goes down to -0.150005",
        None,
    ),
    (
        lambda: Box(1.0).repeat(2.0 + 0.1 * np.sin(place.x)),
        "'spacing of repeat' cannot depend on the place: the shape is evaluated at several points",
        "Shape.from_function, with a slope of your own",
    ),
    (
        lambda: Sphere(0.5 + 0.1 * clamp(place.y * 1e20, -1.0, 1.0)),
        "'radius of Sphere' cannot depend on the place here: no bound on its slope is known: it may"
        " be endlessly steep near (0.255, -0.051, -0.051)",
        "limit how fast the number changes, or write Shape.from_function with a slope",
    ),
    (
        lambda: Sphere(0.5 + 0.1 * clamp(np.floor(place.y), 0.0, 1.0)),
        "'radius of Sphere' cannot depend on the place here: no bound on its slope is known: it may"
        " jump: it uses floor",
        "limit how fast the number changes, or write Shape.from_function with a slope",
    ),
]


@pytest.mark.parametrize(("make", "message", "hint"), WRONG)
def test_what_is_wrong_is_said_at_its_line(make, message, hint):
    with pytest.raises(distal.CompileError) as found:
        make()
    (diagnostic,) = found.value.diagnostics
    assert (diagnostic.message, diagnostic.hint) == (message, hint)
    assert diagnostic.span is not None and diagnostic.span.file == __file__


def test_what_depends_on_the_place_says_so():
    assert "place.point" in repr(Sphere(WIDE))
    assert Camera is not None and not Sphere(WIDE).exact
