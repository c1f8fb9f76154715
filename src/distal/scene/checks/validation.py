"""Validation of a tree of shapes: its guarantees, its bounds, and measurements of both.

Input: a shape. Output: a ``ValidationReport``: figures for each shape, and findings, each with its
place in the author's file; also as plain values for editors (``ValidationReport.as_json``).
"""

from __future__ import annotations

import math
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, Final

from distal.diagnostics import Diagnostic, place_json
from distal.error_codes import ErrorCode
from distal.fields.boxes import given_slope
from distal.fields.guarantees import EXACT, Guarantee, Operator, Primitive, ended
from distal.scene.checks.bounds_report import NodeBounds, bounds_of_nodes
from distal.scene.checks.flush_cuts import FlushCut, flush_cuts
from distal.scene.checks.measuring import Measured, Region, measure
from distal.scene.checks.moved_faces import moved_face
from distal.scene.checks.piece_report import BrickReport, PieceReport, bricks_of, pieces_of
from distal.scene.checks.proof_report import proof_note
from distal.scene.checks.table_report import TableReport, table_of
from distal.scene.objects.field import BaseShape
from distal.scene.tree.node import Node

# Measuring a shape may compile its function; of more shapes, only the most important are measured.
MOST_MEASURED: Final = 24
# Tolerance: bounds are computed in 32 bits, and 64 bits do not resolve closer values at a crease.
ROUNDING: Final = 1e-4
# Next to creases, some points do not lead to the surface although the distance is exact.
TOO_LARGE: Final = 100.0  # how many times what was measured
ON_FOOT: Final = 0.98

# Findings at a point, after which nothing is proved.
_MEASURED_WRONG: Final = (ErrorCode.SLOPE_EXCEEDED, ErrorCode.UNDEFINED)


