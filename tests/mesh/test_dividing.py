"""Cells of several sizes: closed and free of intersections whatever is divided; errors fall."""

from __future__ import annotations

import numpy as np
import pytest

from distal import (
    Bolt,
    Box,
    Cone,
    Cylinder,
    MetricHole,
    MetricThread,
    Nut,
    SimplexNoiseSolid,
    Sphere,
)
from distal.mesh import dividing, leaves
from distal.mesh.checks import checked
from distal.mesh.extract import Extracted, completed, extracted
from distal.mesh.kernels import FieldKernels
from distal.mesh.lattice import keys_of
from distal.mesh.meshing import MeshRequest, extent_of
from distal.mesh.tree_topology import Tree, topology_of_tree
from distal.scene.objects.metric_sizes import METRIC
from tests.mesh.noise_fields import noise

SOUND = {"open_edges": 0, "pinched_points": 0, "intersections": 0}
STEP = 0.1


def divided_at_random(shape, step, seed, share, levels=3):
    """A mesh whose cells are divided at random, beside each other and in each other."""
    kernels = FieldKernels(shape.node, {}, 0.0)
    extent = extent_of(shape.node, MeshRequest())
    found = extracted(kernels, extent, step, 1.0, 10**6, lambda part: None)
    assert isinstance(found, Extracted)
    surface = found.looked_at.surface
    tree = Tree.of_equal_cells(kernels, found.lattice, keys_of(surface))
    rng = np.random.default_rng(seed)
    parted, cells = [], surface
    for _level in range(min(levels, tree.levels)):
        chosen = cells[rng.random(len(cells)) < max(share, 8.0 / len(cells))]
        # Cells beside the surface too.
        chosen = np.concatenate([chosen, chosen[:5] + rng.integers(-1, 2, (len(chosen[:5]), 3))])
        parted.append(keys_of(chosen))
        cells = (chosen[:, None] * 2 + np.indices((2, 2, 2)).reshape(3, -1).T[None]).reshape(-1, 3)
    parted += [keys_of(cells[:0])] * (tree.levels - len(parted))
    topology, tree = topology_of_tree(tree.with_divided(tuple(parted)))
    lattice = tree.values.lattice
    return completed(kernels, extent, lattice, topology, found.looked_at, 1.0, lambda part: None)


def sound(made):
    """Check that triangles are closed, manifold and free of intersections, in 64 and 32 bits."""
    assert checked(made.points, made.triangles) == SOUND
    single = made.points.astype(np.float32).astype(np.float64)
    assert checked(single, made.triangles) == SOUND


@pytest.mark.parametrize(
    ("seed", "share"), [(0, 0.03), (1, 0.03), (2, 0.2), (3, 0.2), (4, 0.5), (5, 0.1)]
)
def test_whatever_is_divided_stays_closed(seed, share):
    kind = ("linear", "cubes")[seed % 2]
    shape = noise(kind, seed, (0.14, 0.1, 0.2)[seed % 3], (1.0, 60.0)[seed % 2])
    found = divided_at_random(shape, STEP, seed, share)
    assert len(found.levels) >= 3 and np.count_nonzero(found.levels) >= 3
    sound(found.made)


def edges_passed(found):
    """How many edges with two triangles have triangles that do not meet the edge itself."""
    topology, made = found.topology, found.made
    edges, count = np.unique(made.edge, return_counts=True)
    points = len(topology.points.cell)
    plain = np.flatnonzero((made.triangles < points).all(axis=1))
    plain = plain[np.isin(made.edge[plain], edges[count == 2])]
    assert len(plain) > 50
    rows = made.edge[plain]
    starts = found.lattice.places(topology.edges.start[rows])
    along = np.eye(3)[topology.edges.axis[rows]]
    lengths = topology.edges.size[rows] * found.lattice.step
    a, b, c = np.moveaxis(made.points[made.triangles[plain]] - starts[:, None], 1, 0)
    # Where the line of the edge passes the plane of the triangle, and whether it is inside.
    areas = [np.einsum("ij,ij->i", np.cross(p, q), along) for p, q in ((b, c), (c, a), (a, b))]
    total = np.sum(areas, axis=0)
    shares = np.stack(areas, axis=1) / np.where(total == 0.0, np.inf, total)[:, None]
    inside = (total != 0.0) & (shares > -1e-6).all(axis=1)
    places = np.einsum("ij,ijk,ik->i", shares, np.stack([a, b, c], axis=1), along) / lengths
    within = inside & (places > 0.0) & (places < 1.0)
    passed = np.bincount(rows, weights=inside & ~within) > 0
    met = np.bincount(rows, weights=within) > 0
    return int((passed[np.unique(rows)] | ~met[np.unique(rows)]).sum())


@pytest.mark.parametrize("seed", [5, 6, 9, 10])
def test_two_triangles_meet_their_edge_between_its_ends(seed):
    """With cells of unequal size a triangle may pass the end of its edge; it was accepted once."""
    assert edges_passed(divided_at_random(noise("cubes", seed, 0.14, 60.0), STEP, seed, 0.5)) == 0


