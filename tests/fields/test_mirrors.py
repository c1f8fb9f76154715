"""Mirrors: a reflection is the shape at the reflected place, and a fold shows it in all mirrors.

Of folds two facts say all: the part that is shown is the shape's own, and the whole does not change
with the group, since every place is taken into the part by some of the mirrors.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from distal import (
    Box,
    Camera,
    Cylinder,
    DistantLight,
    Ellipsoid,
    Helix,
    InfiniteCylinder,
    Rectangle,
    Scene,
    Shape,
    Sphere,
    Thread,
    checker,
    deg,
    metal,
    pattern,
)
from distal.lang import func, sin, slider, vec3
from distal.scene.tree.errors import SceneValueError
from tests.fields.trees import Tree

NORMAL, OFFSET = np.array([0.6, -0.48, 0.64]), 0.2
SECTOR = 2.0 * np.pi / 5.0
# No mirror image of it is itself.
SHAPE = Box((1.0, 0.6, 0.4)).translate(0.3, 0.1, 0.2) - Sphere(0.3).translate(0.7, 0.3, 0.3)
PLACES = np.random.default_rng(5).uniform(-2.0, 2.0, (500, 3))


def mirror(normal: Any) -> np.ndarray:
    """The matrix of a mirror through the origin."""
    n = np.asarray(normal, np.float64) / np.linalg.norm(normal)
    return np.eye(len(n)) - 2.0 * np.outer(n, n)


def reflected(points: np.ndarray, normal: Any, offset: float) -> np.ndarray:
    n = np.asarray(normal)
    return points - 2.0 * (points @ n - offset)[:, None] * n


def angle(p: np.ndarray) -> np.ndarray:
    """About y, from x toward -z."""
    return np.arctan2(-p[:, 2], p[:, 0])


HALF_SECTOR = (np.sin(0.5 * SECTOR), 0.0, np.cos(0.5 * SECTOR))
CASES: dict[str, tuple[tuple[Any, ...], list[np.ndarray], Callable[[np.ndarray], Any]]] = {
    "symmetry across": ((tuple(NORMAL), OFFSET), [mirror(NORMAL)], lambda p: p @ NORMAL > OFFSET),
    "symmetry": (
        (True, False, True),
        [mirror((1, 0, 0)), mirror((0, 0, 1))],
        lambda p: (p[:, 0] > 0.0) & (p[:, 2] > 0.0),
    ),
    "symmetry diagonal": ((), [mirror((1, 0, -1))], lambda p: p[:, 0] > p[:, 2]),
    "symmetry octant": (
        (),
        [mirror((1, 0, 0)), mirror((0, 0, 1)), mirror((1, 0, -1))],
        lambda p: (p[:, 0] > p[:, 2]) & (p[:, 2] > 0.0),
    ),
    "kaleidoscope": (
        (5,),
        [mirror((0, 0, 1)), mirror(HALF_SECTOR)],
        lambda p: (angle(p) > 0.0) & (angle(p) < 0.5 * SECTOR),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_a_part_is_shown_in_all_mirrors(name: str) -> None:
    args, mirrors, shown = CASES[name]
    child = Box((0.9, 1.1, 0.5)).rotate(x=0.4).translate(0.5, -0.2, -0.3)
    points = np.random.default_rng(2).uniform(-1.5, 1.5, (1500, 3))

    def value(shape: Any, at: np.ndarray) -> np.ndarray:
        return Tree(shape.node).evaluate(at, "reference")[0]

    whole = child.apply(name, *args)
    part = points[shown(points)]
    assert len(part) > 50
    np.testing.assert_allclose(value(whole, part), value(child, part), atol=1e-6)
    here = value(whole, points)
    fixed = OFFSET * NORMAL if name == "symmetry across" else np.zeros(3)  # on all planes
    for matrix in mirrors:
        there = (points - fixed) @ matrix.T + fixed
        np.testing.assert_allclose(value(whole, there), here, atol=1e-6)


IMAGES: dict[str, tuple[Callable[[Any], Any], tuple[float, ...], float]] = {
    "x": (lambda s: s.mirror("x"), (1.0, 0.0, 0.0), 0.0),
    "y, beside the origin": (lambda s: s.mirror("y", 0.7), (0.0, 1.0, 0.0), 0.7),
    "an axis as a normal": (lambda s: s.mirror(across=(0, 0, 1)), (0.0, 0.0, 1.0), 0.0),
    "oblique": (lambda s: s.mirror(across=tuple(NORMAL), offset=OFFSET), tuple(NORMAL), OFFSET),
    "a factor": (lambda s: s.scale(-1, 1, 1), (1.0, 0.0, 0.0), 0.0),
    "a factor in a vector": (lambda s: s.scale((1, 1, -1)), (0.0, 0.0, 1.0), 0.0),
    "a factor by name": (lambda s: s.scale(y=-1), (0.0, 1.0, 0.0), 0.0),
    "a factor of NumPy": (lambda s: s.scale(np.array([1.0, -1.0, 1.0])), (0.0, 1.0, 0.0), 0.0),
    "a matrix": (lambda s: s.transform(np.diag((-1.0, 1.0, 1.0, 1.0))), (1.0, 0.0, 0.0), 0.0),
}


@pytest.mark.parametrize("name", IMAGES)
def test_a_mirror_image_is_the_shape_at_the_reflected_place(name: str) -> None:
    image, normal, offset = IMAGES[name]
    shape, back = image(SHAPE), reflected(PLACES, normal, offset)
    np.testing.assert_allclose(shape(PLACES), SHAPE(back), atol=1e-6)
    assert np.abs(shape(PLACES) - SHAPE(PLACES)).max() > 0.1
    # Its guarantees are those of the shape, and its gradient is reflected.
    assert shape.slope == SHAPE.slope and shape.claims == SHAPE.claims
    assert image(Box((1.0, 0.6, 0.4))).exact
    slopes = np.asarray(shape.gradient(PLACES))
    np.testing.assert_allclose(slopes, SHAPE.gradient(back) @ mirror(normal).T, atol=1e-5)


def test_an_oblique_plane_is_one_that_is_written_with_few_digits() -> None:
    """The image is rigid, and twice is nothing, for a normal of length 1 but for rounding."""
    written = (0.267261, 0.534522, 0.801784)
    assert abs(np.linalg.norm(written) - 1.0) > 1e-7
    once = SHAPE.mirror(across=written, offset=0.3)
    twice = once.mirror(across=written, offset=0.3)
    np.testing.assert_allclose(twice(PLACES), SHAPE(PLACES), atol=1e-9)
    exact = np.array((1.0, 2.0, 3.0)) / math.sqrt(14.0)
    there = reflected(PLACES, exact, 0.3)
    np.testing.assert_allclose(once(PLACES), SHAPE(there), atol=3e-6)


@pytest.mark.parametrize(
    "way",
    [{"axes": "z"}, {"axes": "x", "offset": -0.4}, {"across": tuple(NORMAL), "offset": 0.3}],
)
def test_twice_is_nothing(way: Any) -> None:
    twice = SHAPE.mirror(**way).mirror(**way)
    np.testing.assert_allclose(twice(PLACES), SHAPE(PLACES), atol=1e-12)
    np.testing.assert_allclose(twice.bounds(), SHAPE.bounds(), atol=1e-5)


def test_several_axes_are_one_after_the_other() -> None:
    both = SHAPE.mirror("xz")
    np.testing.assert_allclose(both(PLACES), SHAPE.mirror("x").mirror("z")(PLACES), atol=1e-12)
    np.testing.assert_allclose(both(PLACES), SHAPE.rotate(y=180 * deg)(PLACES), atol=1e-6)
    np.testing.assert_allclose(SHAPE.scale(-2)(PLACES), 2.0 * SHAPE(PLACES / -2.0), atol=1e-6)
    assert SHAPE.scale(-2).claims == SHAPE.scale(2).claims


def test_a_matrix_is_its_mirror() -> None:
    for seed in range(6):
        normal = np.random.default_rng(seed).normal(size=3)
        normal /= np.linalg.norm(normal)
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = mirror(normal), 2.0 * 0.35 * normal
        image = SHAPE.mirror(across=tuple(normal), offset=0.35)
        np.testing.assert_allclose(SHAPE.transform(matrix)(PLACES), image(PLACES), atol=1e-6)


# A turn is a rotation by so much and a rise: what is right-handed goes up counterclockwise.
HANDED = {
    "thread": (Thread(1.0, 0.5, 4.0), 0.5),
    "helix": (Helix(1.0, 0.2, 0.6), 0.6),
    "twist": (Box(1.0, 8.0, 0.4).twist(1.0), 2.0 * math.pi),
}


@pytest.mark.parametrize("way", [{"axes": "x"}, {"axes": "y"}, {"across": (0.6, 0.0, 0.8)}])
@pytest.mark.parametrize("name", HANDED)
def test_what_winds_to_the_right_winds_to_the_left(name: str, way: Any) -> None:
    """It is itself after a turn with a rise; its image is, after a turn with a fall."""
    shape, pitch = HANDED[name]
    image, turn = shape.mirror(**way), 0.7
    p = np.random.default_rng(4).uniform(-0.8, 0.8, (400, 3)) * (1.5, 0.5, 1.5)

    def off(made: Any, rise: float) -> float:
        moved = made.rotate(y=turn).translate(y=rise)
        return float(np.abs(moved(p) - made(p)).max())

    rise = pitch * turn / math.tau
    hand = -1.0 if off(shape, -rise) < off(shape, rise) else 1.0
    assert off(shape, hand * rise) < 1e-4 < 0.02 < off(shape, -hand * rise)
    assert off(image, -hand * rise) < 1e-4 < 0.02 < off(image, hand * rise)
    assert off(image.mirror(**way), hand * rise) < 1e-4


FLAT = Rectangle(1.0, 0.5).rotate(0.4).translate(0.6, 0.2)


@pytest.mark.parametrize(
    ("image", "normal", "offset"),
    [
        (lambda s: s.mirror("x"), (1.0, 0.0), 0.0),
        (lambda s: s.mirror("y", 0.3), (0.0, 1.0), 0.3),
        (lambda s: s.mirror(across=(0.6, 0.8), offset=0.2), (0.6, 0.8), 0.2),
        (lambda s: s.scale(1, -1), (0.0, 1.0), 0.0),
    ],
)
def test_flat_shapes_are_reflected_in_lines(image: Any, normal: Any, offset: float) -> None:
    shape, p = image(FLAT), PLACES[:, :2]
    np.testing.assert_allclose(shape(p), FLAT(reflected(p, normal, offset)), atol=1e-6)
    assert shape.exact
    corners = np.stack(np.meshgrid((-0.5, 0.5), (-0.25, 0.25)), -1).reshape(-1, 2)
    c, s = math.cos(0.4), math.sin(0.4)
    placed = reflected(corners @ np.array([[c, s], [-s, c]]) + (0.6, 0.2), normal, offset)
    low, high = np.array(shape.bounds())
    assert (low <= placed.min(0) + 1e-5).all() and (high >= placed.max(0) - 1e-5).all()
    if 0.0 in normal:
        np.testing.assert_allclose((low, high), (placed.min(0), placed.max(0)), atol=1e-5)
    around = FLAT.extrude(0.4)
    np.testing.assert_allclose(
        shape.extrude(0.4)(PLACES),
        around(reflected(PLACES, (*normal, 0.0), offset)),
        atol=1e-6,
    )
    assert np.allclose(FLAT.scale(-1)(p), FLAT.rotate(math.pi)(p), atol=1e-6)


def test_boxes_of_images_are_tight() -> None:
    low, high = np.array(SHAPE.bounds())
    np.testing.assert_allclose(
        SHAPE.mirror("x", 2.0).bounds(), ((4.0 - high[0], *low[1:]), (4.0 - low[0], *high[1:]))
    )
    # There and back through turns, as for rotations.
    plate = Box(10, 10, 4).rotate(z=0.8).mirror(across=(0.6, 0.8, 0.0)).mirror("x")
    back = plate.mirror("x").mirror(across=(0.6, 0.8, 0.0)).rotate(z=-0.8)
    np.testing.assert_allclose(back.bounds(), ((-5, -5, -2), (5, 5, 2)), atol=1e-5)
    rod = InfiniteCylinder(0.25).mirror(across=(1.0, 0.0, 0.0)).mirror("y")
    np.testing.assert_allclose(rod.bounds(), ((-0.25, -np.inf, -0.25), (0.25, np.inf, 0.25)))


def test_edges_of_images_are_shaped_as_before() -> None:
    """The ends that two prisms share do not move: so do those of their images."""
    plate = (Box(40, 10, 40) & Cylinder(22, 10)).fillet(2)
    image = (Box(40, 10, 40).mirror("x") & Cylinder(22, 10).mirror("xz")).fillet(2)
    assert image.node.rule is plate.node.rule
    far = 15.0 * PLACES
    np.testing.assert_allclose(image(far), plate(far), atol=1e-5)


def test_copies_of_images_are_images_of_copies() -> None:
    places = [(0.0, 0.0, 0.0), (2.0, 0.5, 0.0), (-2.0, 0.0, 1.0)]
    mirrored = [(-x, y, z) for x, y, z in places]
    small = SHAPE.scale(0.5)
    np.testing.assert_allclose(
        small.array(places).mirror("x")(PLACES),
        small.mirror("x").array(mirrored)(PLACES),
        atol=1e-6,
    )
    row = small.mirror("x").repeat(2.0, count=(3, 1, 1))
    at = np.random.default_rng(6).uniform(-0.9, 0.9, (200, 3))
    np.testing.assert_allclose(
        row(at + np.array((2.0, 0.0, 0.0))), small.mirror("x")(at), atol=1e-6
    )


def test_meshes_of_images_are_outward() -> None:
    """Their volumes are positive, and as large as before."""
    for image in (SHAPE.mirror("x"), SHAPE.mirror(across=tuple(NORMAL))):
        mesh = image.mesh(0.05, colors=False)
        assert not mesh.report["warnings"]  # the ball touches a face from inside
        a, b, c = (np.asarray(mesh.points)[np.asarray(mesh.triangles)[:, i]] for i in range(3))
        volume = float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)
        assert volume == pytest.approx(0.24 - _cut(), rel=0.04)  # of few triangles


def _cut() -> float:
    grid = (np.stack(np.meshgrid(*[np.arange(120)] * 3), -1).reshape(-1, 3) + 0.5) / 120 - 0.5
    at = grid * (1.0, 0.6, 0.4) + (0.3, 0.1, 0.2)
    return 0.24 * float((np.linalg.norm(at - (0.7, 0.3, 0.3), axis=1) < 0.3).mean())


def test_images_follow_parameters() -> None:
    where = slider("Where", 0.3, -1.0, 1.0)
    shape = Sphere(0.5).mirror("x", where)
    for value in (-0.7, 0.3, 0.9):
        found = shape((2.0 * value, 0.0, 0.0), params={"where": value})
        assert found == pytest.approx(-0.5, abs=1e-6)
    # Of a mixed vector, the plain factor reflects and the other one scales.
    size = slider("Size", 1.0, 0.5, 2.0)
    mixed = Ellipsoid(0.5, 0.5, 0.5).translate(x=1.0).scale(-1.0, size, 1.0)
    assert mixed((-1.0, 0.0, 0.0), params={"size": 2.0}) < 0.0 < mixed((1.0, 0.0, 0.0))
    with pytest.raises(SceneValueError, match="must be above 0; the slider 'B' goes down to -1"):
        SHAPE.scale(slider("B", 1.0, -1.0, 2.0))


def test_a_painted_image_has_the_looks_of_the_reflected_place() -> None:
    painted = Box(2.0, 2.0, 2.0).paint(checker("red", "white", 0.37))
    shape = painted.mirror(across=tuple(NORMAL), offset=OFFSET).named("image")
    assert shape.node.label == "image"
    assert shape.node.children[0].material is painted.node.material


@func
def glow(p: vec3) -> vec3:
    return vec3(0.5 + 0.5 * sin(9.0 * p.x), 0.5 + 0.5 * sin(7.0 * p.y + p.x), 0.3)


@func
def glow_of_image(p: vec3) -> vec3:
    return glow(vec3(-p.x, p.y, p.z))


@pytest.mark.parametrize("looks", ["a pattern", "metal"])
def test_the_picture_of_an_image_is_that_of_a_shape_modelled_so(looks: str) -> None:
    shape = Box(1.2, 0.8, 0.6).translate(0.2, 0.1, 0.3) | Sphere(0.5).translate(-0.6, 0.2, 0.0)
    other = Box(1.2, 0.8, 0.6).translate(-0.2, 0.1, 0.3) | Sphere(0.5).translate(0.6, 0.2, 0.0)
    made = {"a pattern": (pattern(glow), pattern(glow_of_image)), "metal": (metal(), metal())}
    pictures = []
    for image, material in zip((shape, other), made[looks], strict=True):
        painted = image.paint(material)
        seen = painted.mirror("x") if image is shape else painted
        camera = Camera((-3.0, 2.0, 5.0), (0.0, 0.0, 0.0))
        lights = [DistantLight(direction=(0.4, -1.0, -0.5))]
        scene = Scene(seen, camera=camera, lights=lights, background=(0.2, 0.3, 0.4))
        pictures.append(np.asarray(scene.render((60, 45), device="cpu")))
    np.testing.assert_allclose(pictures[0], pictures[1], atol=5e-4)
    assert np.abs(pictures[0] - pictures[0][:, ::-1]).max() > 0.1


REFUSED: dict[str, tuple[Callable[[], Any], str]] = {
    "a vector by position": (
        lambda: SHAPE.mirror((1, 0, 0)),
        "mirror takes letters of 'xyz', and a normal by name|"
        r"mirror\(across=\(1, 0, 0\)\) is the mirror image; symmetry\(across=\(1, 0, 0\)\)",
    ),
    "as the fold was called": (
        lambda: SHAPE.mirror(np.array([0.0, 1.0, 0.0]), 0.2),
        r"mirror\(across=\(0.0, 1.0, 0.0\)\) is the mirror image; symmetry\(across=\(0.0, 1.0, 0.0",
    ),
    "a flat one": (lambda: FLAT.mirror((1, 0)), r"mirror\(across=\(1, 0\)\) is the mirror image"),
    "a vector of the fold": (
        lambda: SHAPE.symmetry((1, 0, 0)),
        r"symmetry\(across=\(1, 0, 0\)\) keeps the half that it points to",
    ),
    "other letters": (lambda: FLAT.mirror("z"), "mirror takes letters of 'xy', not 'z'"),
    "a letter twice": (lambda: SHAPE.mirror("xx"), "mirror takes letters of 'xyz', not 'xx'"),
    "nothing": (lambda: SHAPE.mirror(), r"needs an axis or a plane|mirror\(across="),
    "both": (lambda: SHAPE.symmetry("x", across=(1, 0, 0)), "axes or a plane"),
    "one offset of two planes": (lambda: SHAPE.symmetry("xz", 0.5), "one for each axis"),
    "a normal that is long": (lambda: SHAPE.mirror(across=(1, 1, 0)), "a vector of length 1"),
    "a factor of 0": (lambda: SHAPE.scale(-1, 0, 1), "must be above 0"),
    "a British word": (lambda: SHAPE.shell(0.1, where="centre"), "did you mean 'center'"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_other_arguments_are_refused(name: str) -> None:
    make, message = REFUSED[name]
    with pytest.raises(SceneValueError) as caught:
        make()
    for part in message.split("|"):
        caught.match(part)
    assert "test_mirrors.py" in str(caught.value)


def test_names_of_other_tools_lead_here() -> None:
    for name, instead in (("reflect", "mirror('x')"), ("mirror_x", "mirror(across=")):
        with pytest.raises(AttributeError) as caught:
            getattr(Shape._of(SHAPE.node), name)
        assert instead in str(caught.value)


def test_the_fold_at_an_axis_beside_the_origin() -> None:
    half = Cylinder(0.4, 1.0).translate(x=1.5)
    both = half.symmetry("x", 0.5)
    np.testing.assert_allclose(
        both(PLACES), half.symmetry(across=(1, 0, 0), offset=0.5)(PLACES), atol=1e-12
    )
    assert both((-0.5, 0.0, 0.0)) == pytest.approx(-0.4) == both((1.5, 0.0, 0.0))
