"""A class for every shape of the field library, ``Sphere`` to ``Hexagon``.

Input: the library's rows. Output: a class for each, called with the shape's
numbers. ``shapes.pyi`` beside this file, made by ``tools/gen_shapes_stub.py``, tells editors.
"""

from __future__ import annotations

import inspect
from typing import Any

from distal.fields.guarantees import Primitive
from distal.fields.library import PRIMITIVES
from distal.scene.objects.binding import bound
from distal.scene.objects.field import Field
from distal.scene.objects.shape import Shape, Shape2D
from distal.scene.tree.node import Node
from distal.scene.tree.source_places import author_place


def _make(row: Primitive) -> type[Field]:
    """The class of one row."""
    base: type[Field] = Shape2D if row.flat else Shape

    def initialise(self: Field, *args: Any, **kwargs: Any) -> None:
        place = author_place()
        numbers, constants = bound(row, args, kwargs, place)
        Field.__init__(self, Node(row, row.flat, (), numbers, constants, place))

    python = inspect.signature(row.distance.python_function)
    own = [p for name, p in python.parameters.items() if name not in ("p", "cell")]
    body = {
        "__init__": initialise,
        "__doc__": row.distance.__doc__,
        "__module__": __name__,
        "__signature__": inspect.Signature(own),
        "row": row,
    }
    return type(row.name, (base,), body)


CLASSES = {name: _make(row) for name, row in PRIMITIVES.items()}
globals().update(CLASSES)
__all__ = [*CLASSES]
