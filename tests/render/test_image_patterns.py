"""Pictures laid on shapes: one whose colors are its own coordinates shows where it was read."""

from __future__ import annotations

import numpy as np
import pytest

from distal.lang import Texture2D, func, vec3
from distal.render import patterns

SIDE = 64
ROWS, COLUMNS = np.mgrid[0:SIDE, 0:SIDE]
# Red goes right and green goes up, 0 to 1 from edge to edge.
PICTURE = Texture2D(
    np.stack([(COLUMNS + 0.5) / SIDE, 1.0 - (ROWS + 0.5) / SIDE, 0.0 * ROWS], axis=-1)
)
SIZE = 1.7
POINTS = np.random.default_rng(3).uniform(-1.0, 1.0, (400, 3))
X, Y, Z = POINTS.T
ACROSS = np.hypot(X, Z)


@func
def planar(p: vec3) -> vec3:
    return patterns.image_planar(p, PICTURE, 1.7)


@func
def spherical(p: vec3) -> vec3:
    return patterns.image_spherical(p, PICTURE, 1.7)


@func
def cylindrical(p: vec3) -> vec3:
    return patterns.image_cylindrical(p, PICTURE, 1.7)


@func
def triplanar(p: vec3, n: vec3) -> vec3:
    return patterns.image_triplanar(p, n, PICTURE, 1.7)


def shown(found: np.ndarray, u: np.ndarray, v: np.ndarray) -> None:
    """What is read at (u, v): a picture repeats, and between its ends the colors run back."""
    wanted = np.mod(np.stack([u, v], axis=1) / SIZE + 0.5, 1.0)
    inner = ((wanted > 1.0 / SIDE) & (wanted < 1.0 - 1.0 / SIDE)).all(axis=1)
    assert inner.sum() > 300
    np.testing.assert_allclose(found[inner, :2], wanted[inner], atol=1e-6)


def test_planar_lies_across_z() -> None:
    shown(planar(POINTS), X, Y)


def test_spherical_goes_by_longitude_and_latitude() -> None:
    shown(spherical(POINTS), np.arctan2(X, Z) / (2.0 * np.pi), np.arctan2(Y, ACROSS) / np.pi)


def test_cylindrical_goes_by_longitude_and_height() -> None:
    shown(cylindrical(POINTS), np.arctan2(X, Z) / (2.0 * np.pi), Y)


@pytest.mark.parametrize(("axis", "u", "v"), [(0, Z, Y), (1, X, Z), (2, X, Y)], ids=["x", "y", "z"])
def test_triplanar_lies_across_the_axis_that_a_face_looks_along(
    axis: int, u: np.ndarray, v: np.ndarray
) -> None:
    for side in (-1.0, 1.0):
        normals = np.broadcast_to(side * np.eye(3)[axis], POINTS.shape)
        shown(triplanar(POINTS, normals), u, v)


def test_triplanar_blends_by_the_fourth_power_of_the_normal() -> None:
    normal = np.array([0.6, 0.48, 0.64])
    normals = np.broadcast_to(normal, POINTS.shape)
    faces = [triplanar(POINTS, np.broadcast_to(n, POINTS.shape)) for n in np.eye(3)]
    share = normal**4 / (normal**4).sum()
    wanted = sum(s * face for s, face in zip(share, faces, strict=True))
    np.testing.assert_allclose(triplanar(POINTS, normals), wanted, atol=1e-6)
