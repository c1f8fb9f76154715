"""``distal check``: show what shapes guarantee, where slope comes from, and what is violated.

Input: parsed arguments. Output: a tree of shapes and findings with their lines, or the same as JSON
for editors; exit code 1 if a guarantee is violated.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

from distal.cli.arguments import read_assignments, read_time
from distal.cli.base import (
    JsonOption,
    SceneArgument,
    SetOption,
    TimeOption,
    answer,
    application,
    load,
    reporting,
)
from distal.cli.exit_codes import ExitCode
from distal.cli.surroundings import check_processor
from distal.diagnostics import LoadError
from distal.error_codes import ErrorCode

if TYPE_CHECKING:
    from distal.diagnostics import Span
    from distal.scene.checks.validation import CheckFinding, ShapeReport, ValidationReport

# The tree is cut at this depth; a shared shape is expanded only once.
DEEPEST = 12
MOST_ROWS = 60


@application.command()
@reporting
def check(
    scene: SceneArgument,
    at: TimeOption = "0",
    assignments: SetOption = None,
    seed: Annotated[int, typer.Option(min=0, help="What random points start from.")] = 0,
    as_json: JsonOption = False,
) -> None:
    """Show what shapes guarantee, where slope comes from, and which guarantees do not hold."""
    from distal.scene.checks.validation import check as run_checks
    from distal.scene.objects.field import BaseShape
    from distal.scene.scene import Scene

    seconds = read_time(at)
    check_processor()
    obj: Any = load(scene)
    if not isinstance(obj, BaseShape | Scene):
        message = f"'{obj.name}' is no scene and no shape; guarantees are checked of these"
        raise LoadError(message)
    values = read_assignments(assignments or (), obj.parameters())
    shape = obj.subject if isinstance(obj, Scene) else obj
    report = run_checks(shape, values, seconds, seed)
    if as_json:
        answer(json.dumps({**report.as_json(), "name": obj.name}))
    else:
        answer("\n".join(report_lines(report)))
    if not report.holds:
        raise typer.Exit(ExitCode.FAILED)


def report_lines(report: ValidationReport) -> Iterator[str]:
    """Yield the lines of the report."""
    yield from _tree(report)
    yield from _table(report)
    yield from _pieces(report)
    yield from _bricks(report)
    yield ""
    yield from _slope(report)
    yield from _measurements(report)
    # The source of the slope of the whole is already shown above.
    said = [
        f
        for f in report.findings
        if f.diagnostic.code is not ErrorCode.SLOPE_RAISED or not _is_in(f, report)
    ]
    for finding, more in _gathered(said):
        yield ""
        yield str(finding)
        if more:
            yield f"   = and {more} more like it from this line"


def _tree(report: ValidationReport) -> Iterator[str]:
    rows = list(_rows(report))
    shown = rows[:MOST_ROWS]
    widths = [max(len(row[column]) for row in shown) for column in range(3)]
    for row in shown:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=False))
        yield "  ".join((*cells, row[3])).rstrip()
    if len(rows) > MOST_ROWS:
        yield f"… and {len(rows) - MOST_ROWS} more; --json lists all"


def _table(report: ValidationReport) -> Iterator[str]:
    """Yield what is known of the table of parts."""
    table = report.table
    if table is None:
        return
    yield ""
    kinds = "one kind" if len(table.kinds) == 1 else f"{len(table.kinds)} kinds"
    parts = f"{table.count:,} parts of {kinds}"
    yield f"{parts} are drawn through a tree of boxes; one of each is shown"
    for kind in table.kinds[:MOST_ROWS]:
        numbers = f"{kind.columns} numbers each"
        yield f"  {kind.count:,} {kind.name}, {numbers}  {_line(kind.place)}".rstrip()
    gathered = Counter((b.name, b.reason, _line(b.place)) for b in table.beside)
    for (name, reason, line), count in list(gathered.items())[:MOST_ROWS]:
        times = f" ({count} times)" if count > 1 else ""
        yield f"  beside it: {name}{times}: {reason}  {line}".rstrip()


def _pieces(report: ValidationReport) -> Iterator[str]:
    """Yield how joined shapes are drawn."""
    pieces = report.pieces
    if pieces is None:
        return
    yield ""
    if pieces.count:
        steps = f"programs of {pieces.mean:.1f} steps, {pieces.longest} at most"
        size = f"{pieces.bytes / 1e6:.2f} MB"
        yield f"joined shapes are drawn as {pieces.count:,} pieces with {steps}, {size}"
    else:
        yield "joined shapes are drawn together, each at each point"
    for whole in pieces.whole[:MOST_ROWS]:
        yield f"  {whole.name} is not taken apart: {whole.reason}  {_line(whole.place)}".rstrip()


def _bricks(report: ValidationReport) -> Iterator[str]:
    """Yield what is known of joined shapes that are not drawn as pieces."""
    for shapes in report.bricks[:MOST_ROWS]:
        many, line = f"{shapes.count:,} joined shapes", _line(shapes.place)
        if shapes.reason:
            yield f"  {many} are asked at each point: {shapes.reason}  {line}".rstrip()
            continue
        steps = f"programs of {shapes.mean:.1f} steps, {shapes.longest} at most"
        size = f"{shapes.bytes / 1e6:.2f} MB"
        yield f"  {many} have {shapes.bricks:,} bricks with {steps}, {size}  {line}".rstrip()


def _rows(report: ValidationReport) -> Iterator[tuple[str, str, str, str]]:
    """Yield a table row for each shape: name, slope, guarantees, box and line."""
    seen: set[int] = set()
    stack = [(0, 0)]
    while stack:
        i, depth = stack.pop()
        row = report.shapes[i]
        if i in seen or depth > DEEPEST:
            continue
        seen.add(i)
        stack.extend((c, depth + 1) for c in reversed(row.children))
        yield (
            "  " * depth + row.node.name,
            f"slope {row.declared.slope:.3g}" + (" (estimate)" if row.node.estimate else ""),
            _claims(row),
            f"{_box(row)}  {_line(row.node.place)}".rstrip(),
        )


def _claims(row: ShapeReport) -> str:
    from distal.scene.checks.validation import guarantee_names

    claims = guarantee_names(row.node)
    if len(claims) == 3:
        return "exact"
    return ", ".join(claims) or "-"


def _box(row: ShapeReport) -> str:
    n = 2 if row.node.flat else 3
    low, high = row.declared.low[:n], row.declared.high[:n]
    if not any(map(math.isfinite, (*low, *high))):
        return "no box"
    return f"box {_corner(low)} to {_corner(high)}"


def _corner(corner: Sequence[float]) -> str:
    return f"({', '.join(f'{c:.3g}' for c in corner)})"


def _line(place: Span | None) -> str:
    return "" if place is None else f"{place.file}:{place.line}"


def _slope(report: ValidationReport) -> Iterator[str]:
    """Yield the sources of the whole's slope: which shapes raised it, by how much, and where."""
    from distal.scene.checks.validation import described

    whole = report.shapes[0]
    yield f"slope of '{whole.node.name}': {whole.declared.slope:.3g}"
    for i in reversed(report.slope_from):
        row = report.shapes[i]
        where = f" at {_line(row.node.place)}" if row.node.place else ""
        if row.children:
            yield (
                f"  {described(row.node)} raises the slope from {row.raised:.3g} "
                f"to {row.declared.slope:.3g}{where}"
            )
        else:
            yield f"  {described(row.node)} has the slope {row.declared.slope:.3g}{where}"


def _measurements(report: ValidationReport) -> Iterator[str]:
    measured = [row for row in report.shapes if row.measured is not None]
    count, all_of_them = len(measured), len(report.shapes)
    whole = report.shapes[0].measured
    assert whole is not None
    yield (
        f"measured at {whole.points} points: |gradient| median {whole.median:.3g}, "
        f"99 % at most {whole.most_of_99:.3g}, maximum {whole.steepest:.3g}"
    )
    yield f"between two points the value changes by at most {whole.largest_change:.3g} per unit"
    if count < all_of_them:
        yield f"{count} of {all_of_them} shapes were measured"


def _is_in(finding: CheckFinding, report: ValidationReport) -> bool:
    return finding.shape in report.slope_from


def _gathered(findings: Sequence[CheckFinding]) -> list[tuple[CheckFinding, int]]:
    """Group findings of the same kind and line; return each with the number of further ones."""
    groups: dict[Any, list[CheckFinding]] = {}
    for finding in findings:
        key = (finding.severity, finding.diagnostic.code, finding.diagnostic.span)
        groups.setdefault(key, []).append(finding)
    return [(group[0], len(group) - 1) for group in groups.values()]
