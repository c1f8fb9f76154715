"""Soft shadows in direct light of plates and strips thinner than the light, against paths."""

from __future__ import annotations

import numpy as np
import pytest

from distal import Box, Camera, DistantLight, Plane, Scene, matte

SIZE = (48, 36)


@pytest.mark.parametrize("samples", [1, 4])
@pytest.mark.parametrize(
    ("size", "angle"),
    [
        ((0.01, 0.8, 0.8), 0.4),  # a wall
        ((0.05, 0.05, 0.8), 0.1),  # a strip half as wide as the light's edge
        ((1.0, 0.002, 0.8), 1.0),  # a plate
    ],
)
def test_a_thin_plate_has_the_shadow_that_paths_find(size, angle, samples):
    scene = Scene(
        Box(size).translate(0, 0.9, 0).paint(matte((0, 0, 0))) | Plane().paint(matte((1, 1, 1))),
        lights=[DistantLight((0.6, 1, 0.2), angle=angle, intensity=3)],
        camera=Camera((0, 6, 0.01), target=(0, 0, 0), fov_deg=50),
        background=(0, 0, 0),
    )
    exact = scene.render(size=SIZE, mode="path", spp=256).linear[..., 0]
    found = scene.render(size=SIZE, samples=samples).linear[..., 0]
    error = (found - exact) / exact.max()
    assert (exact < 0.9 * exact.max()).mean() > 0.005  # there is a shadow
    assert np.sqrt(np.mean(error**2)) < 0.035
    assert abs(error.mean()) < 0.01
