"""Diffuse light of surroundings, one spherical harmonic at a time: each is dimmed by its band."""

from __future__ import annotations

import numpy as np
import pytest

from distal.lang import Buffer, func, vec3
from distal.render import ambient, environment

# Of degree 0, 1 and 2; a diffuse surface leaves 1, 2/3 and 1/4 of them (Ramamoorthi, Hanrahan).
BANDS = {0: 1.0, 1: 2.0 / 3.0, 2: 1.0 / 4.0}
HARMONICS = {
    "x": (1, lambda x, y, z: x),
    "y": (1, lambda x, y, z: y),
    "z": (1, lambda x, y, z: z),
    "xy": (2, lambda x, y, z: x * y),
    "yz": (2, lambda x, y, z: y * z),
    "xz": (2, lambda x, y, z: x * z),
    "zz": (2, lambda x, y, z: 1.5 * z * z - 0.5),
    "xx-yy": (2, lambda x, y, z: x * x - y * y),
    "xx-zz": (2, lambda x, y, z: x * x - z * z),
}
WAYS = np.random.default_rng(8).normal(size=(12, 3))


@pytest.mark.parametrize("names", [("x", "y", "z"), ("xy", "yz", "xz"), ("zz", "xx-yy", "xx-zz")])
def test_each_harmonic_is_dimmed_by_its_band(names: tuple[str, ...]) -> None:
    height, width = 64, 128
    rows, columns = np.mgrid[0:height, 0:width]
    polar = np.pi * (rows + 0.5) / height
    around = 2 * np.pi * ((columns + 0.5) / width - 0.5)
    place = np.sin(polar) * np.sin(around), np.cos(polar), -np.sin(polar) * np.cos(around)
    chosen = [HARMONICS[name] for name in names]
    texels = np.stack([1.5 + shape(*place) for _, shape in chosen], axis=-1)
    table = Buffer([tuple(row) for row in environment.harmonics(texels)])

    @func
    def lit(n: vec3) -> vec3:
        return ambient.environment_ambient(n, table)

    normals = WAYS / np.linalg.norm(WAYS, axis=1, keepdims=True)
    wanted = np.stack([1.5 + BANDS[band] * shape(*normals.T) for band, shape in chosen], axis=-1)
    np.testing.assert_allclose(lit(normals), wanted, atol=1.5e-3)
