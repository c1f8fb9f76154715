"""Check the values that a caller gives for parameters.

Input: parameters, and Python values by name. Output: plain values by the names of the parameters.
The texts of a command line are parsed in ``distal.cli.arguments``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from distal.lang.parameter_values import Value
from distal.lang.parameters import Parameter


def by_key(parameters: Iterable[Parameter]) -> dict[str, Parameter]:
    """Return parameters by all that names them: their names, and labels that are no names."""
    listed = list(parameters)
    return {p.label: p for p in listed} | {p.name: p for p in listed}


def checked_values(
    parameters: Iterable[Parameter], chosen: Mapping[str, Any] | None
) -> dict[str, Value]:
    """Return the given values, checked, by parameter name; other parameters are left out.

    Args:
        parameters: All parameters of the scene.
        chosen: Values by the name or label of a parameter; None is the same as an empty mapping.

    Raises:
        TypeError: ``chosen`` is not a mapping, or a value has the wrong type.
        ValueError: There is no such parameter, or a value is out of its range.
    """
    if chosen is None:
        return {}
    if not isinstance(chosen, Mapping):
        raise TypeError(f"params are values by name, not {type(chosen).__name__}")
    known = by_key(parameters)
    values = {}
    for key, value in chosen.items():
        if key not in known:
            names = ", ".join(dict.fromkeys(p.name for p in known.values())) or "none"
            raise ValueError(f"there is no parameter '{key!s:.60}'; parameters: {names}")
        values[known[key].name] = known[key].check(value)
    return values
