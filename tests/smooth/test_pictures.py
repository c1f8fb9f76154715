"""A large smooth union looks the same with its grid of cells as without, on every target."""

from __future__ import annotations

import numpy as np
import pytest

from distal import (
    AmbientLight,
    Box,
    Camera,
    DistantLight,
    Plane,
    Scene,
    Sphere,
    checker,
    glass,
    union,
)
from distal.compiler import driver
from distal.diagnostics import CompileError
from distal.lang import slider
from distal.scene.checks.probe import probe
from distal.scene.checks.validation import check
from distal.scene.lowering.smooth import cells, grid
from distal.scene.lowering.smooth.cells import MOST_WITHOUT, celled

EYE = Camera((2.0, 2.0, 4.0), target=(0.0, 0.0, 0.0))
SUN = DistantLight((1.0, 2.0, 1.5), angle=0.05)


MANY = 16


@pytest.fixture(autouse=True)
def few_cells(monkeypatch):
    """Small grids, and for few members: without lists, these compile fast."""
    monkeypatch.setattr(grid, "CELLS_PER_ROOT", 500)
    monkeypatch.setattr(cells, "LEAST_MEMBERS", MANY)


def blob(count=MANY, smooth=0.06, **more):
    rng = np.random.default_rng(3)
    made = []
    for i in range(count):
        a = float(rng.uniform(0.1, 0.3))
        part = Sphere(a) if i % 3 else Box(a, 1.5 * a, a).rotate(x=1.0 + i)
        part = part.translate(*rng.uniform(-1, 1, 3))
        made.append(part.paint(tuple(rng.uniform(0.1, 0.9, 3))))
    return union(made, smooth=smooth, **more)


def light(shape, *, acceleration=True, device="cpu", size=(48, 36), **given):
    given = {"camera": EYE, "lights": [SUN, AmbientLight()], "ambient_occlusion": 0.4, **given}
    scene = Scene(shape, acceleration=acceleration, **given)
    return scene.render(size=size, samples=1, device=device).array.astype(float)[..., :3]


def far_off(a, b, limit=0.03):
    return float((np.abs(a - b).max(axis=-1) > limit).mean())


def test_a_scene_is_the_same_without_grids():
    shape = blob() | Plane(y=-1.3).paint(checker("red", "white", 0.5))
    assert len(celled(shape.node).grids) == 1
    a, b = (light(shape, acceleration=on) for on in (True, False))
    assert a.std() > 0.01
    assert far_off(a, b) < 0.003 and np.abs(a - b).mean() < 1e-3


@pytest.mark.parametrize("device", ["reference", "gpu", "gpu-fragment"])
def test_targets_agree(device):
    shape = (blob() | Plane(y=-1.3)).scale(0.9).rotate(y=0.3)
    a, b = light(shape, size=(12, 9)), light(shape, size=(12, 9), device=device)
    assert far_off(a, b, 0.02) < 0.01


def test_rays_that_start_inside():
    shape = blob().paint(glass(1.2, "#ddffee"))
    a, b = (light(shape, acceleration=on, ambient_occlusion=0.0) for on in (True, False))
    assert far_off(a, b) < 0.01


def test_views_show_the_values_of_the_union():
    scenes = [Scene(blob(), acceleration=on, camera=EYE, lights=SUN) for on in (True, False)]
    for view in ("slice", "material"):
        a, b = (s.render(size=(48, 36), samples=1, view=view).array / 255.0 for s in scenes)
        assert far_off(a, b) < 0.01, view


def test_probes_find_the_shape_with_the_larger_share():
    shape, near = blob(), Camera((0.8, 0.8, 1.8), target=(0.0, 0.0, 0.0))
    with_lists, without = (
        Scene(shape, acceleration=on, camera=near, lights=SUN) for on in (True, False)
    )
    leaves = set()
    for pixel in ((24, 12), (9, 7), (45, 8), (20, 18)):
        a, b = (probe(scene, pixel, size=(48, 36)) for scene in (with_lists, without))
        assert [id(node) for node in a.path] == [id(node) for node in b.path]
        assert a.material is b.material
        leaves |= {id(node) for node in a.path[-1:]}
    assert len(leaves) > 1


def test_beside_a_table_of_parts_and_below_operators():
    pegs = [Box(0.1).translate(0.25 * i - 2.0, -1.2, 1.0).paint("blue") for i in range(17)]
    shape = union([*pegs, blob().scale(0.5), Plane(y=-1.3)]) - Sphere(0.3)
    a, b = (light(shape, acceleration=on) for on in (True, False))
    assert far_off(a, b) < 0.01


def test_texts_have_the_same_size_for_any_number_of_members():
    sizes = [len(driver.compile(Scene(blob(n), camera=EYE), "wgsl").text) for n in (260, 400)]
    assert abs(sizes[0] - sizes[1]) < 200


def test_a_check_says_what_smooth_unions_have():
    found = check(blob() | Plane())
    ((report),) = found.smooth
    assert report.count == MANY and report.reason == "" and report.cells > 0
    assert 1.0 <= report.mean <= report.longest <= MANY
    assert [row.node.name for row in found.shapes].count("Sphere") == 1
    moving = check(blob(smooth=slider("size", 0.1, 0.01, 1.0)))
    assert moving.smooth[0].reason == "the size of its blend depends on parameters or time"
    assert len(moving.shapes) > MANY


def test_too_many_members_without_lists_are_refused():
    balls = [Sphere(0.1).translate(0.01 * i, 0.0, 0.0) for i in range(MOST_WITHOUT + 1)]
    shape = union(balls, smooth=0.1, blend="exponential")
    with pytest.raises(CompileError) as caught:
        shape(np.zeros((1, 3)))
    assert "2,049 shapes of a smooth union need lists for cells, but the blend 'exponential'" in (
        str(caught.value)
    )
