"""The record as a value and as a file.

``raw_rows`` reads what a recording wrote; ``Record.save`` and ``load`` keep it in one file,
``tests/record/rows.xz``: a header, then one bit for each test and function.
"""

from __future__ import annotations

import json
import lzma
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final

ROOT: Final = Path(__file__).parents[2]
PATH: Final = ROOT / "tests/record/rows.xz"


@dataclass(frozen=True)
class Row:
    """A test as recorded.

    Attributes:
        seconds: Processor time, that of its child processes included.
        functions: Each function that it runs, as a bit.
    """

    seconds: float
    functions: int


@dataclass(frozen=True)
class Record:
    """All recorded tests.

    Attributes:
        functions: "file:qualified name" for each bit.
        rows: By test id.
        digests: Of the text of each function when the rows that run it were recorded.
        chosen: The tests of ``make test``.
    """

    functions: tuple[str, ...]
    rows: Mapping[str, Row]
    digests: Mapping[str, str]
    chosen: frozenset[str] = frozenset()

    @cached_property
    def _places(self) -> dict[str, int]:
        return {name: i for i, name in enumerate(self.functions)}

    def mask(self, names: Iterable[str]) -> int:
        """Return the bits of the functions that the record knows."""
        return _mask(self._places[name] for name in names if name in self._places)

    def names(self, mask: int) -> list[str]:
        """Return the functions of a mask."""
        return [
            name
            for name, bit in zip(self.functions, reversed(f"{mask:b}"), strict=False)
            if bit == "1"
        ]

    def running(self, names: Iterable[str]) -> set[str]:
        """Return the tests that run any of some functions."""
        mask = self.mask(names)
        return {test for test, row in self.rows.items() if row.functions & mask}

    def seconds(self, tests: Iterable[str]) -> float:
        """Return the processor time of tests; those that the record does not know take none."""
        return sum(self.rows[test].seconds for test in tests if test in self.rows)

    def save(self, path: Path = PATH) -> None:
        """Write the file; equal records make equal files."""
        ids = sorted(self.rows)
        header = {
            "functions": [[name, self.digests.get(name, "")] for name in self.functions],
            "tests": [[i, self.rows[i].seconds, int(i in self.chosen)] for i in ids],
        }
        size = len(self.functions) + 7 >> 3
        matrix = b"".join(self.rows[i].functions.to_bytes(size, "little") for i in ids)
        path.parent.mkdir(parents=True, exist_ok=True)
        parts = (json.dumps(header, separators=(",", ":")).encode(), matrix)
        path.write_bytes(b"".join(lzma.compress(p, preset=9 | lzma.PRESET_EXTREME) for p in parts))


@dataclass(frozen=True)
class Plan:
    """What a run of the tests needs of the record.

    Attributes:
        seconds: Of each test.
        left_out: The tests that ``make test`` does not run.
    """

    seconds: Mapping[str, float]
    left_out: frozenset[str]


def plan(path: Path = PATH) -> Plan:
    """Return what the header says, which is read in an instant; nothing if there is no record."""
    tests = _read(path)[0]["tests"] if path.exists() else []
    left_out = frozenset(name for name, _, is_chosen in tests if not is_chosen)
    return Plan({name: seconds for name, seconds, _ in tests}, left_out)


def load(path: Path = PATH) -> Record:
    """Return the record of a file."""
    header, rest = _read(path)
    matrix = lzma.decompress(rest)
    digests, tests = dict(header["functions"]), header["tests"]
    size = len(digests) + 7 >> 3
    rows = {
        name: Row(seconds, int.from_bytes(matrix[k * size : (k + 1) * size], "little"))
        for k, (name, seconds, _) in enumerate(tests)
    }
    chosen = frozenset(name for name, _, is_chosen in tests if is_chosen)
    return Record(tuple(digests), rows, digests, chosen)


def _read(path: Path) -> tuple[dict[str, Any], bytes]:
    reader = lzma.LZMADecompressor()
    header = json.loads(reader.decompress(path.read_bytes()))
    return header, reader.unused_data


def raw_rows(folder: Path) -> dict[str, tuple[float, set[str]]]:
    """Return seconds and functions of each test of a recording, child processes included."""
    rows: dict[str, tuple[float, set[str]]] = {}
    for path in folder.glob("rows-*.jsonl"):
        for line in path.read_text("utf-8").splitlines():
            row = json.loads(line)
            rows[row["id"]] = (row["seconds"], set(row["functions"]))
    for path in folder.glob("child-*"):
        test, *names = path.read_text("utf-8").splitlines()
        owner = test.partition(" ")[2]
        if owner in rows:
            rows[owner][1].update(n for n in names if ".py:" in n and ":<" not in n)
    return rows


def merged(
    found: Mapping[str, tuple[float, set[str]]], digests: Mapping[str, str], before: Record | None
) -> Record:
    """Return a record with new rows; the others stay as they were.

    Args:
        found: Seconds and functions of the tests that were recorded.
        digests: Of the functions of the source as it is now.
        before: An older record.
    """
    rows: dict[str, tuple[float, Iterable[str]]] = {}
    stale: set[str] = set()
    if before is not None:
        kept = {test: row for test, row in before.rows.items() if test not in found}
        rows |= {test: (row.seconds, before.names(row.functions)) for test, row in kept.items()}
        # A function that an older row ran keeps its digest: that row may be out of date.
        stale = {name for _, functions in rows.values() for name in functions}
        digests = {**digests, **{n: d for n, d in before.digests.items() if n in stale}}
    rows |= found
    count = Counter(name for _, functions in rows.values() for name in functions)
    order = tuple(sorted(count, key=lambda f: (-count[f], f)))  # similar rows are alike in bytes
    place = {name: i for i, name in enumerate(order)}
    masks = {
        test: Row(seconds, _mask(place[name] for name in functions))
        for test, (seconds, functions) in rows.items()
    }
    digests = {name: digests[name] for name in order if name in digests}
    # A test that is new to the record is run by ``make test`` until one chooses again.
    chosen = before.chosen | (found.keys() - before.rows.keys()) if before else frozenset()
    return Record(order, masks, digests, chosen)


def _mask(places: Iterable[int]) -> int:
    """Return an integer with bits at places."""
    found = bytearray()
    for place in places:
        if place >> 3 >= len(found):
            found.extend(bytes((place >> 3) + 1 - len(found)))
        found[place >> 3] |= 1 << (place & 7)
    return int.from_bytes(found, "little")
