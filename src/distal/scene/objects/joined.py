"""The set operations as functions of several shapes: union, intersection, difference, xor.

Input: shapes, in a list, a generator or one by one. Output: one shape. The methods of these names
of a shape do the work.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, TypeVar, Unpack

from distal.lang.source_places import author_place
from distal.scene.objects.field import BaseShape
from distal.scene.tree.errors import refuse_kind

if TYPE_CHECKING:
    from distal.scene.objects.argument_types import BlendNumbers, Number

S = TypeVar("S", bound=BaseShape)


def union(
    *shapes: S | Iterable[S],
    smooth: Number = 0.0,
    blend: str = "quadratic",
    **blend_numbers: Unpack[BlendNumbers],
) -> S:
    """Return the union of shapes: ``union(parts)`` or ``union(a, b, c)``.

    Args:
        shapes: Shapes, or one list or generator of shapes.
        smooth: How far a blend moves the surface outwards where two surfaces meet, in scene units;
            0 for a sharp edge.
        blend: Form of the blend, one of those of the method ``union``.
        blend_numbers: ``count``: number of columns or stairs.

    Raises:
        SceneTypeError: There is no shape, or something else is among the shapes.
        SceneValueError: Flat shapes and solids are mixed, or a number is beyond its limit.
    """
    first, rest = _first_of("union", shapes)
    joined: S = first.union(*rest, smooth=smooth, blend=blend, **blend_numbers) if rest else first
    return joined


def intersection(
    *shapes: S | Iterable[S],
    smooth: Number = 0.0,
    blend: str = "quadratic",
    **blend_numbers: Unpack[BlendNumbers],
) -> S:
    """Return the intersection of shapes: ``intersection(parts)`` or ``intersection(a, b)``.

    Arguments as for ``union``.

    Raises:
        SceneTypeError: There is no shape, or something else is among the shapes.
        SceneValueError: Flat shapes and solids are mixed, or a number is beyond its limit.
    """
    first, rest = _first_of("intersection", shapes)
    joined: S = (
        first.intersection(*rest, smooth=smooth, blend=blend, **blend_numbers) if rest else first
    )
    return joined


def difference(
    *shapes: S | Iterable[S],
    smooth: Number = 0.0,
    blend: str = "quadratic",
    **blend_numbers: Unpack[BlendNumbers],
) -> S:
    """Return the first shape without the others: ``difference(a, b, c)`` is ``a - b - c``.

    Args:
        shapes: Shapes, or one list or generator of shapes; from the first, the others are
            subtracted.
        smooth: How far a blend moves the surface where two surfaces meet, as for ``union``.
        blend: Form of the blend, one of those of the method ``union``.
        blend_numbers: ``count``: number of columns or stairs.

    Raises:
        SceneTypeError: There is no shape, or something else is among the shapes.
        SceneValueError: Flat shapes and solids are mixed, or a number is beyond its limit.
    """
    first, rest = _first_of("difference", shapes)
    joined: S = (
        first.difference(*rest, smooth=smooth, blend=blend, **blend_numbers) if rest else first
    )
    return joined


def xor(*shapes: S | Iterable[S]) -> S:
    """Return what is in exactly one of two shapes: ``xor(a, b)`` is ``a ^ b``.

    Of more shapes, it is what is in an odd number of them.

    Args:
        shapes: Shapes, or one list or generator of shapes.

    Raises:
        SceneTypeError: There is no shape, or something else is among the shapes.
        SceneValueError: Flat shapes and solids are mixed.
    """
    first, rest = _first_of("xor", shapes)
    joined: S = first.xor(*rest) if rest else first
    return joined


def _first_of(what: str, given: tuple[Any, ...]) -> tuple[Any, list[Any]]:
    """Return the first shape and the others."""
    if len(given) == 1 and isinstance(given[0], Iterable) and not isinstance(given[0], str):
        given = tuple(given[0])
    if not given:
        hint = f"{what}(parts) for a list with shapes; test 'if parts:' before"
        refuse_kind(f"{what} needs at least one shape, and there is none", hint, author_place())
    first, *rest = given
    if not isinstance(first, BaseShape):
        refuse_kind(f"{what} joins shapes, not {first!r:.60}", None, author_place())
    return first, rest