def test_a_missing_leaf_or_a_wrong_loop_would_be_seen(monkeypatch):
    """Without the search for several loops the same fields have faults."""
    monkeypatch.setattr(leaves, "_several_loops", lambda *given: np.empty(0, np.int64))
    faults = 0
    for seed in (1, 3):
        shape = noise("cubes", seed, 0.1, 60.0)
        made = divided_at_random(shape, STEP, seed, 0.1).made
        found = checked(made.points, made.triangles)
        faults += found["pinched_points"] + found["intersections"]
    assert faults > 0


TURN = {"x": 0.3, "y": 0.5, "z": 0.7}


@pytest.mark.parametrize(
    ("shape", "tolerance", "most"),
    [
        # A corner that equal cells cut made all of them small.
        (Box(1.0, 0.7, 0.4).rotate(**TURN), 0.002, 12_000),
        (Cone(0.5, 1.5).rotate(**TURN), 0.002, 20_000),
        # A large plate with a small pin and a small hole.
        (Box(4.0, 0.5, 4.0) | Cylinder(0.04, 0.4).translate(0.7, 0.3, 0.9), 0.001, 45_000),
        (Box(4.0, 0.5, 4.0).round(0.02) - Cylinder(0.06, 2.0), 0.004, 60_000),
    ],
)
def test_few_triangles_are_within_the_tolerance(shape, tolerance, most):
    made = shape.mesh(tolerance)
    report = made.report
    assert report["warnings"] == []
    assert report["error"]["largest"] <= tolerance and report["error"]["cut_corner"] <= tolerance
    assert len(report["levels"]) > 1 and report["triangles"] < most
    sound(made)
    # Measured from outside of the code: points of the triangles against the field.
    rng = np.random.default_rng(3)
    rows = rng.integers(0, len(made.triangles), 20_000)
    shares = rng.dirichlet((1.0, 1.0, 1.0), 20_000)
    places = np.einsum("ij,ijk->ik", shares, made.points[made.triangles[rows]])
    assert np.abs(shape(places)).max() < 1.5 * tolerance


@pytest.mark.parametrize("tolerance", [0.001, 0.0005])
def test_the_tip_of_a_cone_is_there(tolerance):
    made = Cone(0.5, 1.5).rotate(**TURN).mesh(tolerance)
    low, high = Sphere(0.1).translate(0.0, 0.75, 0.0).rotate(**TURN).bounds()
    tip = (np.array(low) + high) / 2.0
    assert np.linalg.norm(made.points - tip, axis=1).min() < tolerance


def test_cells_that_a_suspicion_divides_may_be_empty():
    made = (SimplexNoiseSolid(cell_size=0.5) & Box(1.2)).mesh(0.012)
    assert made.report["error"]["largest"] <= 0.012
    sound(made)


def test_the_same_bytes_each_time():
    shape = Box(1.0, 0.7, 0.4).rotate(**TURN)
    first, second = shape.mesh(0.002), shape.mesh(0.002)
    assert first.points.tobytes() == second.points.tobytes()
    assert first.triangles.tobytes() == second.triangles.tobytes()


def test_cells_are_not_smaller_than_numbers_of_32_bits():
    far = Box(1.0, 0.7, 0.4).rotate(**TURN).translate(3000.0, 0.0, 0.0)
    made = far.mesh(0.005)
    single = made.points.astype(np.float32).astype(np.float64)
    assert checked(single, made.triangles) == SOUND


def test_division_ends_where_errors_do_not_fall(monkeypatch):
    shape = noise("cubes", 1, 0.14, 60.0)
    kernels = FieldKernels(shape.node, {}, 0.0)
    extent = extent_of(shape.node, MeshRequest())
    watch = lambda part: None  # noqa: E731
    found = extracted(kernels, extent, STEP, 1.0, 10**6, watch)
    assert isinstance(found, Extracted)
    monkeypatch.setattr(dividing, "_MOST_HALVES", 20 * found.cells)
    made = dividing.divided(kernels, extent, found, 0.2 * found.accuracy.mean, watch)
    assert made.error > 0.2 * found.accuracy.mean  # which the report says
    assert found.cells < made.cells < 8 * found.cells
    assert made.tree is not None and any(len(keys) for keys in made.tree.divided)
    sound(made.made)


def test_a_part_of_a_mesh_may_have_no_certain_edge():
    """Cells that only a suspicion divides had edges at the rim without segments: it crashed."""
    made = Bolt("M5", 25.0).mesh(tolerance=0.02)
    assert made.report["error"]["largest"] <= 0.02 and made.report["warnings"] == []


THREADS = {
    "bolt": lambda size, row: Bolt(size, 4.0 * row.diameter),
    "bolt with a shank": lambda size, row: Bolt(size, 3.0 * row.diameter, thread=row.diameter),
    "nut": lambda size, row: Nut(size),
    "rod": lambda size, row: MetricThread(size, 2.0 * row.diameter),
    "left rod": lambda size, row: MetricThread(size, 2.0 * row.diameter, left=True),
    "hole": lambda size, row: MetricHole(size, row.diameter),
}


@pytest.mark.sample(48)
@pytest.mark.parametrize("share", [0.04, 0.02, 0.01, 0.004])
@pytest.mark.parametrize("size", METRIC)
@pytest.mark.parametrize("kind", THREADS)
def test_every_thread_has_a_mesh(kind, size, share):
    row = METRIC[size]
    tolerance = share * row.diameter
    report = THREADS[kind](size, row).mesh(tolerance, check=True).report
    assert report["check"] == SOUND
    assert report["error"]["largest"] <= tolerance or report["warnings"]
