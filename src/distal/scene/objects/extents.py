"""Measured extents: where a shape really ends along each axis.

Input: a shape, its box and its bound on the slope. Output: two corners. A shape that is exact
outside is asked for its distance from points far away along each axis; others are searched with
NumPy: cells of the box that may contain the surface are halved, then points are moved up along the
axis until they meet it. Does not depend on what the extents are used for.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

from distal.diagnostics import Span
from distal.fields.guarantees import Guarantee
from distal.frontend import Assembly
from distal.ir.build import number as constant
from distal.ir.nodes import Call, Compose, Construct, Expr, Return
from distal.ir.types import FLOAT, VEC2, VEC3, tuple_type
from distal.lang.composed import Composed
from distal.lang.runtime_access import executor
from distal.packages import imported
from distal.scene.lowering.parts.table import rolled_for
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.tree.errors import refuse
from distal.scene.tree.node import Node

if TYPE_CHECKING:
    from distal.scene.objects.field import BaseShape

Corner = tuple[float, ...]

# How far away, in sizes of the shape, the distance is asked for. The extent then is too small by at
# most size / (2 FAR), and rounded by FAR * 1e-16.
FAR: Final = 1e7
# Extents this near to the box, in sizes, are those of the box, which is never too small.
SAME: Final = 1e-6
_LEVELS: Final = 4  # of halved cells, after the first 8 along each axis
_MOST_CELLS: Final = 60_000
_STARTS: Final = 12  # points from which the surface is climbed
_AROUND: Final = 24  # points tried around each, in each step
_STEPS: Final = 22
_MOVES: Final = 24  # towards the surface, in each step


class FarDistances(Composed):
    """The distances from a point far away on either side along each axis, without arguments."""

    def __init__(self, node: Node, middle: Sequence[float], far: float) -> None:
        self._node = node
        self._middle, self._far = middle, far
        self.name = f"extents of {node.name}"
        self.signature = ()
        self.result = tuple_type((FLOAT,) * (4 if node.flat else 6))

    def compose(self, assembly: Assembly) -> str:
        """Add the function, and return its name: low sides first, then high sides."""
        node = rolled_for(assembly, self._node, exact=True)
        composer = ShapeComposer(assembly, [node])
        field = composer.field(node, composer.values.all(node), ZERO_CELL)
        type_ = VEC2 if node.flat else VEC3
        found: list[Expr] = []
        for sign, axis in itertools.product((-1.0, 1.0), range(type_.size)):
            parts = [
                m + (sign * self._far if i == axis else 0.0) for i, m in enumerate(self._middle)
            ]
            point = Compose(tuple(constant(part) for part in parts), type_)
            found.append(Call(field.name, (point, *field.captures), FLOAT))
        body = (Return(Construct(tuple(found), self.result)),)
        return assembly.define("far_distances", (), self.result, body, node.place)


def extents_of(
    shape: BaseShape,
    what: str,
    place: Span | None,
    params: Mapping[str, Any] | None = None,
    time: float = 0.0,
) -> tuple[Corner, Corner]:
    """Return the corners (low, high) of the measured box.

    Args:
        shape: The shape.
        what: The method that asks, in messages.
        place: The author's line.
        params: Values of parameters by name; the others have their defaults.
        time: Time in seconds.

    Raises:
        SceneValueError: The shape is infinite, or nothing of it was found.
    """
    low, high = shape.bounds(params=params, time=time)
    if not all(map(math.isfinite, (*low, *high))):
        message = f"{what} needs shapes that end, and '{shape.name}' is infinite"
        refuse(message, "cut it first: shape & Box(…)", place)
    size = max(b - a for a, b in zip(low, high, strict=True))
    measure = _from_far if Guarantee.EXACT_OUTSIDE in shape.claims else _searched
    found = measure(shape, low, high, size, params, time) if size >= 0.0 else None
    if found is None:
        message = f"{what} found nothing of '{shape.name}' in its box"
        refuse(message, "is something left of it? Look at it with distal view", place)
    near = SAME * size
    return (
        tuple(b if abs(a - b) <= near else a for a, b in zip(found[0], low, strict=True)),
        tuple(b if abs(a - b) <= near else a for a, b in zip(found[1], high, strict=True)),
    )


def _from_far(
    shape: BaseShape,
    low: Corner,
    high: Corner,
    size: float,
    params: Mapping[str, Any] | None,
    time: float,
) -> tuple[Corner, Corner]:
    """Return the extents of a shape that is exact outside; arguments as for ``extents_of``."""
    middle = [(a + b) / 2.0 for a, b in zip(low, high, strict=True)]
    far = FAR * size
    found = executor().call(FarDistances(shape.node, middle, far), (), {}, params, time)
    count = len(middle)
    return (
        tuple(m - far + float(d) for m, d in zip(middle, found[:count], strict=True)),
        tuple(m + far - float(d) for m, d in zip(middle, found[count:], strict=True)),
    )


def _searched(
    shape: BaseShape,
    low: Corner,
    high: Corner,
    size: float,
    params: Mapping[str, Any] | None,
    time: float,
) -> tuple[Corner, Corner] | None:
    """Return the extents of a shape whose distances may be too small, or None."""
    np = imported("numpy")

    def values(points: Any) -> Any:
        return executor().call(shape, (points,), {}, params, time, here=True)

    inside = _inside_points(np, values, low, high, shape.slope)
    if not len(inside):
        return None
    count = len(low)
    ups = np.concatenate([-np.eye(count), np.eye(count)])
    most = np.concatenate([-np.array(low), np.array(high)])
    starts = [inside[np.argsort(inside @ -up)[:_STARTS]] for up in ups]
    ends = _climbed(np, values, starts, ups, most, size, shape.slope)
    return tuple((-ends[:count]).tolist()), tuple(ends[count:].tolist())


def _inside_points(
    np: Any, values: Callable[[Any], Any], low: Corner, high: Corner, slope: float
) -> Any:
    """Return points inside, near the surface, from cells that are halved around it."""
    low_, high_ = np.array(low), np.array(high)
    half = (high_ - low_) / 16.0
    axes = [a + h * np.arange(1.0, 16.0, 2.0) for a, h in zip(low_, half, strict=True)]
    cells = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(low))
    corners = np.array(list(itertools.product((-0.5, 0.5), repeat=len(low))))
    inside = cells[:0]
    for level in range(_LEVELS + 1):
        found = values(cells)
        inside = np.concatenate([inside, cells[found <= 0.0]])
        cells = cells[abs(found) <= slope * np.linalg.norm(half)]
        if level == _LEVELS or len(cells) * len(corners) > _MOST_CELLS:
            break
        cells = (cells[:, None, :] + corners * half).reshape(-1, len(low))
        half = half / 2.0
    return inside


def _climbed(
    np: Any,
    values: Callable[[Any], Any],
    starts: Sequence[Any],
    ups: Any,
    most: Any,
    size: float,
    slope: float,
) -> Any:
    """Return the largest heights that points reach which stay inside, one for each direction.

    In each step, points are tried around the best ones, ever nearer to them, and moved up by their
    distance from the surface.

    Args:
        np: NumPy.
        values: The field.
        starts: For each direction, points inside.
        ups: The directions, of unit length, a row each.
        most: The height of the box in each, beyond which nothing is.
        size: Size of the shape.
        slope: Its bound on the slope.
    """
    random = np.random.default_rng(0)
    points, rising, reach = list(starts), list(range(len(ups))), size / 16.0
    for _ in range(_STEPS):
        tried = np.concatenate([np.repeat(points[i], _AROUND, axis=0) for i in rising])
        of = np.concatenate([np.full(len(points[i]) * _AROUND, i) for i in rising])
        shifts = random.uniform(-1.0, 1.0, tried.shape) * reach
        shifts[::_AROUND] = 0.0
        tried += shifts
        is_inside = values(tried) <= 0.0
        tried, of = tried[is_inside], of[is_inside]
        for _ in range(_MOVES):
            depth = -values(tried)
            tried = tried + (np.maximum(depth, 0.0) / slope)[:, None] * ups[of]
            if depth.max(initial=0.0) < 1e-9 * size:
                break
        for i in rising:
            own = tried[of == i]
            if len(own):  # rounding may put all outside
                points[i] = own[np.argsort(own @ -ups[i])[:_STARTS]]
        reach *= 0.55
        rising = [i for i in rising if points[i][0] @ ups[i] < most[i] - 0.5 * SAME * size]
        if not rising:
            break
    return np.array([(own @ up).max() for own, up in zip(points, ups, strict=True)])
