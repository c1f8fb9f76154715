"""Names that are used in annotations only: arrays, fields and generic types."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from distal.ir.types import VEC2, VEC3, VEC4, Kind, vector_of
from distal.lang.values import VALUE_CLASSES, uint

_vec2, _vec3, _vec4 = (VALUE_CLASSES[t] for t in (VEC2, VEC3, VEC4))

_numbers: list[Any] = [
    float,
    int,
    uint,
    *(VALUE_CLASSES[vector_of(k, n)] for k in (Kind.FLOAT, Kind.INT, Kind.UINT) for n in (2, 3, 4)),
]


@dataclass(frozen=True, slots=True)
class ArrayAnnotation:
    """``array[element, length]`` as the author wrote it, not checked."""

    element: Any
    length: Any


class array:  # noqa: N801
    """A fixed array: ``array[float, 4]`` is four floats."""

    def __class_getitem__(cls, item: Any) -> ArrayAnnotation:
        """Return the annotation for an array type."""
        if not isinstance(item, tuple) or len(item) != 2:
            raise TypeError("write array[float, 4]: the element type and the length")
        return ArrayAnnotation(*item)

    def __init__(self, *_: Any) -> None:
        raise TypeError("write [a, b, c] for an array's values; array[float, 3] is its type")


# Functions of a point in 2D and in 3D: the most common types of function parameters.
Field2: Any = Callable[[_vec2], float]
Field3: Any = Callable[[_vec3], float]

# A function annotated with one of these is compiled once for each type that it is called with.
Floats = TypeVar("Floats", float, _vec2, _vec3, _vec4)  # type: ignore[valid-type]
Numbers = TypeVar("Numbers", *_numbers)  # type: ignore[misc]
Vectors = TypeVar("Vectors", _vec2, _vec3, _vec4)  # type: ignore[valid-type]
