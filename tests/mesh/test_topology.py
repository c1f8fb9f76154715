"""Every mesh is closed, oriented, manifold and free of self-intersections."""

from __future__ import annotations

import numpy as np
import pytest

import distal
from distal import Shape
from distal.lang import func, vec3
from distal.mesh import places, triangle_arithmetic, triangulate
from distal.mesh.checks import checked, intersections, open_edges, pinched_points
from distal.mesh.exact import intersect
from distal.mesh.kernels import rows_of
from distal.mesh.lattice import Lattice
from tests.mesh.noise_fields import at_spacing, noise

CLEAN = {"open_edges": 0, "pinched_points": 0, "intersections": 0}
# Kind, seed, size of the noise, declared slope, spacing. The slopes are false.
FIELDS = [
    ("linear", 1, 0.07, 5.0, 0.06),
    ("linear", 2, 0.05, 2.0, 0.05),
    ("linear", 3, 0.11, 3.0, 0.06),
    ("cubes", 4, 0.05, 1.5, 0.05),
    ("cubes", 5, 0.08, 2.0, 0.06),
]


@pytest.mark.parametrize(("kind", "seed", "size", "slope", "step"), FIELDS)
def test_noise_gives_a_clean_mesh(
    kind: str, seed: int, size: float, slope: float, step: float
) -> None:
    found = at_spacing(noise(kind, seed, size, slope), step, tolerance=0.02)
    points, triangles = found.made.points, found.made.triangles
    assert found.shared > 50 and len(triangles) > 2000
    assert checked(points, triangles) == CLEAN
    # Files hold 32 bits.
    assert checked(points.astype(np.float32).astype(np.float64), triangles) == CLEAN


@func
def wall(p: vec3, at: float = 0.0) -> float:
    """A ball that ends at a wall, without a slope: -1 inside, 1 outside."""
    return -1.0 if p.x * p.x + p.y * p.y + p.z * p.z < 0.16 and p.x < at else 1.0


def test_a_lattice_point_of_two_bricks_has_one_sign() -> None:
    # The wall is between what two ways to compute a face's x give: they differ by rounding.
    step, low = 0.029, np.full(3, -0.5)
    lattice = Lattice.over(low, -low, step)
    ends = [(lattice.places([[8 * n, 0, 0]])[0, 0], n) for n in (1, 2)]
    for true, n in ends:
        other = lattice.places([[8 * n - 8, 0, 0]])[0, 0] + 8.0 * step
        box = (tuple(low), tuple(-low))
        between = Shape.from_function(wall, at=max(true, other), slope=50.0, bounds=box)
        found = at_spacing(between, step)
        assert open_edges(found.made.triangles) == 0
    assert any(lattice.places([[8 * n - 8, 0, 0]])[0, 0] + 8.0 * step != x for x, n in ends)


def test_orientation_is_outwards() -> None:
    found = at_spacing(distal.Sphere(1.0), 0.2)
    corners = found.made.points[found.made.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("ij,ij->i", normals, corners.mean(axis=1)) > 0.0).all()


def test_without_the_regions_triangles_intersect(monkeypatch: pytest.MonkeyPatch) -> None:
    # The same noise with points anywhere in their cells: this test can fail.
    def anywhere(lattice, topology, mean, found, rows):  # type: ignore[no-untyped-def]
        return found[rows]

    monkeypatch.setattr(places, "_in_regions", anywhere)
    found = at_spacing(noise(*FIELDS[0][:4]), FIELDS[0][4], tolerance=0.02)
    assert intersections(found.made.points, found.made.triangles) > 0


def test_without_points_on_faces_triangles_intersect(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(kernels, lattice, topology, places, reach, tolerance):  # type: ignore[no-untyped-def]
        return np.zeros(len(topology.segments.lower), np.bool_)

    monkeypatch.setattr(triangulate, "_open_segments", never)
    found = at_spacing(noise(*FIELDS[0][:4]), FIELDS[0][4], tolerance=0.02)
    assert checked(found.made.points, found.made.triangles) != CLEAN


# The checks themselves

TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
CORNERS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])


def test_checks_of_a_tetrahedron() -> None:
    assert checked(CORNERS, TETRAHEDRON) == CLEAN
    assert open_edges(TETRAHEDRON[:3]) == 3
    turned = TETRAHEDRON.copy()
    turned[0] = turned[0][::-1]
    assert open_edges(turned) == 3


def test_two_tetrahedra_at_one_point_are_pinched() -> None:
    other = np.where(TETRAHEDRON > 0, TETRAHEDRON + 3, 0)
    both = np.concatenate([TETRAHEDRON, other])
    assert pinched_points(both, 7) == 1
    assert open_edges(both) == 0


def test_two_tetrahedra_that_overlap_intersect() -> None:
    both = np.concatenate([TETRAHEDRON, TETRAHEDRON + 4])
    apart = np.concatenate([CORNERS, CORNERS + 2.0])
    assert intersections(apart, both) == 0
    assert intersections(np.concatenate([CORNERS, CORNERS + 0.1]), both) > 0


BASE = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("other", "shared", "expected"),
    [
        ([[0.2, 0.2, -1], [0.2, 0.2, 1], [2, 2, 0]], 0, True),  # through the inside
        ([[0.2, 0.2, 0], [0.2, 0.2, 1], [0.3, 0.2, 1]], 0, True),  # a corner on the face
        ([[0.2, 0.2, 1e-15], [0.2, 0.2, 1], [0.3, 0.2, 1]], 0, False),  # barely above it
        ([[0.2, 0.2, 0], [0.3, 0.2, 0], [0.2, 0.3, 0]], 0, True),  # within the same plane
        ([[1, 1, 0], [2, 1, 0], [1, 2, 0]], 0, False),  # beside it in the same plane
        ([[0, 0, 0], [-1, 0, 0], [0, -1, 0]], 1, False),  # across a common corner
        ([[0, 0, 0], [2, 1, 1], [2, 1, -1]], 1, True),  # through the opposite side
        ([[0, 0, 0], [1, 0, 0], [0, -1, 0]], 2, False),  # flat beside a common side
        ([[0, 0, 0], [1, 0, 0], [0.3, 2, 0]], 2, True),  # folded onto it
        ([[0, 0, 0], [1, 0, 0], [0.3, 2, 1e-300]], 2, False),  # nearly folded
    ],
)
def test_exact_pairs(other: list[list[float]], shared: int, expected: bool) -> None:
    assert intersect(BASE, other, shared) is expected


def test_vector_code_agrees_with_integers() -> None:
    # What vector code calls apart must be apart; it may leave pairs undecided.
    rng = np.random.default_rng(5)
    corners = rng.integers(0, 4, (400, 2, 3, 3)).astype(np.float64)
    corners[:200, 1, 0] = corners[:200, 0, 0]
    shared = np.arange(400) < 200
    columns = [corners[:, i, j] for i in range(2) for j in range(3)]
    apart = rows_of(triangle_arithmetic.are_apart, *columns, shared)
    assert apart.sum() > 50
    for (a, b), one, is_apart in zip(corners, shared, apart, strict=True):
        if is_apart:
            assert not intersect(a.tolist(), b.tolist(), int(one))
