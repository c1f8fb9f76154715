"""Functions of the library are lowered once: what comes of them stays the same."""

import pytest

from distal import Box, Scene, Shape, Sphere, load
from distal.frontend import lower
from distal.frontend.lowering import scene_calls
from distal.ir.printer import print_module
from distal.lang import func, length, struct, vec3
from distal.session import SESSION

SCENES = ("raymarcher_objects", "city", "wine", "still_life", "bunny")


def text_of(obj) -> str:
    return print_module(lower(obj))


def fresh(obj) -> str:
    SESSION.fresh()
    return text_of(obj)


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_is_the_same_whatever_was_lowered_before(name):
    scene = load(f"example:{name}")
    expected = fresh(scene)
    assert text_of(scene) == expected
    SESSION.fresh()
    for other in SCENES:
        if other != name:
            lower(load(f"example:{other}"))
    assert text_of(scene) == expected


def test_the_second_time_no_function_of_the_library_is_lowered(monkeypatch):
    scene = Scene(Sphere(0.5))
    lower(scene)
    lowered = []
    real = scene_calls.lower_function
    monkeypatch.setattr(
        scene_calls, "lower_function", lambda *a: (lowered.append(a[1].name), real(*a))[1]
    )
    lower(Scene(Sphere(0.25)))
    assert lowered == []


@func
def highlight(p: vec3) -> float:
    return length(p) - 0.5


@struct
class Surface:
    size: float


@func
def ball(p: vec3) -> float:
    return length(p) - Surface(0.5).size


@pytest.mark.parametrize("own", [highlight, ball], ids=["function", "struct"])
def test_a_name_that_the_author_took_is_not_taken_again(own):
    mine = Shape.from_function(own, slope=1.0, bounds=((-1, -1, -1), (1, 1, 1)))
    scene = Scene(mine.union(Box(0.4), Sphere(0.3)))
    expected = fresh(scene)
    SESSION.fresh()
    lower(Scene(Box(0.4).union(Sphere(0.3), Sphere(0.2))))
    assert text_of(scene) == expected
