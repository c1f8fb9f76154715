"""The lowest height of a solid: where a floor touches it.

Input: a shape. Output: a height; that of its box where the box is tight, or nothing better is
known. Columns of the box are followed upwards as far as the field proves them empty; those that may
hold something below the lowest surface found are divided. Does not depend on looks.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from typing import Any, Final

from distal.fields.combine import joins
from distal.fields.guarantees import ENDLESS, Guarantee, Primitive
from distal.fields.lift import extrude
from distal.fields.place import mirrors
from distal.fields.place import solid as placing
from distal.lang.composed import Composed
from distal.lang.expressions import Expression, depends_on_time
from distal.lang.runtime_access import executor
from distal.packages import PackageError, imported
from distal.scene.lowering.derived import DistanceOf
from distal.scene.objects.field import BaseShape
from distal.scene.tree.node import Node
from distal.scene.tree.varying import VaryingNumber
from distal.session import SESSION

_COLUMNS: Final = 16  # along x and z, at first
_LEVELS: Final = 5  # of divided columns
_ROUNDS: Final = 8  # of finer lines, at the lowest place
_STEPS: Final = 24  # upwards, at each level
_MOST_COLUMNS: Final = 3000
_MOST_VALUES: Final = 8_000  # of the field: 0.06 s for a shape of two parts, 0.3 s for noise
# A surface is met within this, and a column is followed no more if it rises less than this: in
# sizes of the box, and in widths of the column.
_MET: Final = 1e-5
_SLOW: Final = 0.05
# What a slanted edge may be lower than the lines found, in sizes of the box.
_MARGIN: Final = 5e-4
# What is thinner than this, in sizes of the box, may be below the height.
THIN: Final = 0.01

# Operators below which tight boxes of exact shapes stay tight.
_TIGHT: Final = frozenset(
    (
        joins.UNION,
        placing.TRANSLATE,
        placing.SCALE,
        mirrors.REFLECT,
        mirrors.SYMMETRY,
        extrude.EXTRUDE,
    )
)

Corner = tuple[float, ...]
# Heights by what they depend on: a scene is made again at each change of its file.
_found: dict[Hashable, float] = SESSION.keep("lowest points", {})
_MOST_FOUND: Final = 1024


def lowest_of(
    node: Node, box: tuple[Corner, Corner], params: Mapping[str, Any], time: float
) -> float:
    """Return the height of a solid's lowest point.

    That of its box where it moves with the time, or without NumPy.

    Args:
        node: The solid.
        box: Its box (low, high), finite.
        params: Values of parameters by name; the others have their defaults.
        time: Time in seconds.
    """
    low, high = box
    if _is_tight(node) or _moves(node) or node.estimate:
        return low[1]
    try:
        np = imported("numpy")
        shape, program = BaseShape._of(node), DistanceOf(node)
        slope = float(shape._known_bounds(_read_by(shape._bounds_function, params), time)[0])
        if not slope < ENDLESS:
            return low[1]
        known = _read_by(program, params)

        def values(points: Any) -> Any:
            return executor().call(program, (points,), {}, known, time, "reference")

        key = _key_of(program, (low, high, time, tuple(sorted(known.items()))))
        found = _found.get(key)
        if found is None:
            found = lowest_height(values, slope, low, high, np)
            if key is not None:
                if len(_found) >= _MOST_FOUND:
                    _found.clear()
                _found[key] = found
        return found
    except PackageError:  # where scenes are only compiled to text
        return low[1]


def _key_of(program: Composed, about: Hashable) -> Hashable:
    """Return what a height depends on; None if that has textures or buffers."""
    lowered = executor().lowered(program)
    if lowered.module.resources:
        return None
    numbers = tuple((u.name, u.default) for u in lowered.module.uniforms)
    key = lowered.digest, numbers, about
    try:
        hash(key)
    except TypeError:  # values of parameters that are lists or arrays
        return None
    return key


def _read_by(program: Composed, params: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of the parameters that a program reads."""
    names = {parameter.name for parameter in executor().parameters(program)}
    return {name: value for name, value in params.items() if name in names}


def _is_tight(node: Node) -> bool:
    rule = node.rule
    if isinstance(rule, Primitive):
        return rule.bounds is not None and Guarantee.EXACT_OUTSIDE in rule.claims
    return rule in _TIGHT and all(map(_is_tight, node.children))


def _moves(root: Node) -> bool:
    """Return whether a number of the tree depends on the time."""
    for node in root.walk():
        if any(isinstance(v, VaryingNumber) and v.moves for v in node.constants.values()):
            return True
        values = (number.value for number in node.numbers.values())
        if any(isinstance(value, Expression) and depends_on_time(value) for value in values):
            return True
    return False


