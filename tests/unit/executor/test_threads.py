"""Several threads render at once: a scene is lowered and compiled once, and nothing breaks."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from distal import Box, Scene, Sphere
from distal.lang.render_options import RenderOptions
from distal.runtime.executor import PythonExecutor
from distal.runtime.lowered import Lowered


def test_scenes_are_lowered_by_many_threads_at_once():
    # CPython 3.11 fails when two threads build syntax trees at once.
    executor = PythonExecutor()
    scenes = [
        Scene(Sphere(0.5).union(Box(0.4 + 0.1 * i).twist(0.1), smooth=0.1), normals=way)
        for i, way in enumerate(("exact", "six_taps", "tetrahedron", "forward"))
    ]
    with ThreadPoolExecutor(8) as pool:
        options = RenderOptions(size=(8, 6))
        made = list(pool.map(lambda i: executor.render(scenes[i % 4], options), range(16)))
    for i, picture in enumerate(made):
        assert (picture.array == made[i % 4].array).all()
    assert not np.array_equal(made[0].array, made[3].array)


def test_a_function_is_lowered_once_for_all_threads(monkeypatch):
    executor, made, scene = PythonExecutor(), [], Scene(Sphere(0.7))

    def counted(function, types, _of=Lowered.of):
        made.append(function)
        return _of(function, types)

    monkeypatch.setattr("distal.runtime.executor.Lowered.of", staticmethod(counted))
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda _: executor.render(scene, RenderOptions(size=(4, 3))), range(8)))
    assert made.count(scene) == 1
