"""Layers of pictures in mode "path"."""

from __future__ import annotations

import numpy as np
import pytest

from distal import Box, Camera, Plane, PointLight, Scene, Sphere, glass, matte, mirror
from distal.images import exr
from distal.images.picture_files import read

SIZE = (48, 36)
LAYERS = ("depth", "normal", "albedo", "material", "samples", "variance")


def scene(shape, **options) -> Scene:
    lamp = PointLight((2.0, 4.0, 5.0), intensity=30.0, radius=0.5)
    camera = Camera((0.0, 0.0, 6.0), (0.0, 0.0, 0.0))
    return Scene(shape, lights=lamp, camera=camera, background=(0.2, 0.2, 0.2), **options)


def rendered(shape, spp=64, **options):
    return scene(shape, floor=False).render(
        SIZE, mode="path", spp=spp, layers=LAYERS, seed=1, **options
    )


def test_albedo_and_normal_are_means_over_the_samples():
    red = Box((2.0, 2.0, 2.0)).paint(matte((0.8, 0.2, 0.1)))
    layers = rendered(red).layers
    row = layers["albedo"][SIZE[1] // 2, :, 0]
    assert row.max() == pytest.approx(0.8, abs=1e-4) and row.min() == 0.0
    edges = row[(row > 0.01) & (row < 0.79)]
    assert 1 <= len(edges) <= 4
    middle = layers["normal"][SIZE[1] // 2, SIZE[0] // 2]
    assert middle == pytest.approx((0.0, 0.0, 1.0), abs=1e-4)


def test_depth_and_material_are_those_of_the_middle():
    ball = Sphere(1.0).paint(matte((0.8, 0.2, 0.1)))
    path = rendered(ball).layers
    direct = scene(ball, floor=False).render(SIZE, layers=("depth", "material")).layers
    assert np.array_equal(path["depth"], direct["depth"])
    assert np.array_equal(path["material"], direct["material"])


def test_albedo_is_what_a_mirror_shows():
    wall = Box((20.0, 20.0, 0.2)).translate(z=8.0).paint(matte((0.1, 0.6, 0.3)))
    pane = Box((4.0, 4.0, 0.2)).paint(mirror())
    layers = rendered(pane | wall).layers
    albedo = layers["albedo"][SIZE[1] // 2, SIZE[0] // 2]
    assert albedo[1] / albedo[0] == pytest.approx(6.0, rel=1e-3)
    assert layers["normal"][SIZE[1] // 2, SIZE[0] // 2] == pytest.approx((0.0, 0.0, -1.0), abs=1e-3)


def test_albedo_is_what_is_behind_clear_glass():
    wall = Box((20.0, 20.0, 0.2)).translate(z=-4.0).paint(matte((0.1, 0.6, 0.3)))
    pane = Box((4.0, 4.0, 0.2)).paint(glass(ior=1.5))
    layers = rendered(pane | wall, 256).layers
    albedo = layers["albedo"][
        SIZE[1] // 2 - 4 : SIZE[1] // 2 + 4, SIZE[0] // 2 - 4 : SIZE[0] // 2 + 4
    ]
    # A pane passes (1 - F) / (1 + F) of the light, and shows nothing in the other share.
    passed = (1.0 - 0.04) / (1.0 + 0.04)
    assert albedo[..., 1].mean() == pytest.approx(0.6 * passed, rel=0.01)


def test_samples_and_variance_describe_each_pixel():
    ball = Sphere(1.0)
    found = rendered(ball, 48)
    assert found.layers["samples"].dtype == np.uint32
    assert (found.layers["samples"] == 48).all()
    others = [rendered_with(ball, seed) for seed in range(24)]
    spread = np.var(others, axis=0, ddof=1).mean()
    estimate = found.layers["variance"].mean()
    # Its edge has nearly all of the error: few pixels, of which no rate is taken.
    assert 0.8 * spread < estimate < 8.0 * spread


def rendered_with(shape, seed):
    picture = scene(shape, floor=False).render(SIZE, mode="path", spp=48, seed=100 + seed)
    return picture.linear[..., :3].astype(float) @ (0.2126, 0.7152, 0.0722)


def test_variance_is_unknown_after_one_sample():
    assert np.isinf(rendered(Sphere(), 1).layers["variance"]).all()


def test_an_exr_holds_them(tmp_path):
    pytest.importorskip("OpenEXR", reason="EXR files need it: pip install 'distal[exr]'")
    file = tmp_path / "ball.exr"
    made = rendered(Sphere() | Plane().translate(y=-1.0), 8, filter="mitchell", clamp=20.0)
    made.save(file, 32)
    held = exr.decode(file.read_bytes())
    assert np.array_equal(held["samples"], made.layers["samples"])
    assert np.array_equal(held["variance"], made.layers["variance"])
    assert np.array_equal(held["albedo.G"], made.layers["albedo"][..., 1])
    origin = read(file).provenance
    assert origin.layers == LAYERS
    assert origin.paths == {"filter": "mitchell", "clamp": 20.0}


def test_direct_light_has_no_samples_to_describe():
    with pytest.raises(ValueError, match="samples") as caught:
        Scene(Sphere()).render((4, 4), layers="samples")
    assert str(caught.value) == "the layer 'samples' is for mode 'path'"
