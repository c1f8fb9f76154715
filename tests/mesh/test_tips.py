"""Tips that are thinner than the cells of a mesh end where they end, within the tolerance."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import Box, Cone, Octahedron, Shape
from distal.mesh import triangle_arithmetic
from distal.mesh.kernels import rows_of

LEAN = 0.3
# A shape and the places of its tips.
TIPS = {
    "narrow cone": (Cone(0.1, 1.0), [(0.0, 0.5, 0.0)]),
    "cone aslant": (
        Cone(0.3, 1.0).rotate(z=LEAN),
        [(-0.5 * math.sin(LEAN), 0.5 * math.cos(LEAN), 0.0)],
    ),
    "octahedron": (Octahedron(1.0), [*np.eye(3), *-np.eye(3)]),
    "pit": (Box(1.2) - Cone(0.5, 1.0).rotate(x=math.pi).translate(0, 0.3, 0), [(0.0, -0.2, 0.0)]),
}


@pytest.mark.parametrize("tolerance", [0.02, 0.002])
@pytest.mark.parametrize("name", TIPS)
def test_tips_are_as_close_as_the_tolerance_says(name: str, tolerance: float):
    shape: Shape
    shape, tips = TIPS[name]
    mesh = shape.mesh(tolerance=tolerance)
    corners = mesh.points[mesh.triangles]
    for tip in tips:
        places = np.broadcast_to(np.asarray(tip, float), (len(corners), 3))
        away = rows_of(triangle_arithmetic.distance_to_triangle, places, *corners.swapaxes(0, 1))
        assert away.min() <= tolerance
    assert mesh.report["error"]["cut_corner"] <= tolerance and not mesh.report["warnings"]
