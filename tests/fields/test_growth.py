"""Boxes hold what moves out: growth is declared by every row, derived rightly, and tight."""

from __future__ import annotations

import numpy as np
import pytest

from distal.diagnostics import CompileError
from distal.fields.guarantees import Growth, Guarantee, Operator, Primitive
from distal.lang import Func, func, length, slider, vec3
from distal.scene.objects.field import BaseShape
from distal.scene.objects.shape import Shape
from distal.scene.objects.shapes import (
    Box,
    BoxCheap,
    ConeCheap,
    Dodecahedron,
    Ellipsoid,
    OctahedronCheap,
    Plane,
    SmoothDodecahedron,
    SmoothTruncatedOctahedron,
    Sphere,
    Spring,
    Superellipsoid,
)
from distal.scene.tree.node import Node
from tests.fields.drawing import sample_with
from tests.fields.library import operators, primitives
from tests.fields.seeds import SEED, seed_of
from tests.fields.slopes import steepest
from tests.fields.subject import subject_of

MOVED_OUT = {
    "octahedron": OctahedronCheap().round(0.6),
    "cone": ConeCheap(0.2, 1.5).round(0.4),
    "dodecahedron": Dodecahedron().offset(0.5),
    "smooth dodecahedron": SmoothDodecahedron().round(0.5),
    "smooth truncated octahedron": SmoothTruncatedOctahedron(exponent=3.0).round(0.5),
    "spring": Spring(pitch=0.9, major=0.3, minor=0.05).offset(0.15),
    "ellipsoid": Ellipsoid((0.1, 1.0, 0.3)).rotate(x=0.7).round(0.4),
    "superellipsoid": Superellipsoid((0.1, 0.8, 0.3), 1.0, 6.0).round(0.3),
    "cheap box, turned": BoxCheap().rotate(x=0.6, y=0.6).round(0.5),
    "intersection, turned": (Box() & Box().translate(0.8, 0.8, 0.8))
    .rotate(x=0.6, y=0.6)
    .round(0.5),
    "emboss": ConeCheap().emboss(Sphere(2.0), 0.4),
    "blend": OctahedronCheap().union(Sphere(0.2), smooth=0.3),
    "shell": OctahedronCheap().shell(0.8, where="outer"),
    "polar, above": Box(0.2, 0.2, 0.2).translate(0.5, 0, 0).repeat_polar(8).round(0.1),
}


@pytest.mark.parametrize("name", MOVED_OUT)
def test_a_box_holds_what_moved_out(name: str):
    shape = MOVED_OUT[name]
    low, high = (np.array(corner) for corner in shape.bounds())
    assert np.isfinite([*low, *high]).all()
    size = float((high - low).max())
    rng = np.random.default_rng(seed_of(name))
    points = rng.uniform(low - 0.1 * size, high + 0.1 * size, (200000, 3))
    inside = points[shape(points) < 0.0]
    assert len(inside) > 50
    assert (inside >= low - 1e-6).all(), f"DISTAL_FIELD_SEED={SEED}"
    assert (inside <= high + 1e-6).all(), f"DISTAL_FIELD_SEED={SEED}"


@pytest.mark.parametrize("row", [pytest.param(r, id=n) for n, r in operators().items()])
def test_an_operator_says_how_its_box_grows(row: Operator):
    assert row.growth is not Growth.UNKNOWN, "its shapes would lose their box when moved out"
    if isinstance(row.slope, Func) and row.needs is None:
        assert not _may_be_unbounded(row.slope), "says no needs, but its slope may have no bound"


def _may_be_unbounded(rule: Func) -> bool:
    names = set(rule.python_function.__code__.co_names)
    if "UNBOUNDED" in names or "unless_endless" in names:
        return True
    found = (rule.python_function.__globals__.get(name) for name in names)
    return any(_may_be_unbounded(inner) for inner in found if type(inner) is Func)


@pytest.mark.parametrize("row", [pytest.param(r, id=n) for n, r in primitives().items()])
def test_a_shape_says_how_its_box_grows(row: Primitive):
    derived = Guarantee.EXACT_OUTSIDE in row.claims or row.bounds is None
    assert (row.growth is None) is derived


def test_what_says_nothing_has_no_box_when_moved_out():
    silent = Operator("silent")
    node = Node(silent, False, (Sphere().node,))
    shape = BaseShape._of(node)
    assert shape.bounds() == Sphere().bounds()
    assert not np.isfinite(shape.round(0.1).bounds()).any()
    assert shape.round(0.0).bounds() == Sphere().bounds()
    assert not np.isfinite(shape.union(Sphere(), smooth=0.1).bounds()).any()