class Severity(Enum):
    """Severity of a finding; an error is a guarantee that does not hold."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True, slots=True)
class CheckFinding:
    """A finding about one shape.

    Attributes:
        shape: Index of the shape in ``ValidationReport.shapes``.
    """

    severity: Severity
    shape: int
    diagnostic: Diagnostic

    def __str__(self) -> str:
        return self.diagnostic.text(self.severity.value)


@dataclass(frozen=True, slots=True)
class ShapeReport:
    """The report about one shape; a shape used several times is listed once.

    Attributes:
        children: Indices of the shapes that it is made of.
        raised: The slope of the steepest child if the shape's own is larger, else None.
        measured: Measured figures, or None if it was not measured.
    """

    node: Node
    children: tuple[int, ...]
    declared: NodeBounds
    raised: float | None
    measured: Measured | None


@dataclass(frozen=True, slots=True)
class ValidationReport:
    """The report about a tree; the first shape is the whole.

    Attributes:
        slope_from: Indices of the shapes that increase the slope of the whole, outermost first.
        table: The table of parts, or None. Then the shapes are one of each kind of parts, and those
            beside the table.
        pieces: The pieces as which pictures draw joined shapes, or None.
        bricks: What is known of joined shapes that are not drawn as pieces.
    """

    shapes: tuple[ShapeReport, ...]
    slope_from: tuple[int, ...]
    findings: tuple[CheckFinding, ...]
    table: TableReport | None = None
    pieces: PieceReport | None = None
    bricks: tuple[BrickReport, ...] = ()

    @property
    def holds(self) -> bool:
        """Whether no violated guarantee was found."""
        return not any(f.severity is Severity.ERROR for f in self.findings)

    def as_json(self) -> dict[str, Any]:
        """Return plain values in the schema of ``docs/guide/checking.md``."""
        return {
            "version": 1,
            "holds": self.holds,
            "slope_from": list(self.slope_from),
            "table": None if self.table is None else self.table.as_json(),
            "pieces": None if self.pieces is None else self.pieces.as_json(),
            "bricks": [shapes.as_json() for shapes in self.bricks],
            "shapes": [_shape_json(i, row) for i, row in enumerate(self.shapes)],
            "findings": [
                {
                    "severity": f.severity.value,
                    "shape": f.shape,
                    "place": place_json(f.diagnostic.span),
                    **f.diagnostic.to_json(),
                }
                for f in self.findings
            ],
        }


def check(
    shape: BaseShape, params: Mapping[str, Any] | None = None, time: float = 0.0, seed: int = 0
) -> ValidationReport:
    """Validate a shape and all its parts.

    Args:
        shape: The whole shape.
        params: Values of parameters by name; the others have their defaults.
        time: Time in seconds.
        seed: Seed of the random points.
    """
    given = dict(params or {})
    table, root = table_of(shape.node)
    nodes = list(root.walk())
    numbers = {id(node): i for i, node in enumerate(nodes)}
    declared = bounds_of_nodes(root, given, time)
    chosen = {id(n) for n in _worth_measuring(nodes, declared)}
    regions = _regions(nodes, declared)
    rows = []
    for node in nodes:
        own = declared[id(node)]
        measured = None
        if id(node) in chosen:
            measured = measure(BaseShape._of(node), own, given, time, seed, regions[id(node)])
        children = tuple(numbers[id(c)] for c in node.children)
        rows.append(ShapeReport(node, children, own, _raised(node, declared), measured))
    found = [f for i, row in enumerate(rows) for f in _findings(i, row, rows)]
    found += _moved_faces(
        [i for i, row in enumerate(rows) if id(row.node) in chosen], rows, given, time, seed
    )
    found += _proofs(
        rows, {f.shape for f in found if f.diagnostic.code in _MEASURED_WRONG}, given, time
    )
    found += _cuts_at_faces(numbers, flush_cuts(shape.node, given, time, seed))
    order = {severity: i for i, severity in enumerate(Severity)}
    found = sorted(_at_their_roots(found, rows), key=lambda f: order[f.severity])
    pieces, bricks = pieces_of(shape.node), bricks_of(shape.node)
    return ValidationReport(tuple(rows), _slope_from(rows), tuple(found), table, pieces, bricks)


def _regions(nodes: Sequence[Node], declared: Mapping[int, NodeBounds]) -> dict[int, Region | None]:
    """Return where to measure each shape that has no box, by the id of its node.

    That is the box of the smallest whole that it is a part of and that has one, otherwise the box
    around all shapes that have one. Coordinates of moved parts differ, so this is only where values
    probably matter.
    """
    found: dict[int, Region | None] = {}
    boxes = [declared[id(n)] for n in nodes if declared[id(n)].finite and not n.flat]
    found[id(nodes[0])] = None
    if boxes:
        low = tuple(min(box.low[i] for box in boxes) for i in range(3))
        high = tuple(max(box.high[i] for box in boxes) for i in range(3))
        found[id(nodes[0])] = (low, high)
    for node in nodes:  # parents before at least one path to each child
        own = declared[id(node)]
        held = (own.low, own.high) if own.finite else found[id(node)]
        for child in node.children:
            if child.flat == node.flat:
                found.setdefault(id(child), held)
            else:
                found.setdefault(id(child), None)
    return found


def _at_their_roots(
    found: Sequence[CheckFinding], rows: Sequence[ShapeReport]
) -> list[CheckFinding]:
    """Drop the errors of shapes that only inherit the error of one of their parts."""
    errors = [f for f in found if f.severity is Severity.ERROR]
    wrong = {(f.diagnostic.code, id(rows[f.shape].node)) for f in errors}

    def is_passed_on(f: CheckFinding) -> bool:
        below = list(rows[f.shape].node.walk())[1:]
        return f.severity is Severity.ERROR and any(
            (f.diagnostic.code, id(n)) in wrong for n in below
        )

    return [f for f in found if not is_passed_on(f)]


def _worth_measuring(nodes: Sequence[Node], declared: Mapping[int, NodeBounds]) -> list[Node]:
    """Return the shapes to measure.

    Of a small tree all shapes; of a large tree the whole, the author's functions, and steep shapes.
    """
    if len(nodes) <= MOST_MEASURED:
        return list(nodes)

    def rank(node: Node) -> int:
        if node is nodes[0]:
            return 0
        if is_own(node):
            return 1
        raises = _raised(node, declared) is not None
        return 2 if raises else 3 if node.label else 4

    worth = [n for n in sorted(nodes, key=rank) if rank(n) < 4]
    return worth[:MOST_MEASURED]


def is_own(node: Node) -> bool:
    """Return whether a shape is an author's own function."""
    return isinstance(node.rule, Primitive) and node.rule.slope is given_slope


def _raised(node: Node, declared: Mapping[int, NodeBounds]) -> float | None:
    before = max((declared[id(c)].slope for c in node.children), default=1.0)
    return before if declared[id(node)].slope > before * (1.0 + ROUNDING) else None


