"""``distal sweep``: render and measure a scene for many sets of values.

Input: parsed arguments. Output: a sheet or a folder of pictures, a table, and one line about it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from distal.cli.arguments import UsageError
from distal.cli.base import (
    AdapterOption,
    ClusterOption,
    Device,
    DeviceOption,
    ProgressKind,
    ProgressOption,
    SceneArgument,
    TimeoutOption,
    application,
    chosen_device,
    cluster_of,
    load_picture,
    reporting,
)
from distal.cli.options import NOTHING_ASKED, Asked, request_of, requesting
from distal.lang.progress_lines import COMPILING, LOADING


@application.command()
@reporting
@requesting("sweep")
def sweep(
    scene: SceneArgument,
    output: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            help="A .png for a sheet of all pictures, a folder for numbered pictures, or a .csv "
            "for a table of measures alone.",
            show_default=False,
        ),
    ],
    assignments: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="NAME=VALUES",
            help="All combinations of NAME=FIRST:LAST:COUNT or NAME=A,B,C; of colors and points "
            "NAME=A;B. Also time. With --draw: NAME=LOW:HIGH, or values to choose from.",
            show_default=False,
        ),
    ] = None,
    values_file: Annotated[
        Path | None,
        typer.Option(
            "--values",
            metavar="FILE.csv",
            help="A list of sets of values: names of parameters, and a line for each set.",
            show_default=False,
        ),
    ] = None,
    draw: Annotated[
        str | None,
        typer.Option(
            metavar="METHOD:COUNT",
            help="Draw sets of values that fill the ranges evenly: latin:100, or sobol:128.",
            show_default=False,
        ),
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Of --draw; 0 if left out.")] = None,
    asked: Asked = NOTHING_ASKED,
    device: DeviceOption = Device.CPU,
    adapter: AdapterOption = None,
    cluster: ClusterOption = None,
    task_timeout: TimeoutOption = 600.0,
    measure: Annotated[
        bool,
        typer.Option("--measure", help="Add volume, area, box and thinnest wall to the table."),
    ] = False,
    fresh: Annotated[
        bool,
        typer.Option("--fresh", help="Do all work again, and replace a table of other values."),
    ] = False,
    shown_progress: ProgressOption = ProgressKind.BAR,
) -> None:
    """Render and measure a scene for many sets of values of its parameters."""
    from distal.cli.messages import say
    from distal.cli.report import frame_progress
    from distal.sweeps import parameter_sets
    from distal.sweeps.sweeping import swept

    device_name = chosen_device(device, adapter)
    grid = _assigned(assignments or [])
    if values_file is not None and (grid or draw is not None):
        raise UsageError("--values has all values: leave out --set and --draw")
    if seed is not None and draw is None:
        raise UsageError("--seed is for --draw")
    drawn = None if draw is None else _drawn(draw)
    bar = frame_progress(shown_progress)
    bar.stage(LOADING)
    obj, _ = load_picture(scene, None)
    bar.stage(COMPILING)
    with cluster_of(cluster, device_name, task_timeout) as pool, bar:
        try:
            values: Any = grid if values_file is None else values_file
            if drawn is not None:
                method, count = drawn
                values = parameter_sets(obj, count, grid or None, method=method, seed=seed or 0)
            options = request_of(asked, device=device_name, cluster=pool)
            made = swept(obj, values, output, options, measure=measure, fresh=fresh, progress=bar)
        except ValueError as error:
            raise UsageError(str(error)) from None
    say(str(made))


def _assigned(assignments: list[str]) -> dict[str, str]:
    """Return the texts of --set by name.

    Raises:
        UsageError: One has no name, or a name is there twice.
    """
    values: dict[str, str] = {}
    for text in assignments:
        name, equals, given = text.partition("=")
        if not equals:
            raise UsageError(f"--set takes NAME=VALUES, not '{text:.60}'")
        if name.strip() in values:
            raise UsageError(f"--set gives '{name.strip()}' twice: NAME=0.2,0.4 has both values")
        values[name.strip()] = given
    return values


def _drawn(text: str) -> tuple[str, int]:
    """Return the method and the count of --draw.

    Raises:
        UsageError: The text has another form.
    """
    method, _, count = text.partition(":")
    if not (count.isascii() and count.isdigit() and len(count) < 10):
        raise UsageError(f"--draw takes METHOD:COUNT, like latin:100, not '{text:.60}'")
    return method.strip().lower(), int(count)
