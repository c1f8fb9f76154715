"""``distal mesh``: save the surface of a shape as triangles.

Input: parsed arguments. Output: a mesh file, and how exact it is in words or as JSON.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from distal.cli.arguments import (
    UsageError,
    check_is_not_scene,
    check_lengths,
    read_assignments,
    read_time,
)
from distal.cli.base import (
    FeatureOption,
    JsonOption,
    SceneArgument,
    SetOption,
    TimeOption,
    ToleranceOption,
    UnitOption,
    answer,
    application,
    load,
    reporting,
)
from distal.cli.exit_codes import ExitCode
from distal.cli.surroundings import check_processor
from distal.diagnostics import LoadError

if TYPE_CHECKING:
    from distal.mesh.scene_parts import SceneParts
    from distal.scene.objects.shape import Shape


@application.command()
@reporting
def mesh(
    scene: SceneArgument,
    output: Annotated[
        Path,
        typer.Option(
            "-o", "--output", help="The file: .3mf, .stl, .glb, .ply or .obj.", show_default=False
        ),
    ],
    tolerance: ToleranceOption = None,
    feature: FeatureOption = None,
    angle: Annotated[
        float | None,
        typer.Option(
            metavar="DEGREES",
            help="How much the surface may turn within a triangle.",
            show_default="any angle",
        ),
    ] = None,
    unit: UnitOption = "mm",
    bed: Annotated[
        bool, typer.Option("--bed", help="Stand the part on 0, centered, as printers want it.")
    ] = False,
    colors: Annotated[
        int | None,
        typer.Option(metavar="N", help="At most so many colors, for a printer with N filaments."),
    ] = None,
    parts: Annotated[
        bool,
        typer.Option("--parts", help="Save each shape with a name as a part of its own."),
    ] = False,
    check: Annotated[
        bool,
        typer.Option("--check", help="Count open edges, pinched points and intersections."),
    ] = False,
    at: TimeOption = "0",
    assignments: SetOption = None,
    as_json: JsonOption = False,
) -> None:
    """Save a shape's surface as triangles: closed, with sharp edges, in a unit of length."""
    from distal.cli.messages import say
    from distal.cli.report import ProgressBar
    from distal.mesh import palette, scene_parts
    from distal.mesh.files import formats
    from distal.mesh.meshing import MeshRequest

    check_is_not_scene(output, scene)
    check_lengths(tolerance=tolerance, feature=feature)
    if angle is not None and not 0.0 < angle < float("inf"):
        raise UsageError(f"--angle is an angle above 0, in degrees, not {angle:g}")
    if colors is not None and not 1 <= colors <= palette.MOST:
        raise UsageError(f"--colors is a number from 1 to {palette.MOST}, not {colors}")
    formats.check_output(output, unit)
    shape, values, seconds = load_solid(scene, assignments, at)
    with ProgressBar("meshing") as progress:
        request = MeshRequest(
            tolerance,
            feature,
            values,
            seconds,
            progress=progress,
            check=check,
            colors=True if colors is None else colors,
            angle=None if angle is None else math.radians(angle),
        )
        found = scene_parts.meshes_of(shape.node, request, parts=parts)
    found.save(output, unit=unit, bed=bed)
    if as_json:
        rows = [
            {**report, "size": formats.size_in_file(output, report["size"]), "name": name}
            for report, name in ((made.report, made.name) for made in found.meshes)
        ]
        rows = [{**row, "unit": unit} for row in rows]
        answer(json.dumps({"parts": rows, "endless": list(found.endless)} if parts else rows[0]))
    else:
        for line in report_lines(output, found, unit):
            say(line)
    if check and any(any(made.report["check"].values()) for made in found.meshes):
        raise typer.Exit(ExitCode.FAILED)


def load_solid(
    scene: str, assignments: list[str] | None, at: str
) -> tuple[Shape, dict[str, Any], float]:
    """Load the solid FILE[:NAME], of a scene its shape; parameter values and time.

    Raises:
        LoadError: The object is an image, or a flat shape.
        UsageError: A value is invalid.
    """
    from distal.scene.objects.shape import Shape
    from distal.scene.scene import Scene

    seconds = read_time(at)
    check_processor()
    obj: Any = load(scene)
    shape = obj.subject if isinstance(obj, Scene) else obj
    if not isinstance(shape, Shape):
        flat = getattr(shape, "flat", False)
        what = "a flat shape: .extrude(height) makes a solid" if flat else "no shape and no scene"
        raise LoadError(f"'{obj.name}' is {what}")
    return shape, read_assignments(assignments or (), obj.parameters()), seconds


def report_lines(output: Path, found: SceneParts, unit: str) -> Iterator[str]:
    """Yield what was saved, how exact it is, and what to watch for."""
    from distal.mesh.files.formats import size_in_file

    several = len(found.meshes) > 1
    for made in found.meshes:
        title = f"{output}, {made.name}" if several else str(output)
        yield from _part_lines(title, made.report, size_in_file(output, made.report["size"]), unit)
    for name in found.endless:
        yield f"{name} has no end and is left out"


def _part_lines(
    title: str, report: Mapping[str, Any], size: Sequence[float], unit: str
) -> Iterator[str]:
    sides = " x ".join(f"{side:.4g}" for side in size)
    volume = f"{report['volume']:.4g} cubic {unit}"
    yield f"{title}: {report['triangles']:,} triangles, {sides} {unit}, {volume}"
    error = report["error"]
    yield (
        f"at most {error['largest']:.2g} {unit} from the surface, {error['mean']:.2g} on average; "
        f"parts and gaps of {report['sure_to']:.2g} {unit} are found"
    )
    if report["unknown_widths"]:
        unknown = ", ".join(report["unknown_widths"])
        yield f"without {unknown}, whose widths are not known, smaller ones would be"
    yield ", ".join(
        f"{report[name]:,} {name[:-1] if report[name] == 1 else name}"
        for name in ("pieces", "holes", "voids")
    )
    for name in report["leaves"]["unchecked"]:
        yield f"whether all of {name} is there is not known: its distance is an estimate"
    if "check" in report:
        found = report["check"]
        yield (
            f"{found['open_edges']} open edges, {found['pinched_points']} pinched points, "
            f"{found['intersections']} intersections"
        )
    for warning in report["warnings"]:
        yield f"warning: {warning}"
