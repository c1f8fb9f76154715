"""Functions that call functions which capture values of their caller.

Input: the functions, and how the new one is made. Output: a function that captures the same values.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from distal.ir.nodes import Expr, FunctionRef
from distal.scene.tree.conversion import NO_VALUES
from distal.scene.tree.values import StatementList

Make = Callable[[StatementList, Mapping[str, Any]], Expr]


def capturing(
    define: Callable[..., FunctionRef],
    name: str,
    params: Any,
    functions: Mapping[str, FunctionRef],
    make: Make,
    values: Mapping[str, Expr] = NO_VALUES,
) -> FunctionRef:
    """Return a function of some parameters that calls others, and captures what they capture.

    Args:
        define: Adds a function.
        name: Its name.
        params: Name and type of each parameter.
        functions: The functions that it calls, by name.
        make: Returns its result from its parameters, these functions and the values.
        values: Other values of its caller that it captures, by name.
    """
    captured = dict(values)
    for n, function in functions.items():
        captured |= {f"{n}_{i}": value for i, value in enumerate(function.captures)}

    def made(body: StatementList, given: Mapping[str, Expr]) -> Expr:
        here = {n: _with_captures(f, n, given) for n, f in functions.items()}
        return make(body, {**given, **here})

    every = [*params, *((n, value.type) for n, value in captured.items())]
    return define(name, every, made, list(captured.values()))


def _with_captures(function: FunctionRef, name: str, given: Mapping[str, Expr]) -> FunctionRef:
    """Return a function that captures values of its caller, which are parameters here.

    Args:
        function: The function.
        name: Its name among the caller's functions.
        given: The caller's parameters.
    """
    captures = tuple(given[f"{name}_{i}"] for i in range(len(function.captures)))
    return FunctionRef(function.name, captures, function.type)