@func
def far_below(p: vec3) -> float:
    return 0.25 * (length(p) - 1.0)


def test_an_author_says_how_the_box_of_a_function_grows():
    box = ((-1, -1, -1), (1, 1, 1))
    unknown = Shape.from_function(far_below, bounds=box)
    assert not np.isfinite(unknown.round(0.1).bounds()).any()
    known = Shape.from_function(far_below, bounds=box, growth=4.0)
    np.testing.assert_allclose(known.round(0.1).bounds(), [[-1.4] * 3, [1.4] * 3], rtol=1e-6)
    exact = Shape.from_function(far_below, bounds=box, exact=True)
    np.testing.assert_allclose(exact.round(0.1).bounds(), [[-1.1] * 3, [1.1] * 3], rtol=1e-6)
    with pytest.raises(ValueError, match="growth must be 1 or more"):
        Shape.from_function(far_below, bounds=box, growth=0.5)


def test_boxes_of_exact_shapes_stay_tight():
    a, b = Box(2, 2, 2), Sphere(1.2)
    for shape in (a | b, a & b, a - b, a.translate(0, 0, 0) & b.rotate(y=0.3), BoxCheap(2, 2, 2)):
        low, high = (np.array(corner) for corner in shape.bounds())
        grown = np.array(shape.round(0.25).bounds())
        np.testing.assert_allclose(grown, [low - 0.25, high + 0.25], atol=1e-6)
    turned = a.rotate(x=0.5, z=0.2)
    low, high = (np.array(corner) for corner in turned.bounds())
    expected = [low - 0.25, high + 0.25]
    np.testing.assert_allclose(turned.round(0.25).bounds(), expected, atol=1e-6)


@pytest.mark.parametrize(
    ("across", "upward"), [(1.0, 2.0), (1.5, 2.0), (2.0, 1.0), (2.0, 1.4), (1.2, 5.0)]
)
def test_a_superellipsoid_is_as_steep_as_a_distance_and_no_steeper(across: float, upward: float):
    """The norm grows by 2^(1/e - 1/2) where an exponent e is below 2, which is reached."""
    row = primitives()["Superellipsoid"]
    given = {"radii": (0.5, 0.5, 0.5), "across": across, "upward": upward}
    subject = subject_of(sample_with(row, given))
    rng = np.random.default_rng(seed_of(f"superellipsoid {across} {upward}"))
    found = steepest(subject, np.zeros((0, 3)), rng, pairs=400).slope
    assert found <= 1.0 + 1e-6, f"DISTAL_FIELD_SEED={SEED}"
    assert found >= 0.999, f"DISTAL_FIELD_SEED={SEED}"


FITS = "its box goes from (-1, -1, -1) to (1, 1, 1)"
NO_SLOPE = {
    "polar": (
        lambda: Sphere().repeat_polar(2),
        "repeat polar",
        "a shape beside the y axis whose box fits in its sector",
    ),
    "twist": (lambda: Plane().twist(1), "twist", "a shape that ends around the y axis"),
    "repeat": (
        lambda: Sphere().repeat(1.0),
        "repeat",
        FITS,
    ),
    "by default": (
        lambda: Sphere(slider("Size", 1.0, low=0.01)).repeat(1.0),
        "repeat",
        FITS,
    ),
}


@pytest.mark.parametrize("name", NO_SLOPE)
def test_what_has_no_slope_is_refused_when_it_is_made(name: str):
    make, operator, needs = NO_SLOPE[name]
    with pytest.raises(CompileError, match=f"{operator} gives this shape no bound") as raised:
        make()
    assert f"{operator} needs" in str(raised.value)
    assert needs in str(raised.value)
    assert "test_growth.py" in str(raised.value)


def test_a_parameter_that_takes_the_slope_is_refused_when_it_is_drawn():
    from distal import Scene  # noqa: PLC0415

    scene = Scene(Sphere(slider("Size", 0.3, low=0.01)).repeat(1.0))
    with pytest.raises(CompileError, match="repeat gives this shape no bound"):
        scene.render(size=(4, 4), params={"Size": 0.9})


def test_shapes_are_refused_cheaply():
    """One function for each kind of operator, however many shapes are made."""
    from distal.scene.lowering import known_bounds as known_promises  # noqa: PLC0415

    [Sphere(0.1).translate(0.01 * i, 0, 0).twist(0.1 * i) for i in range(3)]
    before = len(known_promises._bounds_steps)
    [Sphere(0.1).translate(0.01 * i, 0, 0).twist(0.1 * i) for i in range(30)]
    assert len(known_promises._bounds_steps) == before
