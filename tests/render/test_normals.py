"""Every kind of normal against the gradient of a field whose gradient is known."""

from __future__ import annotations

import numpy as np
import pytest

from distal.lang import dot, func, length, sin, vec3
from distal.render import normals

STEP = 1e-3


@func
def field(p: vec3) -> float:
    """Skew, so that no two axes are alike."""
    return length(p) + 0.3 * sin(2.0 * p.x) - dot(p, vec3(0.1, 0.4, -0.7))


@func
def exact(p: vec3) -> vec3:
    return normals.normal(field, p, normals.EXACT, 1e-3)


@func
def six(p: vec3) -> vec3:
    return normals.normal(field, p, normals.SIX_TAPS, 1e-3)


@func
def tetrahedron(p: vec3) -> vec3:
    return normals.normal(field, p, normals.TETRAHEDRON, 1e-3)


@func
def forward(p: vec3) -> vec3:
    return normals.normal(field, p, normals.FORWARD, 1e-3)


# How the error goes with the step: by the order of the differences.
KINDS = {"exact": (exact, 1e-9), "six": (six, 10 * STEP**2)}
KINDS |= {"tetrahedron": (tetrahedron, 2 * STEP), "forward": (forward, 2 * STEP)}


@pytest.mark.parametrize("kind", KINDS)
def test_a_normal_is_the_gradients_direction(kind: str) -> None:
    function, error = KINDS[kind]
    p = np.random.default_rng(6).uniform(-2.0, 2.0, (300, 3))
    p = p[np.linalg.norm(p, axis=1) > 0.7]
    gradient = p / np.linalg.norm(p, axis=1, keepdims=True) - (0.1, 0.4, -0.7)
    gradient[:, 0] += 0.6 * np.cos(2.0 * p[:, 0])
    size = np.linalg.norm(gradient, axis=1, keepdims=True)
    steep = size[:, 0] > 0.3
    assert steep.sum() > 150
    found = np.asarray(function(p))
    np.testing.assert_allclose(found[steep], (gradient / size)[steep], atol=4.0 * error)


def test_tangents_are_unit_vectors_across():
    rng = np.random.default_rng(5)
    random = rng.normal(size=(400, 3))
    # Next to straight down, where the sum of 1 and a component cancels.
    angle, near = rng.uniform(0.0, 2.0 * np.pi, 400), 10.0 ** rng.uniform(-7.0, -1.0, 400)
    down = np.stack([near * np.cos(angle), -np.sqrt(1.0 - near**2), near * np.sin(angle)], axis=1)
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    every = np.concatenate([random, down, axes])
    n = (every / np.linalg.norm(every, axis=1, keepdims=True)).astype(np.float32)
    found = normals.tangent(n)
    assert np.abs(np.linalg.norm(found, axis=1) - 1.0).max() < 1e-6
    assert np.abs(np.sum(found * n, axis=1)).max() < 1e-6
