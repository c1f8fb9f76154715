"""Noise that is removed from finished pictures."""

from __future__ import annotations

import sys
from types import SimpleNamespace

import numpy as np
import pytest

from distal import Box, Camera, Plane, PointLight, Scene, Sphere, matte
from distal.images.denoising import denoised
from distal.packages import PackageError

SIZE = (64, 48)


def scene() -> Scene:
    lamp = PointLight((1.0, 3.0, 2.0), intensity=9.0, radius=0.6)
    ball = Sphere(0.5).translate(y=0.5).paint(matte((0.8, 0.3, 0.2)))
    block = Box((0.5, 0.8, 0.5)).translate((-0.9, 0.4, 0.0))
    camera = Camera((0.0, 1.5, 4.0), (0.0, 0.4, 0.0))
    return Scene(ball | block | Plane(), lights=lamp, camera=camera)


def rendered(spp, **options):
    return scene().render(SIZE, mode="path", spp=spp, seed=2, **options)


def error(picture, truth) -> float:
    return float(np.sqrt(np.mean((picture.linear[..., :3] - truth.linear[..., :3]) ** 2)))


@pytest.fixture
def calls(monkeypatch):
    """A denoiser that darkens, and keeps what it was called with."""
    found = []

    def denoise(color, albedo, normal, **options):
        found.append((color, albedo, normal, options))
        return 0.5 * color

    monkeypatch.setitem(sys.modules, "pyoidn", SimpleNamespace(denoise=denoise))
    return found


def test_the_denoiser_gets_the_light_and_its_guides(calls):
    plain = rendered(4, layers=("albedo", "normal"))
    assert calls == []
    made = rendered(4, denoise=True)
    (color, albedo, normal, options) = calls[0]
    assert len(calls) == 1 and options == {"hdr": True}
    assert np.array_equal(color, plain.linear[..., :3])
    assert np.array_equal(albedo, np.clip(plain.layers["albedo"], 0.0, 1.0))
    assert np.array_equal(normal, plain.layers["normal"])
    assert all(a.dtype == np.float32 and a.flags.c_contiguous for a in (color, albedo, normal))
    assert np.allclose(made.linear[..., :3], 0.5 * plain.linear[..., :3])
    assert made.array[..., :3].mean() < plain.array[..., :3].mean()
    assert made.provenance.paths == {"denoise": True}


def test_a_film_keeps_the_samples_not_the_result(calls, tmp_path):
    kept = tmp_path / "a.film"
    rendered(4, denoise=True, film=kept)
    assert np.array_equal(rendered(4, film=kept).linear, rendered(4).linear)


def test_alpha_and_broken_numbers_are_kept_from_the_denoiser(calls):
    light = np.full((2, 2, 4), 2.0, np.float32)
    light[..., 3] = [[1.0, 0.5], [0.0, 1.0]]
    light[1, 1, 0] = np.nan
    light[0, 0, 1] = -0.1
    made = denoised(light, np.zeros((2, 2, 3), np.float32), np.zeros((2, 2, 3), np.float32))
    color = calls[0][0]
    assert np.isfinite(color).all() and (color >= 0.0).all()
    assert color[0, 1, 0] == 1.0 and made[0, 1, 0] == pytest.approx(1.0)
    assert np.array_equal(made[..., 3], light[..., 3])


def test_a_missing_denoiser_says_how_to_install_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyoidn", None)
    with pytest.raises(PackageError) as caught:
        rendered(65536, denoise=True)
    assert str(caught.value) == "pyoidn is missing: pip install 'distal[denoise]'"


def test_direct_light_has_no_noise():
    with pytest.raises(ValueError, match="denoise") as caught:
        scene().render((4, 4), denoise=True)
    assert str(caught.value) == "denoise is for mode 'path'"


def test_open_image_denoise_removes_noise():
    pytest.importorskip("pyoidn", reason="needs: pip install 'distal[denoise]'")
    truth, noisy, made = rendered(1024), rendered(2), rendered(2, denoise=True)
    assert error(made, truth) < 0.65 * error(noisy, truth)
    mean = truth.linear[..., :3].mean()
    assert made.linear[..., :3].mean() == pytest.approx(mean, rel=0.02)
