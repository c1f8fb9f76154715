"""Which folders of tests are about which package, by the record.

Input: a record. Output: for each package, folders that run most of its functions.
"""

from __future__ import annotations

from collections import defaultdict
from typing import Final

from tools.record.rows import Record

ENOUGH: Final = 0.95  # of the functions of a package that any test runs
HEAD: Final = "| package | its tests |\n|---|---|\n"


def package_of(function: str) -> str:
    """Return the package, or the module beside the packages, that a function is in."""
    parts = function.partition(":")[0].split("/")
    return parts[1].removesuffix(".py")


def folder_of(test: str) -> str:
    """Return the folder of a test, or its file if that stands for itself."""
    parts = test.partition("::")[0].split("/")
    return "/".join(parts[: 3 if parts[1] == "unit" else 2])


def functions_of(record: Record) -> dict[str, int]:
    """Return the functions of each package as a mask."""
    names: dict[str, list[str]] = defaultdict(list)
    for function in record.functions:
        names[package_of(function)].append(function)
    return {package: record.mask(found) for package, found in sorted(names.items())}


def share(record: Record, package: int, folders: list[str]) -> float:
    """Return the share of a package's functions that the tests of folders run."""
    ran = 0
    for name, row in record.rows.items():
        if folder_of(name) in folders:
            ran |= row.functions
    return (ran & package).bit_count() / package.bit_count()


def folders(record: Record, package: int) -> list[str]:
    """Return the folders of tests that are about a package.

    Whose tests run little else come first; the others follow for what those leave.
    """
    ran: dict[str, int] = defaultdict(int)
    every: dict[str, int] = defaultdict(int)
    here: dict[str, int] = defaultdict(int)
    for name, row in record.rows.items():
        ran[folder_of(name)] |= row.functions & package
        every[folder_of(name)] += row.functions.bit_count()
        here[folder_of(name)] += (row.functions & package).bit_count()
    chosen: list[str] = []
    left = package
    while left.bit_count() > (1.0 - ENOUGH) * package.bit_count():
        gains = {f: (ran[f] & left).bit_count() * here[f] / (every[f] + 1) for f in sorted(ran)}
        chosen.append(max(gains, key=gains.__getitem__))
        left &= ~ran[chosen[-1]]
    return chosen


def table(record: Record) -> str:
    """Return the table of CONTRIBUTING."""
    return HEAD + "".join(
        f"| `{package}` | {', '.join(f'`{f}`' for f in folders(record, mask))} |\n"
        for package, mask in functions_of(record).items()
    )


def rows_of(text: str) -> dict[str, list[str]]:
    """Return the rows of the table in a document."""
    lines = text.partition(HEAD)[2].partition("\n\n")[0].splitlines()
    cells = (line.strip("|").replace("`", "").split("|") for line in lines)
    return {package.strip(): [f.strip() for f in rest.split(",")] for package, rest in cells}


def with_table(text: str, record: Record) -> str:
    """Return a document with the table of a record in the place of its own."""
    start, _, rest = text.partition(HEAD)
    return start + table(record) + "\n" + rest.partition("\n\n")[2]
