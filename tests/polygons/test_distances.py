"""Distances to meshes on a grid: closed forms, slopes, insides of open and overlapping meshes."""

import numpy as np
import pytest

from distal.diagnostics import LoadError
from distal.polygons import arithmetic, distances
from distal.polygons.cells import sorted_into_cells
from distal.polygons.kernels import run
from distal.polygons.topology import joined, topology
from distal.polygons.tree import tree_buffers
from distal.polygons.triangles import checked
from tests.mesh.sample_solids import box, sphere, torus, volume

RANDOM = np.random.default_rng(15)
# Away from the surface, a node knows the nearest triangles of its neighbors only. Their nearest
# points are at most about half a cell beside its own, at two cells or more: 0.5^2 / (2 * 2).
FARTHER = 0.0625


def grid_of(found):
    z, y, x = np.indices(found.values.shape)
    return np.stack([x, y, z], axis=-1) * found.spacing + found.low


def of_box(p, size):
    past = np.abs(p) - np.array(size) / 2.0
    outside = np.linalg.norm(np.maximum(past, 0.0), axis=-1)
    return outside + np.minimum(past.max(axis=-1), 0.0)


def of_sphere(p):
    return np.linalg.norm(p, axis=-1) - 1.0


def of_torus(p):
    return np.hypot(np.hypot(p[..., 0], p[..., 2]) - 1.0, p[..., 1]) - 0.25


def steepest(found):
    """The largest difference of neighbors along an axis, in their distance."""
    rises = [np.abs(np.diff(found.values, axis=axis)).max() for axis in range(3)]
    return max(rises) / found.spacing


def test_the_nearest_point_of_a_triangle():
    """Against the smallest distance to many points of the triangle."""
    corners = RANDOM.normal(size=(40, 3, 3))
    corners[30:] = np.round(corners[30:])
    corners[39, 2] = 2.0 * corners[39, 1] - corners[39, 0]  # no area
    points = RANDOM.normal(size=(40, 3)) * 2.0
    names = ("FIRST", "SECOND", "THIRD")
    buffers = {name: corners[:, i].astype(np.float32) for i, name in enumerate(names)}
    which = np.arange(40, dtype=np.int32)
    found = np.sqrt(run(arithmetic.squared_distance, points, which, buffers, double=True))
    u, v = np.meshgrid(np.linspace(0.0, 1.0, 200), np.linspace(0.0, 1.0, 200))
    weights = np.stack([1 - u, u * (1 - v), u * v], axis=-1).reshape(-1, 3)
    for p, triangle, distance in zip(points, corners, found, strict=True):
        sampled = np.linalg.norm(weights @ triangle - p, axis=1).min()
        assert distance <= sampled + 1e-6
        assert distance == pytest.approx(sampled, abs=0.04)


def test_a_box_is_exact():
    size = (1.0, 2.0, 3.0)
    found = distances.distances(checked(*box(size)))
    assert found.values.shape == (69, 48, 27)
    assert found.spacing == pytest.approx(3.0 / 64.0)
    assert found.values == pytest.approx(of_box(grid_of(found), size), abs=1e-6)
    assert found.sign == "normals" and not found.turned
    assert found.topology.volume == pytest.approx(6.0, rel=1e-6)


@pytest.mark.parametrize(
    ("mesh", "field", "most"),
    [(sphere(5), of_sphere, 0.0013), (torus(128, 64), of_torus, 0.0013)],
)
def test_round_solids_are_as_exact_as_their_triangles(mesh, field, most):
    found = distances.distances(checked(*mesh), 0.06)
    points, triangles = mesh
    # How far the triangles are inside of the surface.
    corners = points[triangles]
    middles = [corners.mean(axis=1), *(0.5 * (corners[:, i] + corners[:, i - 1]) for i in range(3))]
    sagging = np.abs(field(np.concatenate(middles))).max()
    assert sagging < most
    true = field(grid_of(found))
    assert ((found.values < 0.0) == (true < 0.0))[np.abs(true) > sagging].all()
    away = np.abs(found.values) - np.abs(true)
    assert away.min() > -1.01 * sagging
    assert away[np.abs(true) < found.spacing].max() < 1.01 * sagging
    assert away.max() < sagging + FARTHER * found.spacing
    assert steepest(found) <= 1.0 + 1e-5


