"""Names of arguments: none is that of a method or an attribute of the object that the call makes.

An object's arguments are to be its attributes too, so each name has one meaning on it.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from typing import Any, Final

import pytest

import distal
from distal.fields.library import PRIMITIVES
from distal.render.declarations import BACKGROUNDS, CAMERAS, LIGHTS, MATERIALS, PATTERNS
from distal.scene.objects.field import BaseShape
from distal.scene.objects.materials import Material
from distal.scene.objects.scene_object import SceneObject
from distal.scene.objects.shape import Shape, Shape2D
from distal.scene.tree.calls import Pattern
from distal.scene.tree.value import argument

# Attributes that objects have, or will have, besides their arguments.
RESERVED: Final = frozenset(
    ("arguments", "replace", "operator", "children", "material", "paths", "digest", "written")
)
# Attributes that are the argument: what an author declares of a function, or of a sky.
SAME: Final = {
    "from_function": {"bounds", "exact", "slope"},
    "from_vm": {"bounds", "slope"},
    "Environment": {"light"},
    "Sky": {"light"},
}
FAMILIES: Final = {
    "lights": (LIGHTS, None),
    "backgrounds": (BACKGROUNDS, None),
    "cameras": (CAMERAS, None),
    "materials": (MATERIALS, Material),
    "patterns": (PATTERNS, Pattern),
}


def arguments_of(called: Callable[..., Any]) -> set[str]:
    """The names that a call may give."""
    parameters = inspect.signature(called).parameters.values()
    return {p.name for p in parameters if p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL)}


def attributes_of(made: type) -> set[str]:
    """The public names of an object besides its arguments."""
    names = {name for name in dir(made) if not name.startswith("_") and not shows(made, name)}
    return names | RESERVED


def shows(made: type, name: str) -> bool:
    """Whether an attribute is the one of an argument."""
    return getattr(inspect.getattr_static(made, name), "__doc__", "") == argument(name).__doc__


def calls() -> Iterator[tuple[str, Callable[..., Any], type]]:
    """Each call that makes an object: its name, what is called, the class of the object."""
    for name in PRIMITIVES:
        yield name, getattr(distal, name), getattr(distal, name)
    for family, made in FAMILIES.values():
        for name in family.members:
            yield name, getattr(distal, name), made or getattr(distal, name)
    for name in distal.__all__:
        found = getattr(distal, name)
        if isinstance(found, type) and issubclass(found, BaseShape | SceneObject):
            yield name, found, found
    yield "Camera.yaw_pitch_roll", distal.Camera.yaw_pitch_roll, distal.Camera
    for made in (Shape, Shape2D):
        for name, found in inspect.getmembers(made, inspect.ismethod):
            if not name.startswith("_"):
                yield f"{made.__name__}.{name}", found, made


CALLS: Final = {name: (called, made) for name, called, made in calls()}


def test_each_kind_of_call_is_looked_at():
    assert {"Sphere", "Text", "Gear", "Nut", "Bolt", "SpotLight", "Environment"} <= set(CALLS)
    made_of_data = {"Shape.from_function", "Shape.from_mesh", "Shape2D.from_image"}
    assert {*made_of_data, "Camera.yaw_pitch_roll"} <= set(CALLS)
    for family, _ in FAMILIES.values():
        assert set(family.members) <= set(CALLS)


@pytest.mark.parametrize("name", CALLS)
def test_no_argument_is_called_as_what_the_object_has(name: str):
    called, made = CALLS[name]
    same = SAME.get(name.rpartition(".")[2], set())
    assert arguments_of(called) & attributes_of(made) == same
