"""Meshes of shapes with known surfaces: how exact they are, what they report and refuse."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest

from distal import Box, Circle, Cone, Cylinder, Octahedron, Plane, Shape, Sphere
from distal.devices import threads
from distal.devices.base import Cancelled
from distal.diagnostics import CompileError
from distal.lang import func, length, sqrt, vec3
from distal.mesh import spacing, tree_topology
from distal.mesh.solid import Mesh
from tests.mesh.noise_fields import at_spacing


def volume_of(points: Any, triangles: Any) -> float:
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


# Where points are


def test_a_box_is_exact() -> None:
    found = at_spacing(Box(1.0, 0.7, 0.4), 0.11)
    assert volume_of(found.made.points, found.made.triangles) == pytest.approx(0.28, rel=1e-9)
    assert found.accuracy.largest < 1e-9 and found.accuracy.from_surface < 1e-9
    corners = (np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)]) - 0.5) * (1.0, 0.7, 0.4)
    assert nearest(found.made.points, corners).max() < 1e-9


def nearest(points: Any, places: Any) -> Any:
    """The distance of each place to the nearest point."""
    return np.linalg.norm(points[None] - places[:, None], axis=2).min(axis=1)


def turned(places: Any, **angles: float) -> Any:
    for axis, angle in angles.items():
        u, v = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
        moved = places.copy()
        moved[:, u] = np.cos(angle) * places[:, u] - np.sin(angle) * places[:, v]
        moved[:, v] = np.sin(angle) * places[:, u] + np.cos(angle) * places[:, v]
        places = moved
    return places


@pytest.mark.parametrize("step", [0.11, 0.05])
def test_edges_of_a_turned_box_are_sharp(step: float) -> None:
    shape = Box(1.0, 0.7, 0.4).rotate(x=0.3, y=0.5, z=0.7)
    found = at_spacing(shape, step, tolerance=0.001 * step)
    distances = np.abs(shape(found.made.points))
    # Corners between lattice points are cut, and counted; nearly all other points are exact.
    assert found.accuracy.cut == int((distances > 1e-3 * step).sum()) < 0.04 * len(distances)
    assert np.quantile(distances, 0.9) < 1e-9
    bits = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)]) - 0.5
    corners = turned(bits * (1.0, 0.7, 0.4), x=0.3, y=0.5, z=0.7)
    off = nearest(found.made.points, corners)
    assert (off < 1e-3 * step).sum() >= 4
    # A corner of three square faces is at most sqrt(3) times as far as its faces.
    assert off.max() < np.sqrt(3.0) * found.accuracy.largest


@func
def prism(p: vec3) -> float:
    """A prism with three sides of 120 degrees between them, along z, one unit long."""
    a = p.x
    b = -0.5 * p.x + 0.8660254037844386 * p.y
    c = -0.5 * p.x - 0.8660254037844386 * p.y
    side = a if a > b else b
    side = c if c > side else side
    end = p.z - 0.5 if p.z > 0.0 else -p.z - 0.5
    return (side - 0.4) if side - 0.4 > end else end


@func
def cone(p: vec3) -> float:
    """A cone with its tip at (0, 0, 0.6) and its foot at z = -0.4."""
    side = (sqrt(p.x * p.x + p.y * p.y) + 0.5 * (p.z - 0.6)) / 1.118033988749895
    return side if side > -0.4 - p.z else -0.4 - p.z


@pytest.mark.parametrize(
    ("function", "tip", "sharpness"),
    [(prism, (-0.8, 0.0, 0.5), 2.0), (cone, (0.0, 0.0, 0.6), 2.24)],
    ids=["prism", "cone"],
)
def test_tips_are_as_near_as_the_error_says(
    function: Any, tip: tuple[float, ...], sharpness: float
) -> None:
    # A tip is farther from what is cut off than its sides, by 1 / sin of half its angle.
    box = ((-1.0, -1.0, -0.5), (1.0, 1.0, 0.65))
    shape = Shape.from_function(function, bounds=box).rotate(x=0.2, z=0.1)
    place = turned(np.array([tip]), x=0.2, z=0.1)
    for step in (0.09, 0.061):
        found = at_spacing(shape, step, tolerance=0.01 * step)
        off = float(nearest(found.made.points, place)[0])
        assert off < max(sharpness * found.accuracy.largest, 1e-3 * step)
        assert found.accuracy.cut < 0.05 * len(found.made.points)


def test_points_of_a_smooth_surface_are_on_it() -> None:
    found = at_spacing(Sphere(1.0), 0.1)
    assert np.abs(np.linalg.norm(found.made.points, axis=1) - 1.0).max() < 1e-9
    assert np.abs(found.normals - found.made.points).max() < 1e-5
    assert found.creases == 0


def test_the_volume_of_a_sphere_converges_quadratically() -> None:
    errors = []
    for step in (0.2, 0.1, 0.05):
        made = at_spacing(Sphere(1.0), step).made
        errors.append(4.0 / 3.0 * np.pi - volume_of(made.points, made.triangles))
    assert 3.5 < errors[0] / errors[1] < 4.5 and 3.5 < errors[1] / errors[2] < 4.5
    assert 0.0 < errors[2] < 0.01


def test_a_wall_thicker_than_the_claim_is_found_whole() -> None:
    # A ball wider than sqrt(3) cells holds a lattice point: a slab of 1.8 cells has no hole.
    step = 0.1
    slab = Box(2.0, 2.0, 1.8 * step).rotate(x=0.6, y=0.4)
    found = at_spacing(slab, step)
    assert not len(found.lost)
    # Its edges may be cut by half a cell, which is a hundredth of the volume; a hole is more.
    expected = 2.0 * 2.0 * 1.8 * step
    assert volume_of(found.made.points, found.made.triangles) == pytest.approx(expected, rel=1e-2)


def test_the_error_is_the_true_distance_both_ways() -> None:
    found = at_spacing(Sphere(1.0), 0.15)
    corners = found.made.points[found.made.triangles]
    rng = np.random.default_rng(2)
    weights = rng.dirichlet((1.0, 1.0, 1.0), (len(corners), 40))
    samples = np.einsum("tsk,tkd->tsd", weights, corners)
    deepest = (1.0 - np.linalg.norm(samples, axis=2)).max()
    assert 0.9 * deepest < found.accuracy.largest < 1.05 * deepest
    assert found.accuracy.from_surface < 1.05 * deepest


# Requests


def test_the_tolerance_is_kept() -> None:
    shape = Sphere(1.0) & Box(1.5) - Cylinder(0.4, 3.0)
    for tolerance in (0.01, 0.003):
        report = shape.mesh(tolerance=tolerance).report
        assert 0.1 * tolerance < report["error"]["largest"] <= tolerance
        assert not report["warnings"]


def test_a_feature_size_sets_the_spacing() -> None:
    report = Sphere(1.0).mesh(tolerance=0.1, feature=0.09).report
    assert report["feature"] == pytest.approx(0.09)
    assert report["spacing"] == pytest.approx(0.09 / np.sqrt(3.0))


def test_thin_parts_make_it_finer() -> None:
    # The plate is thinner than the first cells, which are 2 / 24 long.
    made = (Box(2.0, 2.0, 0.03) | Sphere(0.5)).mesh(tolerance=0.05)
    assert not made.report["lost"]
    assert made.report["spacing"] < 2.0 / 24.0
    low, high = made.bounds
    assert high[0] - low[0] == pytest.approx(2.0)


def test_lost_parts_are_named() -> None:
    thin = Sphere(1.0) | Box(3.0, 0.0001, 0.0001).named("wire")
    made = thin.mesh(tolerance=0.05, feature=0.2)
    (warning,) = made.report["warnings"]
    assert warning.startswith("'wire (Box)' (line ") and "is thinner than 0.2 at (" in warning
    assert warning.endswith("parts of it are missing")
    assert made.report["lost"][0]["count"] >= 5


def test_cut_corners_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tree_topology, "MOST_LEVELS", 0)  # otherwise no corner is cut
    made = Octahedron(0.7).rotate(x=0.3, y=0.5, z=0.7).named("block").mesh(tolerance=0.01)
    report = made.report
    (warning,) = report["warnings"]
    assert warning.startswith("a corner of 'block (Octahedron)' (line ")
    assert "is cut by up to 0.0" in warning
    assert report["error"]["largest"] <= 0.01 < report["error"]["cut_corner"] < report["spacing"]


@func
def steep_ball(p: vec3) -> float:
    """A ball whose values are three times the distance."""
    return 3.0 * (length(p) - 1.0)


def test_a_false_slope_is_reported() -> None:
    shape = Shape.from_function(steep_ball, bounds=((-1, -1, -1), (1, 1, 1)))
    (warning,) = shape.mesh(tolerance=0.05).report["warnings"]
    assert "changes 3 times as fast as its slope says" in warning


def test_the_same_bytes_with_one_and_two_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    shape = (Sphere(1.0) & Box(1.5)) - Cylinder(0.4, 3.0)
    made = []
    for count in (1, 2, 2):
        monkeypatch.setattr(threads, "usable_threads", lambda count=count: count)
        made.append(shape.mesh(tolerance=0.02))
    for other in made[1:]:
        assert made[0].points.tobytes() == other.points.tobytes()
        assert made[0].triangles.tobytes() == other.triangles.tobytes()


def test_progress_rises_to_one() -> None:
    shares: list[float] = []
    Sphere(1.0).mesh(tolerance=0.01, progress=shares.append)
    assert shares == sorted(shares) and shares[-1] == 1.0 and len(shares) > 5


def test_cancelled_work_ends() -> None:
    event = threading.Event()
    event.set()
    with pytest.raises(Cancelled):
        Sphere(1.0).mesh(cancel=event)


# Colors


def test_colors_are_those_of_the_materials() -> None:
    shape = Box(1.0).paint("#ff0000") | Sphere(0.4).translate(0.5, 0.5, 0.5).paint("#0000ff")
    made = shape.mesh(tolerance=0.01)
    assert made.colors is not None and made.triangle_colors is not None
    assert set(map(tuple, made.triangle_colors.tolist())) == {(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)}
    middles = made.points[made.triangles].mean(axis=1)
    blue = made.triangle_colors[:, 2] == 1.0
    distance = np.linalg.norm(middles - 0.5, axis=1)
    assert distance[blue].max() < 0.41 and distance[~blue].min() > 0.39


def test_one_material_needs_no_color_for_each_triangle() -> None:
    made = Sphere(1.0).paint("#ff0000").mesh(tolerance=0.05)
    assert made.triangle_colors is None
    assert made.colors is not None and (made.colors == (1.0, 0.0, 0.0)).all()
    assert Sphere(1.0).mesh(tolerance=0.05).colors is None


# Mistakes


@func
def broken(p: vec3) -> float:
    """No number in half of the ball."""
    return sqrt(p.x) + length(p) - 1.0 if p.x > 0.0 else 0.0 / (p.x - p.x)


@func
def wide_ball(p: vec3) -> float:
    """A ball that is larger than its box says."""
    return length(p) - 1.2


BALL = ((-1, -1, -1), (1, 1, 1))
MISTAKES = {
    "endless": (
        lambda: Plane().mesh(),
        "'Plane' has no end along x and y and z, and a mesh is of a part of space with an end",
        "intersect it with a box: shape & Box(…); an own function takes bounds=(low, high)",
    ),
    "endless member": (
        lambda: (Sphere(1.0) | Plane()).mesh(),
        "'union' has no end along x and y and z, and a mesh is of a part of space with an end",
        "leave out 'Plane'; distal mesh FILE:NAME meshes one shape of a file",
    ),
    "empty": (
        lambda: (Sphere(1.0) - Sphere(2.0)).mesh(),
        "'difference' has no inside: its values are positive everywhere",
        None,
    ),
    "thin": (
        lambda: Box(2.0, 2.0, 0.001).mesh(feature=0.1),
        "nothing of 'Box' is as thick as 0.1: 'Box' (line ",
        "a smaller feature=, such as 0.025",
    ),
    "no number": (
        lambda: Shape.from_function(broken, bounds=BALL).mesh(),
        "is no finite number",
        "avoid divisions by 0, and roots and logarithms of negative numbers",
    ),
    "beyond its box": (
        lambda: Shape.from_function(wide_ball, bounds=BALL).mesh(),
        "the surface of 'wide_ball' leaves its box: it goes on at (",
        "give larger bounds than (-1, -1, -1) to (1, 1, 1)",
    ),
    "tolerance": (
        lambda: Sphere(1.0).mesh(tolerance=0),
        "tolerance is a length above 0, not 0",
        "tolerance=0.01",
    ),
    "feature": (
        lambda: Sphere(1.0).mesh(feature=float("nan")),
        "feature is a length above 0, not nan",
        "feature=0.01",
    ),
    "density": (
        lambda: Sphere(1.0).measure(density=-1.0),
        "a density is a number above 0, not -1.0",
        "density=1.24e-3",
    ),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_say_what_to_write(name: str) -> None:
    make, message, hint = MISTAKES[name]
    with pytest.raises(CompileError) as caught:
        make()
    (found,) = caught.value.diagnostics
    assert message in found.message
    assert found.hint == hint
    assert found.span is not None


def test_a_tolerance_that_needs_too_much_names_one_that_fits(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(spacing, "MOST_BRICKS", 1500)
    with pytest.raises(CompileError, match="with this tolerance, 1e-06, needs about") as caught:
        Sphere(1.0).mesh(tolerance=1e-6)
    (found,) = caught.value.diagnostics
    assert found.hint is not None
    made = Sphere(1.0).mesh(tolerance=float(found.hint.removeprefix("tolerance=")))
    assert made.report["bricks"] <= 1500


def test_flat_shapes_have_no_mesh() -> None:
    with pytest.raises(AttributeError, match="mesh"):
        Circle(1.0).mesh()


def test_a_mesh_checks_its_arrays() -> None:
    with pytest.raises(ValueError, match=r"points of a mesh: an array \(n, 3\), not \(2, 2\)"):
        Mesh(np.zeros((2, 2)), np.zeros((0, 3), np.int64))
    with pytest.raises(ValueError, match="a triangle names a point outside 0 to 1"):
        Mesh(np.zeros((2, 3)), np.array([[0, 1, 2]]))
    with pytest.raises(ValueError, match=r"colors of a mesh: an array \(2, 3\), not \(1, 3\)"):
        Mesh(np.zeros((2, 3)), np.zeros((0, 3), np.int64), colors=np.zeros((1, 3)))


# Measures


def test_measures_of_a_box() -> None:
    found = Box(1.0, 2.0, 3.0).translate(1.0, 0.0, 0.0).measure(density=2.0)
    assert found.volume.value == pytest.approx(6.0, rel=1e-9)
    assert found.area.value == pytest.approx(22.0, rel=1e-9)
    assert found.mass.value == pytest.approx(12.0, rel=1e-9)
    assert np.allclose(found.center.value, (1.0, 0.0, 0.0), atol=1e-9)
    assert np.allclose(found.inertia.value, np.diag([13.0, 10.0, 5.0]), atol=1e-8)
    assert np.allclose((found.low.value, found.high.value), [(0.5, -1, -1.5), (1.5, 1, 1.5)])


@pytest.mark.parametrize("radius", [0.5, 2.0])
def test_true_measures_of_a_sphere_are_within_their_errors(radius: float) -> None:
    found = Sphere(radius).measure()
    volume, area = 4.0 / 3.0 * np.pi * radius**3, 4.0 * np.pi * radius**2
    for measured, true in (
        (found.volume, volume),
        (found.area, area),
        (found.inertia, 0.4 * volume * radius**2 * np.eye(3)),
        (found.high, radius),
        (found.center, 0.0),
    ):
        off = np.abs(np.asarray(measured.value) - true).max()
        assert off <= measured.error
    assert found.volume.error < 0.02 * volume


def test_a_cone_has_its_volume() -> None:
    found = Cone(0.5, 1.0).measure()
    assert found.volume.value == pytest.approx(np.pi / 12.0, abs=found.volume.error)


def test_fields_without_a_gradient_on_their_surface_have_smooth_sides() -> None:
    # The library's cone is a square root: on its surface the gradient is 0 divided by 0.
    step = 0.04
    found = at_spacing(Cone(0.5, 1.0), step, tolerance=0.01 * step)
    made = found.made
    points = made.points[: len(made.points) - made.face_points - made.fans]
    radius = np.linalg.norm(points[:, [0, 2]], axis=1)
    side = (points[:, 1] > -0.5 + step) & (points[:, 1] < 0.5 - 2.0 * step)
    off = np.abs(radius - 0.5 * (0.5 - points[:, 1]))[side]
    # Beside the tip and the rim a few points are at creases; with gradients on the surface the
    # largest was 1.4 cells.
    assert side.sum() > 1000
    assert np.median(off) < 1e-9 and off.max() < 0.01 * step