@pytest.mark.parametrize("seed", range(4))
def test_far_nodes_know_the_nearest_triangle(seed):
    """Every value against the smallest distance to any triangle."""
    points, triangles = torus(16, 8)
    rough = np.random.default_rng(seed).normal(size=points.shape) * 0.03
    points = points * (1.0, 2.0, 0.7) + rough
    found = distances.distances(checked(points, triangles), 0.12)
    at = grid_of(found).reshape(-1, 3)
    corners = points[triangles].astype(np.float32)
    buffers = {n: corners[:, i].copy() for i, n in enumerate(("FIRST", "SECOND", "THIRD"))}
    nearest = np.full(len(at), np.inf)
    for index in range(len(triangles)):
        which = np.full(len(at), index, np.int32)
        nearest = np.minimum(nearest, run(arithmetic.squared_distance, at, which, buffers))
    true, values = np.sqrt(nearest), np.abs(found.values.reshape(-1))
    assert (values >= true - 1e-5).all()
    near = true <= found.spacing
    assert values[near] == pytest.approx(true[near], abs=1e-5)
    # Of 24 such shapes, .029 of the spacing at most.
    assert (values - true).max() < 0.03 * found.spacing
    assert ((values - true) < 1e-5).mean() > 0.999


def test_large_and_small_triangles_are_in_all_cells_they_meet():
    corners = RANDOM.uniform(1.0, 18.0, (60, 3, 3)).astype(np.float32)
    corners[40:] = corners[40:, :1] + RANDOM.normal(size=(20, 3, 3)).astype(np.float32) * 0.2
    cells = sorted_into_cells(tuple(corners.transpose(1, 0, 2)), (20, 20, 20))
    assert cells.shape == (21, 21, 21) and cells.starts[-1] == len(cells.members)
    weights = RANDOM.dirichlet((1.0, 1.0, 1.0), 400)
    for index, triangle in enumerate(corners):
        x, y, z = np.floor(weights @ triangle).astype(int).T + 1
        for cell in np.unique((z * 21 + y) * 21 + x):
            members = cells.members[cells.starts[cell] : cells.starts[cell + 1]]
            assert (members == index).sum() == 1


def test_an_inverted_mesh_is_turned():
    points, triangles = sphere(4)
    right = distances.distances(checked(points, triangles), 0.1)
    found = distances.distances(checked(points, triangles[:, ::-1]), 0.1)
    assert found.turned and found.topology.volume == pytest.approx(-right.topology.volume)
    assert found.values == pytest.approx(right.values, abs=FARTHER * 0.1)
    near = np.abs(right.values) < 0.1
    assert found.values[near] == pytest.approx(right.values[near], abs=1e-6)


def test_bodies_that_overlap_are_joined():
    points, triangles = sphere(4)
    both = np.concatenate([points, points + np.array((0.7, 0.0, 0.0))])
    twice = np.concatenate([triangles, triangles + len(points)])
    found = distances.distances(checked(both, twice), 0.1)
    at = grid_of(found)
    expected = np.minimum(of_sphere(at), of_sphere(at - (0.7, 0.0, 0.0)))
    assert found.sign == "winding" and found.topology.is_closed
    outside = expected > 0.01
    assert found.values[outside] == pytest.approx(expected[outside], abs=FARTHER * 0.1)
    # The walls within the other body are still there: the value is -0 on them.
    assert (np.signbit(found.values) == (expected < 0.0))[np.abs(expected) > 0.01].all()


def test_a_shell_in_a_shell_is_a_cavity_if_it_is_turned():
    points, triangles = sphere(3)
    both = np.concatenate([points, 0.5 * points])
    cavity = np.concatenate([triangles, triangles[:, ::-1] + len(points)])
    found = distances.distances(checked(both, cavity), 0.1)
    at = grid_of(found)
    assert found.sign == "normals"
    expected = np.maximum(of_sphere(at), 0.5 - np.linalg.norm(at, axis=-1))
    assert found.values == pytest.approx(expected, abs=0.03)


def test_sharp_corners_have_the_right_side():
    """At an acute corner the side of the nearest face can be wrong; winding numbers are right."""
    points, triangles = sphere(2)
    points = points * RANDOM.uniform(0.25, 1.5, (len(points), 1))
    found = distances.distances(checked(points, triangles), 0.06)
    assert found.sign == "normals"
    at = grid_of(found).reshape(-1, 3)
    mesh = joined(checked(points, triangles), np.zeros(3), 1.0)
    winding = run(arithmetic.winding_number, at, None, tree_buffers(mesh.corners))
    far = np.abs(found.values.reshape(-1)) > 1e-4
    assert ((found.values.reshape(-1) < 0.0) == (winding > 0.5))[far].all()


def test_holes_are_closed_without_a_jump():
    points, triangles = sphere(4)
    is_cap = points[triangles].mean(axis=1)[:, 1] > 0.8
    mesh = checked(points, triangles[~is_cap])
    found = distances.distances(mesh, 0.1)
    assert found.sign == "winding" and found.topology.open_edges > 10
    assert steepest(found) <= 1.0 + 1e-4
    at = grid_of(found)
    below = (at[..., 1] < 0.0) & (np.abs(of_sphere(at)) < 0.5)
    assert found.values[below] == pytest.approx(of_sphere(at)[below], abs=FARTHER * 0.1)
    # The hole is closed near the plane of its edge: inside below it, outside above it.
    axis = (np.hypot(at[..., 0], at[..., 2]) < 0.1) & (at[..., 1] > 0.0)
    assert (found.values[axis & (at[..., 1] < 0.7)] < 0.0).all()
    assert (found.values[axis & (at[..., 1] > 0.95)] > 0.0).all()


