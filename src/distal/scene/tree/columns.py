"""Columns of numbers: one value for each row of an array, checked together.

Input: NumPy arrays, lists, colors; the parameter that the values are for. Output: a ``Number`` for
each row. Needs no NumPy: arrays are read by their own ``tolist``. A value that is wrong is reported
with the number of its row.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any

from distal.fields.guarantees import Limit
from distal.ir.types import FLOAT, Vector
from distal.lang.parameter_values import LARGEST_FLOAT
from distal.scene.tree.conversion import (
    Asked,
    Number,
    Plain,
    complaint,
    number,
    plain_choice,
    type_name,
    unwrapped,
)
from distal.scene.tree.errors import refuse, refuse_kind


def rows_of(value: Any, asked: Asked, count: int | None = None) -> Sequence[Any]:
    """Return the rows of a column, unchecked.

    Args:
        value: A list, an array, or another iterable.
        asked: The parameter that the column is for.
        count: The required number of rows; None for any number above 0.

    Raises:
        SceneTypeError: The value has no rows.
        SceneValueError: There are no rows, or not ``count``.
    """
    found = unwrapped(value)
    if isinstance(found, str) or not isinstance(found, Iterable):
        refuse_kind(
            f"'{asked.label}' takes a list or an array, not {type_name(value)} {value!r:.40}",
            place=asked.place,
        )
    rows: Sequence[Any] = found if isinstance(found, Sequence) else list(found)
    if count is not None and len(rows) != count:
        refuse(
            f"'{asked.label}' has {len(rows)} rows for {count} positions",
            "give one row for each position",
            asked.place,
        )
    if not rows:
        refuse(f"'{asked.label}' needs at least one row", place=asked.place)
    return rows


def column(rows: Sequence[Any], asked: Asked) -> list[Number]:
    """Return each row as a float or a vector.

    Args:
        rows: The rows.
        asked: The parameter; its type is that of one row.

    Raises:
        SceneTypeError: A row has the wrong type; the message has its number.
        SceneValueError: A number is not finite, or is beyond its limit.
    """
    plain = _plain_rows(rows, asked)
    if plain is not None:
        type = asked.type
        return [Number(type, row) for row in plain]
    known: dict[str, Plain] = {}
    found = []
    for at, row in enumerate(rows):
        if isinstance(row, str) and row in known:
            found.append(Number(asked.type, known[row]))
            continue
        made = number(row, replace(asked, name=f"{asked.name}[{at}]"))
        if isinstance(row, str) and made.plain is not None:
            known[row] = made.plain
        found.append(made)
    return found


def _plain_rows(rows: Sequence[Any], asked: Asked) -> Sequence[Plain] | None:
    """Return rows of plain numbers as floats and tuples; None if a row is anything else.

    A hundred thousand rows are checked together in 20 ms.
    """
    size = 1
    flat: Sequence[Any] = rows
    if asked.type is not FLOAT:
        assert isinstance(asked.type, Vector)
        size = asked.type.size
        if not {tuple, list}.issuperset(map(type, rows)) or {size} != set(map(len, rows)):
            return None
        flat = list(chain.from_iterable(rows))
    kinds = set(map(type, flat))
    if not kinds <= {float, int} or not all(map(math.isfinite, flat)):
        return None
    if max(flat) > LARGEST_FLOAT or min(flat) < (0.0 if asked.is_color else -LARGEST_FLOAT):
        return None
    if int in kinds:
        flat = list(map(float, flat))
    plain: Sequence[Plain] = flat if size == 1 else list(zip(*[iter(flat)] * size, strict=True))
    if asked.limit is not Limit.ANY and any(complaint(row, asked.limit) for row in plain):
        return None
    return plain


def choices(rows: Sequence[Any], asked: Asked, count: int) -> list[int]:
    """Return each row as an index below ``count``.

    Args:
        rows: The rows.
        asked: The parameter.
        count: The number of things to choose from.

    Raises:
        SceneTypeError: A row is not a whole number.
        SceneValueError: A row is not one of the indices.
    """
    if set(map(type, rows)) == {int} and min(rows) >= 0 and max(rows) < count:
        return list(rows)
    found = []
    for at, row in enumerate(rows):
        named = replace(asked, name=f"{asked.name}[{at}]")
        chosen = plain_choice(row, named)
        if not 0 <= chosen < count:
            refuse(f"'{named.label}' is from 0 to {count - 1}, not {chosen}", place=asked.place)
        found.append(int(chosen))
    return found
