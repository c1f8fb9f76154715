"""Trees of many parts: unions that grow in a loop, arguments that are bound quickly."""

from __future__ import annotations

import dataclasses
import itertools
import math
import sys
import threading

import numpy as np
import pytest

from distal import Box, Sphere, Torus
from distal.fields.combine.joins import DIFFERENCE, UNION
from distal.fields.guarantees import Limit
from distal.fields.library import PRIMITIVES
from distal.ir.types import FLOAT, VEC3
from distal.lang import slider, vec3
from distal.scene.objects.binding import bound
from distal.scene.tree import arguments as binding
from distal.scene.tree.conversion import Asked, number, plain_number
from distal.scene.tree.errors import SceneTypeError, SceneValueError
from distal.scene.tree.node import Node


def radii(shape):
    return [child.numbers["radius"].value for child in shape.node.children]


# Unions that grow


def test_a_loop_of_unions_is_one_union_in_order():
    shape = Sphere(1.0)
    for i in range(2, 500):
        shape = shape | Sphere(float(i))
    assert shape.node.rule is UNION
    assert radii(shape) == [float(i) for i in range(1, 500)]
    assert shape.node.parts == 499


def test_each_union_of_a_loop_keeps_its_own_parts():
    made = list(itertools.accumulate(map(Sphere, map(float, range(1, 40))), lambda a, b: a | b))
    # The last ones first: what was appended after them must not be seen.
    for count, shape in reversed([*enumerate(made, 1)][1:]):
        assert radii(shape) == [float(i) for i in range(1, count + 1)]
        assert shape.node.parts == count


def test_two_unions_that_continue_one_do_not_share_parts():
    both = Sphere(1.0) | Sphere(2.0) | Sphere(3.0)
    left, right = both | Sphere(4.0), both | Sphere(5.0)
    again = left | Sphere(6.0)
    assert radii(both) == [1.0, 2.0, 3.0]
    assert radii(left) == [1.0, 2.0, 3.0, 4.0]
    assert radii(right) == [1.0, 2.0, 3.0, 5.0]
    assert radii(again) == [1.0, 2.0, 3.0, 4.0, 6.0]


def test_a_loop_of_unions_copies_no_lists(monkeypatch):
    """The number of nodes that are written grows as the number of parts, not as its square."""
    written = 0
    extend = list.extend

    class Counted(list):
        def extend(self, nodes):
            nonlocal written
            nodes = list(nodes)
            written += len(nodes)
            extend(self, nodes)

        def __getitem__(self, at):
            nonlocal written
            found = list.__getitem__(self, at)
            written += len(found) if isinstance(at, slice) else 0
            return found

    shape = Sphere(1.0) | Sphere(1.0)
    growing = shape.node._growing
    assert growing is None
    shape = shape | Sphere(1.0)
    growing = shape.node._growing
    growing._nodes = Counted(growing._nodes)
    growing._last[0] = growing._nodes
    part = Sphere(1.0)
    for _ in range(1000):
        shape = shape | part
    assert written == 1000
    assert len(shape.node.children) == 1003


