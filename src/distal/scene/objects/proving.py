"""Slopes and boxes of the author's functions, proved within a region.

Input: a function, its numbers, and a region that contains the shape. Output: a bound on its slope
and a box, or an error that says why none can be proved.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any, Final

from distal.diagnostics import Span
from distal.fields.guarantees import Proven
from distal.lang.runtime_access import executor
from distal.scene.lowering.derived import DistanceOf, GradientOf
from distal.scene.objects.binding import own_node
from distal.scene.tree.errors import refuse
from distal.scene.tree.node import Node
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
) -> tuple[Any, Any, Proven | None]:
    """Return a slope and bounds: the given ones, or what is proved; and what that is.

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
    corners = low, high
    if slope is not None:
        _compare(node, name, float(slope), corners, place)
        if bounds is not None:
            return slope, bounds, None
    try:
        found = executor().prove(DistanceOf(node), low, high)
    except TapeError as error:
        hint = "leave out region=, and pass slope= and bounds="
        refuse(f"nothing can be proved of '{name}': {error}", hint, place)
    names = (*(("slope",) if slope is None else ()), *(("box",) if bounds is None else ()))
    if bounds is None:
        if found.low is None or found.high is None:
            refuse(f"'{name}' is positive in the whole region", "give a larger region", place)
        inside = zip(low, found.low, found.high, high, strict=True)
        if not all(a < b and c < d for a, b, c, d in inside):
            message = f"the shape of '{name}' may leave the region"
            refuse(message, "give a larger region", place)
        bounds = found.low, found.high
    return (found.slope if slope is None else slope), bounds, Proven(names, low, high)


def _compare(node: Node, name: str, slope: float, region: Any, place: Span | None) -> None:
    """Refuse a declared slope that the function exceeds somewhere in the region.

    Points are looked at first; then cells, whose intervals also find what is between the points.

    Args:
        node: The function.
        name: Its name.
        slope: The declared slope.
        region: The corners of the region.
        place: The author's line.
    """
    sides = [
        [a + (b - a) * (i + 0.5) / _PLACES for i in range(_PLACES)]
        for a, b in zip(*region, strict=True)
    ]
    steepest, at = executor().steepest(GradientOf(node), list(product(*sides)))
    by = f"{steepest:.3g} per unit at"
    if steepest <= _ROUNDING * slope:
        try:
            found = executor().refute(DistanceOf(node), _ROUNDING * slope, region)
        except TapeError:
            return
        if found is None:
            return
        by, at = f"at least {found.slope:.3g} per unit near", found.place
    shown = ", ".join(f"{number:.3g}" for number in at)
    message = f"'{name}' changes by {by} ({shown}), more than its declared slope {slope:g}"
    refuse(message, "leave out slope=, and it is proved", place)
