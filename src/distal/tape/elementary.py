"""The elementary functions of tapes, as scene code.

One function selects by number, so that the runtime's text has one copy of each built-in. The number
is the same for all lanes: a branch, not a selection.
"""

from __future__ import annotations

from distal.lang import (
    acos,
    asin,
    atan,
    atan2,
    cos,
    cosh,
    exp,
    exp2,
    func,
    log,
    log2,
    sin,
    sinh,
    tan,
    tanh,
)


@func
def elementary(number: int, x: float, y: float) -> float:
    """Return the elementary function with this position in ``operations.ELEMENTARY``."""
    result = x
    if number == 0:
        result = sin(x)
    elif number == 1:
        result = cos(x)
    elif number == 2:
        result = tan(x)
    elif number == 3:
        result = exp(x)
    elif number == 4:
        result = exp2(x)
    elif number == 5:
        result = log(x)
    elif number == 6:
        result = log2(x)
    elif number == 7:
        result = asin(x)
    elif number == 8:
        result = acos(x)
    elif number == 9:
        result = atan(x)
    elif number == 10:
        result = sinh(x)
    elif number == 11:
        result = cosh(x)
    elif number == 12:
        result = tanh(x)
    elif number == 13:
        result = atan2(x, y)
    else:
        result = pow(x, y)
    return result
