"""The floor of a look touches what stands on it, and cuts nothing of it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import distal
from distal import Box, Capsule, Plane, Scene, Sphere, place, time
from distal.lang import slider
from distal.lang.runtime_access import executor
from distal.packages import PackageError
from distal.scene.lowering.union_parts import parts_of
from distal.scene.objects import lowest_point
from distal.scene.objects.lowest_point import lowest_height

TILTED = -(math.cos(0.7) + 0.3)  # of a capsule of the radius 0.3 whose ends are 1 from the middle


def floor_of(scene: Scene) -> float:
    """The height of the look's floor."""
    (floor,) = [part for part in parts_of(scene.shape.node) if part.label == "floor"]
    return -float(distal.Shape._of(floor)([[0.0, 0.0, 0.0]])[0])


MADE: dict[str, Callable[[], Any]] = {
    "smooth": lambda: Sphere(1.0).union(Sphere(0.8).translate(1.2, 0.0, 0.0), smooth=0.3),
    "smooth with a flat face": lambda: Box(1.0, 2.0, 1.0).union(Sphere(0.6), smooth=0.2),
    "tilted": lambda: Capsule(0.3, 2.0).rotate(z=0.7),
    "in a region": lambda: Sphere(1.0).where(Box(1.4), lambda s: s.round(0.2)),
    "twisted": lambda: Box(1.0, 2.0, 1.0).twist(1.0).rotate(x=0.5),
    "cut": lambda: (Sphere(1.0) - Box(4.0, 2.0, 4.0).translate(0.0, -1.4, 0.0)).rotate(z=0.4),
}


@pytest.mark.parametrize("name", MADE)
def test_the_floor_touches_and_cuts_nothing(name: str) -> None:
    shape = MADE[name]()
    low, high = (np.array(corner) for corner in shape.bounds())
    height, radius = floor_of(Scene(shape)), float(np.linalg.norm(high - low)) / 2.0
    lowest = shape.extents()[0][1]
    assert lowest - 0.012 * radius <= height <= lowest + 1e-4 * radius
    below = np.random.default_rng(5).uniform(low, high, (100_000, 3))
    below[:, 1] = np.random.default_rng(6).uniform(low[1] - 0.1, height, len(below))
    assert float(shape(below).min()) > -1e-4 * radius


def test_a_height_in_closed_form() -> None:
    assert floor_of(Scene(MADE["tilted"]())) == pytest.approx(TILTED, abs=3e-3)
    # The lowest of two balls that melt into each other is the larger ball's, up to what melts.
    assert -1.08 < floor_of(Scene(MADE["smooth"]())) < -1.0


def test_the_lowest_of_several_parts_counts() -> None:
    tilted = MADE["tilted"]()
    assert floor_of(Scene(tilted | Sphere(0.2).translate(2.0, -1.0, 0.0))) == pytest.approx(
        -1.2, abs=1e-3
    )
    lower = Scene(tilted | Sphere(0.2).translate(2.0, -0.85, 0.0))
    assert floor_of(lower) == pytest.approx(TILTED, abs=3e-3)


def test_what_moves_or_changes() -> None:
    # What moves keeps the height of its box, in which it may come anywhere.
    low = Capsule(0.3, 2.0).rotate(z=0.7 + 0.0 * time).bounds()[0][1]
    assert floor_of(Scene(Capsule(0.3, 2.0).rotate(z=0.7 + 0.0 * time))) == pytest.approx(
        low, abs=1e-3
    )
    # A parameter has its default, or the value that the picture is framed for.
    turn = slider("Turn", 0.7, 0.0, 1.5)
    assert floor_of(Scene(Capsule(0.3, 2.0).rotate(z=turn))) == pytest.approx(TILTED, abs=3e-3)
    other = Scene.of_shape(Capsule(0.3, 2.0).rotate(z=turn), {"turn": 0.2}, 0.0)
    assert floor_of(other) == pytest.approx(-(math.cos(0.2) + 0.3), abs=3e-3)
    waving = Sphere(0.5 + 0.1 * np.sin(9.0 * place.y + time)).rotate(z=0.7)
    below = 0.002 * max(b - a for a, b in zip(*waving.bounds(), strict=True))
    assert abs(floor_of(Scene(waving)) - waving.bounds()[0][1]) < 10.0 * below


def test_each_part_has_its_own_parameters() -> None:
    first, second = slider("First", 0.7, 0.0, 1.5), slider("Second", 0.4, 0.0, 1.5)
    left = Capsule(0.3, 2.0).rotate(z=first)
    both = left | Capsule(0.3, 2.0).rotate(z=second).translate(2.0, 0.0, 0.0)
    scene = Scene.of_shape(both, {"first": 0.2, "second": 0.3}, 0.0)
    assert floor_of(scene) == pytest.approx(-(math.cos(0.2) + 0.3), abs=3e-3)


def test_without_numpy_it_is_the_box(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> Any:
        raise PackageError(f"no {name}")

    monkeypatch.setattr(lowest_point, "imported", missing)
    shape = MADE["tilted"]()
    assert floor_of(Scene(shape)) == pytest.approx(shape.bounds()[0][1], abs=1e-3)


def values_of(shape: Any) -> Callable[[Any], Any]:
    return lambda p: executor().call(shape, (p,), {}, device="reference")


@pytest.mark.parametrize("count", [0, 100])
def test_without_work_the_box_is_kept(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lowest_point, "_MOST_VALUES", count)
    shape = MADE["tilted"]()
    low, high = shape.bounds()
    assert lowest_height(values_of(shape), 1.0, low, high, np) == low[1]


def test_a_thin_foot_is_found_or_the_floor_stays_below_it() -> None:
    thin = Sphere(1.0).union(Box(0.004, 1.0, 0.004).translate(0.37, -1.0, 0.21), smooth=0.05)
    height = floor_of(Scene(thin))
    assert -1.56 < height <= -1.5 + 1e-3


def test_an_infinite_scene_has_no_floor() -> None:
    assert not Scene(Plane()).has_floor
