"""The inputs of a sweep: what is rendered and measured, one set of values after the other.

Input: values by parameter, of which all combinations are taken; or a list of sets of values, from
Python or a CSV file. Output: checked plain values. A mistake names its row and its column.
"""

from __future__ import annotations

import csv
import io
import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any

from distal.foreign_files import check_time, opened
from distal.lang.parameters import Parameter
from distal.source_text import SourceTextError, decoded
from distal.sweeps.axes import MOST, Axis, chosen_axes
from distal.sweeps.columns import INPUT, TIME, InputColumn, column_of


@dataclass(frozen=True, slots=True)
class Inputs:
    """The sets of values of a sweep.

    Attributes:
        columns: What has values, in order.
        sets: For each picture a plain value for each column.
        axes: What the sets are all combinations of, the values of the last one fastest; None for a
            list of sets.
    """

    columns: tuple[InputColumn, ...]
    sets: Sequence[tuple[Any, ...]]
    axes: tuple[Axis, ...] | None = None

    def params(self, index: int) -> dict[str, Any]:
        """Return the values of the parameters of a set by name."""
        pairs = zip(self.columns, self.sets[index], strict=True)
        return {c.name: value for c, value in pairs if c.parameter is not None}

    def time(self, index: int, default: float) -> float:
        """Return the time of a set in seconds."""
        pairs = zip(self.columns, self.sets[index], strict=True)
        return next((value for c, value in pairs if c.parameter is None), default)

    def named(self, index: int) -> dict[str, Any]:
        """Return the values of a set by name, options by their names."""
        pairs = zip(self.columns, self.sets[index], strict=True)
        return {c.name: c.named(value) for c, value in pairs}

    def shown(self, index: int) -> str:
        """Return a set in words, "Width 0.5, Count 3"."""
        pairs = zip(self.columns, self.sets[index], strict=True)
        return ", ".join(f"{c.label} {c.shown(value)}" for c, value in pairs)

    @property
    def recipe(self) -> dict[str, Any]:
        """The inputs as plain data."""
        if self.axes is not None:
            return {"axes": {axis.name: list(axis.values) for axis in self.axes}}
        return {"sets": [self.named(index) for index in range(len(self.sets))]}


def inputs_of(values: Any, parameters: Sequence[Parameter]) -> Inputs:
    """Return the inputs that a caller gives; see ``distal.sweep``.

    Args:
        values: Values by parameter; a list of sets of values; or the path of a CSV file.
        parameters: The parameters of the scene.

    Raises:
        ValueError: A name or a value is wrong, there are none, or there are too many.
    """
    if isinstance(values, Mapping):
        return _grid(values, parameters)
    if isinstance(values, str | PathLike):
        return read_inputs(values, parameters)
    return _listed(values, parameters)


def _grid(values: Mapping[str, Any], parameters: Sequence[Parameter]) -> Inputs:
    axes = tuple(chosen_axes(values, parameters))
    if not axes:
        raise ValueError("a sweep takes values: --set NAME=FIRST:LAST:COUNT or NAME=A,B,C")
    count = 1
    for axis in axes:
        count *= len(axis.values)
    if count > MOST:
        raise ValueError(f"a sweep has at most {MOST} pictures, not {count}")
    sets = list(itertools.product(*(axis.values for axis in axes)))
    return Inputs(tuple(axis.column for axis in axes), sets, axes)


def _listed(rows: Iterable[Any], parameters: Sequence[Parameter]) -> Inputs:
    """Return the inputs of a list of mappings or named tuples."""
    if not isinstance(rows, Iterable):
        raise ValueError(
            f"a sweep takes values by parameter, or a list of them, not {type(rows).__name__}"
        )
    columns: tuple[InputColumn, ...] = ()
    sets: list[tuple[Any, ...]] = []
    for number, row in enumerate(rows, 1):
        _check_count(number)
        where = f"set {number}"
        given = _mapping(row, where)
        names = _columns(given, parameters, where)
        if not columns:
            columns = tuple(names)
        _check_same(columns, names, where)
        sets.append(tuple(_checked(c, given[names[c]], where) for c in columns))
    if not sets:
        raise ValueError("the list of a sweep has no sets of values")
    if not columns:
        raise ValueError("set 1 has no values")
    return Inputs(columns, sets)


def _mapping(row: Any, where: str) -> Mapping[str, Any]:
    as_dict = getattr(row, "_asdict", None)
    if callable(as_dict):
        row = as_dict()
    if not isinstance(row, Mapping):
        raise ValueError(
            f"{where}: values by parameter, as {{'width': 0.5}}, not {type(row).__name__}"
        )
    return row


def _columns(
    names: Iterable[str], parameters: Sequence[Parameter], where: str
) -> dict[InputColumn, str]:
    """Return the columns that are given, with the names that they are given by."""
    found: dict[InputColumn, str] = {}
    for name in names:
        try:
            column = column_of(name, parameters)
        except ValueError as error:
            raise ValueError(f"{where}: {error}") from None
        if column in found:
            raise ValueError(f"{where} has '{column.label}' twice: '{found[column]}' and '{name}'")
        found[column] = name
    return found


