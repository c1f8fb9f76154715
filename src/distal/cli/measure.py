"""``distal measure``: volume, area, mass, center, inertia, box, walls and overhang of a solid.

Input: parsed arguments. Output: numbers with their errors, in words or as JSON.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

import typer

from distal.cli.arguments import UsageError, check_lengths
from distal.cli.base import (
    FeatureOption,
    JsonOption,
    SceneArgument,
    SetOption,
    TimeOption,
    ToleranceOption,
    answer,
    application,
    reporting,
)
from distal.cli.mesh import load_solid

if TYPE_CHECKING:
    from distal.mesh.brackets import Brackets
    from distal.mesh.measuring import Measures, Quantity
    from distal.mesh.overhangs import Overhang
    from distal.mesh.widths import Width


@application.command()
@reporting
def measure(
    scene: SceneArgument,
    density: Annotated[float, typer.Option(help="The mass of a unit of volume.")] = 1.0,
    tolerance: ToleranceOption = None,
    feature: FeatureOption = None,
    volume_tolerance: Annotated[
        float | None,
        typer.Option(
            metavar="VOLUME",
            help="Cells become finer until the error of the volume is at most this.",
        ),
    ] = None,
    overhang: Annotated[
        float,
        typer.Option(
            metavar="DEGREES",
            help="Faces that look down need support up to this angle to the horizontal.",
        ),
    ] = 45.0,
    proved: Annotated[
        bool,
        typer.Option("--proved", help="Also prove bounds, by interval arithmetic."),
    ] = False,
    width: Annotated[
        float | None,
        typer.Option(
            metavar="SHARE",
            help="With --proved: until the bounds of the volume are this close, such as 0.01.",
        ),
    ] = None,
    work: Annotated[
        int | None,
        typer.Option(
            metavar="BOXES",
            help="With --proved: how many boxes are looked at, at most; 1000000 by default.",
        ),
    ] = None,
    at: TimeOption = "0",
    assignments: SetOption = None,
    as_json: JsonOption = False,
) -> None:
    """Show volume, area, mass, center, inertia, box, walls, gaps and overhang of a solid."""
    from distal.cli.report import ProgressBar

    check_lengths(tolerance=tolerance, feature=feature)
    if not 0.0 < density < float("inf"):
        raise UsageError(f"--density is a number above 0, not {density:g}")
    if not 0.0 <= overhang <= 90.0:
        raise UsageError(f"--overhang is an angle from 0 to 90 degrees, not {overhang:g}")
    if volume_tolerance is not None and not 0.0 < volume_tolerance < float("inf"):
        raise UsageError(f"--volume-tolerance is a number above 0, not {volume_tolerance:g}")
    _check_effort(width, work, proved=proved)
    shape, values, seconds = load_solid(scene, assignments, at)
    with ProgressBar("measuring") as progress:
        found = shape.measure(
            density,
            tolerance,
            values,
            seconds,
            progress=progress,
            feature=feature,
            overhang_deg=overhang,
            proved=proved,
            width=width,
            work=work,
            volume_tolerance=volume_tolerance,
        )
    if as_json:
        answer(json.dumps({**found.as_json(), "name": shape.name}))
    else:
        answer("\n".join(report_lines(found)))


def _check_effort(width: float | None, work: int | None, *, proved: bool) -> None:
    """Check what is asked of proved bounds.

    Raises:
        UsageError: A number is out of range, or nothing is to be proved.
    """
    from distal.mesh.certain_boxes import MOST_WORK

    for name, value in (("width", width), ("work", work)):
        if value is not None and not proved:
            raise UsageError(f"--{name} is for --proved, which is not given")
    if width is not None and not 0.0 <= width < 2.0:
        raise UsageError(f"--width is a share from 0 to 2, such as 0.01, not {width:g}")
    if work is not None and not 1 <= work <= MOST_WORK:
        raise UsageError(f"--work is 1 to {MOST_WORK:,} boxes, not {work}")


def report_lines(found: Measures) -> Iterator[str]:
    """Yield the measures, in scene units."""
    for name in ("volume", "area", "mass", "center"):
        yield f"{name:<8} {_shown(getattr(found, name))}"
    rows = "; ".join(_numbers(row) for row in found.inertia.value)
    yield f"inertia  {rows} ± {found.inertia.error:.2g}, about the center"
    yield f"box      {_shown(found.low)} to {_shown(found.high)}"
    low, high = (f"({_numbers(list(corner))})" for corner in found.bounds)
    yield f"bounds   {low} to {high}, which the shape never leaves"
    yield f"wall     {_width(found.wall)}"
    yield f"gap      {_width(found.gap)}"
    yield f"overhang {_overhang(found.overhang)}"
    yield f"errors   {found.how}"
    for warning in found.warnings:
        yield f"warning  {warning}"
    if found.brackets is not None:
        yield from _bracket_lines(found.brackets)


def _width(found: Width | None) -> str:
    if found is None:
        return "none"
    places = f"({_numbers(list(found.place))}) to ({_numbers(list(found.opposite))})"
    return f"{found.value:.6g}, the least of lines {found.apart:.2g} apart: {found.name}, {places}"


def _overhang(found: Overhang) -> str:
    limit = f"{found.angle_deg:g} degrees"
    if found.place is None:
        return f"none: no face that looks down is within {limit} of the horizontal"
    where = f"flattest at {found.name}, ({_numbers(list(found.place))})"
    return f"{found.area:.4g}, {100.0 * found.share:.2g} % of the area, within {limit}; {where}"


def _bracket_lines(found: Brackets) -> Iterator[str]:
    (lower, upper), (light, heavy) = found.volume, found.mass
    yield f"proved   volume {lower:.8g} to {upper:.8g}, {100.0 * found.width:.3g} % apart"
    yield f"         mass   {light:.8g} to {heavy:.8g}"
    for name, (first, second) in (
        ("center", found.center),
        ("low   ", found.low),
        ("high  ", found.high),
    ):
        yield f"         {name} ({_numbers(list(first))}) to ({_numbers(list(second))})"
    how = "by intervals, whatever the slope"
    if found.slope is not None:
        how = f"by the stated slope {found.slope:g}, which is assumed: intervals do not apply, "
        how += f"since {found.reason}"
    yield f"         {how}"
    undecided = f"{100.0 * found.undecided:.3g} % of the box are undecided"
    yield f"         {undecided} after {found.boxes:,} boxes; the shape is looked at in its bounds"
    if not found.reached:
        yield "         --width is not reached: give a larger --work"


def _shown(measured: Quantity) -> str:
    value = measured.value
    text = f"({_numbers(value)})" if isinstance(value, list) else f"{value:.8g}"
    return f"{text} ± {measured.error:.2g}"


def _numbers(values: list[float]) -> str:
    # Adding 0 makes -0 a 0.
    return ", ".join(f"{round(value, 12) + 0.0:.6g}" for value in values)
