"""Moves that are taken back leave the mesh that was there before them, or a closed one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from distal import Box, Sphere, Torus
from distal.mesh.checks import checked
from distal.mesh.collapses import Collapsing, collapsed
from distal.mesh.kernels import FieldKernels
from distal.mesh.moves import take_back

SHAPES = {
    "sphere": Sphere(1.0),
    "twisted": Box(0.5, 1.0, 1.5).twist(2.0),
    "crossing": Sphere(1.0) | Torus(1.1, 0.2),
}


def collapsing(name: str) -> tuple[Collapsing, Any]:
    """A mesh that has lost its points, and its first triangles."""
    shape = SHAPES[name]
    made = shape.mesh(0.004)
    points, triangles = made.points.astype(np.float64), made.triangles.astype(np.int64)
    given = (points, triangles, np.ones(len(points), np.bool_), 0.1, np.inf, 0.1)
    mesh = Collapsing.of(FieldKernels(shape.node, {}, 0.0), *given)
    collapsed(mesh)
    return mesh, triangles


@pytest.mark.parametrize("name", SHAPES)
def test_all_moves_taken_back_leave_the_first_mesh(name: str) -> None:
    mesh, first = collapsing(name)
    assert mesh.is_left.sum() < 0.7 * len(first)
    changed = (mesh.triangles != first).any(axis=1)
    back = take_back(mesh, np.arange(len(first)), 1000)
    assert np.array_equal(back, changed)
    assert np.array_equal(mesh.triangles, first) and mesh.is_left.all()
    assert not mesh.away.any()
    own = mesh.triangles[mesh.nearest] == np.arange(len(mesh.points))[:, None]
    assert own.any(axis=1).all()
    assert not any(len(moves.triangle) or len(moves.followed.place) for moves in mesh.log)


@pytest.mark.sample(3, each="name")
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", SHAPES)
def test_some_moves_taken_back_leave_a_closed_mesh(name: str, seed: int) -> None:
    mesh, _ = collapsing(name)
    rng = np.random.default_rng(seed)
    for depth in (1, 2, 5):
        before = int(mesh.is_left.sum())
        some = rng.choice(np.flatnonzero(mesh.is_left), 3, replace=False)
        back = take_back(mesh, some, depth)
        assert back[some].any() and mesh.is_left.sum() > before
        left = mesh.triangles[mesh.is_left]
        report = checked(mesh.points, left, lambda share: None)
        assert report["open_edges"] == report["pinched_points"] == 0
        # What is followed is as far from its triangle as is said.
        assert mesh.is_left[mesh.nearest].all()
        assert mesh.away.max() <= mesh.tolerance