def _check_same(
    columns: Sequence[InputColumn], names: Mapping[InputColumn, str], where: str
) -> None:
    for column in columns:
        if column not in names:
            raise ValueError(f"{where} has no value of '{column.label}', which set 1 has")
    for column, name in names.items():
        if column not in columns:
            raise ValueError(f"{where} has a value of '{name}', which set 1 has not")


def _check_count(number: int) -> None:
    if number > MOST:
        raise ValueError(f"a sweep has at most {MOST} pictures, and the list has more")


def _checked(column: InputColumn, value: Any, where: str) -> Any:
    try:
        return column.checked(value)
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None


# Files


@dataclass(frozen=True, slots=True)
class _ColumnCells:
    """Where the cells of a column are: their numbers from 0, and the names of the columns."""

    column: InputColumn
    cells: tuple[int, ...]
    headers: tuple[str, ...]


def read_inputs(path: str | PathLike[str], parameters: Sequence[Parameter]) -> Inputs:
    """Return the inputs of a CSV file, whose first line has the names of parameters.

    In the table of a sweep its columns of inputs are read alone.

    Raises:
        ValueError: It cannot be read, a name or a value is wrong, or there are too many rows; the
            message names the file, the line and the column.
    """
    with opened("list", path, error=ValueError) as data:
        try:
            text = decoded(data)
        except SourceTextError as error:
            raise ValueError(f"it {error}") from None
        return _parsed(text, parameters)


def _parsed(text: str, parameters: Sequence[Parameter]) -> Inputs:
    if "\0" in text:
        raise ValueError("it is no text")
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    header = _next(reader)
    while header is not None and not any(cell.strip() for cell in header):
        header = _next(reader)
    if header is None:
        raise ValueError("it is empty: its first line has the names of parameters")
    places = _places([name.strip() for name in header], parameters)
    sets: list[tuple[Any, ...]] = []
    while (row := _next(reader)) is not None:
        if not any(cell.strip() for cell in row):
            continue
        check_time()
        _check_count(len(sets) + 1)
        line = reader.line_num
        if len(row) != len(header):
            raise ValueError(_count_of_cells(line, row, header))
        sets.append(tuple(_of_row(place, row, line) for place in places))
    if not sets:
        raise ValueError("it has names of parameters, and no values below them")
    return Inputs(tuple(place.column for place in places), sets)


def _next(reader: Any) -> list[str] | None:
    """Return the next row; None at the end."""
    try:
        row: list[str] | None = next(reader, None)
    except csv.Error as error:
        raise ValueError(f"line {reader.line_num}: {error}") from None
    return row


def _count_of_cells(line: int, row: Sequence[str], header: Sequence[str]) -> str:
    words = f"line {line} has {len(row)} values for {len(header)} columns"
    if len(row) > len(header) and any(cell.strip().lstrip("-").isdigit() for cell in row):
        words += '; the decimal sign is a point, and a value with commas stands in "…"'
    return words


def _places(header: Sequence[str], parameters: Sequence[Parameter]) -> list[_ColumnCells]:
    """Return where the values of each column are."""
    is_table = any(name.startswith(INPUT) for name in header)
    if len(header) == 1 and any(mark in header[0] for mark in ";\t"):
        raise ValueError("its columns are separated by commas, not semicolons or tabs")
    found: dict[InputColumn, dict[str, tuple[int, str]]] = {}
    for number, name in enumerate(header):
        if is_table and not name.startswith(INPUT):
            continue
        if not name:
            raise ValueError(f"column {number + 1} has no name")
        column, part = _named(name.removeprefix(INPUT) if is_table else name, parameters)
        parts = found.setdefault(column, {})
        if part in parts or (parts and "" in (part, *parts)):
            first = next(iter(parts.values()))[1]
            raise ValueError(f"'{column.label}' has two columns: '{first}' and '{name}'")
        parts[part] = number, name
    return [_place(column, parts) for column, parts in found.items()]


def _named(name: str, parameters: Sequence[Parameter]) -> tuple[InputColumn, str]:
    """Return the column of a name, and its coordinate, or ""."""
    try:
        return column_of(name, parameters), ""
    except ValueError:
        stem, dot, part = name.rpartition(".")
        if dot and len(part) == 1:
            try:
                column = column_of(stem, parameters)
            except ValueError:
                column = InputColumn(TIME, TIME, None)
            if part in column.parts:
                return column, part
        raise


def _place(column: InputColumn, parts: Mapping[str, tuple[int, str]]) -> _ColumnCells:
    if "" in parts:
        number, name = parts[""]
        return _ColumnCells(column, (number,), (name,))
    for part in column.parts:
        if part not in parts:
            raise ValueError(f"'{column.label}' has no column '{column.name}.{part}'")
    ordered = [parts[part] for part in column.parts]
    return _ColumnCells(column, tuple(n for n, _ in ordered), tuple(name for _, name in ordered))


def _of_row(place: _ColumnCells, row: Sequence[str], line: int) -> Any:
    cells = [row[number] for number in place.cells]
    for cell, name in zip(cells, place.headers, strict=True):
        if not cell.strip():
            raise ValueError(f"line {line}, column '{name}': there is no value")
    try:
        return place.column.of_cells(cells)
    except ValueError as error:
        shown = "', '".join(place.headers)
        raise ValueError(f"line {line}, column '{shown}': {error}") from None
