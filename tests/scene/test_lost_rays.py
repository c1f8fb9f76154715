"""Rays that end without an answer are counted, and a picture that lost many warns once."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from distal import Box, Camera, DistantLight, Plane, RoundBox, Scene, Sphere
from distal.render.lost_rays import LOWEST, MARK

SIZE = (64, 48)
FRONT = Camera((0.0, 0.0, 6.0))


def told(scene, **options):
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        picture = scene.render(SIZE, **options)
    return picture, [str(w.message) for w in found]


def lattice():
    return Sphere(0.2).repeat((4.0, 4.0, 4.0))


@pytest.mark.parametrize("samples", [None, 1, 4])
def test_a_picture_that_answers_every_ray_says_nothing(samples):
    scene = Scene(Sphere() | Plane(y=-1.0), lights=DistantLight((1, 2, 3)), camera=FRONT)
    picture, messages = told(scene, samples=samples)
    assert all(share < 1e-3 for share in picture.stats["lost"].values())
    assert messages == []


def test_rays_that_run_out_of_steps_are_counted():
    """With two steps no ray gets to a ball that fills most of the picture."""
    camera = Camera((0.0, 0.0, 2.2))
    block = RoundBox((1.9, 1.9, 1.9), 0.05).rotate(y=0.7)
    scene = Scene(block, camera=camera, steps=2, shadows=False,
                  lights=DistantLight((1, 2, 3)), background="#fff")  # fmt: skip
    picture, messages = told(scene, samples=1)
    whole = Scene(scene.shape, camera=camera, shadows=False, lights=DistantLight((1, 2, 3)),
                  background="#fff")  # fmt: skip
    hit = whole.render(SIZE, samples=1, transparent=True).array[..., 3] > 0.0
    found = scene.render(SIZE, samples=1, transparent=True).array[..., 3] > 0.0
    # Exactly the rays that should have hit something, and did not; some that pass the edges.
    missed = float((hit & ~found).mean())
    assert missed > 0.05
    assert missed <= picture.stats["lost"]["steps"] <= missed + 0.2
    (message,) = messages
    assert "of the pixels rays used up their 2 steps before they met a surface: give steps=4" in (
        message
    )


def test_rays_that_the_far_limit_ends_are_counted():
    scene = Scene(lattice(), lights=DistantLight((1, 2, 3)), camera=FRONT, far=15.0,
                  shadows=False, background="#fff")  # fmt: skip
    picture, messages = told(scene, samples=1)
    open_rays = scene.render(SIZE, samples=1, transparent=True).array[..., 3] == 0.0
    assert 0.2 * open_rays.mean() < picture.stats["lost"]["far"] <= open_rays.mean()
    assert ["a larger far, or fog that hides what is far away" in m for m in messages] == [True]


def test_a_plane_that_ends_a_ray_is_no_limit():
    scene = Scene(Sphere(0.1) | Plane(y=-1.0), lights=DistantLight((1, 2, 3)), camera=FRONT)
    assert scene.render(SIZE, samples=1).stats["lost"] == {}


def test_rays_to_a_light_are_counted():
    """A light just above a row of a thousand posts: its rays pass many of them, in few steps."""
    posts = Box((0.2, 0.5, 0.2)).repeat((0.25, 0.0, 0.25), count=(40, 1, 40))
    scene = Scene(posts, lights=DistantLight((1.0, 0.02, 0.3)), camera=Camera((0.0, 4.0, 8.0)),
                  steps=30)  # fmt: skip
    picture, messages = told(scene, samples=1)
    assert picture.stats["lost"]["shadow steps"] > 1e-3
    assert "rays to a light used up their steps" in " ".join(messages)


@pytest.mark.parametrize("transparent", [False, True])
def test_marks_do_not_change_a_picture(transparent):
    """The marks are taken out of alpha, whatever it is."""
    camera = Camera((0.0, 0.0, 2.2))
    scene = Scene(Box(1.9).rotate(y=0.7), camera=camera, steps=3, lights=DistantLight((1, 2, 3)))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for samples in (1, 4, None):
            alpha = scene.render(SIZE, samples=samples, transparent=transparent).array[..., 3]
            assert alpha.min() >= 0.0 and alpha.max() <= 1.0
            if not transparent:
                assert (alpha == 1.0).all()


def test_marks_and_alphas_do_not_overlap():
    """The smallest alpha of one mark is above the largest of the mark before it."""
    assert MARK - 1.0 > 1.0
    assert np.floor((np.array([-1.0, 1.0]) + LOWEST) / MARK).tolist() == [0.0, 0.0]
