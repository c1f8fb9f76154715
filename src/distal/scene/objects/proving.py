"""Slopes and boxes of the author's functions, proved within a region.

Input: a function, its numbers, and a region that contains the shape. Output: a bound on its slope
and a box, or an error that says why none can be proved.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any, Final

from distal.diagnostics import Span
from distal.lang.composed import Composed
from distal.lang.runtime_access import executor
from distal.scene.lowering.derived import DistanceOf, GradientOf
from distal.scene.objects.binding import own_node
from distal.scene.tree.errors import refuse
from distal.tape.tape import TapeError

_PLACES: Final = 12  # along each side, where a declared slope is compared with the gradient
_ROUNDING: Final = 1.001


def proved(
    function: Any,
    numbers: Mapping[str, Any],
    place: Span | None,
    *,
    region: Any,
    slope: Any,
    bounds: Any,
) -> tuple[Any, Any]:
    """Return a slope and bounds: the given ones, or what is proved.

    Args:
        function: The author's ``@func``.
        numbers: Values of its parameters, by name.
        place: The author's line.
        region: Corners (low, high) of the region.
        slope: The declared slope, or None.
        bounds: The declared box, or None.

    Raises:
        SceneValueError: Nothing can be proved, or the function is steeper than its declared slope.
    """
    # With the region as its box, the node is checked as every own function is.
    node = own_node(function, numbers, place, slope=slope, bounds=region, exact=False, growth=None)
    name = node.name
    low, high = (tuple(float(number) for number in corner) for corner in region)
    try:
        found = executor().prove(DistanceOf(node), low, high)
    except TapeError as error:
        hint = "leave out region=, and pass slope= and bounds="
        refuse(f"nothing can be proved of '{name}': {error}", hint, place)
    if slope is not None:
        _compare(GradientOf(node), name, slope, (low, high), place)
    if bounds is None:
        if found.low is None or found.high is None:
            refuse(f"'{name}' is positive in the whole region", "give a larger region", place)
        inside = zip(low, found.low, found.high, high, strict=True)
        if not all(a < b and c < d for a, b, c, d in inside):
            message = f"the shape of '{name}' may leave the region"
            refuse(message, "give a larger region", place)
        bounds = found.low, found.high
    return (found.slope if slope is None else slope), bounds


def _compare(gradient: Composed, name: str, slope: Any, region: Any, place: Span | None) -> None:
    """Refuse a declared slope that the function exceeds at some point of the region.

    Args:
        gradient: The gradient of the function.
        name: The name of the function.
        slope: The declared slope.
        region: The corners of the region.
        place: The author's line.
    """
    sides = [
        [a + (b - a) * (i + 0.5) / _PLACES for i in range(_PLACES)]
        for a, b in zip(*region, strict=True)
    ]
    points = list(product(*sides))
    steepest, at = executor().steepest(gradient, points)
    if steepest > _ROUNDING * float(slope):
        shown = ", ".join(f"{number:.3g}" for number in at)
        message = f"'{name}' changes by {steepest:.3g} per unit at ({shown}), "
        message += f"more than its declared slope {float(slope):g}"
        refuse(message, "leave out slope=, and it is proved", place)
