"""``distal probe``: show what one pixel of a scene sees, or the locals of an ``@image`` there.

Input: parsed arguments. Output: ray, march, shape and material in words, with the author's line; of
an image the value of every local; or the same as JSON for editors.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from distal.cli.arguments import read_assignments, read_pixel, read_size, read_time
from distal.cli.base import (
    JsonOption,
    SceneArgument,
    SetOption,
    SizeOption,
    TimeOption,
    answer,
    application,
    load,
    reporting,
)
from distal.cli.surroundings import check_processor
from distal.diagnostics import LoadError, excerpt
from distal.lang.srgb import hex_of

if TYPE_CHECKING:
    from distal.diagnostics import Span
    from distal.scene.checks.probe import Probed
    from distal.scene.checks.probe_image import ProbedImage


LONGEST: Final = 56  # letters of an author's line beside a value


@application.command()
@reporting
def probe(
    scene: SceneArgument,
    pixel: Annotated[
        str,
        typer.Option(
            "--at", metavar="X,Y", help="Column and row from the upper left.", show_default=False
        ),
    ],
    size: SizeOption = "640x480",
    at: TimeOption = "0",
    assignments: SetOption = None,
    as_json: JsonOption = False,
) -> None:
    """Show what one pixel sees: its ray, the march, the shape; of an @image its locals."""
    from distal.lang.functions import Func, Image
    from distal.lang.render_options import LARGEST_SIDE_PX
    from distal.scene.checks.probe import probe as look
    from distal.scene.viewing.viewable import viewable

    width_height, seconds = read_size(size, LARGEST_SIDE_PX), read_time(at)
    place = read_pixel(pixel, width_height)
    check_processor()
    obj: Any = load(scene)
    if isinstance(obj, Func) and not isinstance(obj, Image):
        message = f"'{obj.name}' is no scene, shape or @image; pixels are probed of these"
        raise LoadError(message)
    values = read_assignments(assignments or (), obj.parameters())
    if isinstance(obj, Image):
        from distal.scene.checks.probe_image import probe_image

        seen_locals = probe_image(obj, place, width_height, values, seconds)
        if as_json:
            answer(json.dumps({**seen_locals.as_json(), "time": seconds}))
        else:
            answer("\n".join(local_lines(seen_locals, seconds)))
        return
    seen = viewable(obj, values, seconds)
    assert seen.scene is not None  # images were refused
    found = look(seen.scene, place, width_height, values, seconds)
    if as_json:
        answer(json.dumps({**found.as_json(), "time": seconds}))
    else:
        answer("\n".join(report_lines(found, seconds)))


def report_lines(found: Probed, seconds: float) -> Iterator[str]:
    """Yield a text report of what a pixel sees."""
    (x, y), (width, height), seen = found.pixel, found.size, found.seen
    yield f"pixel     {x},{y} of {width}x{height} at {seconds:g} s"
    yield f"ray       from {_point(seen.origin)} along {_point(seen.direction)}"
    yield f"steps     {seen.steps}"
    if not found.hit:
        yield f"nothing   the ray {found.ended}"
        return
    inside = ", from inside" if seen.side < 0.0 else ""
    yield f"hit       at {_point(seen.p)}, {seen.t:.4g} along the ray{inside}"
    yield f"normal    {_point(seen.normal)}"
    yield f"gradient  {seen.steepness:.4g} of at most {found.slope:.4g}"
    yield from _shape(found)
    yield from _material(found)


def local_lines(found: ProbedImage, seconds: float) -> Iterator[str]:
    """Yield a text report of the locals of an image at a pixel."""
    (x, y), (width, height) = found.pixel, found.size
    yield f"pixel     {x},{y} of {width}x{height} at {seconds:g} s"
    yield f"color     {_point(found.color)} {_hex(found.color[:3])}"
    if not found.locals:
        yield f"'{found.name}' has no locals"
        return
    rows = [
        (each.name, str(each.type), _value(each.value), _line(each.place)) for each in found.locals
    ]
    widths = [max(len(row[i]) for row in rows) for i in range(3)]
    for row in rows:
        cells = "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=False))
        yield f"{cells}  {row[3]}".rstrip()


def _value(value: Any) -> str:
    if value is None:
        return "not reached"
    if isinstance(value, bool):
        return str(value)
    return f"{value:.4g}" if isinstance(value, float | int) else _point(value)


def _hex(color: Iterable[float]) -> str:
    """Return display values as the picture has them in 8 bits."""
    return "#" + "".join(f"{round(255.0 * min(max(c, 0.0), 1.0)):02x}" for c in color)


def _line(place: Span | None) -> str:
    if place is None:
        return ""
    text = place.text.strip()
    return f"line {place.line}: {text if len(text) <= LONGEST else text[: LONGEST - 1] + '…'}"


def _shape(found: Probed) -> Iterator[str]:
    from distal.scene.checks.validation import described, guarantee_names

    leaf = found.path[-1]
    claims = ", ".join(guarantee_names(leaf)) or "no guarantees besides its slope"
    yield f"shape     {described(leaf)}: {claims}"
    if len(found.path) > 1:
        yield f"part of   {' > '.join(node.name for node in found.path[:-1])}"
    if leaf.place is not None:
        yield from excerpt(leaf.place)


def _material(found: Probed) -> Iterator[str]:
    surface, call = found.seen.surface, found.material.call
    color = tuple(surface.color)
    parts = [f"{call.what}: color {_point(color)} {hex_of(color)}"]
    parts += [
        f"{name} {value:.3g}"
        for name in ("diffuse", "specular", "transmission", "roughness", "metal")
        if (value := getattr(surface, name)) > 0.0
    ]
    if any(c > 0.0 for c in surface.emission):
        parts.append(f"emission {_point(surface.emission)}")
    yield f"material  {', '.join(parts)}"
    if call.place is not None and call.place != found.path[-1].place:
        yield from excerpt(call.place)


def _point(p: Iterable[float]) -> str:
    return f"({', '.join(f'{c:.4g}' for c in p)})"
