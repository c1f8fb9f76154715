"""Pieces, holes and voids of meshes: against counts that are known."""

from __future__ import annotations

import numpy as np
import pytest

from distal.mesh.shells import Shells, shells_of
from tests.mesh.sample_solids import box, sphere, torus


def together(*parts):
    """One mesh of several, which do not share points."""
    points, triangles, count = [], [], 0
    for own, faces in parts:
        points.append(own)
        triangles.append(faces + count)
        count += len(own)
    return np.concatenate(points), np.concatenate(triangles)


def moved(part, *offset):
    return part[0] + np.array(offset), part[1]


def inside_out(part):
    return part[0], part[1][:, ::-1]


def plate(bores: int):
    """A plate with square bores in a row: a wall of quads, seen from both ends of each bore."""
    width = 2 * bores + 1
    solid = np.ones((width, 3), bool)
    solid[1::2, 1] = False
    cells = np.argwhere(solid)
    full = {tuple(c) for c in cells}
    corners: dict[tuple[int, ...], int] = {}
    faces = []

    def corner(*place):
        return corners.setdefault(place, len(corners))

    for x, y in cells:
        quads = [((0, 0), (0, 1), (1, 1), (1, 0))]
        bottom = [corner(x + i, y + j, 0) for i, j in quads[0]]
        top = [corner(x + i, y + j, 1) for i, j in reversed(quads[0])]
        faces += [bottom, top]
        sides = {(1, 0): ((1, 0), (1, 1)), (-1, 0): ((0, 1), (0, 0))}
        sides |= {(0, 1): ((1, 1), (0, 1)), (0, -1): ((0, 0), (1, 0))}
        for way, ((ax, ay), (bx, by)) in sides.items():
            if (x + way[0], y + way[1]) not in full:
                a, b = (x + ax, y + ay), (x + bx, y + by)
                faces.append([corner(*a, 0), corner(*b, 0), corner(*b, 1), corner(*a, 1)])
    points = np.array(list(corners), float)
    triangles = np.array([t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])
    return points, triangles


@pytest.mark.parametrize("bores", [0, 1, 7, 60])
def test_a_plate_has_a_hole_for_each_bore(bores):
    assert shells_of(*plate(bores)) == Shells(1, bores, 0)


def test_hollow_spheres_in_each_other_have_a_void_each():
    walls = [sphere(1, 1.0), inside_out(sphere(1, 0.9))]
    walls += [sphere(1, 0.5), inside_out(sphere(1, 0.4))]
    assert shells_of(*together(*walls)) == Shells(2, 0, 2)
    # Far from the origin, the sign of a volume is that of the shell all the same.
    far = [moved(wall, 1e5, -2e5, 3e5) for wall in walls]
    assert shells_of(*together(*far)) == Shells(2, 0, 2)


def test_a_chain_of_rings_has_a_piece_and_a_hole_for_each():
    rings = []
    for number in range(9):
        points, triangles = torus(24, 8)
        turned = points if number % 2 else points[:, [0, 2, 1]] * (1.0, 1.0, -1.0)
        rings.append(moved((turned, triangles), 1.4 * number, 0.0, 0.0))
    assert shells_of(*together(*rings)) == Shells(9, 9, 0)
    hollow = [*rings, inside_out(torus(24, 8, 1.0, 0.1))]
    assert shells_of(*together(moved(box((40.0, 40.0, 40.0)), 60.0, 0.0, 0.0), *hollow)) == Shells(
        10, 10, 1
    )


def test_points_without_triangles_do_not_count():
    points, triangles = box()
    points = np.concatenate([[[9.0, 9.0, 9.0]], points, [[8.0, 8.0, 8.0]]])
    assert shells_of(points, triangles + 1) == Shells(1, 0, 0)
    assert shells_of(points[:0], triangles[:0]) == Shells(0, 0, 0)


def test_the_order_of_triangles_does_not_matter():
    points, triangles = together(plate(40), moved(torus(60, 20), 0.0, 9.0, 0.0))
    order = np.random.default_rng(3).permutation(len(triangles))
    numbers = np.random.default_rng(4).permutation(len(points))
    back = np.argsort(numbers)
    assert shells_of(points[numbers], back[triangles[order]]) == Shells(2, 41, 0)
