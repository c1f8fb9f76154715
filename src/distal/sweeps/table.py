"""The table of a sweep: a CSV file to which each finished row is added at once.

Input: what the columns are, rows. Output: the file; the rows of an earlier run, if they are of the
same inputs. Inputs, figures of pictures and measures are three namespaces, which the names of the
columns begin with: "input.width" is what was asked for, "measured.width" what came of it. Numbers
have all their digits: they read back to the bit. Does not depend on pictures.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from distal.file_writer import LineAppender, SaveError, appending, only_writer, replacement
from distal.foreign_files import opened
from distal.sweeps.columns import INPUT, cell_of
from distal.sweeps.inputs import Inputs

NUMBER: Final = "number"
FILE: Final = "file"
PICTURE: Final = "picture."
MEASURED: Final = "measured."
# Of a picture or of measures: a hash of all that they depend on.
KEY: Final = "key"
# Columns whose values are no numbers.
_TEXTS: Final = (KEY, "remark")


@dataclass(frozen=True, slots=True)
class SweepRow:
    """What a sweep has found for one set of values.

    Attributes:
        number: Which set it is, from 1.
        inputs: The values that were asked for, by the names of the parameters, and "time"; options
            by their names.
        measured: What was measured of the solid, by name; empty if it was not.
        picture: Figures of the picture, by name; empty without one.
        file: The name of the picture's file in the folder; "" without one.
    """

    number: int
    inputs: Mapping[str, Any]
    measured: Mapping[str, Any] = field(default_factory=dict)
    picture: Mapping[str, Any] = field(default_factory=dict)
    file: str = ""

    def as_json(self) -> dict[str, Any]:
        """Return plain values."""
        return {
            "number": self.number,
            "file": self.file,
            "inputs": dict(self.inputs),
            "picture": dict(self.picture),
            "measured": dict(self.measured),
        }


class SweepTable:
    """A table of a sweep.

    Attributes:
        rows: Its rows by number.

    Args:
        path: The file.
        inputs: The inputs.
        picture: The names of the figures of pictures.
        measured: The names of the measures.
        files: Whether each row has a file.
    """

    def __init__(
        self,
        path: Path,
        inputs: Inputs,
        picture: Sequence[str],
        measured: Sequence[str],
        *,
        files: bool,
    ) -> None:
        self.path = path
        self.rows: dict[int, SweepRow] = {}
        self._inputs = inputs
        self._picture, self._measured, self._files = tuple(picture), tuple(measured), files
        self._appender: LineAppender | None = None

    def earlier(self, *, fresh: bool) -> dict[int, SweepRow]:
        """Return the rows of an earlier run by number; a row that was cut off is left out.

        Args:
            fresh: Whether they are to be replaced: then there are none.

        Raises:
            SaveError: The file is no table of a sweep, or one of other inputs.
        """
        if not self.path.exists():
            return {}
        with opened("table", self.path, error=SaveError) as data:
            rows = _whole_rows(data.decode("utf-8", "replace"))
        if not rows:
            return {}
        header, *others = rows
        if header[:1] != [NUMBER] or not any(name.startswith(INPUT) for name in header):
            raise SaveError(
                f"{self.path} is no table of a sweep of this version: move it, or name another "
                "output"
            )
        if fresh:
            return {}
        own = [name for name in header if name.startswith(INPUT)]
        asked = [name for column in self._inputs.columns for name in column.headers]
        if set(own) != set(asked):
            other = min(set(own) ^ set(asked)).removeprefix(INPUT)
            which = "has" if other in (name.removeprefix(INPUT) for name in own) else "has no"
            raise self._of_other_inputs(f"{which} column of '{other}'")
        found = {}
        for cells in others:
            row = self._read(dict(zip(header, cells, strict=True)), asked)
            found[row.number] = row
        self._keep_measures(header, found)
        return found

    def _read(self, cells: Mapping[str, str], asked: Sequence[str]) -> SweepRow:
        """Return an earlier row.

        Raises:
            SaveError: Its inputs are others.
        """
        text = cells[NUMBER]
        index = int(text) - 1 if text.isascii() and text.isdigit() else -1
        if not 0 <= index < len(self._inputs.sets):
            raise self._of_other_inputs(f"has row '{text:.20}' of {len(self._inputs.sets)}")
        pairs = zip(self._inputs.columns, self._inputs.sets[index], strict=True)
        expected = [cell for column, value in pairs for cell in column.cells(value)]
        for name, cell in zip(asked, expected, strict=True):
            if cells[name] != cell:
                shown = name.removeprefix(INPUT)
                words = f"has '{shown}' {cells[name]:.40} in row {text}, and not {cell:.40}"
                raise self._of_other_inputs(words)
        return SweepRow(
            number=index + 1,
            inputs=self._inputs.named(index),
            measured=_values(cells, MEASURED),
            picture=_values(cells, PICTURE),
            file=cells.get(FILE, ""),
        )

    def _of_other_inputs(self, how: str) -> SaveError:
        return SaveError(
            f"{self.path} is of other inputs: it {how}; --fresh (fresh=True) replaces it, or name "
            "another output"
        )

    def _keep_measures(self, header: Sequence[str], rows: Mapping[int, SweepRow]) -> None:
        """Keep the columns of measures that an earlier run has made, if this one makes none."""
        if rows and not self._measured:
            names = [name.removeprefix(MEASURED) for name in header if name.startswith(MEASURED)]
            self._measured = tuple(names)

    @contextmanager
    def open(self, rows: Mapping[int, SweepRow]) -> Iterator[None]:
        """Write the table with the rows that there are; in the block, ``add`` adds others.

        At the end its rows are in the order of the inputs. A process that is killed leaves them in
        the order in which they came; of two with one number the last one holds.

        Raises:
            SaveError: It cannot be written, or another process adds to it.
        """
        self.rows = dict(rows)
        with only_writer(self.path):
            self._write()
            try:
                with appending(self.path) as self._appender:
                    yield
            except BaseException:
                with suppress(SaveError):
                    self._write()
                raise
            self._write()

    def add(self, row: SweepRow) -> None:
        """Add a row: it stays also if this process is killed.

        Raises:
            SaveError: It cannot be written.
        """
        assert self._appender is not None, "the table is open"
        self._appender.add(_line(self._cells(row)))
        self.rows[row.number] = row

    def _write(self) -> None:
        with replacement(self.path) as file:
            file.write(_line(self._header()))
            for number in sorted(self.rows):
                file.write(_line(self._cells(self.rows[number])))

    def _header(self) -> list[str]:
        return [
            NUMBER,
            *([FILE] if self._files else []),
            *(name for column in self._inputs.columns for name in column.headers),
            *(f"{PICTURE}{name}" for name in self._picture),
            *(f"{MEASURED}{name}" for name in self._measured),
        ]

    def _cells(self, row: SweepRow) -> list[str]:
        pairs = zip(self._inputs.columns, self._inputs.sets[row.number - 1], strict=True)
        return [
            str(row.number),
            *([row.file] if self._files else []),
            *(cell for column, value in pairs for cell in column.cells(value)),
            *(cell_of(row.picture.get(name)) for name in self._picture),
            *(cell_of(row.measured.get(name)) for name in self._measured),
        ]


def _line(cells: Sequence[str]) -> bytes:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue().encode()


def _whole_rows(text: str) -> list[list[str]]:
    """Return the rows of a table; without the last one if it was cut off."""
    rows: list[list[str]] = []
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    try:
        rows.extend(row for row in reader if row)
    except csv.Error as error:
        if "unexpected end" not in str(error):  # of what is between quotation marks
            raise SaveError(f"line {reader.line_num}: {error}") from None
    if rows and not text.endswith(("\n", "\r")):
        rows.pop()
    if rows and len(rows[-1]) != len(rows[0]):
        rows.pop()
    for number, row in enumerate(rows, 1):
        if len(row) != len(rows[0]):
            raise SaveError(f"row {number} has {len(row)} values for {len(rows[0])} columns")
    return rows


def _values(cells: Mapping[str, str], prefix: str) -> dict[str, Any]:
    """Return the values of a namespace by name; empty if there is none at all."""
    found = {
        name.removeprefix(prefix): text for name, text in cells.items() if name.startswith(prefix)
    }
    if not any(found.values()):
        return {}
    return {n: (text or None) if n in _TEXTS else _number(text) for n, text in found.items()}


def _number(text: str) -> int | float | str | None:
    """Return the number of a cell; None for an empty one."""
    for read in (int, float):
        try:
            return read(text)
        except ValueError:
            continue
    return text or None
