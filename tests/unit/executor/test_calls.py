"""Scene functions called from Python: what is taken, as what, and what comes back."""

from __future__ import annotations

import copy
import pickle
from enum import Enum

import numpy as np
import pytest

import distal
from distal.frontend.freshness import Captured
from distal.lang import Floats, Frame, array, func, image, length, point, sin, struct, vec2, vec3

ROWS = np.arange(8.0).reshape(2, 4)
steps = [1.0, 2.0]
grid = np.array([1.0, 2.0])


@struct
class Hit:
    distance: float
    normal: vec3


@struct
class Hidden:
    _depth: float
    count: int


@func
def distance(p: vec3, radius: float = 0.5) -> float:
    return length(p) - radius


@func
def farther(hit: Hit) -> float:
    return hit.distance + 1.0


@func
def ends(values: array[float, 4]) -> float:
    return values[0] + values[3]


@func
def corners(values: array[vec2, 3]) -> vec2:
    return values[0] + values[2]


@func
def nearest(hits: array[Hit, 2]) -> float:
    return hits[0].distance + 10.0 * hits[1].distance


@func
def both(x: float) -> array[Hit, 2]:
    return [Hit(x, vec3(x)), Hit(x + 1.0, vec3(0.0))]


@func
def hidden(x: float) -> Hidden:
    return Hidden(x, 3)


@func
def twice(x: Floats) -> Floats:
    return x * 2.0


@func
def sized(x: float) -> float:
    return x


@sized.overload
def sized_vector(p: vec2) -> float:
    return p.x + p.y


@func
def first_step(x: float) -> float:
    return x + steps[0] + grid[1]


class Settings:
    gain = 0.5


@func
def settings_gain(x: float) -> float:
    return vec2(x, 2.0).x + Settings.gain


near = Hit(0.5, vec3(0.0))


@func
def beyond(x: float, hit: Hit = near) -> float:
    return x + hit.distance


@func
def beyond_the_near(x: float) -> float:
    return beyond(x)


@func
def starred(**numbers: float) -> float:
    return 1.0


target = point("Target", (0.0, 0.5, 0.0))


@image
def picture(frame: Frame) -> vec3:
    return target + frame.time


def test_float64_counts_wherever_it_is_given() -> None:
    points = np.ones((2, 3))
    assert distance(p=points).dtype == np.float64
    assert distance(points.astype(np.float32), radius=np.zeros(2)).dtype == np.float64
    assert farther(Hit(np.zeros(2), np.zeros((2, 3)))).dtype == np.float64
    assert distance(points.astype(np.float32)).dtype == np.float32


def test_arrays_have_a_row_for_each_point() -> None:
    assert ends([1, 2, 3, 4]) == 5.0
    assert ends(ROWS[0]) == 3.0
    assert ends(ROWS).tolist() == [3.0, 11.0]
    assert corners([vec2(1, 2), (3, 4), (5, 6)]) == vec2(6, 8)
    assert corners(np.arange(12.0).reshape(2, 3, 2)).tolist() == [[4.0, 6.0], [16.0, 18.0]]


def test_arrays_of_structs_go_in_and_out() -> None:
    one, two = Hit(1.0, vec3(0.0)), Hit(2.0, vec3(0.0))
    assert nearest([one, two]) == 21.0
    many = Hit(np.array([2.0, 3.0]), vec3(0.0))
    assert nearest([one, many]).tolist() == [21.0, 31.0]
    first, second = both(4.0)
    assert (first.distance, first.normal, second.distance) == (4.0, vec3(4.0), 5.0)
    assert both(np.empty(0))[1].shape == (0, 2, 3)


def test_a_field_may_begin_with_an_underscore() -> None:
    assert (hidden(2.0)._depth, hidden(2.0).count) == (2.0, 3)


def test_a_tuple_is_a_vector_and_a_list_is_many_numbers() -> None:
    assert twice((1, 2)) == twice(vec2(1, 2)) == vec2(2, 4)
    assert twice([1, 2]).tolist() == [2.0, 4.0]
    assert sized((1, 2)) == 3.0
    assert isinstance(sin((0.0, 0.0)), type(vec2(0.0, 0.0)))
    with pytest.raises(TypeError, match=r"sized\(\) does not take"):
        sized((1, 2, 3))


def test_ragged_points_are_refused_in_words() -> None:
    with pytest.raises(TypeError, match="a list whose parts differ in length"):
        distance([(1, 2, 3), (1, 2)])


def test_what_changes_inside_a_captured_list_or_array_is_seen() -> None:
    assert first_step(0.0) == 3.0
    steps[0] = 5.0
    assert first_step(0.0) == 7.0
    grid[1] = 0.0
    assert first_step(0.0) == 5.0
    steps[0], grid[1] = 1.0, 2.0


def test_what_changes_in_a_captured_class_is_seen() -> None:
    assert settings_gain(1.0) == 1.5
    Settings.gain = 2.0
    assert settings_gain(1.0) == 3.0
    Settings.gain = 0.5


def test_what_changes_in_a_captured_struct_is_seen() -> None:
    assert beyond(1.0) == beyond_the_near(1.0) == 1.5
    near.distance = 2.0
    assert beyond(1.0) == beyond_the_near(1.0) == 3.0
    near.distance = 0.5


def test_what_cannot_change_is_not_looked_at_again() -> None:
    # Else every call would lower anew.
    for function in (distance, farther, both, sized, settings_gain, beyond):
        assert Captured(function.overloads).is_fresh()
    assert not Captured(first_step.overloads).is_fresh()


def test_mistakes_in_the_definition_come_before_those_of_the_call() -> None:
    with pytest.raises(distal.CompileError, match=r"'\*\*numbers' is not part of scene code"):
        starred(1.0)


def test_functions_are_pickled_by_name_and_copied_as_themselves() -> None:
    assert pickle.loads(pickle.dumps(distance)) is distance
    assert copy.deepcopy(distance) is distance


@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        ({"size": (3.7, 2)}, TypeError, "size is"),
        ({"size": (float("inf"), 2)}, TypeError, "size is"),
        ({"time": 1e300}, ValueError, r"within 1048576 seconds \(12 days\) of 0, not 1e\+300"),
        ({"time": -1048577.0}, ValueError, r"within 1048576 seconds \(12 days\) of 0"),
        ({"time": 10**400}, ValueError, "finite"),
        ({"params": ["target"]}, TypeError, "values by name"),
        ({"threads": "2"}, TypeError, "whole number"),
        ({"threads": 2.5}, TypeError, "whole number"),
    ],
)
def test_what_cannot_be_rendered_is_refused_in_words(
    options: dict[str, object], kind: type[Exception], message: str
) -> None:
    with pytest.raises(kind, match=message):
        picture.render(**{"size": (2, 2), **options})  # type: ignore[arg-type]


def test_a_vector_is_a_point() -> None:
    pixels = picture.render(size=(1, 1), params={"target": vec3(0.1, 0.2, 0.3)}).array
    assert np.allclose(pixels[0, 0, :3], (0.1, 0.2, 0.3))


def test_only_scene_code_is_compiled() -> None:
    with pytest.raises(TypeError, match="only a scene, an @image or a @func"):
        distal.compile(len)  # type: ignore[arg-type]


class Mode(Enum):
    SOFT = 2
    HARD = 5


@func
def by_mode(x: float) -> float:
    return x * float(Mode.HARD.value) if Mode.SOFT.value == Mode.SOFT else 0.0


def test_a_member_of_an_enum_is_its_value() -> None:
    assert by_mode(2.0) == 10.0
