"""Layers against closed forms: a sphere's depth and normal, painted materials by their order."""

import numpy as np
import pytest

from distal import Box, Camera, Plane, Scene, Sphere
from distal.scene.steering import Steering

WIDTH, HEIGHT = 64, 48
FOV = 0.7
EYE = np.array([0.0, 0.0, 5.0])
ALL = ("depth", "normal", "albedo", "material")


def directions():
    """The unit rays of a camera on the z axis, through the middles of pixels."""
    x, y = np.meshgrid(np.arange(WIDTH) + 0.5, HEIGHT - (np.arange(HEIGHT) + 0.5))
    ahead = np.full_like(x, -1.0 / np.tan(FOV / 2.0))
    rays = np.stack(((2.0 * x - WIDTH) / HEIGHT, (2.0 * y - HEIGHT) / HEIGHT, ahead), -1)
    return rays / np.linalg.norm(rays, axis=-1, keepdims=True)


def sphere():
    """Depth (infinite where missed) and normal of the unit sphere, in closed form."""
    along = directions() @ EYE
    root = along**2 - (EYE @ EYE - 1.0)
    depth = np.where(root > 0.0, -along - np.sqrt(np.maximum(root, 0.0)), np.inf)
    place = EYE + np.where(np.isfinite(depth), depth, 0.0)[..., None] * directions()
    return depth, place


@pytest.fixture(scope="module")
def ball():
    shape = Sphere(1.0).paint((0.25, 0.5, 1.0))
    scene = Scene(shape, camera=Camera((0, 0, 5), fov=FOV), floor=False)
    return scene.render(size=(WIDTH, HEIGHT), layers=ALL)


def facing(normal):
    """Pixels where the ray meets the sphere, not grazing it: within a march's reach of its rim."""
    return -(normal * directions()).sum(-1) > 0.3


def test_depth_is_the_way_along_the_ray(ball):
    depth, normal = sphere()
    found = ball.layers["depth"]
    assert found.dtype == np.float32
    assert found.shape == (HEIGHT, WIDTH)
    inside = np.isfinite(depth) & facing(normal)
    # 32 bits at 5 units from the eye: 24 bits of 8, a few of them lost.
    assert np.abs(found[inside] - depth[inside]).max() < 4e-6
    beside = ~np.isfinite(depth)
    rim = beside & np.isfinite(found)  # rays that pass by within a march's threshold
    assert rim.sum() < 0.01 * beside.sum()
    assert np.isposinf(found[beside & ~rim]).all()


def test_normal_is_of_the_world_and_of_length_one(ball):
    depth, normal = sphere()
    found = ball.layers["normal"]
    assert found.shape == (HEIGHT, WIDTH, 3)
    inside = np.isfinite(depth) & facing(normal)
    # Normals are asked half a threshold (5e-4 of the way) before the surface, as for shading.
    assert np.abs(found[inside] - normal[inside]).max() < 5e-3
    met = np.isfinite(ball.layers["depth"])
    assert np.allclose(np.linalg.norm(found[met], axis=-1), 1.0, atol=1e-5)
    assert (found[~met] == 0.0).all()


def test_albedo_is_linear_and_unlit(ball):
    met = np.isfinite(ball.layers["depth"])
    assert np.allclose(ball.layers["albedo"][met], (0.25, 0.5, 1.0), atol=1e-6)
    assert (ball.layers["albedo"][~met] == 0.0).all()


def test_materials_are_numbered_in_the_order_of_the_tree():
    red, blue = Sphere(0.5).paint("#ff0000"), Sphere(0.5).paint("#0000ff")
    twice = Box(0.6).paint("#00ff00")
    parts = [
        red.translate(-1.5, 0, 0),
        Sphere(0.3),  # unpainted: the scene's own material, counted where it is met first
        twice.translate(0, 1.2, 0),
        twice.translate(0, -1.2, 0),
        blue.translate(1.5, 0, 0),
    ]
    scene = Scene(parts, camera=Camera((0, 0, 5), fov=FOV), floor=False)
    found = scene.render(size=(WIDTH, HEIGHT), layers=["material"]).layers["material"]
    assert found.dtype == np.uint32
    per_unit = HEIGHT / (2.0 * 5.0 * np.tan(FOV / 2.0))

    def at(x, y):
        return found[int(HEIGHT / 2 - y * per_unit), int(WIDTH / 2 + x * per_unit)]

    assert at(-1.5, 0) == 1
    assert at(0, 0) == 2
    assert at(0, 1.2) == at(0, -1.2) == 3
    assert at(1.5, 0) == 4
    assert at(-1.8, 1.4) == 0
    assert set(np.unique(found)) == {0, 1, 2, 3, 4}


def test_blend_shows_whichever_shows_more():
    left, right = Sphere(0.8).paint("#ff0000"), Sphere(0.8).paint("#0000ff")
    shape = left.translate(-0.6, 0, 0).union(right.translate(0.6, 0, 0), smooth=0.3)
    scene = Scene(shape, camera=Camera((0, 0, 5), fov=FOV), floor=False)
    found = scene.render(size=(WIDTH, HEIGHT), layers=["material"]).layers["material"]
    row = found[HEIGHT // 2]
    met = row[row > 0]
    assert np.array_equal(met, [1] * (len(met) // 2) + [2] * (len(met) // 2))


def test_layers_do_not_depend_on_samples_and_leave_the_picture_alone():
    scene = Scene([Sphere(1.0), Plane(y=-1.0)], camera=Camera((0, 0, 5), fov=FOV))
    size = (32, 24)
    plain = scene.render(size=size)
    one = scene.render(size=size, layers=ALL)
    many = scene.render(size=size, samples=16, layers=ALL)
    assert not plain.layers
    assert np.array_equal(plain.array, one.array)
    for name in ALL:
        assert np.array_equal(one.layers[name], many.layers[name]), name


def test_layers_follow_a_camera_that_is_moved():
    scene = Scene(Sphere(1.0), camera=Camera((0, 0, 5), fov=FOV))
    near = scene.render(size=(33, 25), layers=["depth"], steering=Steering(zoom=0.5))
    assert near.layers["depth"][12, 16] == pytest.approx(1.5, abs=1e-5)


def test_the_reference_says_the_same():
    scene = Scene([Sphere(1.0).paint("#ff0000"), Plane(y=-1.0)], camera=Camera((0, 0, 5)))
    cpu = scene.render(size=(16, 12), layers=ALL).layers
    slow = scene.render(size=(16, 12), layers=ALL, device="reference").layers
    assert np.allclose(cpu["depth"], slow["depth"], rtol=1e-5)
    assert np.allclose(cpu["normal"], slow["normal"], atol=1e-3)
    assert np.array_equal(cpu["material"], slow["material"])


def test_layers_are_read_only_and_unknown_ones_are_listed(ball):
    with pytest.raises(ValueError, match="read-only"):
        ball.layers["depth"][0, 0] = 1.0
    with pytest.raises(TypeError):
        ball.layers["depth"] = 0
    scene = Scene(Sphere(1.0))
    with pytest.raises(ValueError, match=r"no layer 'dept'; layers: depth, normal, albedo, mat"):
        scene.render(size=(4, 4), layers=["dept"])


def test_progress_runs_once_from_nothing_to_all():
    told = []
    Scene(Sphere(1.0)).render(size=(64, 64), layers=ALL, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0
    assert sum(share == 1.0 for share in told) == 1
