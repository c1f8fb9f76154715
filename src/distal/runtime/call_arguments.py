"""Select the overload of a call from Python and prepare its arguments for the kernel.

Input: a function of scene code and the arguments of a call. Output: the parameter types, the values
in parameter order, and the values as arrays with one row per point; or a ``TypeError`` that lists
the signatures. Does not depend on a device.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from distal.frontend import lower
from distal.frontend.signatures.signatures import MISSING, read_signature
from distal.ir.types import Type
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.names import LangFunction
from distal.runtime.call_values import bind, choose_types, collected, rows_of


def call_arguments(
    function: Func | Composed | LangFunction,
    args: Sequence[Any],
    kwargs: Mapping[str, Any],
) -> tuple[tuple[Type, ...], list[Any], list[Any]]:
    """Select the overload that accepts the arguments.

    Args:
        function: The function to call.
        args: Values by position.
        kwargs: Values by name.

    Returns:
        The parameter types, the values in parameter order, and the values as arrays with one row
        per point.

    Raises:
        TypeError: No overload accepts the arguments.
        CompileError: The signature is wrong; the message shows the author's lines.
    """
    if isinstance(function, LangFunction):
        if kwargs:
            raise TypeError(f"{function.row.name}() takes no keyword arguments")
        for signature in function.row.signatures:
            for types, _ in signature.instances():
                rows = rows_of(args, types) if len(types) == len(args) else None
                if rows is not None:
                    return types, list(args), rows
    elif isinstance(function, Composed):
        types = tuple(type for _, type in function.signature)
        names = dict.fromkeys((name for name, _ in function.signature), MISSING)
        values = bind(function.name, names, args, kwargs)
        rows = rows_of(values, types)
        if rows is not None:
            return types, values, rows
    else:
        mistake: TypeError | None = None
        for overload in function.overloads:
            declared = read_signature(overload).collecting(len(args))
            if declared.problems:
                lower(function)  # raises with the author's lines
            try:
                defaults = {slot.name: slot.default for slot in declared.parameters}
                values = bind(declared.name, defaults, collected(declared, args), kwargs)
            except TypeError as error:
                mistake = error
                continue
            found = choose_types(declared, values)
            if found is not None:
                types, rows = found
                return types, values, rows
        if mistake is not None and len(function.overloads) == 1:
            raise mistake
    given = ", ".join(map(_described, [*args, *kwargs.values()]))
    if _name(function) == "atan" and len(args) == 2:
        raise TypeError(f"atan() does not take ({given}); atan2(y, x) does")
    raise TypeError(f"{_name(function)}() does not take ({given}); {_takes(function)}")


def _name(function: Func | Composed | LangFunction) -> str:
    return function.row.name if isinstance(function, LangFunction) else function.name


def _takes(function: Func | Composed | LangFunction) -> str:
    if isinstance(function, LangFunction):
        overloads = [
            f"({', '.join(map(str, types))})"
            for signature in function.row.signatures
            for types, _ in signature.instances()
        ]
    elif isinstance(function, Composed):
        params = ", ".join(f"{name}: {type}" for name, type in function.signature)
        overloads = [f"({params}) -> {function.result}"]
    else:
        overloads = [read_signature(o).text() for o in function.overloads]
    return f"it takes {' or '.join(overloads)}, or arrays with a row for each point"


def _described(value: Any) -> str:
    try:
        shape = np.shape(value) if not isinstance(value, str) else ()
    except ValueError:
        return f"a {type(value).__name__} whose parts differ in length"
    if shape:
        dtype = np.asarray(value).dtype
        return f"an array of shape {shape}" + ("" if dtype.kind in "fiu" else f" of {dtype}")
    return repr(value) if isinstance(value, int | float | str) else type(value).__name__
