"""Cameras far away: a ball has its outline and its normals, however far the rays have gone."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import Camera, DistantLight, OrthographicCamera, Scene, Sphere

SIZE = (120, 90)
HEIGHT = 2.6  # of the picture, at the ball


def cameras(away):
    eye = (0.0, 0.0, away)
    long = math.degrees(2.0 * math.atan(0.5 * HEIGHT / away))
    return OrthographicCamera(eye, height=HEIGHT), Camera(eye, fov_deg=long)


@pytest.mark.parametrize("away", [30.0, 400.0, 3700.0])
@pytest.mark.parametrize("without_perspective", [True, False])
def test_a_ball_seen_from_far_away(away, without_perspective):
    camera = cameras(away)[0 if without_perspective else 1]
    scene = Scene(Sphere(1.0), camera=camera, lights=DistantLight((1, 2, 3)), background="#000")
    picture = scene.render(SIZE, samples=1, transparent=True, layers=("normal",))
    pixel = HEIGHT / SIZE[1]
    seen = picture.array[..., 3] > 0.5
    # A ray that passes within a third of a pixel hits; 32 bits add to that at the largest distance.
    radius = math.sqrt(seen.sum() * pixel**2 / math.pi)
    assert 1.0 - 0.1 * pixel < radius < 1.0 + 0.45 * pixel + 1e-6 * away
    x = (np.arange(SIZE[0]) + 0.5 - 0.5 * SIZE[0]) * pixel
    y = (0.5 * SIZE[1] - np.arange(SIZE[1]) - 0.5) * pixel
    x, y = np.meshgrid(x, y)
    normals = picture.layers["normal"].reshape((*seen.shape, 3))
    inside = np.hypot(x, y) < 0.9
    assert np.abs(normals[..., 0] - x)[inside].max() < 0.05
    assert np.abs(normals[..., 1] - y)[inside].max() < 0.05
