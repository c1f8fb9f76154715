"""Values that a caller chose for parameters, checked.

Input: parameters, and values by name from Python. Output: plain values by the parameters' names.
``distal.cli.arguments`` reads texts of a command line.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from distal.lang.parameter_values import Value
from distal.lang.parameters import Parameter


def checked_values(
    parameters: Iterable[Parameter], chosen: Mapping[str, Any] | None
) -> dict[str, Value]:
    """The chosen values, checked; parameters that were not chosen are left out.

    Args:
        parameters: All that there are.
        chosen: Values by a parameter's name or label; None: nothing is chosen.

    Raises:
        TypeError: These are no values by name, or a value is of another kind.
        ValueError: There is no such parameter, or a value lies outside its range.
    """
    if chosen is None:
        return {}
    if not isinstance(chosen, Mapping):
        raise TypeError(f"params are values by name, not {type(chosen).__name__}")
    known = {key: p for p in parameters for key in (p.label, p.name)}
    values = {}
    for key, value in chosen.items():
        if key not in known:
            names = ", ".join(dict.fromkeys(p.name for p in known.values())) or "none"
            raise ValueError(f"there is no parameter '{key!s:.60}'; parameters: {names}")
        values[known[key].name] = known[key].check(value)
    return values
