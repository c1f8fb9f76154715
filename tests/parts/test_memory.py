"""What is made of a tree for its pictures lives no longer than the tree."""

from __future__ import annotations

import gc
import weakref

import pytest

from distal import Camera, Scene, Sphere, union


@pytest.mark.parametrize(("count", "smooth"), [(4, 0.0), (30, 0.0), (60, 0.0), (60, 0.02)])
def test_a_scene_that_nobody_holds_is_gone(count, smooth):
    parts = [Sphere(0.1).translate(x=0.1 * i) for i in range(count)]
    whole = union(parts, smooth=smooth) if smooth else union(parts)
    scene = Scene(whole, camera=Camera((3, 3, 4)), floor=False)
    scene.render(size=(8, 6), samples=1)
    held = weakref.ref(scene), weakref.ref(scene.shape.node), weakref.ref(parts[0].node)
    del scene, whole, parts
    gc.collect()
    assert [found() for found in held] == [None, None, None]
