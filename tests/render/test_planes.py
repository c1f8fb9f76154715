"""Planes end at the true horizon: against the rays of the camera, computed here."""

from __future__ import annotations

import numpy as np
import pytest

from distal import Box, Camera, HalfSpace, OrthographicCamera, Plane, Scene, Sphere

UP = np.array([0.0, 1.0, 0.0])


def rays(eye, target, size, fov_deg=40.0):
    """The directions through the middles of all pixels, top row first."""
    width, height = size
    ahead = np.subtract(target, eye) / np.linalg.norm(np.subtract(target, eye))
    right = np.cross(ahead, UP) / np.linalg.norm(np.cross(ahead, UP))
    up = np.cross(right, ahead)
    x = (2.0 * (np.arange(width) + 0.5) - width) / height
    y = -(2.0 * (np.arange(height) + 0.5) - height) / height
    focal = 1.0 / np.tan(np.radians(fov_deg) / 2.0)
    ways = x[None, :, None] * right + y[:, None, None] * up + focal * ahead
    return ways / np.linalg.norm(ways, axis=-1, keepdims=True)


@pytest.mark.parametrize("size", [(64, 48), (31, 333), (97, 5), (1, 1)])
@pytest.mark.parametrize(
    ("eye", "target"),
    [
        ((0.0, 1.0, 5.0), (0.0, 0.9, 0.0)),
        ((3.0, 2e-3, 5.0), (0.0, 0.0, 0.0)),
        ((0.0, 3e4, 5.0), (1e5, 1e4, -3e5)),
    ],
)
def test_a_plane_ends_at_the_true_horizon(size, eye, target):
    scene = Scene(Plane() | Sphere(1e-4).translate(y=-1.0), camera=Camera(eye, target))
    picture = scene.render(size, samples=1, transparent=True, layers=("depth",))
    ways = rays(eye, target, size)
    # 32-bit rays: directions within 1e-6 of the horizon may be on either side of it.
    clear = np.abs(ways[..., 1]) > 1e-6
    falls = ways[..., 1] < 0.0
    assert (picture.array[..., 3] == falls)[clear].all()
    met = clear & falls & (ways[..., 1] < -1e-4)
    expected = -eye[1] / ways[..., 1]
    depth = picture.layers["depth"].reshape(picture.array.shape[:2])
    assert depth[met] == pytest.approx(expected[met], rel=3e-3)


def test_tilted_planes_meet_where_their_equations_say():
    normals = [(0.6, 0.8, 0.0), (-0.48, 0.8, 0.36)]
    eye, target, size = (0.3, 2.0, 4.0), (0.0, 0.5, 0.0), (40, 30)
    scene = Scene(
        [HalfSpace(normals[0], -0.5).translate(0.1, 0.2, 0.3), HalfSpace(normals[1], 0.2)],
        camera=Camera(eye, target),
    )
    ways = rays(eye, target, size)
    expected = np.full(ways.shape[:2], np.inf)
    offsets = [-0.5 + float(np.dot(normals[0], (0.1, 0.2, 0.3))), 0.2]
    for normal, offset in zip(normals, offsets, strict=True):
        fall = -ways @ np.array(normal)
        t = (np.dot(eye, normal) - offset) / np.where(fall > 0.0, fall, np.nan)
        expected = np.fmin(expected, t)
    picture = scene.render(size, samples=1, transparent=True, layers=("depth",))
    found = np.isfinite(expected)
    assert (picture.array[..., 3] == found).all()
    depth = picture.layers["depth"].reshape(picture.array.shape[:2])
    assert depth[found] == pytest.approx(expected[found], rel=1e-5)


@pytest.mark.parametrize("turned", [Plane(), Plane().rotate(x=0.0).scale(3.0)])
def test_a_plane_seen_without_perspective(turned):
    camera = OrthographicCamera((0.0, 5.0, 5.0), (0.0, 0.0, 0.0), height=2.0)
    picture = Scene(turned, camera=camera).render((6, 4), samples=1, layers=("depth",))
    y = -(2.0 * (np.arange(4) + 0.5) - 4.0) / 4.0
    heights = 5.0 + y * np.sqrt(0.5)
    assert np.squeeze(picture.layers["depth"])[:, 2] == pytest.approx(heights * np.sqrt(2.0))


def test_what_stands_before_a_plane_hides_it_and_far_limits_it():
    shape = Plane() | Box(1.0).translate(y=0.5)
    camera = Camera((0.0, 1.0, 6.0), (0.0, 0.5, 0.0))
    size = (64, 48)
    ways = rays((0.0, 1.0, 6.0), (0.0, 0.5, 0.0), size)
    near = Scene(shape, camera=camera, far=20.0).render(
        size, samples=1, transparent=True, layers=("depth",)
    )
    t = np.where(ways[..., 1] < 0.0, -1.0 / np.minimum(ways[..., 1], -1e-9), np.inf)
    depth = np.squeeze(near.layers["depth"])
    assert depth[24, 32] == pytest.approx(5.5, abs=0.03)
    sides = np.abs(ways[..., 0]) * 6.0 > 0.9
    assert (near.array[..., 3] == (t < 20.0))[sides & (np.abs(t - 20.0) > 1e-3)].all()


def test_a_camera_below_the_plane_is_inside_a_solid():
    scene = Scene(Plane(), camera=Camera((0.0, -1.0, 5.0), (0.0, -2.0, 0.0)))
    with pytest.warns(UserWarning, match="the camera is inside 'Plane'"):
        scene.render((16, 12), samples=1)
