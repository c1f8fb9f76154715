"""Meshes with known volumes, for tests of files and of shapes from meshes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Sample:
    points: NDArray[Any]
    triangles: NDArray[Any]
    normals: NDArray[Any] | None = None
    colors: NDArray[Any] | None = None
    triangle_colors: NDArray[Any] | None = None
    name: str = "part"


def box(size: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> tuple[NDArray[Any], NDArray[Any]]:
    """Points and outward triangles of a box centered at the origin."""
    bits = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)])
    quads = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return (bits - 0.5) * np.array(size), np.array(triangles)


def sphere(levels: int, radius: float = 1.0) -> tuple[NDArray[Any], NDArray[Any]]:
    """Points and outward triangles of an octahedron divided ``levels`` times, on a sphere."""
    points = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float)
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    triangles = np.array(faces)
    for _ in range(levels):
        edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        pairs, which = np.unique(edges, axis=0, return_inverse=True)
        middle = len(points) + which.reshape(-1, 3)
        points = np.concatenate([points, points[pairs].sum(axis=1)])
        points /= np.linalg.norm(points, axis=1, keepdims=True)
        (a, b, c), (p, q, r) = triangles.T, middle.T
        parts = [(a, p, r), (p, b, q), (r, q, c), (p, q, r)]
        triangles = np.concatenate([np.stack(part, axis=1) for part in parts])
    return points * radius, triangles


def torus(
    around: int, across: int, ring: float = 1.0, tube: float = 0.25
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Points and outward triangles of a torus about the y axis."""
    u = 2.0 * np.pi * np.arange(around)[:, None] / around
    v = 2.0 * np.pi * np.arange(across)[None] / across
    out = ring + tube * np.cos(v)
    points = np.stack([out * np.cos(u), tube * np.sin(v) + 0 * u, out * np.sin(u)], axis=-1)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    at = [
        ((i + a) % around) * across + (j + b) % across for a, b in ((0, 0), (0, 1), (1, 1), (1, 0))
    ]
    a, b, c, d = (each.reshape(-1) for each in at)
    faces = [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]
    return points.reshape(-1, 3), np.concatenate(faces)


def volume(points: NDArray[Any], triangles: NDArray[Any]) -> float:
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    return float((a * np.cross(b, c)).sum() / 6.0)
