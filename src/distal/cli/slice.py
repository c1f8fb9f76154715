"""``distal slice``: save the outlines of a flat shape, or of a solid in layers.

Input: parsed arguments. Output: an SVG or DXF file, or a folder with one for each layer, and how
exact they are in words or as JSON.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
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
    JsonOption,
    SceneArgument,
    SetOption,
    TimeOption,
    UnitOption,
    answer,
    application,
    load,
    reporting,
)
from distal.cli.messages import say
from distal.cli.surroundings import check_processor
from distal.diagnostics import LoadError
from distal.file_writer import SaveError

if TYPE_CHECKING:
    from distal.mesh.outlines.layers import SolidLayer
    from distal.mesh.outlines.outlining import OutlineRequest
    from distal.scene.objects.field import BaseShape


@application.command()
@reporting
def slice(
    scene: SceneArgument,
    output: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            help="The file, .svg or .dxf, or a folder for one file of each layer.",
            show_default=False,
        ),
    ],
    height: Annotated[
        float | None,
        typer.Option(
            metavar="LENGTH", help="The height of a layer, in scene units.", show_default=False
        ),
    ] = None,
    place: Annotated[
        float | None,
        typer.Option(
            "--at",
            metavar="PLACE",
            help="Instead of layers: one slice, at this place on the axis.",
            show_default=False,
        ),
    ] = None,
    axis: Annotated[str, typer.Option(help="The axis across the layers: x, y or z.")] = "y",
    tolerance: Annotated[
        float | None,
        typer.Option(
            metavar="LENGTH",
            help="How far outlines may be from the surface, in scene units.",
            show_default="0.0002 of the largest side",
        ),
    ] = None,
    unit: UnitOption = "mm",
    kind: Annotated[
        str, typer.Option("--format", help="Of the files in a folder: svg or dxf.")
    ] = "svg",
    at: TimeOption = "0",
    assignments: SetOption = None,
    as_json: JsonOption = False,
) -> None:
    """Save outlines for cutters: of a flat shape, of a solid's layers, or of one slice."""
    from distal.cli.report import ProgressBar
    from distal.mesh.outlines.outlining import OutlineRequest

    _check(scene, output, axis, kind, height=height, tolerance=tolerance)
    _check_output(output, kind, unit)
    seconds = read_time(at)
    check_processor()
    obj: Any = load(scene)
    values = read_assignments(assignments or (), obj.parameters())
    shape = _shape_of(obj, height, place)
    with ProgressBar("slicing") as progress:
        request = OutlineRequest(tolerance, values, seconds, progress)
        report = _saved(output, kind, unit, shape, _layers(shape, height, place, axis, request))
    if as_json:
        answer(json.dumps(report))
    else:
        for line in _lines(output, report):
            say(line)


def _check(scene: str, output: Path, axis: str, kind: str, **lengths: float | None) -> None:
    """Check the options that need no scene.

    Args:
        scene: FILE[:NAME].
        output: The file or the folder.
        axis: The name of an axis.
        kind: The format of files in a folder.
        lengths: Options that are lengths.

    Raises:
        UsageError: One is invalid.
    """
    check_is_not_scene(output, scene)
    check_lengths(**lengths)
    if axis not in ("x", "y", "z"):
        raise UsageError(f"--axis is x, y or z, not '{axis}'")
    if kind not in ("svg", "dxf"):
        raise UsageError(f"--format is svg or dxf, not '{kind}'")


def _is_folder(output: Path) -> bool:
    return output.is_dir() or not output.suffix


def _check_output(output: Path, kind: str, unit: str) -> None:
    """Check that the output can be written; make the folder.

    Args:
        output: The file or the folder.
        kind: The format of files in a folder.
        unit: The length of one scene unit.

    Raises:
        SaveError: It cannot be written, or the suffix or the unit is unknown.
    """
    from distal.mesh.files.formats import check_outline_file

    if not _is_folder(output):
        check_outline_file(output, unit)
        return
    try:
        output.mkdir(exist_ok=True)
    except OSError as error:
        raise SaveError(f"cannot make the folder {output}: {error.strerror or error}") from None
    check_outline_file(output / f"layer.{kind}", unit)


def _shape_of(obj: Any, height: float | None, place: float | None) -> BaseShape:
    """Return the shape to slice: of a scene its shape.

    Args:
        obj: What FILE[:NAME] is.
        height: The height of a layer.
        place: The place of one slice.

    Raises:
        LoadError: It is an image.
        UsageError: The options are not those of a solid, or of a flat shape.
    """
    from distal.scene.objects.field import BaseShape
    from distal.scene.scene import Scene

    shape = obj.subject if isinstance(obj, Scene) else obj
    if not isinstance(shape, BaseShape):
        raise LoadError(f"'{obj.name}' is no shape and no scene")
    if shape.flat and (height is not None or place is not None):
        raise UsageError(f"'{shape.name}' is flat: it has one outline, without --height and --at")
    if not shape.flat and (height is None) == (place is None):
        raise UsageError(
            "give --height, the height of the layers, or --at, the place of one slice"
            if height is None
            else "--height is for layers, and --at for one slice: give one of them"
        )
    return shape


