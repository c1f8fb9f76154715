"""Anchors: moves that put a side of one shape at a side of another.

Input: two shapes and the words of the author. Output: the components of a translation. The extents
are measured once (``extents``); what changes them afterwards is refused. Does not depend on the
public classes.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, Final

from distal.diagnostics import Span
from distal.fields.guarantees import Guarantee
from distal.ir.types import BOOL, FLOAT, INT
from distal.lang.lazy_module import LazyModule
from distal.lang.runtime_access import executor
from distal.scene.tree.errors import refuse, refuse_kind

if TYPE_CHECKING:
    from distal.scene.objects import extents
    from distal.scene.objects.extents import Corner
    from distal.scene.objects.field import BaseShape
else:
    extents = LazyModule("distal.scene.objects.extents")

# The axis of each side, and the direction that it faces.
_SIDES: Final[Mapping[str, tuple[int, float]]] = {
    "top": (1, 1.0),
    "bottom": (1, -1.0),
    "right": (0, 1.0),
    "left": (0, -1.0),
    "front": (2, 1.0),
    "back": (2, -1.0),
}
_SHARES: Final[Mapping[str, float]] = {"low": 0.0, "center": 0.5, "high": 1.0}
# Other times, at which the extents must be the same as at time 0.
_TIMES: Final = (0.37, 1.9)
# How much they may differ, in sizes.
_STILL: Final = 1e-6


def measured_extents(shape: BaseShape, place: Span | None) -> tuple[Corner, Corner]:
    """Return the corners (low, high) of the measured box; see ``BaseShape.extents``."""
    return extents.extents_of(shape, "extents()", place)


def offset_on(
    shape: BaseShape, other: Any, side: Any, gap: Any, place: Span | None
) -> tuple[Any, ...]:
    """Return the translation of ``shape.on(other, side)``.

    Args:
        shape: The shape that is moved.
        other: The shape that it is put on.
        side: The author's word for the side.
        gap: The distance to keep: a number or an expression.
        place: The author's line.
    """
    _check_other(shape, other, "on()", place)
    sides = [name for name, (axis, _) in _SIDES.items() if axis < _count(shape)]
    if side not in sides:
        refuse(f"there is no side {side!r:.40}", ", ".join(sides), place)
    (own_low, own_high), (low, high) = (
        _fixed_extents(s, "on()", range(_count(shape)), place) for s in (shape, other)
    )
    middles = [
        (a + b - c - d) / 2.0 for a, b, c, d in zip(low, high, own_low, own_high, strict=True)
    ]
    axis, sign = _SIDES[side]
    touching = high[axis] - own_low[axis] if sign > 0.0 else low[axis] - own_high[axis]
    return tuple(touching + sign * gap if i == axis else m for i, m in enumerate(middles))


def offset_aligned(
    shape: BaseShape, other: Any, words: Mapping[str, Any], place: Span | None
) -> tuple[float, ...]:
    """Return the translation of ``shape.align(other, …)``.

    Args:
        shape: The shape that is moved.
        other: The shape that it is aligned with.
        words: The author's word for each axis, or None.
        place: The author's line.
    """
    _check_other(shape, other, "align()", place)
    named = {axis: word for axis, word in words.items() if word is not None}
    for axis, word in named.items():
        if word not in _SHARES:
            refuse(f"{axis} of align() is 'low', 'center' or 'high', not {word!r:.40}", None, place)
    if shape.flat and "z" in named:
        refuse("a flat shape has no z", "align(other, x=…, y=…)", place)
    if not named:
        refuse("align() needs an axis", 'align(other, x="center", y="low")', place)
    axes = ["xyz".index(axis) for axis in named]
    (own_low, own_high), (low, high) = (
        _fixed_extents(s, "align()", axes, place) for s in (shape, other)
    )
    offset = [0.0] * _count(shape)
    for i, word in zip(axes, named.values(), strict=True):
        share = _SHARES[word]
        there = low[i] + share * (high[i] - low[i])
        offset[i] = there - own_low[i] - share * (own_high[i] - own_low[i])
    return tuple(offset)


def _count(shape: BaseShape) -> int:
    return 2 if shape.flat else 3


def _check_other(shape: BaseShape, other: Any, what: str, place: Span | None) -> None:
    if not hasattr(other, "node"):
        refuse_kind(f"{what} takes another shape, not {other!r:.60}", None, place)
    if other.flat != shape.flat:
        kind = "flat" if shape.flat else "solid"
        refuse(f"{what} takes another {kind} shape, not '{other.name}'", None, place)


def _fixed_extents(
    shape: BaseShape, what: str, axes: Iterable[int], place: Span | None
) -> tuple[Corner, Corner]:
    """Return the extents of a shape that do not change along some axes."""
    first = extents.extents_of(shape, what, place)
    # The box of a shape that is exact outside moves with its surface, and is asked in no time.
    exact = Guarantee.EXACT_OUTSIDE in shape.claims
    known = shape.bounds() if exact else first
    for why, params, time in _other_values(shape):
        if exact:
            now = shape.bounds(params=params, time=time)
        else:
            now = extents.extents_of(shape, what, place, params, time)
        still = _STILL * max(b - a for a, b in zip(*first, strict=True))
        pairs = itertools.product(zip(known, now, strict=True), axes)
        if any(abs(b[axis] - a[axis]) > still for (a, b), axis in pairs):
            hint = "move it by translate(), whose numbers may be parameters and the time"
            message = f"{what} measures once, but the extents of '{shape.name}' follow {why}"
            refuse(message, hint, place)
    return first


def _other_values(shape: BaseShape) -> Iterator[tuple[str, Mapping[str, Any], float]]:
    """Yield what may change a shape, with values of parameters and times that differ from now."""
    for parameter in shape.parameters():
        if parameter.type not in (FLOAT, INT, BOOL):
            continue
        toggled = (not parameter.default,) if parameter.type is BOOL else ()
        for value in toggled or (parameter.low, parameter.high):
            if value is not None and value != parameter.default:
                yield f"the parameter '{parameter.label}'", {parameter.name: value}, 0.0
    if executor().follows_time(shape):
        yield from (("the time", {}, time) for time in _TIMES)
