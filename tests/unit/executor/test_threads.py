"""Several threads render at once: a scene is lowered and compiled once, and nothing breaks.

``DISTAL_THREAD_PROCESSES=200`` tries as many nervous processes (``make sweep-threads``).
"""

from __future__ import annotations

import asyncio
import json
import os
import random
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from distal import Box, Scene, Sphere
from distal.lang.render_options import RenderOptions
from distal.runtime import kernels
from distal.runtime.executor import PythonExecutor
from distal.runtime.lowered import Lowered
from distal.session import SESSION, CompilerSession
from tests.unit.executor.threads_probe import SCENES

PROCESSES = int(os.environ.get("DISTAL_THREAD_PROCESSES", "1"))
SMALL = RenderOptions(size=(4, 3))


def probe(way: str, names: Sequence[str]) -> dict[str, list[str]]:
    """Run a fresh process of ``threads_probe`` without a cache; return its rows by name."""
    command = [sys.executable, "-m", "tests.unit.executor.threads_probe", way, *names]
    environment = {**os.environ, "DISTAL_CACHE_DIR": "off", "DISTAL_VERIFY": "1"}
    made = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=300)
    assert made.returncode == 0, made.stderr
    found = json.loads(made.stdout)
    assert not found["faults"], (names, found["faults"])
    return {row[0]: row for row in found["rows"]}


def test_texts_and_pictures_of_nervous_threads_are_those_made_alone():
    alone: dict[str, list[str]] = {}
    for seed in range(PROCESSES):
        names = random.Random(seed).sample(list(SCENES), 4)
        alone |= probe("alone", [name for name in names if name not in alone])
        assert probe("nervous", names) == {name: alone[name] for name in names}, seed


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
        list(pool.map(lambda _: executor.render(scene, SMALL), range(8)))
    assert made.count(scene) == 1


def test_a_ready_kernel_does_not_wait_for_the_compilation_of_another(monkeypatch):
    executor, ready = PythonExecutor(), Scene(Sphere(0.71))
    executor.render(ready, SMALL)
    begun, go_on = threading.Event(), threading.Event()

    def slow(*args, _make=kernels.DEVICES["cpu"]):
        begun.set()
        assert go_on.wait(60)
        return _make(*args)

    monkeypatch.setitem(kernels.DEVICES, "cpu", slow)
    with ThreadPoolExecutor(1) as pool:
        other = pool.submit(executor.render, Scene(Box(0.72)), SMALL)
        assert begun.wait(60)
        executor.render(ready, SMALL)  # hangs if anything is locked
        assert not other.done()
        go_on.set()
        assert other.result(60).array.shape == (3, 4, 4)


def test_each_thread_has_an_error_of_its_own(monkeypatch):
    executor, scene = PythonExecutor(), Scene(Sphere(0.73))

    def refuse(*_):
        time.sleep(0.01)
        raise ValueError("no")

    monkeypatch.setitem(kernels.DEVICES, "cpu", refuse)

    def attempt(_: int) -> ValueError:
        with pytest.raises(ValueError, match="no") as found:
            executor.render(scene, SMALL)
        return found.value

    with ThreadPoolExecutor(4) as pool:
        assert len({id(error) for error in pool.map(attempt, range(4))}) == 4
    monkeypatch.undo()
    assert executor.render(scene, SMALL).array.shape == (3, 4, 4)


def test_tasks_of_one_event_loop_render_in_threads():
    async def all_of_them():
        scenes = [Scene(Sphere(0.1 * k + 0.2)) for k in range(3)]
        tasks = [asyncio.to_thread(s.render, size=(4, 3), samples=1) for s in scenes * 2]
        return await asyncio.gather(*tasks)

    with ThreadPoolExecutor(1) as pool:  # in this thread another test's loop may run
        made = pool.submit(lambda: asyncio.run(all_of_them())).result()
    for first, second in zip(made[:3], made[3:], strict=True):
        assert (first.array == second.array).all()


def test_an_executor_has_what_it_can_do_and_nothing_else():
    executor = PythonExecutor()
    assert hasattr(executor, "render")
    assert not hasattr(executor, "no_such_thing")
    assert not hasattr(executor, "_no_such_thing")


def test_a_session_forgets_all_of_its_tables():
    session = CompilerSession()
    table = session.keep("words", {"a": 1})
    with pytest.raises(ValueError, match="there is a table 'words' already"):
        session.keep("words", {})
    session.fresh()
    assert table == {}


def test_a_scene_made_after_everything_was_forgotten_has_the_same_picture():
    scene = Scene(Sphere(0.5).union(Box(0.4), smooth=0.1))
    before = scene.render(size=(8, 6), samples=1).array.copy()
    SESSION.fresh()
    assert (scene.render(size=(8, 6), samples=1).array == before).all()
