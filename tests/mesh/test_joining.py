"""Cells that are joined: few triangles, nothing lost, closed whatever is joined and divided."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from distal import Box, Cylinder, Sphere
from distal.devices import threads
from distal.mesh import dividing, joining
from distal.mesh.checks import checked
from distal.mesh.extract import Extracted, completed, extracted
from distal.mesh.join_arithmetic import unsaid_by_corners
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.lattice import keys_of
from distal.mesh.meshing import MeshRequest, extent_of
from distal.mesh.tables import CORNERS, cell_tables
from distal.mesh.tree_topology import topology_of_tree
from tests.mesh.noise_fields import noise

SOUND = {"open_edges": 0, "pinched_points": 0, "intersections": 0}
TURN = {"x": 0.3, "y": 0.5, "z": 0.7}
GRID = np.stack(np.meshgrid(*[np.arange(3.0)] * 3, indexing="ij"), axis=-1).reshape(27, 3)


def sound(made):
    """Check that triangles are closed, manifold and free of intersections, in 64 and 32 bits."""
    assert checked(made.points, made.triangles) == SOUND
    single = made.points.astype(np.float32).astype(np.float64)
    assert checked(single, made.triangles) == SOUND


def at_step(shape, step, joined):
    """The mesh of a shape at one spacing."""
    kernels = FieldKernels(shape.node, {}, 0.0)
    extent = extent_of(shape.node, MeshRequest())
    found = extracted(kernels, extent, step, 1.0, 10**6, lambda share: None, joined)
    assert isinstance(found, Extracted)
    return found


def test_a_plane_is_said_by_corners_and_a_bump_is_not():
    plane = GRID @ (0.3, 0.5, -0.2) - 0.7
    bump = plane.copy()
    bump[13] -= 0.05
    found = rows_of(unsaid_by_corners, np.stack([plane, bump]), np.full(2, 2.0))
    assert found[0] == pytest.approx(0.0, abs=1e-12)
    # The value changes by sqrt(.38) for each unit of length.
    assert found[1] == pytest.approx(0.05 / np.sqrt(0.38))


def agreeing(block):
    """Whether each sample has the sign of a corner of its edge or face."""
    for place in np.argwhere(block | True):
        ends = [(0, 2) if n == 1 else (n,) for n in place]
        if block[tuple(place)] not in [block[corner] for corner in product(*ends)]:
            return False
    return True


def test_signs_of_blocks_are_said_by_corners_if_each_sample_agrees_with_one():
    rng = np.random.default_rng(3)
    lattice = rng.random((60, 9, 9, 9)) < rng.random((60, 1, 1, 1))
    # Half of them are cut by planes: most of their blocks agree.
    ways = rng.normal(size=(30, 3))
    places = np.stack(np.meshgrid(*[np.arange(9.0) - 4.0] * 3, indexing="ij"), axis=-1)
    lattice[:30] = np.einsum("nc,xyzc->nxyz", ways, places) < rng.normal(size=(30, 1, 1, 1))
    tables = cell_tables()
    found = joining.said_by_corners(lattice)
    for number, x, y, z in np.argwhere(np.ones_like(found)):
        block = lattice[number, 2 * x : 2 * x + 3, 2 * y : 2 * y + 3, 2 * z : 2 * z + 3]
        mask = sum(int(block[c[0] * 2, c[1] * 2, c[2] * 2]) << i for i, c in enumerate(CORNERS))
        single = tables.components[tables.case[mask, 0]] == 1 and not tables.ambiguous[mask].any()
        assert found[number, x, y, z] == (single and agreeing(block))
    assert 0.1 < found[:30].mean() < 0.9


def test_flat_faces_have_few_triangles():
    block = Box(2.0, 2.0, 1.0)
    equal, joined = at_step(block, 0.03, None), at_step(block, 0.03, 0.001)
    assert joined.looked_at.sampled == equal.looked_at.sampled
    assert len(joined.made.triangles) < 0.3 * len(equal.made.triangles)
    assert joined.error < 1e-9 and sum(joined.joined) > 0
    sound(joined.made)


@pytest.mark.parametrize("seed", range(4))
def test_whatever_is_joined_and_divided_stays_closed(seed):
    kind = ("linear", "cubes")[seed % 2]
    shape = noise(kind, seed, (0.3, 0.25)[seed % 2], (1.0, 30.0)[seed % 2])
    found = at_step(shape, 0.04, 1.0)
    assert found.tree is not None and sum(found.joined) > 50
    sound(found.made)
    rng = np.random.default_rng(seed)
    tree = found.tree
    size = found.topology.points.size
    level = tree.base + np.log2(found.topology.unit / size).astype(np.int64)
    keys = keys_of(found.topology.points.cell // size[:, None])
    chosen = rng.random(len(keys)) < 0.05
    parted = tuple(keys[chosen & (level == number)] for number in range(tree.levels))
    topology, tree = topology_of_tree(tree.with_divided(parted))
    lattice, watch = tree.values.lattice, lambda share: None
    extent = extent_of(shape.node, MeshRequest())
    kernels = tree.values.kernels
    made = completed(kernels, extent, lattice, topology, found.looked_at, 1.0, watch)
    assert np.count_nonzero(made.levels) > 1
    sound(made.made)


PLATE = Box(4.0, 0.4, 4.0) | Cylinder(0.05, 0.6).translate(0.71, 0.2, 0.93)


def pin_is_there():
    points = at_step(PLATE, 0.045, 0.02).made.points
    return points[:, 1].max() > 0.45


def test_a_pin_on_a_plate_is_found_and_without_its_samples_it_is_lost(monkeypatch):
    assert pin_is_there()
    made = PLATE.mesh(0.02, feature=0.08)
    assert made.report["feature"] <= 0.08 and sum(made.report["joined"]) > 0
    assert made.report["warnings"] == [] and made.report["error"]["largest"] <= 0.02
    sound(made)
    said, unsaid = joining.said_by_corners, joining._unsaid
    corners = np.flatnonzero((GRID != 1.0).all(axis=1))

    def blind(inside):
        """Join blocks whose corners are all inside or all outside, whatever is between."""
        masks = joining.corner_masks(inside[:, ::2, ::2, ::2])
        return (masks == 0) | (masks == 255) | said(inside)

    def unsaid_if_mixed(samples, size):
        inside = samples[:, corners] < 0.0
        mixed = inside.any(axis=1) & ~inside.all(axis=1)
        return np.where(mixed, unsaid(samples, size), 0.0)

    monkeypatch.setattr(joining, "said_by_corners", blind)
    monkeypatch.setattr(joining, "_unsaid", unsaid_if_mixed)
    assert not pin_is_there()


def test_lost_parts_are_those_of_equal_cells():
    thin = Sphere(1.0) | Box(3.0, 0.0001, 0.0001)
    (warning,) = thin.mesh(tolerance=0.05, feature=0.2).report["warnings"]
    assert "parts of it are missing" in warning


@pytest.mark.parametrize(
    ("shape", "tolerance"),
    [(Box(1.0, 0.7, 0.4).rotate(**TURN), 0.002), (PLATE, 0.004)],
)
def test_measuring_only_what_changed_gives_the_same_mesh(shape, tolerance, monkeypatch):
    monkeypatch.setattr(dividing, "_MOST_OF_WHOLE", 0.0)
    whole = shape.mesh(tolerance)
    monkeypatch.setattr(dividing, "_MOST_OF_WHOLE", 1.0)
    parts = shape.mesh(tolerance)
    assert np.array_equal(whole.points, parts.points)
    assert np.array_equal(whole.triangles, parts.triangles)


def test_joined_meshes_have_the_same_bytes_with_one_and_two_threads(monkeypatch):
    made = []
    for count in (1, 2):
        monkeypatch.setattr(threads, "usable_threads", lambda count=count: count)
        made.append(PLATE.mesh(0.01))
    assert sum(made[0].report["joined"]) > 0
    assert made[0].points.tobytes() == made[1].points.tobytes()
    assert made[0].triangles.tobytes() == made[1].triangles.tobytes()