def _layers(
    shape: Any, height: float | None, place: float | None, axis: str, request: OutlineRequest
) -> Iterator[SolidLayer]:
    """Return the layers of a shape; a flat one is its only layer.

    Args:
        shape: The shape.
        height: The height of a layer, or None.
        place: The place of one slice, or None.
        axis: The axis across the layers.
        request: What is asked.
    """
    from distal.mesh.outlines.layers import SolidLayer, layer_places, layers_at
    from distal.mesh.outlines.outlining import outline_of

    if shape.flat:
        return iter([SolidLayer(0.0, outline_of(shape, request))])
    if height is not None:
        return layers_at(shape, layer_places(shape, height, axis, request), axis, request)
    assert place is not None
    return layers_at(shape, [place], axis, request)


def _saved(
    output: Path, kind: str, unit: str, shape: BaseShape, layers: Iterator[SolidLayer]
) -> dict[str, Any]:
    """Save layers, those of a folder each when it is there, and return the report.

    Args:
        output: The file or the folder.
        kind: The format of files in a folder.
        unit: The length of one scene unit.
        shape: The shape.
        layers: Its layers.

    Raises:
        SaveError: No layer has an inside, or a file cannot be written.
    """
    from distal.mesh.files.formats import write_layers, write_outlines
    from distal.mesh.files.outlines import layer_name

    folder = _is_folder(output)
    rows: list[dict[str, Any]] = []
    kept: list[tuple[float, Any]] = []
    warnings: list[str] = []
    for layer in layers:
        if layer.outline is None:
            warnings += [] if layer.warning is None else [layer.warning]
            continue
        file = output / f"{layer_name(len(rows) + 1)}.{kind}" if folder else output
        loops = layer.outline.loops
        if folder:
            write_outlines(file, loops, unit=unit, frame=layer.frame)
        else:
            kept.append((layer.place, loops))
        rows.append({"file": str(file), "at": layer.place, **layer.outline.report})
        found = rows[-1].pop("warnings")
        warnings += [text if shape.flat else f"at {layer.place:g}: {text}" for text in found]
    if not rows:
        more = f"; {warnings[0]}" if warnings else ""
        raise SaveError(f"nothing to save: '{shape.name}' has no inside at these places{more}")
    if not folder and shape.flat:
        write_outlines(output, kept[0][1], unit=unit)
    elif not folder:
        write_layers(output, kept, unit=unit)
    else:
        warnings += _left_over(output, kind, len(rows))
    return {"name": shape.name, "unit": unit, "layers": rows, "warnings": warnings}


def _left_over(folder: Path, kind: str, count: int) -> list[str]:
    """Return a warning if a folder holds layers of an earlier run, which are not deleted.

    Args:
        folder: The folder.
        kind: The format of its files.
        count: How many layers were written.
    """
    from distal.mesh.files.outlines import layer_name

    names = sorted(path.name for path in folder.glob(f"layer-*.{kind}"))
    written = {f"{layer_name(number + 1)}.{kind}" for number in range(count)}
    rest = [name for name in names if name not in written]
    if not rest:
        return []
    return [f"{folder} also holds {len(rest)} layers of an earlier run, from {rest[0]}"]


def _lines(output: Path, report: dict[str, Any]) -> Iterator[str]:
    """Yield what was saved, how exact it is, and what to watch for.

    Args:
        output: The file or the folder.
        report: The report.
    """
    layers, unit = report["layers"], report["unit"]
    loops, points = (sum(layer[name] for layer in layers) for name in ("loops", "points"))
    many = f"{len(layers):,} layers, " if len(layers) > 1 else ""
    yield f"{output}: {many}{loops:,} closed {'line' if loops == 1 else 'lines'}, {points:,} points"
    error = max(layer["error"] for layer in layers)
    if len(layers) == 1:
        area, length = layers[0]["area"], layers[0]["length"]
        yield f"area {area:.6g}, length {length:.6g}, at most {error:.2g} {unit} from the surface"
    else:
        volume = sum(layer["area"] for layer in layers) * (layers[1]["at"] - layers[0]["at"])
        yield f"volume about {volume:.6g}, each layer at most {error:.2g} {unit} from the surface"
    for warning in report["warnings"]:
        yield f"warning: {warning}"