def _slope_from(rows: Sequence[ShapeReport]) -> tuple[int, ...]:
    """Return the shapes that increase the slope, from the whole down the steepest children."""
    at, found = 0, []
    while True:
        row = rows[at]
        if row.raised is not None:
            found.append(at)
        if not row.children:
            return tuple(found)
        at = max(row.children, key=lambda c: rows[c].declared.slope)


# Findings


def _findings(i: int, row: ShapeReport, rows: Sequence[ShapeReport]) -> Iterator[CheckFinding]:
    def finding(
        severity: Severity, code: ErrorCode, message: str, hint: str | None = None
    ) -> CheckFinding:
        return CheckFinding(severity, i, Diagnostic(code, message, row.node.place, hint))

    if row.measured is not None:
        yield from _violations(row, row.measured, finding)
    if is_own(row.node) and not row.node.signed:
        message = f"'{row.node.name}' has no inside: it is drawn a third of a pixel thick"
        yield finding(Severity.NOTE, ErrorCode.NO_INSIDE, message, "signed=True if it is a solid")
    if row.raised is not None:
        message = (
            f"{described(row.node)} raises the slope from {row.raised:.3g} "
            f"to {row.declared.slope:.3g}"
        )
        if is_own(row.node) or isinstance(row.node.rule, Primitive):
            message = f"{described(row.node)} has the slope {row.declared.slope:.3g}"
        yield finding(Severity.NOTE, ErrorCode.SLOPE_RAISED, message)
    inner = [rows[c] for c in row.children]
    if _is_empty(row) and not any(map(_is_empty, inner)) and row.children:
        kind = "area" if row.node.flat else "volume"
        message = f"{described(row.node)} is empty: its box has no {kind}"
        hint = "the side that is kept, or that both have in common, holds nothing"
        yield finding(Severity.WARNING, ErrorCode.NO_INSIDE, message, hint)
    if not row.declared.finite and all(r.declared.finite for r in inner):
        yield _endless(row, finding)
    if isinstance(row.node.rule, Operator):
        yield from _of_operator(row, [r.node for r in inner], finding)


def _is_empty(row: ShapeReport) -> bool:
    n = 2 if row.node.flat else 3
    own = row.declared
    return any(low >= high for low, high in zip(own.low[:n], own.high[:n], strict=True))


def _proofs(
    rows: Sequence[ShapeReport], wrong: Container[int], params: Mapping[str, Any], time: float
) -> Iterator[CheckFinding]:
    """Yield what is proved or refuted of the author's functions.

    Args:
        rows: The reports about all shapes.
        wrong: Those for which a point refutes the slope already.
        params: Values of parameters by name.
        time: Time in seconds.
    """
    for i, row in enumerate(rows):
        if row.measured is None or i in wrong or not is_own(row.node):
            continue
        note = proof_note(row.node, row.declared, params, time)
        if note is not None:
            severity = Severity.ERROR if note.code is ErrorCode.SLOPE_REFUTED else Severity.NOTE
            diagnostic = Diagnostic(note.code, note.message, row.node.place, note.hint)
            yield CheckFinding(severity, i, diagnostic)


def _cuts_at_faces(numbers: Mapping[int, int], cuts: Iterable[FlushCut]) -> Iterator[CheckFinding]:
    """Yield the cutters that end exactly on a face.

    Args:
        numbers: The indices of shapes, by the id of their node.
        cuts: The cutters.
    """
    for cut in cuts:
        leaf, hint = cut.cutter.leaf, "let it go through by a little"
        diagnostic = Diagnostic(ErrorCode.FLUSH_FACES, cut.message, leaf.place, hint)
        yield CheckFinding(Severity.WARNING, numbers.get(id(leaf), 0), diagnostic)


def _moved_faces(
    chosen: Sequence[int],
    rows: Sequence[ShapeReport],
    params: Mapping[str, Any],
    time: float,
    seed: int,
) -> Iterator[CheckFinding]:
    """Yield how far blends move faces where there is no edge.

    Args:
        chosen: The shapes to look at.
        rows: The reports about all shapes.
        params: Values of parameters by name.
        time: Time in seconds.
        seed: Seed of the random places.
    """
    declared = {id(row.node): row.declared for row in rows}
    for i in chosen:
        node = rows[i].node
        moved = moved_face(node, declared, params, time, seed)
        if moved is None:
            continue
        severity = Severity.WARNING if moved.kind.keeps_faces else Severity.NOTE
        message, hint = moved.text(described(node))
        diagnostic = Diagnostic(ErrorCode.FLUSH_FACES, message, node.place, hint)
        yield CheckFinding(severity, i, diagnostic)