def test_threads_that_continue_one_union_do_not_mix():
    start = Sphere(1.0) | Sphere(1.0) | Sphere(1.0)
    results = {}

    def grow(value):
        shape = start
        for _ in range(300):
            shape = shape | Sphere(value)
        results[value] = radii(shape)

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    try:
        threads = [threading.Thread(target=grow, args=(v,)) for v in (2.0, 3.0, 4.0)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    finally:
        sys.setswitchinterval(interval)
    assert results == {v: [1.0] * 3 + [v] * 300 for v in (2.0, 3.0, 4.0)}


def test_painted_named_and_smooth_unions_stay_whole():
    painted = (Sphere(1.0) | Sphere(2.0)).paint("red") | Sphere(3.0)
    named = (Sphere(1.0) | Sphere(2.0)).named("pair") | Sphere(3.0)
    smooth = Sphere(1.0).union(Sphere(2.0), smooth=0.1) | Sphere(3.0)
    for shape in (painted, named, smooth):
        assert len(shape.node.children) == 2


def test_differences_grow_on_the_left_alone():
    shape = Box(3.0) - Sphere(1.0) - Sphere(1.1) - Sphere(1.2)
    assert (shape.node.rule, len(shape.node.children)) == (DIFFERENCE, 4)
    other = Box(4.0) - shape
    assert len(other.node.children) == 2
    assert other.node.children[1] is shape.node


def test_a_node_does_not_change_and_is_replaced():
    node = (Sphere(1.0) | Sphere(2.0) | Sphere(3.0)).node
    with pytest.raises(dataclasses.FrozenInstanceError):
        node.label = "other"
    with pytest.raises(AttributeError, match="a node has no attribute 'color'"):
        _ = node.color
    changed = dataclasses.replace(node, label="three")
    assert (changed.label, changed.children, changed.parts) == ("three", node.children, 3)
    fewer = dataclasses.replace(node, children=node.children[:2])
    assert (fewer.parts, fewer.rule) == (2, UNION)


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class Marked(Node):
    """A node with another attribute, as a table's."""

    mark: str = ""


def test_a_subclass_is_a_dataclass_too():
    both = (Sphere(1.0).node, Box(1.0).node)
    made = Marked(UNION, False, children=both, mark="yes")
    assert (made.mark, made.children, made.parts) == ("yes", both, 2)
    assert (dict(made.numbers), made.material, made.label) == ({}, None, "")
    assert Marked(UNION, False).parts == 1


# The quick way and the whole way to bind arguments agree

ARGUMENTS = [
    ("Sphere", (1,), {}),
    ("Sphere", (), {"radius": 2.5}),
    ("Sphere", (np.float64(1.5),), {}),
    ("Sphere", (np.float32(1.5),), {}),
    ("Sphere", (), {}),
    ("Sphere", (0.0,), {}),
    ("Sphere", (-1.0,), {}),
    ("Sphere", (math.nan,), {}),
    ("Sphere", (math.inf,), {}),
    ("Sphere", (1e39,), {}),
    ("Sphere", (10**400,), {}),
    ("Sphere", (True,), {}),
    ("Sphere", ("1",), {}),
    ("Sphere", (None,), {}),
    ("Sphere", ((1.0,),), {}),
    ("Sphere", (1.0, 2.0), {}),
    ("Sphere", (1.0,), {"radius": 2.0}),
    ("Sphere", (1.0,), {"size": 2.0}),
    ("Sphere", (slider("Radius", 1.0, low=0.1),), {}),
    ("Box", (1.0,), {}),
    ("Box", (1.0, 2.0), {}),
    ("Box", (1.0, 2.0, 3.0), {}),
    ("Box", ((1.0, 2.0, 3.0),), {}),
    ("Box", ([1, 2, 3],), {}),
    ("Box", (np.array([1.0, 2.0, 3.0]),), {}),
    ("Box", (np.array([1.0, 2.0]),), {}),
    ("Box", (vec3(1.0, 2.0, 3.0),), {}),
    ("Box", ((1.0, 2.0, math.nan),), {}),
    ("Box", ((1.0, 2.0, True),), {}),
    ("Box", (1.0, 2.0, "3"), {}),
    ("Box", (), {"x": 1.0, "y": 2.0}),
    ("Torus", (1.0, 0.25), {}),
    ("Torus", (0.25, 1.0), {}),
    ("Cylinder", (1.0,), {"height": 2.0}),
    ("RoundConeBetween", ((0, 0, 0), (0, 1, 0), 0.3, 0.1), {}),
    ("RoundConeBetween", (0, 0, 0, 0, 1, 0, 0.3, 0.1), {}),
    ("RoundConeBetween", (0, 0, 0, (0, 1, 0), 0.3, 0.1), {}),
]


def outcome(name, args, kwargs):
    try:
        numbers, constants = bound(PRIMITIVES[name], args, kwargs, None)
    except (SceneTypeError, SceneValueError) as error:
        return str(error)
    shown = {n: (v.type, v.plain, type(v.plain)) for n, v in numbers.items()}
    return shown, constants


@pytest.mark.parametrize(("name", "args", "kwargs"), ARGUMENTS)
def test_quickly_bound_arguments_are_the_same(name, args, kwargs, monkeypatch):
    quick = outcome(name, args, kwargs)
    monkeypatch.setattr(binding, "_bound_quickly", lambda *given: None)
    monkeypatch.setattr(binding, "plain_number", lambda *given, **named: None)
    assert outcome(name, args, kwargs) == quick


@pytest.mark.parametrize("limit", Limit)
@pytest.mark.parametrize("is_color", [False, True])
@pytest.mark.parametrize(
    "value", [0.0, 1, -2.5, (0.0, 1, 0.0), [0.6, 0.8, 0.0], (-1.0, 0.0, 0.0), (0.0,) * 3, 1e-39]
)
def test_plain_numbers_are_those_that_need_no_conversion(value, limit, is_color):
    type = FLOAT if isinstance(value, float | int) else VEC3
    quick = plain_number(value, type, limit, is_color=is_color)
    try:
        whole = number(value, Asked("n", "Test", type, limit, is_color))
    except SceneValueError:
        whole = None
    assert quick == whole


def test_a_place_is_shared_by_all_parts_of_a_loop():
    parts = [Torus(1.0, 0.1 + 0.01 * i) for i in range(3)]
    assert parts[0].node.place is parts[2].node.place
    first, second = Sphere(1.0), Sphere(1.0)
    assert first.node.place != second.node.place