def test_winding_numbers_of_the_tree_are_those_of_the_sum():
    points, triangles = torus(40, 20)
    is_open = points[triangles].mean(axis=1)[:, 0] < 0.5
    for chosen in (triangles, triangles[is_open]):
        mesh = joined(checked(points, chosen), np.zeros(3), 0.05)
        at = RANDOM.uniform(-30.0, 30.0, (300, 3))
        found = run(arithmetic.winding_number, at, None, tree_buffers(mesh.corners))
        count = len(mesh.triangles)
        rows, which = np.repeat(at, count, axis=0), np.tile(np.arange(count), 300)
        angles = run(arithmetic.solid_angle, rows, which.astype(np.int32), mesh.buffers)
        exact = angles.reshape(300, count).sum(axis=1, dtype=float) / (4.0 * np.pi)
        assert found == pytest.approx(exact, abs=0.02)
        if chosen is triangles:
            assert exact == pytest.approx(np.round(exact), abs=1e-4)
            assert set(np.round(exact)) == {0.0, 1.0}


def test_unsigned_distances_have_no_inside():
    found = distances.distances(checked(*sphere(4)), 0.1, "unsigned")
    assert found.values.min() >= 0.0
    assert found.values == pytest.approx(np.abs(of_sphere(grid_of(found))), abs=FARTHER * 0.1)


def test_edges_are_counted():
    points, triangles = box()
    mesh = joined(checked(points, np.concatenate([triangles, [(0, 0, 1)]])), np.zeros(3), 1.0)
    found = topology(mesh)
    assert found.is_closed and mesh.left_out == 1 and found.volume == pytest.approx(1.0)
    edges = [
        (triangles[1:], (3, 0, 0)),
        (np.concatenate([triangles, triangles[:1]]), (0, 3, 0)),
        (np.concatenate([triangles[:1, ::-1], triangles[1:]]), (0, 0, 3)),
    ]
    for changed, counts in edges:
        found = topology(joined(checked(points, changed), np.zeros(3), 1.0))
        assert not found.is_closed
        assert (found.open_edges, found.shared_edges, found.turned_edges) == counts


def test_points_are_joined_by_place():
    points, triangles = box()
    loose = points[triangles].reshape(-1, 3)
    found = distances.distances(checked(loose, np.arange(36).reshape(-1, 3)), 0.1)
    assert found.sign == "normals"
    assert found.values == pytest.approx(of_box(grid_of(found), (1, 1, 1)), abs=1e-6)


SHEET = ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
REFUSED = [
    (
        SHEET,
        {},
        "the mesh is open, with 3 open edges, and encloses nothing: close it, or give "
        "sign='unsigned' and make a sheet of it with .round(thickness)",
    ),
    (
        SHEET,
        {"sign": "normals"},
        "the mesh is open, with 3 open edges: sign='normals' needs a closed one; close it, or "
        "give sign='winding'",
    ),
    (([(1, 1, 1)] * 3, [(0, 1, 2)]), {}, "all points are in one place: the mesh has no size"),
    (
        ([(0, 0, 0), (1, 0, 0)], [(0, 1, 0)]),
        {},
        "all triangles have a corner twice: there is no surface",
    ),
    (
        box(),
        {"spacing": 2.0},
        "the spacing 2 is not smaller than the mesh, 1: leave it out, or give 0.0156",
    ),
    (
        box(),
        {"spacing": 0.003},
        "a spacing of 0.003 needs 38,958,219 samples, more than 16,777,216: a spacing of 0.00417 "
        "is enough",
    ),
    (box(), {"spacing": 1e-9}, "a spacing of 1e-09 is too small for a mesh of size 1"),
]


@pytest.mark.parametrize(("mesh", "options", "message"), REFUSED)
def test_what_is_no_solid_is_refused(mesh, options, message):
    with pytest.raises(LoadError) as caught:
        distances.distances(checked(*mesh), **options)
    assert caught.value.message == message


def test_the_spacing_that_is_named_is_enough():
    with pytest.raises(LoadError) as caught:
        distances.distances(checked(*box()), 0.001)
    enough = float(caught.value.message.split("a spacing of ")[-1].split()[0])
    counts = [np.ceil(1.0 / enough) + 1 + 2 * distances.MARGIN] * 3
    assert np.prod(counts) <= distances.MOST_DENSE


def test_volumes_of_the_sample_meshes():
    assert volume(*box((1, 2, 3))) == pytest.approx(6.0)
    assert volume(*torus(64, 32)) == pytest.approx(2.0 * np.pi**2 / 16.0, rel=0.01)
