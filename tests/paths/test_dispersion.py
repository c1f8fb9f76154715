"""Dispersion: indices and colors by wavelength, and a prism against Snell's law in doubles."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import AmbientLight, Box, Material, Sphere, glass
from distal.lang import func, vec3
from distal.render import dispersion
from tests.paths.test_integrator import WHITE, check, estimate


def test_the_index_has_its_abbe_number():
    lines = np.float32([dispersion.BLUE_LINE, dispersion.YELLOW_LINE, dispersion.RED_LINE])
    blue, yellow, red = np.asarray(dispersion.index_at(1.62, 20 / 36.4, lines), float)
    assert yellow == pytest.approx(1.62, abs=1e-7)
    assert (yellow - 1) / (blue - red) == pytest.approx(36.4, rel=1e-4)


def test_an_even_spectrum_is_white():
    u = (np.arange(4096) + 0.5) / 4096
    colors = np.asarray(dispersion.color_of(dispersion.wavelength_of(u.astype(np.float32))), float)
    assert colors.mean(axis=0) == pytest.approx(1.0, abs=1e-5)
    # Red, green and blue are where they are expected.
    peaks = dispersion.SHORTEST + u[colors.argmax(axis=0)] * 310
    assert peaks == pytest.approx((605, 535, 448), abs=8)


@func
def height_of(direction: vec3) -> vec3:
    """Shows how steeply a ray goes down."""
    return vec3(0.5 - direction.y)


def bent_height(index, angle):
    """How steeply a level ray goes down behind a prism whose first face it meets straight."""
    out = np.arcsin(np.sin(angle) * index)
    return 0.5 + np.sin(out - angle)


@pytest.mark.parametrize("strength", [0.3, 2.0])
def test_a_prism_spreads_white_light_by_color(strength):
    """The ray enters the first face straight on and leaves through a tilted one."""
    angle = 0.5
    clear = Material(diffuse=0.0, transmission=1.0, ior=1.5, dispersion=strength)
    # The rear face is tilted about z: a block, cut by a turned one.
    block = Box((2, 2, 2)) & Box((4, 8, 8)).translate(x=-2).rotate(z=angle)
    found = estimate(block.paint(clear), (-4, 0, 0), (0, 0, 0), 256, background=height_of)
    u = (np.arange(20000) + 0.5) / 20000
    lengths = dispersion.wavelength_of(u.astype(np.float32))
    colors = np.asarray(dispersion.color_of(lengths), float)
    indices = np.asarray(dispersion.index_at(1.5, strength, lengths), float)
    expected = (colors * bent_height(indices, angle)[:, None]).mean(axis=0)
    mean, sigma = found
    assert sigma.max() < 4e-3
    assert np.abs(mean - expected).max() < 4 * sigma.max() + 1e-4, (mean, expected)
    assert np.ptp(expected) > 10 * sigma.max() or strength < 1


def test_glass_with_dispersion_keeps_white_light_white():
    for shape in (Sphere(), Box((3, 0.5, 3))):
        found = estimate(
            shape.paint(glass(dispersion=1.0)),
            (0.3, 4, 0.2),
            (0.3, 0, 0.2),
            512,
            lights=AmbientLight(1.0),
            background=WHITE,
        )
        check(found, 1.0, 8e-3)


def test_dispersion_is_not_negative():
    with pytest.raises(ValueError, match="dispersion"):
        glass(dispersion=-0.1)
    assert math.isfinite(float(dispersion.index_at(1.5, 20.0, 390.0)))