def _violations(row: ShapeReport, measured: Measured, finding: Any) -> Iterator[CheckFinding]:
    name, own = row.node.name, is_own(row.node)
    severity = Severity.WARNING if row.node.estimate else Severity.ERROR
    if measured.undefined_at is not None:
        message = f"'{name}' is not a number at {shown_point(measured.undefined_at)}"
        yield finding(
            Severity.ERROR, ErrorCode.UNDEFINED, message, "look for a division by 0, a root below 0"
        )
    if _exceeds(measured.slope, row.declared.slope):
        message = f"'{name}' declares the slope {row.declared.slope:.4g}, but its value changes by "
        if measured.steepest >= measured.largest_change:
            message += f"{measured.steepest:.4g} per unit at {shown_point(measured.steepest_at)}"
        else:
            p, q = map(shown_point, measured.change_between)
            message += f"{measured.largest_change:.4g} per unit from {p} to {q}"
        hint = f"slope={_rounded_up(measured.slope)}" if own else None
        yield finding(severity, ErrorCode.SLOPE_EXCEEDED, message, hint)
    elif own and row.declared.slope > TOO_LARGE * max(measured.slope, 1.0):
        message = (
            f"'{name}' has the slope {row.declared.slope:.4g}, and its value changes by at most "
            f"{measured.slope:.4g} per unit: rays need many steps"
        )
        hint = f"slope={_rounded_up(measured.slope)}, if no place is steeper"
        yield finding(Severity.WARNING, ErrorCode.SLOPE_TOO_LARGE, message, hint)
    elif measured.steepest_around_at is not None and _exceeds(
        measured.steepest_around, row.declared.slope
    ):
        at = shown_point(measured.steepest_around_at)
        message = (
            f"'{name}' changes by {measured.steepest_around:.4g} per unit at {at}, outside its "
            f"bounds, more than its declared slope {row.declared.slope:.4g}"
        )
        hint = f"slope={_rounded_up(measured.steepest_around)} if rays come through there"
        # The author's slope may be about the declared bounds only; the library's is everywhere.
        around = Severity.WARNING if own else severity
        yield finding(around, ErrorCode.SLOPE_OUTSIDE_BOX, message, hint if own else None)
    if measured.outside_box is not None:
        message = f"'{name}' reaches outside its box, to {shown_point(measured.outside_box)}"
        hint = "bounds=(low, high) hold all of it" if own else None
        yield finding(Severity.ERROR, ErrorCode.OUTSIDE_BOX, message, hint)
    if row.node.claims >= EXACT and measured.on_foot < ON_FOOT:
        share = f"{100.0 * (1.0 - measured.on_foot):.0f} %"
        message = f"'{name}' is declared exact, but {share} of its values are not the distance"
        yield finding(Severity.ERROR, ErrorCode.NOT_EXACT, message, "exact=False" if own else None)


def _exceeds(measured: float, declared: float) -> bool:
    return measured > declared * (1.0 + ROUNDING) + ROUNDING


def _endless(row: ShapeReport, finding: Any) -> CheckFinding:
    unknown = _without_growth(row.node)
    if unknown is not None:
        message = (
            f"{described(row.node)} has no box: how fast '{unknown.name}' rises outside its "
            "bounds is not known"
        )
        hint = f"growth=1 for '{unknown.name}' if it is at least the distance to its bounds"
        grown: CheckFinding = finding(Severity.WARNING, ErrorCode.NO_GROWTH, message, hint)
        return grown
    message = f"{described(row.node)} has no finite bounding box, so every ray has to look for it"
    if is_own(row.node):
        hint = "give its corners: bounds=((x, y, z), (x, y, z))"
        found: CheckFinding = finding(Severity.WARNING, ErrorCode.NO_BOX, message, hint)
    else:
        found = finding(Severity.NOTE, ErrorCode.NO_BOX, message)
    return found


