"""A mesh joins no two surfaces across a gap that is narrower than the tolerance."""

from __future__ import annotations

import pytest

from distal import Cone, Sphere
from distal.mesh import leaf_check
from tests.mesh.narrow_solids import narrow_solid, topology_of


@pytest.mark.parametrize("tolerance", [0.3, 0.5, 1.0, 1.5])
def test_a_gap_is_open_at_the_rim_of_the_smaller_face(tolerance: float):
    # One cell had a corner of the upper box and the face of the lower one, and one point for both.
    solid = narrow_solid("gap", 1000)
    made = solid.shape.mesh(colors=False, tolerance=tolerance)
    assert topology_of(made) == (2, 0) and made.report["warnings"] == []


def test_a_narrow_gap_between_balls_is_open():
    made = (Sphere(1.0) | Sphere(1.0).translate((2.02, 0.1, 0.2))).mesh(colors=False)
    assert topology_of(made) == (2, 0) and made.report["warnings"] == []


def test_the_tip_of_a_narrow_cone_stays_on_it():
    assert topology_of(Cone(0.1, 1.0).mesh(tolerance=0.002)) == (1, 0)


def test_what_needs_too_many_cells_is_named(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(leaf_check, "_MOST_CELLS", 0)
    made = narrow_solid("gap", 1000).shape.mesh(colors=False, tolerance=1.5)
    (said,) = made.report["warnings"]
    assert said.startswith("two surfaces may be joined across a narrow gap or wall at (")
