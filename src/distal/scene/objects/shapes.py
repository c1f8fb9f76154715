"""A class for each shape of the field library, from ``Sphere`` to ``Hexagon``.

Input: the primitives of the library. Output: a class for each, called with the numbers of the
shape. Editors read ``distal/__init__.pyi``, which ``tools/gen_stubs.py`` generates.
"""

from __future__ import annotations

import inspect
from typing import Any

from distal.fields.guarantees import Primitive
from distal.fields.library import PRIMITIVES
from distal.lang.source_places import author_place
from distal.scene.objects.binding import bound
from distal.scene.objects.field import BaseShape
from distal.scene.objects.shape import Shape, Shape2D
from distal.scene.objects.shape_values import CLASSES_OF_RULES
from distal.scene.tree.node import Node
from distal.scene.tree.value import argument


def _make(primitive: Primitive) -> type[BaseShape]:
    """Make the class of one primitive."""
    flat = primitive.flat
    base: type[BaseShape] = Shape2D if flat else Shape

    def initialise(self: BaseShape, *args: Any, **kwargs: Any) -> None:
        place = author_place()
        numbers, constants = bound(primitive, args, kwargs, place)
        BaseShape.__init__(self, Node(primitive, flat, (), numbers, constants, place))

    hidden = {"p", "cell", *primitive.measured}
    python = inspect.signature(primitive.distance.python_function)
    own = [p for name, p in python.parameters.items() if name not in hidden]
    body = {
        "__init__": initialise,
        "__doc__": primitive.distance.__doc__,
        "__module__": __name__,
        "__signature__": inspect.Signature(own),
        "row": primitive,
        **{p.name: argument(p.name) for p in own},
    }
    made = type(primitive.name, (base,), body)
    CLASSES_OF_RULES[id(primitive)] = made
    return made


def made_of(name: str, *args: Any, **kwargs: Any) -> Any:
    """Return a shape of the library by the name of its class, at the author's line."""
    kind: Any = CLASSES[name]
    return kind(*args, **kwargs)


CLASSES = {name: _make(primitive) for name, primitive in PRIMITIVES.items()}
globals().update(CLASSES)
__all__ = [*CLASSES]