def lowest_height(
    values: Callable[[Any], Any], slope: float, low: Corner, high: Corner, np: Any
) -> float:
    """Return the height of the lowest surface; of the box, if nothing was found.

    Args:
        values: The field: points of shape (n, 3) to n values.
        slope: Its bound on the slope.
        low: Lower corner of a box around the surface.
        high: Upper corner.
        np: NumPy.
    """
    size = max(b - a for a, b in zip(low, high, strict=True))
    width = np.array([high[0] - low[0], high[2] - low[2]]) / _COLUMNS
    steps = np.arange(_COLUMNS) + 0.5
    grid = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    middles = np.array([low[0], low[2]]) + grid * width
    empty = np.full(len(middles), low[1])  # below it, the whole column is
    found, proven, spent, around = high[1], low[1], 0, middles[0]
    for level in range(_LEVELS):
        reach = 0.5 * float(np.hypot(*width))
        empty, surface, count = _followed(
            values, slope, middles, empty, reach, size, found, _MOST_VALUES - spent, np
        )
        spent += count
        best = int(surface.argmin())
        if surface[best] < found:
            found, around = float(surface[best]), middles[best]
        left = empty < found - _MET * size
        proven = float(empty[left].min()) if left.any() else found
        more = 4 * int(left.sum())
        is_last = level == _LEVELS - 1 or more > _MOST_COLUMNS
        if not more or is_last:
            break
        corners = np.array([(-1, -1), (-1, 1), (1, -1), (1, 1)]) * (width / 4.0)
        middles = (middles[left][:, None, :] + corners).reshape(-1, 2)
        empty = np.repeat(empty[left], 4)
        width = width / 2.0
    if found - proven > THIN * size:
        return proven
    found = _settled(values, slope, around, width, (proven, found), size, np)
    return max(proven, found - _MARGIN * size)


def _settled(
    values: Callable[[Any], Any],
    slope: float,
    around: Any,
    width: Any,
    ends: tuple[float, float],
    size: float,
    np: Any,
) -> float:
    """Return the height of the lowest surface near a place, by lines ever nearer to the lowest.

    Args:
        values: The field.
        slope: Its bound on the slope.
        around: The place (x, z).
        width: How far from it lines are followed at first.
        ends: The heights between which the surface is.
        size: Size of the box.
        np: NumPy.
    """
    proven, found = ends
    shifts = np.stack(np.meshgrid(*[np.linspace(-1.0, 1.0, 5)] * 2), axis=-1).reshape(-1, 2)
    for _ in range(_ROUNDS):
        x, z = (around + shifts * width).T
        height = np.full(len(x), proven)
        for _ in range(_STEPS):
            free = values(np.stack([x, height, z], axis=1)) / slope
            height = np.where(height < found, height + np.maximum(free, 0.0), height)
            if not (free[height < found] > _MET * size).any():
                break
        best = int(height.argmin())
        if height[best] < found:
            found, around = float(height[best]), np.array([x[best], z[best]])
        width = width * 0.5
    return found


def _followed(
    values: Callable[[Any], Any],
    slope: float,
    middles: Any,
    empty: Any,
    reach: float,
    size: float,
    most: float,
    most_values: int,
    np: Any,
) -> tuple[Any, Any, int]:
    """Return up to where columns are empty, the surface on their middle lines, how many values.

    A ball of the radius value / slope is empty, so a column of a smaller radius is, as far as the
    ball covers it.

    Args:
        values: The field.
        slope: Its bound on the slope.
        middles: Of the columns, (n, 2).
        empty: Up to where each is known to be empty.
        reach: From a column's middle line to its edges.
        size: Size of the box.
        most: A height at which a surface is known; columns are followed no farther.
        most_values: How often the field may be evaluated.
        np: NumPy.
    """
    count = len(middles)
    height = np.concatenate([empty, empty])  # of the columns, then of their middle lines
    radius = np.repeat([reach, 0.0], count)
    moving = np.ones(2 * count, bool)
    x, z = np.tile(middles, (2, 1)).T
    surface = np.full(count, np.inf)
    spent = 0
    for _ in range(_STEPS):
        which = np.flatnonzero(moving)
        if not len(which) or spent + len(which) > most_values:
            break
        spent += len(which)
        free = values(np.stack([x[which], height[which], z[which]], axis=1)) / slope
        rise = np.sqrt(np.maximum(free * free - radius[which] ** 2, 0.0)) * (free > 0.0)
        met = which[(free <= _MET * size) & (which >= count)]
        surface[met - count] = height[met]
        height[which] += rise
        slow = rise < np.where(which < count, _SLOW * reach, _MET * size)
        moving[which] = ~slow & (height[which] < most)
    return height[:count], surface, spent
