"""Glow: the halo has the light of what is beyond white, and the shape of two Gaussians."""

from __future__ import annotations

import numpy as np
import pytest

from distal import Box, Camera, Scene, emissive
from distal.diagnostics import CompileError
from distal.lang import slider
from distal.render import glow as formulas

SIZE = (240, 160)
FRONT = Camera((0.0, 0.0, 10.0))


def lamp(glow, strength=5.0, size=0.5, device="cpu", pixels=SIZE):
    shape = Box((size, size, 0.1)).paint(emissive((1.0, 0.5, 0.25), strength))
    scene = Scene(shape, lights=[], background="#000", camera=FRONT, tone_map="none", glow=glow)
    return scene.render(pixels, samples=1, device=device).linear[..., :3]


def halo(**options):
    return lamp(1.0, **options) - lamp(0.0, **options)


def test_the_halo_has_the_light_beyond_white():
    """Far from the border nothing is lost: the sum over the picture, in each color."""
    expected = np.maximum(lamp(0.0) * (1.0 - 1.0 / 5.0), 0.0).sum((0, 1))
    assert halo().sum((0, 1)) == pytest.approx(expected, rel=0.01)


def test_the_halo_is_two_gaussians():
    """The second moment of a column sum: that of both Gaussians, of the lamp and of a block."""
    found = halo(size=0.05)[..., 0].sum(0)
    x = np.arange(found.size) - np.average(np.arange(found.size), weights=found)
    moment = np.average(x * x, weights=found)
    narrow, wide = (formulas.NARROW * SIZE[1]) ** 2, (formulas.WIDE * SIZE[1]) ** 2
    share = formulas.NARROW_WEIGHT
    block = formulas.BLOCK_PX**2 / 12.0 + formulas.BLOCK_PX**2 / 6.0
    assert moment == pytest.approx(share * narrow + (1.0 - share) * wide + block, rel=0.1)


@pytest.mark.parametrize("strength", [0.2, 1.0])
def test_what_is_not_beyond_white_has_no_halo(strength):
    assert (lamp(1.0, strength) == lamp(0.0, strength)).all()


def test_a_halo_is_as_large_a_share_of_every_picture():
    """At half a lamp's width beside it, relative to the number of pixels of the lamp."""
    near = {}
    for height in (160, 320):
        pixels = (3 * height // 2, height)
        shown = halo(pixels=pixels)[..., 0] / lamp(0.0, pixels=pixels)[..., 0].mean()
        near[height] = shown[height // 2, 3 * height // 4 + height // 10]
    assert near[320] == pytest.approx(near[160], rel=0.1)


@pytest.mark.parametrize("pixels", [(1, 1), (3, 2), (5, 61)])
def test_pictures_of_any_size_have_one(pixels):
    assert np.isfinite(lamp(1.0, pixels=pixels)).all()


def test_the_reference_agrees():
    apart = np.abs(lamp(0.7, pixels=(48, 32)) - lamp(0.7, pixels=(48, 32), device="reference"))
    assert apart.max() < 1e-3


@pytest.mark.parametrize("value", [-0.1, 1.5, "much", slider("Glow", 0.5)])
def test_glow_is_a_constant_from_0_to_1(value):
    with pytest.raises(CompileError, match="glow"):
        Scene(Box(), glow=value)
