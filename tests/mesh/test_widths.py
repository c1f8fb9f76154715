"""Walls, gaps and overhang against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import Box, Cone, Cylinder, Plane, Sphere, Torus, union
from distal.mesh.parts import part_at
from distal.scene.tree.errors import SceneValueError

TURN = {"x": 0.3, "y": 0.5, "z": 0.7}


@pytest.mark.parametrize(
    ("shape", "wall", "gap"),
    [
        (Sphere(1.0), 2.0, None),
        (Box(2.0, 1.0, 0.5), 0.5, None),
        (Box(2.0, 1.0, 0.5).rotate(**TURN), 0.5, None),
        # The wall is the shell, and the hollow is a gap.
        (Box(2.0, 1.0, 0.5).shell(0.03, where="center") & Box(1.7, 4.0, 4.0), 0.03, 0.47),
        # A slot that is narrower than the cells of the mesh are apart at first.
        (Box(40.0, 10.0, 20.0) - Box(0.37, 20.0, 20.0).translate(x=3.0), 10.0, 0.37),
        (Torus(1.0, 0.2), 0.4, 1.6),
        # A wall that is thinnest in the middle, between two holes.
        (
            Box(4.0, 4.0, 1.0)
            - Cylinder(0.9, 3.0).rotate(x=np.pi / 2).translate(x=0.95)
            - Cylinder(0.9, 3.0).rotate(x=np.pi / 2).translate(x=-0.95),
            0.1,
            1.8,
        ),
        # Large and small shapes alike.
        (Box(2000.0, 1000.0, 500.0), 500.0, None),
        (Box(2e-3, 1e-3, 0.5e-3), 0.5e-3, None),
    ],
)
def test_the_thinnest_wall_and_the_narrowest_gap(shape, wall, gap):
    found = shape.measure()
    assert found.wall.value == pytest.approx(wall, rel=1e-4)
    assert (found.gap is None) == (gap is None)
    if gap is not None:
        assert found.gap.value == pytest.approx(gap, rel=1e-4)
    least = wall if gap is None else min(wall, gap)
    assert found.feature.value == pytest.approx(least, rel=1e-4)
    between = np.linalg.norm(np.subtract(found.wall.opposite, found.wall.place))
    assert between == pytest.approx(found.wall.value, rel=1e-6)


def test_a_tapered_wall_is_followed_to_its_thin_end():
    # A wedge of 4 degrees, cut off where it is .02 thick.
    angle = math.radians(2.0)
    upper = Plane(y=0.0).rotate(z=angle)
    lower = Plane(y=0.0).rotate(z=math.pi - angle)
    start = 0.01 / math.tan(angle)
    wedge = upper & lower & Box(2.0, 1.0, 0.5).translate(x=start + 1.0)
    found = wedge.measure(tolerance=0.0005)
    # A line along the normal of one side meets the other at this angle.
    expected = 0.02 * math.cos(angle) / math.cos(2.0 * angle)
    assert found.wall.value == pytest.approx(expected, rel=0.01)


def test_the_shape_and_the_line_are_named():
    thick = Box(2.0, 2.0, 2.0)
    thin = Box(0.05, 1.0, 1.0).translate(x=1.5) | Box(1.0, 0.3, 0.3).translate(x=1.1)
    found = (thick | thin).measure()
    assert found.wall.value == pytest.approx(0.05, rel=1e-4)
    assert found.wall.name.startswith("'Box' (line ")
    assert found.wall.line == thin.node.place.line
    assert found.wall.place[0] > 1.4


def test_the_nearest_name_of_the_author_is_shown():
    post = Box(0.6, 5.0, 1.0)
    left, right = post.translate(x=-3.0), post.translate(x=3.0)
    posts = (left.named("left") | right.named("right")).named("posts")
    top = (Box(10.0, 0.4, 4.0) - Cylinder(0.5, 3.0).named("bore")).translate(y=2.5).named("top")
    names = {}
    for place in ((3.0, 0.0, 0.5), (-3.3, 0.0, 0.0), (0.0, 2.7, 1.0), (0.0, 2.5, 0.5)):
        part = part_at((posts | top).node, np.array(place), {}, 0.0)
        names[place] = part.text.partition(" (line ")[0].removesuffix("'")
        assert part.line is not None
    shown = ["'right (Box)", "'left (Box)", "'top (Box)", "'bore (Cylinder)"]
    assert list(names.values()) == shown
    found = (posts | top).measure(tolerance=0.02)
    assert found.wall.name == f"'top (Box)' (line {found.wall.line})"
    assert found.overhang.name == f"'top (Box)' (line {found.overhang.line})"


def test_names_reach_into_tables_of_parts():
    rods = [Box(0.3, 1.0, 0.3).translate(x=float(i)) for i in range(20)]
    comb = union([*rods[1:], rods[0].named("first")]).named("comb")
    first = part_at(comb.node, np.array([0.0, 0.5, 0.0]), {}, 0.0)
    other = part_at(comb.node, np.array([7.0, 0.5, 0.0]), {}, 0.0)
    assert first.text.startswith("'first (Box)' (line ")
    assert other.text.startswith("'comb (Box)' (line ")


def test_a_corner_is_no_thin_wall():
    assert Box(1.0).rotate(**TURN).measure().wall.value == pytest.approx(1.0, rel=1e-6)
    angled = Box(1.0) - Box(1.0).translate(0.5, 0.5, 0.0)
    found = angled.measure()
    assert found.gap is None
    assert found.wall.value == pytest.approx(0.5, rel=1e-4)


@pytest.mark.parametrize("limit", [30.0, 45.0, 60.0])
def test_the_overhang_of_a_ball_is_a_cap(limit):
    found = Sphere(1.0).measure(tolerance=0.0005, overhang_deg=limit).overhang
    cap = 2.0 * math.pi * (1.0 - math.cos(math.radians(limit)))
    assert found.area == pytest.approx(cap, rel=0.03)
    assert found.share == pytest.approx(cap / (4.0 * math.pi), rel=0.03)
    assert found.place[1] < -0.99


def test_what_stands_on_the_bed_does_not_hang_over():
    assert Box(1.0).measure().overhang.area == 0.0
    table = Box(2.0, 0.2, 2.0).translate(y=1.0) | Box(0.3, 2.0, 0.3)
    found = table.measure().overhang
    assert found.area == pytest.approx(4.0 - 0.09, rel=1e-3)
    assert found.name == f"'Box' (line {table.node.children[0].place.line})"
    assert found.place[1] == pytest.approx(0.9, abs=1e-6)


def test_faces_at_the_angle_itself_need_no_support():
    cone = Cone(1.0, 1.0).rotate(x=np.pi)  # opens upwards: its side is at an angle of its own
    low, high = (np.array(corner) for corner in cone.bounds())
    steep = math.degrees(math.atan((high - low)[1] / (high - low)[0] * 2.0))
    # The triangles at the tip are flatter than the cone.
    assert cone.measure(overhang_deg=steep - 1.0).overhang.share < 2e-3
    side = cone.measure(overhang_deg=steep + 1.0).overhang.area
    assert side == pytest.approx(math.pi * math.sqrt(2.0), rel=0.02)


@pytest.mark.parametrize("angle", [-1.0, 91.0, "steep", True, math.nan])
def test_a_wrong_angle_is_refused(angle):
    with pytest.raises(SceneValueError, match="an overhang is an angle from 0 to 90 degrees, not"):
        Box(1.0).measure(overhang_deg=angle)


def test_too_far_from_the_origin_is_told():
    with pytest.raises(SceneValueError) as caught:
        Sphere(1e-3).translate(100.0, 0.0, 0.0).mesh()
    assert "is too far from the origin for so fine a mesh: files hold 7 digits" in str(caught.value)
    assert "mesh it at the origin: .translate(-100, -0, -0)" in str(caught.value)
