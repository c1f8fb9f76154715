"""What is proved of the author's own functions, and what is refuted, as findings.

Input: the node of an author's function, its bounds, and values of parameters. Output: a severity, a
code, a message and a hint. Proofs are by intervals (``distal.tape.proofs``): they hold at every
point of a box, not only where the function was evaluated.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from distal.error_codes import ErrorCode
from distal.fields.guarantees import Primitive, Proven
from distal.lang.runtime_access import executor
from distal.scene.checks.bounds_report import NodeBounds
from distal.scene.lowering.derived import DistanceOf
from distal.scene.tree.node import Node
from distal.tape.tape import TapeError

# A proof takes time that grows with the function: half a second for 30 operations.
MOST_OPERATIONS: Final = 300
_ROUNDING: Final = 1e-3


@dataclass(frozen=True, slots=True)
class ProofNote:
    """What is known of a function's slope.

    Attributes:
        code: That it is proved, not proved or refuted; the last is an error.
        message: What is known.
        hint: What to write instead, or None.
    """

    code: ErrorCode
    message: str
    hint: str | None = None


def proof_note(
    node: Node, own: NodeBounds, params: Mapping[str, Any], time: float
) -> ProofNote | None:
    """Return what is known of the slope of an author's function; None if there is no box.

    Args:
        node: The function's node.
        own: Its declared slope and box.
        params: Values of parameters by name.
        time: The time in seconds.
    """
    rule, name = node.rule, node.name
    assert isinstance(rule, Primitive)
    if rule.proved is not None:
        return ProofNote(ErrorCode.PROVED, _by_construction(rule.proved, name))
    if rule.normalize is not None or not own.finite:
        return None
    n = 2 if node.flat else 3
    low, high = tuple(own.low[:n]), tuple(own.high[:n])
    declared, function = own.slope, DistanceOf(node)
    try:
        found = executor().prove(function, low, high, params, time, most=MOST_OPERATIONS)
    except TapeError as error:
        return ProofNote(
            ErrorCode.SLOPE_NOT_PROVED, f"the slope of '{name}' is not proved: {error}"
        )
    if found.slope <= declared * (1.0 + _ROUNDING):
        message = f"the slope of '{name}' is proved in its box: it is at most {_up(found.slope)}"
        return ProofNote(ErrorCode.SLOPE_PROVED, f"{message}, and {declared:.4g} is declared")
    most = declared * (1.0 + _ROUNDING)
    refuted = executor().refute(function, most, (low, high), params, time)
    if refuted is None:
        message = f"the slope {declared:.4g} of '{name}' is neither proved nor refuted in its box"
        return ProofNote(
            ErrorCode.SLOPE_NOT_PROVED, f"{message}: at most {_up(found.slope)} is proved"
        )
    place = ", ".join(f"{number:.3g}" for number in refuted.place)
    message = f"'{name}' declares the slope {declared:.4g}, but its value changes by at least "
    message += f"{refuted.slope:.3g} per unit near ({place})"
    return ProofNote(ErrorCode.SLOPE_REFUTED, message, f"slope={_up(found.slope)}, which is proved")


def _by_construction(proved: Proven, name: str) -> str:
    what = " and the ".join(proved.names)
    low, high = (", ".join(f"{c:.3g}" for c in corner) for corner in (proved.low, proved.high))
    verb = "is" if len(proved.names) == 1 else "are"
    return f"the {what} of '{name}' {verb} proved in ({low}) to ({high})"


def _up(slope: float) -> str:
    """Return a slope, rounded up to three digits."""
    digits = max(2 - math.floor(math.log10(slope)), 0) if slope > 0.0 else 2
    return f"{math.ceil(slope * 10**digits) / 10**digits:.{digits}f}"