def _without_growth(node: Node) -> Node | None:
    """Return the author's function without ``growth`` that leaves an operator without a box."""
    rule = node.rule
    if not isinstance(rule, Operator) or rule.bounds is None:
        return None
    asked = rule.bounds.python_function.__annotations__
    if not any(name.startswith("side_growth") for name in asked):
        return None
    for part in node.walk():
        silent = isinstance(part.rule, Primitive) and part.rule.growth is None
        if silent and is_own(part) and Guarantee.EXACT_OUTSIDE not in part.claims:
            return part
    return None


def _of_operator(row: ShapeReport, inner: Sequence[Node], finding: Any) -> Iterator[CheckFinding]:
    rule = row.node.rule
    if isinstance(rule, Operator) and not rule.local and len(inner) > 1:
        message = f"{rule.name} changes shapes everywhere, not only where they meet"
        yield finding(
            Severity.WARNING, ErrorCode.BLEND_EVERYWHERE, message, "blend='cubic' keeps far parts"
        )
    lost = [c for c in Guarantee if c not in row.node.claims and all(c in n.claims for n in inner)]
    # If the slope is at most 1, the value never exceeds the distance.
    lost = [
        c for c in lost if c is not Guarantee.LOWER_BOUND or row.declared.slope > 1.0 + ROUNDING
    ]
    if lost:
        words = {Guarantee.LOWER_BOUND: "a lower bound"}
        lost_names = ", ".join(words.get(c, c.value) for c in lost)
        message = f"{described(row.node)} is no longer {lost_names}"
        yield finding(Severity.NOTE, ErrorCode.CLAIM_LOST, message)


# Text of messages


def described(node: Node) -> str:
    """Return a shape as the author wrote it: "twist(rate=3)"."""
    arguments = []
    of_bounds = ("slope", "low", "high") if is_own(node) else ()
    for name, value in node.numbers.items():
        plain = value.plain
        if name not in of_bounds and plain is not None:
            arguments.append(f"{name}={_shown(plain)}")
    arguments += [f"{n}={v}" for n, v in node.constants.items() if isinstance(v, bool | int)]
    own = f"{node.rule.name}({', '.join(arguments)})" if arguments else node.rule.name
    return f"'{node.label}' ({own})" if node.label else own


def _shown(plain: float | tuple[float, ...]) -> str:
    return shown_point(plain) if isinstance(plain, tuple) else f"{ended(plain):.4g}"


def shown_point(p: Sequence[float]) -> str:
    """Return a point as text."""
    return f"({', '.join(f'{ended(c):.4g}' for c in p)})"


def _rounded_up(slope: float) -> str:
    """Return a measured slope, rounded up to two digits."""
    digits = max(1 - math.floor(math.log10(slope)), 0)
    return f"{math.ceil(1.03 * slope * 10**digits) / 10**digits:.{digits}f}"


# Plain values


def _shape_json(i: int, row: ShapeReport) -> dict[str, Any]:
    node, declared = row.node, row.declared
    n = 2 if node.flat else 3
    return {
        "id": i,
        "name": node.name,
        "kind": node.rule.name,
        "own_function": is_own(node),
        "flat": node.flat,
        "children": list(row.children),
        "place": place_json(node.place),
        "claims": guarantee_names(node),
        "slope": _plain(declared.slope),
        "slope_before": None if row.raised is None else _plain(row.raised),
        "estimate": node.estimate,
        "bounds": {
            "low": [_plain(c) for c in declared.low[:n]],
            "high": [_plain(c) for c in declared.high[:n]],
        },
        "measured": None if row.measured is None else _measured_json(row.measured),
    }


def guarantee_names(node: Node) -> list[str]:
    """Return the names of a shape's guarantees, in a fixed order."""
    return [c.value for c in Guarantee if c in node.claims]


def _measured_json(measured: Measured) -> dict[str, Any]:
    return {
        "points": measured.points,
        "gradient_median": _plain(measured.median),
        "gradient_99": _plain(measured.most_of_99),
        "gradient_max": _plain(measured.steepest),
        "gradient_max_at": [_plain(c) for c in measured.steepest_at],
        "change_max": _plain(measured.largest_change),
        "change_max_between": [[_plain(c) for c in p] for p in measured.change_between],
    }


def _plain(value: float) -> float | None:
    """Round to six digits; None for infinity, which JSON lacks."""
    return float(f"{value:.6g}") if math.isfinite(value) else None
