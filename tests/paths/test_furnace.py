"""White furnaces: in a uniform surrounding of light 1, what loses nothing shows 1.

Balls and boxes of all materials side by side, so that light passes from each to the others. Colored
materials absorb: they show less, and never more.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import distal
from distal import AmbientLight, Box, Camera, Material, Scene, Sphere, union
from distal.render import named_materials

WHITE = (1.0, 1.0, 1.0)
SIDE = 12  # pixels of a cell

# Each: a material, and the largest documented loss (decision 38).
WHITES = {
    "matte": (distal.matte(WHITE), 0.0),
    "mirror": (distal.mirror(WHITE), 0.0),
    "glossy": (distal.glossy(WHITE, 0.5, 0.5, 0.0), 0.0),
    "glass": (distal.glass(), 0.0),
    "dense glass": (distal.glass(2.4), 0.0),
    "plastic": (distal.plastic(WHITE, 0.0), 0.0),
    "polished metal": (distal.metal(WHITE, 0.0), 0.0),
    "brushed metal": (distal.metal(WHITE, 0.3), 0.006),
    "rough metal": (distal.metal(WHITE, 0.7), 0.012),
    "rough plastic": (distal.plastic(WHITE, 0.5), 0.012),
}

OTHERS = ("water", "ice", "skin", "wood", "marble", "granite")
NAMED = [
    *named_materials.METALS, *named_materials.COATED, *named_materials.CLEAR, *OTHERS
]  # fmt: skip


def in_furnace(materials, kind, spp=64):
    """The mean light of cells with one solid each, and its standard error."""
    columns = math.ceil(math.sqrt(len(materials)))
    rows = math.ceil(len(materials) / columns)
    solids = []
    for i, material in enumerate(materials):
        solid = Sphere(0.4) if kind == "ball" else Box(0.55).rotate(x=0.5, y=0.6)
        place = (i % columns - 0.5 * (columns - 1), 0.5 * (rows - 1) - i // columns, 0.0)
        solids.append(solid.translate(*place).paint(material))
    eye = Camera((0.0, 0.0, 60.0), target=(0.0, 0.0, 0.0), fov=2.0 * math.atan(0.5 * rows / 60.0))
    scene = Scene(
        union(solids), lights=AmbientLight(1.0), background=WHITE, camera=eye, floor=False
    )
    size = (columns * SIDE, rows * SIDE)
    runs = []
    for seed in range(8):
        picture = scene.render(size=size, mode="path", spp=spp // 8, seed=seed)
        assert np.isfinite(picture.linear).all()
        cells = picture.linear[..., :3].reshape(rows, SIDE, columns, SIDE, 3)
        middle = cells[:, 4:8, :, 4:8].astype(float)  # within the outline
        runs.append(middle.mean(axis=(1, 3)).reshape(-1, 3)[: len(materials)])
    light = np.stack(runs)
    return light.mean(axis=0), light.std(axis=0, ddof=1) / math.sqrt(len(runs))


@pytest.mark.parametrize("kind", ["ball", "box"])
def test_white_materials_lose_nothing(kind):
    light, error = in_furnace([material for material, _ in WHITES.values()], kind)
    for name, mean, sigma in zip(WHITES, light, error, strict=True):
        loss = WHITES[name][1]
        allowed = 7.0 * sigma.max() + 1e-5  # Student's t of 7 degrees, 1 in 5000
        assert mean.max() <= 1.0 + allowed + min(loss, 0.012), (name, mean, sigma)
        assert mean.min() >= 1.0 - loss - allowed, (name, mean, sigma)
        assert sigma.max() < 0.02, name


@pytest.mark.parametrize("kind", ["ball", "box"])
def test_named_materials_show_no_more_than_there_is(kind):
    assert len(NAMED) > 40
    light, error = in_furnace([getattr(distal, name)() for name in NAMED], kind, 32)
    for name, mean, sigma in zip(NAMED, light, error, strict=True):
        assert mean.max() <= 1.012 + 7.0 * sigma.max(), (name, mean, sigma)
        assert mean.min() > 0.0, (name, mean)


@pytest.mark.parametrize(("roughness", "most"), [(0.2, 0.01), (0.3, 0.03), (0.5, 0.2)])
@pytest.mark.parametrize("kind", ["ball", "box"])
def test_rough_glass_loses_what_its_facets_pass_on(roughness, most, kind):
    """Single scattering loses at each surface, inside more than outside (decision 38)."""
    material = Material(diffuse=0.0, transmission=1.0, ior=1.5, fresnel=1.0, roughness=roughness)
    light, error = in_furnace([material], kind, 512)
    assert light.max() <= 1.0 + 7.0 * error.max()
    assert light.min() >= 1.0 - most - 7.0 * error.max()
    assert error.max() < 0.01
