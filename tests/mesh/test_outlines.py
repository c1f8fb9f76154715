"""Outlines of flat shapes: closed forms, corners, topology, messages."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from distal import (
    Circle,
    Cone,
    HalfPlane,
    Hexagram,
    Polygon,
    Rectangle,
    Shape2D,
    Text,
)
from distal.devices.base import Cancelled
from distal.file_writer import SaveError
from distal.lang import floor, fract, func, length, max, mix, sin, slider, vec2
from distal.mesh.kernels import FieldKernels
from distal.mesh.outlines.crossings import crossing_lines
from distal.mesh.outlines.layers import layer_places, layers_at
from distal.mesh.outlines.outline import Outline
from distal.mesh.outlines.outlining import OutlineRequest
from distal.mesh.outlines.tiles import FlatExtent
from distal.mesh.outlines.tracing import TracedOutline, _at_spacing
from distal.scene.tree.errors import SceneValueError


def signed_area(loop: Any) -> float:
    x, y = np.asarray(loop).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def nearest(points: Any, place: Any) -> float:
    return float(np.sqrt(((np.asarray(points) - place) ** 2).sum(axis=1)).min())


def meets(a: Any, b: Any, c: Any, d: Any) -> bool:
    """Whether two lines have a common point, in fractions of whole numbers."""

    def side(p: Any, q: Any, r: Any) -> int:
        turned = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        return (turned > 0) - (turned < 0)

    def within(p: Any, q: Any, r: Any) -> bool:
        return all(min(p[i], q[i]) <= r[i] <= max_of(p[i], q[i]) for i in range(2))

    sides = side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b)
    if sides[0] * sides[1] < 0 and sides[2] * sides[3] < 0:
        return True
    ends = (a, b, c), (a, b, d), (c, d, a), (c, d, b)
    return any(s == 0 and within(*e) for s, e in zip(sides, ends, strict=True))


def max_of(a: Any, b: Any) -> Any:
    return a if a > b else b


def crossings(loops: Any) -> int:
    """How many pairs of lines meet that are no neighbors, in whole numbers without rounding."""
    lines = []
    for number, loop in enumerate(loops):
        # A float is a whole number of 2^-120, unless it is below 2^-68.
        places = [tuple(int(Fraction(x) * 2**120) for x in p) for p in np.asarray(loop).tolist()]
        count = len(places)
        for i in range(count):
            a, b = places[i], places[(i + 1) % count]
            lines.append((sorted((a[0], b[0])), sorted((a[1], b[1])), a, b, number, i, count))
    lines.sort(key=lambda line: line[0])
    found = 0
    for i, (xs, ys, a, b, loop, row, count) in enumerate(lines):
        for other_xs, other_ys, c, d, other, other_row, _ in lines[i + 1 :]:
            if other_xs[0] > xs[1]:
                break
            beside = loop == other and (other_row - row) % count in (1, count - 1)
            apart = other_ys[0] > ys[1] or other_ys[1] < ys[0]
            found += not apart and not beside and meets(a, b, c, d)
    return found


def at_spacing(shape: Any, step: float) -> TracedOutline:
    low, high = (np.array(corner) for corner in shape.bounds())
    extent = FlatExtent(low, high, shape.slope, shape.divisor)
    found = _at_spacing(FieldKernels(shape.node, {}, 0.0), extent, step, lambda share: None)
    assert isinstance(found, TracedOutline)
    return found


@pytest.mark.parametrize("tolerance", [0.01, 1e-4])
def test_a_circle_has_its_area_and_length(tolerance: float) -> None:
    made = Circle(2.0).outline(tolerance)
    (loop,) = made.loops
    radii = np.hypot(*loop.T)
    assert np.abs(radii - 2.0).max() < 2e-8
    # How far the middles of the chords are from the circle, in closed form.
    angles = np.unwrap(np.arctan2(loop[:, 1], loop[:, 0]))
    steps = np.diff(angles, append=angles[0] + math.tau)
    assert (steps > 0.0).all()
    sagitta = 2.0 * (1.0 - np.cos(steps.max() / 2.0))
    assert sagitta <= tolerance
    assert made.report["error"] == pytest.approx(sagitta, rel=0.02)
    assert made.area == pytest.approx(signed_area(loop))
    assert 0.0 < 4.0 * math.pi - made.area < made.length * tolerance
    assert 0.0 < 4.0 * math.pi - made.length < 2.0 * math.pi * tolerance


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.0, math.pi / 4])
def test_a_rectangle_has_four_points(angle: float) -> None:
    made = Rectangle(3.0, 2.0).rotate(angle).outline()
    (loop,) = made.loops
    assert loop.shape == (4, 2)
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    for corner in np.array([(-1.5, -1.0), (1.5, -1.0), (1.5, 1.0), (-1.5, 1.0)]) @ turn:
        assert nearest(loop, corner) < 1e-3 * made.report["spacing"]
        assert nearest(loop, corner) < 3e-7
    assert made.area == pytest.approx(6.0, abs=1e-6) and made.report["corners"] == 4


def test_corners_of_polygons_are_sharp() -> None:
    corners = [(0.0, 0.0), (3.0, 0.2), (2.2, 1.1), (3.1, 2.7), (0.9, 1.6)]
    made = Polygon(corners).outline()
    assert [len(loop) for loop in made.loops] == [5]
    for corner in corners:
        assert nearest(made.loops[0], corner) < 1e-3 * made.report["spacing"]
    assert made.area == pytest.approx(signed_area(corners), abs=1e-6)
    star = Hexagram(1.0).outline()
    assert [len(loop) for loop in star.loops] == [12]
    assert star.length == pytest.approx(4.0 * math.sqrt(3.0), abs=1e-6)


def test_holes_are_clockwise() -> None:
    made = (Circle(1.0) - Circle(0.5)).outline(1e-3)
    outer, hole = sorted(made.loops, key=lambda loop: -abs(signed_area(loop)))
    assert signed_area(outer) == pytest.approx(math.pi, rel=2e-3)
    assert signed_area(hole) == pytest.approx(-math.pi / 4.0, rel=3e-3)
    assert made.area == pytest.approx(0.75 * math.pi, abs=1e-3 * made.length)


def test_letters_have_their_holes_and_never_cross() -> None:
    made = Text("Be8", size=1.0).outline(1e-3)
    areas = [signed_area(loop) for loop in made.loops]
    assert sum(area > 0.0 for area in areas) == 3 and sum(area < 0.0 for area in areas) == 5
    assert made.report["error"] <= 1e-3 and not made.report["warnings"]
    assert crossings(made.loops) == 0


def test_squares_that_touch() -> None:
    square = Rectangle(1.0, 1.0)
    beside = (square.translate(-0.5, 0.0) | square.translate(0.5, 0.0)).outline()
    assert [len(loop) for loop in beside.loops] == [4] and beside.area == pytest.approx(2.0)
    tips = (square.translate(-0.5, -0.5) | square.translate(0.5, 0.5)).outline()
    assert tips.area == pytest.approx(2.0, abs=1e-5) and crossings(tips.loops) == 0


@func
def random_value(cell: vec2, seed: float) -> float:
    """A number between -1 and 1 for a lattice point."""
    return 2.0 * fract(sin(cell.x * 127.1 + cell.y * 311.7 + seed * 53.3) * 43758.5453) - 1.0


@func
def linear_noise(p: vec2, seed: float = 1.0, size: float = 0.03) -> float:
    """Bilinear noise whose cells are about as large as those of the outline, within a disc."""
    q = p / size
    cell = floor(q)
    t = q - cell
    low = mix(random_value(cell, seed), random_value(cell + vec2(1.0, 0.0), seed), t.x)
    above = cell + vec2(0.0, 1.0)
    high = mix(random_value(above, seed), random_value(above + vec2(1.0, 0.0), seed), t.x)
    return max(mix(low, high, t.y), (p.x * p.x + p.y * p.y) / 0.16 - 1.0)


@func
def squares(p: vec2, seed: float = 1.0, size: float = 0.03) -> float:
    """Values without a slope: each small square is inside or outside."""
    disc = (p.x * p.x + p.y * p.y) / 0.16 - 1.0
    return max(random_value(floor(p / size), seed), disc)


@pytest.mark.parametrize("field", [linear_noise, squares])
@pytest.mark.parametrize("seed", range(3))
def test_noise_has_closed_loops_that_never_cross(field: Any, seed: int) -> None:
    box = ((-0.5, -0.5), (0.5, 0.5))
    # The slope is wrong: parts may be lost, but no loop is open.
    shape = Shape2D.from_function(field, seed=float(seed), slope=5.0, bounds=box)
    found = at_spacing(shape, 1.0 / 24.0)
    assert len(found.loops) > 5 and all(len(loop) >= 8 for loop in found.loops)
    assert crossings(found.loops) == 0
    # Outer loops turn one way and holes the other: no place is enclosed twice, or by a hole.
    places = np.random.default_rng(seed).uniform(-0.4, 0.4, (200, 2))
    winding = np.zeros(len(places))
    for loop in found.loops:
        a, b = loop[None] - places[:, None], np.roll(loop, -1, axis=0)[None] - places[:, None]
        cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
        winding += np.arctan2(cross, (a * b).sum(axis=-1)).sum(axis=1) / math.tau
    assert np.abs(winding - np.rint(winding)).max() < 1e-9
    assert set(np.rint(winding).tolist()) == {0.0, 1.0}


def test_crossings_are_found_as_by_comparing_each_with_each() -> None:
    rng = np.random.default_rng(5)
    total = 0
    for size in (6, 40, 1000):
        for _ in range(8):
            loops = [np.unique(rng.integers(-size, size, (9, 2)), axis=0) for _ in range(2)]
            loops = [rng.permutation(loop) for loop in loops]
            found = {tuple(sorted(pair)) for pair in crossing_lines(loops).tolist()}
            starts = np.concatenate(loops)
            ends = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
            many = crossings(loops)
            turned_back = [
                pair
                for pair in found
                if (starts[pair[0]] == ends[pair[1]]).all()
                or (ends[pair[0]] == starts[pair[1]]).all()
            ]
            assert len(found) - many <= len(turned_back)
            assert len(found) >= many
            total += many
    assert total > 150


def test_slices_of_a_cone_are_circles() -> None:
    cone = Cone(1.0, 2.0)
    request = OutlineRequest(tolerance=1e-4)
    places = layer_places(cone, 0.5, "y", request)
    assert places == pytest.approx([-0.75, -0.25, 0.25, 0.75])
    for layer in layers_at(cone, places, "y", request):
        radius = (1.0 - layer.place) / 2.0
        assert layer.outline is not None
        (loop,) = layer.outline.loops
        assert np.hypot(*loop.T) == pytest.approx(radius, abs=1e-6)
        assert layer.outline.area == pytest.approx(
            math.pi * radius**2, abs=1e-4 * math.tau * radius
        )
    (end,) = layers_at(cone, [1.5], "y", request)
    assert end.outline is None and end.warning is None
    one = cone.slice((0.0, 0.25, 0.0), (0.0, 1.0, 0.0)).outline(1e-4)
    assert np.hypot(*one.loops[0].T) == pytest.approx(0.375, abs=1e-6)


def test_parameters_and_the_progress() -> None:
    shares: list[float] = []
    ball = Circle(slider("radius", 1.0, low=0.5, high=3.0))
    made = ball.outline(params={"radius": 2.0}, progress=shares.append)
    assert made.bounds[1] == pytest.approx((2.0, 2.0), abs=1e-3)
    assert shares == sorted(shares) and shares[-1] == 1.0
    with pytest.raises(Cancelled):
        ball.outline(cancel=lambda: True)


def test_the_same_bytes_every_time(tmp_path: Any) -> None:
    shape = Circle(1.0) | Rectangle(3.0, 0.4).rotate(0.3)
    for suffix in (".svg", ".dxf"):
        for name in ("a", "b"):
            shape.outline(1e-3).save(tmp_path / f"{name}{suffix}", unit="cm")
        first, second = ((tmp_path / f"{n}{suffix}").read_bytes() for n in ("a", "b"))
        assert first == second and len(first) > 1000
    shown = shape.outline(1e-3)._repr_svg_()
    assert shown.startswith("<svg ") and "mm" in shown


@func
def no_number(p: vec2) -> float:
    """A disc with values beyond all numbers on one side."""
    return (p.x * p.x + p.y * p.y - 1.0) / max(p.x - 0.5, 0.0)


@func
def wide(p: vec2) -> float:
    """A disc that is larger than its box."""
    return length(p) - 1.2


@pytest.mark.parametrize(
    ("shape", "tolerance", "message"),
    [
        (
            HalfPlane(),
            None,
            "'HalfPlane' has no end along x and y, and an outline is closed",
        ),
        (
            Circle(1.0) - Circle(2.0),
            None,
            "'difference' has no inside: its values are positive everywhere",
        ),
        (
            Circle(1.0) & Circle(1.0).translate(5.0, 0.0),
            None,
            "'intersection' is empty: its box has no area",
        ),
        (
            Rectangle(1.0, 1e-6),
            None,
            "nothing of 'Rectangle' is as thick as 6.1e-05: it is thinner at (-0.5, -5e-07)",
        ),
        (
            Shape2D.from_function(no_number, slope=4.0, bounds=((-2.0, -2.0), (2.0, 2.0))),
            None,
            "is no finite number",
        ),
        (
            Shape2D.from_function(wide, bounds=((-1.0, -1.0), (1.0, 1.0))),
            None,
            "the edge of 'wide' leaves its box: it goes on at",
        ),
        (Circle(1.0), 0.0, "tolerance is a length above 0, not 0.0"),
        (Circle(1.0), 1e-9, "tolerance 1e-09 is too fine for the size of 'Circle'"),
    ],
)
def test_what_has_no_outline_is_refused(shape: Any, tolerance: float | None, message: str) -> None:
    with pytest.raises(SceneValueError) as caught:
        shape.outline(tolerance)
    assert message in str(caught.value)


def test_unknown_suffixes_are_refused(tmp_path: Any) -> None:
    made = Circle(1.0).outline(0.01)
    with pytest.raises(SaveError) as caught:
        made.save(tmp_path / "a.png")
    assert str(caught.value) == "an outline is not saved as '.png': use one of .svg, .dxf"
    with pytest.raises(ValueError, match=r"an array \(n, 2\) of 3 points or more, not \(2, 2\)"):
        Outline([made.loops[0][:2]])


def test_what_is_missing_is_reported() -> None:
    wire = Circle(1.0) | Rectangle(1.0, 1e-5).translate(3.0, 0.0)
    (warning,) = wire.outline(0.01).report["warnings"]
    assert warning.startswith("'union' is thinner than ")
    assert warning.endswith(": parts or gaps of it are missing")
    box = ((-1.1, -1.1), (1.1, 1.1))
    with pytest.raises(SceneValueError, match=r"is inside at \(0, 0\), and its slope, 0\.5, says"):
        Shape2D.from_function(wide_disc, slope=0.5, bounds=box).outline()
    steep = Shape2D.from_function(wide_disc, slope=1.0, bounds=box)
    (warning,) = steep.outline(0.01).report["warnings"]
    assert warning.startswith("'wide_disc' changes 2 times as fast as its slope says, at (")


@func
def wide_disc(p: vec2) -> float:
    """A disc whose gradient at the edge has the length 2."""
    return p.x * p.x + p.y * p.y - 1.0
