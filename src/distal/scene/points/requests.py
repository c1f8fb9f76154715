"""Checks of what an author requests: numbers of points, distances, seeds.

Input: the author's values. Output: checked plain numbers. Does not depend on NumPy.
"""

from __future__ import annotations

from typing import Any, Final

from distal.diagnostics import Span
from distal.fields.guarantees import Limit
from distal.ir.types import FLOAT, INT
from distal.scene.tree.conversion import Asked, number, plain_choice
from distal.scene.tree.errors import refuse, refuse_kind

# A shape is drawn at each point, so more points than a scene has parts are of no use.
MOST_POINTS: Final = 1_000_000


def positive(value: Any, label: str, place: Span | None) -> float:
    """Return a plain number above 0.

    Args:
        value: The author's value.
        label: Its name in messages: "spacing of points_in".
        place: The author's line.

    Raises:
        SceneTypeError: The value is not a plain number.
        SceneValueError: It is not above 0.
    """
    name, _, what = label.partition(" of ")
    found = number(value, Asked(name, what, FLOAT, Limit.POSITIVE, place=place)).plain
    if not isinstance(found, float):
        refuse_kind(f"'{label}' is a plain number, not an expression", place=place)
    return found


def whole_number(
    value: Any, label: str, place: Span | None, least: int = 1, most: int = MOST_POINTS
) -> int:
    """Return a whole number from ``least`` to ``most``.

    Args:
        value: The author's value.
        label: Its name in messages: "count of points_in".
        place: The author's line.
        least: The smallest allowed number.
        most: The largest.

    Raises:
        SceneTypeError: The value is not a whole number.
        SceneValueError: It is out of range.
    """
    name, _, what = label.partition(" of ")
    found = int(plain_choice(value, Asked(name, what, INT, place=place)))
    if not least <= found <= most:
        refuse(f"'{label}' is from {least} to {most:,}, not {found:,}", place=place)
    return found
