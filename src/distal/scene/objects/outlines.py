"""Drawings and letters as outlines: closed chains of lines and curves for ``fields.outlines``.

Input: an SVG path, or a text and a font (which ``lettering`` lays out). Output: a
``DrawnOutline``: the buffers of edges and the box around them. Input that cannot be read is an
error at the author's line. Paths and fonts are read by fontTools, an optional package.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

import numpy as np

from distal.diagnostics import LoadError, Span
from distal.foreign_files import need, reading, watched
from distal.lang.resources import Buffer
from distal.lang.source_places import author_place
from distal.packages import PackageError, imported
from distal.scene.objects.svg_grammar import draw_path
from distal.scene.tree.errors import refuse, refuse_kind

# A line (two points), a quadratic Bézier curve (three) or a cubic one (four); y points up.
Edge: TypeAlias = tuple[complex, ...]

# Largest deviation of a quadratic curve from the cubic that it approximates, as a fraction of the
# side of the outline's box.
TOLERANCE: Final = 1.0 / 4000.0
# A curve that deviates from a line by less than this fraction of its length becomes a line.
EDGE_BYTES: Final = 400  # of an edge and its points
_LOOK: Final = 1024  # edges between two looks at their number
STRAIGHT: Final = 1e-6


@dataclass(frozen=True, slots=True)
class DrawnOutline:
    """Closed chains of edges, as the buffers of ``fields.flats.outlines.outline``.

    Attributes:
        lines: Start and end of each line, a vec4 each.
        curves: Start, control point and end of each quadratic curve, three vec2 each.
        low: The lower left corner of the box around all edges.
        high: The upper right corner of this box.
    """

    lines: Buffer
    curves: Buffer
    low: tuple[float, float]
    high: tuple[float, float]


def svg_path(path: str, *, size: float | None = None, place: Span | None = None) -> DrawnOutline:
    """Return the outline of an SVG path; y points up, and the middle is at the origin.

    Open subpaths are closed by a line, as SVG does for filling.

    Args:
        path: The value of the path's attribute ``d``: "M 0 0 L 10 0 …".
        size: The larger of width and height; None keeps the drawing's own units.
        place: The author's line.

    Raises:
        SceneValueError: The path is invalid, or encloses no area.
        SceneTypeError: ``path`` is not a string.
    """
    place = place or author_place()
    if not isinstance(path, str):
        refuse_kind(f"an SVG path is a text, not {path!r:.40}", 'write "M 0 0 L 1 0 …"', place)
    pen = outline_pen(None, place)
    arc = font_tools("svgLib.path.arc", place).EllipticalArc
    hint = "give the attribute d of a <path>: M 0 0 L 1 0 …"
    try:
        with reading("drawing", "this SVG path", len(path)):
            watched(lambda: draw_path(path, pen, arc))
            upright = [tuple(p.conjugate() for p in edge) for edge in pen.finished()]
    except LoadError as error:
        refuse(error.message, hint, place)
    low, high = _corners(upright, "this SVG path", place)
    extent = max(high.real - low.real, high.imag - low.imag)
    if size is not None and not 0.0 < size < math.inf:
        refuse(f"size must be above 0, not {size}", None, place)
    scale = 1.0 if size is None else size / extent
    middle = 0.5 * (low + high)
    moved = [tuple((p - middle) * scale for p in edge) for edge in upright]
    return made_of(moved, "this SVG path", place)


def font_tools(module: str, place: Span | None) -> Any:
    """Import a module of fontTools.

    Raises:
        SceneValueError: The package is missing or broken.
    """
    try:
        return imported(f"fontTools.{module}")
    except PackageError as error:
        why = "" if error.is_missing else f": {error}"
        refuse(f"outlines need the package fontTools{why}", "pip install 'distal[text]'", place)


def outline_pen(glyphs: Any, place: Span | None) -> Any:
    """Return a fontTools pen that records edges; ``finished()`` returns them as closed chains."""
    base: Any = font_tools("pens.basePen", place).BasePen

    class OutlinePen(base):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__(glyphs)
            self.edges: list[Edge] = []
            self.start = self.at = 0j

        def _add(self, *points: tuple[float, float]) -> None:
            ahead = tuple(complex(*p) for p in points)
            self.edges.append((self.at, *ahead))
            if len(self.edges) % _LOOK == 0:
                need(len(self.edges) * EDGE_BYTES, f"{len(self.edges):,} edges")
            self.at = ahead[-1]

        def _moveTo(self, point: tuple[float, float]) -> None:  # noqa: N802
            self._closePath()
            self.start = self.at = complex(*point)

        def _lineTo(self, point: tuple[float, float]) -> None:  # noqa: N802
            self._add(point)

        def _curveToOne(self, *points: tuple[float, float]) -> None:  # noqa: N802
            self._add(*points)

        def _qCurveToOne(self, *points: tuple[float, float]) -> None:  # noqa: N802
            self._add(*points)

        def _closePath(self) -> None:  # noqa: N802
            if self.at != self.start:
                self.edges.append((self.at, self.start))
                self.at = self.start

        _endPath = _closePath  # noqa: N815

        def finished(self) -> list[Edge]:
            self._closePath()
            return self.edges

    return OutlinePen()


def made_of(edges: Iterable[Edge], what: str, place: Span | None) -> DrawnOutline:
    """Return the outline made of closed chains of edges.

    Args:
        edges: The edges, in any order.
        what: The name of the drawing in messages.
        place: The author's line.

    Raises:
        SceneValueError: The edges enclose no area, or a number is not finite.
    """
    given = list(edges)
    low, high = _corners(given, what, place)
    tolerance = TOLERANCE * max(high.real - low.real, high.imag - low.imag)
    lines: list[Edge] = []
    curves: list[Edge] = []
    for edge in given:
        for part in _parts(edge, tolerance):
            if len(part) == 3:
                curves.append(part)
            elif part[0] != part[1]:
                lines.append(part)
    # A buffer must not be empty: add an edge of length 0, which changes neither distance nor sign.
    anywhere = (lines or curves)[0][0]
    lines = lines or [(anywhere, anywhere)]
    curves = curves or [(anywhere, anywhere, anywhere)]
    segments = _numbers(lines).reshape(-1, 4)
    bows = _numbers(curves).reshape(-1, 2)
    points = np.concatenate([segments.reshape(-1, 2), bows])
    left, below = points.min(axis=0).tolist()
    right, above = points.max(axis=0).tolist()
    return DrawnOutline(Buffer(segments), Buffer(bows), (left, below), (right, above))


def _numbers(edges: Sequence[Edge]) -> Any:
    """Return two floats for each point."""
    return np.array(edges, np.complex128).view(np.float64)


def _corners(edges: Sequence[Edge], what: str, place: Span | None) -> tuple[complex, complex]:
    points = np.array([p for edge in edges for p in edge], np.complex128)
    if len(points) and not np.isfinite(points).all():
        refuse(f"{what} holds a number that is not finite", None, place)
    from_first = points - points[0] if len(points) else np.zeros(1, np.complex128)
    farthest = from_first[np.argmax(np.abs(from_first))]
    aside = np.abs((from_first * farthest.conjugate()).imag).max()
    if aside <= STRAIGHT * abs(farthest) ** 2:
        refuse(f"{what} encloses nothing", None, place)
    x, y = points.real, points.imag
    return complex(x.min(), y.min()), complex(x.max(), y.max())


def _parts(edge: Edge, tolerance: float) -> Iterator[Edge]:
    """Yield lines, and quadratic curves that are monotonic in y."""
    match len(edge):
        case 2:
            yield edge
        case 3:
            yield from _rising_or_falling(edge)
        case 4:
            for quadratic in _quadratics(edge, tolerance):
                yield from _rising_or_falling(quadratic)
        case count:
            raise AssertionError(f"an edge of {count} points")


def _quadratics(cubic: Edge, tolerance: float) -> Iterator[Edge]:
    """Yield quadratic curves within a tolerance of a cubic curve.

    A quadratic with the same ends and middle deviates from the cubic by at most sqrt(3)/36 of its
    third difference, which decreases with the cube of the number of parts.
    """
    a, b, c, d = cubic
    bend = abs(d - 3.0 * c + 3.0 * b - a)
    count = max(1, math.ceil((bend * math.sqrt(3.0) / 36.0 / tolerance) ** (1.0 / 3.0)))
    at = _cubic_at(cubic)
    for i in range(count):
        t, s = i / count, (i + 1) / count
        start, leaving = at(t)
        end, arriving = at(s)
        share = 0.25 / count
        yield start, 0.5 * (start + end) + share * (leaving - arriving), end


def _cubic_at(cubic: Edge) -> Callable[[float], tuple[complex, complex]]:
    """Return the position and velocity on a cubic curve as a function; its ends are exact."""
    a, b, c, d = cubic

    def at(t: float) -> tuple[complex, complex]:
        u = 1.0 - t
        place = u**3 * a + 3.0 * u * u * t * b + 3.0 * u * t * t * c + t**3 * d
        velocity = 3.0 * (u * u * (b - a) + 2.0 * u * t * (c - b) + t * t * (d - c))
        return (a if t == 0.0 else d if t == 1.0 else place), velocity

    return at


def _rising_or_falling(quadratic: Edge) -> Iterator[Edge]:
    """Cut a curve where its tangent is horizontal; return a line for a straight curve."""
    a, b, c = quadratic
    fall = a.imag - 2.0 * b.imag + c.imag
    t = (a.imag - b.imag) / fall if fall else -1.0
    if 0.0 < t < 1.0:
        first, second = a + (b - a) * t, b + (c - b) * t
        turn = first + (second - first) * t
        # Make the tangent exactly horizontal: rounding must not make a part non-monotonic.
        yield from _straightened(a, complex(first.real, turn.imag), turn)
        yield from _straightened(turn, complex(second.real, turn.imag), c)
    else:
        yield from _straightened(a, b, c)


def _straightened(a: complex, b: complex, c: complex) -> Iterator[Edge]:
    along, aside = c - a, b - a
    across = along.real * aside.imag - along.imag * aside.real
    between = 0.0 <= along.real * aside.real + along.imag * aside.imag <= abs(along) ** 2
    straight = abs(across) <= STRAIGHT * abs(along) ** 2 and between
    yield (a, c) if straight else (a, b, c)
