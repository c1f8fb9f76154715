"""``distal measure``: volume, area, mass, center of mass, inertia and box of a solid.

Input: parsed arguments. Output: numbers with their errors, in words or as JSON.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

import typer

from distal.cli.arguments import UsageError
from distal.cli.base import SceneArgument, SetOption, TimeOption, answer, application, reporting
from distal.cli.mesh import ToleranceOption, check_lengths, load_solid

if TYPE_CHECKING:
    from distal.mesh.measuring import Measures, Quantity


@application.command()
@reporting
def measure(
    scene: SceneArgument,
    density: Annotated[float, typer.Option(help="The mass of a unit of volume.")] = 1.0,
    tolerance: ToleranceOption = None,
    at: TimeOption = "0",
    assignments: SetOption = None,
    as_json: Annotated[bool, typer.Option("--json", help="Plain values, on one line.")] = False,
) -> None:
    """Show volume, area, mass, center of mass, inertia and box of a solid, each with its error."""
    from distal.cli.report import ProgressBar

    check_lengths(tolerance=tolerance)
    if not 0.0 < density < float("inf"):
        raise UsageError(f"--density is a number above 0, not {density:g}")
    shape, values, seconds = load_solid(scene, assignments, at)
    with ProgressBar("measuring") as progress:
        found = shape.measure(density, tolerance, values, seconds, progress=progress)
    if as_json:
        answer(json.dumps({**found.as_json(), "name": shape.name}))
    else:
        answer("\n".join(report_lines(found)))


def report_lines(found: Measures) -> Iterator[str]:
    """Yield the measures, in scene units."""
    for name in ("volume", "area", "mass", "center"):
        yield f"{name:<8} {_shown(getattr(found, name))}"
    rows = "; ".join(_numbers(row) for row in found.inertia.value)
    yield f"inertia  {rows} ± {found.inertia.error:.2g}, about the center"
    yield f"box      {_shown(found.low)} to {_shown(found.high)}"
    low, high = (f"({_numbers(list(corner))})" for corner in found.bounds)
    yield f"bounds   {low} to {high}, which the shape never leaves"
    yield f"errors   {found.how}"


def _shown(measured: Quantity) -> str:
    value = measured.value
    text = f"({_numbers(value)})" if isinstance(value, list) else f"{value:.8g}"
    return f"{text} ± {measured.error:.2g}"


def _numbers(values: list[float]) -> str:
    # Adding 0 makes -0 a 0.
    return ", ".join(f"{round(value, 12) + 0.0:.6g}" for value in values)
